#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "../observe/watched.hpp"
#include "../session/small_case.hpp"
#include "app/gauge_text.hpp"
#include "app/plan_text.hpp"
#include "core/error.hpp"
#include "grid/forest.hpp"
#include "grid/grid.hpp"

namespace brisance::app {
namespace {

using namespace session;

TEST(Plan, KnowsTheChargeAsTheWorldWillBuildIt) {
  auto const setup = small_case("[end]\ntime = \"0.2 ms\"\n");
  Plan const p = plan(setup);
  observe::Watched const world{run::Case(setup)};
  ASSERT_EQ(p.charges.size(), 1U);
  EXPECT_EQ(p.blocks, world.grid.block_count());
  EXPECT_EQ(p.charges[0].specified_mass, world.charges[0].specified_mass);
  // Two ways of summing the same cells: round-off.
  EXPECT_NEAR(p.charges[0].realised_mass, world.charges[0].realised_mass, 1e-13);
  EXPECT_NEAR(p.charges[0].realised_energy / world.charges[0].realised_energy, 1.0, 1e-13);
  EXPECT_NEAR(p.charges[0].cells_per_radius / world.charges[0].cells_per_radius, 1.0, 1e-13);
}

TEST(Plan, CountsDumpsAndWarnsOfCoarseCharges) {
  auto setup = small_case("[output]\nfield_interval = \"50 us\"\n[end]\ntime = \"0.2 ms\"\n");
  EXPECT_EQ(plan(setup).dumps, 5);
  EXPECT_TRUE(plan(setup).warnings.empty());
  setup.domain.h = 12.5e-3;  // radius 52.7 mm: 4.2 cells
  setup.domain.cells[0] = 80;
  ASSERT_GE(plan(setup).warnings.size(), 1U);
  EXPECT_NE(plan(setup).warnings[0].find("4.2 cells per radius"), std::string::npos) << plan(setup).warnings[0];
  setup.domain.h = 50e-3;
  setup.domain.cells[0] = 20;
  ASSERT_GE(plan(setup).warnings.size(), 1U);
  EXPECT_NE(plan(setup).warnings[0].find("1.1 cells per radius"), std::string::npos) << plan(setup).warnings[0];
}

TEST(Plan, CountsSubsetsOnTheDisk) {
  std::string const head =
      "[domain]\nsize = [1, 1, 1]\ncell = \"50 mm\"\n[[charge]]\nmass = \"1 kg\"\nposition = [0.5, 0.5, 0.5]\n"
      "[end]\ntime = \"0.2 ms\"\n[output]\nfields = [\"pressure\"]\npeak_fields = false\n";
  std::string const subsets =
      "[[output.subset]]\nname = \"cut\"\nplane = {normal = \"z\", at = 0.5}\ninterval = \"50 us\"\n"
      "fields = [\"velocity\"]\n"
      "[[output.subset]]\nname = \"part\"\nbox = {lower = [0, 0, 0], upper = [0.5, 0.5, 0.1]}\ncell = \"0.1 m\"\n";
  auto const read = [](std::string const& text) { return deck::read_text(text, "deck").case_.value(); };
  Plan const without = plan(read(head));
  auto const setup = read(head + "field_interval = \"0.1 ms\"\n" + subsets);
  Plan const p = plan(setup);
  EXPECT_EQ(p.dumps, 3);
  ASSERT_EQ(p.subsets.size(), 2U);
  EXPECT_EQ(p.subsets[0].dumps, 5);
  // Values in single precision; one corner [m], four numbers of corners, one beginning and one type a square.
  EXPECT_EQ(p.subsets[0].dump_bytes, 400.0 * (3 * 4 + 24 + 4 * 8 + 8 + 1));
  EXPECT_EQ(p.subsets[1].dumps, 3);
  EXPECT_EQ(p.subsets[1].dump_bytes, 5.0 * 5.0 * 1.0 * 4.0);
  EXPECT_DOUBLE_EQ(p.disk_bytes,
                   without.disk_bytes + p.dump_bytes + 5 * p.subsets[0].dump_bytes + 3 * p.subsets[1].dump_bytes);
  Plan const alone = plan(read(head + subsets));
  EXPECT_EQ(alone.dumps, 0);
  EXPECT_EQ(alone.subsets[1].dumps, 2);
  EXPECT_DOUBLE_EQ(alone.disk_bytes,
                   without.disk_bytes - 2 * p.dump_bytes + 5 * p.subsets[0].dump_bytes + 2 * p.subsets[1].dump_bytes);
  std::string const text = plan_text(setup, p);
  for (char const* part : {"cut: plane z = 0.5 m, 5 dumps of 30.8 kB each before compression: velocity",
                           "part: box 0 to 0.5, 0 to 0.5, 0 to 0.1 m, 3 dumps of 100 B each", "subsets 154 kB, "})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_NE(plan_text(setup, alone).find("none of the whole domain"), std::string::npos);
  EXPECT_EQ(plan_json(setup, p)["subsets"][1]["dump_bytes"], 100.0);
}

TEST(Plan, RefusesWhatDoesNotFitIntoTheMachine) {
  Plan p = plan(small_case("[end]\ntime = \"0.2 ms\"\n"));
  EXPECT_NO_THROW(refuse_unless_it_fits(p));
  p.memory_bytes = 2.0 * p.machine_memory_bytes;
  EXPECT_THROW(refuse_unless_it_fits(p), InputError);
}

TEST(Plan, MemoryGrowsWithCellsTimesValues) {
  auto setup = small_case("[end]\ntime = \"0.2 ms\"\n");
  Plan const before = plan(setup);
  setup.domain.cells[0] += 1'000'000;
  Plan const after = plan(setup);
  // Of a dump the specified fields, and two peak fields in the last one, in single precision.
  double const dump = after.last_dump_bytes - before.last_dump_bytes;
  EXPECT_EQ(dump - (after.dump_bytes - before.dump_bytes), 2 * 4e6);
  // 8 components, 3 peak values and the last dump per cell, and the ghost layers of a thousand blocks.
  EXPECT_NEAR(after.memory_bytes - before.memory_bytes, 8.0 * 11e6 + dump, 2e6);
}

TEST(Plan, TellsTheCellsOfEachLevel) {
  if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  auto const result = deck::read_text(
      "[domain]\ngeometry = \"planar2d\"\nsize = [2.048, 2.048]\ncell = \"64 mm\"\n[end]\ntime = \"1 ms\"\n"
      "[[charge]]\nradius = 0.1\nposition = [1, 1]\n[adaptive]\nfinest = \"32 mm\"\n",
      "d");
  ASSERT_TRUE(result.case_);
  Plan const p = plan(*result.case_);
  std::string const text = plan_text(*result.case_, p);
  // The charge is in the middle of four blocks of 16 x 16 cells, and of the domain: a quarter of each is finer.
  EXPECT_NE(text.find("cells        level 0: 768 of 64 mm, level 1: 1024 of 32 mm (at the start, in 8 blocks)\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("of the coarsest cells, each finer level twice as many"), std::string::npos) << text;
  nlohmann::json const json = plan_json(*result.case_, p);
  ASSERT_EQ(json["levels"].size(), 2U);
  EXPECT_EQ(json["levels"][1]["cells_at_start"], 1024.0);
  EXPECT_EQ(json["levels"][1]["cell_size"], 0.032);
  EXPECT_TRUE(
      plan_json(small_case("[end]\ntime = 1e-3\n"), plan(small_case("[end]\ntime = 1e-3\n")))["levels"].empty());
}

TEST(Plan, EstimatesTheStepsWithinAFactorOfTwo) {
  auto const setup = small_case("[end]\ntime = \"0.4 ms\"\n");
  double const estimate = plan(setup).steps;
  observe::Watched world{run::Case(setup)};
  while (!world.finished()) run::advance(world, setup.end.time);
  auto const steps = static_cast<double>(world.clock.step);
  EXPECT_GT(estimate, 0.5 * steps);
  EXPECT_LT(estimate, 2.0 * steps);
}

TEST(Plan, TellsWhatIsAskedAndWhatIsPlaced) {
  auto const read = [](std::string const& text) {
    auto const result = deck::read_text(
        "[domain]\ngeometry = \"planar2d\"\nsize = [1, 1]\ncell = 0.05\n[end]\ntime = 1e-3\n" + text, "placed.toml");
    for (auto const& error : result.errors) ADD_FAILURE() << deck::format(error);
    return result.case_.value();
  };
  auto const setup = read(
      "[[charge]]\nmass = 2\nposition = [0.5, 0.5]\n"
      "[[initial_state]]\nshape = \"cylinder\"\nradius = 0.3\nposition = [0.5, 0.5]\npressure = \"3 bar\"\ndensity = "
      "2\n"
      "[[obstacle]]\nname = \"slab\"\nshape = \"box\"\nlower = [0, 0]\nupper = [1, 0.13]\n");
  Plan const p = plan(setup);
  auto const json = plan_json(setup, p);
  double const charge = 2.0 / setup.charges[0].explosive.density();
  double const disc = 0.09 * std::numbers::pi;
  auto const& region = json["initial_states"][0];
  EXPECT_NEAR(region["specified_volume"].get<double>(), disc, 1e-12);
  EXPECT_NEAR(region["volume"].get<double>(), disc - charge, 1e-12);
  EXPECT_NEAR(region["specified_mass"].get<double>(), 2.0 * disc, 1e-12);
  EXPECT_NEAR(region["mass"].get<double>(), 2.0 * (disc - charge), 1e-12);
  EXPECT_NEAR(region["energy"].get<double>(), 3e5 / 0.4 * (disc - charge), 1e-6);
  auto const& obstacle = json["placed_obstacles"][0];
  EXPECT_EQ(obstacle["name"], "slab");
  EXPECT_NEAR(obstacle["specified_volume"].get<double>(), 0.13, 1e-12);
  EXPECT_NEAR(obstacle["volume"].get<double>(), 0.13, 1e-12);
  EXPECT_EQ(obstacle["cells"], 40);
  EXPECT_NEAR(json["charges"][0]["specified_volume"].get<double>(), charge, 1e-15);
  EXPECT_NEAR(json["charges"][0]["realised_volume"].get<double>() / charge, 1.0, 1e-12);
  std::string const text = plan_text(setup, p);
  EXPECT_NE(text.find("slab: volume specified 0.13 m3, placed 0.13 in 40 cells"), std::string::npos) << text;
  EXPECT_NE(text.find("1: air, volume specified 0.282743 m3, placed 0.281516"), std::string::npos) << text;
  // The world does what the plan says.
  observe::Watched const world{run::Case(setup)};
  EXPECT_NEAR(world.initial_states[0].volume, p.initial_states[0].volume, 1e-14);
  EXPECT_EQ(world.obstacles[0].cells, p.obstacles[0].cells);
  // What is too coarse is said.
  auto const coarse = read(
      "[numerics]\nobstacles = \"stairs\"\n[[obstacle]]\nname = \"bar\"\nshape = \"box\"\nlower = [0.2, 0.2]\nupper = "
      "[0.23, 0.6]\n"
      "[[initial_state]]\nshape = \"cylinder\"\nradius = 0.02\nposition = [0.7, 0.7]\npressure = \"3 bar\"\n");
  std::string warnings;
  for (auto const& w : plan(coarse).warnings) warnings += w;
  EXPECT_NE(warnings.find("obstacle \"bar\" is 67 % larger on the grid"), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("initial state 1 is only 0.8 cells thick"), std::string::npos) << warnings;
}

TEST(Plan, WarnsOfLoadsThatAreShorterThanSteps) {
  auto const warnings = [](std::string const& duration) {
    auto const result = deck::read_text(
        "[domain]\ngeometry = \"planar1d\"\nsize = 1\ncell = 0.01\n[end]\ntime = 1e-3\n[[body]]\nname = "
        "\"bar\"\nmaterial = "
        "\"RHA\"\nlower = 0.2\nupper = 0.8\n[[surface_pressure]]\nnormal = \"-x\"\npressure = 1e6\nduration = \"" +
            duration + "\"\n",
        "load.toml");
    for (auto const& error : result.errors) ADD_FAILURE() << deck::format(error);
    std::string all;
    for (auto const& w : plan(result.case_.value()).warnings) all += w;
    return all;
  };
  // A step takes 0.4 h/c, about 0.7 us.
  EXPECT_EQ(warnings("10 us"), "");
  EXPECT_NE(warnings("1 us").find("surface pressure 1 acts for 1 us"), std::string::npos) << warnings("1 us");
}

TEST(Plan, TellsWhatTheMemoryIsFor) {
  auto setup = small_case("[end]\ntime = \"0.2 ms\"\n");
  setup.domain.cells[0] = 10'000'000;
  Plan const p = plan(setup);
  double sum = 0.0;
  for (auto const& part : p.memory) sum += part.bytes;
  EXPECT_NEAR(sum / p.memory_bytes, 1.0, 1e-12);
  EXPECT_EQ(p.memory[0].what, "state of the gas, 8 values per cell");
  EXPECT_EQ(p.memory[0].bytes, 8.0 * 8.0 * 1e7);
  EXPECT_NE(plan_text(setup, p).find("state of the gas, 8 values per cell 640 MB; "), std::string::npos)
      << plan_text(setup, p);
}

TEST(Plan, TellsTimeAndDisk) {
  auto setup = small_case("[output]\nfield_interval = \"50 us\"\n[end]\ntime = \"0.2 ms\"\n");
  setup.domain.cells[0] = 300;  // one block: one thread
  Plan p = plan(setup);
  // One of three sweeps at 18 million cells a second, docs/benchmarks.md.
  EXPECT_NEAR(p.seconds * 18e6 / (p.steps * 300.0 / 3.0), 1.0, 1e-12);
  EXPECT_EQ(p.disk_bytes, 4.0 * p.dump_bytes + p.last_dump_bytes + p.gauge_bytes + 3.0 * p.checkpoint_bytes);
  std::string const text = plan_text(setup, p);
  for (char const* part : {"up to about", "(estimate from the rates in docs/benchmarks.md", "5 dumps of"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  auto const json = plan_json(setup, p);
  EXPECT_EQ(json["estimated_seconds"], p.seconds);
  EXPECT_EQ(json["disk_bytes"], p.disk_bytes);
  setup.charges.clear();
  setup.other_fluids.clear();
  EXPECT_NEAR(plan(setup).seconds * 22e6 / (plan(setup).steps * 300.0 / 3.0), 1.0, 1e-12);
}

// 2e9 cells, in any form: answered by arithmetic.
TEST(Plan, OfACaseThatNoMachineHoldsTakesNoTime) {
  auto const begin = std::chrono::steady_clock::now();
  auto setup = small_case("[end]\ntime = \"0.2 ms\"\n");
  setup.domain.cells = {2'000'000'000, 1, 1};
  EXPECT_GT(plan(setup).memory_bytes, 2e9 * 88.0);
  setup.domain.geometry = grid::Geometry::cartesian3d;
  setup.domain.cells = {1250, 1250, 1250};
  setup.domain.h = 1.0;
  setup.charges[0].shape = shape::Sphere{{600.0, 600.0, 600.0}, 500.0};
  setup.charges[0].mass = 1630.0 * 4.0 / 3.0 * M_PI * 1.25e8;
  setup.gauges[0].position = {1200.0, 600.0, 600.0};
  for (int const block_cells : {0, 4}) {
    setup.numerics.block_cells = block_cells;
    Plan const p = plan(setup);
    EXPECT_NEAR(p.charges[0].cells_per_radius, 500.0, 1e-6);
    EXPECT_GT(p.memory_bytes, 1.9e9 * 88.0);
    EXPECT_FALSE(plan_text(setup, p).empty());
    if (p.memory_bytes > p.machine_memory_bytes) {
      EXPECT_THROW(refuse_unless_it_fits(p), InputError);
    }
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));  // 6 minutes before
}

TEST(Plan, CountsTheGhostLayersOfUnequalBlocks) {
  auto setup = small_case("[end]\ntime = \"0.2 ms\"\n");
  setup.charges.clear();
  setup.other_fluids.clear();
  setup.domain.geometry = grid::Geometry::cartesian3d;
  setup.domain.cells = {33, 70, 50};
  grid::Grid const grid(setup.domain);
  double ghosts = 0.0;
  for (auto const& block : grid.blocks()) {
    int face = 0;
    for (int d = 0; d < 3; ++d) face = std::max(face, block.cell_count() / block.n[d]);
    ghosts += 2.0 * grid::ghost_layers * face;
  }
  Plan const p = plan(setup);
  EXPECT_EQ(p.blocks, grid.block_count());
  auto const part = std::ranges::find(p.memory, "ghost layers of the blocks", &MemoryPart::what);
  ASSERT_NE(part, p.memory.end());
  EXPECT_NEAR(part->bytes / (ghosts * 6.0 * 8.0), 1.0, 1e-12);
}

TEST(Plan, TextAndJsonTellTheSame) {
  auto const setup = small_case("[end]\ntime = \"0.2 ms\"\n");
  Plan const p = plan(setup);
  auto const json = plan_json(setup, p);
  EXPECT_EQ(json["cell_count"], 200);
  EXPECT_EQ(json["boundaries"]["x_high"], "outflow");
  EXPECT_EQ(json["charges"][0]["explosive"], "TNT");
  std::string const text = plan_text(setup, p);
  for (char const* part : {"200 = 200 of 5 mm", "x_high outflow", "mass specified 1 kg, realised 1 kg",
                           "TNT (explosive): ", "air (ambient fluid): "}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

TEST(Gauges, CheckSaysWhatTheCellsWillClipOfTheirPeaks) {
  auto setup = small_case("[end]\ntime = \"0.2 ms\"\n");  // 0.8 m from 1 kg, cells of 5 mm
  Plan const fine = plan(setup);
  ASSERT_EQ(fine.gauges.size(), 1U);
  ASSERT_TRUE(fine.gauges[0].peak);
  auto const row = plan_json(setup, fine)["gauge_peaks"][0];
  EXPECT_EQ(row["name"], "g");
  EXPECT_GT(row["expected_clipping"].get<double>(), 0.04);
  EXPECT_LT(row["expected_clipping"].get<double>(), 0.10);
  EXPECT_EQ(row["reflected"], false);
  EXPECT_NE(plan_text(setup, fine).find("cells in the half width of the peak; the recorded peak will be about"),
            std::string::npos);
  // Four times as coarse: a warning with the cell that would clip it by 5 %.
  setup.domain.h = 20e-3;
  setup.domain.cells[0] = 50;
  Plan const coarse = plan(setup);
  EXPECT_NEAR(coarse.gauges[0].peak->cells_per_half_width, 0.25 * fine.gauges[0].peak->cells_per_half_width, 1e-6);
  auto const warning = clipping_warning(coarse.gauges, setup.domain.h);
  ASSERT_TRUE(warning);
  EXPECT_NE(warning->find("at \"g\" by about"), std::string::npos) << *warning;
  EXPECT_NE(std::ranges::find(coarse.warnings, *warning), coarse.warnings.end());
  EXPECT_FALSE(clipping_warning(fine.gauges, 5e-3));
  // Where the curves do not tell, nothing is said.
  setup.ambient.fluid.eos = material::StiffenedGas{};
  EXPECT_TRUE(plan_json(setup, plan(setup))["gauge_peaks"][0]["expected_clipping"].is_null());
}

TEST(Gauges, TablesShowTheWholeRecordAndDashesWhereNothingArrived) {
  auto setup = small_case("[end]\ntime = \"0.9 ms\"\n");
  setup.gauges.push_back({"far", {0.99, 0.0, 0.0}});
  observe::Watched world{std::move(setup)};
  world.sample_gauges();
  std::string const before = gauge_tables(world.setup, world.gauges.gas);
  EXPECT_NE(before.find("\ng "), std::string::npos) << before;
  EXPECT_EQ(before.find("Pa"), std::string::npos) << before;  // dashes only
  while (!world.finished()) {
    run::advance(world, world.setup.end.time);
    world.sample_gauges();
  }
  std::string const after = gauge_tables(world.setup, world.gauges.gas);
  for (char const* words : {"clipped", "peak at front", "max. impulse", "mean at end", "negative peak", "\nfar "})
    EXPECT_NE(after.find(words), std::string::npos) << words << after;
  EXPECT_NE(after.find("Pa s"), std::string::npos);
}

}  // namespace
}  // namespace brisance::app
