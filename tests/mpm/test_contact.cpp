// Bodies that meet: exact waves, separation, friction, rigid bodies, and the loads and constraints that act on bodies.
#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

/// Two bars of unit modulus and density, side by side on a line.
struct Bars : Problem {
  double h = 0.01;
  double gap_at = 1.0;
  double first_length = 0.0;
  double second_length = 0.0;

  Bars(ShapeFunction shape, double first, double second, double speed) : first_length(first), second_length(second) {
    box(Geometry::planar1d, h, {static_cast<int>(std::lround((first + second + 2.0) / h)), 1, 1}, Boundary::outflow);
    gap_at = 0.5 + first;
    options.shape = shape;
    options.linear_viscosity = 0.06;
    options.quadratic_viscosity = 1.5;
    add(unit_solid(0.0));
    add(unit_solid(0.0));
    contacts.push_back({0, 1, 0.0});
    start();
    fill(0, shape::Box{{0.5, -1.0, -1.0}, {gap_at, 1.0, 1.0}}, [=](Vec3 const&) { return Vec3{speed, 0.0, 0.0}; });
    fill(1, shape::Box{{gap_at, -1.0, -1.0}, {gap_at + second, 1.0, 1.0}});
  }
};

class EachShape : public testing::TestWithParam<ShapeFunction> {};

INSTANTIATE_TEST_SUITE_P(Shapes, EachShape, testing::ValuesIn(all_shapes),
                         [](auto const& one) { return word_of(one.param); });

// Two equal bars exchange their velocity: contact lasts 2 L/c, the stress meanwhile is rho c v/2, afterwards they part.
TEST_P(EachShape, EqualBarsExchangeTheirVelocity) {
  double const v = 1e-3;
  double const length = 1.0;
  Bars bars(GetParam(), length, length, v);
  double const before = bars.energy();
  double const dt = 0.4 * bars.h;
  double begin = 0.0;
  double end = 0.0;
  double stress = 0.0;
  double last = 0.0;
  double const whole = mpm::sums(*bars.mpm, 0).momentum[0];
  while (bars.mpm->time() < 3.0) {
    bars.mpm->advance(dt);
    double const now = mpm::sums(*bars.mpm, 1).momentum[0];
    double const t = bars.mpm->time();
    auto const crosses = [&](double level) { return last < level && now >= level; };
    if (crosses(0.1 * whole)) begin = t - dt * (now - 0.1 * whole) / (now - last);
    if (crosses(0.9 * whole)) end = t - dt * (now - 0.9 * whole) / (now - last);
    if (stress == 0.0 && t >= 0.75) {
      // The middle half of what the two waves have passed.
      double sum = 0.0;
      int count = 0;
      for (int body = 0; body < 2; ++body) {
        bars.for_each_particle(body, [&](mpm::ParticleSet const& set, int q) {
          if (std::abs(Problem::position(set, q)[0] - bars.gap_at) > 0.5) return;
          sum += Problem::stress(set, q)[0];
          ++count;
        });
      }
      stress = sum / count;
    }
    last = now;
  }
  auto const first = mpm::sums(*bars.mpm, 0);
  auto const second = mpm::sums(*bars.mpm, 1);
  // Momentum goes over at an even rate, so its middle 80 % take 80 % of the time.
  double const duration = (end - begin) / 0.8;
  double const left = first.momentum[0] / first.mass / v;
  double const got = second.momentum[0] / second.mass / v;
  double const loss = 1.0 - second.kinetic_energy / before;
  std::printf(
      "%s: contact %.4f (exact 2), stress %.4f rho c v/2, velocities %.5f %.5f, energy error %.1e, not in motion "
      "%.4f\n",
      word_of(GetParam()), duration, -2.0 * stress / v, left, got, bars.energy() / before - 1.0, loss);
  // The ends of a bar are known to half a particle, 0.25 % of L, and so is the time that a wave takes through it.
  EXPECT_NEAR(duration, 2.0, 0.005);
  // Behind the front the stress is even but for the oscillations that the viscosity damps.
  EXPECT_NEAR(-2.0 * stress / v, 1.0, 0.003);
  // What the front carries beyond the first two cells (2 % of L) comes back too late to be handed over; it is a little
  // wider with tents.
  EXPECT_NEAR(left, 0.0, 0.025);
  EXPECT_NEAR(got, 1.0, 0.025);
  EXPECT_LT(loss, 0.04);
  // The step's own energy error: the work of the contact where the front passes, in 1 of 100 cells.
  EXPECT_NEAR(bars.energy() / before, 1.0, 0.01);
  // They are apart and stay so: no force over the gap.
  double const momentum = second.momentum[0];
  bars.run(1.0, dt);
  EXPECT_NEAR(mpm::sums(*bars.mpm, 1).momentum[0] / momentum, 1.0, 1e-12);
}

