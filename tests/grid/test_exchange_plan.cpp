/// The list of what an exchange does.
#include <gtest/gtest.h>

#include <set>

#include "grid/exchange_plan.hpp"

namespace brisance::grid {
namespace {

Domain with_every_boundary() {
  Domain domain;
  domain.cells = {20, 13, 10};
  domain.boundary = {Boundary::inflow,  Boundary::wall,     Boundary::symmetry,
                     Boundary::outflow, Boundary::periodic, Boundary::periodic};
  return domain;
}

TEST(ExchangePlan, FillsEveryGhostCellOnce) {
  Grid const grid(with_every_boundary(), 6);
  ExchangePlan const plan(grid);
  for (int direction = 0; direction < 3; ++direction) {
    for (Block const& block : grid.blocks()) {
      CellRange const slab = ghost_box(block, direction);
      std::array<std::vector<int>, 2> filled{std::vector<int>(slab.count()), std::vector<int>(slab.count())};
      for (Transfer const& t : plan.into(block.number, direction)) {
        EXPECT_EQ(t.face / 2, direction);
        for_each_cell(t.to, [&](Index3 const& cell) { ++filled[t.face % 2][slab.offset(cell)]; });
      }
      for (auto const& side : filled) {
        for (int const times : side) ASSERT_EQ(times, 1);
      }
    }
  }
}

TEST(ExchangePlan, TheKindFollowsFromWhatLiesBeyond) {
  Grid const grid(with_every_boundary(), 6);
  ExchangePlan const plan(grid);
  for (Block const& block : grid.blocks()) {
    for (int direction = 0; direction < 3; ++direction) {
      for (Transfer const& t : plan.into(block.number, direction)) {
        bool const outside = block.at_boundary(t.face);
        TransferKind expected = TransferKind::copy;
        if (outside && t.face == 0) expected = TransferKind::fill;
        if (outside && (t.face == 1 || t.face == 2)) expected = TransferKind::mirror;
        if (outside && t.face == 3) expected = TransferKind::repeat;
        EXPECT_EQ(t.kind, expected);
        if (t.kind == TransferKind::fill) continue;
        EXPECT_EQ(t.source, outside ? block.number : block.neighbour[t.face]);
        // It gives cells that it has, as many as are filled; or one layer of them.
        CellRange const cells = grid.blocks()[t.source].interior();
        EXPECT_EQ(common(t.from, cells).n(), t.from.n());
        Index3 n = t.to.n();
        if (t.kind == TransferKind::repeat) n[direction] = 1;
        EXPECT_EQ(t.from.n(), n);
      }
    }
  }
}

// Every block lies in one chain, behind its neighbour; what the chains link gets no ghost cells, and all else does.
TEST(ExchangePlan, ChainsHoldEveryBlockOnce) {
  Domain domain;
  domain.cells = {64, 48, 40};
  domain.h = 1.0;
  domain.boundary.fill(Boundary::periodic);
  Grid const grid(domain, 16);
  ExchangePlan const plan(grid, 100);
  for (int d = 0; d < 3; ++d) {
    std::set<int> seen;
    int links = 0;
    for (Chain const& chain : plan.chains(d)) {
      for (std::size_t n = 0; n < chain.size(); ++n) {
        EXPECT_TRUE(seen.insert(chain[n]).second);
        bool const goes_on = n + 1 < chain.size();
        EXPECT_EQ(plan.links(chain[n], 2 * d + 1), goes_on);
        EXPECT_EQ(plan.links(chain[n], 2 * d), n > 0);
        links += goes_on ? 1 : 0;
        if (goes_on) {
          EXPECT_EQ(grid.blocks()[chain[n]].neighbour[2 * d + 1], chain[n + 1]);
          EXPECT_GT(grid.blocks()[chain[n + 1]].origin[d], grid.blocks()[chain[n]].origin[d]);
        }
      }
    }
    EXPECT_EQ(seen.size(), grid.blocks().size());
    EXPECT_GT(links, 0);
  }
}

// A row of blocks is no chain: its threads would have one piece of work between them.
TEST(ExchangePlan, ARowOfBlocksIsSharedByThreads) {
  Domain domain;
  domain.geometry = Geometry::planar1d;
  domain.cells = {3000, 1, 1};
  domain.h = 1.0;
  Grid const grid(domain, 256);
  EXPECT_EQ(ExchangePlan(grid, 320).chains(0).size(), grid.blocks().size());
}

}  // namespace
}  // namespace brisance::grid
