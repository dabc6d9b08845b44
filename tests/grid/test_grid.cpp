/// The grid's blocks and the exchange between them, against a slow and obvious look-up by domain index.
#include <gtest/gtest.h>

#include <cmath>
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
    for_each_cell(block, [&](Cell const& cell) {
      EXPECT_TRUE(seen.insert(block.index(cell)).second);
      EXPECT_EQ(grid.block_of(block.index(cell)), b);
    });
  }
  EXPECT_EQ(static_cast<long>(seen.size()), grid.domain().cell_count());
}

// Whatever the domain and the wish: one size, as many blocks as needed, each with its ghost layers.
TEST(Grid, BlocksHaveOneSizeAndTheLastTheRest) {
  for (int const wanted : {0, 4, 5, 8, 11, 32, 64}) {
    for (int const cells : {4, 5, 7, 9, 13, 33, 44, 80, 100, 150, 257}) {
      Domain domain = box({cells, 4, 4}, Boundary::outflow);
      Grid const grid(domain, wanted);
      int const size = grid.block_size()[0];
      int sum = 0;
      for (Block const& block : grid.blocks()) {
        bool const last = block.at_boundary(1);
        EXPECT_EQ(block.size, grid.block_size());
        EXPECT_EQ(block.origin[0] % size, 0);
        EXPECT_GE(block.n[0], 4);
        EXPECT_LE(block.n[0], size);
        if (!last) {
          EXPECT_EQ(block.n[0], size);
        }
        sum += block.n[0];
      }
      EXPECT_EQ(sum, cells);
      // Larger than wanted only where no size up to that leaves the last block 4 cells.
      if (wanted == 0) {
        EXPECT_LE(size, 44);
      }
      if (wanted > 0 && size > wanted) {
        for (int smaller = 4; smaller <= wanted; ++smaller) {
          EXPECT_TRUE(cells % smaller > 0 && cells % smaller < 4) << cells << " cells in blocks of " << smaller;
        }
      }
    }
  }
  // Left to the grid: whole vectors, and columns that do not lie a multiple of 4096 bytes apart.
  EXPECT_EQ(Grid(box({150, 80, 80}, Boundary::outflow)).block_size(), (Index3{40, 40, 40}));
  for (int const n : {64, 96, 128, 256}) {
    Index3 const size = Grid(box({n, n, n}, Boundary::outflow)).block_size();
    EXPECT_NE(size[0] * size[1] % 512, 0) << n;
  }
}

TEST(Grid, RefusesDirectionsThatAreTooThin) { EXPECT_THROW(Grid(box({3, 20, 20}, Boundary::outflow), 8), InputError); }

TEST(Grid, FindsTheCellOfAParticle) {
  Grid const grid(box({10, 10, 10}, Boundary::outflow), 8);
  EXPECT_EQ(grid.cell_at({0.6, 4.9, 2.5}), (Index3{1, 9, 5}));
  EXPECT_EQ(grid.cell_at({-7.0, 99.0, 0.0}), (Index3{0, 9, 0}));
}

TEST(Grid, LocatesEveryCellInItsBlock) {
  Grid const grid(box({37, 20, 9}, Boundary::outflow), 8);
  for (Block const& block : grid.blocks()) {
    int offset = 0;
    for_each_cell(block, [&](Cell const& cell) {
      EXPECT_EQ(cell.offset, offset++);  // in the order of the arrays
      EXPECT_EQ(cell.offset, block.offset(cell.i, cell.j, cell.k));
      Cell const same = block.cell_at(cell.offset);
      EXPECT_EQ(same.within(), cell.within());
      // By its index, and by every corner that rounding may have moved a little.
      Index3 const index = block.index(cell);
      EXPECT_EQ(index, grid.index(cell));
      for (double const part : {1e-9, 0.5, 1.0 - 1e-9}) {
        Vec3 const x{(index[0] + part) * block.h(), (index[1] + part) * block.h(), (index[2] + part) * block.h()};
        for (Cell const& found : {grid.locate(index), grid.locate(x)}) {
          EXPECT_EQ(found.block, block.number);
          EXPECT_EQ(found.within(), cell.within());
          EXPECT_EQ(found.offset, cell.offset);
        }
      }
    });
    EXPECT_EQ(offset, block.cell_count());
  }
}

