#include "setup/solid_cells.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "core/parallel.hpp"
#include "shape/cut_cells.hpp"
#include "shape/parts.hpp"
#include "shape/placement.hpp"

namespace brisance::setup {

namespace {

using shape::CellRange;
using shape::Parts;
using shape::Share;

/// A convex obstacle that is this thick [cells] cannot stand between two gas cells that touch: at its edges it does not
/// reach through them.
constexpr double thick = 2.0;

/// Parts of a cell per direction in which is looked for a way around a wall.
int parts_of(int dimensions) { return dimensions == 3 ? 6 : 8; }

/// A part of the largest free piece; -1 where nothing is free.
int in_largest(Parts const& parts) {
  shape::Pieces const pieces = shape::pieces_of(parts);
  int const largest = pieces.largest();
  if (largest == 0) return -1;
  return static_cast<int>(std::find(pieces.number.begin(), pieces.number.end(), largest) - pieces.number.begin());
}

/// Is the gas of the low cell cut off from that of the high cell, within the two?
bool parted(Parts const& low, Parts const& high, int direction) {
  int const a = in_largest(low);
  int const b = in_largest(high);
  if (a < 0 || b < 0) return true;
  Parts both;
  both.box = low.box;
  both.box.upper[direction] *= 2;
  both.free.resize(both.box.count());
  auto const place = [&](std::size_t at, int side) {
    Index3 part = low.box.at(at);
    part[direction] += side * low.box.n(direction);
    return both.box.offset(part);
  };
  for (std::size_t at = 0; at < low.free.size(); ++at) {
    both.free[place(at, 0)] = low.free[at];
    both.free[place(at, 1)] = high.free[at];
  }
  std::vector<int> const number = shape::pieces_of(both).number;
  return number[place(static_cast<std::size_t>(a), 0)] != number[place(static_cast<std::size_t>(b), 1)];
}

int largest_of(std::vector<Share> const& shares) {
  return std::max_element(shares.begin(), shares.end(),
                          [](Share const& a, Share const& b) { return a.fraction < b.fraction; })
      ->shape;
}

}  // namespace

SolidCells::SolidCells(grid::Domain const& domain, std::vector<Obstacle> const& obstacles, bool cut)
    : cut_(cut), domain_(domain), obstacles_(obstacles) {
  for (Obstacle const& o : obstacles) shapes_.push_back(o.shape);
}

bool SolidCells::operator()(Index3 const& cell) const {
  return any() && solid(sum_of(shape::shares_of_cell(shapes_, domain_, cell)));
}

std::vector<std::uint8_t> SolidCells::all() const {
  CellRange const whole = domain_.all_cells();
  std::vector<std::uint8_t> flags(whole.count(), 0);
  if (!any()) return flags;
  // Slabs across the last direction, which follow each other in memory.
  int const last = domain_.dimensions() - 1;
  constexpr int thickness = 8;
  parallel_for((domain_.cells[last] + thickness - 1) / thickness, [&](int n, int) {
    CellRange slab = domain_.all_cells();
    slab.lower[last] = n * thickness;
    slab.upper[last] = std::min(domain_.cells[last], (n + 1) * thickness);
    shape::for_each_share(shapes_, domain_, slab, [&](CellRange const& r, std::vector<Share> const& shares) {
      if (!solid(sum_of(shares))) return true;
      grid::for_each_cell(r, [&](Index3 const& cell) { flags[whole.offset(cell)] = 1; });
      return true;
    });
  });
  return flags;
}

std::optional<std::vector<run::ObstacleReport>> SolidCells::reports(long most) const {
  std::vector<run::ObstacleReport> all(shapes_.size());
  for (std::size_t n = 0; n < all.size(); ++n) {
    all[n].name = obstacles_[n].name;
    all[n].specified_volume = shape::volume_inside(shapes_[n], domain_);
  }
  long cut = 0;
  shape::for_each_share(shapes_, domain_, domain_.all_cells(),
                        [&](CellRange const& r, std::vector<Share> const& shares) {
                          double const sum = sum_of(shares);
                          double const whole = shape::volume_of(r, domain_);
                          if (sum < 1.0 && ++cut > most) return false;
                          if (cut_) {
                            for (Share const& s : shares)
                              all[static_cast<std::size_t>(s.shape)].volume += s.fraction * whole;
                            if (1.0 - sum < shape::least_open) {
                              all[static_cast<std::size_t>(largest_of(shares))].cells += static_cast<long>(r.count());
                            }
                          } else if (solid(sum)) {
                            run::ObstacleReport& report = all[static_cast<std::size_t>(largest_of(shares))];
                            report.cells += static_cast<long>(r.count());
                            report.volume += whole;
                            report.excess += (1.0 - std::min(sum, 1.0)) * whole;
                          } else {
                            for (Share const& s : shares)
                              all[static_cast<std::size_t>(s.shape)].excess -= s.fraction * whole;
                          }
                          return true;
                        });
  if (cut > most) return std::nullopt;
  return all;
}

double SolidCells::thickness(std::size_t obstacle) const {
  shape::Shape const& s = shapes_[obstacle];
  int const dims = domain_.dimensions();
  if (auto const* sphere = std::get_if<shape::Sphere>(&s)) return 2.0 * sphere->radius;
  if (auto const* half = std::get_if<shape::Hemisphere>(&s)) return half->radius;
  if (auto const* cylinder = std::get_if<shape::Cylinder>(&s)) {
    bool const endless =
        domain_.geometry != grid::Geometry::cartesian3d && domain_.geometry != grid::Geometry::axisymmetric2d;
    return endless ? 2.0 * cylinder->radius : std::min(2.0 * cylinder->radius, cylinder->length);
  }
  shape::Box const box = shape::bounds(s);
  double least = box.upper[0] - box.lower[0];
  for (int d = 1; d < dims; ++d) least = std::min(least, box.upper[d] - box.lower[d]);
  return least;
}

CellRange SolidCells::around(std::size_t obstacle, int layers) const {
  CellRange const own = shape::cells_around(shapes_[obstacle], domain_);
  return grid::common(domain_.all_cells(), own.grown(layers, domain_.dimensions()));
}

std::vector<Index3> SolidCells::cells_of(std::size_t obstacle) const {
  std::vector<Index3> cells;
  shape::for_each_share(shapes_, domain_, around(obstacle, 0),
                        [&](CellRange const& r, std::vector<Share> const& shares) {
                          if (!solid(sum_of(shares)) || largest_of(shares) != static_cast<int>(obstacle)) return true;
                          grid::for_each_cell(r, [&](Index3 const& cell) { cells.push_back(cell); });
                          return true;
                        });
  return cells;
}

bool SolidCells::vanishes(std::size_t obstacle) const {
  if (!(shape::volume_inside(shapes_[obstacle], domain_) > 0.0)) return true;
  bool holds = false;
  bool lost = false;
  shape::for_each_share(shapes_, domain_, around(obstacle, 0), [&](CellRange const&, std::vector<Share> const& shares) {
    bool const here = std::any_of(shares.begin(), shares.end(),
                                  [&](Share const& s) { return s.shape == static_cast<int>(obstacle); });
    bool const full = solid(sum_of(shares));
    if (here && full && largest_of(shares) == static_cast<int>(obstacle)) holds = true;
    if (here && !full) lost = true;
    return !holds;
  });
  return !holds && lost;
}

bool SolidCells::may_leak(std::size_t obstacle) const {
  // A box lies along the grid: one layer of its cells is solid all over, or none is.
  return !std::holds_alternative<shape::Box>(shapes_[obstacle]) &&
         thickness(obstacle) < thick * domain_.smallest_cell();
}

std::optional<Leak> SolidCells::leak(long& most) const {
  std::vector<CellRange> ranges;
  std::vector<CellRange> near(shapes_.size());
  for (std::size_t n = 0; n < shapes_.size(); ++n) near[n] = around(n, 1);
  for (std::size_t n = 0; n < shapes_.size() && most > 0; ++n) {
    ranges.clear();
    if (may_leak(n)) {
      ranges.push_back(around(n, 0));
    } else {
      for (std::size_t other = 0; other < n; ++other) {
        CellRange const both = grid::common(near[n], near[other]);
        if (!both.empty() && !may_leak(other)) ranges.push_back(both);
      }
    }
    for (CellRange const& range : ranges) {
      if (auto const found = leak_in(range, most)) return found;
      if (most <= 0) break;
    }
  }
  return std::nullopt;
}

std::optional<Leak> SolidCells::leak_in(CellRange const& range, long& most) const {
  int const dims = domain_.dimensions();
  int const p = parts_of(dims);
  grid::Domain fine = domain_;
  fine.h /= p;
  for (int d = 0; d < dims; ++d) fine.cells[d] = domain_.cells[d] * p;
  std::map<Index3, Parts> known;
  auto const parts_at = [&](Index3 const& cell) -> Parts const& {
    auto const [place, added] = known.try_emplace(cell);
    if (added) place->second = shape::parts_of_cell(shapes_, fine, cell, p);
    return place->second;
  };
  // Where nothing lies between the middles of two cells, gas may pass. That is soon seen, and true of most.
  auto const free_between = [&](Index3 const& low, int direction) {
    Index3 i{0, 0, 0};
    for (int d = 0; d < dims; ++d) i[d] = low[d] * p + p / 2;
    for (int n = 0; n < p; ++n, ++i[direction]) {
      if (!shape::shares_of_cell(shapes_, fine, i, 2).empty()) return false;
    }
    return true;
  };
  std::vector<CellRange> near(shapes_.size());
  for (std::size_t n = 0; n < shapes_.size(); ++n) near[n] = around(n, 1);

  std::optional<Leak> leak;
  auto const look = [&](CellRange const& r, std::vector<Share> const& shares) {
    if (--most <= 0) return false;
    if (solid(sum_of(shares))) return true;
    Index3 const cell = r.lower;
    // One thick convex obstacle alone has no gaps, nor has a box.
    int obstacles = 0;
    bool thin = false;
    for (std::size_t n = 0; n < shapes_.size(); ++n) {
      if (!near[n].contains(cell)) continue;
      ++obstacles;
      thin = thin || may_leak(n);
    }
    if (obstacles < 2 && !thin) return true;
    for (int face = 0; face < 2 * dims; ++face) {
      int const d = face / 2;
      Index3 const other = grid::beside(cell, d, face % 2);
      if (!domain_.contains(other) || (*this)(other)) continue;
      Index3 const& low = face % 2 == 0 ? other : cell;
      Index3 const& high = face % 2 == 0 ? cell : other;
      if (free_between(low, d)) continue;
      Parts const& a = parts_at(low);
      Parts const& b = parts_at(high);
      if (!parted(a, b, d)) continue;
      Vec3 place = domain_.centre(low);
      place[d] += 0.5 * domain_.smallest_cell();
      leak = Leak{static_cast<std::size_t>(largest_of(shares)), place};
      return false;
    }
    return true;
  };
  shape::for_each_share(shapes_, domain_, range, look);
  return leak;
}

}  // namespace brisance::setup