// A bar that hits one of twice its length hands over all its momentum and stays behind at rest.
TEST_P(EachShape, ShortBarStaysBehindTheLongOne) {
  double const v = 1e-3;
  Bars bars(GetParam(), 1.0, 2.0, v);
  double const before = bars.energy();
  bars.run(4.8, 0.4 * bars.h);
  auto const first = mpm::sums(*bars.mpm, 0);
  auto const second = mpm::sums(*bars.mpm, 1);
  double const rest = first.momentum[0] / first.mass / v;
  double const got = second.momentum[0] / second.mass / v;
  std::printf("%s: velocities %.5f %.5f (exact 0, 0.5), energy error %.1e\n", word_of(GetParam()), rest, got,
              bars.energy() / before - 1.0);
  // As with equal bars, whose fronts have half as far to go.
  EXPECT_NEAR(rest, 0.0, 0.04);
  EXPECT_NEAR(got, 0.5, 0.02);
  EXPECT_NEAR(bars.energy() / before, 1.0, 0.01);
  EXPECT_NEAR((first.momentum[0] + second.momentum[0]) / (first.mass * v), 1.0, 1e-12);
}

// A rigid piston throws a bar off with twice its own velocity and is not slowed down.
TEST_P(EachShape, RigidPistonThrowsABarOff) {
  double const v = 1e-3;
  Problem problem;
  double const h = 0.01;
  problem.box(Geometry::planar1d, h, {250, 1, 1}, Boundary::outflow);
  problem.options.shape = GetParam();
  problem.options.linear_viscosity = 0.06;
  problem.options.quadratic_viscosity = 1.5;
  int const piston = problem.add(unit_solid(0.0));
  int const bar = problem.add(unit_solid(0.0));
  problem.bodies[piston].rigid_velocity = Vec3{v, 0.0, 0.0};
  problem.contacts.push_back({piston, bar, 0.0});
  problem.start();
  problem.fill(piston, shape::Box{{0.5, -1.0, -1.0}, {0.6, 1.0, 1.0}});
  problem.fill(bar, shape::Box{{0.6, -1.0, -1.0}, {1.6, 1.0, 1.0}});
  problem.run(3.0, 0.4 * h);
  auto const thrown = mpm::sums(*problem.mpm, bar);
  auto const pushed = mpm::sums(*problem.mpm, piston);
  double const got = thrown.momentum[0] / thrown.mass / v;
  double const impulse = problem.mpm->accounts().constraint_impulse[0] / thrown.momentum[0];
  std::printf("%s: bar %.5f of the piston's velocity (exact 2), impulse booked %.3f of it\n", word_of(GetParam()), got,
              impulse);
  // As with equal bars: 2 % of L.
  EXPECT_NEAR(got, 2.0, 0.04);
  // Round-off of the sums.
  EXPECT_NEAR(pushed.centre[0], 0.55 + v * 3.0, 1e-13);
  EXPECT_NEAR(pushed.momentum[0] / pushed.mass / v, 1.0, 1e-13);
  EXPECT_NEAR(impulse, 1.0, 1e-12);
}

/// A block on a rigid floor, under gravity, that moves to the right.
struct Slider : Problem {
  double g = 1e-4;
  double speed = 0.01;
  double dt = 0.3;

