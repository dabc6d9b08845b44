// Cells of several sizes: what decks say about them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "deck/deck.hpp"
#include "files.hpp"
#include "grid/forest.hpp"

namespace brisance {
namespace {

deck::Result read(std::string const& text) { return deck::read_text(text, "d"); }

run::Case case_of(std::string const& text) {
  auto const result = read(text);
  std::string errors;
  for (auto const& error : result.errors) errors += deck::format(error) + "\n";
  if (!result.case_) throw std::runtime_error(errors);
  return *result.case_;
}

std::string const head =
    "[end]\ntime = 1e-3\n[domain]\ngeometry = \"planar2d\"\nsize = [2.048, 1.024]\ncell = \"64 mm\"\n";
std::string const charge = "[[charge]]\nradius = 0.1\nposition = [0.4, 0.5]\n";
std::string const plate = "[[body]]\nmaterial = \"RHA\"\nshape = \"box\"\nlower = [1.4, 0.4]\nupper = [1.408, 0.6]\n";

class Levels : public testing::Test {
 protected:
  void SetUp() override {
    if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  }
};

TEST_F(Levels, TheFinestCellIsAllThatMustBeSaid) {
  run::Case const c = case_of(head + charge + plate + "[adaptive]\nfinest = \"4 mm\"\n");
  EXPECT_EQ(c.adaptive.finest, 4);
  EXPECT_EQ(c.adaptive.shocks, 4);
  EXPECT_EQ(c.adaptive.charges, 4);
  EXPECT_EQ(c.adaptive.obstacles, 4);
  EXPECT_FALSE(c.adaptive.gauges);
  EXPECT_FALSE(c.adaptive.products);
  EXPECT_EQ(c.adaptive.threshold, 0.3);
  EXPECT_EQ(c.adaptive.most_cells, 0.0);
  ASSERT_TRUE(c.has_regions());
  EXPECT_EQ(c.mpm_regions.front().level, 4);
  EXPECT_EQ(c.domain.h, 0.064);
  EXPECT_EQ(c.region_domain(0).h, 0.004);
}

TEST_F(Levels, AllKeysAreUnderstood) {
  run::Case const c = case_of(test::file_text(test::root() / "tests/deck/good/all_levels.toml"));
  EXPECT_EQ(c.adaptive.finest, 4);
  EXPECT_EQ(c.adaptive.shocks, 2);
  EXPECT_EQ(c.adaptive.charges, 3);
  EXPECT_EQ(c.adaptive.obstacles, 3);
  EXPECT_EQ(c.adaptive.gauges, 1);
  EXPECT_EQ(c.adaptive.products, 2);
  EXPECT_EQ(c.adaptive.threshold, 0.4);
  EXPECT_EQ(c.adaptive.most_cells, 2e5);
  ASSERT_EQ(c.adaptive.parts.size(), 2U);
  EXPECT_EQ(c.adaptive.parts[0].level, 1);
  EXPECT_TRUE(std::holds_alternative<shape::Box>(c.adaptive.parts[0].shape));
  EXPECT_EQ(c.adaptive.parts[1].level, 3);
  EXPECT_EQ(c.mpm_regions.front().level, 4);
}

TEST_F(Levels, SeveralRegionsHaveCellsOfTheirOwn) {
  run::Case const c = case_of(test::file_text(test::root() / "tests/deck/good/two_regions.toml"));
  ASSERT_EQ(c.mpm_regions.size(), 2U);
  EXPECT_EQ(c.mpm_regions[0].level, 2);
  EXPECT_EQ(c.mpm_regions[1].level, 3);
  EXPECT_EQ(c.mpm_regions[0].bodies, std::vector<int>{0});
  EXPECT_EQ(c.mpm_regions[1].bodies, std::vector<int>{1});
  EXPECT_EQ(c.domain_around(0).h, 0.016);
  EXPECT_EQ(c.domain_around(1).h, 0.008);
  EXPECT_EQ(c.mpm_regions[0].width, 5);
  EXPECT_EQ(c.mpm_regions[1].width, 3);
  EXPECT_EQ(c.mpm_regions[1].margin, 12);
}

TEST_F(Levels, ObstaclesFollowTheCellsOfShocks) {
  run::Case const c = case_of(head + charge + "[adaptive]\nfinest = \"4 mm\"\nshocks = \"16 mm\"\n");
  EXPECT_EQ(c.adaptive.charges, 4);
  EXPECT_EQ(c.adaptive.obstacles, 2);
}

// 0.3 halved is not exact in binary numbers.
TEST_F(Levels, SizesNeedNotBeExactNumbers) {
  std::string const domain = "[end]\ntime = 1e-3\n[domain]\ngeometry = \"planar2d\"\nsize = [4.8, 4.8]\ncell = 0.3\n";
  for (int k = 0; k <= 4; ++k) {
    run::Case const c = case_of(domain + charge + fmt::format("[adaptive]\nfinest = {:.9g}\n", 0.3 / (1 << k)));
    EXPECT_EQ(c.adaptive.finest, k);
  }
}

TEST_F(Levels, CellsOfOneSizeAreTold) {
  auto const result = read(head + charge + "[adaptive]\nfinest = \"64 mm\"\n");
  ASSERT_TRUE(result.case_);
  EXPECT_FALSE(result.case_->adaptive.any());
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_NE(result.warnings[0].find("has no effect: it is domain.cell"), std::string::npos) << result.warnings[0];
}

TEST_F(Levels, ARegionMayHaveCellsThatAreNotTheFinest) {
  std::string const thick = "[[body]]\nmaterial = \"RHA\"\nshape = \"box\"\nlower = [1.4, 0.4]\nupper = [1.45, 0.6]\n";
  run::Case const c = case_of(head + charge + thick +
                              "[mpm_region]\ncell = \"16 mm\"\n[adaptive]\nfinest = \"8 mm\"\nshocks = \"16 mm\"\n");
  EXPECT_EQ(c.mpm_regions.front().level, 2);
  EXPECT_EQ(c.adaptive.finest, 3);
}

// Faces of its box need only be those of its own cells.
TEST_F(Levels, ARegionsBoxLiesOnItsOwnCells) {
  std::string const deck = head + charge + plate + "[adaptive]\nfinest = \"4 mm\"\n[mpm_region]\nbox = ";
  run::Case const c = case_of(deck + "{lower = [1.308, 0.308], upper = [1.508, 0.708]}\n");
  EXPECT_EQ(c.mpm_regions.front().boxes.size(), 1U);
  EXPECT_FALSE(read(deck + "{lower = [1.306, 0.308], upper = [1.508, 0.708]}\n").case_);
}

TEST_F(Levels, AChargeBetweenObstaclesIsTriedOnItsOwnCells) {
  // A slot of 100 mm between two walls that leaves no cell of 64 mm open, but 12 of 8 mm.
  std::string const walls =
      "[numerics]\nobstacles = \"stairs\"\n"
      "[[obstacle]]\nshape = \"box\"\nlower = [0, 0]\nupper = [2.048, 0.414]\n"
      "[[obstacle]]\nshape = \"box\"\nlower = [0, 0.514]\nupper = [2.048, 1.024]\n";
  std::string const narrow = "[[charge]]\nradius = 0.03\nposition = [1, 0.464]\n";
  EXPECT_TRUE(read(head + narrow + walls + "[adaptive]\nfinest = \"8 mm\"\n").case_);
}

TEST_F(Levels, BlocksThatDoNotDivideTheDomainAreTold) {
  auto const result =
      read("[end]\ntime = 1e-3\n[domain]\ngeometry = \"planar2d\"\nsize = [2.112, 1.024]\ncell = \"64 mm\"\n" + charge +
           "[numerics]\nblock_cells = 16\n[adaptive]\nfinest = \"32 mm\"\n");
  ASSERT_TRUE(result.case_);
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_NE(result.warnings[0].find("the domain cannot be divided into such blocks along x"), std::string::npos)
      << result.warnings[0];
}

TEST_F(Levels, ChargesThatAreRemappedHaveNoCells) {
  auto const result =
      read("start = \"remap\"\n" + head + charge + "[adaptive]\nfinest = \"8 mm\"\ncharges = \"8 mm\"\n");
  ASSERT_TRUE(result.case_) << deck::format(result.errors.front());
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_NE(result.warnings[0].find("has no effect with start = \"remap\""), std::string::npos) << result.warnings[0];
}

TEST(OneLevel, IsWhatAProgramWithoutP4estHas) {
  if (grid::Forest::can_refine(2)) GTEST_SKIP() << "built with p4est";
  auto const result = read(head + charge + "[adaptive]\nfinest = \"8 mm\"\n");
  ASSERT_EQ(result.errors.size(), 1U);
  EXPECT_NE(result.errors[0].message.find("built without p4est"), std::string::npos) << result.errors[0].message;
}

}  // namespace
}  // namespace brisance
