// Several MPM regions in one simulation: they do what one region of several boxes does, each wakes by itself and loses
// nothing, and they go on from a checkpoint, and with any number of threads, with the same bits.
#include <gtest/gtest.h>

#include <cmath>

#include "cases.hpp"
#include "checkpoint_bytes.hpp"
#include "core/parallel.hpp"
#include "setup/levels.hpp"
#include "setup/region_gaps.hpp"

namespace brisance::run {
namespace {

using grid::Boundary;
using grid::Geometry;

constexpr double h = 0.02;
// Where the compressed air begins: as far from one region as from the other, and nearer to the second.
constexpr double middle = 0.58;
constexpr double aside = 0.6;

Body plate_at(double x, char const* name) {
  Body plate;
  plate.name = name;
  plate.solid = material::elastic_solid(2700.0, 70e9, 0.33);
  plate.shape = shape::Box{{x, 0.08, -1.0}, {x + 0.06, 0.16, 1.0}};
  return plate;
}

shape::Box box_at(double x) { return {{x, 0.0, -1.0}, {x + 0.26, 0.24, 1.0}}; }

/// Compressed air from `x` on in a closed box of 64 by 12 cells, and two plates, each in a region; or both in the boxes
/// of one.
Case tube(bool in_one, double x) {
  Case c = air_case(Geometry::planar2d, {64, 12, 1}, h, Boundary::wall);
  c.numerics.block_cells = 16;
  c.particles.options.block_cells = 8;
  c.initial_states = {{shape::Box{{x, 0.0, -1.0}, {x + 0.12, 0.24, 1.0}}, {12.0, 4e6, {0.0, 0.0, 0.0}}, false, ""}};
  c.particles.bodies = {plate_at(0.36, "first"), plate_at(0.86, "second")};
  c.particles.gauges = {{"first", 0, {}}, {"on the second", 1, Vec3{0.86, 0.12, 0.0}}};
  c.gauges = {
      {"in the first", {0.33, 0.12, 0.0}}, {"between", {0.63, 0.12, 0.0}}, {"in the second", {0.81, 0.12, 0.0}}};
  MpmRegion region;
  region.width = 2;
  region.reference_pressure = 0.0;  // of its own lowest pressure each would take another
  region.subcycling = false;        // else each takes steps of its own
  c.mpm_regions = {region};
  if (in_one) {
    c.mpm_regions[0].boxes = {box_at(0.26), box_at(0.76)};
    return c;
  }
  c.mpm_regions.push_back(region);
  c.mpm_regions[0].boxes = {box_at(0.26)};
  c.mpm_regions[0].bodies = {0};
  c.mpm_regions[1].boxes = {box_at(0.76)};
  c.mpm_regions[1].bodies = {1};
  return c;
}

/// What a comparison looks at: how bodies move, and what gauges see.
std::vector<double> seen(observe::Watched& w) {
  std::vector<double> all{w.clock.time};
  for (int body = 0; body < 2; ++body) {
    mpm::BodySums const s = w.sums(body);
    all.insert(all.end(), {s.mass, s.momentum[0], s.kinetic_energy, s.internal_energy, s.centre[0]});
  }
  for (GaugeHistory const& history : w.gauges.gas) all.push_back(history.records.back().pressure);
  all.push_back(w.gauges.particles[1].particles.back().position[0]);
  return all;
}

double largest_mass_error(World& w) {
  w.update_audit();
  auto const error = w.audit.relative_error();
  return *std::max_element(error.mass.begin(), error.mass.end());
}

TEST(Regions, DoWhatOneRegionOfTheirBoxesDoes) {
  auto const run = [](Case c) {
    for (MpmRegion& region : c.mpm_regions) region.activation = -1.0;  // awake, so that all particles take all steps
    auto w = std::make_unique<observe::Watched>(std::move(c));
    advance_to(*w, 2e-4);
    return w;
  };
  auto const one = run(tube(true, middle));
  auto const two = run(tube(false, middle));
  ASSERT_EQ(one->regions.size(), 1U);
  ASSERT_EQ(two->regions.size(), 2U);
  std::vector<double> const a = seen(*one);
  std::vector<double> const b = seen(*two);
  double most = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) most = std::max(most, std::abs(a[n] - b[n]) / std::abs(a[n]));
  std::printf("%ld and %ld steps, largest relative difference %.2g, momenta %.6g and %.6g\n", one->clock.step,
              two->clock.step, most, a[2], a[7]);
  EXPECT_LT(a[2], -1.0);  // both plates were hit
  EXPECT_GT(a[7], 1.0);
  EXPECT_EQ(one->clock.step, two->clock.step);
  // The places of particles are rounded differently, since each region counts cells from its own corner. What a ledger
  // gives back to the gas in a step follows the fastest wave at all faces of its region: were one nearer to the air
  // than the other, the boxes of one region would differ from two regions by 1e-4 here.
  // Round-off grows from 1e-15 in the first steps to some 1e-9 here.
  EXPECT_LT(most, 1e-8);
  EXPECT_LT(largest_mass_error(*one), 1e-12);
  EXPECT_LT(largest_mass_error(*two), 1e-12);
  EXPECT_NEAR(one->energy_balance().drift(), two->energy_balance().drift(), 1e-9);
  EXPECT_TRUE(two->verdict().balanced);
}

/// While a region sleeps the fluxes through its faces are kept for it, whatever the others do meanwhile. The second
/// wakes late here, when gas has flown into it for a while.
TEST(Regions, KeepWhatFlowsIntoThemWhileTheySleep) {
  Case c = tube(false, 0.0);
  c.mpm_regions[1].activation = 2e5;
  for (MpmRegion& region : c.mpm_regions) region.subcycling = true;
  World w = setup::build(c);
  double flown = 0.0;
  while (!w.regions[1].bridge->awake() && w.clock.step < 2000) {
    advance(w, 1.0);
    w.update_audit();
    flown = std::max(flown, w.audit.relative_error().mass[0]);  // what a sleeping region has got is not yet counted
  }
  ASSERT_TRUE(w.regions[1].bridge->awake());
  EXPECT_GT(*w.regions[1].awake_since, *w.regions[0].awake_since);
  EXPECT_GT(flown, 1e-9) << "nothing has flown into the region that slept";
  for (int n = 0; n < 20; ++n) advance(w, 1.0);
  EXPECT_LT(largest_mass_error(w), 1e-12);
  EXPECT_GT(w.regions[0].steps, w.regions[1].steps);
  EXPECT_EQ(w.regions[0].steps + w.regions[1].steps, w.clock.particle_steps);
}

void append(std::vector<double>& bits, double const* values, int count) {
  if (values != nullptr) bits.insert(bits.end(), values, values + count);
}

/// All that a later step depends on, and all that is written.
std::vector<double> bits_of(observe::Watched const& w) {
  AuditMemory const& m = w.audit.memory;
  std::vector<double> bits{w.clock.time,
                           w.clock.dt,
                           double(w.clock.step),
                           double(w.clock.particle_steps),
                           double(w.grid.block_count()),
                           m.scale,
                           m.drift,
                           m.content};
  for (grid::Block const& block : w.grid.blocks()) {
    for (int c = 0; c < w.gas->fields().components(); ++c)
      append(bits, w.gas->fields().at(block.number, c), block.cell_count());
  }
  for (gas::FaceFlux const& flux : w.gas->coupling.watched()) bits.push_back(flux.carried.mass[0]);
  for (Region const& region : w.regions) {
    bits.insert(bits.end(), {region.awake_since.value_or(-1.0), double(region.steps), region.particles->time()});
    for (bridge::Amounts const& l : region.bridge->accounts()) bits.insert(bits.end(), {l.mass[0], l.energy, l.volume});
    for (int b = 0; b < region.particles->grid().block_count(); ++b) {
      for (int body = 0; body < static_cast<int>(region.bodies.size()); ++body) {
        mpm::ParticleSet const& set = region.particles->particles(b, body);
        bits.push_back(set.size());
        for (int f = 0; f < mpm::field_count; ++f) append(bits, set.field(static_cast<mpm::Field>(f)), set.size());
      }
    }
  }
  for (GaugeHistory const& history : w.gauges.gas) {
    for (GaugeRecord const& r : history.records) bits.insert(bits.end(), {r.time, r.pressure, r.velocity[0]});
  }
  for (ParticleGaugeHistory const& history : w.gauges.particles) {
    for (ParticleRecord const& r : history.particles) bits.push_back(r.position[0]);
  }
  for (auto const& records : w.gauges.bodies) bits.push_back(records.back().sums.kinetic_energy);
  return bits;
}

void step(observe::Watched& world) {
  advance(world, 1.0);
  world.follow_audit();
  world.sample_gauges();
}

void expect_the_same_after_any_stop(Case const& c, std::vector<long> const& stops, long steps) {
  for (long const stop : stops) {
    observe::Watched whole(c);
    whole.sample_gauges();
    std::string bytes;
    while (whole.clock.step < steps) {
      if (whole.clock.step == stop) bytes = written(whole);
      step(whole);
    }
    observe::Watched second(c);
    read(second, bytes);
    while (second.clock.step < steps) step(second);
    EXPECT_TRUE(bits_of(second) == bits_of(whole)) << "stopped after step " << stop;
    EXPECT_TRUE(whole.regions.front().bridge->awake());
  }
}

void expect_the_same_with_any_threads(Case const& c, long steps) {
  std::vector<std::vector<double>> states;
  for (int const count : {1, 2}) {
    set_threads(count);
    observe::Watched world(c);
    world.sample_gauges();
    while (world.clock.step < steps) step(world);
    EXPECT_TRUE(world.regions.back().bridge->awake());
    states.push_back(bits_of(world));
  }
  set_threads(1);
  EXPECT_TRUE(states[0] == states[1]);
}

/// Particles split and merge, and steps are taken as the regions like.
Case restless(Case c) {
  for (MpmRegion& region : c.mpm_regions) {
    region.subcycling = true;
    region.population_interval = 3;
  }
  return c;
}

TEST(Regions, GoOnFromACheckpoint) {
  Case c = restless(tube(false, aside));
  c.mpm_regions[1].population_interval = 4;
  expect_the_same_after_any_stop(c, {1, 4, 40}, 70);
}

TEST(Regions, HaveTheSameBitsWithAnyNumberOfThreads) {
  expect_the_same_with_any_threads(restless(tube(false, aside)), 80);
}

TEST(Regions, BelongToBodiesConstraintsAndLoadsOfTheirOwn) {
  Case c = tube(false, aside);
  c.initial_states.clear();
  c.particles.constraints.push_back(
      {shape::Box{{0.8, 0.0, -1.0}, {0.95, 0.24, 1.0}}, {true, true, true}, {3.0, 0.0, 0.0}, 1});
  mpm::SurfacePressure push;
  push.body = 0;
  push.within = shape::Box{{0.35, 0.0, -1.0}, {0.37, 0.24, 1.0}};
  push.normal = {-1.0, 0.0, 0.0};
  push.thickness = 0.01;
  push.times = {0.0, 1.0};
  push.pressures = {1e6, 1e6};
  c.particles.pressures.push_back(push);
  World w = setup::build(c);
  EXPECT_TRUE(w.regions[0].bridge->awake());
  EXPECT_TRUE(w.regions[1].bridge->awake());
  advance_to(w, 2e-5);
  EXPECT_GT(w.sums(0).momentum[0], 0.5 * 1e6 * 0.08 * 2e-5);
  EXPECT_NEAR(w.sums(1).momentum[0] / w.sums(1).mass, 3.0, 0.01);
  // Without them there is nothing that wakes anything.
  c.particles.constraints.clear();
  World only = setup::build(c);
  EXPECT_TRUE(only.regions[0].bridge->awake());
  EXPECT_FALSE(only.regions[1].bridge->awake());
  EXPECT_EQ(w.bodies.size(), 4U);
  EXPECT_EQ(w.bodies[1].name, "second");
  EXPECT_EQ(w.bodies[3].name, "gas of region 2");
}

TEST(Regions, MustLeaveCellsBetweenThem) {
  Case c = tube(false, 0.0);
  // B-splines reach three cells, and the gas needs four.
  EXPECT_EQ(setup::least_gap_of_regions(c), 7);
  auto const place = [&](double x) {
    c.mpm_regions[1].boxes = {box_at(x)};
    c.particles.bodies[1] = plate_at(x + 0.1, "second");
    return c;
  };
  EXPECT_NO_THROW((void)setup::build(place(0.66)));
  EXPECT_THROW((void)setup::build(place(0.64)), InputError);  // six cells
  EXPECT_THROW((void)setup::build(place(0.5)), InputError);
}

/// Two slabs in a closed box on both sides of compressed air: the first among cells of level 1, the second of `second`.
Case slabs(int coarse, int second) {
  Case c = air_case(Geometry::planar2d, {4 * coarse, coarse, 1}, 1.0 / coarse, Boundary::wall);
  c.initial_states.push_back(
      {shape::Cylinder{{1.9, 0.5, 0.0}, 0.2, 1.0, {0.0, 0.0, 1.0}}, {6.0, 20e5, {0.0, 0.0, 0.0}}, {}, {}});
  c.adaptive.finest = std::max(1, second);
  c.adaptive.shocks = 1;
  c.adaptive.obstacles = c.adaptive.charges = 1;
  c.numerics.block_cells = 8;
  for (double const x : {1.1, 2.6}) {
    Body body;
    body.name = x < 2.0 ? "first" : "second";
    body.solid = material::elastic_solid(7850.0, 210e9, 0.3);
    body.shape = shape::Box{{x, 0.375, -1.0}, {x + 0.05, 0.625, 1.0}};
    c.particles.bodies.push_back(body);
    MpmRegion region;
    region.width = 3;
    region.activation = 10.0;
    region.level = x < 2.0 ? 1 : second;
    region.bodies = {x < 2.0 ? 0 : 1};
    region.boxes = {{{x - 0.225, 0.125, -1.0}, {x + 0.275, 0.875, 1.0}}};
    c.mpm_regions.push_back(region);
  }
  // On faces of cells of level 1.
  for (MpmRegion& region : c.mpm_regions) {
    shape::Box& box = region.boxes.front();
    for (Vec3* corner : {&box.lower, &box.upper}) (*corner)[0] = std::round((*corner)[0] * 2 * coarse) / (2 * coarse);
  }
  return c;
}

class RegionsOnLevels : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "a build without p4est";
  }
};

