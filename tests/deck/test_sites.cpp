/// Buildings and terrains as decks give them: files beside the deck, and what becomes of them on the grid.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "deck/deck.hpp"
#include "files.hpp"
#include "grid/cell.hpp"
#include "setup/solid_cells.hpp"

namespace brisance {
namespace {

class Site : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              fmt::format("brisance_site_{}", testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(std::string const& name, std::string const& text) const { std::ofstream(folder_ / name) << text; }

  /// A deck of 40 x 40 x 10 m in cells of 1 m, or of 40 x 10 m.
  [[nodiscard]] deck::Result read(std::string const& tables, char const* geometry = "cartesian3d") const {
    bool const flat = std::string(geometry) != "cartesian3d";
    bool const radial = std::string(geometry) == "axisymmetric2d";
    write("deck.toml",
          fmt::format("[domain]\ngeometry = \"{}\"\nlower = {}\nsize = {}\ncell = 1\n[end]\ntime = 1e-3\n{}", geometry,
                      radial ? "[0, 0]"
                      : flat ? "[-20, 0]"
                             : "[-20, -20, 0]",
                      flat ? "[40, 10]" : "[40, 40, 10]", tables));
    return deck::read_file((folder_ / "deck.toml").string());
  }

  [[nodiscard]] std::string errors(std::string const& tables, char const* geometry = "cartesian3d") const {
    std::string all;
    for (auto const& error : read(tables, geometry).errors) all += deck::format(error) + "\n";
    return all;
  }

  [[nodiscard]] run::Case good(std::string const& tables, char const* geometry = "cartesian3d") const {
    auto const result = read(tables, geometry);
    if (!result.case_) throw std::runtime_error(deck::format(result.errors.front()));
    return *result.case_;
  }

  std::filesystem::path folder_;
};

std::vector<std::uint8_t> solid_cells(run::Case const& c) { return setup::SolidCells(c.domain, c.obstacles).all(); }

std::string const street = R"({"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"height": 8}, "geometry": {"type": "MultiPolygon", "coordinates":
  [[[[-20, -20], [-4, -20], [-4, -4], [-20, -4], [-20, -20]]], [[[4, 4], [20, 4], [20, 20], [4, 20], [4, 4]]]]}},
{"type": "Feature", "properties": {"height": 6}, "geometry": {"type": "Polygon", "coordinates":
  [[[4, -20], [20, -20], [20, -4], [4, -4], [4, -20]]]}},
{"type": "Feature", "properties": {"height": 6}, "geometry": {"type": "Polygon", "coordinates":
  [[[-20, 4], [-20, 20], [-4, 20], [-4, 4], [-20, 4]]]}}]})";

// Four houses from a file are the cells of the four boxes.
TEST_F(Site, AStreetIsThatOfBoxes) {
  write("street.geojson", street);
  auto const from_file = good("[[obstacle]]\nshape = \"buildings\"\nfile = \"street.geojson\"\n");
  std::string boxes;
  for (auto const* box : {"lower = [-20, -20, 0]\nupper = [-4, -4, 8]", "lower = [4, 4, 0]\nupper = [20, 20, 8]",
                          "lower = [4, -20, 0]\nupper = [20, -4, 6]", "lower = [-20, 4, 0]\nupper = [-4, 20, 6]"})
    boxes += fmt::format("[[obstacle]]\nshape = \"box\"\n{}\n", box);
  auto const cells = solid_cells(from_file);
  EXPECT_EQ(cells, solid_cells(good(boxes)));
  EXPECT_EQ(std::count(cells.begin(), cells.end(), 1), 16 * 16 * 2 * (8 + 6));
  // Turned by a quarter around the crossing it is another street; turned twice it is the same.
  std::string const turned = "[[obstacle]]\nshape = \"buildings\"\nfile = \"street.geojson\"\nrotate = [{angle = ";
  EXPECT_NE(solid_cells(good(turned + "90}]\n")), cells);
  EXPECT_EQ(solid_cells(good(turned + "180}]\n")), cells);
}

// z = 4 + x / 10: half the cells of each column below the slope, and the whole of it on average.
TEST_F(Site, ATerrainFillsWhatLiesBelowIt) {
  write("ground.csv", "x,y,z\n-20,-20,2\n20,-20,6\n-20,20,2\n20,20,6\n");
  std::string const plain = "[[obstacle]]\nshape = \"terrain\"\nfile = \"ground.csv\"\n";
  auto const c = good(plain);
  EXPECT_NEAR(shape::volume(c.obstacles[0].shape, c.domain.geometry), 1600.0 * 4.0, 1e-6);
  EXPECT_EQ(shape::bounds(c.obstacles[0].shape).lower[2], 0.0) << "the face of the domain";
  auto const cells = solid_cells(c);
  for_each_cell(c.domain.all_cells(), [&](Index3 const& at) {
    double const height = 4.0 + 0.1 * (-20.0 + at[0] + 0.5);
    if (std::abs(height - at[2] - 0.5) < 1e-6) return;
    EXPECT_EQ(cells[c.domain.all_cells().offset(at)] == 1, at[2] + 0.5 < height) << at[0] << " " << at[2];
  });
  EXPECT_EQ(shape::bounds(good(plain + "bottom = -3\n").obstacles[0].shape).lower[2], -3.0);
  // Where the ground reaches the face of the domain the bottom lies a cell below.
  EXPECT_EQ(shape::bounds(good(plain + "position = [0, 0, -2]\n").obstacles[0].shape).lower[2], -1.0);
  EXPECT_NE(
      errors(plain + "bottom = 2\n").find("obstacle[1].bottom: 2 is not below the lowest height of the file, 2 m"),
      std::string::npos);
}

