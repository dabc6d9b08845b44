// Gauges interpolate linearly between cell centres.
#include <gtest/gtest.h>

#include "../run/cases.hpp"
#include "watched.hpp"

namespace brisance::observe {
namespace {

using namespace run;

double linear_pressure(Vec3 const& x) { return 1e5 + 3e4 * x[0] - 2e4 * x[1] + 7e3 * x[2]; }
double linear_density(Vec3 const& x) { return 1.2 + 0.3 * x[0] + 0.1 * x[1] - 0.2 * x[2]; }
Vec3 linear_velocity(Vec3 const& x) { return {10.0 + x[0], 5.0 - 2.0 * x[1], 1.0 + 3.0 * x[0] * 0.5 + x[2]}; }

void fill_linearly(Watched& world) {
  for (grid::Block const& block : world.grid.blocks()) {
    for_each_cell(block, [&](grid::Cell const& cell) {
      Vec3 x = block.centre(cell);
      for (int d = world.setup.domain.dimensions(); d < 3; ++d) x[d] = 0.0;
      material::Primitive state;
      state.pressure = linear_pressure(x);
      state.density = linear_density(x);
      state.velocity = linear_velocity(x);
      world.gas->set(cell, state);
    });
  }
  world.gas->start();
}

TEST(Gauges, ReproduceALinearFieldAcrossBlocks) {
  struct Setup {
    grid::Geometry geometry;
    Index3 cells;
  };
  for (Setup const& s : {Setup{grid::Geometry::planar1d, {40, 1, 1}}, Setup{grid::Geometry::planar2d, {20, 24, 1}},
                         Setup{grid::Geometry::cartesian3d, {20, 16, 24}}}) {
    Case c = air_case(s.geometry, s.cells, 0.05, grid::Boundary::outflow);
    c.numerics.block_cells = 8;
    int const dims = grid::dimensions(s.geometry);
    for (Vec3 x : {Vec3{0.4, 0.4, 0.4}, Vec3{0.3917, 0.2011, 0.7003}, Vec3{0.7749, 0.5501, 0.1234},
                   Vec3{0.625, 0.375, 0.525}, Vec3{0.9, 0.0251, 0.0251}}) {
      for (int d = dims; d < 3; ++d) x[d] = 0.0;
      if (dims > 1) x[1] = std::max(x[1], 0.025);
      c.gauges.push_back({"g", x});
    }
    Watched world(c);
    ASSERT_GT(world.grid.block_count(), 2);
    fill_linearly(world);
    world.sample_gauges();
    for (GaugeHistory const& gauge : world.gauges.gas) {
      ASSERT_EQ(gauge.records.size(), 1U);
      Vec3 const& x = gauge.gauge.position;
      EXPECT_NEAR(gauge.records[0].pressure / linear_pressure(x), 1.0, 1e-13);
      EXPECT_NEAR(gauge.records[0].density / linear_density(x), 1.0, 1e-13);
      for (int d = 0; d < 3; ++d) EXPECT_NEAR(gauge.records[0].velocity[d], linear_velocity(x)[d], 1e-12);
    }
  }
}

TEST(Gauges, BeyondTheLastCentreTakeTheNearestCell) {
  Case c = air_case(grid::Geometry::planar1d, {40, 1, 1}, 0.05, grid::Boundary::outflow);
  c.gauges = {{"low", {0.0, 0.0, 0.0}}, {"high", {2.0, 0.0, 0.0}}};
  Watched world(c);
  fill_linearly(world);
  world.sample_gauges();
  EXPECT_NEAR(world.gauges.gas[0].records[0].pressure, linear_pressure({0.025, 0.0, 0.0}), 1e-7);
  EXPECT_NEAR(world.gauges.gas[1].records[0].pressure, linear_pressure({1.975, 0.0, 0.0}), 1e-7);
}

TEST(Gauges, LeaveTheInsideOfAnObstacleOut) {
  Case c = air_case(grid::Geometry::planar2d, {20, 20, 1}, 0.05, grid::Boundary::outflow);
  c.obstacles = {{"block", shape::Box{{0.5, 0.0, 0.0}, {1.0, 1.0, 1.0}}}};
  c.gauges = {{"face", {0.5, 0.525, 0.0}}};  // between the last open cell and the first solid one
  Watched world(c);
  fill_linearly(world);
  world.sample_gauges();
  EXPECT_NEAR(world.gauges.gas[0].records[0].pressure, linear_pressure({0.475, 0.525, 0.0}), 1e-7);
}

}  // namespace
}  // namespace brisance::observe