  /// Lengths and times are in cells: with any `h` the same happens, but for round-off.
  Slider(ShapeFunction shape, double friction, Boundary side = Boundary::outflow, double h = 1.0) {
    box(Geometry::planar2d, h, {24, 8, 1}, side);
    dt *= h;
    options.shape = shape;
    options.block_cells = 8;
    options.body_force = {0.0, -g / h, 0.0};
    add(unit_solid(0.0));
    add(unit_solid(0.0));
    bodies[0].rigid_velocity = Vec3{0.0, 0.0, 0.0};
    contacts.push_back({0, 1, friction});
    start();
    fill(0, shape::Box{{0.0, 0.0, -1.0}, {24.0 * h, 2.0 * h, 1.0}});
    fill(1, shape::Box{{4.0 * h, 2.0 * h, -1.0}, {12.0 * h, 5.0 * h, 1.0}}, [&](Vec3 const&) {
      return Vec3{speed, 0.0, 0.0};
    });
  }
  Vec3 mean_velocity() {
    auto const s = mpm::sums(*mpm, 1);
    return (1.0 / s.mass) * s.momentum;
  }
};

// Friction takes mu times the impulse of the normal force; that is g t but for what the block's bouncing keeps.
TEST_P(EachShape, BlockSlidesWithCoulombFriction) {
  double const mu = 0.3;
  Slider slider(GetParam(), mu);
  slider.run(200.0, slider.dt);
  Vec3 const v = slider.mean_velocity();
  double const slowed = (slider.speed - v[0]) / (mu * (slider.g * 200.0 + v[1]));
  double const plain = (slider.speed - v[0]) / (mu * slider.g * 200.0);
  // What it slid times mu times its weight, and the balance of all energies.
  double const mass = mpm::sums(*slider.mpm, 1).mass;
  double const rubbed = slider.mpm->accounts().dissipation.friction /
                        (mu * mass * slider.g * (mpm::sums(*slider.mpm, 1).centre[0] - 8.0));
  double const drift =
      (slider.energy() + slider.mpm->accounts().dissipation.sum() - slider.mpm->accounts().outer_work) /
          (0.5 * mass * slider.speed * slider.speed) -
      1.0;
  slider.run(300.0, slider.dt);
  double const end = slider.mean_velocity()[0] / slider.speed;
  double const sunk = mpm::sums(*slider.mpm, 1).centre[1] - 3.5;
  std::printf(
      "%s: slowed by %.5f mu N t, %.4f mu g t; friction took %.4f mu m g s, drift %.1e; after it should stop %.1e of "
      "its speed; sunk %.4f h\n",
      word_of(GetParam()), slowed, plain, rubbed, drift, end, sunk);
  // The normals at the block's lower corners, two of 17 nodes, are oblique and take part of the weight. Nodes rub when
  // they push and not less when the trembling of the surface pulls them: 6 % with tents, 4 % and less with the others.
  EXPECT_NEAR(slowed, 1.0, 0.07);
  // The bounce is that of a weight put on at once; it ends anywhere in its period of 4 H/c = 12.
  EXPECT_NEAR(plain, 1.0, 0.06);
  // As the impulse, and what the bounce takes along.
  EXPECT_NEAR(rubbed, 1.0, 0.06);
  // Without the friction the drift would be -84 %.
  EXPECT_LT(std::abs(drift), 0.005);
  // At rest it only vibrates.
  EXPECT_LT(std::abs(end), 0.02);
}

// Also on cells of a length that has no exact binary form: what the gradients of the floor's particles leave within it
// is round-off then, and no normal.
TEST_P(EachShape, BlockSlidesOnWithoutFriction) {
  for (double const h : {1.0, 0.01}) {
    Slider slider(GetParam(), 0.0, Boundary::outflow, h);
    slider.run(200.0 * h, slider.dt);
    double const kept = slider.mean_velocity()[0] / slider.speed;
    std::printf("%s, h = %g: keeps %.6f of its speed without friction\n", word_of(GetParam()), h, kept);
    // Nothing acts along the floor but the oblique normals of the corners, left against right.
    EXPECT_NEAR(kept, 1.0, 0.02);
    EXPECT_EQ(slider.mpm->accounts().dissipation.friction, 0.0);
  }
}