TEST_F(Site, ATerrainCoversTheDomain) {
  write("ground.csv", "x,y,z\n-20,-20,2\n10,-20,5\n-20,20,2\n10,20,5\n");
  std::string const plain = "[[obstacle]]\nshape = \"terrain\"\nfile = \"ground.csv\"\n";
  EXPECT_NE(errors(plain).find("the terrain does not reach the corner [20, -20] m of the domain: it extends from [-20, "
                               "-20] to [10, 20] m"),
            std::string::npos)
      << errors(plain);
  auto const wide = good(plain + "extend = true\n");
  EXPECT_TRUE(shape::contains(wide.obstacles[0].shape, {19.0, 0.0, 4.9}));
  EXPECT_FALSE(shape::contains(wide.obstacles[0].shape, {19.0, 0.0, 5.1}));
  auto const turned = good(plain + "extend = true\nrotate = [{angle = 45}]\n");
  EXPECT_TRUE(shape::contains(turned.obstacles[0].shape, {19.9, 19.9, 4.9}));
  EXPECT_NE(errors(plain + "origin = [100, 0]\n").find("lie between -120 and -90 m in direction x, outside the domain"),
            std::string::npos);
  // A body or a part of one need not cover it.
  EXPECT_EQ(errors("[[body]]\nmaterial = \"soil\"\nrigid = true\nvelocity = [1, 0, 0]\nshape = \"terrain\"\nfile = "
                   "\"ground.csv\"\n"),
            "");
}

TEST_F(Site, AProfileIsATerrainInTwoDimensions) {
  write("profile.csv", "x,z\n-20,2\n0,4\n20,2\n");
  std::string const plain = "[[obstacle]]\nshape = \"terrain\"\nfile = \"profile.csv\"\n";
  auto const c = good(plain, "planar2d");
  EXPECT_NEAR(shape::volume(c.obstacles[0].shape, c.domain.geometry), 120.0, 1e-6);
  EXPECT_NE(errors(plain, "axisymmetric2d").find("its profile reaches the radius -20 m"), std::string::npos);
  write("profile.csv", "x,z\n0,4\n20,2\n");
  EXPECT_NE(errors(plain, "planar2d").find("does not reach the corner [-20] m"), std::string::npos);
  EXPECT_EQ(errors(plain + "extend = true\n", "planar2d"), "");
  // A hill around the axis: a cone and the disc below it.
  write("profile.csv", "x,z\n0,6\n40,2\n");
  auto const hill = good(plain, "axisymmetric2d");
  double const expected = std::numbers::pi * 1600.0 * (2.0 + 4.0 / 3.0);
  EXPECT_NEAR(shape::volume(hill.obstacles[0].shape, hill.domain.geometry) / expected, 1.0, 1e-5);
}

// Charges, initial states and bodies take the same shapes.
TEST_F(Site, AllThatHasAShapeMayHaveThese) {
  write("stack.csv", "building,x,y,height\na,0,0,1.5\na,2,0,1.5\na,2,2,1.5\na,0,2,1.5\n");
  std::string const keys = "shape = \"buildings\"\nfile = \"stack.csv\"\n";
  auto const charge = good("[[charge]]\n" + keys);
  EXPECT_NEAR(charge.charges[0].mass / (6.0 * charge.charges[0].explosive.density()), 1.0, 1e-5);
  EXPECT_EQ(errors("[[initial_state]]\npressure = 2e5\n" + keys), "");
  EXPECT_EQ(errors("[[body]]\nmaterial = \"RHA\"\nvelocity = [1, 0, 0]\n" + keys), "");
}

TEST_F(Site, FaultsOfFilesStandAtTheirKeys) {
  write("street.geojson", street);
  write("ground.csv", "x,y,z\n-20,-20,2\n20,-20,6\n-20,20,2\n");
  std::string const plain = "[[obstacle]]\nshape = \"buildings\"\nfile = \"street.geojson\"\n";
  EXPECT_NE(errors(plain + "height_property = \"storeys\"\n").find("obstacle[1].file: file"), std::string::npos);
  EXPECT_NE(errors(plain + "terrain = \"ground.csv\"\n").find("obstacle[1].terrain: file"), std::string::npos);
  std::string const far = errors(plain + "origin = [691000, 5334000]\n");
  EXPECT_NE(far.find("the buildings of the file lie between -691020 and -690980 m in direction x"), std::string::npos)
      << far;
  EXPECT_NE(errors(plain + "origin = [1]\n").find("[1] is no point of the file; write x and y, or x, y and z"),
            std::string::npos);
}

TEST(Sites, TheDeckOfTheTestsIsGood) {
  auto const result = deck::read_file((test::root() / "tests/deck/good/street.toml").string());
  ASSERT_TRUE(result.case_) << deck::format(result.errors.front());
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
  auto const& houses = result.case_->obstacles[1].shape;
  // z = 2 + x / 20: the lowest corner of the first house lies 1.25 m high, that of the courtyard 2.225 m.
  EXPECT_TRUE(shape::contains(houses, {-10.0, -10.0, 7.2}));
  EXPECT_FALSE(shape::contains(houses, {-10.0, -10.0, 7.3}));
  EXPECT_TRUE(shape::contains(houses, {7.0, 7.0, 7.7}));
  EXPECT_FALSE(shape::contains(houses, {7.0, 7.0, 7.75}));
  EXPECT_FALSE(shape::contains(houses, {9.0, 9.0, 3.0})) << "the courtyard";
  EXPECT_TRUE(shape::contains(houses, {-12.0, 10.0, 5.2})) << "the default height";
}

}  // namespace
}  // namespace brisance
