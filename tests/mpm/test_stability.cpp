// How long a step may be. For B-splines a particle bounds the highest frequency wherever it stands, docs/theory.md,
// "Steps": elastic bodies of disordered particles that tremble in every way neither gain energy at the Courant numbers
// of `Case::courant_of` nor keep it far beyond them.
#include <random>

#include "mpm/harness.hpp"
#include "mpm/shapes/bspline.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

/// Largest kinetic energy over the steps, in units of that at the start.
double growth(Geometry geometry, double courant, int steps) {
  Problem problem;
  double const h = 0.1;
  problem.box(geometry, h, {12, 12, 12}, Boundary::outflow);
  if (geometry == Geometry::axisymmetric2d) problem.domain.boundary[0] = Boundary::symmetry;
  problem.options.shape = ShapeFunction::bspline;
  problem.add(unit_solid(0.3));
  problem.start();
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> anywhere(-0.24, 0.24);  // of a cell: half of the particles' distance
  std::uniform_real_distribution<double> any_speed(-1e-6, 1e-6);
  bool const from_axis = geometry == Geometry::axisymmetric2d;
  int const dims = problem.domain.dimensions();
  mpm::Filling filling;
  Index3 const n{from_axis ? 16 : 12, dims > 1 ? 12 : 1, dims > 2 ? 12 : 1};
  double const first = 3.0 * h;
  for_each_cell(grid::CellRange{{0, 0, 0}, n}, [&](Index3 const& at) {
    Vec3 x = problem.domain.centre({0, 0, 0});
    double volume = 1.0;
    for (int d = 0; d < dims; ++d) {
      x[d] = (d == 0 && from_axis ? 0.0 : first) + (at[d] + 0.5) * 0.5 * h + anywhere(random) * h;
      volume *= 0.5 * h;
    }
    filling.positions.push_back(x);
    filling.volumes.push_back(from_axis ? volume * 2.0 * std::acos(-1.0) * x[0] : volume);
  });
  problem.mpm->fill(0, filling);
  problem.set_velocity(0, [&](Vec3 const&) {
    Vec3 v{0.0, 0.0, 0.0};
    for (int d = 0; d < dims; ++d) v[d] = any_speed(random);
    return v;
  });
  double const before = mpm::sums(*problem.mpm, 0).kinetic_energy;
  double const dt = courant * h / pressure_wave_speed(problem.bodies[0].solid);
  double most = 0.0;
  for (int step = 0; step < steps && most < 1e6; ++step) {
    problem.mpm->advance(dt);
    most = std::max(most, mpm::sums(*problem.mpm, 0).kinetic_energy / before);
  }
  return most;
}

TEST(Stability, BSplinesBearTheirCourantNumbersWhereverTheParticlesStand) {
  struct Run {
    Geometry geometry;
    double courant;
  };
  for (Run const& run : {Run{Geometry::planar1d, 0.6}, Run{Geometry::planar2d, 0.6}, Run{Geometry::axisymmetric2d, 0.6},
                         Run{Geometry::cartesian3d, 0.5}}) {
    int const steps = run.geometry == Geometry::cartesian3d ? 600 : 3000;
    double const sound = growth(run.geometry, run.courant, steps);
    double const unsound = growth(run.geometry, 4.0 * run.courant, 300);
    std::printf("Courant number %.1f: at most %.3f of the kinetic energy, four times that: %.3g\n", run.courant, sound,
                unsound);
    EXPECT_LT(sound, 1.05);
    EXPECT_GT(unsound, 1e3);
  }
}

/// The bound itself: sum over a particle's nodes of (dw/dx)^2 / w is between 4 and 6 per cell squared.
TEST(Stability, ASpreadOfWeightsBoundsTheFrequency) {
  constexpr int cells = 8;
  double least = 1e300;
  double most = 0.0;
  for (int n = 1; n < 1000; ++n) {
    double const u = 3.5 + n / 1000.0;
    int first = 0;
    double w[3];
    double g[3];
    mpm::BSpline::weights(u, 0.0, cells, first, w, g);
    double sum = 0.0;
    for (int s = 0; s < 3; ++s) sum += g[s] * g[s] / w[s];
    least = std::min(least, sum);
    most = std::max(most, sum);
  }
  EXPECT_GE(least, 4.0 * (1.0 - 1e-12));
  EXPECT_LE(most, 6.0);
  EXPECT_GT(most, 5.9);
}

}  // namespace
}  // namespace brisance::test
