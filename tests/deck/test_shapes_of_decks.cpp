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
  bool const line = geometry.ends_with("1d");
  return fmt::format(
      "[domain]\ngeometry = \"{}\"\nsize = {}\ncell = 0.05\n[[charge]]\n{}[end]\ntime = 1e-3\n[[{}]]\n{}\n", geometry,
      three  ? "[4, 4, 4]"
      : line ? "4"
             : "[4, 4]",
      three                          ? "position = [3.5, 3.5, 3.5]\nradius = 0.1\n"
      : geometry == "spherical1d"    ? "radius = 0.1\n"
      : line                         ? "shape = \"box\"\nlower = 3.6\nupper = 3.7\n"
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
              {0.4, 1.7, 0.0}},
        // Scaled about `position`, then turned, then moved.
        Given{"cartesian3d",
              "shape = \"sphere\"\nradius = 0.2\nposition = [1, 1, 1]\nscale = 2\ntranslate = [1, 0, 0.5]",
              4.0 / 3.0 * pi * 0.064,
              {2.0, 1.0, 1.89},
              {1.0, 1.0, 1.0}},
        Given{"cartesian3d",
              "shape = \"hemisphere\"\nradius = 0.4\nposition = [1, 1, 1]\nscale = 0.5\n"
              "rotate = [{axis = \"x\", angle = -90}]\ntranslate = [0, 1, 0]",
              2.0 / 3.0 * pi * 0.008,
              {1.0, 2.19, 1.0},
              {1.0, 1.99, 1.0}},
        Given{"cartesian3d",
              "shape = \"cylinder\"\nradius = 0.1\nlength = 0.5\nposition = [1, 1, 1]\nscale = 2\n"
              "rotate = [{axis = \"y\", angle = 90}]\ntranslate = [\"50 cm\", 0, 0]",
              pi * 0.04,
              {1.99, 1.0, 1.19},
              {1.5, 1.0, 1.4}},
        Given{"cartesian3d",
              "shape = \"box\"\nlower = [1, 1, 1]\nupper = [2, 1.2, 3]\nscale = 0.5\ntranslate = [0, 1, 0]",
              0.05,
              {1.26, 2.1, 2.49},
              {1.2, 2.1, 2.0}},
        Given{"cartesian3d",
              "shape = \"cone\"\nradius = 0.25\nlength = 0.5\nposition = [1, 1, 1]\nscale = 2\n"
              "rotate = [{axis = \"y\", angle = 90}]\ntranslate = [0, 1, 0]",
              pi * 0.25 / 3.0,
              {1.9, 2.0, 1.0},
              {1.0, 2.0, 1.9}},
        Given{"cartesian3d",
              "shape = \"ogive\"\nradius = 1\nlength = 1\nposition = [1, 1, 1]\nscale = 0.5\ntranslate = [0, 0, 1]",
              2.0 / 3.0 * pi * 0.125,
              {1.0, 1.0, 2.49},
              {1.0, 1.0, 1.9},
              3e-5},
        Given{"cartesian3d",
              "shape = \"torus\"\nradius = 1\ntube_radius = 0.4\nposition = [1, 1, 1]\nscale = 0.5\n"
              "translate = [1, 1, 1]",
              2.0 * pi* pi * 0.5 * 0.04,
              {2.5, 2.0, 2.0},
              {2.0, 2.0, 2.0}},
        Given{"cartesian3d",
              "shape = \"turned\"\npoints = [[200, 0], [400, 0], [400, 1000], [200, 1000]]\nposition = [1, 1, 1]\n"
              "scale = 0.001\nrotate = [{axis = \"y\", angle = 90}]\ntranslate = [0, 0, 1]",
              pi*(0.16 - 0.04),
              {1.9, 1.3, 2.0},
              {1.5, 1.0, 2.0}},
        Given{"cartesian3d",
              "shape = \"half_space\"\nposition = [0, 0, 1]\nnormal = \"-z\"\ntranslate = [0, 0, 0.5]",
              infinite,
              {2.0, 3.0, 1.49},
              {2.0, 3.0, 1.51}},
        Given{"planar2d",
              "shape = \"cylinder\"\nradius = 0.2\nposition = [1, 1]\nscale = 2\ntranslate = [1, 0.5]",
              pi * 0.16,
              {2.0, 1.89, 0.0},
              {1.0, 1.0, 0.0}},
        Given{"planar2d",
              "shape = \"box\"\nposition = [1, 1]\nsize = [1, 0.1]\nscale = 2\nrotate = [{angle = \"12 deg\"}]\n"
              "translate = [1, 1]",
              0.4,
              {2.9, 2.19, 0.0},
              {2.9, 2.0, 0.0}},
        Given{"planar2d",
              "shape = \"polygon\"\npoints = [[0, 0], [2000, 0], [2000, 1000]]\nposition = [1, 1]\nscale = 0.001\n"
              "rotate = [{angle = 90}]\ntranslate = [1, 0]",
              1.0,
              {1.1, 2.9, 0.0},
              {1.4, 2.0, 0.0}},
        Given{"axisymmetric2d",
              "shape = \"cylinder\"\nradius = 0.25\nlength = 0.5\nposition = [0, 1]\nscale = 2\ntranslate = [0, 1]",
              pi * 0.25,
              {0.4, 2.4, 0.0},
              {0.4, 1.4, 0.0}},
        Given{"axisymmetric2d",
              "shape = \"box\"\nlower = [1, 1]\nupper = [1.4, 1.4]\nscale = 0.5\ntranslate = [-0.5, 1]",
              pi*(0.64 - 0.36) * 0.2,
              {0.65, 2.15, 0.0},
              {1.2, 1.2, 0.0}},
        Given{"axisymmetric2d",
              "shape = \"ogive\"\nradius = 1\nlength = 1\nposition = [0, 1]\nscale = 0.5\ntranslate = [0, 1]",
              2.0 / 3.0 * pi * 0.125,
              {0.1, 2.4, 0.0},
              {0.1, 1.9, 0.0},
              3e-5},
        Given{"planar1d",
              "shape = \"box\"\nlower = 1\nupper = 2\nscale = 0.5\ntranslate = 1",
              0.5,
              {2.7, 0.0, 0.0},
              {2.8, 0.0, 0.0}},
        Given{"spherical1d",
              "shape = \"box\"\nlower = 1\nupper = 1.4\nscale = 0.5\ntranslate = 1",
              4.0 / 3.0 * pi*(12.167 - 9.261),
              {2.2, 0.0, 0.0},
              {2.0, 0.0, 0.0}}),
    [](auto const& given) { return "Case" + std::to_string(given.index); });

