// Sleep and waking, steps of their own for gas and particles, solids that come to the bridge, regions of several boxes,
// and the number of particles in the long run.
#include "bridge/harness.hpp"
#include "core/error.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

/// A shock tube in air: pressure ratio 10, diaphragm at 0.25, the region right of 0.5.
run::Case blast_case() {
  auto c = coupled_case(Geometry::planar1d, {200, 1, 1}, Boundary::outflow);
  set_region(c, {100, 0, 0}, {200, 1, 1});
  run::InitialState high;
  high.shape = shape::Box{{-1.0, -1.0, -1.0}, {0.25, 1.0, 1.0}};
  high.state = {5.0, 10.0, {0.0, 0.0, 0.0}};
  c.initial_states = {high};
  return c;
}

TEST(Activation, SleepsUntilTheShockArrives) {
  auto c = blast_case();
  run::World w = setup::build(c);
  EXPECT_FALSE(w.regions.front().bridge->awake());
  double woken = 0.0;
  run_to(w, 0.25, [&](run::World& now) {
    if (now.regions.front().bridge->awake() && woken == 0.0) woken = now.clock.time;
    if (!now.regions.front().bridge->awake()) {
      EXPECT_EQ(now.clock.particle_steps, 0);  // a sleeping region costs nothing
    }
  });
  ASSERT_GT(woken, 0.0);
  EXPECT_GT(w.clock.particle_steps, 0);
  // The shock runs at Mach 1.6 to 1.9 and meets the first proxy cell at x = 0.485.
  EXPECT_GT(woken, 0.235 / 2.0);
  EXPECT_LT(woken, 0.235 / 1.4);

  c.mpm_regions.front().activation = -1.0;  // awake from the start
  run::World early = setup::build(c);
  run_to(early, 0.25);
  EXPECT_GT(early.clock.particle_steps, w.clock.particle_steps);
  // The threshold only cuts the foot of the smeared shock: the front moves by a small part of a cell, 0.2 % in the
  // mean.
  auto const late_p = pressure_line(w);
  auto const early_p = pressure_line(early);
  auto const mean_difference = [](std::vector<double> const& p, std::vector<double> const& q) {
    double sum = 0.0;
    double scale = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      sum += std::abs(p[i] - q[i]);
      scale += q[i];
    }
    return sum / scale;
  };
  double worst = mean_difference(late_p, early_p);
  std::printf("woken at %.3f s; point steps %ld, awake from the start %ld; pressure differs by %.1e in the mean\n",
              woken, w.clock.particle_steps, early.clock.particle_steps, worst);
  EXPECT_LT(worst, 2e-3);

  c.mpm_regions.front().activation = 0.0;  // any disturbance at all
  run::World zero = setup::build(c);
  run_to(zero, 0.25);
  auto const zero_p = pressure_line(zero);
  worst = mean_difference(late_p, zero_p);
  std::printf("activation 0: pressure differs by %.1e in the mean from the default\n", worst);
  EXPECT_LT(worst, 2e-3);
}

/// Largest difference of the pressure lines of two runs, relative to the largest pressure, and their steps.
double difference(run::World& a, run::World& b, double end, char const* what) {
  run::Totals const before_a = a.totals();
  run::Totals const before_b = b.totals();
  run_to(a, end);
  run_to(b, end);
  EXPECT_LE(balance_of(a, before_a).mass, mass_tolerance);
  EXPECT_LE(balance_of(b, before_b).mass, mass_tolerance);
  auto const p = pressure_line(a);
  auto const q = pressure_line(b);
  double sum = 0.0;
  double scale = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!std::isfinite(p[i]) || !std::isfinite(q[i])) continue;  // cells full of steel
    sum += std::abs(p[i] - q[i]);
    scale += std::abs(q[i]);
  }
  std::printf(
      "%s: gas steps %ld, point steps %ld with sub-cycling, %ld and %ld without; pressure differs by %.2f %% in the "
      "mean\n",
      what, a.clock.gas_steps, a.clock.particle_steps, b.clock.gas_steps, b.clock.particle_steps, 100 * sum / scale);
  return sum / scale;
}

