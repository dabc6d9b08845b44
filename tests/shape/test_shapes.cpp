// Primitives, combinations, volumes.
#include <gtest/gtest.h>

#include <random>

#include "core/error.hpp"
#include "meshes.hpp"
#include "shape/shape.hpp"

using namespace brisance;
using namespace brisance::shape;
using grid::Geometry;

namespace {

constexpr double pi = std::numbers::pi;
// What the docstring of `volume` promises.
constexpr double in_3d = 1e-5;
constexpr double in_2d = 1e-5;

Vec3 const oblique = [] {
  Vec3 const a{0.3, -0.5, 0.7};
  return (1.0 / norm(a)) * a;
}();

/// A combination that is the shape itself, so that its volume comes from lines.
Shape by_lines(Shape const& shape) {
  Box const b = bounds(shape);
  Vec3 const margin{1.0, 1.0, 1.0};
  return combine(Operation::intersection, {shape, Box{b.lower - margin, b.upper + margin}});
}

Shape plate_with_hole() {
  return combine(Operation::difference,
                 {Box{{-0.5, -0.4, 0.0}, {0.5, 0.4, 0.02}}, Cylinder{{0.1, 0.05, 0.01}, 0.15, 1.0, {0.0, 0.0, 1.0}}});
}

std::vector<Shape> primitives() {
  Vec3 const c{0.11, -0.07, 0.23};
  return {Sphere{c, 0.3},
          Hemisphere{c, 0.3, {0.0, 0.0, 1.0}},
          Hemisphere{c, 0.3, {-1.0, 0.0, 0.0}},
          Cylinder{c, 0.2, 0.7, {0.0, 0.0, 1.0}},
          Cylinder{c, 0.2, 0.7, {1.0, 0.0, 0.0}},
          Cylinder{c, 0.2, 0.7, oblique},
          Box{{-0.1, 0.2, -0.3}, {0.4, 0.5, 0.6}}};
}

/// Points inside counted in the box around a shape.
double counted_volume(Shape const& shape, int n) {
  Box const b = bounds(shape);
  Vec3 const size = b.upper - b.lower;
  long hits = 0;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        hits +=
            contains(shape, b.lower + Vec3{(i + 0.5) / n * size[0], (j + 0.5) / n * size[1], (k + 0.5) / n * size[2]})
                ? 1
                : 0;
      }
    }
  }
  return size[0] * size[1] * size[2] * static_cast<double>(hits) / std::pow(n, 3);
}

}  // namespace

TEST(Primitives, VolumesInClosedForm) {
  double const R = 0.3;
  double const ball = 4.0 / 3.0 * pi * R * R * R;
  EXPECT_DOUBLE_EQ(volume(Sphere{{}, R}, Geometry::cartesian3d), ball);
  EXPECT_DOUBLE_EQ(volume(Sphere{{}, R}, Geometry::planar2d), pi * R * R);
  EXPECT_DOUBLE_EQ(volume(Sphere{{}, R}, Geometry::planar1d), 2.0 * R);
  EXPECT_DOUBLE_EQ(volume(Sphere{{}, R}, Geometry::axisymmetric2d), ball);
  EXPECT_DOUBLE_EQ(volume(Hemisphere{{}, R, {0.0, 1.0, 0.0}}, Geometry::axisymmetric2d), 0.5 * ball);
  EXPECT_DOUBLE_EQ(volume(Cylinder{{}, R, 0.5, {0.0, 1.0, 0.0}}, Geometry::axisymmetric2d), 0.5 * pi * R * R);
  EXPECT_DOUBLE_EQ(volume(Cylinder{{}, R, 0.5, {0.0, 0.0, 1.0}}, Geometry::planar2d), pi * R * R);
  EXPECT_DOUBLE_EQ(volume(Box{{1.0, 0.0, 0.0}, {2.0, 1.0, 1.0}}, Geometry::spherical1d), 4.0 / 3.0 * pi * 7.0);
  EXPECT_TRUE(std::isinf(volume(Everywhere{}, Geometry::cartesian3d)));
  EXPECT_DOUBLE_EQ(equivalent_radius(ball, Geometry::cartesian3d), R);
}

TEST(Primitives, PointsAndLinesAgree) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(-0.6, 0.9);
  std::vector<Shape> all = primitives();
  all.emplace_back(plate_with_hole());
  all.emplace_back(combine(Operation::united, primitives()));
  all.emplace_back(Mesh(test::ball({0.1, 0.2, 0.1}, 0.4, 12), "ball"));
  std::vector<Span> line;
  for (std::size_t s = 0; s < all.size(); ++s) {
    long inside = 0;
    for (int n = 0; n < 4000; ++n) {
      Vec3 const x{at(random), at(random), s == 7 ? 0.03 * at(random) : at(random)};
      spans(all[s], 3, x[1], x[2], line);
      bool on_line = false;
      for (Span const& span : line) on_line = on_line || (x[0] > span.from && x[0] < span.to);
      ASSERT_EQ(contains(all[s], x), on_line) << "shape " << s << " at " << x[0] << " " << x[1] << " " << x[2];
      inside += on_line ? 1 : 0;
    }
    EXPECT_GT(inside, 50) << "shape " << s;
  }
}