// A pressure on the face of a plate: p/(rho h) from the first step on.
TEST_P(EachShape, SurfacePressureAcceleratesAPlate) {
  Problem problem;
  double const p = 1e-6;
  problem.box(Geometry::planar2d, 1.0, {8, 12, 1}, Boundary::outflow);
  problem.domain.boundary[0] = Boundary::periodic;
  problem.domain.boundary[1] = Boundary::periodic;
  problem.options.shape = GetParam();
  problem.options.block_cells = 4;
  int const plate = problem.add(unit_solid(0.3));
  problem.start();
  problem.fill(plate, shape::Box{{0.0, 4.0, -1.0}, {8.0, 7.0, 1.0}});
  mpm::SurfacePressure load;
  load.body = plate;
  load.within = shape::Box{{-1.0, 6.5, -1.0}, {9.0, 7.5, 1.0}};
  load.normal = {0.0, 1.0, 0.0};
  load.thickness = 0.5;
  load.times = {0.0, 40.0, 80.0};
  load.pressures = {p, p, 0.0};
  problem.mpm->load(load);
  double const dt = 0.25;
  problem.run(40.0, dt);
  double const held = mpm::sums(*problem.mpm, plate).momentum[1] / (-p * 8.0 * 40.0);
  problem.run(60.0, dt);
  auto const sums = mpm::sums(*problem.mpm, plate);
  double const whole = sums.momentum[1] / (-p * 8.0 * 60.0);
  std::printf("%s: %.8f of p t, %.8f of the whole impulse, across %.1e\n", word_of(GetParam()), held, whole,
              sums.momentum[0] / sums.momentum[1]);
  // The loaded layer carries its present volume: strains of p/E.
  EXPECT_NEAR(held, 1.0, 2e-6);
  // On the ramp the pressure is taken at the start of the step: half a step of 60.
  EXPECT_NEAR(whole, 1.0, 0.5 * dt / 60.0 + 2e-6);
  EXPECT_NEAR(sums.momentum[0] / sums.momentum[1], 0.0, 1e-12);
}

/// Pressure [Pa] of a history at a time [s]: linear between its times, none before the first and after the last.
double pressure_at(std::vector<double> const& times, std::vector<double> const& pressures, double t) {
  double p = 0.0;
  for (std::size_t n = 1; n < times.size(); ++n) {
    if (t < times[n - 1] || t > times[n]) continue;
    p = pressures[n - 1] + (pressures[n] - pressures[n - 1]) * (t - times[n - 1]) / (times[n] - times[n - 1]);
  }
  return p;
}

// Pressures that end while they are still high, that begin late, and two in turn on one face: the plate gets the area
// below the history step by step, and nothing before and after it. Along every direction, from both sides.
TEST(SurfacePressure, ActsFromItsFirstTimeToItsLast) {
  struct Load {
    std::vector<double> times, pressures;
  };
  double const p = 1e-6;
  Load const ends{{0.0, 20.0}, {p, p}};           // a rectangle
  Load const rises{{0.0, 20.0}, {0.0, 2.0 * p}};  // a saw tooth that falls at once
  Load const late{{15.0, 25.0}, {3.0 * p, p}};    // jumps up, and down
  Load const pulls{{5.0, 10.0, 20.0}, {-p, 2.0 * p, -3.0 * p}};
  double const dt = 0.25;
  for (std::vector<Load> const& loads : {std::vector<Load>{ends}, std::vector<Load>{rises}, std::vector<Load>{late},
                                         std::vector<Load>{pulls}, std::vector<Load>{ends, late, pulls}}) {
    for (int face = 0; face < 6; ++face) {
      int const d = face / 2;
      double const outwards = face % 2 == 0 ? -1.0 : 1.0;
      Problem problem;
      Index3 cells{4, 4, 4};
      cells[d] = 8;
      problem.box(Geometry::cartesian3d, 1.0, cells, Boundary::periodic);
      problem.domain.boundary[2 * d] = problem.domain.boundary[2 * d + 1] = Boundary::outflow;
      int const plate = problem.add(unit_solid(0.0));
      problem.start();
      shape::Box body{{0.0, 0.0, 0.0}, {4.0, 4.0, 4.0}};
      body.lower[d] = 3.0;
      body.upper[d] = 5.0;
      problem.fill(plate, body);
      for (Load const& one : loads) {
        mpm::SurfacePressure load;
        load.body = plate;
        shape::Box region{{-1.0, -1.0, -1.0}, {5.0, 5.0, 5.0}};
        region.lower[d] = face % 2 == 0 ? 2.5 : 4.5;
        region.upper[d] = face % 2 == 0 ? 3.5 : 5.5;
        load.within = region;
        load.normal = {0.0, 0.0, 0.0};
        load.normal[d] = outwards;
        load.thickness = 0.5;
        load.times = one.times;
        load.pressures = one.pressures;
        problem.mpm->load(load);
      }
      double impulse = 0.0;
      bool acted = false;
      for (int step = 0; step < 160; ++step) {
        double const t = problem.mpm->time();
        double force = 0.0;
        for (Load const& one : loads) force += 16.0 * pressure_at(one.times, one.pressures, t);
        impulse += -outwards * force * dt;
        acted = acted || force != 0.0;
        problem.mpm->advance(dt);
        // The loaded layer carries its present volume: strains of p/E.
        ASSERT_NEAR(mpm::sums(*problem.mpm, plate).momentum[d], impulse, 1e-5 * 16.0 * p * 20.0)
            << "face " << face << ", t = " << t;
      }
      EXPECT_TRUE(acted);
    }
  }
}

