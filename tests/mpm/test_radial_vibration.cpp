// Radial vibration of solid spheres and cylinders against closed forms, in every curvilinear geometry.
#include <numbers>

#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;
using std::numbers::pi;

constexpr double nu = 0.25;

double j0(double x) { return std::sin(x) / x; }
double j1(double x) { return std::sin(x) / (x * x) - std::cos(x) / x; }

/// Radial displacement of the first mode at k r, and k R from the free surface: sigma_rr = 0 [Love27, Sec. 196, 199].
double shape_of(bool sphere, double x) {
  if (x < 1e-6) return sphere ? x / 3.0 : x / 2.0;
  return sphere ? j1(x) : std::cyl_bessel_j(1.0, x);
}
double surface_stress(bool sphere, double x) {
  double const G = material::shear_modulus_of(1.0, nu);
  double const stiff = material::bulk_modulus_of(1.0, nu) + 4.0 / 3.0 * G;
  return sphere ? stiff * x * j0(x) - 4.0 * G * j1(x)
                : stiff * x * std::cyl_bessel_j(0.0, x) - 2.0 * G * shape_of(false, x);
}
double first_root(bool sphere) {
  double low = 1.0;
  double high = 3.0;
  for (int n = 0; n < 60; ++n) {
    double const middle = 0.5 * (low + high);
    (surface_stress(sphere, middle) > 0.0 ? low : high) = middle;
  }
  return low;
}

/// Half a period of a body of radius 1 that starts with the velocity of its first mode, over the exact value.
double half_period_ratio(Geometry geometry, bool sphere, ShapeFunction shape, int n) {
  double const k = first_root(sphere);
  double const c = pressure_wave_speed(unit_solid(nu));
  Problem problem;
  double const h = 1.0 / n;
  int const outer = n + 3;
  problem.box(geometry, h, {outer, sphere ? outer : 4, outer}, Boundary::outflow);
  for (int d = 0; d < 3; ++d) problem.domain.boundary[2 * d] = Boundary::symmetry;
  if (!sphere) problem.domain.boundary[3] = Boundary::symmetry;
  problem.options.shape = shape;
  problem.add(unit_solid(nu));
  problem.start();
  auto const radius = [&](Vec3 const& x) {
    switch (geometry) {
      case Geometry::cartesian3d: return norm(x);
      case Geometry::axisymmetric2d: return sphere ? std::hypot(x[0], x[1]) : x[0];
      default: return x[0];
    }
  };
  auto const mode = [&](Vec3 const& x) {
    double const r = radius(x);
    Vec3 v = (shape_of(sphere, k * r) / r) * x;
    if (geometry != Geometry::cartesian3d) v[2] = 0.0;
    if (geometry != Geometry::cartesian3d && (geometry != Geometry::axisymmetric2d || !sphere)) v[1] = 0.0;
    return v;
  };
  shape::Shape body = shape::Sphere{{0.0, 0.0, 0.0}, 1.0};
  bool const upright = geometry == Geometry::axisymmetric2d;
  Vec3 const axis = upright ? Vec3{0.0, 1.0, 0.0} : Vec3{0.0, 0.0, 1.0};
  if (!sphere) body = shape::Cylinder{{0.0, 2.0 * h, 0.0}, 1.0, 4.0 * h, axis};
  problem.fill(0, body, [&](Vec3 const& x) { return 1e-6 * mode(x); });
  double const exact = pi / (k * c);
  double const found = half_period(problem, 0.3 * h / c, 3.0 * exact, [&] {
    return problem.sum(0, [&](mpm::ParticleSet const& set, int q) {
      return set.field(Field::mass)[q] * dot(Problem::get(set, q, Field::velocity_x), mode(Problem::origin(set, q)));
    });
  });
  return found / exact;
}

class Radial : public testing::TestWithParam<ShapeFunction> {};

INSTANTIATE_TEST_SUITE_P(Shapes, Radial, testing::ValuesIn(all_shapes),
                         [](auto const& one) { return word_of(one.param); });

TEST_P(Radial, LinesOfParticles) {
  for (bool const sphere : {true, false}) {
    auto const geometry = sphere ? Geometry::spherical1d : Geometry::cylindrical1d;
    double const coarse = half_period_ratio(geometry, sphere, GetParam(), 40) - 1.0;
    double const fine = half_period_ratio(geometry, sphere, GetParam(), 80) - 1.0;
    std::printf("%s %s: half period off by %+.3f %% (40 cells), %+.3f %% (80)\n", word_of(geometry),
                word_of(GetParam()), 100.0 * coarse, 100.0 * fine);
    // Second order: (k h)^2/12 would be 0.04 % and 0.01 %.
    EXPECT_LT(std::abs(coarse), 4e-4);
    EXPECT_LT(std::abs(fine), 1e-4);
  }
}

TEST_P(Radial, AxisymmetricCylinder) {
  double const off = half_period_ratio(Geometry::axisymmetric2d, false, GetParam(), 40) - 1.0;
  std::printf("axisymmetric cylinder %s: half period off by %+.3f %%\n", word_of(GetParam()), 100.0 * off);
  EXPECT_LT(std::abs(off), 4e-4);  // as the line of particles
}

TEST_P(Radial, AxisymmetricSphere) {
  double const off = half_period_ratio(Geometry::axisymmetric2d, true, GetParam(), 24) - 1.0;
  std::printf("axisymmetric sphere %s: half period off by %+.3f %%\n", word_of(GetParam()), 100.0 * off);
  // The cut particles of the surface carry their volume, but not its shape: a tenth of a cell, 0.4 % of R.
  EXPECT_LT(std::abs(off), 0.004);
}

TEST(RadialOctant, SphereInThreeDimensions) {
  double const off = half_period_ratio(Geometry::cartesian3d, true, ShapeFunction::bspline, 12) - 1.0;
  std::printf("octant of a sphere: half period off by %+.3f %%\n", 100.0 * off);
  EXPECT_LT(std::abs(off), 0.02);  // stairs of a quarter of a cell, 2 % of R
}

}  // namespace
}  // namespace brisance::test
