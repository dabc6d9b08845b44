// Particles of bodies: mass, centre of mass and radius of gyration against closed forms.
#include <gtest/gtest.h>

#include <chrono>
#include <numeric>
#include <string>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "meshes.hpp"
#include "shape/placement.hpp"

using namespace brisance;
using namespace brisance::shape;
using grid::Boundary;
using grid::Domain;
using grid::Geometry;

namespace {

constexpr double pi = std::numbers::pi;

Domain domain_of(Geometry g, double h, Index3 const& cells, Vec3 const& lower = {0.0, 0.0, 0.0}) {
  Domain domain;
  domain.geometry = g;
  domain.h = h;
  domain.cells = cells;
  domain.lower = lower;
  return domain;
}

struct Moments {
  double volume = 0.0;
  Vec3 centre{0.0, 0.0, 0.0};
  Vec3 square{0.0, 0.0, 0.0};  ///< mean of (x - centre)^2 in each direction
};

Moments moments_of(Placement const& p) {
  Moments m;
  for (std::size_t n = 0; n < p.volumes.size(); ++n) {
    m.volume += p.volumes[n];
    m.centre = m.centre + p.volumes[n] * p.positions[n];
  }
  m.centre = (1.0 / m.volume) * m.centre;
  for (std::size_t n = 0; n < p.volumes.size(); ++n) {
    for (int d = 0; d < 3; ++d) {
      double const r = p.positions[n][d] - m.centre[d];
      m.square[d] += p.volumes[n] * r * r / m.volume;
    }
  }
  return m;
}

}  // namespace

TEST(Placement, BodiesAlongTheGridHoldFullSubCellsOnly) {
  // Sizes that are no binary fractions, far from the origin: round-off is where it hurts.
  for (int const p : {1, 2, 3}) {
    Domain const domain = domain_of(Geometry::cartesian3d, 0.1, {30, 20, 25}, {100.3, -7.7, 0.9});
    Box const box{{100.3 + 0.7, -7.7 + 0.3, 0.9}, {100.3 + 1.9, -7.7 + 1.1, 0.9 + 2.5}};
    auto const placed = place_particles(box, domain, p);
    ASSERT_EQ(placed.volumes.size(), 12U * 8U * 25U * p * p * p);
    double const s = 0.1 / p;
    for (double const v : placed.volumes) ASSERT_DOUBLE_EQ(v, s * s * s);
    EXPECT_NEAR(placed.volume, 1.2 * 0.8 * 2.5, 1e-12);
  }
}

TEST(Placement, OrderIsCellByCell) {
  Domain const domain = domain_of(Geometry::cartesian3d, 1.0, {4, 4, 4});
  auto const placed = place_particles(Box{{1.0, 1.0, 1.0}, {3.0, 3.0, 3.0}}, domain, 2);
  ASSERT_EQ(placed.positions.size(), 64U);
  std::size_t n = 0;
  for (int cell = 0; cell < 8; ++cell) {
    for (int sub = 0; sub < 8; ++sub, ++n) {
      for (int d = 0; d < 3; ++d) {
        EXPECT_DOUBLE_EQ(placed.positions[n][d], 1.0 + ((cell >> d) & 1) + 0.25 + 0.5 * ((sub >> d) & 1));
      }
    }
  }
}

TEST(Placement, BoxesAcrossTheGridAreExact) {
  Domain const domain = domain_of(Geometry::cartesian3d, 0.1, {10, 10, 10});
  Box const box{{0.213, 0.15, 0.1}, {0.777, 0.85, 0.9}};
  auto const placed = place_particles(box, domain, 2);
  Moments const m = moments_of(placed);
  EXPECT_NEAR(m.volume, 0.564 * 0.7 * 0.8, 1e-13);    // round-off of 2688 terms
  EXPECT_EQ(placed.volumes.size(), 12U * 14U * 16U);  // 0.213 leaves 0.74, 0.777 0.54 of a sub-cell
  EXPECT_NEAR(*std::min_element(placed.volumes.begin(), placed.volumes.end()), 0.54 * 0.05 * 0.05 * 0.05, 1e-15);
}

