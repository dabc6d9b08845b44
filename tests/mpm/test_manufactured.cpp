// A manufactured solution: a square between mirror planes is driven by an acceleration such that its displacement is
//     u_x = a g(t) sin(pi x) cos(pi y),   u_y = b g(t) cos(pi x) sin(pi y),   g = (1 - cos w t)^2,
// which has dilation and shear, and starts at rest with no acceleration, so that the half step between velocity and
// position leaves no trace. The acceleration follows from the equation of motion, small strain:
//     rho u_tt = (lambda + mu) grad div u + mu laplace u + rho f.
#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double a = 1e-5;  // strains of 1e-4: their squares are far below the errors of the grids
constexpr double b = -0.4e-5;
constexpr double w = 2.0;
constexpr double nu = 0.3;

double g(double t) { return (1.0 - std::cos(w * t)) * (1.0 - std::cos(w * t)); }
double g_second(double t) {
  double const c = std::cos(w * t);
  return 2.0 * w * w * (1.0 - c * c + (1.0 - c) * c);
}

/// Acceleration that drives the solution, for unit density and Young's modulus, at the place x of the material.
Vec3 drive(Vec3 const& x, double t) {
  double const shear = 1.0 / (2.0 * (1.0 + nu));
  double const lambda = nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  double const stiff = pi * pi * (lambda + shear) * (a + b);
  double const fx = a * g_second(t) + (stiff + 2.0 * shear * pi * pi * a) * g(t);
  double const fy = b * g_second(t) + (stiff + 2.0 * shear * pi * pi * b) * g(t);
  return {fx * std::sin(pi * x[0]) * std::cos(pi * x[1]), fy * std::cos(pi * x[0]) * std::sin(pi * x[1]), 0.0};
}

/// Root mean square of the error in displacement over the amplitude, at t = 1.2 (g is 3 there).
double displacement_error(ShapeFunction shape, int cells) {
  Problem problem;
  problem.options.shape = shape;
  problem.options.acceleration = drive;
  problem.box(grid::Geometry::planar2d, 1.0 / cells, {cells, cells, 1}, grid::Boundary::symmetry);
  int const body = problem.add(unit_solid(nu));
  problem.start();
  problem.fill(body, shape::Everywhere{});
  double const end = 1.2;
  double const dt = end / (4.0 * cells);  // Courant number 0.35
  for (int n = 0; n < 4 * cells; ++n) problem.mpm->advance(dt);
  double const square = problem.sum(body, [&](mpm::ParticleSet const& set, int q) {
    Vec3 const x = Problem::origin(set, q);
    Vec3 const exact{a * g(end) * std::sin(pi * x[0]) * std::cos(pi * x[1]),
                     b * g(end) * std::cos(pi * x[0]) * std::sin(pi * x[1]), 0.0};
    Vec3 const error = Problem::position(set, q) - x - exact;
    return dot(error, error);
  });
  return std::sqrt(square / static_cast<double>(mpm::particle_count(*problem.mpm))) / (a * g(end));
}

class Manufactured : public testing::TestWithParam<ShapeFunction> {};

INSTANTIATE_TEST_SUITE_P(Shapes, Manufactured, testing::ValuesIn(all_shapes),
                         [](auto const& one) { return word_of(one.param); });

TEST_P(Manufactured, ConvergesInDisplacement) {
  std::array<double, 3> error{};
  for (int n = 0; n < 3; ++n) error[n] = displacement_error(GetParam(), 16 << n);
  double const first = std::log2(error[0] / error[1]);
  double const second = std::log2(error[1] / error[2]);
  std::printf("%-8s errors %.2e %.2e %.2e orders %.2f %.2f\n", word_of(GetParam()), error[0], error[1], error[2], first,
              second);
  EXPECT_GE(second, 1.8);  // all parts of the method are of second order in space and time
  EXPECT_LT(error[2], 2e-2);
}

TEST(Manufactured, WorkOfTheAccelerationIsBooked) {
  Problem problem;
  problem.options.acceleration = drive;
  problem.box(grid::Geometry::planar2d, 1.0 / 16, {16, 16, 1}, grid::Boundary::symmetry);
  int const body = problem.add(unit_solid(nu));
  problem.start();
  problem.fill(body, shape::Everywhere{});
  for (int n = 0; n < 64; ++n) problem.mpm->advance(1.2 / 64);
  mpm::BodySums const sums = mpm::sums(*problem.mpm, body);
  // To the half step between velocity and position, 1/128 of the time, and the truncation of a coarse grid.
  EXPECT_NEAR(sums.kinetic_energy + sums.internal_energy, problem.mpm->accounts().outer_work,
              0.05 * problem.mpm->accounts().outer_work);
  EXPECT_GT(problem.mpm->accounts().outer_work, 0.0);
}

}  // namespace
}  // namespace brisance::test
