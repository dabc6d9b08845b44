// Cells of several sizes in a whole simulation: blocks follow shocks, obstacles and charges keep their shape, nothing
// is lost, and a world that is written and read goes on with the same bits.
#include <gtest/gtest.h>

#include <cmath>

#include "cases.hpp"
#include "checkpoint_bytes.hpp"
#include "core/parallel.hpp"

namespace brisance::run {
namespace {

using grid::Boundary;
using grid::Geometry;

constexpr double bar = 1e5;

class RunLevels : public ::testing::TestWithParam<Geometry> {
 protected:
  void SetUp() override {
    if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "a build without p4est";
  }
};

/// A ball of compressed air in a closed box.
Case burst_case(Geometry geometry, int cells, int levels) {
  int const dims = grid::dimensions(geometry);
  Case c = air_case(geometry, {cells, cells, dims == 3 ? cells : 1}, 1.0 / cells, Boundary::wall);
  c.initial_states.push_back(
      {shape::Sphere{{0.3, 0.3, dims == 3 ? 0.3 : 0.0}, 0.15}, {6.0, 20.0 * bar, {0.0, 0.0, 0.0}}, {}, {}});
  c.adaptive.finest = c.adaptive.shocks = c.adaptive.obstacles = c.adaptive.charges = levels;
  c.numerics.block_cells = 8;
  return c;
}

double audit_error(World& w) {
  w.update_audit();
  auto const error = w.audit.relative_error();
  return std::max(*std::max_element(error.mass.begin(), error.mass.end()), error.energy);
}

/// Pressures at places of a grid of probes.
std::vector<double> pressures(World const& w, int n) {
  std::vector<double> all;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      Vec3 x{(i + 0.5) / n, (j + 0.5) / n, 0.3};
      all.push_back(w.gas->primitive(w.grid.locate(x)).pressure);
    }
  }
  return all;
}

double mean_difference(std::vector<double> const& a, std::vector<double> const& b) {
  double sum = 0.0;
  double scale = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    sum += std::abs(a[n] - b[n]);
    scale += std::abs(b[n] - 1.013e5);
  }
  return sum / scale;
}