TEST(Placement, MomentsOfRoundBodiesIn3D) {
  double const h = 0.06;  // 5 cells in a radius
  double const R = 0.3;
  Domain const domain = domain_of(Geometry::cartesian3d, h, {20, 20, 20});
  Mesh const ball(test::ball({0.6, 0.6, 0.6}, R, 60), "ball");
  struct Case {
    std::string name;
    Shape shape;
    double volume;
    Vec3 centre, square;
  };
  double const v_ball = 4.0 / 3.0 * pi * R * R * R;
  auto const even = [](double q) { return Vec3{q, q, q}; };
  for (double const shift : {0.0, 0.017, 0.0291}) {
    Vec3 const c{0.6 + shift, 0.6 - 0.7 * shift, 0.6 + 0.3 * shift};
    Vec3 const a{0.6, 0.0, 0.8};
    auto const cylinder = [&](double along, double L) {
      return R * R / 4.0 * (1.0 - along * along) + L * L / 12.0 * along * along;
    };
    // A hollow cylinder, 0.3 and 0.15 in radius: differences of moments.
    double const outer = pi * R * R * 0.5;
    double const inner = 0.25 * outer;
    double const ring = (outer * R * R / 4.0 - inner * R * R / 16.0) / (outer - inner);
    std::vector<Case> const cases{
        {"sphere", Sphere{c, R}, v_ball, c, even(R * R / 5.0)},
        {"half",
         Hemisphere{c, R, {0.0, 1.0, 0.0}},
         0.5 * v_ball,
         c + Vec3{0.0, 0.375 * R, 0.0},
         {R * R / 5.0, R * R * (0.2 - 0.140625), R * R / 5.0}},
        {"cylinder",
         Cylinder{c, R, 0.5, {0.0, 0.0, 1.0}},
         pi * R * R * 0.5,
         c,
         {cylinder(0.0, 0.5), cylinder(0.0, 0.5), cylinder(1.0, 0.5)}},
        {"oblique",
         Cylinder{c, R, 0.4, a},
         pi * R * R * 0.4,
         c,
         {cylinder(0.6, 0.4), cylinder(0.0, 0.4), cylinder(0.8, 0.4)}},
        {"tube", tube(c, 0.5 * R, R, 0.5, {0.0, 0.0, 1.0}), outer - inner, c, {ring, ring, 0.25 / 12.0}},
        {"mesh", ball, ball.volume(), {0.6, 0.6, 0.6}, even(R * R / 5.0)},
    };
    for (Case const& body : cases) {
      auto const placed = place_particles(body.shape, domain, 2);
      Moments const m = moments_of(placed);
      bool const sampled = body.name == "tube";
      EXPECT_NEAR(m.volume / body.volume, 1.0, sampled ? 1e-4 : 1e-12) << body.name;
      EXPECT_NEAR(m.volume / placed.volume, 1.0, 1e-12) << body.name;
      // A fiftieth of a cell: faces that cut a layer of sub-cells move its mass by up to half of one.
      for (int d = 0; d < 3; ++d) EXPECT_NEAR(m.centre[d], body.centre[d], 0.02 * h) << body.name << " " << d;
      double const asked = std::sqrt(body.square[0] + body.square[1] + body.square[2]);
      EXPECT_NEAR(std::sqrt(m.square[0] + m.square[1] + m.square[2]) / asked, 1.0, 5e-3) << body.name;
      double const s = 0.5 * h;
      for (double const v : placed.volumes) {
        ASSERT_GT(v, 0.24 * s * s * s) << body.name;  // a quarter, but for the scaling
        ASSERT_LT(v, 2.0 * s * s * s) << body.name;
      }
    }
  }
}

