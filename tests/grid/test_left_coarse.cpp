/// Leaves that are left coarse, against the boxes of the leaves alone.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "core/error.hpp"
#include "grid/cell.hpp"
#include "grid/forest.hpp"

namespace brisance::grid {
namespace {

constexpr int most_level = 3;

struct Case {
  std::string name;
  Index3 parts{1, 1, 1};
  int dimensions = 2;
  std::array<bool, 3> periodic{false, false, false};
};

void PrintTo(Case const& c, std::ostream* out) { *out << c.name; }

class LeftCoarse : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    if (!Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  }
  [[nodiscard]] static Forest forest() { return Forest(GetParam().parts, GetParam().dimensions, GetParam().periodic); }
  /// A box in blocks of the most level.
  [[nodiscard]] static CellRange box_of(Leaf const& leaf) {
    CellRange box;
    for (int d = 0; d < GetParam().dimensions; ++d) {
      box.lower[d] = leaf.place[d] << (most_level - leaf.level);
      box.upper[d] = (leaf.place[d] + 1) << (most_level - leaf.level);
    }
    return box;
  }
  [[nodiscard]] static bool touch(Leaf const& a, Leaf const& b) {
    CellRange const one = box_of(a);
    CellRange const other = box_of(b);
    for (int d = 0; d < GetParam().dimensions; ++d) {
      int const period = GetParam().periodic[d] ? GetParam().parts[d] << most_level : 0;
      bool meet = false;
      for (int const shift : {-period, 0, period})
        meet = meet || (one.lower[d] <= other.upper[d] + shift && other.lower[d] + shift <= one.upper[d]);
      if (!meet) return false;
    }
    return true;
  }
  /// The level of the cells in every block of the most level.
  [[nodiscard]] static std::vector<int> levels_of_cells(Forest const& forest) {
    CellRange const all = CellRange{{0, 0, 0}, GetParam().parts};
    CellRange whole = all;
    for (int d = 0; d < GetParam().dimensions; ++d) whole.upper[d] <<= most_level;
    std::vector<int> levels(whole.count(), -1);
    for (int n = 0; n < static_cast<int>(forest.leaves().size()); ++n) {
      for_each_cell(box_of(forest.leaves()[n]),
                    [&](Index3 const& at) { levels[whole.offset(at)] = forest.level_of_cells(n); });
    }
    return levels;
  }
  template <class Random>
  [[nodiscard]] static std::vector<std::int8_t> marks_for(Forest const& forest, Random& random) {
    std::vector<std::int8_t> marks;
    for (std::size_t n = 0; n < forest.leaves().size(); ++n)
      marks.push_back(static_cast<std::int8_t>(random() % 4 == 0 ? 1 : random() % 4 == 0 ? 0 : -1));
    return marks;
  }
};

TEST_P(LeftCoarse, AreLeavesThatTouchNothingFinerAndNoOthers) {
  std::mt19937 random(3);
  Forest forest = LeftCoarse::forest();
  int found = 0;
  for (int round = 0; round < 20; ++round) {
    forest.adapt(marks_for(forest, random), most_level);
    std::vector<std::uint8_t> may;
    for (std::size_t n = 0; n < forest.leaves().size(); ++n) may.push_back(random() % 3 != 0 ? 1 : 0);
    forest.leave_coarse(may);
    for (int n = 0; n < static_cast<int>(may.size()); ++n) {
      Leaf const& leaf = forest.leaves()[n];
      bool beside_finer = false;
      for (int m = 0; m < static_cast<int>(may.size()); ++m) {
        if (m == n || !touch(leaf, forest.leaves()[m])) continue;
        EXPECT_LE(std::abs(forest.level_of_cells(n) - forest.level_of_cells(m)), 1);
        beside_finer = beside_finer || forest.level_of_cells(m) > leaf.level;
      }
      EXPECT_EQ(forest.is_left_coarse(n), may[n] != 0 && leaf.level > 0 && !beside_finer);
      found += forest.is_left_coarse(n) ? 1 : 0;
    }
  }
  EXPECT_GT(found, 100);
}

TEST_P(LeftCoarse, CellsChangeByOneLevelAtMost) {
  std::mt19937 random(4);
  Forest forest = LeftCoarse::forest();
  int left = 0;
  int refined = 0;
  for (int round = 0; round < 100; ++round) {
    std::vector<int> const before = levels_of_cells(forest);
    forest.adapt(marks_for(forest, random), most_level, [&](Leaf const&) { return random() % 3 == 0; });
    std::vector<int> const after = levels_of_cells(forest);
    for (std::size_t n = 0; n < before.size(); ++n) {
      ASSERT_LE(std::abs(after[n] - before[n]), 1);
      refined += after[n] > before[n] ? 1 : 0;
    }
    for (std::uint8_t const coarse : forest.left_coarse()) left += coarse;
  }
  EXPECT_GT(left, 100);
  EXPECT_GT(refined, 100);
}

TEST_P(LeftCoarse, StaySoUntilTheyAreRefined) {
  Forest forest = LeftCoarse::forest();
  std::vector<std::int8_t> marks(forest.leaves().size(), 0);
  marks.front() = 1;
  Leaf const wanted{1, {0, 0, 0}};
  forest.adapt(marks, 1, [&](Leaf const& leaf) { return leaf == wanted; });
  int const family = 1 << GetParam().dimensions;
  auto const left = [&] {
    int count = 0;
    for (std::uint8_t const coarse : forest.left_coarse()) count += coarse;
    return count;
  };
  EXPECT_EQ(left(), family - 1);
  EXPECT_EQ(forest.level_of_cells(forest.find(wanted)), 1);

  auto const adapt = [&](std::int8_t mark, Leaf const& of) {
    marks.assign(forest.leaves().size(), 0);
    marks[forest.find(of)] = mark;
    forest.adapt(marks, 1, [](Leaf const&) { return false; });
  };
  Leaf const other{1, {1, 0, 0}};
  adapt(0, other);
  EXPECT_EQ(left(), family - 1);
  adapt(1, other);
  EXPECT_EQ(left(), family - 2);
  EXPECT_EQ(forest.level_of_cells(forest.find(other)), 1);
  adapt(-1, other);
  EXPECT_EQ(left(), family - 1);
  // Without a word on what is wanted all get their own cells.
  forest.adapt(std::vector<std::int8_t>(forest.leaves().size(), 0), 1);
  EXPECT_EQ(left(), 0);
}

TEST_P(LeftCoarse, ComeBackFromTheirList) {
  std::mt19937 random(5);
  Forest forest = LeftCoarse::forest();
  for (int round = 0; round < 4; ++round)
    forest.adapt(marks_for(forest, random), most_level, [&](Leaf const&) { return random() % 2 == 0; });
  Forest const again(forest.parts(), forest.dimensions(), forest.periodic(), forest.leaves(), forest.left_coarse());
  EXPECT_EQ(again.leaves(), forest.leaves());
  EXPECT_EQ(again.left_coarse(), forest.left_coarse());

  // One of level 0 cannot be left coarse, nor can one beside finer cells.
  auto const made = [&](Forest const& of, std::vector<std::uint8_t> const& left) {
    return Forest(of.parts(), of.dimensions(), of.periodic(), of.leaves(), left).leaves().size();
  };
  Forest const roots = LeftCoarse::forest();
  EXPECT_THROW(made(roots, std::vector<std::uint8_t>(roots.leaves().size(), 1)), InputError);
  EXPECT_THROW(made(roots, std::vector<std::uint8_t>(roots.leaves().size() + 1, 0)), InputError);
  Forest finer = LeftCoarse::forest();
  finer.adapt(std::vector<std::int8_t>(finer.leaves().size(), 1), most_level);
  std::vector<std::int8_t> marks(finer.leaves().size(), 0);
  marks.front() = 1;
  finer.adapt(marks, most_level);
  std::vector<std::uint8_t> left(finer.leaves().size(), 0);
  EXPECT_EQ(made(finer, left), left.size());
  left[finer.find({1, {1, 0, 0}})] = 1;
  EXPECT_THROW(made(finer, left), InputError);
}

INSTANTIATE_TEST_SUITE_P(Forests, LeftCoarse,
                         testing::Values(Case{"Plane", {4, 3, 1}, 2},
                                         Case{"Periodic", {2, 3, 1}, 2, {true, true, true}},
                                         Case{"Space", {2, 2, 1}, 3},
                                         Case{"PeriodicSpace", {2, 1, 2}, 3, {true, false, true}}),
                         [](auto const& tested) { return tested.param.name; });

}  // namespace
}  // namespace brisance::grid