// Steps of other lengths change the result by their errors: a shock smears over another number of cells. 2 % in the
// mean of the pressure is of the size of the errors of each (test_bridge_tubes).
TEST(SubCycling, WithSteelTheParticlesTakeMoreSteps) {
  auto c = coupled_case(Geometry::planar1d, {160, 1, 1}, Boundary::outflow);
  set_region(c, {80, 0, 0}, {160, 1, 1});
  c.mpm_regions.front().activation = -1.0;
  c.ambient.state = {1.225, 101325.0, {0.0, 0.0, 0.0}};
  c.numerics.density_floor = 1e-6;
  c.numerics.pressure_floor = 1.0;
  run::InitialState high;
  high.shape = shape::Box{{-1.0, -1.0, -1.0}, {0.4, 1.0, 1.0}};
  high.state = {5.0, 1e6, {0.0, 0.0, 0.0}};
  c.initial_states = {high};
  run::Body body;
  body.name = "steel";
  body.solid = material::elastic_solid(7850.0, 210e9, 0.3);
  body.shape = shape::Box{{0.7, -1.0, -1.0}, {0.8, 1.0, 1.0}};
  c.particles.bodies = {body};
  run::World with = setup::build(c);
  c.mpm_regions.front().subcycling = false;
  run::World without = setup::build(c);
  EXPECT_LT(difference(with, without, 6e-4, "steel"), 0.02);
  EXPECT_GT(with.clock.particle_steps, 3 * with.clock.gas_steps);
  EXPECT_EQ(without.clock.particle_steps, without.clock.gas_steps);
  double const v = mpm::sums(*with.regions.front().particles, 0).momentum[0];
  EXPECT_GT(v, 0.0);
  // The impulse counts from the shock's arrival, which its width shifts: as the pressure.
  EXPECT_NEAR(mpm::sums(*without.regions.front().particles, 0).momentum[0] / v, 1.0, 0.02);
}

TEST(SubCycling, WithHotGasOutsideTheGasTakesMoreSteps) {
  auto c = coupled_case(Geometry::planar1d, {200, 1, 1}, Boundary::outflow);
  set_region(c, {100, 0, 0}, {200, 1, 1});
  run::InitialState hot;  // ten times the sound speed at the same pressure: far from the region
  hot.shape = shape::Box{{-1.0, -1.0, -1.0}, {0.2, 1.0, 1.0}};
  hot.state = {0.014, 4.0, {0.0, 0.0, 0.0}};
  c.initial_states = {hot};
  run::World with = setup::build(c);
  c.mpm_regions.front().subcycling = false;
  run::World without = setup::build(c);
  EXPECT_LT(difference(with, without, 0.35, "hot gas"), 0.02);
  EXPECT_GT(with.clock.gas_steps, with.clock.particle_steps);
  EXPECT_LT(static_cast<double>(with.clock.particle_steps),
            0.7 * static_cast<double>(without.clock.particle_steps));  // what it saves
}

TEST(Intruder, StopsTheCalculation) {
  auto c = coupled_case(Geometry::planar1d, {100, 1, 1}, Boundary::outflow);
  set_region(c, {20, 0, 0}, {100, 1, 1});
  run::Body body;
  body.name = "slug";
  body.solid = material::elastic_solid(1e4, 1e4, 0.3);
  body.shape = shape::Box{{0.3, -1.0, -1.0}, {0.4, 1.0, 1.0}};
  body.velocity = {-0.5, 0.0, 0.0};
  c.particles.bodies = {body};
  run::World w = setup::build(c);
  std::string message;
  try {
    run_to(w, 0.5);
  } catch (NumericalError const& e) {
    message = e.what();
  }
  std::printf("at %.3f s: %s\n", w.clock.time, message.c_str());
  EXPECT_EQ(message.find("body \"slug\" has reached the bridge at (0.2"), 0U);
  EXPECT_NE(message.find("solids must stay 7 cells away from the faces of the MPM region"), std::string::npos);
  // The first row of particles begins at 0.3025 and may go to 0.27.
  EXPECT_NEAR(w.clock.time, 0.0325 / 0.5, 0.01);
}