TEST(Primitives, CylindersOfAnyAxis) {
  Shape const cylinder = Cylinder{{0.1, 0.2, 0.3}, 0.2, 0.7, oblique};
  EXPECT_DOUBLE_EQ(volume(cylinder, Geometry::cartesian3d), pi * 0.04 * 0.7);
  EXPECT_NEAR(volume(by_lines(cylinder), Geometry::cartesian3d) / (pi * 0.04 * 0.7), 1.0, in_3d);
  // 200^3 points: about 6e4 lie within half a spacing of the surface and err at random, 250 of 2e6.
  EXPECT_NEAR(counted_volume(cylinder, 200) / (pi * 0.04 * 0.7), 1.0, 1e-3);
}

TEST(Combinations, VolumesByLinesAreThoseOfThePrimitives) {
  for (Shape const& shape : primitives()) {
    double const exact = volume(shape, Geometry::cartesian3d);
    EXPECT_NEAR(volume(by_lines(shape), Geometry::cartesian3d) / exact, 1.0, in_3d) << shape.index();
  }
  EXPECT_NEAR(volume(by_lines(Sphere{{0.4, 0.1, 0.0}, 0.3}), Geometry::planar2d), pi * 0.09, in_2d * pi * 0.09);
  EXPECT_NEAR(volume(by_lines(Sphere{{0.0, 0.1, 0.0}, 0.3}), Geometry::axisymmetric2d) / (4.0 / 3.0 * pi * 0.027), 1.0,
              in_2d);
  // In 1D nothing is sampled.
  EXPECT_DOUBLE_EQ(volume(by_lines(Sphere{{}, 0.3}), Geometry::spherical1d), 4.0 / 3.0 * pi * 0.027);
}