TEST_P(RunLevels, FollowTheShockAsUniformCellsDo) {
  Geometry const geometry = GetParam();
  int const coarse = grid::dimensions(geometry) == 3 ? 24 : 48;
  World levels = setup::build(burst_case(geometry, coarse, 1));
  Case uniform = burst_case(geometry, 2 * coarse, 0);
  World fine = setup::build(uniform);
  ASSERT_EQ(levels.grid.levels(), 2);
  double const end = 3e-4;
  advance_to(levels, end);
  advance_to(fine, end);
  EXPECT_LT(audit_error(levels), 1e-12);
  EXPECT_GE(levels.adaptation->changes(), 1);
  double const difference = mean_difference(pressures(levels, 40), pressures(fine, 40));
  RecordProperty("difference", std::to_string(difference));
  EXPECT_LT(difference, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Geometries, RunLevels,
                         ::testing::Values(Geometry::planar2d, Geometry::axisymmetric2d, Geometry::cartesian3d),
                         [](auto const& of) {
                           return std::string(word_of(of.param)).substr(0, 6) + std::to_string(of.index);
                         });

std::vector<double> bits_of(World const& w) {
  std::vector<double> bits{w.clock.time, w.clock.dt, double(w.clock.step), double(w.grid.block_count())};
  for (grid::Block const& block : w.grid.blocks()) {
    for (int c = 0; c < w.gas->fields().components(); ++c) {
      double const* u = w.gas->fields().at(block.number, c);
      bits.insert(bits.end(), u, u + block.cell_count());
    }
  }
  return bits;
}

/// With an obstacle that no cells fit, one that all fit, and a charge.
Case furnished_case() {
  Case c = burst_case(Geometry::planar2d, 48, 2);
  c.initial_states.clear();
  c.obstacles.push_back({"round", shape::Cylinder{{0.71, 0.67, 0.0}, 0.083, 1.0, {0.0, 0.0, 1.0}}});
  c.obstacles.push_back({"box", shape::Box{{0.5, 0.0, -1.0}, {0.75, 0.25, 1.0}}});
  Charge charge = tnt_charge(shape::Cylinder{{0.3, 0.3, 0.0}, 0.02, 1.0, {0.0, 0.0, 1.0}}, Geometry::planar2d);
  c.charges.push_back(charge);
  return c;
}

TEST(RunLevelsWhole, ChargesAndObstaclesStayWhatTheyAre) {
  if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "a build without p4est";
  World w = setup::build(furnished_case());
  ASSERT_EQ(w.charges.size(), 1u);
  EXPECT_NEAR(w.charges[0].realised_mass, w.charges[0].specified_mass, 1e-12 * w.charges[0].specified_mass);
  advance_to(w, 1.2e-4);
  EXPECT_LT(audit_error(w), 1e-11);
  EXPECT_GT(w.adaptation->changes(), 3);
  EXPECT_FALSE(w.gas->cut.cells().empty());
}

TEST(RunLevelsWhole, GoesOnFromACheckpoint) {
  if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "a build without p4est";
  for (long const stop : {1L, 7L, 20L, 33L}) {
    World whole = setup::build(furnished_case());
    std::string bytes;
    while (whole.clock.step < 50) {
      if (whole.clock.step == stop) bytes = written(whole);
      advance(whole, 1.0);
    }
    World second = setup::build(furnished_case());
    read(second, bytes);
    EXPECT_EQ(second.clock.step, stop);
    while (second.clock.step < 50) advance(second, 1.0);
    EXPECT_EQ(bits_of(second), bits_of(whole)) << "stopped after step " << stop;
  }
}

TEST(RunLevelsWhole, HaveTheSameBitsOnAnyNumberOfThreads) {
  if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "a build without p4est";
  std::vector<double> first;
  for (int const n : {1, 2, 4}) {
    set_threads(n);
    World w = setup::build(furnished_case());
    while (w.clock.step < 40) advance(w, 1.0);
    if (first.empty()) first = bits_of(w);
    EXPECT_EQ(bits_of(w), first) << n << " threads";
  }
  set_threads(0);
}

TEST(RunLevelsWhole, KeepWithinTheLimitOnCells) {
  if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "a build without p4est";
  auto const most_cells = [](double limit) {
    Case c = burst_case(Geometry::planar2d, 64, 2);
    c.adaptive.most_cells = limit;
    World w = setup::build(c);
    long most = 0;
    while (w.clock.step < 40) {
      advance(w, 1.0);
      long cells = 0;
      for (grid::Block const& block : w.grid.blocks()) cells += uncovered_count(block);
      most = std::max(most, cells);
    }
    EXPECT_LT(audit_error(w), 1e-12);
    EXPECT_EQ(w.adaptation->held_back(), limit > 0.0);
    return static_cast<double>(most);
  };
  double const free = most_cells(0.0);
  double const limit = 0.5 * free;
  EXPECT_LE(most_cells(limit), limit);
}

/// A steel slab in an MPM region of its own level, in a closed box, beside compressed air.
Case slab_case(int coarse, int levels) {
  Case c = air_case(Geometry::planar2d, {4 * coarse, coarse, 1}, 1.0 / coarse, Boundary::wall);
  c.initial_states.push_back(
      {shape::Cylinder{{0.35, 0.5, 0.0}, 0.15, 1.0, {0.0, 0.0, 1.0}}, {6.0, 20.0 * bar, {0.0, 0.0, 0.0}}, {}, {}});
  c.adaptive.finest = c.adaptive.shocks = c.adaptive.obstacles = c.adaptive.charges = levels;
  c.mpm_regions.emplace_back();
  c.mpm_regions.front().level = levels;
  c.mpm_regions.front().boxes.push_back({{0.75, 0.125, -1.0}, {1.5, 0.875, 1.0}});
  Body body;
  body.name = "slab";
  body.solid = material::elastic_solid(7850.0, 210e9, 0.3);
  body.shape = shape::Box{{1.1, 0.375, -1.0}, {1.15, 0.625, 1.0}};
  c.particles.bodies = {body};
  c.numerics.block_cells = 8;
  return c;
}

double slab_momentum(World const& w) { return mpm::sums(*w.regions.front().particles, 0).momentum[0]; }

TEST(RunLevelsRegion, ASlabFeelsTheShockAsOnUniformCells) {
  if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "a build without p4est";
  World levels = setup::build(slab_case(32, 1));
  World fine = setup::build(slab_case(64, 0));
  double const end = 1.2e-3;
  advance_to(levels, end);
  advance_to(fine, end);
  std::printf("momentum %.6g and %.6g kg m/s, %ld changes, %ld and %ld steps\n", slab_momentum(levels),
              slab_momentum(fine), levels.adaptation->changes(), levels.clock.step, fine.clock.step);
  EXPECT_GT(slab_momentum(fine), 0.0);
  EXPECT_NEAR(slab_momentum(levels) / slab_momentum(fine), 1.0, 0.02);
  levels.update_audit();
  auto const error = levels.audit.relative_error();
  EXPECT_LT(error.mass[0], 1e-12);
}

TEST(RunLevelsRegion, GoesOnFromACheckpoint) {
  if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "a build without p4est";
  for (long const stop : {3L, 30L}) {
    World whole = setup::build(slab_case(32, 1));
    std::string bytes;
    while (whole.clock.step < 40) {
      if (whole.clock.step == stop) bytes = written(whole);
      advance(whole, 1.0);
    }
    World second = setup::build(slab_case(32, 1));
    read(second, bytes);
    while (second.clock.step < 40) advance(second, 1.0);
    EXPECT_EQ(bits_of(second), bits_of(whole)) << "stopped after step " << stop;
    EXPECT_EQ(slab_momentum(second), slab_momentum(whole));
    EXPECT_TRUE(whole.regions.front().bridge->awake());
  }
}

}  // namespace
}  // namespace brisance::run
