#include "grid/exchange_plan.hpp"

namespace brisance::grid {

namespace {

/// So many layers of the block's cells at its low (side 0) or high (1) face in a direction.
CellRange layers_at(Block const& block, int direction, int side, int layers) {
  CellRange box = block.interior();
  if (side == 0)
    box.upper[direction] = layers;
  else
    box.lower[direction] = block.n[direction] - layers;
  return box;
}

Transfer transfer_across(Grid const& grid, Block const& block, int direction, int side) {
  Transfer t;
  t.face = 2 * direction + side;
  t.to = ghost_box(block, direction);
  if (int const other = block.neighbour[t.face]; other != no_neighbour) {
    t.kind = TransferKind::copy;
    t.source = other;
    t.from = layers_at(grid.blocks()[other], direction, 1 - side, ghost_layers);
    return t;
  }
  Boundary const boundary = grid.domain().boundary[t.face];
  if (is_given(boundary)) {
    t.kind = TransferKind::fill;
    return t;
  }
  t.kind = is_mirror(boundary) ? TransferKind::mirror : TransferKind::repeat;
  t.source = block.number;
  t.from = layers_at(block, direction, side, t.kind == TransferKind::mirror ? ghost_layers : 1);
  return t;
}

}  // namespace

CellRange ghost_box(Block const& block, int direction) {
  CellRange box = block.interior();
  box.upper[direction] = ghost_layers;
  return box;
}

ExchangePlan::ExchangePlan(Grid const& grid) {
  for (int direction = 0; direction < grid.domain().dimensions(); ++direction) {
    first_[direction].push_back(0);
    for (Block const& block : grid.blocks()) {
      for (int side = 0; side < 2; ++side)
        transfers_[direction].push_back(transfer_across(grid, block, direction, side));
      first_[direction].push_back(transfers_[direction].size());
    }
  }
}

}  // namespace brisance::grid
