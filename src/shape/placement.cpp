#include "shape/placement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/error.hpp"
#include "core/parallel.hpp"

namespace brisance::shape {

using grid::CellRange;

namespace {

/// Smallest fraction of a sub-cell that becomes a particle of its own. Measured on spheres and cylinders of 5 cells
/// radius with 2 particles per direction, anywhere on the grid: at a quarter the radius of gyration is 0.2 % off at
/// most and a particle holds 1.5 sub-cells at most; at one half it is 0.3 % and 2.2, at a tenth 0.2 % with light
/// particles added.
constexpr double smallest_share = 0.25;

/// Faces of a body closer than this to those of a sub-cell, in its sizes, lie on them: the round-off of a coordinate
/// that is a million sub-cells long is a thousand times smaller.
constexpr double on_face = 1e-7;

/// Lines through a sub-cell in each direction across x.
constexpr int lines_per_sub_cell = 8;

/// The range of sub-cells around a body and how much of each it fills.
struct SubCells {
  grid::Geometry geometry = grid::Geometry::cartesian3d;
  int dims = 3;
  double size = 1.0;
  Vec3 corner{};   ///< of the domain
  Index3 first{};  ///< in the domain
  Index3 count{};  ///< in each direction
  std::vector<double> filled;

  [[nodiscard]] CellRange all() const { return {{0, 0, 0}, count}; }
  [[nodiscard]] std::size_t index(Index3 const& at) const { return all().offset(at); }
  /// Volume of sub-cells with first index i.
  [[nodiscard]] double volume(int i) const {
    double const across = dims == 3 ? size * size : dims == 2 ? size : 1.0;
    if (grid::radial_exponent(geometry) == 0) return size * across;
    double const r = corner[0] + (first[0] + i) * size;
    return (radial_integral(geometry, r + size) - radial_integral(geometry, r)) * across;
  }
};

/// The sub-cells that may hold a part of the body.
SubCells sub_cells(Shape const& shape, grid::Domain const& domain, int per_direction) {
  SubCells cells;
  cells.geometry = domain.geometry;
  cells.dims = domain.dimensions();
  cells.size = domain.smallest_cell() / per_direction;
  cells.corner = domain.lower;
  Box const box = bounds(shape);
  for (int d = 0; d < 3; ++d) {
    cells.count[d] = 1;
    if (d >= cells.dims) continue;
    double const all = static_cast<double>(domain.cells[d]) * per_direction;
    double const low = std::clamp((box.lower[d] - domain.lower[d]) / cells.size, 0.0, all);
    double const high = std::clamp((box.upper[d] - domain.lower[d]) / cells.size, 0.0, all);
    cells.first[d] = static_cast<int>(std::floor(low + on_face));
    cells.count[d] = std::max(0, static_cast<int>(std::ceil(high - on_face)) - cells.first[d]);
  }
  return cells;
}

/// Adds what a stretch of a line fills, `share` of each sub-cell's cross-section, to a row of sub-cells.
void fill_row(SubCells const& cells, Span const& span, double share, double* row) {
  double const low = cells.corner[0] + cells.first[0] * cells.size;
  double const n = cells.count[0];
  auto const snapped = [&](double x) {
    double const u = std::clamp((x - low) / cells.size, 0.0, n);
    double const whole = std::round(u);
    return std::abs(u - whole) < on_face ? whole : u;
  };
  double const from = snapped(span.from);
  double const to = snapped(span.to);
  if (!(to > from)) return;
  int const begin = std::min(static_cast<int>(from), cells.count[0] - 1);
  int const end = std::min(static_cast<int>(to), cells.count[0] - 1);
  auto const part = [&](int i, double a, double b) {
    if (grid::radial_exponent(cells.geometry) == 0) return b - a;
    auto const metric = [&](double u) { return radial_integral(cells.geometry, low + u * cells.size); };
    return (metric(b) - metric(a)) / (metric(i + 1) - metric(i));
  };
  if (begin == end) {
    row[begin] += share * part(begin, from, to);
    return;
  }
  row[begin] += share * part(begin, from, begin + 1);
  for (int i = begin + 1; i < end; ++i) row[i] += share;
  if (to > end) row[end] += share * part(end, end, to);
}

/// By lines along x.
void fill_by_lines(Shape const& shape, SubCells& cells) {
  cells.filled.assign(cells.all().count(), 0.0);
  auto const across = [&](int d, int n) {
    if (d >= cells.dims) return std::vector<Station>{{0.0, 1.0}};
    double const from = cells.corner[d] + (cells.first[d] + n) * cells.size;
    double const to = cells.corner[d] + (cells.first[d] + n + 1) * cells.size;
    return stations(shape, d, from, to, lines_per_sub_cell, on_face * cells.size);
  };
  std::vector<std::vector<Station>> ys(cells.count[1]);
  for (int j = 0; j < cells.count[1]; ++j) ys[j] = across(1, j);
  CellRange rows = cells.all();
  rows.upper[0] = 1;
  parallel_for(static_cast<int>(rows.count()), [&](int n, int) {
    Index3 const first = rows.at(static_cast<std::size_t>(n));
    double* const row = cells.filled.data() + cells.index(first);
    std::vector<Span> inside;
    for (Station const& z : across(2, first[2])) {
      for (Station const& y : ys[first[1]]) {
        spans(shape, cells.dims, y.at, z.at, inside);
        for (Span const& s : inside) fill_row(cells, s, y.share * z.share, row);
      }
    }
  });
}

/// What lines along x say of a sub-cell that the surface cuts is not what lines along y say: where nothing tells the
/// directions apart, all are asked, so that a body and its image with the axes exchanged are the same.
void fill(Shape const& shape, SubCells& cells) {
  fill_by_lines(shape, cells);
  bool const along_grid = std::holds_alternative<Box>(shape) || std::holds_alternative<Everywhere>(shape);
  if (!along_grid && grid::radial_exponent(cells.geometry) == 0) {
    for (int d = 1; d < cells.dims; ++d) {
      Index3 const axes = cells.dims == 2 ? Index3{1, 0, 2} : d == 1 ? Index3{1, 2, 0} : Index3{2, 0, 1};
      SubCells seen = cells;
      for (int e = 0; e < 3; ++e) {
        seen.corner[e] = cells.corner[axes[e]];
        seen.first[e] = cells.first[axes[e]];
        seen.count[e] = cells.count[axes[e]];
      }
      fill_by_lines(turned(shape, axes), seen);
      for_each_cell(cells.all(), [&](Index3 const& at) {
        cells.filled[cells.index(at)] += seen.filled[seen.index({at[axes[0]], at[axes[1]], at[axes[2]]})];
      });
    }
    for (double& f : cells.filled) f /= cells.dims;
  }
  for (double& f : cells.filled) {
    if (f < on_face) f = 0.0;
    if (f > 1.0 - on_face) f = 1.0;
  }
}

enum class Fate : std::uint8_t { empty, full, part, remnant };

/// Calls use(index, squared distance in sub-cells) for the neighbours of a sub-cell, corners included.
template <typename Use>
void for_neighbours(SubCells const& cells, Index3 const& at, Use const& use) {
  for_each_cell(common(grid::around(at, 1, 3), cells.all()), [&](Index3 const& other) {
    int distance = 0;
    for (int d = 0; d < 3; ++d) distance += (other[d] - at[d]) * (other[d] - at[d]);
    if (distance > 0) use(cells.index(other), distance);
  });
}

/// Calls use(index, place in `filled`) for all sub-cells.
template <typename Use>
void for_all(SubCells const& cells, Use const& use) {
  for_each_cell(cells.all(), [&](Index3 const& at) { use(at, cells.index(at)); });
}

/// Which sub-cells become particles, and the volume of each.
std::vector<Fate> share_out(SubCells const& cells, std::vector<double>& volumes) {
  std::vector<Fate> fate(cells.filled.size());
  std::vector<Index3> remnants;
  for_all(cells, [&](Index3 const& at, std::size_t n) {
    double const f = cells.filled[n];
    fate[n] = f <= 0.0                       ? Fate::empty
              : f >= 1.0                     ? Fate::full
              : f > smallest_share + on_face ? Fate::part
                                             : Fate::remnant;
    if (fate[n] == Fate::remnant) remnants.push_back(at);
  });
  auto const is_particle = [&](std::size_t n) { return fate[n] == Fate::full || fate[n] == Fate::part; };
  // A sheet thinner than a quarter of a sub-cell has nothing but remnants: those that are not much smaller than all
  // around them stay.
  std::vector<std::size_t> stay;
  for (Index3 const& at : remnants) {
    bool alone = true;
    double most = 0.0;
    for_neighbours(cells, at, [&](std::size_t n, int) {
      alone = alone && !is_particle(n);
      most = std::max(most, cells.filled[n]);
    });
    std::size_t const n = cells.index(at);
    if (alone && cells.filled[n] >= 0.5 * most - on_face) stay.push_back(n);
  }
  for (std::size_t const n : stay) fate[n] = Fate::part;
  volumes.resize(cells.filled.size());
  for_all(cells, [&](Index3 const& at, std::size_t n) {
    double const whole = cells.volume(at[0]);
    volumes[n] = fate[n] == Fate::full ? whole : is_particle(n) ? cells.filled[n] * whole : 0.0;
  });
  for (Index3 const& at : remnants) {
    std::size_t const n = cells.index(at);
    if (fate[n] != Fate::remnant) continue;
    double const left = cells.filled[n] * cells.volume(at[0]);
    int nearest = 4;
    int heirs = 0;
    for_neighbours(cells, at, [&](std::size_t m, int distance) {
      if (!is_particle(m) || distance > nearest) return;
      heirs = distance < nearest ? 1 : heirs + 1;
      nearest = distance;
    });
    // What has no heir is made good by the scaling.
    for_neighbours(cells, at, [&](std::size_t m, int distance) {
      if (is_particle(m) && distance == nearest) volumes[m] += left / heirs;
    });
  }
  return fate;
}

/// Volume of the part of a shape in the domain where a closed form gives it. The domain's faces may halve a shape.
std::optional<double> closed_volume(Shape const& shape, grid::Domain const& domain) {
  grid::Geometry const g = domain.geometry;
  int const dims = domain.dimensions();
  double const slack = on_face * domain.smallest_cell();
  Box const box = bounds(shape);
  if (std::holds_alternative<Box>(shape) || std::holds_alternative<Everywhere>(shape)) {
    Box part = box;
    for (int d = 0; d < dims; ++d) {
      part.lower[d] = std::max(box.lower[d], domain.lower[d]);
      part.upper[d] = std::min(box.upper[d], domain.upper(d));
      if (part.upper[d] <= part.lower[d]) return 0.0;
    }
    return volume(part, g);
  }
  if (dims == 1 || std::holds_alternative<std::shared_ptr<Combination const>>(shape) ||
      std::holds_alternative<HalfSpace>(shape))
    return std::nullopt;
  bool const mesh = std::holds_alternative<Mesh>(shape);
  if (mesh && dims < 3) return std::nullopt;
  bool upright = true;  // mirrored in every plane through its centre along the grid
  auto const is_along = [](Vec3 const& axis, int d) { return std::abs(std::abs(axis[d]) - 1.0) < 1e-12; };
  if (auto const* half = std::get_if<Hemisphere>(&shape))
    upright = is_along(half->normal, 0) || is_along(half->normal, 1) || is_along(half->normal, 2);
  if (auto const* cylinder = std::get_if<Cylinder>(&shape)) {
    auto const along = [&](int d) { return is_along(cylinder->axis, d); };
    upright = along(0) || along(1) || along(2);
    if (g == grid::Geometry::planar2d && !along(2)) return std::nullopt;
    if (g == grid::Geometry::axisymmetric2d && !along(1)) return std::nullopt;
  }
  if (auto const* half = std::get_if<Hemisphere>(&shape);
      half != nullptr && dims == 2 && std::abs(half->normal[2]) > 0.5)
    return std::nullopt;
  Vec3 const middle = centre(shape);
  double images = 1.0;
  for (int d = 0; d < dims; ++d) {
    if (d == 0 && grid::radial_exponent(g) > 0) {
      // The closed forms are those of bodies around the axis; beside it they are rings.
      if (std::abs(middle[0]) > slack || std::abs(domain.lower[0]) > slack || box.upper[0] > domain.upper(0) + slack)
        return std::nullopt;
      if (auto const* half = std::get_if<Hemisphere>(&shape); half != nullptr && std::abs(half->normal[1]) < 0.5)
        return std::nullopt;
      continue;
    }
    for (int face = 0; face < 2; ++face) {
      double const plane = face == 0 ? domain.lower[d] : domain.upper(d);
      double const beyond = face == 0 ? plane - box.lower[d] : box.upper[d] - plane;
      if (beyond <= slack) continue;
      if (mesh || !upright || std::abs(middle[d] - plane) > slack) return std::nullopt;
      if (auto const* half = std::get_if<Hemisphere>(&shape); half != nullptr && std::abs(half->normal[d]) > 0.5)
        return std::nullopt;
      images *= 2.0;
    }
  }
  return volume(shape, g) / images;
}

}  // namespace

double volume_inside(Shape const& shape, grid::Domain const& domain) {
  if (auto const closed = closed_volume(shape, domain)) return *closed;
  int const dims = domain.dimensions();
  Box box = bounds(shape);
  for (int d = 0; d < dims; ++d) {
    box.lower[d] = std::max(box.lower[d], domain.lower[d]);
    box.upper[d] = std::min(box.upper[d], domain.upper(d));
  }
  return volume_within(shape, domain.geometry, box);
}

Placement place_particles(Shape const& shape, grid::Domain const& domain, int per_direction) {
  if (per_direction < 1 || per_direction > 64)
    throw InputError(fmt::format("{} particles per cell and direction: give 1 to 64", per_direction));
  Placement placement;
  SubCells cells = sub_cells(shape, domain, per_direction);
  if (cells.count[0] == 0 || cells.count[1] == 0 || cells.count[2] == 0) return placement;
  fill(shape, cells);
  double sampled = 0.0;
  for_all(cells, [&](Index3 const& at, std::size_t n) { sampled += cells.filled[n] * cells.volume(at[0]); });
  std::vector<double> volumes;
  std::vector<Fate> const fate = share_out(cells, volumes);
  double const known = volume_inside(shape, domain);
  placement.volume = known > 0.0 ? known : sampled;

  // Full sub-cells keep their volume, the others make up for the rest.
  double full = 0.0;
  double part = 0.0;
  auto const untouched = [&](int i, std::size_t n) { return fate[n] == Fate::full && volumes[n] == cells.volume(i); };
  for_all(cells, [&](Index3 const& at, std::size_t n) { (untouched(at[0], n) ? full : part) += volumes[n]; });
  double const factor = part > 0.0 ? (placement.volume - full) / part : 1.0;
  // Bodies along the grid are exact as they are; where the parts cannot make it up, all are scaled.
  bool const exact = std::abs(full + part - placement.volume) <= 1e-12 * placement.volume;
  bool const by_parts = factor > 0.5 && factor < 2.0;
  double const whole = full + part > 0.0 ? placement.volume / (full + part) : 1.0;

  // Cell by cell of the domain, sub-cell by sub-cell in each.
  Index3 each{1, 1, 1};
  CellRange touched;
  for (int d = 0; d < 3; ++d) {
    if (d < cells.dims) each[d] = per_direction;
    touched.lower[d] = cells.first[d] / each[d];
    touched.upper[d] = (cells.first[d] + cells.count[d] - 1) / each[d] + 1;
  }
  for_each_cell(touched, [&](Index3 const& cell) {
    CellRange within;
    for (int d = 0; d < 3; ++d) {
      within.lower[d] = cell[d] * each[d] - cells.first[d];
      within.upper[d] = within.lower[d] + each[d];
    }
    for_each_cell(common(within, cells.all()), [&](Index3 const& at) {
      std::size_t const n = cells.index(at);
      if (fate[n] != Fate::full && fate[n] != Fate::part) return;
      Vec3 x = domain.centre(cell);
      for (int d = 0; d < cells.dims; ++d) x[d] = domain.lower[d] + (cells.first[d] + at[d] + 0.5) * cells.size;
      double const scale = exact ? 1.0 : !by_parts ? whole : untouched(at[0], n) ? 1.0 : factor;
      placement.positions.push_back(x);
      placement.volumes.push_back(scale * volumes[n]);
    });
  });
  return placement;
}

}  // namespace brisance::shape
