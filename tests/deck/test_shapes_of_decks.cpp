/// Shapes as decks give them: the bodies that come of the keys.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "deck/deck.hpp"
#include "files.hpp"

namespace brisance {
namespace {

using grid::Geometry;

constexpr double pi = std::numbers::pi;

struct Given {
  char const* geometry;
  char const* keys;
  double volume;  ///< [m3], per metre in the plane
  Vec3 inside;    ///< a point of it
  Vec3 outside;   ///< a point beside it
  double tolerance = 1e-5;
};

std::string deck_with(Given const& given, char const* table) {
  std::string const geometry = given.geometry;
  bool const three = geometry == "cartesian3d";
  return fmt::format(
      "[domain]\ngeometry = \"{}\"\nsize = {}\ncell = 0.05\n[[charge]]\n{}[end]\ntime = 1e-3\n[[{}]]\n{}\n", geometry,
      three ? "[4, 4, 4]" : "[4, 4]",
      three                          ? "position = [3.5, 3.5, 3.5]\nradius = 0.1\n"
      : geometry == "axisymmetric2d" ? "position = [0, 3.5]\nradius = 0.1\n"
                                     : "position = [3.5, 3.5]\nradius = 0.1\n",
      table, given.keys);
}

shape::Shape obstacle_of(Given const& given) {
  auto const result = deck::read_text(deck_with(given, "obstacle"), "deck");
  std::string errors;
  for (auto const& error : result.errors) errors += deck::format(error) + "\n";
  if (!result.case_) throw std::runtime_error(errors);
  return result.case_->obstacles.front().shape;
}

class ShapeOfADeck : public testing::TestWithParam<Given> {};

TEST_P(ShapeOfADeck, IsWhereAndAsLargeAsItsKeysSay) {
  Given const& given = GetParam();
  shape::Shape const shape = obstacle_of(given);
  Geometry const geometry = *value_of<Geometry>(given.geometry);
  if (std::isfinite(given.volume)) {
    EXPECT_NEAR(shape::volume(shape, geometry) / given.volume, 1.0, given.tolerance);
  }
  EXPECT_TRUE(shape::contains(shape, given.inside));
  EXPECT_FALSE(shape::contains(shape, given.outside));
}

constexpr double infinite = std::numeric_limits<double>::infinity();

INSTANTIATE_TEST_SUITE_P(
    Keys, ShapeOfADeck,
    testing::Values(
        Given{"cartesian3d",
              "shape = \"cone\"\nradius = 0.5\nlength = 1\nposition = [1, 1, 1]\nnormal = \"-z\"",
              pi * 0.25 / 3.0,
              {1.0, 1.4, 0.9},
              {1.0, 1.4, 0.5}},
        Given{"cartesian3d",
              "shape = \"cone\"\nradius = 0.5\ntop_radius = 0.25\nlength = 1\nposition = [1, 1, 1]\nnormal = \"+x\"",
              pi / 3.0 * (0.25 + 0.125 + 0.0625),
              {1.9, 1.2, 1.0},
              {0.9, 1.0, 1.0}},
        Given{"cartesian3d",
              "shape = \"ogive\"\nradius = 0.5\nlength = 0.5\nposition = [1, 1, 1]\nnormal = \"-y\"",
              2.0 / 3.0 * pi * 0.125,
              {1.0, 0.6, 1.0},
              {1.0, 1.1, 1.0},
              3e-5},
        Given{"cartesian3d",
              "shape = \"torus\"\nradius = 0.5\ntube_radius = 0.2\nposition = [1, 1, 1]\naxis = \"x\"",
              2.0 * pi* pi * 0.5 * 0.04,
              {1.0, 1.0, 1.5},
              {1.0, 1.0, 1.0}},
        Given{"cartesian3d",
              "shape = \"extrusion\"\npoints = [[0, 0], [1, 0], [0, \"50 cm\"]]\nlength = 2\nposition = [1, 1, "
              "1]\naxis = \"y\"",
              0.5,
              {1.1, 2.9, 1.6},
              {1.4, 2.9, 1.6}},
        Given{"cartesian3d",
              "shape = \"extrusion\"\npoints = [[0, 0], [1000, 0], [1000, 500]]\nscale = 0.001\nlength = 2",
              0.5,
              {0.9, 0.4, 1.9},
              {0.9, 0.46, 1.9}},
        Given{"cartesian3d",
              "shape = \"turned\"\npoints = [[0.2, 0], [0.4, 0], [0.4, 1], [0.2, 1]]\nposition = [1, 1, 1]",
              pi*(0.16 - 0.04),
              {1.3, 1.0, 1.9},
              {1.0, 1.0, 1.5}},
        Given{"cartesian3d",
              "shape = \"half_space\"\nposition = [0, 0, 1]\nnormal = \"-z\"\n"
              "rotate = [{axis = \"y\", angle = \"45 deg\"}]",
              infinite,
              {0.2, 3.0, 0.7},
              {0.2, 3.0, 0.9}},
        Given{"cartesian3d",
              "shape = \"box\"\nlower = [1, 1, 1]\nupper = [2, 1.2, 3]\n"
              "rotate = [{angle = 90, about = [1, 1, 1]}, {axis = [0, 1, 0], angle = 30}]",
              0.4,
              {0.5, 1.5, 1.31},
              {0.9, 1.5, 1.2}},
        Given{"cartesian3d",
              "shape = \"cylinder\"\nradius = 0.2\nlength = 2\nposition = [2, 2, 2]\naxis = \"x\"\n"
              "rotate = [{axis = \"z\", angle = 90}]",
              pi * 0.04 * 2.0,
              {2.0, 2.9, 2.0},
              {2.9, 2.0, 2.0}},
        Given{"planar2d",
              "shape = \"polygon\"\npoints = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]\nposition = [1, 1]",
              3.0,
              {1.5, 2.9, 0.0},
              {2.5, 2.5, 0.0}},
        Given{"planar2d",
              "shape = \"box\"\nposition = [2, 2]\nsize = [2, 0.2]\nrotate = [{angle = \"12 deg\"}]",
              0.4,
              {2.9, 2.19, 0.0},
              {2.9, 2.0, 0.0}},
        Given{"planar2d",
              "shape = \"half_space\"\nposition = [2, 0]\nnormal = \"-y\"\nrotate = [{angle = 30}]",
              infinite,
              {3.0, 0.5, 0.0},
              {3.0, 0.6, 0.0}},
        Given{"axisymmetric2d",
              "shape = \"cone\"\nradius = 0.5\nlength = 1\nposition = [0, 2]\nnormal = \"-y\"",
              pi * 0.25 / 3.0,
              {0.4, 1.9, 0.0},
              {0.4, 2.1, 0.0}},
        Given{"axisymmetric2d",
              "shape = \"ogive\"\nradius = 0.5\nlength = 0.5\nposition = [0, 1]",
              2.0 / 3.0 * pi * 0.125,
              {0.1, 1.4, 0.0},
              {0.1, 0.9, 0.0},
              3e-5},
        Given{"axisymmetric2d",
              "shape = \"torus\"\nradius = 0.5\ntube_radius = 0.2\nposition = [0, 1]",
              2.0 * pi* pi * 0.5 * 0.04,
              {0.5, 1.1, 0.0},
              {0.1, 1.0, 0.0}},
        Given{"axisymmetric2d",
              "shape = \"polygon\"\npoints = [[0.5, 0], [0.7, 0], [0.2, 1], [0, 1]]\nposition = [0, 1]",
              pi / 3.0 * (0.49 + 0.14 + 0.04 - 0.25),
              {0.35, 1.5, 0.0},
              {0.1, 1.5, 0.0}},
        Given{"axisymmetric2d",
              "shape = \"turned\"\npoints = [[0, 0], [0.5, 0], [0, 1]]\nposition = [0, 1]",
              pi * 0.25 / 3.0,
              {0.1, 1.7, 0.0},
              {0.4, 1.7, 0.0}}),
    [](auto const& given) { return "Case" + std::to_string(given.index); });

// The mass of a drawn charge is that of its volume, whole and where planes of symmetry quarter it.
TEST(DrawnCharge, HasTheMassOfItsVolume) {
  double const volume = pi * 0.04 * 0.5 / 3.0;
  for (char const* place : {"[1, 1, 1]", "[0, 0, 1]"}) {
    auto const result = deck::read_text(
        fmt::format(
            "[domain]\nsize = [2, 2, 2]\ncell = 0.05\n[boundaries]\nx_low = \"symmetry\"\ny_low = \"symmetry\"\n"
            "[[charge]]\nshape = \"cone\"\nradius = 0.2\nlength = 0.5\nposition = {}\n[end]\ntime = 1e-3\n",
            place),
        "deck");
    ASSERT_TRUE(result.case_.has_value());
    auto const& charge = result.case_->charges.front();
    EXPECT_NEAR(charge.mass / (volume * charge.explosive.density()), 1.0, 1e-9);
  }
}

// A house of 0.4 x 0.8 x 0.8 m on cells of 50 mm, and a tower that stands between cells.
TEST(GaugesOnObstacles, StandOnTheirFaces) {
  auto const result = deck::read_text(R"([domain]
size = [2, 2, 2]
cell = "50 mm"
[[charge]]
mass = "0.5 kg"
position = [0.5, 0.5, 0.5]
[[obstacle]]
name = "house"
shape = "box"
lower = [1.2, 0.6, 0]
upper = [1.6, 1.4, 0.8]
[[obstacle]]
name = "tower"
shape = "turned"
points = [[0, 0], [0.21, 0], [0.21, 1], [0, 1.2]]
position = [0.5, 1.7, 0]
[[gauge]]
obstacle = "house"
face = "x_low"
[[gauge]]
obstacle = "house"
face = "z_high"
[[gauge]]
obstacle = "tower"
face = "y_low"
[[gauge]]
snap = true
line = {from = [1.15, 1.03, 0.3], to = [1.65, 1.03, 0.3], count = 6}
[end]
time = "3 ms"
)",
                                      "deck");
  ASSERT_TRUE(result.case_.has_value()) << deck::format(result.errors.front());
  std::vector<Vec3> const expected{{1.2, 1.0, 0.4},   {1.4, 1.0, 0.8},  {0.5, 1.5, 0.6},
                                   {1.15, 1.03, 0.3}, {1.2, 1.03, 0.3}, {1.2, 1.03, 0.3},
                                   {1.6, 1.03, 0.3},  {1.6, 1.03, 0.3}, {1.65, 1.03, 0.3}};
  ASSERT_EQ(result.case_->gauges.size(), expected.size());
  for (std::size_t n = 0; n < expected.size(); ++n)
    EXPECT_LT(norm(result.case_->gauges[n].position - expected[n]), 1e-9) << n;
}

}  // namespace
}  // namespace brisance
