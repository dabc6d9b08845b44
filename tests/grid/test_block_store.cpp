/// Data of blocks that come, go and change their numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/buffer.hpp"
#include "grid/block_store.hpp"
#include "grid/exchange.hpp"
#include "grid/fields.hpp"

namespace brisance::grid {
namespace {

Grid row_of_blocks(int count, int cells = 4) {
  Domain domain;
  domain.geometry = Geometry::planar1d;
  domain.cells = {count * cells, 1, 1};
  return Grid(domain, cells);
}

/// A value that cannot be copied, and tells the block that it was made for.
struct Mark {
  Buffer data;
  [[nodiscard]] double of() const { return data[0]; }
};

BlockStore<Mark> marks(Grid const& grid, double offset = 0.0) {
  return {grid, [offset](Block const& block) {
            Mark mark{Buffer(1)};
            mark.data[0] = block.number + offset;
            return mark;
          }};
}

std::vector<double> values(BlockStore<Mark> const& store) {
  std::vector<double> all;
  for (Mark const& mark : store) all.push_back(mark.of());
  return all;
}

TEST(BlockStore, HoldsOneValueForEachBlock) {
  Grid const grid = row_of_blocks(3);
  ASSERT_EQ(grid.block_count(), 3);
  EXPECT_EQ(values(marks(grid)), (std::vector<double>{0, 1, 2}));
  AwakeBlocks const awake(grid, 1);
  EXPECT_EQ(awake.size(), 3U);
  EXPECT_EQ(awake[2], 1);
}

TEST(BlockStore, AddsDropsAndMovesBlocks) {
  Grid const grid = row_of_blocks(5);
  BlockStore<Mark> store = marks(grid);
  store.move(0, 3);
  EXPECT_EQ(values(store), (std::vector<double>{1, 2, 3, 0, 4}));
  store.move(3, 0);
  EXPECT_EQ(values(store), (std::vector<double>{0, 1, 2, 3, 4}));
  store.move(2, 2);
  EXPECT_EQ(values(store), (std::vector<double>{0, 1, 2, 3, 4}));
  store.drop(1);
  EXPECT_EQ(values(store), (std::vector<double>{0, 2, 3, 4}));
  Block block = grid.blocks()[0];
  block.number = 2;
  store.add(block);
  EXPECT_EQ(values(store), (std::vector<double>{0, 2, 2, 3, 4}));
  block.number = 5;  // behind the last
  store.add(block);
  EXPECT_EQ(values(store), (std::vector<double>{0, 2, 2, 3, 4, 5}));
}

TEST(BlockStore, ARearrangementIsManyMovesAtOnce) {
  Grid const grid = row_of_blocks(6);
  BlockStore<Mark> store = marks(row_of_blocks(4), 10.0);
  double const* where = store[3].data.data();
  store.rearrange(grid.blocks(), {3, no_neighbour, 0, 1, no_neighbour, no_neighbour});
  EXPECT_EQ(values(store), (std::vector<double>{13, 11, 10, 11, 14, 15}));
  EXPECT_EQ(store[0].data.data(), where);  // moved, not copied
}

TEST(BlockStore, FieldsFollowTheirBlocks) {
  Grid const grid = row_of_blocks(3);
  Fields fields(grid, 2);
  for (Block const& block : grid.blocks()) {
    for (int c = 0; c < 2; ++c) std::fill_n(fields.at(block.number, c), block.cell_count(), 10.0 * block.number + c);
  }
  fields.rearrange(grid.blocks(), {2, no_neighbour, 0});
  for (int c = 0; c < 2; ++c) {
    for (int n = 0; n < 4; ++n) {
      EXPECT_EQ(fields.at(0, c)[n], 20.0 + c);
      EXPECT_EQ(fields.at(1, c)[n], 0.0);
      EXPECT_EQ(fields.at(2, c)[n], 0.0 + c);
    }
  }
}

/// A grid is cut anew into blocks half as long: the exchange finds its neighbours again.
TEST(BlockStore, AnExchangeFollowsTheBlocks) {
  Grid grid = row_of_blocks(2, 8);
  ExchangeRules rules;
  rules.quiescent = {0.0};
  Exchange exchange(grid, 1, rules);
  grid = row_of_blocks(4, 4);
  exchange.follow_blocks({no_neighbour, no_neighbour, no_neighbour, no_neighbour});
  Fields fields(grid, 1);
  for (Block const& block : grid.blocks())
    std::iota(fields.at(block.number, 0), fields.at(block.number, 0) + 4, block.origin[0]);
  AwakeBlocks awake(grid, 1);
  exchange.fill(fields, 0, awake);
  for (Block const& block : grid.blocks()) {
    for (int side = 0; side < 2; ++side) {
      for (int l = 0; l < ghost_layers; ++l) {
        int const cell = block.origin[0] + (side == 0 ? l - ghost_layers : block.n[0] + l);
        EXPECT_EQ(exchange.ghosts(block.number, side)[l], std::clamp(cell, 0, 15));
      }
    }
  }
}

}  // namespace
}  // namespace brisance::grid
