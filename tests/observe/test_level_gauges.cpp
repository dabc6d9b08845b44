// Gauges and fields of runs with cells of several sizes.
#include <gtest/gtest.h>

#include <random>

#include "../run/cases.hpp"
#include "observe/expected_peak.hpp"
#include "observe/gas_fields.hpp"
#include "watched.hpp"

namespace brisance::observe {
namespace {

using namespace run;
using grid::Geometry;

/// A gas whose conserved fields are linear, so that the means of fine cells are what the coarse one has at its centre:
/// either pressure and density vary, or the velocity. Around an axis only what varies along it is linear to them.
struct LinearGas {
  Geometry geometry;
  bool moves;

  [[nodiscard]] material::Primitive at(Vec3 x) const {
    for (int d = grid::dimensions(geometry); d < 3; ++d) x[d] = 0.0;
    if (grid::radial_exponent(geometry) > 0) x[0] = 0.0;
    material::Primitive state;
    state.pressure = 1e5;
    state.density = 1.2;
    state.velocity = {10.0, 5.0, 1.0};
    if (moves) {
      state.velocity = {10.0 + x[0], 5.0 - 2.0 * x[1], 1.0 + 1.5 * x[0] + x[2]};
    } else {
      state.pressure += 3e4 * x[0] - 2e4 * x[1] + 7e3 * x[2];
      state.density += 0.3 * x[0] + 0.1 * x[1] - 0.2 * x[2];
    }
    return state;
  }
  void fill(World& world) const {
    for (grid::Block const& block : world.grid.blocks())
      for_each_cell(block, [&](grid::Cell const& cell) { world.gas->set(cell, at(block.centre(cell))); });
    world.gas->start();
  }
  /// Tolerances: rounding of sums of up to 27 values.
  void expect_at_gauges(Watched const& world) const {
    for (GaugeHistory const& gauge : world.gauges.gas) {
      material::Primitive const expected = at(gauge.gauge.position);
      GaugeRecord const& seen = gauge.records.back();
      EXPECT_NEAR(seen.density / expected.density, 1.0, 1e-13);
      for (int d = 0; d < 3; ++d) EXPECT_NEAR(seen.velocity[d], expected.velocity[d], 1e-12);
      // The kinetic energy of a velocity that varies is not linear.
      if (!moves) {
        EXPECT_NEAR(seen.pressure / expected.pressure, 1.0, 1e-13);
      }
    }
  }
};

/// Air in 2 m with two finer levels around the middle.
Case levels_case(Geometry geometry) {
  int const dims = grid::dimensions(geometry);
  Case c = air_case(geometry, {40, 40, dims > 2 ? 40 : 1}, 0.05, grid::Boundary::outflow);
  c.numerics.block_cells = 8;
  c.adaptive.finest = 2;
  Vec3 const middle{1.0, 1.0, dims > 2 ? 1.0 : 0.0};
  c.adaptive.parts = {{shape::Sphere{middle, 0.1}, 2}};
  return c;
}

/// Gauges all over the domain, except where nearest cells stand in for what lies beyond it: within a coarse cell.
void add_gauges(Case& c, int count) {
  std::minstd_rand random(7);
  std::uniform_real_distribution<double> place(0.06, 1.94);
  int const dims = c.domain.dimensions();
  for (int n = 0; n < count; ++n) {
    Vec3 x{0.0, 0.0, 0.0};
    for (int d = 0; d < dims; ++d) x[d] = place(random);
    c.gauges.push_back({"g", x});
  }
  // On faces, edges and corners of blocks of all sizes.
  for (double const x : {0.4, 0.6, 0.8, 0.9, 1.0, 1.2, 1.4, 1.6}) c.gauges.push_back({"g", {x, x, dims > 2 ? x : 0.0}});
}

/// A build without p4est has no levels.
class LevelGauges : public testing::TestWithParam<Geometry> {
 protected:
  void SetUp() override {
    if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  }
};

TEST_P(LevelGauges, ReproduceALinearFieldAcrossLevels) {
  Case c = levels_case(GetParam());
  add_gauges(c, 400);
  Watched world(c);
  ASSERT_EQ(world.grid.levels(), 3);
  for (bool const moves : {false, true}) {
    LinearGas const gas{GetParam(), moves};
    gas.fill(world);
    world.sample_gauges();
    gas.expect_at_gauges(world);
  }
}

TEST_P(LevelGauges, DoNotSeeBlocksChangeInALinearField) {
  Case c = levels_case(GetParam());
  c.adaptive.parts.clear();
  // The shock around a ball under pressure asks for fine cells; the gas that replaces it does not.
  c.adaptive.shocks = 2;
  InitialState ball;
  ball.shape = shape::Sphere{{1.0, 1.0, GetParam() == Geometry::cartesian3d ? 1.0 : 0.0}, 0.2};
  ball.state = {1.2, 1e7, {0.0, 0.0, 0.0}};
  c.initial_states = {ball};
  add_gauges(c, 100);
  Watched world(c);
  for (int n = 0; n < 40 && world.grid.levels() < 3; ++n) advance(world, 1.0);
  ASSERT_EQ(world.grid.levels(), 3);
  LinearGas const gas{GetParam(), false};
  gas.fill(world);
  world.sample_gauges();
  gas.expect_at_gauges(world);
  long const before = world.adaptation->changes();
  world.clock.step = 0;  // a multiple of every interval
  for (int n = 0; n < 20 && world.grid.levels() > 1; ++n) {
    world.adaptation->follow(world);
    world.sample_gauges();
    gas.expect_at_gauges(world);
  }
  EXPECT_EQ(world.grid.levels(), 1);
  EXPECT_GT(world.adaptation->changes(), before);
}

TEST_P(LevelGauges, RunThroughChangesOfTheBlocks) {
  Case c = levels_case(GetParam());
  c.adaptive.parts.clear();
  c.adaptive.shocks = 1;
  c.adaptive.finest = 1;
  InitialState ball;
  ball.shape = shape::Sphere{{1.0, 1.0, GetParam() == Geometry::cartesian3d ? 1.0 : 0.0}, 0.2};
  ball.state = {1.2, 1e7, {0.0, 0.0, 0.0}};
  c.initial_states = {ball};
  add_gauges(c, 20);
  Watched world(c);
  world.sample_gauges();
  long const before = world.adaptation->changes();
  for (int n = 0; n < 60; ++n) {
    advance(world, 1.0);
    world.sample_gauges();
  }
  EXPECT_GT(world.adaptation->changes(), before);
  for (GaugeHistory const& gauge : world.gauges.gas) {
    for (GaugeRecord const& record : gauge.records) {
      ASSERT_GT(record.pressure, 1e3);
      ASSERT_LT(record.pressure, 1.2e7);
    }
  }
}

TEST_P(LevelGauges, ShowTheLevelOfEachCell) {
  Watched world(levels_case(GetParam()));
  std::vector<double> levels;
  for (grid::Block const& block : world.grid.blocks()) {
    block_field(world, block.number, "level", levels);
    ASSERT_EQ(levels.size(), static_cast<std::size_t>(block.cell_count()));
    for (double const level : levels) ASSERT_EQ(level, block.level);
  }
}

INSTANTIATE_TEST_SUITE_P(Gauges, LevelGauges,
                         testing::Values(Geometry::planar2d, Geometry::axisymmetric2d, Geometry::cartesian3d),
                         [](auto const& one) { return std::string(word_of(one.param)); });

TEST(ExpectedCell, IsThatOfTheLevelWhichTheCaseAsksFor) {
  Case c = air_case(Geometry::planar2d, {40, 40, 1}, 0.08, grid::Boundary::outflow);
  EXPECT_EQ(expected_cell(c, {1.0, 1.0, 0.0}), 0.08);
  c.adaptive.finest = 3;
  c.adaptive.shocks = 1;
  c.adaptive.parts = {{shape::Sphere{{1.0, 1.0, 0.0}, 0.1}, 2}};
  EXPECT_EQ(expected_cell(c, {1.05, 1.0, 0.0}), 0.02);
  EXPECT_EQ(expected_cell(c, {1.5, 1.0, 0.0}), 0.04);
  c.adaptive.gauges = 3;
  EXPECT_EQ(expected_cell(c, {1.5, 1.0, 0.0}), 0.01);
  MpmRegion region;
  region.boxes = {shape::Box{{2.0, 2.0, 0.0}, {3.0, 3.0, 0.0}}};
  region.level = 2;
  c.mpm_regions = {region};
  EXPECT_EQ(expected_cell(c, {2.5, 2.5, 0.0}), 0.02);
}

}  // namespace
}  // namespace brisance::observe