// A block under pressures on three of its faces at a time: the particles at its edges and corners bear them all.
TEST(SurfacePressure, OfSeveralFacesMeetAtTheEdges) {
  Problem problem;
  double const p = 1e-6;
  problem.box(Geometry::cartesian3d, 1.0, {10, 10, 10}, Boundary::outflow);
  problem.options.block_cells = 4;
  int const block = problem.add(unit_solid(0.3));
  problem.start();
  problem.fill(block, shape::Box{{3.0, 3.0, 3.0}, {7.0, 6.0, 5.0}});
  Vec3 const low{3.0, 3.0, 3.0};
  Vec3 const area{6.0, 8.0, 12.0};
  Vec3 const pressures{p, 3.0 * p, -2.0 * p};
  for (int d = 0; d < 3; ++d) {
    mpm::SurfacePressure load;
    load.body = block;
    shape::Box region{{0.0, 0.0, 0.0}, {10.0, 10.0, 10.0}};
    region.upper[d] = low[d] + 0.5;
    load.within = region;
    load.normal = {0.0, 0.0, 0.0};
    load.normal[d] = -1.0;
    load.thickness = 0.5;
    load.times = {0.0, 10.0 + d};
    load.pressures = {pressures[d], pressures[d]};
    problem.mpm->load(load);
  }
  problem.run(20.0, 0.25);
  Vec3 const momentum = mpm::sums(*problem.mpm, block).momentum;
  for (int d = 0; d < 3; ++d) {
    // A pressure still acts in the step that begins with its last moment.
    double const impulse = pressures[d] * area[d] * (10.25 + d);
    EXPECT_NEAR(momentum[d] / impulse, 1.0, 1e-5) << d;  // strains of p/E
  }
}

// A block that falls on held nodes beside a mirror plane, cut into blocks: nodes on planes and copies count once.
TEST_P(EachShape, ConstraintImpulseIsTheChangeOfMomentum) {
  Problem problem;
  problem.box(Geometry::planar2d, 1.0, {12, 12, 1}, Boundary::outflow);
  problem.domain.boundary[0] = Boundary::symmetry;
  problem.options.shape = GetParam();
  problem.options.block_cells = 4;
  problem.options.body_force = {0.0, -1e-5, 0.0};
  problem.constraints.push_back(
      {shape::Box{{-1.0, -1.0, -1.0}, {13.0, 3.0, 1.0}}, {false, true, false}, {0.0, 1e-4, 0.0}, -1});
  int const body = problem.add(unit_solid(0.3));
  problem.start();
  problem.fill(body, shape::Box{{0.0, 3.5, -1.0}, {6.5, 9.0, 1.0}}, [](Vec3 const&) { return Vec3{0.0, -0.01, 0.0}; });
  double const before = problem.momentum()[1];
  double const mass = mpm::sums(*problem.mpm, body).mass;
  problem.run(90.0, 0.25);
  double const change = problem.momentum()[1] - before + mass * 1e-5 * 90.0;
  double const impulse = problem.mpm->accounts().constraint_impulse[1];
  std::printf("%s: change of momentum %.6g, impulse error %.1e\n", word_of(GetParam()), change, impulse / change - 1.0);
  EXPECT_GT(std::abs(change), 0.5 * std::abs(before));  // it did hit
  EXPECT_NEAR(impulse / change, 1.0, 1e-11);            // sums of 360 steps
}

