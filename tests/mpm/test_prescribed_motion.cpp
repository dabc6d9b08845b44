// Constraints that move by a history: the way that a history means, the wave that a driven end sends through a bar, and
// what follows the end.
#include <numbers>

#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;
using mpm::MotionHistory;
using std::numbers::pi;

TEST(MotionHistory, HasTheWayOfItsIntegral) {
  MotionHistory const v{{1.0, 3.0, 4.0}, {1.0, 3.0, -1.0}, false, false};
  EXPECT_NEAR(v.way(0.0, 1.0), 1.0, 1e-15);  // the first value holds before
  EXPECT_NEAR(v.way(1.0, 3.0), 4.0, 1e-15);
  EXPECT_NEAR(v.way(1.0, 2.0), 1.5, 1e-15);
  EXPECT_NEAR(v.way(3.0, 4.0), 1.0, 1e-15);
  EXPECT_NEAR(v.way(4.0, 6.0), -2.0, 1e-15);  // and the last after
  EXPECT_NEAR(v.way(0.0, 6.0), 4.0, 1e-15);
  double sum = 0.0;
  for (int n = 0; n < 60; ++n) sum += v.way(0.1 * n, 0.1 * (n + 1));
  EXPECT_NEAR(sum, v.way(0.0, 6.0), 1e-13);
  MotionHistory const u{{1.0, 3.0, 4.0}, {0.5, 2.5, 2.0}, true, false};
  EXPECT_NEAR(u.way(0.0, 1.0), 0.0, 1e-15);  // a displacement rests before and after
  EXPECT_NEAR(u.way(1.0, 2.0), 1.0, 1e-15);
  EXPECT_NEAR(u.way(2.0, 3.5), 0.75, 1e-15);
  EXPECT_NEAR(u.way(4.0, 9.0), 0.0, 1e-15);
}

/// A bar from 0.2 to 2.8 m whose left end moves with V sin(w t) along x. Sound takes 1 s per metre.
struct DrivenBar : Problem {
  static constexpr double V = 1e-3;
  static constexpr double w = 2.0 * pi / 0.8;
  static constexpr double end = 2.0;

  /// Of `per_wave` cells per wave length.
  DrivenBar(Transfer transfer, bool displacement, int per_wave) {
    box(Geometry::planar1d, 0.8 / per_wave, {15 * per_wave / 4, 1, 1}, Boundary::outflow);
    options.transfer = transfer;
    add(unit_solid(0.0));
    MotionHistory history;
    history.displacement = displacement;
    for (int n = 0; n <= 400; ++n) {  // lines between: off by (w dt)^2/8, 2e-4
      double const t = end * n / 400.0;
      history.times.push_back(t);
      history.values.push_back(displacement ? V / w * (1.0 - std::cos(w * t)) : V * std::sin(w * t));
    }
    mpm::Constraint c;
    c.within = shape::Box{{-1.0, -1.0, -1.0}, {0.2, 1.0, 1.0}};
    c.components = {true, false, false};
    c.velocity = {1.0, 0.0, 0.0};
    c.history = history;
    constraints = {c};
    bodies[0].books_work = transfer == Transfer::apic;
    start();
    fill(0, shape::Box{{0.2, -1.0, -1.0}, {2.8, 1.0, 1.0}});
  }
};

// d'Alembert: the wave v(x, t) = v_end(t - (x - 0.2)/c) runs along the bar; the end does the work of its flux,
// rho c v^2 per time and area.
//
// B-splines feel a constraint half a cell before its last node, so that the wave is late by as much: the error is of
// first order, 0.13 with 40 cells per wave length.
TEST(PrescribedMotion, SendsTheWaveOfDAlembertThroughABar) {
  for (Transfer const transfer : {Transfer::flip, Transfer::apic}) {
    for (bool const displacement : {false, true}) {
      std::vector<double> errors;
      for (int const per_wave : {40, 160}) {
        DrivenBar bar(transfer, displacement, per_wave);
        double const dt = Problem::even_step(DrivenBar::end, 0.2 / per_wave);
        bar.run(DrivenBar::end, dt);
        double wrong = 0.0;
        double square = 0.0;
        bar.for_each_particle(0, [&](mpm::ParticleSet const& set, int q) {
          // Velocities stand half a step behind.
          double const t = DrivenBar::end - 0.5 * dt - (Problem::origin(set, q)[0] - 0.2);
          double const exact = t > 0.0 ? DrivenBar::V * std::sin(DrivenBar::w * t) : 0.0;
          wrong += std::pow(set.field(Field::velocity_x)[q] - exact, 2);
          square += exact * exact;
        });
        errors.push_back(std::sqrt(wrong / square));
        double const work = DrivenBar::V * DrivenBar::V * 0.5 * DrivenBar::end;  // over 2.5 periods
        double const done = bar.mpm->accounts().outer_work;
        std::printf("%s, %s, %d cells per wave: error %.4f, work %.5f of the exact one, audit %.1e of it\n",
                    word_of(transfer), displacement ? "displacement" : "velocity", per_wave, errors.back(), done / work,
                    bar.accounted() / done);
        EXPECT_NEAR(done / work, 1.0, 0.8 / per_wave);
        EXPECT_LT(std::abs(bar.accounted()), 0.005 * done);  // as far as `[audit] warn` lets it
      }
      EXPECT_LT(errors[1], 0.03);
      EXPECT_LT(errors[1], 0.3 * errors[0]);
    }
  }
}

/// A block whose nodes are all driven along x until 0.4 s, under a body force along x.
struct DrivenBlock : Problem {
  explicit DrivenBlock(bool release) {
    box(Geometry::planar2d, 0.1, {20, 10, 1}, Boundary::outflow);
    options.block_cells = 4;
    options.body_force = {0.1, 0.0, 0.0};
    add(unit_solid(0.3));
    mpm::Constraint c;
    c.within = shape::Everywhere{};
    c.components = {true, false, false};
    c.velocity = {1.0, 0.0, 0.0};
    c.history = MotionHistory{{0.0, 0.4}, {0.0, 0.2}, false, release};
    constraints = {c};
    start();
    fill(0, shape::Box{{0.3, 0.3, -1.0}, {0.7, 0.7, 1.0}});
  }
  [[nodiscard]] double speed() const {
    mpm::BodySums const s = mpm::sums(*mpm, 0);
    return s.momentum[0] / s.mass;
  }
};

TEST(PrescribedMotion, IsHeldOrReleasedAfterItsEnd) {
  DrivenBlock held(false);
  DrivenBlock released(true);
  held.run(1.4, 0.02);
  released.run(1.4, 0.02);
  EXPECT_NEAR(held.speed(), 0.2, 1e-12);
  // The last step before the end has the mean velocity of the step, half a step before it.
  EXPECT_NEAR(released.speed(), 0.2 - 0.5 * 0.02 * 0.5 + 0.1 * 1.0, 1e-6);
  mpm::BodySums const s = mpm::sums(*held.mpm, 0);
  EXPECT_NEAR(s.centre[0], 0.5 + 0.5 * 0.4 * 0.2 + 0.2, 1e-12);
}

}  // namespace
}  // namespace brisance::test
