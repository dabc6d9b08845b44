// The program's parts on cases of material points.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "../observe/watched.hpp"
#include "../run/particles_case.hpp"
#include "../session/small_case.hpp"
#include "app/plan_text.hpp"
#include "app/progress.hpp"
#include "core/error.hpp"
#include "session/driver.hpp"

namespace brisance::app {
namespace {

using namespace session;

TEST(ParticlePlan, KnowsTheBodiesAsTheWorldWillFillThem) {
  auto setup = run::two_blocks();
  setup.particles.bodies[0].shape = shape::Cylinder{{0.012, 0.012, 0.0}, 0.0093, 1.0, {0.0, 0.0, 1.0}};
  setup.particles.bodies[2].density = 2.0;
  Plan const p = plan(setup);
  observe::Watched const world{run::Case(setup)};
  ASSERT_EQ(p.bodies.size(), 3U);
  EXPECT_EQ(p.particles, static_cast<double>(mpm::particle_count(*world.regions.front().particles)));
  for (int b = 0; b < 3; ++b) {
    EXPECT_EQ(p.bodies[b].particles, world.bodies[b].particles);
    // Two ways of summing the same points: round-off.
    EXPECT_NEAR(p.bodies[b].mass / world.bodies[b].mass, 1.0, 1e-13);
    EXPECT_NEAR(p.bodies[b].geometric_mass / world.bodies[b].geometric_mass, 1.0, 1e-13);
  }
}

TEST(ParticlePlan, StepsAreAsLongAsTheFirst) {
  auto setup = run::two_blocks();
  observe::Watched world{run::Case(setup)};
  double const first = world.regions.front().particles->stable_step();
  // The steps of the gentle start come on top.
  EXPECT_NEAR(plan(setup).steps, setup.end.time / first + 5.0, 1e-6 * setup.end.time / first);
  setup.end.steps = 12;
  EXPECT_EQ(plan(setup).steps, 12.0);
  // Explosives: the detonation is faster than the sound.
  auto const charge = run::charge_slab();
  observe::Watched const slab{run::Case(charge)};
  EXPECT_NEAR(plan(charge).steps / (charge.end.time / slab.regions.front().particles->stable_step() + 5.0), 1.0, 1e-6);
}

TEST(ParticlePlan, MemoryIsThatOfTheParticles) {
  auto setup = run::two_blocks();
  Plan const before = plan(setup);
  EXPECT_GT(before.dump_bytes, 3600 * 12.0);
  for (auto& body : setup.particles.bodies) body.particles_per_direction = 8;
  Plan const p = plan(setup);
  EXPECT_EQ(p.particles, 16.0 * 3600);
  EXPECT_NEAR(p.memory_bytes - before.memory_bytes, 15 * 3600 * 300.0 + p.dump_bytes - before.dump_bytes, 1.0);
  // What the particles really take is not more.
  observe::Watched const world{run::Case(setup)};
  double taken = 0.0;
  for (int block = 0; block < world.regions.front().particles->grid().block_count(); ++block)
    for (int body = 0; body < 3; ++body)
      taken += static_cast<double>(world.regions.front().particles->particles(block, body).bytes());
  EXPECT_LT(taken, p.particles * 300.0);
  EXPECT_GT(taken, p.particles * 100.0);
}

TEST(ParticlePlan, WhatCannotFitIsNotFilled) {
  auto setup = run::two_blocks();
  setup.domain.geometry = grid::Geometry::cartesian3d;
  setup.domain.h = 1e-5;
  setup.domain.cells = {20000, 20000, 20000};
  setup.particles.bodies.resize(1);
  setup.particles.bodies[0].shape = shape::Box{{0.0, 0.0, 0.0}, {0.2, 0.2, 0.2}};
  Plan const p = plan(setup);
  EXPECT_GT(p.particles, 1e13);
  EXPECT_THROW(refuse_unless_it_fits(p), InputError);
  EXPECT_EQ(plan_json(setup, p)["bodies"][0]["mass"], nullptr);
}

// What a machine holds, but a look does not try out: the volume tells the number of particles.
TEST(ParticlePlan, LargeBodiesAreEstimatedByTheirVolume) {
  auto setup = run::two_blocks();
  setup.domain.geometry = grid::Geometry::cartesian3d;
  setup.domain.h = 0.01;
  setup.domain.cells = {1250, 1250, 1250};
  setup.particles.bodies.resize(1);
  setup.particles.bodies[0].shape = shape::Sphere{{6.0, 6.0, 6.0}, 5.0};
  double const particles = 8.0 * 4.0 / 3.0 * M_PI * 1.25e8;
  EXPECT_NEAR(plan(setup).particles / particles, 1.0, 1e-6);
}

TEST(ParticlePlan, WarnsOfThinBodies) {
  auto setup = run::two_blocks();
  EXPECT_TRUE(plan(setup).warnings.empty());
  setup.particles.bodies[1].shape = shape::Box{{0.03, 0.002, 0.0}, {0.0315, 0.022, 0.0}};
  ASSERT_EQ(plan(setup).warnings.size(), 1U);
  EXPECT_NE(plan(setup).warnings[0].find("only 3 material points across"), std::string::npos)
      << plan(setup).warnings[0];
  // A gas does not bend.
  setup.particles.bodies[2].shape = shape::Box{{0.02, 0.03, 0.0}, {0.0215, 0.04, 0.0}};
  EXPECT_EQ(plan(setup).warnings.size(), 1U);
}

TEST(ParticlePlan, TextAndJsonTellTheSame) {
  auto const setup = run::two_blocks();
  Plan const p = plan(setup);
  auto const json = plan_json(setup, p);
  EXPECT_EQ(json["points"], 3600.0);
  EXPECT_EQ(json["bodies"][0]["name"], "left");
  EXPECT_EQ(json["gauges"], 2);
  EXPECT_EQ(json["materials"].size(), 2U);
  std::string const text = plan_text(setup, p);
  for (char const* part :
       {"3600 material points in 3 bodies", "material points, ", "left: copper, 1600 particles, 2 per cell",
        "(100, 0, 0) m/s", "mass of the particles 3.572 kg, of the shape 3.572 kg", "copper (body): a test",
        "position, body, material, velocity"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  EXPECT_EQ(text.find("ambient"), std::string::npos) << "there is no gas";
}

TEST(ParticleDriver, RunsToItsEnd) {
  auto setup = run::two_blocks();
  setup.end.time = 1e-6;
  setup.output.field_interval = 0.5e-6;
  observe::Watched world(std::move(setup));
  Scratch scratch;
  output::Writer writer(world, world.gauges, scratch.path());
  std::atomic<bool> const stop{false};
  std::FILE* const shown = std::tmpfile();
  Progress progress(shown, true);
  auto const ending = drive(world, world.gauges, writer, stop, [&](run::World const& w) { progress.step(w); });
  std::fclose(shown);
  EXPECT_EQ(ending.code, ExitCode::done) << ending.reason;
  EXPECT_EQ(writer.dump_count(), 3);
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "points/points_000002.h5"));
  EXPECT_EQ(world.gauges.bodies[0].back().time, 1e-6);
  EXPECT_EQ(world.gauges.particles[0].particles.back().time, 1e-6);
}

}  // namespace
}  // namespace brisance::app
