/// Grids of several levels against geometry: every question is answered a second time from the places of the forest's
/// leaves, by a search of all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "grid/forest.hpp"
#include "grid/grid.hpp"

namespace brisance::grid {
namespace {

/// Small, but large enough to be told from nothing in every place below.
constexpr double little = 0x1p-30;  // [m]

using Place = std::pair<int, Index3>;  // level and place of a block

struct Case {
  std::string name;
  Geometry geometry = Geometry::planar2d;
  Index3 cells{1, 1, 1};
  Index3 size{1, 1, 1};
  std::array<bool, 3> periodic{false, false, false};
  int most_level = 2;
  bool left_coarse = false;  ///< are most leaves that may be?
};

void PrintTo(Case const& c, std::ostream* out) { *out << c.name; }

std::vector<Case> cases() {
  return {
      {"Plane", Geometry::planar2d, {32, 24, 1}, {8, 8, 1}, {false, false, false}, 3},
      {"PeriodicPlane", Geometry::planar2d, {64, 72, 1}, {8, 8, 1}, {true, true, false}, 3},
      {"PlanePeriodicInY", Geometry::planar2d, {20, 18, 1}, {4, 6, 1}, {false, true, false}, 3},
      {"PlaneOfOnePeriodicBlock", Geometry::planar2d, {8, 24, 1}, {8, 6, 1}, {true, false, false}, 3},
      {"PlaneWithRests", Geometry::planar2d, {36, 20, 1}, {8, 6, 1}, {false, false, false}, 3},
      {"PeriodicPlaneWithARestInX", Geometry::planar2d, {26, 42, 1}, {8, 6, 1}, {false, true, false}, 3},
      {"Axisymmetric", Geometry::axisymmetric2d, {22, 16, 1}, {6, 4, 1}, {false, false, false}, 2},
      {"Space", Geometry::cartesian3d, {24, 12, 16}, {4, 4, 4}, {false, false, false}, 2},
      {"PeriodicSpace", Geometry::cartesian3d, {24, 12, 16}, {4, 4, 4}, {true, true, true}, 2},
      {"SpaceWithRests", Geometry::cartesian3d, {14, 10, 9}, {4, 4, 6}, {false, false, false}, 2},
      {"SpacePeriodicInZ", Geometry::cartesian3d, {14, 4, 12}, {4, 4, 4}, {false, false, true}, 2},
      {"PlaneWithLeavesLeftCoarse", Geometry::planar2d, {32, 24, 1}, {8, 8, 1}, {false, false, false}, 3, true},
      {"PeriodicPlaneWithLeavesLeftCoarse", Geometry::planar2d, {64, 72, 1}, {8, 8, 1}, {true, true, false}, 3, true},
      {"PlaneWithRestsAndLeavesLeftCoarse", Geometry::planar2d, {36, 20, 1}, {8, 6, 1}, {false, false, false}, 3, true},
      {"SpaceWithLeavesLeftCoarse", Geometry::cartesian3d, {24, 12, 16}, {4, 4, 4}, {false, false, false}, 2, true},
      {"PeriodicSpaceWithLeavesLeftCoarse",
       Geometry::cartesian3d,
       {24, 12, 16},
       {4, 4, 4},
       {true, true, true},
       2,
       true},
      {"SpaceWithRestsAndLeavesLeftCoarse",
       Geometry::cartesian3d,
       {14, 10, 9},
       {4, 4, 6},
       {false, false, false},
       2,
       true},
  };
}

Domain domain_of(Case const& c) {
  Domain domain;
  domain.geometry = c.geometry;
  domain.cells = c.cells;
  domain.h = 0.5;
  // All places below are exact.
  if (radial_exponent(c.geometry) == 0) domain.lower = {-1.5, 2.0, 0.25};
  for (int face = 0; face < 6; ++face) {
    domain.boundary[face] = c.periodic[face / 2] ? Boundary::periodic : Boundary::outflow;
  }
  return domain;
}

/// The cells of its level that a block covers, as if it lay in the domain as a whole.
CellRange cells_of(Place const& block, Index3 const& size) {
  CellRange box;
  for (int d = 0; d < 3; ++d) {
    box.lower[d] = block.second[d] * size[d];
    box.upper[d] = box.lower[d] + size[d];
  }
  return box;
}

/// A box of cells of one level in cells of a finer one.
CellRange refined(CellRange box, int by_levels, int dimensions) {
  for (int d = 0; d < dimensions; ++d) {
    box.lower[d] <<= by_levels;
    box.upper[d] <<= by_levels;
  }
  return box;
}

/// The blocks in the place of a block of the next coarser level.
std::vector<Place> children_of(Place const& block, int dimensions) {
  std::vector<Place> children;
  CellRange const one{block.second, {block.second[0] + 1, block.second[1] + 1, block.second[2] + 1}};
  for_each_cell(refined(one, 1, dimensions), [&](Index3 const& place) {
    children.push_back({block.first + 1, place});
  });
  return children;
}

Place parent_of(Place block, int dimensions) {
  --block.first;
  for (int d = 0; d < dimensions; ++d) block.second[d] /= 2;
  return block;
}

class LevelsGrid : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    if (!Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
    Case const& c = GetParam();
    domain_ = domain_of(c);
    dimensions_ = domain_.dimensions();
    for (int level = 0; level <= c.most_level; ++level) domains_.push_back(domain_.refined(level));
    Index3 parts{1, 1, 1};
    for (int d = 0; d < dimensions_; ++d) parts[d] = (c.cells[d] + c.size[d] - 1) / c.size[d];
    Forest forest(parts, dimensions_, c.periodic);
    std::mt19937 random(7);
    // A few here and there, and all near the high end, where blocks may reach beyond the domain: there covered blocks
    // lie as deep as those that lack neighbours.
    for (int level = 0; level < c.most_level; ++level) {
      std::vector<std::int8_t> marks;
      for (Leaf const& leaf : forest.leaves()) {
        bool near = leaf.level == level;
        for (int d = 0; d < dimensions_; ++d) {
          int const last = ((domain_.cells[d] << level) - 1) / c.size[d];
          near = near && leaf.place[d] > last - 3;
        }
        marks.push_back(near || random() % 20 == 0 ? 1 : 0);
      }
      forest.adapt(marks, c.most_level);
    }
    if (c.left_coarse) {
      std::vector<std::uint8_t> may;
      for (std::size_t n = 0; n < forest.leaves().size(); ++n) may.push_back(random() % 4 != 0 ? 1 : 0);
      forest.leave_coarse(may);
    }
    for (std::size_t n = 0; n < forest.leaves().size(); ++n) {
      Place const at{forest.leaves()[n].level, forest.leaves()[n].place};
      outside_ += is_inside(at) ? 0 : 1;
      if (!is_inside(at)) continue;
      bool const coarse = forest.is_left_coarse(static_cast<int>(n));
      left_coarse_ += coarse ? 1 : 0;
      areas_.push_back({at, at.first - (coarse ? 1 : 0), coarse ? parent_of(at, dimensions_) : at});
      blocks_of_areas_.insert(areas_.back().block);
    }
    grid_.emplace(domain_, c.size, forest);
    for (Block const& block : grid().blocks()) {
      if (block.covered) covered_.insert(place_of(block));
    }
    EXPECT_EQ(left_coarse_ > 0, c.left_coarse);
  }