TEST_F(RegionsOnLevels, LiveOnLevelsOfTheirOwnAndLoseNothing) {
  double const end = 1.5e-3;
  std::array<World, 2> worlds{setup::build(slabs(16, 2)), setup::build(slabs(16, 1))};
  for (World& w : worlds) {
    w.setup.end.time = end;
    while (!w.finished()) {
      advance(w, end);
      w.follow_audit();
    }
    EXPECT_LT(largest_mass_error(w), 1e-12);
    EXPECT_TRUE(w.regions[0].bridge->awake());
    EXPECT_TRUE(w.regions[1].bridge->awake());
    EXPECT_GT(w.regions[1].bridge->traffic().injected, 0);
    EXPECT_LT(w.sums(0).momentum[0], 0.0);
    EXPECT_GT(w.sums(1).momentum[0], 0.0);
    std::printf("momenta %.6g and %.6g kg m/s, drift %.2g, %ld and %ld particle steps, %ld changes\n",
                w.sums(0).momentum[0], w.sums(1).momentum[0], w.energy_balance().drift(), w.regions[0].steps,
                w.regions[1].steps, w.adaptation->changes());
    EXPECT_LT(std::abs(w.energy_balance().drift()), 5e-3);
  }
  World const& two = worlds[0];
  EXPECT_EQ(two.regions[0].bridge->region().metric().h, 1.0 / 32);
  EXPECT_EQ(two.regions[1].bridge->region().metric().h, 1.0 / 64);
  // The first sees little of what cells the second has; the second feels the same shock, with cells of half the size.
  EXPECT_NEAR(two.sums(0).momentum[0] / worlds[1].sums(0).momentum[0], 1.0, 0.02);
  EXPECT_NEAR(two.sums(1).momentum[0] / worlds[1].sums(1).momentum[0], 1.0, 0.1);
}

