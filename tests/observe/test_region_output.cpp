/// What gauges and dumps show of a gas that particles carry in an MPM region.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "observe/gas_fields.hpp"
#include "observe/gas_view.hpp"
#include "observe/particle_fields.hpp"
#include "setup/place_region.hpp"
#include "watched.hpp"

namespace brisance::observe {
namespace {

using namespace run;

/// Air at rest under a shock tube's pressures, in one half of which particles calculate; `body`: with a block of steel.
Case tube(bool body) {
  Case c;
  c.domain.geometry = grid::Geometry::planar1d;
  c.domain.h = 0.01;
  c.domain.cells = {200, 1, 1};
  c.ambient.fluid.eos = material::IdealGas{};
  c.ambient.fluid.name = "air";
  InitialState high;
  high.shape = shape::Box{{0.0, -1.0, -1.0}, {0.4, 1.0, 1.0}};
  high.state = {2.45, 2.0 * 101325.0, {0.0, 0.0, 0.0}};
  c.initial_states.push_back(high);
  MpmRegion region;
  region.boxes = {shape::Box{{1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}};
  c.mpm_regions = {region};
  if (body) {
    Body block;
    block.name = "block";
    block.shape = shape::Box{{1.6, -1.0, -1.0}, {1.795, 1.0, 1.0}};
    block.solid = material::elastic_solid(7800.0, 200e9, 0.3);
    c.particles.bodies.push_back(block);
  }
  c.end.time = 3e-3;
  c.output.fields = {"pressure"};
  return c;
}

void gauge_at(Case& c, double x) { c.gauges.push_back({"g", {x, 0.0, 0.0}}); }

std::vector<double> line(Watched const& w, std::string const& name) {
  std::vector<PlacedCell> cells;
  for (run::Region const& of_world : w.regions) {
    for (Index3 const& cell : of_world.bridge->region().cells())
      cells.push_back({of_world.bridge->region().level(), cell});
  }
  GasView view(w, cells);
  view.update();
  view.update_solids();
  std::vector<double> out;
  std::vector<double> block;
  for (int b = 0; b < w.grid.block_count(); ++b) {
    block_field(w, b, name, block, &view);
    out.insert(out.end(), block.begin(), block.end());
  }
  return out;
}

TEST(RegionOutput, GaugesAndFieldsSeeTheSameGasOnBothSidesOfTheBridge) {
  Case c = tube(false);
  for (double const x : {0.905, 1.035, 1.505}) gauge_at(c, x);  // gas, bridge, particles: centres of cells
  Watched coupled(c);
  c.mpm_regions.clear();
  Watched gas(std::move(c));
  for (Watched* w : {&coupled, &gas}) {
    w->sample_gauges();
    while (!w->finished()) {
      advance(*w, w->setup.end.time);
      w->sample_gauges();
    }
  }
  for (std::size_t g = 0; g < 3; ++g) {
    auto const& record = coupled.gauges.gas[g].records.back();
    auto const& reference = gas.gauges.gas[g].records.back();
    EXPECT_EQ(coupled.gauges.gas[g].records.front().pressure, 101325.0) << g;  // the particles hold the ambient state
    // Behind a shock of 0.4 atm; particles and cells each smear it over some cells.
    EXPECT_GT(reference.pressure, 1.35 * 101325.0);
    EXPECT_NEAR(record.pressure, reference.pressure, 0.01 * reference.pressure) << g;
    EXPECT_NEAR(record.density, reference.density, 0.01 * reference.density) << g;
    EXPECT_NEAR(record.velocity[0], reference.velocity[0], 0.03 * reference.velocity[0]) << g;
  }
  auto const pressure = line(coupled, "pressure");
  auto const velocity = line(coupled, "velocity");
  auto const energy = line(coupled, "energy");
  auto const region = line(coupled, "region");
  EXPECT_EQ(region[99], 0.0);
  EXPECT_EQ(region[100], 1.0);
  EXPECT_EQ(region[104], 1.0);
  EXPECT_EQ(region[105], 2.0);
  EXPECT_EQ(region[199], 2.0);
  EXPECT_EQ(pressure[150], coupled.gauges.gas[2].records.back().pressure);
  EXPECT_EQ(pressure[90], coupled.gauges.gas[0].records.back().pressure);
  auto const& r = coupled.gauges.gas[2].records.back();
  EXPECT_NEAR(energy[150], r.pressure / 0.4 + 0.5 * r.density * r.velocity[0] * r.velocity[0], 1e-6 * energy[150]);
  EXPECT_EQ(velocity[450], r.velocity[0]);
}

TEST(RegionOutput, CellsInsideSolidsHoldNoGas) {
  Case c = tube(true);
  gauge_at(c, 1.7);
  Watched w(c);
  w.sample_gauges();
  EXPECT_EQ(w.gauges.gas[0].records[0].pressure, 101325.0);
  EXPECT_EQ(w.gauges.gas[0].records[0].density, 0.0);
  auto const density = line(w, "density");
  auto const pressure = line(w, "pressure");
  auto const solid = line(w, "solid");
  EXPECT_NEAR(density[150], 1.225, 1e-12);
  EXPECT_EQ(density[170], 0.0);
  EXPECT_EQ(pressure[170], 101325.0);
  EXPECT_EQ(solid[150], 0.0);
  for (int i = 160; i < 179; ++i) EXPECT_NEAR(solid[i], 1.0, 1e-9) << i;
  EXPECT_NEAR(solid[179], 0.5, 1e-9);  // the block ends in its middle
  EXPECT_EQ(solid[180], 0.0);
}

TEST(RegionOutput, GasParticlesAreDumpedWhenAskedFor) {
  Case c = tube(true);
  Watched without(c);
  c.output.gas_particles = true;
  Watched with(std::move(c));
  EXPECT_EQ(dumped_particles(without), mpm::sums(*without.regions.front().particles, 0).particles);
  EXPECT_EQ(dumped_particles(with), mpm::particle_count(*with.regions.front().particles));
  EXPECT_GT(dumped_particles(with), dumped_particles(without));
  std::vector<double> body;
  particle_field(without, "body", body);
  EXPECT_EQ(static_cast<long>(body.size()), dumped_particles(without));
  for (double const b : body) EXPECT_EQ(b, 0.0);
  particle_field(with, "body", body);
  EXPECT_EQ(*std::max_element(body.begin(), body.end()), 1.0);  // the gas is the last
}

/// The same with a second block in a region of its own, nearer to the high pressure.
Case two_regions() {
  Case c = tube(true);
  c.output.gas_particles = true;
  Body nearer = c.particles.bodies[0];
  nearer.name = "nearer";
  nearer.shape = shape::Box{{0.8, -1.0, -1.0}, {0.895, 1.0, 1.0}};
  c.particles.bodies.push_back(nearer);
  c.particles.gauges = {{"far", 0, Vec3{1.6, 0.0, 0.0}}, {"near", 1, Vec3{0.8, 0.0, 0.0}}, {"all", 1, {}}};
  // Listed against the order of the bodies.
  MpmRegion region;
  region.boxes = {shape::Box{{0.6, 0.0, 0.0}, {1.1, 0.0, 0.0}}};
  region.bodies = {1};
  c.mpm_regions.insert(c.mpm_regions.begin(), region);
  c.mpm_regions[1].boxes = {shape::Box{{1.3, 0.0, 0.0}, {2.0, 0.0, 0.0}}};
  c.mpm_regions[1].bodies = {0};
  return c;
}

TEST(RegionOutput, DumpsShowAllRegions) {
  Watched const w(two_regions());
  auto const region = line(w, "region");
  auto const solid = line(w, "solid");
  EXPECT_EQ(region[59], 0.0);
  EXPECT_EQ(region[60], 1.0);
  EXPECT_EQ(region[85], 2.0);
  EXPECT_EQ(region[120], 0.0);
  EXPECT_EQ(region[170], 2.0);
  EXPECT_NEAR(solid[85], 1.0, 1e-9);
  EXPECT_EQ(solid[100], 0.0);
  EXPECT_NEAR(solid[170], 1.0, 1e-9);
  EXPECT_EQ(dumped_particles(w), w.particle_count());
  std::vector<double> body;
  std::vector<double> identity;
  std::vector<double> position;
  particle_field(w, "body", body);
  particle_field(w, "identity", identity);
  particle_field(w, "position", position);
  std::set<std::pair<double, double>> all;
  for (std::size_t n = 0; n < body.size(); ++n) {
    EXPECT_TRUE(all.insert({body[n], identity[n]}).second) << "body " << body[n] << ", particle " << identity[n];
    // Body 1 and gas 2 are in the first region.
    EXPECT_EQ(position[3 * n] < 1.2, body[n] == 1.0 || body[n] == 2.0);
  }
  for (int b = 0; b < 4; ++b) EXPECT_EQ(std::ranges::count(body, b), w.bodies[b].particles) << b;
  EXPECT_EQ(w.bodies[2].name, "gas of region 1");
  EXPECT_EQ(w.bodies[3].name, "gas of region 2");
}

TEST(RegionOutput, GaugesSeeAllRegions) {
  Case c = two_regions();
  for (double const x : {0.72, 1.45, 1.2}) gauge_at(c, x);
  Watched w(c);
  w.sample_gauges();
  while (w.clock.time < 1.2e-3) {
    advance(w, 1.2e-3);
    w.sample_gauges();
  }
  EXPECT_TRUE(w.regions[0].bridge->awake());
  EXPECT_FALSE(w.regions[1].bridge->awake());  // behind the block of the first
  auto const pressure = [&](int gauge) {
    return w.gauges.gas[static_cast<std::size_t>(gauge)].records.back().pressure;
  };
  EXPECT_GT(pressure(0), 1.5 * 101325.0);
  EXPECT_NEAR(pressure(1), 101325.0, 200.0);
  EXPECT_NEAR(pressure(2), 101325.0, 200.0);
  // Particles and bodies by their numbers in the case.
  EXPECT_NEAR(w.gauges.particles[0].particles.front().position[0], 1.6, 0.01);
  EXPECT_NEAR(w.gauges.particles[1].particles.front().position[0], 0.8, 0.01);
  EXPECT_GT(w.gauges.particles[1].particles.back().velocity[0], 0.0);
  EXPECT_EQ(w.gauges.particles[0].particles.back().velocity[0], 0.0);
  EXPECT_EQ(w.gauges.particles[2].bodies.back().sums.momentum[0], w.sums(1).momentum[0]);
  EXPECT_GT(w.gauges.bodies[1].back().sums.kinetic_energy, 0.0);
  EXPECT_EQ(w.gauges.bodies[0].back().sums.kinetic_energy, 0.0);
}

}  // namespace
}  // namespace brisance::observe
