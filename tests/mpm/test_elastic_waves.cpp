// Standing elastic waves against their closed forms: observed orders of the shape functions, and their energy.
//
// A standing wave is exact between mirrors, and, carried along by a uniform velocity, in a periodic box, where every
// particle crosses many cells. A solution with a source is in test_manufactured.cpp.
#include <numbers>

#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;
using std::numbers::pi;

/// A standing wave in a box of length 1: the velocity of the material at the start is V(x) times cos(w t).
struct Wave {
  Geometry geometry = Geometry::planar1d;
  Vec3 carried{0.0, 0.0, 0.0};  ///< uniform velocity; not zero: periodic box, else mirrors
  double nu = 0.25;
  double amplitude = 1e-6;  ///< of the velocity: so small that the equations are linear to more digits than we look at

  [[nodiscard]] bool moves() const { return norm(carried) > 0.0; }
  [[nodiscard]] double k() const { return moves() ? 2.0 * pi : pi; }
  /// Displacement per amplitude at unit phase. In 2D a shear wave, div u = 0.
  [[nodiscard]] Vec3 mode(Vec3 const& x) const {
    if (geometry == Geometry::planar1d) return {std::sin(k() * x[0]), 0.0, 0.0};
    return {std::sin(k() * x[0]) * std::cos(k() * x[1]), -std::cos(k() * x[0]) * std::sin(k() * x[1]), 0.0};
  }
  [[nodiscard]] double frequency() const {
    auto const solid = unit_solid(nu);
    return geometry == Geometry::planar1d ? k() * pressure_wave_speed(solid)
                                          : std::numbers::sqrt2 * k() * shear_wave_speed(solid);
  }
};

Problem wave_problem(Wave const& wave, mpm::Options const& options, int n, double dt) {
  Problem problem;
  problem.box(wave.geometry, 1.0 / n, {n, n, 1}, wave.moves() ? Boundary::periodic : Boundary::symmetry);
  problem.options.shape = options.shape;
  problem.options.order = options.order;
  problem.options.transfer = options.transfer;
  problem.add(unit_solid(wave.nu));
  problem.start();
  // Velocities stand half a step before the positions.
  double const start = wave.amplitude * std::cos(0.5 * wave.frequency() * dt);
  problem.fill(0, shape::Everywhere{}, [&](Vec3 const& x) { return start * wave.mode(x) + wave.carried; });
  if (options.order == StressOrder::usf && wave.geometry == Geometry::planar1d) {
    // Stress that is updated first stands a whole step before the positions.
    double const K = std::get<material::Linear>(problem.bodies[0].solid.eos).K;
    double const G = material::shear_modulus(problem.bodies[0].solid.strength);
    problem.for_each_particle(0, [&](mpm::ParticleSet& set, int q) {
      double const e = -dt * start * wave.k() * std::cos(wave.k() * Problem::position(set, q)[0]);
      double const across = (K - 2.0 / 3.0 * G) * e;
      problem.put_stress(0, set, q, {(K + 4.0 / 3.0 * G) * e, across, across, 0.0, 0.0, 0.0});
    });
  }
  return problem;
}

/// Root mean square error of the displacement after 3/8 of the period, where amplitude and phase count alike, over the
/// largest displacement.
double displacement_error(Wave const& wave, mpm::Options const& options, int n) {
  double const w = wave.frequency();
  double const end = 0.75 * pi / w;
  double const fastest = pressure_wave_speed(unit_solid(wave.nu)) + norm(wave.carried);
  double const dt = Problem::even_step(end, 0.2 / n / fastest);
  Problem problem = wave_problem(wave, options, n, dt);
  problem.run(end, dt * (1.0 + 1e-12));
  double const most = wave.amplitude / w;
  double const phase = most * std::sin(w * end);
  double const square = problem.sum(0, [&](mpm::ParticleSet const& set, int q) {
    Vec3 const x0 = Problem::origin(set, q);
    Vec3 const moved = Problem::position(set, q) - x0 - end * wave.carried;
    Vec3 const error = moved - phase * wave.mode(x0);
    return dot(error, error);
  });
  return std::sqrt(square / static_cast<double>(mpm::particle_count(*problem.mpm))) / most;
}