TEST(Combinations, ClosedForms) {
  double const plate = 1.0 * 0.8 * 0.02;
  EXPECT_NEAR(volume(plate_with_hole(), Geometry::cartesian3d) / (plate - pi * 0.0225 * 0.02), 1.0, in_3d);
  EXPECT_NEAR(volume(plate_with_hole(), Geometry::planar2d) / (0.8 - pi * 0.0225), 1.0, in_2d);

  for (Vec3 const& axis : {Vec3{0.0, 1.0, 0.0}, Vec3{1.0, 0.0, 0.0}, oblique}) {
    Shape const ring = tube({0.2, 0.1, -0.4}, 0.2, 0.3, 0.5, axis);
    EXPECT_NEAR(volume(ring, Geometry::cartesian3d) / (pi * 0.05 * 0.5), 1.0, in_3d);
  }
  EXPECT_NEAR(volume(tube({0.0, 0.1, 0.0}, 0.2, 0.3, 0.5, {0.0, 1.0, 0.0}), Geometry::axisymmetric2d), pi * 0.05 * 0.5,
              in_2d * 0.1);

  // Two spheres with their centres one radius apart: the lens holds 5/12 pi R^3.
  double const R = 0.3;
  Shape const a = Sphere{{0.0, 0.0, 0.0}, R};
  Shape const b = Sphere{{0.0, R, 0.0}, R};
  double const lens = 5.0 / 12.0 * pi * R * R * R;
  double const ball = 4.0 / 3.0 * pi * R * R * R;
  EXPECT_NEAR(volume(combine(Operation::intersection, {a, b}), Geometry::cartesian3d) / lens, 1.0, in_3d);
  EXPECT_NEAR(volume(combine(Operation::united, {a, b}), Geometry::cartesian3d) / (2.0 * ball - lens), 1.0, in_3d);
  EXPECT_NEAR(volume(combine(Operation::difference, {a, b}), Geometry::cartesian3d) / (ball - lens), 1.0, in_3d);

  // Nested: a shell with a bore, minus a half.
  Shape const shell = combine(Operation::difference, {Sphere{{}, 0.4}, Sphere{{}, 0.3}});
  Shape const half = combine(Operation::difference, {shell, Box{{-1.0, -1.0, -1.0}, {1.0, 1.0, 0.0}}});
  EXPECT_NEAR(volume(half, Geometry::cartesian3d) / (2.0 / 3.0 * pi * (0.064 - 0.027)), 1.0, in_3d);
  EXPECT_DOUBLE_EQ(volume(shell, Geometry::spherical1d), 4.0 / 3.0 * pi * (0.064 - 0.027));

  // Boxes meet their breaks: exact.
  Shape const frame = combine(Operation::difference,
                              {Box{{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}, Box{{0.137, 0.311, 0.0}, {0.729, 0.9003, 2.0}}});
  EXPECT_NEAR(volume(frame, Geometry::cartesian3d), 1.0 - (0.729 - 0.137) * (0.9003 - 0.311), 1e-13);
  EXPECT_TRUE(std::isinf(volume(combine(Operation::difference, {Everywhere{}, a}), Geometry::cartesian3d)));
  EXPECT_EQ(volume(combine(Operation::intersection, {a, Sphere{{2.0, 0.0, 0.0}, R}}), Geometry::cartesian3d), 0.0);
  EXPECT_THROW((void)combine(Operation::united, {}), InputError);
}

TEST(Combinations, BoundsAndCentre) {
  Shape const two = combine(Operation::united, {Sphere{{0.0, 0.0, 0.0}, 1.0}, Sphere{{4.0, 1.0, 0.0}, 2.0}});
  EXPECT_EQ(bounds(two).lower, (Vec3{-1.0, -1.0, -2.0}));
  EXPECT_EQ(bounds(two).upper, (Vec3{6.0, 3.0, 2.0}));
  EXPECT_EQ(centre(two), (Vec3{2.5, 1.0, 0.0}));
  EXPECT_EQ(centre(plate_with_hole()), (Vec3{0.0, 0.0, 0.01}));
}

TEST(FillFraction, SumsToTheVolumeInAllGeometries) {
  for (Geometry const g : {Geometry::cartesian3d, Geometry::planar2d, Geometry::axisymmetric2d, Geometry::planar1d,
                           Geometry::cylindrical1d, Geometry::spherical1d}) {
    grid::Domain domain;
    domain.geometry = g;
    domain.h = 0.05;
    int const dims = grid::dimensions(g);
    domain.cells = {20, dims > 1 ? 20 : 1, dims > 2 ? 20 : 1};
    Vec3 const c = dims == 1 ? Vec3{0.0, 0.0, 0.0} : Vec3{grid::radial_exponent(g) > 0 ? 0.0 : 0.5, 0.47, 0.51};
    if (g == Geometry::planar1d) domain.lower[0] = -0.5;
    Shape const shell = combine(Operation::difference, {Sphere{c, 0.4}, Sphere{c, 0.23}});
    double sum = 0.0;
    int full = 0;
    for (int k = 0; k < domain.cells[2]; ++k) {
      for (int j = 0; j < domain.cells[1]; ++j) {
        for (int i = 0; i < domain.cells[0]; ++i) {
          double const f = fill_fraction(shell, domain, {i, j, k});
          ASSERT_GE(f, 0.0);
          ASSERT_LE(f, 1.0);
          full += f == 1.0 ? 1 : 0;
          sum += f * domain.cell_volume(i);
        }
      }
    }
    EXPECT_GT(full, 0);
    // 16 lines per cell and direction.
    EXPECT_NEAR(sum / volume(shell, g), 1.0, dims == 1 ? 1e-12 : 1e-4) << word_of(g);
  }
}

TEST(FillFraction, CombinationsAndPrimitivesAgree) {
  grid::Domain domain;
  domain.h = 0.1;
  domain.cells = {10, 10, 10};
  Shape const sphere = Sphere{{0.5, 0.45, 0.52}, 0.33};
  Shape const combined = by_lines(sphere);
  for (int k = 0; k < 10; ++k) {
    for (int j = 0; j < 10; ++j) {
      for (int i = 0; i < 10; ++i) {
        // 16^3 points against 16^2 lines.
        ASSERT_NEAR(fill_fraction(sphere, domain, {i, j, k}), fill_fraction(combined, domain, {i, j, k}), 5e-3);
      }
    }
  }
}

TEST(Sections, OfMeshesInFewerDirections) {
  Mesh const cube(test::cube({0.0, 0.1, 0.2}, {0.5, 0.4, 0.8}), "cube");
  EXPECT_NEAR(volume(cube, Geometry::cartesian3d), 0.5 * 0.3 * 0.6, 1e-15);
  EXPECT_NEAR(volume(cube, Geometry::planar2d), 0.5 * 0.3, 1e-13);
  EXPECT_NEAR(volume(cube, Geometry::axisymmetric2d), pi * 0.25 * 0.3, 1e-13);
  EXPECT_NEAR(volume(cube, Geometry::planar1d), 0.5, 1e-15);
  EXPECT_NEAR(volume(cube, Geometry::spherical1d), 4.0 / 3.0 * pi * 0.125, 1e-15);
}