// The same on a rigid body: what it gives is counted once per node too, whichever block holds the node.
TEST_P(EachShape, ImpulseOfARigidBodyIsTheChangeOfMomentum) {
  Problem problem;
  problem.box(Geometry::planar2d, 1.0, {12, 12, 1}, Boundary::outflow);
  problem.domain.boundary[0] = Boundary::symmetry;
  problem.options.shape = GetParam();
  problem.options.block_cells = 4;
  int const floor = problem.add(unit_solid(0.0));
  int const body = problem.add(unit_solid(0.3));
  problem.bodies[floor].rigid_velocity = Vec3{0.0, 1e-4, 0.0};
  problem.contacts.push_back({floor, body, 0.3});
  problem.start();
  problem.fill(floor, shape::Box{{0.0, 1.0, -1.0}, {9.0, 3.0, 1.0}});
  problem.fill(body, shape::Box{{0.0, 3.5, -1.0}, {6.5, 9.0, 1.0}}, [](Vec3 const&) { return Vec3{0.0, -0.01, 0.0}; });
  double const before = mpm::sums(*problem.mpm, body).momentum[1];
  problem.run(90.0, 0.25);
  double const change = mpm::sums(*problem.mpm, body).momentum[1] - before;
  double const impulse = problem.mpm->accounts().constraint_impulse[1];
  std::printf("%s: change of momentum %.6g, impulse error %.1e\n", word_of(GetParam()), change, impulse / change - 1.0);
  EXPECT_GT(std::abs(change), 0.5 * std::abs(before));  // it did hit
  EXPECT_NEAR(impulse / change, 1.0, 1e-11);            // sums of 360 steps
}

/// A body without stiffness: nothing but constraints and filters change the velocity of its particles.
material::Material dust() { return material::elastic_solid(1.0, 1e-30, 0.0); }

/// Two elastic layers, as wide as a periodic domain, that meet along direction d: the second comes with the velocity
/// `coming` on the first, which is rigid or three times as dense.
struct Layers : Problem {
  Layers(ShapeFunction shape, Geometry geometry, int d, double side, Vec3 const& coming, double friction, bool rigid) {
    Index3 cells{4, 4, 4};
    cells[d] = 14;
    box(geometry, 1.0, cells, Boundary::periodic);
    domain.boundary[2 * d] = domain.boundary[2 * d + 1] = Boundary::outflow;
    options.shape = shape;
    options.linear_viscosity = 0.06;
    options.quadratic_viscosity = 1.5;
    material::Material heavy = unit_solid(0.3);
    heavy.density = std::get<material::Linear>(heavy.eos).rho0 = 3.0;
    add(heavy);
    add(unit_solid(0.3));
    if (rigid) bodies[0].rigid_velocity = Vec3{0.0, 0.0, 0.0};
    contacts.push_back({0, 1, friction});
    book_work();
    start();
    shape::Box low{{-1.0, -1.0, -1.0}, {5.0, 5.0, 5.0}};
    shape::Box high = low;
    low.lower[d] = 3.0;
    low.upper[d] = high.lower[d] = 7.0;
    high.upper[d] = 11.0;
    fill(0, side > 0.0 ? low : high);
    fill(1, side > 0.0 ? high : low, [&](Vec3 const&) { return coming; });
  }
};