TEST(Grid, AFaceBetweenBlocksBelongsToTheUpperOne) {
  Grid const grid(box({16, 16, 16}, Boundary::outflow), 8);
  Cell const above = grid.locate(Vec3{8 * 0.5, 1.0, 1.0});
  EXPECT_EQ(above.block, grid.block_of({8, 2, 2}));
  EXPECT_EQ(above.within(), (Index3{0, 2, 2}));
  Cell const below = grid.locate(Vec3{std::nextafter(8 * 0.5, 0.0), 1.0, 1.0});
  EXPECT_EQ(below.block, grid.block_of({7, 2, 2}));
  EXPECT_EQ(below.within(), (Index3{7, 2, 2}));
  EXPECT_EQ(grid.blocks()[below.block].neighbour[1], above.block);
}

TEST(Grid, APlaceOutsideIsLocatedInTheNearestCell) {
  Grid const grid(box({10, 10, 10}, Boundary::outflow), 8);
  EXPECT_EQ(grid.index(grid.locate(Vec3{-7.0, 99.0, 2.6})), (Index3{0, 9, 5}));
  EXPECT_EQ(grid.index(grid.locate(Vec3{5.0, 5.0, 5.0})), (Index3{9, 9, 9}));  // on the high faces
  EXPECT_FALSE(grid.domain().contains({-1, 0, 0}));
  EXPECT_FALSE(grid.domain().contains({0, 10, 0}));
  EXPECT_TRUE(grid.domain().contains({0, 9, 0}));
}

TEST(Grid, GhostsAndFaceCellsOfABlock) {
  Domain flat = box({12, 9, 1}, Boundary::outflow);
  flat.geometry = Geometry::planar2d;
  Grid const plane(flat, 5);
  for (Block const& block : plane.blocks()) {
    CellRange const ghosts = block.with_ghosts();
    EXPECT_EQ(ghosts.n(), (Index3{block.n[0] + 2 * ghost_layers, block.n[1] + 2 * ghost_layers, 1}));
    std::size_t place = 0;
    for_each_cell(ghosts, [&](Index3 const& within) {
      EXPECT_EQ(ghosts.offset(within), place);
      EXPECT_EQ(ghosts.at(place), within);
      ++place;
    });
    EXPECT_EQ(place, ghosts.count());
    for (int d = 0; d < 2; ++d) {
      for (int side = 0; side < 2; ++side) {
        int count = 0;
        for_each_face_cell(block, d, side, [&](Cell const& cell) {
          EXPECT_EQ(cell.within()[d], side == 0 ? 0 : block.n[d] - 1);
          bool const outside = !flat.contains(beside(block.index(cell), d, side));
          EXPECT_EQ(outside, block.at_boundary(2 * d + side));
          ++count;
        });
        EXPECT_EQ(count, block.cell_count() / block.n[d]);
      }
    }
  }
}

TEST(Grid, SumsOfCellsTakeEveryCellOnce) {
  Grid const grid(box({12, 9, 7}, Boundary::outflow), 5);
  long cells = 0;
  for (Block const& block : grid.blocks()) {
    add_cells(block, cells, [](Cell const&, long& row) { ++row; });
    int rows = 0;
    for_each_row(block, [&](Cell const& first) {
      EXPECT_EQ(first.i, 0);
      EXPECT_EQ(first.offset, rows++ * block.n[0]);
    });
  }
  EXPECT_EQ(cells, grid.domain().cell_count());
}

/// A domain of every geometry; the radius begins off the axis.
Domain off_axis(Geometry geometry) {
  Domain domain;
  domain.geometry = geometry;
  domain.h = 0.1;
  domain.lower = {0.7, -0.3, 0.2};
  for (int d = 0; d < domain.dimensions(); ++d) domain.cells[d] = 9 + 2 * d;
  return domain;
}

class Metrics : public testing::TestWithParam<Geometry> {};

/// Volume of the domain from its corners alone.
double whole_volume(Domain const& domain) {
  double const a = domain.lower[0];
  double const b = domain.upper(0);
  double const x = b - a;
  double const y = domain.upper(1) - domain.lower[1];
  switch (domain.geometry) {
    case Geometry::cartesian3d: return x * y * (domain.upper(2) - domain.lower[2]);
    case Geometry::planar2d: return x * y;
    case Geometry::axisymmetric2d: return std::numbers::pi * (b * b - a * a) * y;
    case Geometry::planar1d: return x;
    case Geometry::cylindrical1d: return std::numbers::pi * (b * b - a * a);
    case Geometry::spherical1d: return 4.0 / 3.0 * std::numbers::pi * (b * b * b - a * a * a);
  }
  return 0.0;
}

