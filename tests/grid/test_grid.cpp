/// The grid's blocks and the exchange between them, against a slow and obvious look-up by domain index.
#include <gtest/gtest.h>

#include <set>

#include "core/error.hpp"
#include "grid/exchange.hpp"
#include "grid/grid.hpp"

namespace brisance::grid {
namespace {

Domain box(Index3 cells, Boundary boundary) {
  Domain domain;
  domain.cells = cells;
  domain.h = 0.5;
  domain.boundary.fill(boundary);
  return domain;
}

TEST(Grid, EveryCellLiesInExactlyOneBlock) {
  Grid const grid(box({37, 20, 9}, Boundary::outflow), 8);
  std::set<Index3> seen;
  for (int b = 0; b < grid.block_count(); ++b) {
    Block const& block = grid.blocks()[b];
    for (int d = 0; d < 3; ++d) EXPECT_LE(block.n[d], 8);
    for (int k = 0; k < block.n[2]; ++k) {
      for (int j = 0; j < block.n[1]; ++j) {
        for (int i = 0; i < block.n[0]; ++i) {
          Index3 const cell{block.origin[0] + i, block.origin[1] + j, block.origin[2] + k};
          EXPECT_TRUE(seen.insert(cell).second);
          EXPECT_EQ(grid.block_of(cell), b);
        }
      }
    }
  }
  EXPECT_EQ(static_cast<long>(seen.size()), grid.domain().cell_count());
}

TEST(Grid, RefusesDirectionsThatAreTooThin) { EXPECT_THROW(Grid(box({3, 20, 20}, Boundary::outflow), 8), InputError); }

TEST(Grid, FindsTheCellOfAPoint) {
  Grid const grid(box({10, 10, 10}, Boundary::outflow), 8);
  EXPECT_EQ(grid.cell_at({0.6, 4.9, 2.5}), (Index3{1, 9, 5}));
  EXPECT_EQ(grid.cell_at({-7.0, 99.0, 0.0}), (Index3{0, 9, 0}));
}

TEST(Domain, VolumesAndAreasOfAShellAddUp) {
  for (Geometry geometry : {Geometry::planar1d, Geometry::cylindrical1d, Geometry::spherical1d}) {
    Domain domain = box({20, 1, 1}, Boundary::outflow);
    domain.geometry = geometry;
    double volume = 0.0;
    for (int i = 0; i < 20; ++i) {
      volume += domain.cell_volume(i);
      // The volume grows by the area at the mean radius: exact to second order, here checked against its bounds.
      EXPECT_GE(domain.cell_volume(i), domain.face_area(0, i) * domain.h);
      EXPECT_LE(domain.cell_volume(i), domain.face_area(0, i + 1) * domain.h * (1.0 + 1e-12));
    }
    double const r = 10.0;
    double const whole = geometry == Geometry::planar1d        ? r
                         : geometry == Geometry::cylindrical1d ? std::numbers::pi * r * r
                                                               : 4.0 / 3.0 * std::numbers::pi * r * r * r;
    EXPECT_NEAR(volume / whole, 1.0, 1e-13);
  }
}

/// A value that tells component and place.
double tag(int component, Index3 const& cell) {
  return 1000.0 * component + cell[0] + 0.01 * cell[1] + 0.0001 * cell[2] + 5.0;
}

class Exchanged : public testing::TestWithParam<Boundary> {};

TEST_P(Exchanged, GhostsAreTheImagesOfTheirCells) {
  constexpr int components = 4;
  Grid const grid(box({20, 13, 10}, GetParam()), 6);
  ExchangeRules rules;
  rules.mirrored_component = {1, 2, 3};
  rules.quiescent.assign(components, 0.0);
  for (auto& values : rules.inflow) values = {7.0, 8.0, 9.0, 10.0};
  Exchange exchange(grid, components, rules);
  Fields fields(grid, components);
  for (int b = 0; b < grid.block_count(); ++b) {
    Block const& block = grid.blocks()[b];
    for (int c = 0; c < components; ++c) {
      for (int at = 0; at < block.cell_count(); ++at) {
        Index3 const cell{block.origin[0] + at % block.n[0], block.origin[1] + at / block.n[0] % block.n[1],
                          block.origin[2] + at / (block.n[0] * block.n[1])};
        fields.at(b, c)[at] = tag(c, cell);
      }
    }
  }
  std::vector<std::uint8_t> awake(grid.block_count(), 1);
  for (int direction = 0; direction < 3; ++direction) {
    exchange.fill(fields, direction, awake);
    for (int b = 0; b < grid.block_count(); ++b) {
      Block const& block = grid.blocks()[b];
      Index3 n = block.n;
      n[direction] = ghost_layers;
      for (int side = 0; side < 2; ++side) {
        for (int c = 0; c < components; ++c) {
          double const* ghost = exchange.ghosts(b, side) + static_cast<long>(c) * n[0] * n[1] * n[2];
          for (int k = 0; k < n[2]; ++k) {
            for (int j = 0; j < n[1]; ++j) {
              for (int i = 0; i < n[0]; ++i) {
                Index3 cell{block.origin[0] + i, block.origin[1] + j, block.origin[2] + k};
                cell[direction] += side == 0 ? -ghost_layers : block.n[direction];
                bool const outside = cell[direction] < 0 || cell[direction] >= grid.domain().cells[direction];
                double expected = tag(c, image_cell(grid.domain(), cell));
                if (outside && GetParam() == Boundary::inflow) expected = rules.inflow[2 * direction + side][c];
                if (outside && GetParam() == Boundary::wall && c == rules.mirrored_component[direction])
                  expected = -expected;
                ASSERT_EQ(ghost[i + n[0] * (j + n[1] * k)], expected);
              }
            }
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Boundaries, Exchanged,
                         testing::Values(Boundary::outflow, Boundary::wall, Boundary::inflow, Boundary::periodic));

TEST(Exchange, WakesASleepingBlockThatSeesNews) {
  Grid const grid(box({24, 8, 8}, Boundary::outflow), 8);
  ExchangeRules rules;
  rules.quiescent = {1.0};
  Exchange exchange(grid, 1, rules);
  Fields fields(grid, 1);
  for (int b = 0; b < grid.block_count(); ++b) std::fill_n(fields.at(b, 0), grid.blocks()[b].cell_count(), 1.0);
  int const first = grid.block_of({0, 0, 0});
  int const second = grid.block_of({8, 0, 0});
  int const third = grid.block_of({16, 0, 0});
  std::vector<std::uint8_t> awake(grid.block_count(), 0);
  awake[first] = 1;
  exchange.fill(fields, 0, awake);
  EXPECT_EQ(awake[second], 0);  // the neighbour is awake but brings nothing new
  Block const& block = grid.blocks()[first];
  fields.at(first, 0)[block.offset(block.n[0] - 1, 3, 4)] = 1.0 + 1e-15;
  exchange.fill(fields, 1, awake);
  EXPECT_EQ(awake[second], 0);  // not in this direction
  exchange.fill(fields, 0, awake);
  EXPECT_EQ(awake[second], 1);
  EXPECT_EQ(awake[third], 0);
}

TEST(Nodes, BehindPeriodicFacesAndMirrorsAreImages) {
  Domain d = box({12, 9, 7}, Boundary::outflow);
  d.boundary[0] = d.boundary[1] = Boundary::periodic;
  d.boundary[2] = Boundary::symmetry;
  d.boundary[3] = Boundary::wall;
  auto const expect = [&](Index3 const& node, Index3 const& index, Vec3 const& sign) {
    NodeImage const image = image_node(d, node);
    EXPECT_EQ(image.index, index);
    EXPECT_EQ(image.sign, sign);
  };
  expect({5, 4, 3}, {5, 4, 3}, {1.0, 1.0, 1.0});
  expect({12, 4, 9}, {0, 4, 9}, {1.0, 1.0, 1.0});  // the last node of a period is the first; open faces change nothing
  expect({-2, 4, -1}, {10, 4, -1}, {1.0, 1.0, 1.0});
  expect({1, 0, 0}, {1, 0, 0}, {1.0, 0.0, 1.0});  // on a mirror nothing goes across
  expect({1, -2, 0}, {1, 2, 0}, {1.0, -1.0, 1.0});
  expect({13, 11, 0}, {1, 7, 0}, {1.0, -1.0, 1.0});
}

TEST(Exchange, GathersCellsByDomainIndex) {
  Grid const grid(box({12, 9, 7}, Boundary::outflow), 5);
  Exchange const exchange(grid, 1, {{-1, -1, -1}, {}, {0.0}});
  Fields fields(grid, 1);
  for (int b = 0; b < grid.block_count(); ++b) std::fill_n(fields.at(b, 0), grid.blocks()[b].cell_count(), b);
  std::vector<double> const values = exchange.gather(fields, {{0, 0, 0}, {11, 8, 6}});
  EXPECT_EQ(values[0], grid.block_of({0, 0, 0}));
  EXPECT_EQ(values[1], grid.block_of({11, 8, 6}));
}

}  // namespace
}  // namespace brisance::grid
