#include "grid/exchange.hpp"

#include <algorithm>

#include "core/parallel.hpp"

namespace brisance::grid {

namespace {

/// Copies the cells of a box, which is a part of an array over `all`, into a dense one, with cells reversed along
/// `reverse` when it is 0, 1 or 2.
void copy_box(double const* from, CellRange const& all, CellRange const& box, int reverse, double sign, double* to) {
  int const n = box.n(0);
  for (int k = box.lower[2]; k < box.upper[2]; ++k) {
    for (int j = box.lower[1]; j < box.upper[1]; ++j) {
      int const kk = reverse == 2 ? box.lower[2] + box.upper[2] - 1 - k : k;
      int const jj = reverse == 1 ? box.lower[1] + box.upper[1] - 1 - j : j;
      double const* row = from + all.offset({box.lower[0], jj, kk});
      if (reverse == 0) {
        for (int i = 0; i < n; ++i) to[i] = sign * row[n - 1 - i];
      } else {
        for (int i = 0; i < n; ++i) to[i] = sign * row[i];
      }
      to += n;
    }
  }
}

/// So many layers of the block's cells at its low (side 0) or high (1) face in a direction.
CellRange layers_at(Block const& block, int direction, int side, int layers) {
  CellRange box = block.interior();
  if (side == 0)
    box.upper[direction] = layers;
  else
    box.lower[direction] = block.n[direction] - layers;
  return box;
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
  CellRange const own = layers_at(block, direction, side, ghost_layers);
  auto const count = static_cast<std::ptrdiff_t>(own.count());
  double* slab = slabs_[2 * b + side].data();

  if (other != no_neighbour) {
    Block const& source = grid_->blocks()[other];
    CellRange const box = layers_at(source, direction, 1 - side, ghost_layers);
    for (int c = 0; c < components_; ++c)
      copy_box(fields.at(other, c), source.interior(), box, -1, 1.0, slab + c * count);
    return;
  }
  Boundary const boundary = grid_->domain().boundary[face];
  if (is_mirror(boundary)) {
    for (int c = 0; c < components_; ++c) {
      double const sign = c == rules_.mirrored_component[direction] ? -1.0 : 1.0;
      copy_box(fields.at(b, c), block.interior(), own, direction, sign, slab + c * count);
    }
  } else if (boundary == Boundary::inflow) {
    for (int c = 0; c < components_; ++c) std::fill_n(slab + c * count, count, rules_.inflow[face][c]);
  } else {  // open: every layer repeats the cell next to the face
    CellRange const next = layers_at(block, direction, side, 1);
    std::vector<double> layer(next.count());
    for (int c = 0; c < components_; ++c) {
      copy_box(fields.at(b, c), block.interior(), next, -1, 1.0, layer.data());
      double* to = slab + c * count;
      for_each_cell(own, [&](Index3 cell) {
        cell[direction] = next.lower[direction];
        *to++ = layer[next.offset(cell)];
      });
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
  if (grid_->domain().is_mirror(face)) {
    int const mirrored = rules_.mirrored_component[face / 2];
    return mirrored >= 0 && rules_.quiescent[mirrored] != 0.0;
  }
  if (grid_->domain().boundary[face] == Boundary::inflow) return rules_.inflow[face] != rules_.quiescent;
  return false;  // open faces repeat what is quiescent
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
    Cell const at = grid_->locate(cell);
    for (int c = 0; c < components_; ++c) values.push_back(fields.at(at.block, c)[at.offset]);
  }
  return values;
}

}  // namespace brisance::grid