TEST(Placement, PlateWithHole) {
  Domain const domain = domain_of(Geometry::cartesian3d, 0.02, {50, 50, 6});
  Shape const plate = combine(Operation::difference, {Box{{0.0, 0.0, 0.04}, {1.0, 1.0, 0.08}},
                                                      Cylinder{{0.5, 0.5, 0.06}, 0.133, 1.0, {0.0, 0.0, 1.0}}});
  auto const placed = place_particles(plate, domain, 2);
  Moments const m = moments_of(placed);
  EXPECT_NEAR(m.volume / (0.04 * (1.0 - pi * 0.133 * 0.133)), 1.0, 1e-4);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(m.centre[d], (Vec3{0.5, 0.5, 0.06})[d], 1e-6);
  double const s = 0.01;
  long full = 0;
  for (double const v : placed.volumes) full += std::abs(v / (s * s * s) - 1.0) < 1e-12 ? 1 : 0;
  // All but the rim of the hole: 4 layers of 10000 less 556, with some 100 in the rim.
  EXPECT_GT(full, 4 * (10000 - 556 - 120));
  EXPECT_LT(full, static_cast<long>(placed.volumes.size()));
}

TEST(Placement, RoundBodiesInAllGeometries) {
  double const R = 0.3;
  double const ball = 4.0 / 3.0 * pi * R * R * R;
  Mesh const mesh(test::ball({0.0, 0.6, 0.0}, R, 90), "ball");
  struct Case {
    Geometry geometry;
    Shape shape;
    double volume;
    double tolerance;
  };
  Vec3 const on_axis{0.0, 0.6, 0.0};
  std::vector<Case> const cases{
      {Geometry::planar2d, Sphere{{0.61, 0.6, 0.0}, R}, pi * R * R, 1e-12},
      {Geometry::planar2d, Cylinder{{0.61, 0.6, 0.0}, R, 1.0, {0.0, 0.0, 1.0}}, pi * R * R, 1e-12},
      {Geometry::planar2d, Cylinder{{0.61, 0.6, 0.0}, R, 0.5, {0.0, 1.0, 0.0}}, 2.0 * R * 0.5, 1e-12},
      {Geometry::axisymmetric2d, Sphere{on_axis, R}, ball, 1e-12},
      {Geometry::axisymmetric2d, Hemisphere{on_axis, R, {0.0, 1.0, 0.0}}, 0.5 * ball, 1e-12},
      {Geometry::axisymmetric2d, Cylinder{on_axis, R, 0.44, {0.0, 1.0, 0.0}}, pi * R * R * 0.44, 1e-12},
      {Geometry::axisymmetric2d, tube(on_axis, 0.17, R, 0.44, {0.0, 1.0, 0.0}), pi * (R * R - 0.0289) * 0.44, 1e-6},
      // Beside the axis a sphere is a torus (Pappus).
      {Geometry::axisymmetric2d, Sphere{{0.5, 0.6, 0.0}, R}, pi * R * R * 2.0 * pi * 0.5, 1e-6},
      // Parallels and meridians of 2 degrees: a mesh of 180 corners around.
      {Geometry::axisymmetric2d, mesh, ball, 1e-3},
      {Geometry::planar1d, Box{{0.213, 0.0, 0.0}, {0.777, 1.0, 1.0}}, 0.564, 1e-12},
      {Geometry::cylindrical1d, Cylinder{{0.0, 0.0, 0.0}, R, 1.0, {0.0, 0.0, 1.0}}, pi * R * R, 1e-12},
      {Geometry::spherical1d, Sphere{{0.0, 0.0, 0.0}, R}, ball, 1e-12},
      {Geometry::spherical1d, combine(Operation::difference, {Sphere{{}, R}, Sphere{{}, 0.17}}),
       4.0 / 3.0 * pi * (R * R * R - 0.004913), 1e-12},
  };
  for (std::size_t n = 0; n < cases.size(); ++n) {
    Case const& body = cases[n];
    int const dims = grid::dimensions(body.geometry);
    Domain const domain = domain_of(body.geometry, 0.06, {20, dims > 1 ? 20 : 1, 1});
    auto const placed = place_particles(body.shape, domain, 2);
    double const sum = std::accumulate(placed.volumes.begin(), placed.volumes.end(), 0.0);
    EXPECT_NEAR(sum / body.volume, 1.0, body.tolerance) << "case " << n;
    for (Vec3 const& x : placed.positions) {
      for (int d = dims; d < 3; ++d) ASSERT_DOUBLE_EQ(x[d], domain.centre({0, 0, 0})[d]) << "case " << n;
    }
    if (body.geometry != Geometry::axisymmetric2d) continue;
    Moments const m = moments_of(placed);
    double const middle = std::holds_alternative<Hemisphere>(body.shape) ? 0.6 + 0.375 * R : 0.6;
    EXPECT_NEAR(m.centre[1], middle, 0.02 * domain.h) << "case " << n;
  }
}

