#include "grid/exchange_plan.hpp"

#include "grid/bundle.hpp"

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
  if (block.beyond[t.face] == Beyond::coarser) {
    t.kind = TransferKind::finer;
    t.source = coarser_block_beyond(grid, block, t.face);
    return t;
  }
  if (block.beyond[t.face] == Beyond::nothing) {
    // Cells so deep below finer ones that nobody reads them before they become means of those again.
    t.kind = TransferKind::repeat;
    t.source = block.number;
    t.from = layers_at(block, direction, side, 1);
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

/// The block that follows in the chain; `no_neighbour`: the chain ends.
int next_in_chain(Grid const& grid, Block const& block, int direction, int bundle_cells) {
  int const other = block.neighbour[2 * direction + 1];
  if (bundle_cells == 0 || other == no_neighbour) return no_neighbour;
  Block const& next = grid.blocks()[other];
  bool const behind = next.in_domain().lower[direction] == block.in_domain().upper[direction];  // else: periodic
  if (!behind) return no_neighbour;
  // Chains of few bundles would leave threads without work.
  constexpr int least_bundles = 8;
  Bundles const bundles(block, direction, bundle_cells);
  return bundles.count() >= least_bundles && bundles.match(Bundles(next, direction, bundle_cells)) ? other
                                                                                                   : no_neighbour;
}

}  // namespace

CellRange ghost_box(Block const& block, int direction) {
  CellRange box = block.interior();
  box.upper[direction] = ghost_layers;
  return box;
}

ExchangePlan::ExchangePlan(Grid const& grid, int bundle_cells) {
  for (int direction = 0; direction < grid.domain().dimensions(); ++direction) {
    first_[direction].push_back(0);
    for (Block const& block : grid.blocks()) {
      for (int side = 0; side < 2; ++side)
        transfers_[direction].push_back(transfer_across(grid, block, direction, side));
      first_[direction].push_back(transfers_[direction].size());
    }
    make_chains(grid, direction, bundle_cells);
  }
}

void ExchangePlan::make_chains(Grid const& grid, int direction, int bundle_cells) {
  auto const& blocks = grid.blocks();
  std::vector<int> next(blocks.size());
  std::vector<std::uint8_t> begins(blocks.size(), 1);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    next[b] = next_in_chain(grid, blocks[b], direction, bundle_cells);
    if (next[b] == no_neighbour) continue;
    begins[next[b]] = 0;
    transfers_[direction][first_[direction][b] + 1].kind = TransferKind::none;
    transfers_[direction][first_[direction][next[b]]].kind = TransferKind::none;
  }
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (begins[b] == 0) continue;
    Chain chain;
    for (int at = static_cast<int>(b); at != no_neighbour; at = next[at]) chain.push_back(at);
    chains_[direction].push_back(std::move(chain));
  }
}

}  // namespace brisance::grid
