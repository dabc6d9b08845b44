#include "bridge/region.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"

namespace brisance::bridge {

namespace {

void check_box(grid::Domain const& domain, CellBox const& box) {
  for (int d = 0; d < domain.dimensions(); ++d) {
    char const axis = "xyz"[d];
    if (box.lower[d] < 0 || box.upper[d] > domain.cells[d] || box.lower[d] >= box.upper[d]) {
      throw InputError(fmt::format("the MPM region is empty or extends beyond the domain in {}", axis));
    }
    for (int side = 0; side < 2; ++side) {
      int const gap = side == 0 ? box.lower[d] : domain.cells[d] - box.upper[d];
      grid::Boundary const boundary = domain.boundary[2 * d + side];
      if (gap > 0 && gap < least_gap) {
        throw InputError(
            fmt::format("the MPM region ends {} cells from the boundary {} of the domain; it must touch the boundary "
                        "or leave at least {} cells of gas",
                        gap, grid::face_names[2 * d + side], least_gap));
      }
      if (gap == 0 && grid::is_given(boundary)) {
        throw InputError(fmt::format("the MPM region must not touch the {} boundary {}; leave at least {} cells of gas",
                                     word_of(boundary), grid::face_names[2 * d + side], least_gap));
      }
      if (gap == 0 && boundary == grid::Boundary::periodic && box.upper[d] - box.lower[d] != domain.cells[d]) {
        throw InputError(
            fmt::format("the MPM region touches the periodic boundary {} but does not span the domain in {}",
                        grid::face_names[2 * d + side], axis));
      }
    }
  }
}

}  // namespace

int Region::layer(Index3 const& cell) const { return space_.contains(cell) ? layers_[at(cell)] : 0; }

grid::Cell Region::locate(grid::Grid const& grid, Index3 const& cell) const {
  auto const found = grid.locate(level_, cell);
  if (found && !grid.block(*found).is_covered(*found)) return *found;
  Vec3 const x = domain_.centre(cell);
  throw InputError(
      fmt::format("the gas at the MPM region near ({:.6g}, {:.6g}, {:.6g}) m has other cells than those of {:.6g} m of "
                  "the region: give mpm_region.cell the size of the finest cells nearby, or move the refinement away",
                  x[0], x[1], x[2], domain_.smallest_cell()));
}

gas::Role Region::role(Index3 const& cell) const {
  int const l = layer(cell);
  if (l == 0) return gas::Role::own;
  return l <= width_ + 2 ? gas::Role::shadow : gas::Role::frozen;
}

Index3 Region::clamped(Index3 cell) const {
  for (int d = 0; d < domain_.dimensions(); ++d) cell[d] = std::clamp(cell[d], 0, domain_.cells[d] - 1);
  return cell;
}

Region::Region(grid::Domain const& domain, std::vector<CellBox> boxes, int width, int proxy_layers, int level)
    : domain_(domain), boxes_(std::move(boxes)), level_(level), width_(width) {
  if (boxes_.empty()) throw InputError("an MPM region needs at least one box");
  if (width < 1) throw InputError("the bridge must be at least 1 cell wide");
  CellBox hull = boxes_.front();
  for (CellBox const& box : boxes_) {
    check_box(domain, box);
    for (int d = 0; d < domain.dimensions(); ++d) {
      hull.lower[d] = std::min(hull.lower[d], box.lower[d]);
      hull.upper[d] = std::max(hull.upper[d], box.upper[d]);
    }
  }
  frame(hull, proxy_layers);
  find_layers(boxes_);
  int const deepest = list_cells();
  if (std::any_of(faces_.begin(), faces_.end(), [](Face const& f) { return !f.open; }) && deepest < width + 3) {
    throw InputError(
        fmt::format("the MPM region is too thin: with a bridge {} cells wide it needs at least {} cells between two "
                    "bridges and {} between a bridge and a boundary",
                    width, 2 * width + 5, width + 3));
  }
  list_proxy_cells(proxy_layers);
}

/// The background grid of the particles.
void Region::frame(CellBox const& hull, int proxy_layers) {
  particles_domain_ = domain_;
  for (int d = 0; d < domain_.dimensions(); ++d) {
    std::array<int, 2> margin{};
    for (int side = 0; side < 2; ++side) {
      bool const at_boundary = side == 0 ? hull.lower[d] == 0 : hull.upper[d] == domain_.cells[d];
      bool const closed = at_boundary && grid::has_images(domain_.boundary[2 * d + side]);
      margin[side] = closed ? 0 : proxy_layers;
      if (!closed) particles_domain_.boundary[2 * d + side] = grid::Boundary::outflow;
    }
    space_.lower[d] = hull.lower[d] - margin[0];
    space_.upper[d] = hull.upper[d] + margin[1];
    shift_[d] = -space_.lower[d];
    particles_domain_.lower[d] = domain_.face(d, space_.lower[d]);
    particles_domain_.cells[d] = space_.n(d);
  }
}

/// Layers by Chebyshev distance from the cells outside.
void Region::find_layers(std::vector<CellBox> const& boxes) {
  int const dims = domain_.dimensions();
  std::uint8_t const deep = static_cast<std::uint8_t>(width_ + 5);
  layers_.assign(space_.count(), 0);
  for (CellBox const& box : boxes) for_each_cell(box, [&](Index3 const& cell) { layers_[at(cell)] = deep; });
  auto const any_around = [&](Index3 const& cell, auto&& test) {
    return any_cell(grid::around(cell, 1, dims), [&](Index3 const& c) { return domain_.contains(c) && test(c); });
  };
  // Within a box, away from its faces, all around is region.
  auto const in_the_open = [&](Index3 const& cell) {
    return std::ranges::any_of(boxes, [&](CellBox const& box) { return box.grown(-1, dims).contains(cell); });
  };
  std::vector<Index3> front;
  for_each_cell(space_, [&](Index3 const& cell) {
    if (layers_[at(cell)] != deep || in_the_open(cell)) return;
    if (any_around(cell, [&](Index3 const& c) { return layer(c) == 0; })) front.push_back(cell);
  });
  // Each layer from the one before: what is deep is not looked through again.
  for (int level = 1; level <= width_ + 4; ++level) {
    for (Index3 const& cell : front) layers_[at(cell)] = static_cast<std::uint8_t>(level);
    std::vector<Index3> next;
    for (Index3 const& cell : front) {
      any_around(cell, [&](Index3 const& c) {
        if (!space_.contains(c) || layers_[at(c)] != deep) return false;
        layers_[at(c)] = 0xff;  // taken, so that it comes once
        next.push_back(c);
        return false;
      });
    }
    for (Index3 const& cell : next) layers_[at(cell)] = deep;
    front = std::move(next);
  }
}

/// Lists the region's cells, its ghosts and faces; returns its deepest layer.
int Region::list_cells() {
  int deepest = 0;
  for_each_cell(space_, [&](Index3 const& cell) {
    int const l = layers_[at(cell)];
    deepest = std::max(deepest, l);
    if (l == 0) return;
    cells_.push_back(cell);
    if (l > width_ && l <= width_ + 4) ghosts_.push_back(cell);
    for (int d = 0; d < domain_.dimensions(); ++d) {
      for (int side = 0; side < 2; ++side) {
        Face face{cell, d, side};
        Index3 const outside = face.outside();
        if (inside(outside)) continue;
        if (!domain_.contains(outside)) {
          if (grid::has_images(domain_.boundary[2 * d + side])) continue;
          face.open = true;
        }
        faces_.push_back(face);
      }
    }
  });
  return deepest;
}

/// Lists the cells outside, so many layers of them, that act as particles.
void Region::list_proxy_cells(int proxy_layers) {
  int const dims = domain_.dimensions();
  std::vector<std::uint8_t> near(layers_.size(), 0);  // number of steps that lead to the region
  for (int step = 1; step <= proxy_layers; ++step) {
    std::vector<std::size_t> found;
    for_each_cell(space_, [&](Index3 const& cell) {
      if (layers_[at(cell)] != 0 || near[at(cell)] != 0) return;
      bool const reached = any_cell(grid::around(cell, 1, dims), [&](Index3 const& there) {
        if (!space_.contains(there)) return false;
        return step == 1 ? layers_[at(there)] != 0 : near[at(there)] == step - 1 && layers_[at(there)] == 0;
      });
      if (reached) found.push_back(at(cell));
    });
    for (std::size_t const n : found) near[n] = static_cast<std::uint8_t>(step);
  }
  for_each_cell(space_, [&](Index3 const& cell) {
    if (near[at(cell)] == 0) return;
    // Behind a mirror or a periodic face there are no cells of their own; beyond an open boundary a cell stands for
    // the one of the region, or for the gas cell, that lies next to it.
    bool real = true;
    for (int d = 0; d < dims; ++d) {
      for (int side = 0; side < 2; ++side) {
        bool const beyond = side == 0 ? cell[d] < 0 : cell[d] >= domain_.cells[d];
        if (beyond && grid::has_images(domain_.boundary[2 * d + side])) real = false;
      }
    }
    if (real) proxy_cells_.push_back(cell);
  });
}

}  // namespace brisance::bridge