  [[nodiscard]] Grid const& grid() const { return *grid_; }
  [[nodiscard]] Index3 const& size() const { return GetParam().size; }
  [[nodiscard]] bool is_inside(Place const& block) const {
    return !common(cells_of(block, size()), domains_[block.first].all_cells()).empty();
  }
  [[nodiscard]] Place place_of(Block const& block) const {
    Place at{block.level, {}};
    for (int d = 0; d < 3; ++d) at.second[d] = block.origin[d] / size()[d];
    return at;
  }
  /// Do two blocks touch, be it at a corner, in one of the images of a periodic domain?
  [[nodiscard]] bool touch(Place const& a, Place const& b) const {
    int const finest = std::max(a.first, b.first);
    CellRange const one = refined(cells_of(a, size()), finest - a.first, dimensions_);
    CellRange const other = refined(cells_of(b, size()), finest - b.first, dimensions_);
    for (int d = 0; d < dimensions_; ++d) {
      int const period = GetParam().periodic[d] ? domain_.cells[d] << finest : 0;
      bool meet = false;
      for (int const shift : {-period, 0, period}) {
        meet = meet || (one.lower[d] <= other.upper[d] + shift && other.lower[d] + shift <= one.upper[d]);
      }
      if (!meet) return false;
    }
    return true;
  }
  /// The block that holds a cell of a level, by a search of all.
  [[nodiscard]] Block const* holder(int level, Index3 const& cell) const {
    for (Block const& block : grid().blocks()) {
      if (block.level == level && block.in_domain().contains(cell)) return &block;
    }
    return nullptr;
  }
  /// The cell of a leaf between whose faces a place lies; on a face it is the upper one.
  void expect_located(Vec3 x) const {
    Cell const found = grid().locate(x);
    Vec3 const wanted = x;
    for (int d = 0; d < dimensions_; ++d) {
      x[d] = std::clamp(x[d], domain_.lower[d], domain_.upper(d) - little);
    }
    auto const within = [&](Metric const& metric, CellRange const& box) {
      for (int d = 0; d < dimensions_; ++d) {
        if (x[d] < metric.face(d, box.lower[d]) || x[d] >= metric.face(d, box.upper[d])) return false;
      }
      return true;
    };
    int holders = 0;
    for (Area const& area : areas_) {
      if (!within(domains_[area.leaf.first], cells_of(area.leaf, size()))) continue;
      ++holders;
      Block const& block = grid().block(found);
      Domain const& domain = domains_[area.level];
      EXPECT_EQ(place_of(block), area.block) << wanted[0] << ' ' << wanted[1] << ' ' << wanted[2];
      EXPECT_TRUE(block.interior().contains(found.within()));
      Index3 const cell = grid().index(found);
      EXPECT_TRUE(within(domain, around(cell, 0, dimensions_)));
      EXPECT_EQ(found.offset, block.offset(found.i, found.j, found.k));
    }
    EXPECT_EQ(holders, 1);
  }