// Coulomb's law where bodies meet obliquely: while they slide, the impulse along the surface is the friction times that
// across it, and against the slip. Across every direction, with slip in any; neither momentum nor energy is lost.
TEST_P(EachShape, FrictionIsAPartOfTheNormalImpulseAlsoInObliqueImpact) {
  double const closing = 0.01;
  double const slip = 2.0;
  for (Geometry const geometry : {Geometry::planar2d, Geometry::cartesian3d}) {
    int const dims = grid::dimensions(geometry);
    for (int face = 0; face < 2 * dims; ++face) {
      int const d = face / 2;
      double const side = face % 2 == 0 ? -1.0 : 1.0;
      for (double const friction : {0.1, 0.3}) {
        for (int turn = 0; turn < 2; ++turn) {
          double const angle = dims == 2 ? M_PI * turn : 0.9 * M_PI * turn + 0.3;
          Vec3 along{0.0, 0.0, 0.0};
          along[(d + 1) % dims] = std::cos(angle);
          if (dims == 3) along[(d + 2) % 3] = std::sin(angle);
          Vec3 coming = slip * closing * along;
          coming[d] = -side * closing;
          for (bool const rigid : {true, false}) {
            Layers layers(GetParam(), geometry, d, side, coming, friction, rigid);
            Vec3 const before = mpm::sums(*layers.mpm, 1).momentum;
            Vec3 const all = mpm::sums(*layers.mpm, 0).momentum + before;
            double const energy = layers.energy();
            auto const given = [&] { return mpm::sums(*layers.mpm, 1).momentum - before; };
            auto const not_coulomb = [&] {
              Vec3 tangential = given();
              tangential[d] = 0.0;
              return norm(tangential + friction * side * given()[d] * along) / (friction * side * given()[d]);
            };
            auto const what = [&] {
              return "direction " + std::to_string(d) + ", side " + std::to_string(side) + ", friction " +
                     std::to_string(friction) + ", turn " + std::to_string(turn) + (rigid ? ", rigid" : "");
            };
            layers.run(12.0, 0.25);
            // Elastic bodies bounce: more than what stops them.
            ASSERT_GT(side * given()[d], 1.3 * std::abs(before[d]) * (rigid ? 1.0 : 0.75)) << what();
            // The outermost nodes, and all as the layers part, pull each other for some steps, which does not take
            // friction back: 0.5 % with tents, up to 7 % with B-splines.
            ASSERT_NEAR(not_coulomb(), 0.0, 0.08) << what();
            ASSERT_NEAR(layers.accounted() / energy, 1.0, 1e-11) << what();
            if (rigid) continue;
            Vec3 const after = mpm::sums(*layers.mpm, 0).momentum + mpm::sums(*layers.mpm, 1).momentum;
            ASSERT_NEAR(norm(after - all), 0.0, 1e-13) << what();
          }
        }
      }
    }
  }
}

// Dust that falls on held nodes, at rest and in motion, beside a mirror plane and cut into blocks: all kinetic energy
// that it loses is counted, less the work of the constraints.
TEST_P(EachShape, KineticEnergyLostAtHeldNodesIsCounted) {
  for (double const v : {0.0, 0.004}) {
    Problem problem;
    problem.box(Geometry::planar2d, 1.0, {12, 12, 1}, Boundary::outflow);
    problem.domain.boundary[0] = Boundary::symmetry;
    problem.options.shape = GetParam();
    problem.options.block_cells = 4;
    shape::Shape const ground = shape::Box{{-1.0, -1.0, -1.0}, {13.0, 3.0, 1.0}};
    problem.constraints.push_back({ground, {false, true, false}, {0.0, v, 0.0}, -1});
    // Some nodes are held twice.
    problem.constraints.push_back({shape::Box{{-1.0, -1.0, -1.0}, {4.5, 3.0, 1.0}}, {true, true, false}, {}, -1});
    int const body = problem.add(dust());
    problem.start();
    problem.fill(body, shape::Box{{0.0, 3.5, -1.0}, {6.5, 9.0, 1.0}}, [](Vec3 const& x) {
      return Vec3{1e-3 * x[1], -0.01 - 1e-4 * x[0], 0.0};
    });
    double const before = problem.energy();
    problem.run(150.0, 0.25);
    double const lost = before + problem.mpm->accounts().outer_work - problem.energy();
    double const counted = problem.mpm->accounts().dissipation.constraints;
    std::printf("%s: of %.4g J %.4g J are lost, counted with an error of %.1e\n", word_of(GetParam()), before, lost,
                counted / lost - 1.0);
    EXPECT_GT(lost, 0.05 * before);
    EXPECT_NEAR(counted / lost, 1.0, 1e-11);  // sums of 600 steps
    EXPECT_EQ(problem.mpm->accounts().dissipation.filtered, 0.0);
  }
}

