// A world that is written and read again goes on as if nothing had happened: stopped after any step, it ends in the
// same bits as one that was never stopped.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "../observe/watched.hpp"
#include "cases.hpp"
#include "checkpoint_bytes.hpp"
#include "core/parallel.hpp"
#include "observe/gas_fields.hpp"
#include "particles_case.hpp"

namespace brisance::run {
namespace {

void append(std::vector<double>& to, double const* from, int count) {
  if (from != nullptr) to.insert(to.end(), from, from + count);
}

/// Everything that a result can be made of.
std::vector<double> bits_of(observe::Watched& world) {
  world.update_audit();
  Totals const& out = world.audit.outflow;
  std::vector<double> bits{world.clock.time,
                           world.clock.dt,
                           double(world.clock.step),
                           stable_step(world),
                           world.audit.guard_mass,
                           double(world.audit.guarded_cells),
                           out.mass[0],
                           out.mass[1],
                           out.momentum[0],
                           out.momentum[1],
                           out.energy,
                           double(world.audit.fallback_faces),
                           world.energy_balance().drift(),
                           world.audit.initial.energy,
                           world.audit.afterburn_energy};
  for (int b = 0; world.gas != nullptr && b < world.grid.block_count(); ++b) {
    int const cells = world.grid.blocks()[b].cell_count();
    for (int c = 0; c < world.gas->fields().components(); ++c) append(bits, world.gas->fields().at(b, c), cells);
    append(bits, world.gas->peaks().overpressure(b), cells);
    append(bits, world.gas->peaks().impulse(b), cells);
    bits.push_back(world.gas->awake(b) ? 1.0 : 0.0);
    // While a charge burns, the pressure depends on the time as well.
    std::vector<double> pressure;
    block_field(world, b, "pressure", pressure);
    append(bits, pressure.data(), cells);
  }
  for (GaugeHistory const& history : world.gauges.gas) {
    for (GaugeRecord const& r : history.records) {
      bits.insert(bits.end(), {r.time, r.pressure, r.density, r.velocity[0], r.velocity[1], r.velocity[2]});
    }
  }
  for (Region const& region : world.regions) {
    if (region.bridge == nullptr) continue;
    bridge::Traffic const& traffic = region.bridge->traffic();
    bits.insert(bits.end(), {region.bridge->awake() ? 1.0 : 0.0, double(world.clock.gas_steps), double(region.steps),
                             double(traffic.injected), double(traffic.absorbed), traffic.pressure_work});
    for (bridge::Amounts const& l : region.bridge->accounts()) {
      bits.insert(bits.end(), {l.mass[0], l.mass[1], l.momentum[0], l.momentum[1], l.momentum[2], l.energy});
    }
    for (gas::FaceFlux const& flux : world.gas->coupling.watched())
      bits.insert(bits.end(), {flux.carried.mass[0], flux.carried.energy});
  }
  if (world.panels != nullptr) {
    bits.insert(bits.end(),
                {double(world.panels->last_opening()), world.audit.panels.mass[0], world.audit.panels.energy});
    for (PanelReport const& p : world.panels->reports()) {
      bits.insert(bits.end(), {p.released.value_or(-1.0), p.opened.value_or(-1.0), p.largest, p.difference, p.travel,
                               p.speed, double(p.open_rings)});
    }
  }
  if (world.regions.empty()) return bits;
  for (Region const& region : world.regions) {
    for (int b = 0; b < region.particles->grid().block_count(); ++b) {
      for (int body = 0; body < static_cast<int>(region.bodies.size()); ++body) {
        mpm::ParticleSet const& set = region.particles->particles(b, body);
        bits.push_back(set.size());
        for (int f = 0; f < mpm::field_count; ++f) append(bits, set.field(static_cast<mpm::Field>(f)), set.size());
      }
    }
  }
  mpm::Accounts const booked = world.accounts();
  for (double const p : booked.constraint_impulse) bits.push_back(p);
  bits.push_back(booked.outer_work);
  bits.insert(bits.end(), {booked.dissipation.constraints, booked.dissipation.filtered, booked.dissipation.apic,
                           booked.dissipation.friction, booked.dissipation.damping});
  AuditMemory const& memory = world.audit.memory;
  bits.insert(bits.end(),
              {memory.scale, memory.all, memory.drift, memory.content, memory.surplus, memory.gas, memory.unlit});
  auto const add_sums = [&](std::vector<BodyRecord> const& records) {
    for (BodyRecord const& r : records) {
      mpm::BodySums const& s = r.sums;
      bits.insert(bits.end(), {r.time, double(s.particles), s.mass, s.momentum[0], s.centre[0], s.kinetic_energy,
                               s.internal_energy, s.plastic_work, s.largest_displacement, s.damaged_mass});
    }
  };
  for (auto const& history : world.gauges.bodies) add_sums(history);
  for (ParticleGaugeHistory const& history : world.gauges.particles) {
    add_sums(history.bodies);
    bits.push_back(history.lost ? 1.0 : 0.0);
    for (ParticleRecord const& r : history.particles) {
      bits.insert(bits.end(), {r.time, r.position[0], r.displacement[0], r.velocity[0], r.pressure, r.mises, r.density,
                               r.plastic_strain, r.temperature, r.damage});
    }
  }
  return bits;
}

bool same_bits(std::vector<double> const& a, std::vector<double> const& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

void step(observe::Watched& world) {
  advance(world, world.setup.end.time);
  world.follow_audit();
  world.sample_gauges();
}

/// Stops after every step (or every so many) up to `steps`, goes on in a new world, and compares with one that goes
/// through. What the new world held before must not matter: it is read after a few steps of its own.
void expect_the_same_after_any_stop(Case const& setup, int steps, int every = 1) {
  set_threads(1);  // many small cases: threads would wait for each other
  observe::Watched whole(setup);
  whole.sample_gauges();
  std::vector<std::string> checkpoints{written(whole)};
  std::vector<std::vector<double>> bits{bits_of(whole)};
  for (int n = 0; n < steps; ++n) {
    step(whole);
    checkpoints.push_back(written(whole));
    bits.push_back(bits_of(whole));
  }
  for (std::size_t n = 0; n < checkpoints.size(); n += every) {
    observe::Watched resumed(setup);
    if (n % 4 == 1) {
      for (int s = 0; s < 3; ++s) step(resumed);
    }
    read(resumed, checkpoints[n]);
    ASSERT_EQ(written(resumed), checkpoints[n]) << "after step " << n;
    ASSERT_TRUE(same_bits(bits_of(resumed), bits[n])) << "after step " << n;
    while (resumed.clock.step < steps) step(resumed);
    ASSERT_TRUE(same_bits(bits_of(resumed), bits.back())) << "stopped after step " << n;
  }
}

/// Sleeping blocks, an obstacle, a charge that burns from two particles, gas that leaves.
Case burst(Scheme scheme) {
  Case c = air_case(grid::Geometry::axisymmetric2d, {40, 32, 1}, 0.02, grid::Boundary::outflow);
  c.domain.boundary[2] = grid::Boundary::wall;
  c.numerics.scheme = scheme;
  c.numerics.block_cells = 8;
  Charge charge = tnt_charge(shape::Sphere{{0.0, 0.2, 0.0}, 0.08}, c.domain.geometry);
  charge.initiation = {{{0.0, 0.16, 0.0}, 0.0}, {{0.0, 0.24, 0.0}, 5e-6}};
  c.charges = {charge};
  c.obstacles = {{"block", shape::Box{{0.3, 0.0, 0.0}, {0.4, 0.2, 0.0}}}};
  c.gauges = {{"near", {0.2, 0.2, 0.0}}, {"far", {0.7, 0.6, 0.0}}};
  return c;
}

TEST(State, GasGoesOnAfterAnyStep) {
  for (Scheme const scheme : {Scheme::muscl_hancock, Scheme::lax_wendroff}) {
    observe::Watched const world(burst(scheme));
    EXPECT_LT(world.active_cells(), world.setup.domain.cell_count()) << "some blocks must sleep at the start";
    expect_the_same_after_any_stop(burst(scheme), 60);
  }
}

/// Stopped before the panels give way, while they open ring by ring, and when one of them is open.
TEST(State, PanelsGoOnAfterAnyStep) {
  Case c = burst(Scheme::muscl_hancock);
  c.obstacles = {{"plate", shape::Box{{0.0, 0.4, 0.0}, {9.0, 0.42, 0.0}}},
                 {"hatch", shape::Box{{0.0, 0.4, 0.0}, {0.2, 0.42, 0.0}}, Release{3e5, 2.0}},
                 {"ring", shape::Box{{0.3, 0.4, 0.0}, {0.36, 0.42, 0.0}}, Release{2e5, 0.0}}};
  observe::Watched world(c);
  for (int n = 0; n < 140; ++n) step(world);
  auto const& panels = world.panels->reports();
  EXPECT_GT(panels[0].open_rings, 2);
  EXPECT_FALSE(panels[0].opened) << "the last stop should be in the midst of its opening";
  EXPECT_TRUE(panels[1].opened);
  expect_the_same_after_any_stop(c, 140, 9);
}

TEST(State, AfterburnGoesOnAfterAnyStep) {
  Case c = burst(Scheme::muscl_hancock);
  for (material::AfterburnRate const& rate :
       {material::AfterburnRate{material::MillerAfterburn{2e5, 100e9, 0.5, 1.0 / 6.0, 1e5}},
        material::AfterburnRate{material::ConstantRateAfterburn{8e-6, 1e-3}}}) {
    c.afterburn = material::Afterburn{1e7, rate};
    observe::Watched world(c);
    for (int n = 0; n < 60; ++n) step(world);
    world.update_audit();
    EXPECT_GT(world.audit.afterburn_energy, 0.0);
    expect_the_same_after_any_stop(c, 60, 11);
  }
}

TEST(State, OneFluidInOneDimensionGoesOnAfterAnyStep) {
  Case c = air_case(grid::Geometry::spherical1d, {200, 1, 1}, 0.01, grid::Boundary::outflow);
  c.numerics.block_cells = 32;
  c.output.peak_fields = false;
  c.initial_states = {{shape::Sphere{{0.0, 0.0, 0.0}, 0.3}, {20.0, 5e6, {0.0, 0.0, 0.0}}, false, ""}};
  expect_the_same_after_any_stop(c, 40);
}

/// The two blocks of the other tests, with all that a particle may carry and all that may act on it.
Case everything(mpm::Transfer transfer, mpm::ShapeFunction function, mpm::StressOrder order) {
  Case c = two_blocks();
  c.particles.options.transfer = transfer;
  c.particles.options.shape = function;
  c.particles.options.order = order;
  c.particles.options.block_cells = 8;
  c.particles.options.locking_control = order == mpm::StressOrder::musl;
  c.particles.options.body_force = {0.0, -1e6, 0.0};
  c.particles.bodies[0].velocity = {400.0, 30.0, 0.0};
  c.particles.bodies[2].shape = shape::Box{{0.055, 0.03, 0.0}, {0.0635, 0.04, 0.0}};
  c.particles.bodies[2].velocity = {3000.0, 0.0, 0.0};
  c.particles.contacts = {{0, 1, 0.2}};
  c.particles.constraints = {
      {shape::Box{{0.04, 0.0, 0.0}, {0.045, 0.03, 0.0}}, {true, true, true}, {0.0, 10.0, 0.0}, 1}};
  mpm::SurfacePressure push;
  push.body = 0;
  push.within = shape::Box{{0.0, 0.0, 0.0}, {0.0035, 0.03, 0.0}};
  push.normal = {-1.0, 0.0, 0.0};
  push.thickness = 1e-3;
  push.times = {0.0, 4e-6, 1e-5};
  push.pressures = {0.0, 1e9, 2e8};
  c.particles.pressures = {push};
  c.particles.gauges.push_back({"gone", 2, Vec3{0.06, 0.035, 0.0}});
  return c;
}

TEST(State, ReinforcedConcreteGoesOnAfterAnyStep) {
  Case c;
  c.domain.geometry = grid::Geometry::cartesian3d;
  c.domain.h = 0.01;
  c.domain.cells = {14, 8, 8};
  c.domain.lower = {-0.02, -0.02, -0.02};
  c.domain.boundary.fill(grid::Boundary::outflow);
  c.end.time = 1e-3;
  Body left;
  left.name = "left";
  left.solid.name = "concrete";
  left.solid.density = 2440.0;
  left.solid.eos = material::Compaction{};
  left.solid.strength = material::Hjc{};
  left.solid.failure = material::TensileDamage{2.274e5, 4.57e6, 0.881, 0.01, 100e6, 90.0};
  left.shape = shape::Box{{0.0, 0.0, 0.0}, {0.1, 0.04, 0.04}};
  c.particles.bodies = {left};
  mpm::Bar bar;
  bar.from = {0.0, 0.02, 0.02};
  bar.to = {0.1, 0.02, 0.02};
  bar.diameter = 0.005;
  c.particles.bars = {bar};
  c.particles.constraints = {
      {shape::Box{{-0.02, 0.0, 0.0}, {0.01, 0.04, 0.04}}, {true, true, true}, {-8.0, 0.0, 0.0}, -1}};
  c.particles.options.block_cells = 8;
  mpm::SurfacePressure push;
  push.normal = {1.0, 0.0, 0.0};
  push.thickness = 0.005;
  push.within = shape::Box{{0.095, 0.0, 0.0}, {0.1, 0.04, 0.04}};
  push.times = {0.0, 1e-4};
  push.pressures = {3e7, 3e7};
  c.particles.pressures = {push};
  observe::Watched world(c);
  for (int n = 0; n < 40; ++n) step(world);
  EXPECT_GT(mpm::sums(*world.regions.front().particles, 0).internal_energy, 0.0);
  expect_the_same_after_any_stop(c, 40, 8);
}

TEST(State, ParticlesGoOnAfterAnyStep) {
  using mpm::ShapeFunction;
  using mpm::StressOrder;
  using mpm::Transfer;
  // Longer than it takes to sort the particles twice, to cross blocks and to leave the domain.
  expect_the_same_after_any_stop(everything(Transfer::flip, ShapeFunction::bspline, StressOrder::musl), 60);
  expect_the_same_after_any_stop(everything(Transfer::apic, ShapeFunction::cpgimp, StressOrder::usl), 30);
  expect_the_same_after_any_stop(everything(Transfer::xpic, ShapeFunction::gimp, StressOrder::usf), 30);
}

/// Soil in the stress of its weight, turning and damped, whose foot is shaken and then let go.
Case shaken_soil() {
  Case c;
  c.domain.geometry = grid::Geometry::planar2d;
  c.domain.h = 0.05;
  c.domain.cells = {16, 24, 1};
  c.domain.boundary.fill(grid::Boundary::outflow);
  c.domain.boundary[0] = grid::Boundary::symmetry;
  c.end.time = 0.1;
  Body soil;
  soil.name = "soil";
  soil.solid = material::elastic_solid(1800.0, 50e6, 0.3);
  soil.solid.name = "soil";
  soil.solid.strength = material::DruckerPrager{material::shear_modulus_of(50e6, 0.3)};
  soil.shape = shape::Box{{0.0, 0.1, -1.0}, {0.6, 0.8, 1.0}};
  soil.lateral_stress = 0.5;
  soil.motion.expressions = {"0.1*x", "-0.2*(y - 0.1)"};
  soil.motion.spin = {0.0, 0.0, 0.1};
  soil.motion.centre = {0.0, 0.1, 0.0};
  c.particles.bodies = {soil};
  c.particles.options.block_cells = 8;
  c.particles.options.body_force = {0.0, -9.81, 0.0};
  c.particles.options.damping = 20.0;
  c.particles.options.damping_end = 3.1e-3;
  mpm::Constraint foot{shape::Box{{-1.0, -1.0, -1.0}, {1.0, 0.15, 1.0}}, {false, true, false}, {0.0, 1.0, 0.0}, -1};
  foot.history = mpm::MotionHistory{{0.0, 1e-3, 2.3e-3}, {0.0, 1e-4, 0.0}, true, true};
  c.particles.constraints = {foot};
  return c;
}

// The last stops lie after the release of the foot and the end of the damping.
TEST(State, ShakenSoilGoesOnAfterAnyStep) {
  observe::Watched world(shaken_soil());
  for (int n = 0; n < 80; ++n) step(world);
  EXPECT_GT(world.clock.time, 3.1e-3);
  EXPECT_GT(world.regions.front().particles->accounts().dissipation.damping, 0.0);
  EXPECT_NE(world.regions.front().particles->accounts().constraint_impulse[1], 0.0);
  expect_the_same_after_any_stop(shaken_soil(), 80, 3);
}

TEST(State, TheCaseOfTheParticlesHoldsWhatItClaims) {
  observe::Watched world(everything(mpm::Transfer::flip, mpm::ShapeFunction::bspline, mpm::StressOrder::musl));
  world.sample_gauges();
  for (int n = 0; n < 60; ++n) step(world);
  EXPECT_GT(world.regions.front().particles->accounts().losses.particles, 0);
  EXPECT_NE(world.regions.front().particles->accounts().outer_work, 0.0);
  EXPECT_NE(norm(world.regions.front().particles->accounts().constraint_impulse), 0.0);
  EXPECT_NE(world.regions.front().particles->accounts().dissipation.constraints, 0.0);
  EXPECT_GT(world.gauges.particles[0].particles.back().plastic_strain, 0.0);
}

TEST(State, ParticlesOfABurningChargeGoOnAfterAnyStep) { expect_the_same_after_any_stop(charge_slab(), 60); }

/// A blast that runs into the MPM region and wakes it; with a plate, gas and solid particles share the region.
Case coupled(bool with_plate, mpm::Transfer transfer, mpm::StressOrder order) {
  Case c = air_case(grid::Geometry::planar2d, {64, 24, 1}, 0.01, grid::Boundary::wall);
  c.domain.boundary[1] = grid::Boundary::outflow;
  c.numerics.block_cells = 16;
  c.mpm_regions.emplace_back();
  c.mpm_regions.front().boxes = {shape::Box{{0.16, 0.0, 0.0}, {0.64, 0.24, 0.0}}};
  c.mpm_regions.front().transfer = transfer;
  c.mpm_regions.front().order = order;
  c.particles.options.block_cells = 8;
  c.initial_states = {{shape::Box{{0.0, 0.0, 0.0}, {0.1, 0.12, 0.0}}, {12.0, 4e6, {0.0, 0.0, 0.0}}, false, ""}};
  c.gauges = {{"before", {0.14, 0.1, 0.0}}, {"within", {0.5, 0.1, 0.0}}};
  if (!with_plate) return c;
  Body plate;
  plate.name = "plate";
  plate.solid = material::von_mises_solid(2700.0, 70e9, 0.33, 200e6);
  plate.solid.name = "metal";
  plate.shape = shape::Box{{0.36, 0.08, 0.0}, {0.38, 0.16, 0.0}};
  c.particles.bodies = {plate};
  c.particles.gauges = {{"plate", 0, {}}, {"face", 0, Vec3{0.36, 0.12, 0.0}}};
  return c;
}

TEST(State, GasAndParticlesGoOnAfterAnyStep) {
  for (bool const with_plate : {false, true}) {
    auto const transfer = with_plate ? mpm::Transfer::apic : mpm::Transfer::flip;
    auto const order = with_plate ? mpm::StressOrder::usl : mpm::StressOrder::musl;
    Case const c = coupled(with_plate, transfer, order);
    observe::Watched world(c);
    EXPECT_FALSE(world.regions.front().bridge->awake());
    for (int n = 0; n < 60; ++n) step(world);
    EXPECT_TRUE(world.regions.front().bridge->awake());
    EXPECT_GT(world.regions.front().bridge->traffic().injected, 0);
    expect_the_same_after_any_stop(c, 60, 11);
  }
}

TEST(State, TheNumberOfThreadsMayChange) {
  set_threads(1);
  observe::Watched whole(burst(Scheme::muscl_hancock));
  for (int n = 0; n < 20; ++n) step(whole);
  std::string const checkpoint = written(whole);
  for (int n = 0; n < 20; ++n) step(whole);
  set_threads(4);
  observe::Watched resumed(burst(Scheme::muscl_hancock));
  read(resumed, checkpoint);
  for (int n = 0; n < 20; ++n) step(resumed);
  EXPECT_TRUE(same_bits(bits_of(resumed), bits_of(whole)));
  set_threads(0);
}

std::string refusal(Case const& setup, std::string const& checkpoint) {
  observe::Watched world(setup);
  try {
    read(world, checkpoint);
  } catch (IoError const& error) {
    return error.what();
  }
  return "";
}

TEST(State, OfAnotherCaseIsRefused) {
  Case const gas = burst(Scheme::muscl_hancock);
  observe::Watched world(gas);
  std::string const checkpoint = written(world);
  EXPECT_EQ(refusal(gas, checkpoint), "");
  Case other = gas;
  other.domain.cells[0] = 48;
  EXPECT_NE(refusal(other, checkpoint).find("the number of cells"), std::string::npos);
  other = gas;
  other.numerics.block_cells = 16;
  EXPECT_NE(refusal(other, checkpoint).find("the number of gas blocks"), std::string::npos);
  other = gas;
  other.obstacles.clear();
  EXPECT_NE(refusal(other, checkpoint).find("the shape of the obstacles"), std::string::npos);
  other = gas;
  other.charges[0].initiation[0].delay = 1e-6;
  EXPECT_NE(refusal(other, checkpoint).find("the initiation of the charges"), std::string::npos);
  other = gas;
  other.gauges[1].position[0] = 0.71;
  EXPECT_NE(refusal(other, checkpoint).find("the position of gauge \"far\""), std::string::npos);
  EXPECT_NE(refusal(two_blocks(), checkpoint).find("whether there is gas"), std::string::npos);

  observe::Watched blocks(two_blocks());
  std::string const of_particles = written(blocks);
  Case apic = two_blocks();
  apic.particles.options.transfer = mpm::Transfer::apic;
  EXPECT_NE(refusal(apic, of_particles).find("the set of particle fields"), std::string::npos);
}

/// The checkpoint with the first such bytes replaced by others.
template <class T>
std::string with(std::string checkpoint, std::vector<T> const& before, std::vector<T> const& after) {
  std::string const from(reinterpret_cast<char const*>(before.data()), before.size() * sizeof(T));
  std::size_t const at = checkpoint.find(from);
  EXPECT_NE(at, std::string::npos);
  checkpoint.replace(at, from.size(), reinterpret_cast<char const*>(after.data()), after.size() * sizeof(T));
  return checkpoint;
}

// Whoever writes a checkpoint can give it a checksum that fits. What it says is taken only where it makes sense: by
// numbers that it holds blocks, particles, loads and bars are looked up.
TEST(State, WhatMakesNoSenseIsRefused) {
  set_threads(1);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  auto const expect = [](Case const& c, std::string const& checkpoint, char const* words) {
    std::string const why = refusal(c, checkpoint);
    EXPECT_NE(why.find(words), std::string::npos) << "\"" << why << "\" does not say " << words;
  };
  Case const gas = burst(Scheme::muscl_hancock);
  observe::Watched burning(gas);
  for (int n = 0; n < 5; ++n) step(burning);
  std::string const of_gas = written(burning);
  ASSERT_EQ(refusal(gas, of_gas), "");
  expect(gas, with<double>(of_gas, {burning.clock.time, burning.clock.dt}, {nan, burning.clock.dt}), "the time");
  expect(gas, with<double>(of_gas, {burning.clock.time, burning.clock.dt}, {burning.clock.time, -1.0 / 0.0}),
         "the time");
  // Fewer blocks that sleep or wake than there are.
  std::vector<std::uint8_t> blocks(8, 0);
  std::uint64_t const count = burning.grid.block_count();
  std::memcpy(blocks.data(), &count, sizeof count);
  for (int b = 0; b < burning.grid.block_count(); ++b) blocks.push_back(burning.gas->awake(b) ? 1 : 0);
  std::vector<std::uint8_t> fewer(blocks.begin(), blocks.end() - 1);
  std::uint64_t const less = count - 1;
  std::memcpy(fewer.data(), &less, sizeof less);
  expect(gas, with(of_gas, blocks, fewer), "the number of gas blocks");

  using mpm::Field;
  Case const solid = everything(mpm::Transfer::flip, mpm::ShapeFunction::bspline, mpm::StressOrder::musl);
  observe::Watched moving(solid);
  for (int n = 0; n < 5; ++n) step(moving);
  std::string const of_particles = written(moving);
  ASSERT_EQ(refusal(solid, of_particles), "");
  int block = 0;
  while (moving.regions.front().particles->particles(block, 0).size() < 3) ++block;
  mpm::ParticleSet const& set = moving.regions.front().particles->particles(block, 0);
  auto const spoilt = [&](Field field, double value) {
    double const* values = set.field(field);
    std::vector<double> before(values, values + set.size());
    std::vector<double> after = before;
    after[1] = value;
    return with(of_particles, before, after);
  };
  for (double const x : {nan, 1e300, -1e300, 10.0}) {
    expect(solid, spoilt(Field::position_x, x), "the position of a particle of body");
    expect(solid, spoilt(Field::position_y, x), "the position of a particle of body");
  }
  for (double const number : {nan, -1.0, 2.0, 1e300})
    expect(solid, spoilt(Field::load_number, number), "the fields of a particle");
  for (double const number : {nan, -1.0, 1e300})
    expect(solid, spoilt(Field::identity, number), "the fields of a particle");
}

// Any number of a checkpoint replaced by one that it should not hold: refused, or a world that can be looked at.
TEST(State, NoNumberOfACheckpointIsTrusted) {
  set_threads(1);
  Case const solid = everything(mpm::Transfer::flip, mpm::ShapeFunction::bspline, mpm::StressOrder::musl);
  for (Case const& c :
       {burst(Scheme::muscl_hancock), solid, coupled(true, mpm::Transfer::apic, mpm::StressOrder::usl)}) {
    observe::Watched whole(c);
    for (int n = 0; n < 3; ++n) step(whole);
    std::string const good = written(whole);
    observe::Watched other(c);
    std::mt19937 random(11);
    int refused = 0;
    for (int trial = 0; trial < 300; ++trial) {
      constexpr std::array<std::uint64_t, 5> hostile{~0ULL, 1ULL << 40U, 0x7ff8000000000000ULL, 0x7fefffffffffffffULL,
                                                     0x8000000000000001ULL};
      // Half of them where sizes and times are: at the beginning, and behind the state of the cells.
      std::size_t const range = trial % 2 == 0 ? std::min<std::size_t>(good.size(), 2000) : good.size();
      std::size_t const at = random() % (range - 8);
      std::string bad = good;
      std::memcpy(bad.data() + at, &hostile[trial % hostile.size()], 8);
      try {
        read(other, bad);
        other.update_audit();
        (void)other.totals();
      } catch (IoError const&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 10);
  }
}

}  // namespace
}  // namespace brisance::run
