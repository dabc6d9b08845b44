// What `check` says of cells of several sizes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../observe/watched.hpp"
#include "core/error.hpp"
#include "deck/deck.hpp"
#include "grid/forest.hpp"
#include "session/level_estimates.hpp"
#include "session/plan.hpp"

namespace brisance::session {
namespace {

run::Case case_of(std::string const& more) {
  auto const result = deck::read_text(
      "[domain]\ngeometry = \"planar2d\"\nsize = [4.096, 4.096]\ncell = \"64 mm\"\n[end]\ntime = \"1 ms\"\n" + more,
      "d");
  for (auto const& error : result.errors) ADD_FAILURE() << deck::format(error);
  return result.case_.value();
}

std::string const charge = "[[charge]]\nradius = 0.1\nposition = [2, 2]\n";

class PlanLevels : public testing::Test {
 protected:
  void SetUp() override {
    if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  }
};

double sum(Plan const& p, double LevelPlan::*member) {
  double all = 0.0;
  for (LevelPlan const& level : p.levels) all += level.*member;
  return all;
}

/// Cells of level 0 that all cells together are as large as.
double as_coarse(Plan const& p, double LevelPlan::*member) {
  double all = 0.0;
  for (std::size_t l = 0; l < p.levels.size(); ++l)
    all += p.levels[l].*member * std::ldexp(1.0, -2 * static_cast<int>(l));
  return all;
}

TEST_F(PlanLevels, TheStartIsThatOfTheWorld) {
  auto const setup = case_of(
      charge +
      "[adaptive]\nfinest = \"8 mm\"\n[[refine]]\nshape = \"box\"\nlower = [0, 0]\nupper = [1, 0.3]\nlevel = 1\n");
  Plan const p = plan(setup);
  observe::Watched const world{run::Case(setup)};
  ASSERT_EQ(p.levels.size(), 4U);
  std::vector<double> cells(4, 0.0);
  int blocks = 0;
  for (grid::Block const& block : world.grid.blocks()) {
    if (block.covered) continue;
    cells[static_cast<std::size_t>(block.level)] += uncovered_count(block);
    ++blocks;
  }
  for (std::size_t l = 0; l < 4; ++l) {
    EXPECT_EQ(p.levels[l].start, cells[l]) << l;
    EXPECT_EQ(p.levels[l].cell, 0.064 / (1 << l));
  }
  EXPECT_EQ(p.blocks, blocks);
  ASSERT_EQ(p.charges.size(), 1U);
  // Two ways of summing the same cells: round-off.
  EXPECT_NEAR(p.charges[0].realised_mass / world.charges[0].realised_mass, 1.0, 1e-12);
  EXPECT_NEAR(p.charges[0].cells_per_radius, 12.5, 1e-9);
}

TEST_F(PlanLevels, CellsOfAllLevelsFillTheDomain) {
  for (auto const* more : {"", "cells = 20000\n"}) {
    Plan const p = plan(case_of(charge + "[adaptive]\nfinest = \"8 mm\"\n" + more));
    EXPECT_NEAR(as_coarse(p, &LevelPlan::start), 4096.0, 1e-9);
    EXPECT_GT(sum(p, &LevelPlan::most), sum(p, &LevelPlan::mean));
    if (std::string(more).empty()) {
      EXPECT_NEAR(as_coarse(p, &LevelPlan::mean), 4096.0, 1e-6);
    } else {
      EXPECT_LE(sum(p, &LevelPlan::most), 20000.0 + 1e-6);
    }
  }
}

// Cells of level l take 2^l steps in one of the coarsest.
TEST_F(PlanLevels, UpdatesCountTheStepsOfEachLevel) {
  Plan const p = plan(case_of(charge + "[adaptive]\nfinest = \"8 mm\"\n"));
  double updates = 0.0;
  for (std::size_t l = 0; l < p.levels.size(); ++l)
    updates += p.levels[l].mean * std::ldexp(p.steps, static_cast<int>(l));
  EXPECT_NEAR(p.cell_updates / updates, 1.0, 1e-12);
  Plan const uniform = plan(case_of(charge));
  EXPECT_EQ(uniform.cell_updates, uniform.cells * uniform.steps);
  EXPECT_TRUE(uniform.levels.empty());
  EXPECT_EQ(uniform.steps, p.steps);
}

// Two subsets of known shares of the domain.
TEST_F(PlanLevels, SubsetsCountOnTheCellsOfTheirLevels) {
  auto setup = case_of(charge + "[adaptive]\nfinest = \"8 mm\"\n");
  setup.output.fields = {"pressure"};
  grid::Domain const& domain = setup.domain;
  shape::Box whole{domain.lower, domain.lower};
  for (int d = 0; d < domain.dimensions(); ++d) whole.upper[d] = domain.upper(d);
  run::FieldSubset all;
  all.name = "all";
  all.place = whole;
  all.fields = {"pressure"};
  run::FieldSubset coarse = all;
  coarse.name = "coarse";
  coarse.level = 0;
  setup.output.subsets = {all, coarse};
  Plan const p = plan(setup);
  ASSERT_EQ(p.subsets.size(), 2U);
  EXPECT_NEAR(p.subsets[0].dump_bytes / (4.0 * sum(p, &LevelPlan::most)), 1.0, 1e-12);
  // As many of the coarsest cells as fill the domain.
  EXPECT_NEAR(p.subsets[1].dump_bytes / (4.0 * as_coarse(p, &LevelPlan::most)), 1.0, 1e-12);
}

TEST_F(PlanLevels, WhatIsAtRestKeepsItsCells) {
  Plan const p = plan(case_of(
      "[adaptive]\nfinest = \"8 mm\"\n[[refine]]\nshape = \"box\"\nlower = [0, 0]\nupper = [1, 1]\nlevel = 2\n"));
  for (LevelPlan const& level : p.levels) {
    EXPECT_NEAR(level.mean, level.start, 1e-6);
    EXPECT_NEAR(level.most, level.start, 1e-6);
  }
}

// A strong cylindrical explosion has r^2/2 = t/2 (E/rho)^(1/2), after it has left the charge at the speed of
// detonation. The layer of 4 blocks of 16 cells that its front keeps tells its length.
TEST_F(PlanLevels, AFrontIsAsLongAsItsCircle) {
  run::Case setup = case_of(charge + "[adaptive]\nfinest = \"8 mm\"\ncharges = \"64 mm\"\n");
  setup.end.time = 0.25e-3;
  auto const& explosive = setup.charges[0].explosive;
  double const half =
      0.5 * std::sqrt(setup.charges[0].mass * explosive.specific_energy() / setup.ambient.state.density);
  double const D = explosive.detonation_speed;
  double const slow = half / D;  // radius at which it becomes slower than the detonation
  auto const radius_at = [&](double t) {
    return t < slow / D ? D * t : std::sqrt(slow * slow + 2.0 * half * (t - slow / D));
  };
  double const r = radius_at(setup.end.time);
  ASSERT_GT(r, slow);
  ASSERT_LT(r, 1.9);
  double const lengths = 2.0 * std::numbers::pi * (r + radius_at(setup.end.time / 2.5));
  double const square = 0.1;  // that is looked at in the place of the charge
  Plan const p = plan(setup);
  double const domain = 4.096 * 4.096;
  double const fraction = p.levels[3].most * 0.008 * 0.008 / domain;
  double const length = -std::log(1.0 - fraction) * domain / (5.0 * 16.0 * 0.008);
  // In the last of 50 intervals; 20000 places of which the interval has a few hundred.
  EXPECT_NEAR(length / (lengths + 2.0 * 8.0 * square), 1.0, 0.05);
}

// Against simulations: cells on average and at most. All shocks have left the domain at the end of the second one.
TEST_F(PlanLevels, EstimatesTheCellsWithinAFactorOfTwo) {
  for (auto const* radius : {"0.03", "0.1"}) {
    run::Case setup = case_of(std::string("[[charge]]\nradius = ") + radius +
                              "\nposition = [2, 2]\n[adaptive]\nfinest = \"16 mm\"\n");
    setup.end.time = 1.5e-3;
    Plan const p = plan(setup);
    observe::Watched world{run::Case(setup)};
    double mean = 0.0;
    double most = 0.0;
    while (!world.finished()) {
      double cells = 0.0;
      for (grid::Block const& block : world.grid.blocks()) cells += uncovered_count(block);
      run::advance(world, setup.end.time);
      mean += cells * world.clock.dt / setup.end.time;
      most = std::max(most, cells);
    }
    double const expected = sum(p, &LevelPlan::mean);
    EXPECT_LT(std::abs(std::log2(expected / mean)), 1.0) << expected << " and " << mean;
    EXPECT_LT(std::abs(std::log2(p.cells / most)), 1.0) << p.cells << " and " << most;
  }
}

TEST_F(PlanLevels, TooFewCellsAllowedIsAnError) {
  EXPECT_THROW((void)plan(case_of(charge + "[adaptive]\nfinest = \"8 mm\"\ncells = 5000\n")), InputError);
}

TEST_F(PlanLevels, ChargesFinerThanTheSurfaceBesideThemAreAnError) {
  std::string const deck = charge +
                           "[[obstacle]]\nshape = \"cylinder\"\nposition = [2.3, 2]\nradius = 0.15\n"
                           "[adaptive]\nfinest = \"8 mm\"\nshocks = \"16 mm\"\n";
  EXPECT_THROW((void)plan(case_of(deck)), InputError);
  EXPECT_NO_THROW((void)plan(case_of(deck + "obstacles = \"8 mm\"\n")));
}

// 4096^2 blocks on a level: nothing of that size is made.
TEST_F(PlanLevels, HugeCasesAreEstimatedInNoTime) {
  auto const result = deck::read_text(
      "[domain]\nsize = [1024, 1024, 1024]\ncell = 1\n[end]\ntime = \"1 ms\"\n[[charge]]\nmass = \"1000 kg\"\nposition "
      "= "
      "[500, 500, 500]\n[adaptive]\nfinest = 0.015625\nshocks = 0.5\n[[refine]]\nshape = \"box\"\nlower = [0, 0, 0]\n"
      "upper = [1000, 1000, 1000]\ncell = 0.0625\n",
      "d");
  ASSERT_TRUE(result.case_) << deck::format(result.errors.front());
  Plan const p = plan(*result.case_);
  EXPECT_GT(p.memory_bytes, 1e12);
  EXPECT_FALSE(p.warnings.empty());
}

TEST_F(PlanLevels, BodiesCountOnTheCellsOfTheirRegion) {
  std::string const plate = "[[body]]\nmaterial = \"RHA\"\nshape = \"box\"\nlower = [3, 1.8]\nupper = [3.032, 2.2]\n";
  Plan const p = plan(case_of(charge + plate + "[adaptive]\nfinest = \"8 mm\"\n"));
  ASSERT_EQ(p.regions.size(), 1U);
  // 4 x 50 cells with 2 x 2 particles in each.
  ASSERT_EQ(p.bodies.size(), 1U);
  EXPECT_EQ(p.bodies[0].particles, 800);
  EXPECT_LT(p.regions.front().upper[0] - p.regions.front().lower[0], 0.5);
}

}  // namespace
}  // namespace brisance::session