// A block that falls on a rigid floor at rest and in motion and slides over it: what friction takes, what filters take
// and what the floor does are all that its energy lacks.
TEST_P(EachShape, KineticEnergyLostToFrictionIsCounted) {
  struct How {
    Transfer transfer;
    double pic;
    double floor;
  };
  for (auto const& [transfer, pic, floor] : {How{Transfer::flip, 0.0, 0.0}, How{Transfer::flip, 0.0, 0.003},
                                             How{Transfer::flip, 0.1, 0.0}, How{Transfer::xpic, 0.0, 0.0}}) {
    Problem p;
    p.box(Geometry::planar2d, 1.0, {8, 12, 1}, Boundary::outflow);
    p.domain.boundary[0] = Boundary::periodic;
    p.domain.boundary[1] = Boundary::periodic;
    p.options.shape = GetParam();
    p.options.transfer = transfer;
    p.options.pic_fraction = pic;
    p.options.block_cells = 4;
    p.add(unit_solid(0.0));
    p.add(unit_solid(0.3));
    p.bodies[0].rigid_velocity = Vec3{floor, 0.0, 0.0};
    p.contacts.push_back({0, 1, 0.2});
    p.book_work();
    p.start();
    p.fill(0, shape::Box{{0.0, 0.0, -1.0}, {8.0, 3.0, 1.0}});
    p.fill(1, shape::Box{{0.0, 3.5, -1.0}, {8.0, 7.0, 1.0}}, [](Vec3 const&) { return Vec3{0.01, -0.01, 0.0}; });
    double const before = mpm::sums(*p.mpm, 1).kinetic_energy;
    p.run(100.0, 0.25);
    double const friction = p.mpm->accounts().dissipation.friction;
    double const rigid = mpm::sums(*p.mpm, 0).kinetic_energy;
    double const error = (p.accounted() - rigid) / before - 1.0;
    std::printf("%s, %s with PIC %g, floor at %g: friction took %.3f of the energy, the floor did %.3f, error %.1e\n",
                word_of(GetParam()), word_of(transfer), pic, floor, friction / before,
                p.mpm->accounts().outer_work / before, error);
    EXPECT_GT(friction, 0.05 * before);
    EXPECT_EQ(p.mpm->accounts().outer_work<-0.01 * before, floor> 0.0) << "it slows the block down";
    EXPECT_NEAR(error, 0.0, 1e-10);  // sums of 400 steps
  }
}

// The same for what PIC and XPIC take.
TEST_P(EachShape, KineticEnergyThatFiltersTakeIsCounted) {
  for (Transfer const transfer : {Transfer::flip, Transfer::xpic}) {
    Problem problem;
    problem.box(Geometry::planar2d, 1.0, {12, 12, 1}, Boundary::outflow);
    problem.options.shape = GetParam();
    problem.options.block_cells = 4;
    problem.options.transfer = transfer;
    problem.options.pic_fraction = 0.1;
    int const body = problem.add(dust());
    problem.start();
    problem.fill(body, shape::Box{{3.0, 3.0, -1.0}, {9.0, 9.0, 1.0}}, [](Vec3 const& x) {
      return Vec3{1e-3 * std::sin(7.0 * x[0] + x[1]), 1e-3 * std::cos(3.0 * x[1]), 0.0};
    });
    double const before = problem.energy();
    problem.run(20.0, 0.25);
    double const lost = before - problem.energy();
    double const counted = problem.mpm->accounts().dissipation.filtered;
    std::printf("%s, %s: of %.4g J %.4g J are lost, counted with an error of %.1e\n", word_of(GetParam()),
                word_of(transfer), before, lost, counted / lost - 1.0);
    EXPECT_GT(lost, 0.1 * before);
    EXPECT_NEAR(counted / lost, 1.0, 1e-11);  // sums of 80 steps
  }
}

}  // namespace
}  // namespace brisance::test
