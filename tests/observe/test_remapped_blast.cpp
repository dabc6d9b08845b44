// A burst that was remapped against the same burst in spherical symmetry throughout: what the gauges read. The full
// comparison in 3D, with its convergence, is `validation/run remap`.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "../run/cases.hpp"
#include "output/gauges.hpp"
#include "watched.hpp"

namespace brisance::observe::test {
namespace {

using namespace output;

using grid::Boundary;
using grid::Geometry;

constexpr double radius = 0.05;
constexpr std::array distances{0.25, 0.3, 0.35, 0.4, 0.45};
constexpr double end = 0.26e-3;

run::Case burst_of_one_direction(double h) {
  run::Case c = run::air_case(Geometry::spherical1d, {static_cast<int>(0.8 / h), 1, 1}, h, Boundary::outflow);
  c.domain.boundary[0] = Boundary::symmetry;
  c.charges = {run::tnt_charge(shape::Sphere{{0.0, 0.0, 0.0}, radius}, c.domain.geometry)};
  for (double const d : distances) c.gauges.push_back({fmt::format("{}", d), {d, 0.0, 0.0}});
  return c;
}

/// A part of the burst between mirror planes, remapped when its shock is at three charge radii.
run::Case remapped(Geometry geometry, double h, std::vector<Vec3> const& directions) {
  int const cells = static_cast<int>(0.52 / h);
  bool const flat = geometry != Geometry::cartesian3d;
  run::Case c = run::air_case(geometry, {cells, cells, flat ? 1 : cells}, h, Boundary::outflow);
  for (int d = 0; d < c.domain.dimensions(); ++d) c.domain.boundary[2 * d] = Boundary::symmetry;
  c.charges = {run::tnt_charge(shape::Sphere{{0.0, 0.0, 0.0}, radius}, Geometry::cartesian3d)};
  c.start.remap = true;
  c.start.radius = 3.0 * radius;
  for (double const d : distances) {
    for (Vec3 const& v : directions) c.gauges.push_back({fmt::format("{}", d), (d / norm(v)) * v});
  }
  return c;
}

std::vector<BlastWave> waves_of(run::Case const& setup) {
  Watched world(setup);
  run::advance_to(world, end);
  std::vector<BlastWave> waves;
  for (auto const& summary : summarise(world.setup, world.gauges.gas)) waves.push_back(summary.wave);
  return waves;
}

struct Limits {
  double arrival, impulse, peak, front, scatter;
};

void compare(run::Case const& setup, std::size_t directions, Limits const& limits) {
  static std::vector<BlastWave> const fine = waves_of(burst_of_one_direction(0.25e-3));
  auto const waves = waves_of(setup);
  ASSERT_EQ(waves.size(), directions * distances.size());
  for (std::size_t n = 0; n < distances.size(); ++n) {
    double least = 1e300;
    double most = 0.0;
    for (std::size_t k = 0; k < directions; ++k) {
      BlastWave const& w = waves[directions * n + k];
      ASSERT_TRUE(w.arrival_time);
      double const arrival = *w.arrival_time / *fine[n].arrival_time - 1.0;
      double const impulse = w.positive_impulse / fine[n].positive_impulse - 1.0;
      double const peak = w.peak_overpressure / fine[n].peak_overpressure - 1.0;
      EXPECT_LT(std::abs(arrival), limits.arrival) << distances[n] << ", direction " << k;
      EXPECT_LT(std::abs(impulse), limits.impulse) << distances[n] << ", direction " << k;
      EXPECT_LT(std::abs(peak), limits.peak) << distances[n] << ", direction " << k;
      double front = 0.0;
      if (limits.front > 0.0) {
        ASSERT_TRUE(w.front_overpressure && fine[n].front_overpressure);
        front = *w.front_overpressure / *fine[n].front_overpressure - 1.0;
        EXPECT_LT(std::abs(front), limits.front) << distances[n] << ", direction " << k;
        least = std::min(least, *w.front_overpressure);
        most = std::max(most, *w.front_overpressure);
      } else {
        least = std::min(least, w.peak_overpressure);
        most = std::max(most, w.peak_overpressure);
      }
      fmt::print("{:.2f} m, direction {}: arrival {:+.2f} %, impulse {:+.2f} %, peak {:+.1f} %, front {:+.1f} %\n",
                 distances[n], k, 100.0 * arrival, 100.0 * impulse, 100.0 * peak, 100.0 * front);
    }
    EXPECT_LT(2.0 * (most - least) / (most + least), limits.scatter) << distances[n];
  }
}

TEST(RemappedBlast, AxisymmetricIsTheSphericalOne) {
  // 20 cells per charge radius, and what is asked for there; the peak in the record is clipped by the grid.
  std::vector<Vec3> const directions{{1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}, {0.0, 1.0, 0.0}, {0.92, 0.39, 0.0}};
  compare(remapped(Geometry::axisymmetric2d, 2.5e-3, directions), directions.size(), {0.01, 0.05, 0.10, 0.05, 0.03});
}

TEST(RemappedBlast, ThreeDimensionalIsTheSphericalOne) {
  // Five cells per charge radius are what a test has time for.
  std::vector<Vec3> const directions{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0},
                                     {1.0, 1.0, 0.0}, {0.0, 1.0, 1.0}, {1.0, 1.0, 1.0}};
  compare(remapped(Geometry::cartesian3d, 10e-3, directions), directions.size(), {0.025, 0.06, 0.28, 0.0, 0.14});
}

}  // namespace
}  // namespace brisance::observe::test