/// Prints errors and orders of three grids; returns the order between the finest two.
double observed_order(char const* what, Wave const& wave, mpm::Options const& options,
                      std::array<int, 3> const& grids) {
  std::array<double, 3> error{};
  for (int g = 0; g < 3; ++g) error[g] = displacement_error(wave, options, grids[g]);
  double const first = std::log2(error[0] / error[1]) / std::log2(static_cast<double>(grids[1]) / grids[0]);
  double const second = std::log2(error[1] / error[2]) / std::log2(static_cast<double>(grids[2]) / grids[1]);
  std::printf("%-24s %-8s errors %.2e %.2e %.2e orders %.2f %.2f\n", what, word_of(options.shape), error[0], error[1],
              error[2], first, second);
  return second;
}

mpm::Options with(ShapeFunction shape) {
  mpm::Options options;
  options.shape = shape;
  return options;
}

class WaveOrder : public testing::TestWithParam<ShapeFunction> {
 protected:
  /// What the smooth shape functions owe; tents lose it when particles cross cells.
  void demand(double order, bool crossing) const {
    if (crossing && GetParam() == ShapeFunction::linear) return;
    EXPECT_GE(order, 1.8);
  }
};

INSTANTIATE_TEST_SUITE_P(Shapes, WaveOrder, testing::ValuesIn(all_shapes),
                         [](auto const& one) { return word_of(one.param); });

TEST_P(WaveOrder, BarBetweenMirrors) { demand(observed_order("bar", Wave{}, with(GetParam()), {32, 64, 128}), false); }

TEST_P(WaveOrder, BarThatCrossesCells) {
  Wave wave;
  wave.carried = {1.7, 0.0, 0.0};
  demand(observed_order("bar, moving", wave, with(GetParam()), {32, 64, 128}), true);
}

TEST_P(WaveOrder, ShearWaveInASquare) {
  Wave wave;
  wave.geometry = Geometry::planar2d;
  demand(observed_order("square", wave, with(GetParam()), {16, 32, 64}), false);
}

TEST_P(WaveOrder, ShearWaveThatCrossesCells) {
  Wave wave;
  wave.geometry = Geometry::planar2d;
  wave.carried = {0.9, 0.53, 0.0};
  demand(observed_order("square, moving", wave, with(GetParam()), {16, 32, 64}), true);
}

TEST(WaveOrders, EveryOrderOfTheStressUpdate) {
  for (StressOrder const order : all_orders) {
    for (Transfer const transfer : {Transfer::flip, Transfer::apic, Transfer::xpic}) {
      mpm::Options options;
      options.order = order;
      options.transfer = transfer;
      char what[32];
      std::snprintf(what, sizeof what, "bar, %s %s", word_of(order), word_of(transfer));
      double const found = observed_order(what, Wave{}, options, {32, 64, 128});
      EXPECT_GE(found, 1.8) << what;
    }
  }
}

// Ten periods of free vibration: the energy returns to its value whenever the phase does.
TEST_P(WaveOrder, EnergyOverTenPeriods) {
  for (bool const moving : {false, true}) {
    for (StressOrder const order : all_orders) {
      Wave wave;
      if (moving) wave.carried = {0.31, 0.0, 0.0};
      mpm::Options options = with(GetParam());
      options.order = order;
      double const period = 2.0 * pi / wave.frequency();
      double const dt = period / 160.0;
      Problem problem = wave_problem(wave, options, 32, dt);
      // Seen by who moves along; the energy of the uniform motion would hide all else.
      auto const energy = [&] {
        return problem.sum(0, [&](mpm::ParticleSet const& set, int q) {
          Vec3 const v = Problem::get(set, q, Field::velocity_x) - wave.carried;
          return set.field(Field::mass)[q] * (0.5 * dot(v, v) + set.field(Field::energy)[q]);
        });
      };
      double const start = energy();
      double swing = 0.0;
      for (int n = 0; n < 1600; ++n) {
        problem.mpm->advance(dt);
        swing = std::max(swing, std::abs(energy() / start - 1.0));
      }
      double const drift = energy() / start - 1.0;
      std::printf("%-8s %-4s %s: energy after 10 periods %+.2e, largest deviation %.2e\n", word_of(GetParam()),
                  word_of(order), moving ? "moving" : "at rest", drift, swing);
      if (moving && GetParam() == ShapeFunction::linear) continue;  // crossing noise: reported only
      // What the nodes cannot see of the particles' velocity is lost, most of it when particles cross cells.
      EXPECT_LT(std::abs(drift), 0.05);
    }
  }
}

}  // namespace
}  // namespace brisance::test
