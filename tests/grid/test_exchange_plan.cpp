/// The list of what an exchange does.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace brisance::grid
