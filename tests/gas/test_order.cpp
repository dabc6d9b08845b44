/// Observed order of accuracy on smooth linear waves, as in [Stone08]: an acoustic and an entropy wave of small
/// amplitude cross a periodic box once; along x in 1D and 2D-oblique in 3D along the diagonal.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "gas/harness.hpp"

namespace brisance::test {
namespace {

// Small enough for the wave to be linear: steepening adds (gamma + 1)/2 k x amplitude to the relative error.
constexpr double amplitude = 1e-7;
constexpr double gamma = 1.4;

/// L1 error of the density after one period, relative to the amplitude.
double wave_error(bool acoustic, grid::Geometry geometry, int n, gas::Scheme scheme) {
  Problem problem;
  problem.box(geometry, n, 1.0, grid::Boundary::periodic);
  problem.options.scheme = scheme;
  // At Courant 0.8 the errors in space and in time cancel in part, differently on each grid; 0.4 shows the order.
  problem.courant = 0.4;
  int const dims = problem.domain.dimensions();
  // Unit wave number in every direction: the wave travels along the diagonal.
  double const k = 2.0 * std::numbers::pi;
  double const size = std::sqrt(static_cast<double>(dims));
  double const c = std::sqrt(gamma);
  double const flow = acoustic ? 0.0 : 1.0;
  auto const exact = [&](Vec3 const& x, double t) {
    double phase = 0.0;
    for (int d = 0; d < dims; ++d) phase += x[d];
    double const speed = acoustic ? c : flow;
    double const wave = amplitude * std::sin(k * (phase - size * speed * t));
    Mixed s = state(1.0 + wave, 0.0, acoustic ? 1.0 + gamma * wave : 1.0);
    for (int d = 0; d < dims; ++d) s.velocity[d] = (flow + (acoustic ? c * wave : 0.0)) / size;
    return s;
  };
  // Cell averages of a sine differ from its centre values by a factor that cancels between start and end.
  problem.fill([&](Vec3 const& x) { return exact(x, 0.0); });
  double const period = 1.0 / (size * (acoustic ? c : flow));
  problem.run_to(period);
  double error = 0.0;
  problem.for_each_cell([&](int b, int offset, Index3 const& cell) {
    double const rho = problem.gas->fields().at(b, gas::partial_density(0))[offset];
    error += std::abs(rho - exact(problem.domain.centre(cell), period).ambient_density);
  });
  return error / static_cast<double>(problem.domain.cell_count()) / amplitude;
}

class Order : public testing::TestWithParam<std::tuple<bool, grid::Geometry, gas::Scheme>> {};

TEST_P(Order, IsAtLeastOneParticleNine) {
  auto const [acoustic, geometry, scheme] = GetParam();
  int const coarse = geometry == grid::Geometry::planar1d ? 64 : 32;
  double const a = wave_error(acoustic, geometry, coarse, scheme);
  double const b = wave_error(acoustic, geometry, 2 * coarse, scheme);
  double const order = std::log2(a / b);
  std::printf("%s wave, %s, %s: error %.3e at %d, %.3e at %d cells, order %.2f\n", acoustic ? "acoustic" : "entropy",
              geometry == grid::Geometry::planar1d ? "1D" : "3D",
              scheme == gas::Scheme::muscl_hancock ? "muscl_hancock" : "lax_wendroff", a, coarse, b, 2 * coarse, order);
  EXPECT_GE(order, 1.9);
}

INSTANTIATE_TEST_SUITE_P(Waves, Order,
                         testing::Combine(testing::Bool(),
                                          testing::Values(grid::Geometry::planar1d, grid::Geometry::cartesian3d),
                                          testing::Values(gas::Scheme::muscl_hancock)));

// Sound in a stream of water alone, compressed by 5 %: the reference curve follows the density, so the energy that the
// stream carries through a face must too.
TEST(OrderOfWater, SoundIsOfSecondOrder) {
  material::MieGruneisen const water{1000.0, 1480.0, 1.92, 0.1};
  double const rho = 1050.0;
  double const p = 1e8;
  double const stream = 500.0;
  double const c = material::sound_speed(water, rho, p);
  auto const error = [&](int n) {
    Problem problem;
    problem.box(grid::Geometry::planar1d, n, 1.0, grid::Boundary::periodic);
    problem.fluids.eos[0] = water;
    problem.courant = 0.4;
    auto const wave = [](double x) { return amplitude * std::sin(2.0 * std::numbers::pi * x); };
    problem.fill([&](Vec3 const& x) {
      double const w = wave(x[0]);
      return state(rho * (1.0 + w), stream + c * w, p + rho * c * c * w);
    });
    problem.run_to(1.0 / (c + stream));
    double sum = 0.0;
    problem.for_each_cell([&](int b, int offset, Index3 const& cell) {
      double const got = problem.gas->fields().at(b, gas::partial_density(0))[offset];
      sum += std::abs(got / rho - 1.0 - wave(problem.domain.centre(cell)[0]));
    });
    return sum / n / amplitude;
  };
  double const coarse = error(64);
  double const fine = error(128);
  std::printf("sound in water: error %.3e at 64, %.3e at 128 cells, order %.2f\n", coarse, fine,
              std::log2(coarse / fine));
  EXPECT_GE(std::log2(coarse / fine), 1.9);
}

}  // namespace
}  // namespace brisance::test