TEST_P(Metrics, VolumesSumToThatOfTheDomain) {
  Domain const domain = off_axis(GetParam());
  Grid const grid(domain, 4);
  double volume = 0.0;
  for (Block const& block : grid.blocks()) {
    EXPECT_EQ(block.h(), domain.h);
    for_each_cell(block, [&](Cell const& cell) {
      volume += block.volume(cell);
      EXPECT_EQ(block.centre(cell), domain.centre(block.index(cell)));
    });
  }
  EXPECT_NEAR(volume / whole_volume(domain), 1.0, 1e-13);  // the round-off of a thousand terms
}

/// A constant vector has no divergence: what enters a cell through its low faces leaves it through the high ones. Along
/// a radius that holds of r^-m instead; the areas grow by what the volume tells.
TEST_P(Metrics, AreasTimesNormalsClose) {
  Domain const domain = off_axis(GetParam());
  Grid const grid(domain, 4);
  int const m = radial_exponent(GetParam());
  for (Block const& block : grid.blocks()) {
    for_each_cell(block, [&](Cell const& cell) {
      for (int d = 0; d < domain.dimensions(); ++d) {
        double const low = block.face_area(d, 0, cell);
        double const high = block.face_area(d, 1, cell);
        EXPECT_GT(low, 0.0);
        if (d > 0 || m == 0) {
          EXPECT_EQ(low, high);
          EXPECT_NEAR(block.volume(cell) / (low * block.h()), 1.0, 1e-12);
        } else {
          double const a = domain.face_radius(block.index(cell)[0]);
          double const b = a + block.h();
          EXPECT_NEAR(low * std::pow(a, -m) / (high * std::pow(b, -m)), 1.0, 1e-13);
          // The vector x times 1 / (m + 1) has the divergence 1: its flux through the faces is the volume.
          EXPECT_NEAR((high * b - low * a) / (m + 1) / block.volume(cell), 1.0, 1e-12);
        }
      }
      // Faces are shared: the high one of a cell is the low one of the next.
      for (int d = 0; d < domain.dimensions(); ++d) {
        Index3 const next = beside(block.index(cell), d, 1);
        if (!domain.contains(next)) continue;
        Cell const other = grid.locate(next);
        EXPECT_EQ(block.face_area(d, 1, cell), grid.block(other).face_area(d, 0, other));
      }
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Geometries, Metrics,
                         testing::Values(Geometry::cartesian3d, Geometry::planar2d, Geometry::axisymmetric2d,
                                         Geometry::planar1d, Geometry::cylindrical1d, Geometry::spherical1d));

TEST(Grid, ShellsBeyondAMirrorAreTheOnesBeforeIt) {
  Domain domain = off_axis(Geometry::spherical1d);
  domain.lower = {0.0, 0.0, 0.0};
  domain.boundary = {Boundary::symmetry, Boundary::outflow};
  EXPECT_TRUE(domain.is_axis(0));
  EXPECT_TRUE(domain.is_mirror(0));
  EXPECT_FALSE(domain.is_mirror(1));
  Grid const grid(domain, 4);
  Block const& first = grid.blocks().front();
  for (int l = -ghost_layers; l < first.n[0] + ghost_layers; ++l) {
    Shell const shell = grid.shell(first, l);
    int const i = l < 0 ? -1 - l : l;
    EXPECT_EQ(shell.mirrored, l < 0);
    EXPECT_EQ(shell.volume, domain.cell_volume(i));
    EXPECT_EQ(shell.low_area, domain.face_area(0, i));
    EXPECT_EQ(shell.high_area, domain.face_area(0, i + 1));
  }
  Block const& last = grid.blocks().back();
  EXPECT_EQ(grid.shell(last, last.n[0]).volume, domain.cell_volume(domain.cells[0] - 1));  // open: repeats
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
      for_each_cell(block, [&](Cell const& cell) { fields.at(b, c)[cell.offset] = tag(c, block.index(cell)); });
    }
  }
  AwakeBlocks awake(grid, 1);
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
  AwakeBlocks awake(grid, 0);
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

}  // namespace
}  // namespace brisance::grid
