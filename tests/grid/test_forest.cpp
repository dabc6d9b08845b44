/// The forest of blocks against geometry: every question is answered a second time from the boxes of the leaves alone.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "core/error.hpp"
#include "grid/cell.hpp"
#include "grid/forest.hpp"
#include "grid/grid.hpp"

namespace brisance::grid {
namespace {

using Marks = std::vector<std::int8_t>;

constexpr std::array<bool, 3> closed{false, false, false};
constexpr std::array<bool, 3> periodic_in_all{true, true, true};

/// The level in whose blocks the tests measure; no test goes deeper.
constexpr int finest = 6;

/// What a block covers, in blocks of the finest level.
CellRange box_of(Leaf const& leaf, int dimensions) {
  CellRange box;
  int const shift = finest - leaf.level;
  for (int d = 0; d < dimensions; ++d) {
    box.lower[d] = leaf.place[d] << shift;
    box.upper[d] = (leaf.place[d] + 1) << shift;
  }
  return box;
}

bool covers(CellRange const& outer, CellRange const& inner) {
  for (int d = 0; d < 3; ++d) {
    if (inner.lower[d] < outer.lower[d] || inner.upper[d] > outer.upper[d]) return false;
  }
  return true;
}

/// Morton key, bit by bit, x fastest.
std::uint64_t slow_morton(Index3 const& place) {
  std::uint64_t key = 0;
  for (int bit = 0; bit < 21; ++bit) {
    for (int d = 0; d < 3; ++d) key |= static_cast<std::uint64_t>((place[d] >> bit) & 1) << (3 * bit + d);
  }
  return key;
}

Forest forest_2d(Index3 const& parts, std::array<bool, 3> const& periodic = closed) {
  return Forest(parts, 2, periodic);
}
Forest forest_3d(Index3 const& parts, std::array<bool, 3> const& periodic = closed) {
  return Forest(parts, 3, periodic);
}

void expect_order(Forest const& forest) {
  std::vector<std::uint64_t> keys;
  for (Leaf const& leaf : forest.leaves()) keys.push_back(slow_morton(box_of(leaf, forest.dimensions()).lower));
  EXPECT_TRUE(std::is_sorted(keys.begin(), keys.end()));
  EXPECT_EQ(std::set(keys.begin(), keys.end()).size(), keys.size());
}

/// Leaves lie in the domain, none overlaps another, and their volumes sum to the whole.
void expect_tiling(Forest const& forest) {
  CellRange whole;
  for (int d = 0; d < forest.dimensions(); ++d) whole.upper[d] = forest.parts()[d] << finest;
  std::size_t volume = 0;
  for (Leaf const& leaf : forest.leaves()) {
    CellRange const box = box_of(leaf, forest.dimensions());
    EXPECT_TRUE(covers(whole, box));
    volume += box.count();
    for (Leaf const& other : forest.leaves()) {
      bool const apart = &other == &leaf || common(box, box_of(other, forest.dimensions())).empty();
      if (!apart) ADD_FAILURE() << "blocks of levels " << leaf.level << " and " << other.level << " overlap";
    }
  }
  EXPECT_EQ(volume, whole.count());
}

/// Do two boxes touch, be it at a corner, in one of the images of a periodic domain?
bool touch(CellRange const& a, CellRange const& b, Forest const& forest) {
  for (int d = 0; d < forest.dimensions(); ++d) {
    int const period = forest.periodic()[d] ? forest.parts()[d] << finest : 0;
    bool meet = false;
    for (int const shift : {-period, 0, period}) {
      meet = meet || (a.lower[d] <= b.upper[d] + shift && b.lower[d] + shift <= a.upper[d]);
    }
    if (!meet) return false;
  }
  return true;
}

void expect_balance(Forest const& forest) {
  std::vector<Leaf> const& leaves = forest.leaves();
  for (Leaf const& coarse : leaves) {
    CellRange const box = box_of(coarse, forest.dimensions());
    for (Leaf const& fine : leaves) {
      if (fine.level < coarse.level + 2) continue;
      if (!touch(box, box_of(fine, forest.dimensions()), forest)) continue;
      ADD_FAILURE() << "level " << coarse.level << " beside " << fine.level;
    }
  }
}

/// Each leaf comes from the leaves that covered its box, or from the one that held it; a family is a whole one.
void expect_origins(std::vector<Leaf> const& before, Forest const& forest, std::vector<Origin> const& origins) {
  int const dimensions = forest.dimensions();
  ASSERT_EQ(origins.size(), forest.leaves().size());
  for (std::size_t b = 0; b < origins.size(); ++b) {
    Leaf const& leaf = forest.leaves()[b];
    CellRange const box = box_of(leaf, dimensions);
    auto const [first, count] = origins[b];
    ASSERT_GE(first, 0);
    ASSERT_LE(static_cast<std::size_t>(first) + count, before.size());
    if (count == 1) {
      EXPECT_LE(before[first].level, leaf.level);
      EXPECT_TRUE(covers(box_of(before[first], dimensions), box));
      continue;
    }
    EXPECT_EQ(count, 1 << dimensions);
    std::size_t volume = 0;
    for (int i = first; i < first + count; ++i) {
      EXPECT_EQ(before[i].level, leaf.level + 1);
      EXPECT_TRUE(covers(box, box_of(before[i], dimensions)));
      volume += box_of(before[i], dimensions).count();
    }
    EXPECT_EQ(volume, box.count());
  }
}

/// Every leaf with this mark.
Marks all_of(Forest const& forest, int mark) { return Marks(forest.leaves().size(), static_cast<std::int8_t>(mark)); }

/// A mark for one leaf only.
Marks only(Forest const& forest, Leaf const& leaf, int mark) {
  Marks marks = all_of(forest, 0);
  marks.at(static_cast<std::size_t>(forest.find(leaf))) = static_cast<std::int8_t>(mark);
  return marks;
}

/// Marks of which a share refines and a larger one coarsens: the forest grows and shrinks.
Marks random_marks(Forest const& forest, std::mt19937& random, int refined_in_100, int merged_in_100) {
  Marks marks = all_of(forest, 0);
  for (std::int8_t& mark : marks) {
    // Not a distribution of the standard library: those differ between libraries.
    int const draw = static_cast<int>(random() % 100);
    mark = static_cast<std::int8_t>(draw < refined_in_100 ? 1 : draw < refined_in_100 + merged_in_100 ? -1 : 0);
  }
  return marks;
}

class Refined : public testing::Test {
 protected:
  void SetUp() override {
    if (!Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  }
};

TEST(Forest, OfOneLevelIsInMortonOrder) {
  for (Index3 const& parts :
       {Index3{3, 5, 1}, {1, 7, 1}, {8, 2, 1}, {5, 3, 2}, {7, 2, 3}, {1, 1, 1}, {1, 1, 6}, {4, 4, 4}}) {
    Forest const forest(parts, parts[2] > 1 ? 3 : 2, closed);
    EXPECT_EQ(forest.leaves().size(), (CellRange{{0, 0, 0}, parts}.count()));
    expect_order(forest);
    expect_tiling(forest);
  }
  EXPECT_EQ(Forest({9, 1, 1}, 1, closed).leaves()[7], (Leaf{0, {7, 0, 0}}));
}

// Of the corners of a cube, as they are counted.
TEST(Forest, CountsXFastest) {
  Forest const forest = forest_3d({2, 2, 2});
  for (int b = 0; b < 8; ++b) EXPECT_EQ(forest.leaves()[b], (Leaf{0, {b & 1, (b >> 1) & 1, b >> 2}}));
}

TEST(Forest, RefusesBlocksInUnresolvedDirectionsAndTooMany) {
  EXPECT_THROW(Forest({3, 2, 1}, 1, closed), InputError);
  EXPECT_THROW(Forest({0, 2, 1}, 2, closed), InputError);
  EXPECT_THROW(Forest({(1 << 21) + 1, 1, 1}, 1, closed), InputError);
}

TEST(Forest, AcrossAFaceLiesTheNextBlockOrItsPeriodicImage) {
  Forest const forest(Index3{3, 2, 1}, 2, {true, false, true});
  EXPECT_EQ(forest.across({0, {0, 0, 0}}, 0), (Leaf{0, {2, 0, 0}}));
  EXPECT_EQ(forest.across({2, {11, 3, 0}}, 1), (Leaf{2, {0, 3, 0}}));
  EXPECT_EQ(forest.across({2, {11, 3, 0}}, 3), (Leaf{2, {11, 4, 0}}));
  EXPECT_EQ(forest.across({2, {11, 7, 0}}, 3), std::nullopt);
  EXPECT_EQ(forest.across({0, {0, 0, 0}}, 4), std::nullopt);  // not resolved
}

TEST(Forest, WithNothingToChangeEveryLeafIsItsOrigin) {
  for (int const mark : {0, -1, 1}) {
    Forest forest = forest_3d({3, 2, 2});
    std::vector<Leaf> const before = forest.leaves();
    std::vector<Origin> const origins = forest.adapt(all_of(forest, mark), 0);
    EXPECT_EQ(forest.leaves(), before);
    for (int b = 0; b < static_cast<int>(origins.size()); ++b) {
      EXPECT_EQ(origins[b].first, b);
      EXPECT_EQ(origins[b].count, 1);
    }
  }
}

TEST(Forest, RefusesLevelsWhereTheyCannotBe) {
  Forest line({5, 1, 1}, 1, closed);
  EXPECT_THROW(line.adapt(all_of(line, 1), 1), InputError);
  EXPECT_THROW(Forest({1, 1, 1}, 1, closed, {{1, {0, 0, 0}}, {1, {1, 0, 0}}}), InputError);
  Forest plane = forest_2d({5, 4, 1});
  EXPECT_THROW(plane.adapt(Marks(3, 0), 1), InputError);
  EXPECT_THROW(plane.adapt(all_of(plane, 0), plane.deepest_level() + 1), InputError);
  if (!Forest::can_refine(2)) {
    EXPECT_TRUE(Forest::library().empty());
    EXPECT_THROW(plane.adapt(all_of(plane, 1), 1), InputError);
    EXPECT_THROW(Forest({1, 1, 1}, 2, closed, {{1, {0, 0, 0}}, {1, {1, 0, 0}}, {1, {0, 1, 0}}, {1, {1, 1, 0}}}),
                 InputError);
  }
}

TEST_F(Refined, EveryLeafOnceGivesTheNextLevel) {
  for (Index3 const& parts : {Index3{3, 5, 1}, {1, 7, 1}, {5, 3, 2}, {7, 2, 3}}) {
    int const dimensions = parts[2] > 1 ? 3 : 2;
    Forest forest(parts, dimensions, closed);
    std::vector<Leaf> const before = forest.leaves();
    expect_origins(before, forest, forest.adapt(all_of(forest, 1), finest));
    // As a forest of twice as many blocks along each resolved direction.
    Index3 twice = parts;
    for (int d = 0; d < dimensions; ++d) twice[d] *= 2;
    std::vector<Leaf> const fine = Forest(twice, dimensions, closed).leaves();
    ASSERT_EQ(forest.leaves().size(), fine.size());
    for (std::size_t b = 0; b < fine.size(); ++b) EXPECT_EQ(forest.leaves()[b], (Leaf{1, fine[b].place}));
  }
}

TEST_F(Refined, ACornerPullsItsNeighboursAlong) {
  // Level by level into the corner between four blocks, from one of them: the others follow, that across it as well.
  Forest forest = forest_2d({2, 2, 1});
  for (int level = 0; level < 4; ++level) {
    int const last = (1 << level) - 1;
    std::vector<Leaf> const before = forest.leaves();
    auto const origins = forest.adapt(only(forest, {level, {last, last, 0}}, 1), finest);
    expect_origins(before, forest, origins);
    expect_tiling(forest);
    expect_balance(forest);
  }
  EXPECT_GE(forest.find({4, {15, 15, 0}}), 0);
  EXPECT_GE(forest.find({3, {8, 7, 0}}), 0);
  EXPECT_GE(forest.find({3, {8, 8, 0}}), 0);
}

TEST_F(Refined, BalanceReachesAcrossPeriodicFacesOfOddBricks) {
  for (Index3 const& parts : {Index3{3, 5, 1}, {1, 3, 1}, {1, 1, 1}, {3, 1, 2}, {2, 3, 5}}) {
    for (auto const& periodic : {closed, periodic_in_all, std::array<bool, 3>{true, false, false}}) {
      int const dimensions = parts[2] > 1 ? 3 : 2;
      Forest forest(parts, dimensions, periodic);
      for (int level = 0; level < 3; ++level) {
        // Into the low corner: whatever follows beyond it does so through a periodic face.
        forest.adapt(only(forest, {level, {0, 0, 0}}, 1), finest);
        expect_order(forest);
        expect_tiling(forest);
        expect_balance(forest);
      }
      int const far = forest.holding({0, {parts[0] - 1, 0, 0}});
      if (parts[0] > 1) {
        EXPECT_EQ(far < 0, periodic[0]);
      }
      // The block at the other end of all directions touches the low corner if all that has others joins its faces.
      Leaf last;
      bool touches = true;
      for (int d = 0; d < dimensions; ++d) {
        last.place[d] = parts[d] - 1;
        touches = touches && (parts[d] == 1 || periodic[d]);
      }
      EXPECT_EQ(forest.holding(last) < 0, touches);
    }
  }
}

TEST_F(Refined, NothingGoesBeyondTheMostLevel) {
  Forest forest = forest_3d({2, 1, 1});
  for (int round = 0; round < 4; ++round) forest.adapt(all_of(forest, 1), 2);
  EXPECT_EQ(forest.leaves().size(), 2U * 64U);
  for (Leaf const& leaf : forest.leaves()) EXPECT_EQ(leaf.level, 2);
  // A lower level later takes nothing away.
  forest.adapt(all_of(forest, 1), 1);
  EXPECT_EQ(forest.leaves().size(), 2U * 64U);
}

TEST_F(Refined, AFamilyIsMergedOnlyAsAWhole) {
  Forest forest = forest_2d({2, 1, 1});
  forest.adapt(all_of(forest, 1), 1);
  std::vector<Leaf> const before = forest.leaves();
  Marks marks{-1, -1, -1, 0, -1, -1, -1, -1};
  auto const origins = forest.adapt(marks, 1);
  EXPECT_EQ(forest.leaves().size(), 5U);
  expect_origins(before, forest, origins);
  EXPECT_EQ(origins.back().first, 4);
  EXPECT_EQ(origins.back().count, 4);
  EXPECT_EQ(forest.leaves().back(), (Leaf{0, {1, 0, 0}}));
}

TEST_F(Refined, AMergeThatTheBalanceUndoesLeavesLeavesUnchanged) {
  Forest forest = forest_2d({2, 1, 1});
  forest.adapt(all_of(forest, 1), 1);
  // All of the second block want to merge, while the first becomes two levels finer beside it.
  Marks marks{0, 1, 0, 0, -1, -1, -1, -1};
  std::vector<Leaf> const before = forest.leaves();
  auto const origins = forest.adapt(marks, 2);
  expect_origins(before, forest, origins);
  expect_balance(forest);
  ASSERT_EQ(forest.leaves().size(), 11U);
  for (int b = 0; b < 4; ++b) {
    EXPECT_EQ(forest.leaves()[7 + b], before[4 + b]);
    EXPECT_EQ(origins[7 + b].first, 4 + b);
    EXPECT_EQ(origins[7 + b].count, 1);
  }
}

using Blocks = std::set<std::pair<int, Index3>>;  // levels and places

/// Replaces a block by its children, or its children by it.
void split(Blocks& blocks, int level, Index3 const& place, int dimensions, bool back = false) {
  CellRange children{{0, 0, 0}, {1, 1, 1}};
  for (int d = 0; d < dimensions; ++d) {
    children.lower[d] = 2 * place[d];
    children.upper[d] = 2 * place[d] + 2;
  }
  for_each_cell(children, [&](Index3 const& child) {
    if (back) blocks.erase({level + 1, child});
    if (!back) blocks.insert({level + 1, child});
  });
  if (back) blocks.insert({level, place});
  if (!back) blocks.erase({level, place});
}

/// A block that is too coarse for another one that it touches, be it at a corner, if any.
std::optional<std::pair<int, Index3>> too_coarse(Blocks const& blocks, Forest const& forest) {
  for (auto const& [level, place] : blocks) {
    std::optional<std::pair<int, Index3>> found;
    for_each_cell(around(place, 1, forest.dimensions()), [&, level = level](Index3 next) {
      for (int d = 0; d < forest.dimensions(); ++d) {
        int const n = forest.parts()[d] << level;
        if (forest.periodic()[d]) next[d] = (next[d] + n) % n;
      }
      for (int coarser = 2; coarser <= level; ++coarser) {
        Index3 const holder{next[0] >> coarser, next[1] >> coarser, next[2] >> coarser};
        if (blocks.count({level - coarser, holder}) > 0) found = std::pair{level - coarser, holder};
      }
    });
    if (found) return found;
  }
  return std::nullopt;
}

/// What `adapt` is to do, by its words: refine, merge, then split what is too coarse, and nothing else.
Blocks slow_adapt(Forest const& forest, Marks const& marks, int most_level) {
  int const dimensions = forest.dimensions();
  Blocks blocks;
  std::map<std::pair<int, Index3>, int> willing;  // children of a block that want to be merged
  for (std::size_t b = 0; b < marks.size(); ++b) {
    auto const& [level, place] = forest.leaves()[b];
    blocks.insert({level, place});
    if (marks[b] < 0 && level > 0) ++willing[{level - 1, {place[0] / 2, place[1] / 2, place[2] / 2}}];
  }
  for (std::size_t b = 0; b < marks.size(); ++b) {
    auto const& [level, place] = forest.leaves()[b];
    if (marks[b] > 0 && level < most_level) split(blocks, level, place, dimensions);
  }
  for (auto const& [parent, count] : willing) {
    if (count == 1 << dimensions) split(blocks, parent.first, parent.second, dimensions, true);
  }
  while (auto const block = too_coarse(blocks, forest)) split(blocks, block->first, block->second, dimensions);
  return blocks;
}

void churn(Forest forest, std::uint32_t seed, int most_level, int rounds) {
  std::mt19937 random(seed);
  std::size_t largest = 0;
  int merged = 0;
  int refined = 0;
  for (int round = 0; round < rounds; ++round) {
    // Alternating in tens of rounds: few leaves, and many.
    bool const grows = round / 10 % 2 == 0;
    Marks const marks = random_marks(forest, random, grows ? 12 : 2, grows ? 30 : 90);
    std::vector<Leaf> const before = forest.leaves();
    Forest again(forest.parts(), forest.dimensions(), forest.periodic(), before);
    Blocks const expected = slow_adapt(forest, marks, most_level);
    std::vector<Origin> const origins = forest.adapt(marks, most_level);
    Blocks found;
    for (Leaf const& leaf : forest.leaves()) found.insert({leaf.level, leaf.place});
    EXPECT_EQ(found, expected);
    expect_order(forest);
    if (round % 10 == 9) {
      expect_tiling(forest);
      expect_balance(forest);
    }
    expect_origins(before, forest, origins);
    for (std::size_t b = 0; b < origins.size(); ++b) {
      Leaf const& leaf = forest.leaves()[b];
      EXPECT_LE(leaf.level, most_level);
      auto const [first, count] = origins[b];
      if (count > 1) {
        ++merged;
        for (int i = first; i < first + count; ++i) EXPECT_LT(marks[i], 0);
      }
      if (count == 1 && before[first].level < leaf.level) ++refined;
    }
    // The same leaves and marks give the same forest, whatever was before.
    again.adapt(marks, most_level);
    EXPECT_EQ(again.leaves(), forest.leaves());
    largest = std::max(largest, forest.leaves().size());
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(merged, rounds / 4);
  EXPECT_GT(refined, rounds);
  EXPECT_GT(largest, 2 * (CellRange{{0, 0, 0}, forest.parts()}.count()));
}

TEST_F(Refined, TwoHundredRoundsOfRandomMarksIn2D) {
  churn(forest_2d({3, 5, 1}), 1, 4, 200);
  churn(forest_2d({3, 2, 1}, periodic_in_all), 2, 4, 200);
}

TEST_F(Refined, TwoHundredRoundsOfRandomMarksIn3D) {
  churn(forest_3d({2, 3, 1}), 3, 3, 200);
  churn(forest_3d({1, 3, 2}, periodic_in_all), 4, 3, 200);
}

TEST_F(Refined, HoldingAndFindAgreeWithASearchOfAllLeaves) {
  std::mt19937 random(5);
  Forest forest = forest_3d({3, 2, 1});
  for (int round = 0; round < 4; ++round) forest.adapt(random_marks(forest, random, 10, 0), 3);
  std::vector<Leaf> const& leaves = forest.leaves();
  for (int level = 0; level <= 4; ++level) {
    CellRange all;
    for (int d = 0; d < 3; ++d) all.upper[d] = forest.parts()[d] << level;
    for_each_cell(all.grown(1, 3), [&](Index3 const& place) {
      Leaf const block{level, place};
      int holds = -1;
      int same = -1;
      for (int b = 0; b < static_cast<int>(leaves.size()); ++b) {
        if (covers(box_of(leaves[b], 3), box_of(block, 3))) holds = b;
        if (leaves[b] == block) same = b;
      }
      EXPECT_EQ(forest.holding(block), holds);
      EXPECT_EQ(forest.find(block), same);
    });
  }
  EXPECT_EQ(forest.holding({-1, {0, 0, 0}}), -1);
  EXPECT_EQ(forest.holding({forest.deepest_level() + 1, {0, 0, 0}}), -1);
}

TEST_F(Refined, MergingBackGivesTheFirstLevelAgain) {
  std::mt19937 random(6);
  Forest forest = forest_3d({3, 1, 2}, {true, false, false});
  std::vector<Leaf> const first = forest.leaves();
  for (int round = 0; round < 5; ++round) forest.adapt(random_marks(forest, random, 20, 0), 3);
  EXPECT_GT(forest.leaves().size(), 10 * first.size());
  // One level a round.
  for (int round = 0; round < 3; ++round) forest.adapt(all_of(forest, -1), 3);
  EXPECT_EQ(forest.leaves(), first);
}

TEST_F(Refined, LeavesThatDoNotTileOrAreNotInOrderOrBalancedAreRefused) {
  Forest forest = forest_2d({2, 1, 1});
  forest.adapt(only(forest, {0, {0, 0, 0}}, 1), finest);
  std::vector<Leaf> const leaves = forest.leaves();
  auto const made = [](std::vector<Leaf> const& from) { return Forest({2, 1, 1}, 2, closed, from); };
  EXPECT_EQ(made(leaves).leaves(), leaves);
  std::vector<Leaf> wrong = leaves;
  wrong.erase(wrong.begin() + 2);  // a gap
  EXPECT_THROW(made(wrong), InputError);
  wrong = leaves;
  wrong.pop_back();  // the end is missing
  EXPECT_THROW(made(wrong), InputError);
  wrong = leaves;
  wrong.insert(wrong.begin(), {0, {0, 0, 0}});  // a block and its children
  EXPECT_THROW(made(wrong), InputError);
  wrong = leaves;
  wrong.push_back(wrong.back());  // twice the same
  EXPECT_THROW(made(wrong), InputError);
  wrong = leaves;
  std::swap(wrong[1], wrong[2]);
  EXPECT_THROW(made(wrong), InputError);
  wrong = leaves;
  wrong.back().place[0] = 2;  // outside
  EXPECT_THROW(made(wrong), InputError);
  wrong = leaves;
  wrong.back().level = -1;
  EXPECT_THROW(made(wrong), InputError);
  EXPECT_THROW(made({}), InputError);
  // Level 2 beside level 0.
  wrong = leaves;
  Leaf const parent = wrong[1];
  wrong.erase(wrong.begin() + 1);
  for (int child = 3; child >= 0; --child) {
    wrong.insert(wrong.begin() + 1, {2, {2 * parent.place[0] + child % 2, 2 * parent.place[1] + child / 2, 0}});
  }
  EXPECT_THROW(made(wrong), InputError);
}

/// Blocks of level 1 where those of level 0 were, but for one; in place of one of them its children.
std::vector<Leaf> two_levels_below(Index3 const& parts, int dimensions, Index3 const& coarse, Index3 const& fine) {
  Blocks blocks;
  for_each_cell({{0, 0, 0}, parts}, [&](Index3 const& place) {
    blocks.insert({0, place});
    if (place != coarse) split(blocks, 0, place, dimensions);
  });
  split(blocks, 1, fine, dimensions);
  std::vector<Leaf> leaves;
  for (auto const& [level, place] : blocks) leaves.push_back({level, place});
  std::sort(leaves.begin(), leaves.end(), [dimensions](Leaf const& a, Leaf const& b) {
    return slow_morton(box_of(a, dimensions).lower) < slow_morton(box_of(b, dimensions).lower);
  });
  return leaves;
}

// Across faces levels differ by one everywhere.
TEST_F(Refined, LeavesThatAreBalancedAcrossFacesOnlyAreRefused) {
  auto const made = [](Index3 const& parts, int dimensions, std::array<bool, 3> const& periodic, Index3 const& coarse,
                       Index3 const& fine) {
    std::vector<Leaf> const leaves = two_levels_below(parts, dimensions, coarse, fine);
    return Forest(parts, dimensions, periodic, leaves).leaves() == leaves;
  };
  // At a corner in 2D, at an edge and at a corner in 3D. A block further away is none that touches.
  EXPECT_THROW(made({2, 2, 1}, 2, closed, {1, 1, 0}, {1, 1, 0}), InputError);
  EXPECT_TRUE(made({2, 2, 1}, 2, closed, {1, 1, 0}, {0, 0, 0}));
  EXPECT_THROW(made({2, 2, 1}, 3, closed, {1, 1, 0}, {1, 1, 0}), InputError);
  EXPECT_THROW(made({2, 1, 2}, 3, closed, {0, 0, 1}, {2, 1, 1}), InputError);
  EXPECT_THROW(made({2, 2, 2}, 3, closed, {1, 1, 1}, {1, 1, 1}), InputError);
  EXPECT_TRUE(made({2, 2, 2}, 3, closed, {1, 1, 1}, {1, 1, 0}));
  // Through two periodic faces at once.
  EXPECT_THROW(made({3, 3, 1}, 2, periodic_in_all, {2, 2, 0}, {0, 0, 0}), InputError);
  EXPECT_TRUE(made({3, 3, 1}, 2, {true, false, false}, {2, 2, 0}, {0, 0, 0}));
  EXPECT_TRUE(made({3, 3, 1}, 2, closed, {2, 2, 0}, {0, 0, 0}));
}

TEST_F(Refined, AThousandChangesLeaveNoMemoryBehind) {
  Forest forest = forest_2d({4, 4, 1});
  // In use, by the account of the allocator: what the system counts depends on fragments.
  auto const in_use = [] { return static_cast<long>(mallinfo2().uordblks); };
  long settled = 0;
  for (int round = 0; round < 1200; ++round) {
    forest.adapt(all_of(forest, round % 2 == 0 ? 1 : -1), 1);
    if (round == 199) settled = in_use();
  }
  EXPECT_EQ(forest.leaves().size(), 16U);
  // A thousand times the smallest piece that an allocator gives would be 24000 bytes. A few are left to MPI.
  EXPECT_LT(in_use() - settled, 4096);
}

/// Today's order of blocks: results and checkpoints depend on it.
TEST(Grid, BlocksAreInMortonOrderOfTheirPlaces) {
  for (Index3 const& cells : {Index3{37, 20, 9}, {24, 24, 24}, {8, 90, 17}}) {
    Domain domain;
    domain.cells = cells;
    Grid const grid(domain, 8);
    std::vector<std::uint64_t> keys;
    for (Block const& block : grid.blocks()) {
      Index3 place{};
      for (int d = 0; d < 3; ++d) place[d] = block.origin[d] / block.size[d];
      keys.push_back(slow_morton(place));
    }
    EXPECT_TRUE(std::is_sorted(keys.begin(), keys.end()));
    EXPECT_EQ(std::set(keys.begin(), keys.end()).size(), keys.size());
  }
}

}  // namespace
}  // namespace brisance::grid