/// A hot spot near a region: everything must stay finite and conserve, and mirror images must agree.
TEST(Shapes, TwoBoxesAnLAndMirrors) {
  int const n = 48;
  struct Layout {
    char const* name;
    Geometry geometry;
    std::vector<std::array<Index3, 2>> boxes;
    bool symmetric;  ///< a mirror at x_low
  };
  std::vector<Layout> const layouts{
      {"two boxes", Geometry::planar2d, {{{{4, 4, 0}, {17, 44, 1}}}, {{{31, 4, 0}, {44, 44, 1}}}}, false},
      {"an L", Geometry::planar2d, {{{{4, 4, 0}, {44, 18, 1}}}, {{{4, 4, 0}, {18, 44, 1}}}}, false},
      {"at a mirror", Geometry::planar2d, {{{{0, 10, 0}, {14, 38, 1}}}}, true},
      {"on the axis", Geometry::axisymmetric2d, {{{{0, 10, 0}, {14, 38, 1}}}}, true},
  };
  for (Layout const& layout : layouts) {
    auto c = coupled_case(layout.geometry, {n, n, 1}, Boundary::outflow);
    if (layout.symmetric) c.domain.boundary[0] = Boundary::symmetry;
    for (auto const& box : layout.boxes) set_region(c, box[0], box[1]);
    c.mpm_regions.front().width = 2;
    run::InitialState hot;
    hot.shape = shape::Sphere{{24.0 / n, 24.0 / n, 0.5 / n}, 4.0 / n};
    if (layout.geometry == Geometry::axisymmetric2d || layout.symmetric) {
      hot.shape = shape::Box{{20.0 / n, 20.0 / n, -1.0}, {28.0 / n, 28.0 / n, 1.0}};
    }
    hot.state = {5.0, 20.0, {0.0, 0.0, 0.0}};
    c.initial_states = {hot};
    run::World w = setup::build(c);
    run::Totals const before = w.totals();
    run_to(w, 0.3);
    Balance const b = balance_of(w, before);
    // The layouts without a mirror at x_low are symmetric: to the middle (boxes), to the diagonal (L).
    double asymmetry = 0.0;
    double largest = 0.0;
    std::vector<std::vector<double>> p;
    for (int j = 0; j < n; ++j) p.push_back(pressure_line(w, j));
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        double const image = layout.symmetric          ? p[n - 1 - j][i]
                             : layout.boxes.size() < 2 ? p[j][i]
                             : layout.name[0] == 'a'   ? p[i][j]
                                                       : p[j][n - 1 - i];
        asymmetry = std::max(asymmetry, std::abs(p[j][i] - image));
        largest = std::max(largest, p[j][i]);
      }
    }
    std::printf(
        "%s: %ld point steps, injected %ld, absorbed %ld, mass %.1e, energy %.1e, largest pressure %.3f, asymmetry "
        "%.1e\n",
        layout.name, w.clock.particle_steps, w.regions.front().bridge->traffic().injected,
        w.regions.front().bridge->traffic().absorbed, b.mass, b.energy, largest, asymmetry);
    EXPECT_GT(w.clock.particle_steps, 20);
    EXPECT_LE(b.mass, mass_tolerance);
    EXPECT_LT(b.energy, 2e-3);  // 0.1 % in plane shock tubes
    EXPECT_LT(asymmetry, 0.02 * largest);
  }
}

// A flow through the region for ten transits: as many points as at the start, of the usual mass.
TEST(LongRun, KeepsTheNumberOfParticles) {
  auto c = coupled_case(Geometry::planar1d, {100, 1, 1}, Boundary::periodic);
  set_region(c, {30, 0, 0}, {70, 1, 1});
  c.ambient.state.velocity = {0.6, 0.0, 0.0};
  c.mpm_regions.front().activation = -1.0;
  run::InitialState wave;  // the flow is not uniform: there is something to split and to merge
  wave.shape = shape::Box{{0.1, -1.0, -1.0}, {0.25, 1.0, 1.0}};
  wave.state = {2.8, 1.8, {0.6, 0.0, 0.0}};
  c.initial_states = {wave};
  run::World w = setup::build(c);
  run::Totals const before = w.totals();
  long const start = mpm::sums(*w.regions.front().particles, w.regions.front().gas_body()).particles;
  long least = start;
  long most = start;
  run_to(w, 10.0 * 0.4 / 0.6, [&](run::World& now) {
    long const count = mpm::sums(*now.regions.front().particles, now.regions.front().gas_body()).particles;
    least = std::min(least, count);
    most = std::max(most, count);
  });
  Balance const b = balance_of(w, before);
  double light = 1e30;
  double heavy = 0.0;
  for_each_particle(w, w.regions.front().gas_body(), [&](mpm::ParticleSet const& set, int q) {
    light = std::min(light, set.field(Field::mass)[q]);
    heavy = std::max(heavy, set.field(Field::mass)[q]);
  });
  std::printf(
      "ten transits: %ld steps, points %ld at the start, from %ld to %ld; masses from %.2f to %.2f of the usual; "
      "injected %ld, absorbed %ld; mass %.1e, energy %.1e\n",
      w.clock.step, start, least, most, light / (1.4 * 0.01 / 4), heavy / (1.4 * 0.01 / 4),
      w.regions.front().bridge->traffic().injected, w.regions.front().bridge->traffic().absorbed, b.mass, b.energy);
  EXPECT_GT(w.regions.front().bridge->traffic().injected, 5 * start);
  EXPECT_GT(least, start / 2);
  EXPECT_LT(most, 2 * start);
  EXPECT_LE(b.mass, mass_tolerance);
  EXPECT_GT(light, 0.125 * heavy * 0.5);
}

}  // namespace
}  // namespace brisance::test