TEST(Placement, RingsAlongTheGridAreFull) {
  Domain const domain = domain_of(Geometry::axisymmetric2d, 0.1, {12, 10, 1});
  auto const placed = place_particles(Cylinder{{0.0, 0.5, 0.0}, 0.7, 0.6, {0.0, 1.0, 0.0}}, domain, 2);
  ASSERT_EQ(placed.volumes.size(), 14U * 12U);
  for (std::size_t n = 0; n < placed.volumes.size(); ++n)
    EXPECT_NEAR(placed.volumes[n] / (2.0 * pi * placed.positions[n][0] * 0.05 * 0.05), 1.0, 1e-12);
}

TEST(Placement, BodiesCutByTheDomain) {
  double const R = 0.3;
  Domain const domain = domain_of(Geometry::cartesian3d, 0.06, {10, 10, 20});
  double const ball = 4.0 / 3.0 * pi * R * R * R;
  auto const quarter = place_particles(Sphere{{0.0, 0.0, 0.61}, R}, domain, 2);
  EXPECT_NEAR(quarter.volume / (0.25 * ball), 1.0, 1e-12);
  // Cut off centre: a cap of height 0.1, pi h^2 (R - h/3), is left.
  auto const cap = place_particles(Sphere{{-0.2, 0.3, 0.61}, R}, domain, 2);
  EXPECT_NEAR(cap.volume / (pi * 0.01 * (R - 0.1 / 3.0)), 1.0, 1e-3);
  EXPECT_NEAR(moments_of(cap).volume / cap.volume, 1.0, 1e-12);
  auto const all = place_particles(Everywhere{}, domain, 1);
  EXPECT_EQ(all.volumes.size(), 2000U);
  EXPECT_NEAR(all.volume, 0.6 * 0.6 * 1.2, 1e-12);
  EXPECT_TRUE(place_particles(Sphere{{9.0, 0.0, 0.0}, R}, domain, 2).positions.empty());
  EXPECT_THROW((void)place_particles(Sphere{{0.3, 0.3, 0.6}, R}, domain, 0), InputError);
}

TEST(Placement, SheetsThinnerThanASubCell) {
  Domain const domain = domain_of(Geometry::cartesian3d, 0.1, {10, 10, 10});
  for (int d = 0; d < 3; ++d) {
    Box sheet{{0.2, 0.2, 0.2}, {0.8, 0.8, 0.8}};
    sheet.lower[d] = 0.512;
    sheet.upper[d] = 0.517;
    auto const placed = place_particles(sheet, domain, 2);
    EXPECT_EQ(placed.positions.size(), 144U);
    EXPECT_NEAR(moments_of(placed).volume, 0.36 * 0.005, 1e-15);
  }
}

TEST(Placement, SameOnAnyNumberOfThreads) {
  Domain const domain = domain_of(Geometry::cartesian3d, 0.03, {40, 40, 40});
  Shape const body = tube({0.6, 0.61, 0.59}, 0.21, 0.4, 0.7, {0.6, 0.0, 0.8});
  set_threads(1);
  auto const one = place_particles(body, domain, 2);
  set_threads(4);
  auto const four = place_particles(body, domain, 2);
  set_threads(0);
  EXPECT_EQ(one.positions, four.positions);
  EXPECT_EQ(one.volumes, four.volumes);
}

TEST(Placement, AMillionParticlesInSeconds) {
  Domain const domain = domain_of(Geometry::cartesian3d, 0.01, {100, 100, 100});
  Mesh const ball(test::ball({0.5, 0.5, 0.5}, 0.32, 100), "ball");
  auto const start = std::chrono::steady_clock::now();
  auto const placed = place_particles(ball, domain, 2);
  double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_GT(placed.positions.size(), 1'000'000U);
  EXPECT_LT(seconds, 10.0);  // 0.2 s when measured; room for sanitizers and busy machines
}
