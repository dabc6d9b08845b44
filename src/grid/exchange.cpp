#include "grid/exchange.hpp"

#include <algorithm>

#include "core/parallel.hpp"

namespace brisance::grid {

namespace {

/// A box of cells in an array of extents n.
struct Extent {
  Index3 lower;
  Index3 n;
};

/// Copies a box of one component, x fastest, into `to` (dense), with cells reversed along `reverse` when it is 0, 1
/// or 2.
void copy_box(double const* from, Index3 const& n, Extent const& box, int reverse, double sign, double* to) {
  for (int k = 0; k < box.n[2]; ++k) {
    for (int j = 0; j < box.n[1]; ++j) {
      int const kk = box.lower[2] + (reverse == 2 ? box.n[2] - 1 - k : k);
      int const jj = box.lower[1] + (reverse == 1 ? box.n[1] - 1 - j : j);
      double const* row =
          from + static_cast<std::ptrdiff_t>(n[0]) * (jj + static_cast<std::ptrdiff_t>(n[1]) * kk) + box.lower[0];
      if (reverse == 0) {
        for (int i = 0; i < box.n[0]; ++i) to[i] = sign * row[box.n[0] - 1 - i];
      } else {
        for (int i = 0; i < box.n[0]; ++i) to[i] = sign * row[i];
      }
      to += box.n[0];
    }
  }
}

}  // namespace

Exchange::Exchange(Grid const& grid, int components, ExchangeRules rules)
    : grid_(&grid), components_(components), rules_(std::move(rules)) {
  int const dims = grid.domain().dimensions();
  for (Block const& block : grid.blocks()) {
    int face_cells = 0;
    for (int d = 0; d < dims; ++d) face_cells = std::max(face_cells, block.cell_count() / block.n[d]);
    for (int side = 0; side < 2; ++side) {
      slabs_.emplace_back(static_cast<std::size_t>(face_cells) * ghost_layers * components);
    }
  }
}

void Exchange::fill_side(Fields const& fields, int b, int direction, int side) {
  Block const& block = grid_->blocks()[b];
  int const face = 2 * direction + side;
  int const other = block.neighbour[face];
  Index3 slab_n = block.n;
  slab_n[direction] = ghost_layers;
  int const count = slab_n[0] * slab_n[1] * slab_n[2];
  double* slab = slabs_[2 * b + side].data();

  if (other != no_neighbour) {
    Block const& source = grid_->blocks()[other];
    Extent box{{0, 0, 0}, slab_n};
    box.lower[direction] = side == 0 ? source.n[direction] - ghost_layers : 0;
    for (int c = 0; c < components_; ++c) copy_box(fields.at(other, c), source.n, box, -1, 1.0, slab + c * count);
    return;
  }
  switch (grid_->domain().boundary[face]) {
    case Boundary::wall:
    case Boundary::symmetry: {
      Extent box{{0, 0, 0}, slab_n};
      box.lower[direction] = side == 0 ? 0 : block.n[direction] - ghost_layers;
      for (int c = 0; c < components_; ++c) {
        double const sign = c == rules_.mirrored_component[direction] ? -1.0 : 1.0;
        copy_box(fields.at(b, c), block.n, box, direction, sign, slab + c * count);
      }
      return;
    }
    case Boundary::inflow:
      for (int c = 0; c < components_; ++c) std::fill_n(slab + c * count, count, rules_.inflow[face][c]);
      return;
    default: {  // open: every layer repeats the cell next to the face
      Index3 layer_n = block.n;
      layer_n[direction] = 1;
      Extent box{{0, 0, 0}, layer_n};
      box.lower[direction] = side == 0 ? 0 : block.n[direction] - 1;
      std::vector<double> layer(static_cast<std::size_t>(layer_n[0]) * layer_n[1] * layer_n[2]);
      for (int c = 0; c < components_; ++c) {
        copy_box(fields.at(b, c), block.n, box, -1, 1.0, layer.data());
        for (int k = 0; k < slab_n[2]; ++k) {
          for (int j = 0; j < slab_n[1]; ++j) {
            for (int i = 0; i < slab_n[0]; ++i) {
              int const li = direction == 0 ? 0 : i;
              int const lj = direction == 1 ? 0 : j;
              int const lk = direction == 2 ? 0 : k;
              slab[c * count + i + slab_n[0] * (j + slab_n[1] * k)] = layer[li + layer_n[0] * (lj + layer_n[1] * lk)];
            }
          }
        }
      }
      return;
    }
  }
}

bool Exchange::slab_is_quiescent(int b, int direction, int side) const {
  Block const& block = grid_->blocks()[b];
  int const count = block.cell_count() / block.n[direction] * ghost_layers;
  double const* slab = slabs_[2 * b + side].data();
  for (int c = 0; c < components_; ++c) {
    double const value = rules_.quiescent[c];
    if (std::any_of(slab + c * count, slab + (c + 1) * count, [value](double x) { return x != value; })) return false;
  }
  return true;
}

bool Exchange::disturbs(int face) const {
  switch (grid_->domain().boundary[face]) {
    case Boundary::wall:
    case Boundary::symmetry: {
      int const mirrored = rules_.mirrored_component[face / 2];
      return mirrored >= 0 && rules_.quiescent[mirrored] != 0.0;
    }
    case Boundary::inflow: return rules_.inflow[face] != rules_.quiescent;
    default: return false;  // open faces repeat what is quiescent
  }
}

bool Exchange::anything_to_see(Block const& block, int direction) const {
  for (int face = 2 * direction; face < 2 * direction + 2; ++face) {
    int const other = block.neighbour[face];
    if (other != no_neighbour ? was_awake_[other] != 0 : disturbs(face)) return true;
  }
  return false;
}

void Exchange::fill(Fields const& fields, int direction, std::vector<std::uint8_t>& awake) {
  was_awake_ = awake;
  parallel_for(grid_->block_count(), [&](int b, int) {
    Block const& block = grid_->blocks()[b];
    if (!was_awake_[b] && !anything_to_see(block, direction)) return;
    for (int side = 0; side < 2; ++side) fill_side(fields, b, direction, side);
    if (!was_awake_[b] && !(slab_is_quiescent(b, direction, 0) && slab_is_quiescent(b, direction, 1))) awake[b] = 1;
  });
}

std::vector<double> Exchange::gather(Fields const& fields, std::vector<Index3> const& cells) const {
  std::vector<double> values;
  values.reserve(cells.size() * components_);
  for (Index3 const& cell : cells) {
    int const b = grid_->block_of(cell);
    Block const& block = grid_->blocks()[b];
    int const at = block.offset(cell[0] - block.origin[0], cell[1] - block.origin[1], cell[2] - block.origin[2]);
    for (int c = 0; c < components_; ++c) values.push_back(fields.at(b, c)[at]);
  }
  return values;
}

}  // namespace brisance::grid
