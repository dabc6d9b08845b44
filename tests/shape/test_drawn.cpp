/// Bodies from drawings, and shapes that are turned.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "shape/drawn.hpp"
#include "shape/placement.hpp"
#include "shape/shape.hpp"
#include "shape/surface.hpp"

namespace brisance::shape {
namespace {

using grid::Geometry;

constexpr double pi = std::numbers::pi;
constexpr double round_off = 1e-12;

/// A letter L of three unit squares, and the same with corners in line.
Polygon const corner{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
Polygon const with_corners_in_line{{0, 0}, {1, 0}, {2, 0}, {2, 0.5}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}};

TEST(Polygon, HasItsAreaAsAPrismAndAsASection) {
  for (Polygon polygon : {corner, with_corners_in_line}) {
    for (bool const clockwise : {false, true}) {
      if (clockwise) std::reverse(polygon.begin(), polygon.end());
      Shape const body = prism(polygon, -0.5, 2.0, "it");
      EXPECT_NEAR(volume(body, Geometry::cartesian3d), 7.5, 7.5 * round_off);
      EXPECT_NEAR(volume(prism(polygon, -0.5, 0.5, "it"), Geometry::planar2d), 3.0, 1e-9);
      EXPECT_TRUE(contains(body, {0.5, 1.9, 1.9}));
      EXPECT_FALSE(contains(body, {1.5, 1.5, 1.0}));
    }
  }
}

TEST(Polygon, MayHaveManyCornersAndDeepBays) {
  Polygon comb;
  for (int n = 0; n < 200; ++n) {
    comb.push_back({0.1 * n, n % 2 == 0 ? 1.0 : 0.01});
  }
  comb.push_back({19.9, -1.0});
  comb.push_back({0.0, -1.0});
  EXPECT_NEAR(Mesh(prism(comb, 0.0, 1.0, "it")).volume(), std::abs(area(comb)), 1e-11);
}

std::string why_refused(Polygon const& polygon) {
  try {
    (void)prism(polygon, 0.0, 1.0, "it");
  } catch (InputError const& problem) {
    return problem.what();
  }
  return "";
}

TEST(Polygon, IsRefusedWhereItBoundsNothing) {
  EXPECT_NE(why_refused({{0, 0}, {1, 0}}).find("at least three"), std::string::npos);
  EXPECT_NE(why_refused({{0, 0}, {1, 0}, {1, 1}, {0, 0}}).find("points 4 and 1 are the same"), std::string::npos);
  EXPECT_NE(
      why_refused({{0, 0}, {1, 1}, {1, 0}, {0, 1}}).find("the edge from point 1 to point 2 meets the one from 3 to 4"),
      std::string::npos);
  EXPECT_NE(why_refused({{0, 0}, {2, 0}, {1, 0}}).find("goes back"), std::string::npos);
  EXPECT_NE(why_refused({{0, 0}, {2, 0}, {2, 1}, {1, 0}, {0, 1}}).find("meets"), std::string::npos);
  EXPECT_THROW((void)turned_profile({{-0.1, 0}, {1, 0}, {1, 1}}, "it"), InputError);
}

// Closed forms: frustum, [Pappus] for the ring, and of the ogive by the integral of its section.
TEST(TurnedProfile, HasItsVolume) {
  Mesh const frustum = turned_profile(cone_profile(0.3, 0.1, 0.5), "it");
  EXPECT_NEAR(frustum.volume(), pi * 0.5 / 3.0 * (0.09 + 0.03 + 0.01), 1e-12);
  Mesh const cone = turned_profile(cone_profile(0.3, 0.0, 0.5), "it");
  EXPECT_NEAR(cone.volume(), pi * 0.5 / 3.0 * 0.09, 1e-12);
  EXPECT_NEAR(cone.centre()[2], 0.125, 1e-12);
  Mesh const ring = turned_profile(torus_profile(0.4, 0.1), "it");
  EXPECT_NEAR(ring.volume() / (2.0 * pi * pi * 0.4 * 0.01), 1.0, 1e-12);
  for (double const length : {0.3, 0.9}) {
    double const radius = (0.09 + length * length) / 0.6;
    double exact = 0.0;
    constexpr int steps = 20000;
    for (int n = 0; n < steps; ++n) {
      double const z = (n + 0.5) / steps * length;
      double const r = std::sqrt(radius * radius - z * z) - (radius - 0.3);
      exact += pi * r * r * length / steps;
    }
    Mesh const ogive = turned_profile(ogive_profile(0.3, length), "it");
    EXPECT_NEAR(ogive.volume() / exact, 1.0, 3e-5) << length;
  }
  // At a length of the base's radius it is half a sphere.
  EXPECT_NEAR(turned_profile(ogive_profile(0.3, 0.3), "it").volume() / (2.0 / 3.0 * pi * 0.027), 1.0, 3e-5);
}

// The same body in 3D and as a section in two dimensions around the axis.
TEST(TurnedProfile, IsTheSameBodyInTwoAndThreeDimensions) {
  Polygon const profile = ogive_profile(0.2, 0.7);
  double const whole = turned_profile(profile, "it").volume();
  EXPECT_NEAR(volume(prism(profile, -0.5, 0.5, "it"), Geometry::axisymmetric2d) / whole, 1.0, 1e-5);
}

TEST(Motion, TurnsEveryShapeAlike) {
  std::vector<Shape> const shapes{
      Sphere{{1.0, 0.2, 0.3}, 0.4},
      Hemisphere{{1.0, 0.2, 0.3}, 0.4, {0.0, 1.0, 0.0}},
      Cylinder{{1.0, 0.2, 0.3}, 0.2, 0.7, {1.0, 0.0, 0.0}},
      Box{{0.9, 0.0, 0.1}, {1.4, 0.3, 0.2}},
      HalfSpace{{1.0, 0.1, 0.0}, {0.0, 0.0, 1.0}},
      turned_profile(cone_profile(0.5, 0.2, 0.6), "it", 24),
      combine(Operation::difference, {Box{{0.7, 0.0, 0.0}, {1.4, 0.6, 0.6}}, Sphere{{1.0, 0.2, 0.3}, 0.3}})};
  Vec3 const axis{2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0};
  Motion motion = turn_around(axis, 0.7, {0.3, 0.1, -0.2});
  motion = then({0.5, turn_around({0.0, 1.0, 0.0}, 0.4, {0.0, 0.2, 0.1}).axes, {0.2, -0.1, 0.3}}, motion);
  motion = then(motion, {3.0, {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}}, {0.1, 0.0, 0.0}});
  double const enlarged = std::pow(motion.scale, 3);
  EXPECT_EQ(motion.scale, 1.5);
  std::uint32_t seed = 1;
  auto const random = [&seed] {
    seed = seed * 1664525U + 1013904223U;
    return (seed >> 8) / 16777216.0;
  };
  for (Shape const& shape : shapes) {
    Shape const there = moved(shape, motion);
    int inside = 0;
    for (int n = 0; n < 4000; ++n) {
      Vec3 const x{-0.6 + 2.2 * random(), -0.6 + 1.4 * random(), -0.6 + 1.4 * random()};
      EXPECT_EQ(contains(there, motion.point(x)), contains(shape, x)) << shape.index();
      inside += contains(shape, x) ? 1 : 0;
    }
    EXPECT_GT(inside, 10) << shape.index();
    if (std::isfinite(volume(shape, Geometry::cartesian3d))) {
      EXPECT_NEAR(volume(there, Geometry::cartesian3d) / volume(shape, Geometry::cartesian3d) / enlarged, 1.0, 2e-4)
          << shape.index();
    }
    // The box holds all of it.
    Box const box = bounds(there);
    for (int n = 0; n < 2000; ++n) {
      Vec3 const x = motion.point({-0.6 + 2.2 * random(), -0.6 + 1.4 * random(), -0.6 + 1.4 * random()});
      if (!contains(there, x)) continue;
      for (int d = 0; d < 3; ++d) {
        EXPECT_GE(x[d], box.lower[d] - 1e-12) << shape.index();
        EXPECT_LE(x[d], box.upper[d] + 1e-12) << shape.index();
      }
    }
  }
}

TEST(Motion, QuarterTurnsAreExact) {
  Shape const box = Box{{1.0, 2.0, 3.0}, {1.5, 2.25, 3.125}};
  Shape shape = box;
  for (int n = 0; n < 4; ++n) {
    shape = moved(shape, turn_around({0.0, 0.0, 1.0}, 0.5 * pi, {0.0, 0.0, 0.0}));
    ASSERT_TRUE(std::holds_alternative<Box>(shape));
    if (n == 0) {
      EXPECT_EQ(std::get<Box>(shape).lower, (Vec3{-2.25, 1.0, 3.0}));
    }
  }
  EXPECT_EQ(std::get<Box>(shape).lower, std::get<Box>(box).lower);
  EXPECT_EQ(std::get<Box>(shape).upper, std::get<Box>(box).upper);
}

grid::Domain square(Geometry geometry) {
  grid::Domain domain;
  domain.geometry = geometry;
  domain.cells = {40, 40, 1};
  domain.h = 0.05;
  return domain;
}

// A plate of 1 m x 0.2 m at 12 degrees: volume, first moments and outline of what particles and surface pressures get.
TEST(Motion, ATurnedPlateIsFilledAndBounded) {
  grid::Domain const domain = square(Geometry::planar2d);
  Shape const plate =
      moved(Box{{0.5, 0.9, -0.5}, {1.5, 1.1, 0.5}}, turn_around({0.0, 0.0, 1.0}, 12.0 * pi / 180.0, {1.0, 1.0, 0.0}));
  Placement const placed = place_particles(plate, domain, 2);
  double sum = 0.0;
  Vec3 moment{0.0, 0.0, 0.0};
  for (std::size_t n = 0; n < placed.volumes.size(); ++n) {
    sum += placed.volumes[n];
    moment = moment + placed.volumes[n] * placed.positions[n];
  }
  EXPECT_NEAR(sum, 0.2, 1e-6);
  EXPECT_NEAR(moment[0] / sum, 1.0, 1e-3);
  EXPECT_NEAR(moment[1] / sum, 1.0, 1e-3);
  double outline = 0.0;
  Vec3 closed{0.0, 0.0, 0.0};
  double by_divergence = 0.0;
  for (Facet const& f : surface(plate, Everywhere{}, domain, 0.01)) {
    outline += norm(f.area);
    closed = closed + f.area;
    by_divergence += 0.5 * dot(f.x, f.area);
  }
  EXPECT_NEAR(outline, 2.4, 1e-9);
  EXPECT_NEAR(norm(closed), 0.0, 1e-9);
  EXPECT_NEAR(by_divergence, 0.2, 1e-9);
}

// Half of a domain under a slope: filled, and the slope alone bounds it in the domain.
TEST(HalfSpace, FillsWhatLiesBehindItsPlane) {
  grid::Domain const domain = square(Geometry::planar2d);
  double const angle = 30.0 * pi / 180.0;
  Shape const ground =
      moved(HalfSpace{{1.0, 1.0, 0.0}, {0.0, -1.0, 0.0}}, turn_around({0.0, 0.0, 1.0}, angle, {1.0, 1.0, 0.0}));
  EXPECT_NEAR(volume_inside(ground, domain), 2.0, 1e-6);
  double length = 0.0;
  for (Facet const& f : surface(ground, Everywhere{}, domain, 0.001)) {
    length += norm(f.area);
    EXPECT_NEAR(f.area[0] / f.area[1], -std::tan(angle), 1e-9);
    EXPECT_GT(f.area[1], 0.0);
  }
  EXPECT_NEAR(length, 2.0 / std::cos(angle), 0.003);
}

}  // namespace
}  // namespace brisance::shape