  Domain domain_;
  std::vector<Domain> domains_;  ///< of each level
  int dimensions_ = 0;
  int outside_ = 0;      ///< leaves outside the domain
  int left_coarse_ = 0;  ///< leaves inside
  /// A leaf in the domain, the level of its cells, and the block that holds them.
  struct Area {
    Place leaf;
    int level = 0;
    Place block;
  };
  std::vector<Area> areas_;
  std::set<Place> blocks_of_areas_;
  std::set<Place> covered_;
  std::optional<Grid> grid_;
};

TEST_P(LevelsGrid, BlocksAreTheLeavesInTheDomainAndCoveredOnes) {
  Case const& c = GetParam();
  ASSERT_EQ(grid().levels(), c.most_level + 1);
  std::set<Place> uncovered;
  std::vector<int> seen(static_cast<std::size_t>(grid().levels()), 0);
  for (int b = 0; b < grid().block_count(); ++b) {
    Block const& block = grid().blocks()[b];
    EXPECT_EQ(block.number, b);
    EXPECT_EQ(block.size, size());
    EXPECT_EQ(block.h(), std::ldexp(domain_.h, -block.level));
    CellRange const whole = cells_of(place_of(block), size());
    CellRange const inside = common(whole, domains_[block.level].all_cells());
    EXPECT_EQ(block.in_domain().lower, inside.lower);
    EXPECT_EQ(block.in_domain().upper, inside.upper);
    if (!block.covered) {
      EXPECT_TRUE(uncovered.insert(place_of(block)).second);
    }
    std::size_t const level = static_cast<std::size_t>(block.level);
    ASSERT_LT(seen[level], static_cast<int>(grid().blocks_of(block.level).size()));
    EXPECT_EQ(grid().blocks_of(block.level)[seen[level]++], b);
  }
  EXPECT_EQ(uncovered, blocks_of_areas_);
  for (int level = 0; level < grid().levels(); ++level) {
    EXPECT_EQ(seen[level], static_cast<int>(grid().blocks_of(level).size()));
    EXPECT_GT(seen[level], 0);
    EXPECT_EQ(grid().domain(level).cells, domains_[level].cells);
  }
  EXPECT_EQ(grid().smallest_cell(), std::ldexp(domain_.h, -c.most_level));
  // The domains with rests are such that leaves are left out.
  bool const rests = c.name.find("Rest") != std::string::npos;
  if (rests) {
    EXPECT_GT(outside_, 0);
  }
}

TEST_P(LevelsGrid, TheCellsOfLeavesTileTheDomain) {
  int const finest = grid().levels() - 1;
  CellRange const all = domains_[finest].all_cells();
  std::vector<int> times(all.count(), 0);
  double volume = 0.0;
  for (Block const& block : grid().blocks()) {
    int count = 0;
    for_each_cell(block, [&](Cell const& cell) {
      if (block.is_covered(cell)) return;
      ++count;
      volume += block.volume(cell);
      Index3 const index = block.index(cell);
      for_each_cell(refined(around(index, 0, 3), finest - block.level, dimensions_), [&](Index3 const& fine) {
        ASSERT_TRUE(all.contains(fine));
        ++times[all.offset(fine)];
      });
    });
    EXPECT_EQ(uncovered_count(block), count);
    EXPECT_EQ(block.covered, count == 0);
    for_each_uncovered_box(block, [&](CellRange const& box) {
      for_each_cell(box, [&](Index3 const& index) {
        EXPECT_FALSE(block.is_covered(block.cell_with(index)));
        --count;
      });
    });
    EXPECT_EQ(count, 0);
  }
  EXPECT_TRUE(std::all_of(times.begin(), times.end(), [](int n) { return n == 1; }));
  double whole = 0.0;
  for_each_cell(domain_.all_cells(), [&](Index3 const& cell) { whole += domain_.cell_volume(cell[0]); });
  EXPECT_NEAR(volume, whole, 1e-12 * whole);
}

TEST_P(LevelsGrid, ABlockIsCoveredWhereFinerLeavesTouchLeavesOfItsLevel) {
  std::set<Place> expected;
  for (Area const& fine : areas_) {
    for (Area const& coarse : areas_) {
      if (fine.level <= coarse.level || !touch(fine.leaf, coarse.leaf)) continue;
      ASSERT_EQ(fine.level, coarse.level + 1);
      Place const below = parent_of(fine.block, dimensions_);
      if (!blocks_of_areas_.contains(below)) expected.insert(below);
    }
  }
  EXPECT_TRUE(expected.size() > 0U || left_coarse_ > 0);
  EXPECT_EQ(covered_, expected);
}

TEST_P(LevelsGrid, ChildrenOfCoveredBlocksAreBlocks) {
  for (Place const& block : covered_) {
    int leaves = 0;
    for (Place const& child : children_of(block, dimensions_)) {
      if (!is_inside(child)) continue;
      EXPECT_TRUE(blocks_of_areas_.contains(child) || covered_.contains(child));
      leaves += blocks_of_areas_.contains(child) ? 1 : 0;
    }
    EXPECT_GT(leaves, 0);
  }
}

TEST_P(LevelsGrid, ACoveredBlockComesBeforeThoseThatCoverIt) {
  for (Block const& block : grid().blocks()) {
    if (!block.covered) continue;
    for (Place const& child : children_of(place_of(block), dimensions_)) {
      if (!is_inside(child)) continue;
      EXPECT_GT(grid().block_of(child.first, cells_of(child, size()).lower), block.number);
    }
  }
}

TEST_P(LevelsGrid, NeighboursLieBeyondTheFacesOfTheirBlocks) {
  std::set<Beyond> seen;
  for (Block const& block : grid().blocks()) {
    Domain const& domain = domains_[block.level];
    for (int face = 0; face < 6; ++face) {
      int const d = face / 2;
      bool covered = true;
      for_each_face_cell(block, d, face % 2, [&](Cell const& cell) { covered = covered && block.is_covered(cell); });
      // All cells before the face see the same block beyond it.
      for_each_face_cell(block, d, face % 2, [&](Cell const& cell) {
        Index3 next = beside(block.index(cell), d, face % 2);
        if (d < dimensions_ && GetParam().periodic[d]) next[d] = (next[d] + domain.cells[d]) % domain.cells[d];
        Block const* const other = holder(block.level, next);
        EXPECT_EQ(block.neighbour[face], other != nullptr ? other->number : no_neighbour);
        bool const outside = !domain.contains(next);
        Beyond const expected = outside            ? Beyond::boundary
                                : other != nullptr ? Beyond::block
                                : covered          ? Beyond::nothing
                                                   : Beyond::coarser;
        EXPECT_EQ(block.beyond[face], expected);
        EXPECT_EQ(block.at_boundary(face), outside);
        if (expected != Beyond::coarser) return;
        for (int e = 0; e < dimensions_; ++e) next[e] /= 2;
        Block const* const coarser = holder(block.level - 1, next);
        ASSERT_NE(coarser, nullptr);
        EXPECT_FALSE(coarser->is_covered(coarser->cell_with(next)));
        EXPECT_EQ(coarser_block_beyond(grid(), block, face), coarser->number);
      });
      seen.insert(block.beyond[face]);
    }
  }
  EXPECT_TRUE(seen.contains(Beyond::block));
  // Blocks that are covered in part may lie around all finer ones.
  EXPECT_TRUE(seen.contains(Beyond::coarser) || left_coarse_ > 0);
  EXPECT_TRUE(seen.contains(Beyond::nothing) || left_coarse_ > 0);
}

TEST_P(LevelsGrid, LocatesTheCellsOfEveryLevel) {
  for (int level = 0; level < grid().levels(); ++level) {
    for_each_cell(domains_[level].all_cells(), [&](Index3 const& index) {
      // One cell of each part of the domain.
      for (int d = 0; d < dimensions_; ++d) {
        if (index[d] % size()[d] != size()[d] / 2 && index[d] != 0) return;
      }
      Block const* const block = holder(level, index);
      EXPECT_EQ(grid().block_of(level, index), block != nullptr ? block->number : no_neighbour);
      std::optional<Cell> const cell = grid().locate(level, index);
      ASSERT_EQ(cell.has_value(), block != nullptr);
      if (!cell) return;
      EXPECT_EQ(cell->block, block->number);
      EXPECT_EQ(grid().index(*cell), index);
      EXPECT_EQ(cell->offset, block->offset(cell->i, cell->j, cell->k));
    });
  }
}

// On all faces, edges and corners of all leaves, of whatever levels are on both sides, just below them, and between.
TEST_P(LevelsGrid, LocatesPlacesInTheCellsOfLeaves) {
  for (Area const& area : areas_) {
    Place const& leaf = area.leaf;
    Domain const& domain = domains_[leaf.first];
    CellRange const box = common(cells_of(leaf, size()), domain.all_cells());
    auto const place = [&](int d, int which) {
      double const low = domain.face(d, box.lower[d]);
      double const high = domain.face(d, box.upper[d]);
      return std::array{low, low - little, 0.5 * (low + high), high - little, high}.at(which);
    };
    CellRange places;
    for (int d = 0; d < dimensions_; ++d) places.upper[d] = 5;
    for_each_cell(places, [&](Index3 const& which) {
      Vec3 x{0.0, 0.0, 0.0};
      for (int d = 0; d < dimensions_; ++d) x[d] = place(d, which[d]);
      expect_located(x);
    });
  }
}

TEST_P(LevelsGrid, LocatesPlacesOutsideInTheNearestCells) {
  for (Area const& area : areas_) {
    Place const& leaf = area.leaf;
    Domain const& domain = domains_[leaf.first];
    Vec3 const inside = domain.centre(cells_of(leaf, size()).lower);
    for (int d = 0; d < dimensions_; ++d) {
      for (double const far : {-1000.0, domain_.lower[d] - 0.125, domain_.upper(d) + 0.125, 1000.0}) {
        Vec3 x = inside;
        x[d] = far;
        expect_located(x);
        // And beyond an edge.
        x[(d + 1) % dimensions_] = far;
        expect_located(x);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Domains, LevelsGrid, testing::ValuesIn(cases()),
                         [](auto const& tested) { return tested.param.name; });

TEST(Grid, OfAForestOfOneLevelHasTheBlocksOfAPlainGrid) {
  Domain domain;
  domain.cells = {20, 12, 8};
  domain.boundary = {Boundary::wall,     Boundary::outflow,  Boundary::periodic,
                     Boundary::periodic, Boundary::symmetry, Boundary::wall};
  Grid const plain(domain, 4);
  Grid const grid(domain, {4, 4, 4}, Forest({5, 3, 2}, 3, periodic_directions(domain)));
  ASSERT_EQ(grid.block_count(), plain.block_count());
  EXPECT_EQ(grid.levels(), 1);
  for (int b = 0; b < grid.block_count(); ++b) {
    EXPECT_EQ(grid.blocks()[b].origin, plain.blocks()[b].origin);
    EXPECT_EQ(grid.blocks()[b].n, plain.blocks()[b].n);
    EXPECT_EQ(grid.blocks()[b].neighbour, plain.blocks()[b].neighbour);
    EXPECT_EQ(grid.blocks()[b].beyond, plain.blocks()[b].beyond);
    EXPECT_FALSE(grid.blocks()[b].covered);
  }
}

TEST(Grid, RefusesBlocksThatCannotBeHalvedAndForestsOfAnotherSize) {
  Domain domain;
  domain.cells = {24, 16, 8};
  auto const made = [&](Index3 const& size, Index3 const& parts) {
    return Grid(domain, size, Forest(parts, 3, {false, false, false})).block_count();
  };
  EXPECT_EQ(made({8, 8, 8}, {3, 2, 1}), 6);
  EXPECT_EQ(made({10, 8, 8}, {3, 2, 1}), 6);  // the last block reaches beyond the domain
  EXPECT_THROW(made({5, 8, 8}, {5, 2, 1}), InputError);
  EXPECT_THROW(made({8, 2, 8}, {3, 8, 1}), InputError);
  EXPECT_THROW(made({8, 8, 8}, {3, 2, 2}), InputError);
  EXPECT_THROW(made({8, 8, 8}, {2, 2, 1}), InputError);
}

}  // namespace
}  // namespace brisance::grid