shape::Shape body_of(std::string const& domain, std::string const& keys) {
  auto const result = deck::read_text(
      fmt::format("[domain]\n{}\ncell = 0.05\n[[body]]\nmaterial = \"RHA\"\n{}\n[end]\ntime = 1e-3\n", domain, keys),
      "deck");
  std::string errors;
  for (auto const& error : result.errors) errors += deck::format(error) + "\n";
  if (!result.case_) throw std::runtime_error(errors);
  return result.case_->particles.bodies.front().shape;
}

// A plate with a boss, a hole and a cut-off end, as the sum of its parts; then all of it enlarged, turned by a right
// angle about its `position` and moved. The part that is cut out has a motion of its own, too.
TEST(MovedComposition, MovesWithAllItsParts) {
  std::string const domain = "size = [4, 4, 4]";
  std::string const plate =
      "shape = \"box\"\nposition = [1, 1, 1]\nsize = [0.8, 0.4, 0.2]\n"
      "add = [{shape = \"sphere\", radius = 0.2, position = [1, 1, 1]}]\n"
      "cut = [{shape = \"cylinder\", radius = 0.025, length = 0.5, position = [0, 1, 1], scale = 2, "
      "translate = [0.75, 0, 0]}]\n"
      "common = [{shape = \"half_space\", position = [1.3, 1, 1], normal = \"-x\"}]\n";
  shape::Shape const still = body_of(domain, plate);
  shape::Shape const moved =
      body_of(domain, plate + "whole = {scale = 2, rotate = [{angle = 90}], translate = [1, 0.5, 0.5]}\n");
  int inside = 0;
  for (double x = 0.51; x < 1.5; x += 0.037) {
    for (double y = 0.71; y < 1.3; y += 0.043) {
      for (double z = 0.71; z < 1.3; z += 0.041) {
        Vec3 const there{2.0 - 2.0 * (y - 1.0), 1.5 + 2.0 * (x - 1.0), 1.5 + 2.0 * (z - 1.0)};
        EXPECT_EQ(shape::contains(moved, there), shape::contains(still, {x, y, z})) << x << " " << y << " " << z;
        inside += shape::contains(still, {x, y, z}) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(inside, 500);
  double const ratio = shape::volume(moved, Geometry::cartesian3d) / shape::volume(still, Geometry::cartesian3d);
  EXPECT_NEAR(ratio / 8.0, 1.0, 2e-3);  // by lines along x, which see other sections
}

// In the plane and around the axis; there along the axis only, unless all parts are rings.
TEST(MovedComposition, MovesInTwoDimensions) {
  std::string const disc =
      "shape = \"cylinder\"\nradius = 0.4\nposition = [1, 1]\n"
      "cut = [{shape = \"box\", position = [1, 1], size = [0.4, 0.1]}]\n";
  shape::Shape const turned =
      body_of("geometry = \"planar2d\"\nsize = [4, 4]", disc + "whole = {scale = 2, rotate = [{angle = 90}]}\n");
  EXPECT_NEAR(shape::volume(turned, Geometry::planar2d) / (pi * 0.64 - 0.16), 1.0, 1e-5);
  EXPECT_FALSE(shape::contains(turned, {1.0, 1.35, 0.0}));
  EXPECT_TRUE(shape::contains(turned, {1.35, 1.0, 0.0}));
  shape::Shape const liner = body_of("geometry = \"axisymmetric2d\"\nsize = [4, 4]",
                                     "shape = \"cone\"\nradius = 0.5\nlength = 1\nposition = [0, 1]\n"
                                     "cut = [{shape = \"cone\", radius = 0.4, length = 0.8, position = [0, 1]}]\n"
                                     "whole = {scale = 2, translate = [0, 0.5]}\n");
  EXPECT_NEAR(shape::volume(liner, Geometry::axisymmetric2d) / (8.0 * pi / 3.0 * (0.25 - 0.128)), 1.0, 1e-5);
  EXPECT_TRUE(shape::contains(liner, {0.9, 1.51, 0.0}));
  EXPECT_FALSE(shape::contains(liner, {0.7, 1.51, 0.0}));
  shape::Shape const ring = body_of("geometry = \"axisymmetric2d\"\nsize = [4, 4]",
                                    "shape = \"box\"\nlower = [1, 1]\nupper = [1.4, 1.4]\n"
                                    "cut = [{shape = \"box\", lower = [1.1, 1.1], upper = [1.3, 1.3]}]\n"
                                    "whole = {rotate = [{angle = 45}], translate = [-0.2, 0]}\n");
  EXPECT_NEAR(shape::volume(ring, Geometry::axisymmetric2d) / (2.0 * pi * 1.0 * (0.16 - 0.04)), 1.0, 1e-5);
}

// A half-space reaches through all of the domain however long that is and however it lies.
TEST(HalfSpace, FillsALongDomainAtAnyAngle) {
  auto const result = deck::read_text(
      "[domain]\ngeometry = \"planar2d\"\nsize = [8, 0.5]\ncell = 0.05\n[[charge]]\nposition = [0.3, 0.3]\n"
      "radius = 0.1\n[[obstacle]]\nshape = \"half_space\"\nposition = [1, 0]\nnormal = \"-y\"\n"
      "rotate = [{angle = 60}]\n[end]\ntime = 1e-3\n",
      "deck");
  ASSERT_TRUE(result.case_.has_value()) << deck::format(result.errors.front());
  for (double x : {1.4, 4.0, 7.9}) {
    EXPECT_TRUE(shape::contains(result.case_->obstacles.front().shape, {x, 0.01, 0.0})) << x;
    EXPECT_TRUE(shape::contains(result.case_->obstacles.front().shape, {x, 0.49, 0.0})) << x;
  }
}

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
