// Beams and plate strips in plane strain: natural frequencies, and locking where the material hardly changes its
// volume.
#include <numbers>

#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;
using std::numbers::pi;

/// First mode of a clamped-clamped beam of length 2 with its middle at 0, and its slope's scale: symmetric half.
double clamped_mode(double x) {
  double const b = 2.365020372431352;  // half of 4.730
  return std::cos(b * x) / std::cos(b) - std::cosh(b * x) / std::cosh(b);
}

/// Half a period of a strip of thickness 1 and half length `half_length`, clamped at its end, mirrored in its middle;
/// over that of Kirchhoff's theory.
double clamped_strip(ShapeFunction shape, int through, double half_length, double nu) {
  Problem problem;
  double const h = 1.0 / through;
  int const built_in = 3;  // cells of the strip beyond the clamp
  int const length = static_cast<int>(std::lround(half_length / h));
  problem.box(Geometry::planar2d, h, {length + built_in + 1, through + 4, 1}, Boundary::outflow);
  problem.domain.boundary[0] = Boundary::symmetry;
  problem.options.shape = shape;
  problem.constraints.push_back(
      {shape::Box{{half_length, -1.0, -1.0}, {half_length + 10.0, 10.0, 1.0}}, {true, true, true}, {}, -1});
  problem.add(unit_solid(nu));
  problem.start();
  double const bottom = 2.0 * h;
  double const speed = 1e-6;
  problem.fill(0, shape::Box{{0.0, bottom, -1.0}, {half_length + built_in * h, bottom + 1.0, 1.0}}, [&](Vec3 const& x) {
    return Vec3{0.0, x[0] < half_length ? speed * clamped_mode(x[0] / half_length) : 0.0, 0.0};
  });
  double const D = 1.0 / (12.0 * (1.0 - nu * nu));
  double const L = 2.0 * half_length;
  double const exact = pi / (22.373 * std::sqrt(D / (L * L * L * L)));
  double const dt = 0.5 * h / pressure_wave_speed(problem.bodies[0].solid);
  double const found = half_period(problem, dt, 3.0 * exact, [&] {
    return problem.sum(0, [&](mpm::ParticleSet const& set, int q) {
      double const x = Problem::origin(set, q)[0];
      return x < half_length ? set.field(Field::velocity_y)[q] * clamped_mode(x / half_length) : 0.0;
    });
  });
  return found / exact;
}

class Bending : public testing::TestWithParam<ShapeFunction> {};

INSTANTIATE_TEST_SUITE_P(Shapes, Bending,
                         testing::Values(ShapeFunction::gimp, ShapeFunction::cpgimp, ShapeFunction::bspline),
                         [](auto const& one) { return word_of(one.param); });

// Kirchhoff's value is that of a thin plate: shear and rotation lower the frequency by 7.6 (H/L)^2, here 0.8 %.
// B-splines need more cells through the thickness: their nodes beyond the free faces soften the outer fibres.
TEST_P(Bending, ClampedPlateStrip) {
  double const nu = 0.3;
  int const through = GetParam() == ShapeFunction::bspline ? 6 : 4;
  double const ratio = clamped_strip(GetParam(), through, 15.0, nu);
  std::printf("clamped strip, L/H 30, %d cells through, %s: frequency %+.2f %% of Kirchhoff\n", through,
              word_of(GetParam()), 100.0 * (1.0 / ratio - 1.0));
  EXPECT_NEAR(1.0 / ratio, 1.0, 0.02);
}

/// Half a period of a cantilever of the given slenderness over that of the slender beam in plane strain.
double cantilever(ShapeFunction shape, bool control, double nu) {
  Problem problem;
  int const through = 4;
  double const h = 1.0 / through;
  double const L = 8.0;
  int const length = static_cast<int>(L / h);
  int const built_in = 3;
  problem.box(Geometry::planar2d, h, {length + built_in + 3, through + 4, 1}, Boundary::outflow);
  problem.options.shape = shape;
  problem.options.locking_control = control;
  double const root = built_in * h;
  problem.constraints.push_back({shape::Box{{-1.0, -1.0, -1.0}, {root, 10.0, 1.0}}, {true, true, true}, {}, -1});
  problem.add(unit_solid(nu));
  problem.start();
  double const b = 1.875104068711961;
  double const ratio = (std::cos(b) + std::cosh(b)) / (std::sin(b) + std::sinh(b));
  auto const mode = [&](double x) {
    double const s = b * std::max(0.0, x - root) / L;
    return std::cosh(s) - std::cos(s) - ratio * (std::sinh(s) - std::sin(s));
  };
  problem.fill(0, shape::Box{{0.0, 2.0 * h, -1.0}, {root + L, 2.0 * h + 1.0, 1.0}}, [&](Vec3 const& x) {
    return Vec3{0.0, 1e-6 * mode(x[0]), 0.0};
  });
  double const D = 1.0 / (12.0 * (1.0 - nu * nu));
  double const exact = pi / (b * b * std::sqrt(D / (L * L * L * L)));
  double const dt = 0.5 * h / pressure_wave_speed(problem.bodies[0].solid);
  double const found = half_period(problem, dt, 3.0 * exact, [&] {
    return problem.sum(0, [&](mpm::ParticleSet const& set, int q) {
      return set.field(Field::velocity_y)[q] * mode(Problem::origin(set, q)[0]);
    });
  });
  return found / exact;
}

// Nearly incompressible: the particles of a cell overconstrain it and the beam is too stiff; averaging the volumetric
// strain over the cell frees it. Shear and rotation account for -1.5 % of the frequency at L/H = 8.
TEST(Locking, ControlFreesABendingBeam) {
  double const nu = 0.49;
  for (ShapeFunction const shape : {ShapeFunction::linear, ShapeFunction::gimp, ShapeFunction::bspline}) {
    double const locked = 1.0 / cantilever(shape, false, nu) - 1.0;
    double const freed = 1.0 / cantilever(shape, true, nu) - 1.0;
    std::printf("cantilever, nu 0.49, %s: frequency %+.1f %% without, %+.1f %% with locking control\n", word_of(shape),
                100.0 * locked, 100.0 * freed);
    // What is left is the theory's -1.5 % and the discretisation by 4 cells through the thickness.
    EXPECT_LT(std::abs(freed), 0.05);
    if (shape != ShapeFunction::bspline) {  // which is smooth enough not to lock here
      EXPECT_GT(locked, 0.2);
    }
  }
}

}  // namespace
}  // namespace brisance::test