TEST_F(RegionsOnLevels, GoOnFromACheckpoint) { expect_the_same_after_any_stop(slabs(16, 2), {1, 25}, 32); }

TEST_F(RegionsOnLevels, HaveTheSameBitsWithAnyNumberOfThreads) { expect_the_same_with_any_threads(slabs(16, 2), 28); }

TEST_F(RegionsOnLevels, NeedBlocksOfTheirOwn) {
  Case c = slabs(16, 2);
  EXPECT_EQ(setup::regions_without_own_blocks(c), std::nullopt);
  // So near that a block of cells of the first level touches both.
  c.mpm_regions[1].boxes = {{{1.75, 0.125, -1.0}, {2.25, 0.875, 1.0}}};
  c.particles.bodies[1].shape = shape::Box{{1.975, 0.375, -1.0}, {2.025, 0.625, 1.0}};
  auto const found = setup::regions_without_own_blocks(c);
  ASSERT_TRUE(found);
  EXPECT_EQ(*found, std::pair(std::size_t{0}, std::size_t{1}));
  EXPECT_THROW((void)setup::build(c), InputError);
  c.mpm_regions[1].level = 1;
  EXPECT_EQ(setup::regions_without_own_blocks(c), std::nullopt);
}

}  // namespace
}  // namespace brisance::run
