#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/driver.hpp"
#include "gas/components.hpp"
#include "output/checkpoint.hpp"
#include "small_case.hpp"

namespace brisance::app {
namespace {

std::atomic<bool> const go_on{false};
void ignore(run::World const& /*world*/) {}

nlohmann::json log_of(Scratch const& scratch) {
  return nlohmann::json::parse(std::ifstream(scratch.path() / "run.json"));
}

TEST(Drive, WritesEveryDumpAtItsTimeAndReachesTheEnd) {
  Scratch const scratch;
  run::World world(small_case("[output]\nfield_interval = \"50 us\"\n[end]\ntime = \"0.2 ms\"\n"));
  output::Writer writer(world, scratch.path());
  long steps = 0;
  auto const ending = drive(world, writer, go_on, [&](run::World const& w) {
    ++steps;
    EXPECT_EQ(w.clock.step, steps);
  });
  EXPECT_EQ(ending.code, ExitCode::done);
  EXPECT_EQ(ending.reason, "reached the end time 200 us");
  EXPECT_EQ(world.clock.time, 2e-4);
  EXPECT_EQ(writer.dump_count(), 5);
  // One record per step and the initial one.
  EXPECT_EQ(world.gauges[0].records.size(), static_cast<std::size_t>(steps) + 1);
  EXPECT_EQ(log_of(scratch)["status"], "done");
}

TEST(Drive, GaugeIntervalThinsTheRecordsButKeepsTheLast) {
  Scratch const scratch;
  run::World world(small_case("[output]\ngauge_interval = \"20 us\"\n[end]\ntime = \"0.19 ms\"\n"));
  output::Writer writer(world, scratch.path());
  EXPECT_EQ(drive(world, writer, go_on, ignore).code, ExitCode::done);
  auto const& records = world.gauges[0].records;
  ASSERT_EQ(records.size(), 11U);  // 0, 20, ..., 180 us and the end
  EXPECT_EQ(records.back().time, 1.9e-4);
  for (std::size_t n = 0; n + 1 < records.size(); ++n) {
    EXPECT_GE(records[n].time, 2e-5 * static_cast<double>(n));
    EXPECT_LT(records[n].time, 2e-5 * static_cast<double>(n + 1));
  }
}

TEST(Drive, StopsAtTheStepLimit) {
  Scratch const scratch;
  run::World world(small_case("[end]\ntime = \"0.2 ms\"\nsteps = 7\n"));
  output::Writer writer(world, scratch.path());
  auto const ending = drive(world, writer, go_on, ignore);
  EXPECT_EQ(ending.code, ExitCode::done);
  EXPECT_EQ(world.clock.step, 7);
  EXPECT_NE(ending.reason.find("step limit end.steps = 7"), std::string::npos) << ending.reason;
}

TEST(Drive, StopsWhenAskedAndWritesWhatThereIs) {
  Scratch const scratch;
  run::World world(small_case("[end]\ntime = \"0.2 ms\"\n"));
  output::Writer writer(world, scratch.path());
  std::atomic<bool> stop{false};
  auto const ending = drive(world, writer, stop, [&](run::World const& w) { stop = w.clock.step == 5; });
  EXPECT_EQ(ending.code, ExitCode::stopped_by_user);
  EXPECT_NE(ending.reason.find("step 5"), std::string::npos) << ending.reason;
  EXPECT_EQ(writer.dump_count(), 2);
  EXPECT_EQ(world.gauges[0].records.size(), 6U);
  EXPECT_EQ(log_of(scratch)["status"], "stopped");
  EXPECT_EQ(log_of(scratch)["exit_code"], 3);
}

TEST(Drive, ANumericalFailureLeavesTheResultsUntilThen) {
  Scratch const scratch;
  run::World world(small_case("[end]\ntime = \"0.2 ms\"\n"));
  output::Writer writer(world, scratch.path());
  auto const ending = drive(world, writer, go_on, [&](run::World const& w) {
    if (w.clock.step == 4) world.gas->fields().at(0, gas::energy)[3] = std::numeric_limits<double>::quiet_NaN();
  });
  EXPECT_EQ(ending.code, ExitCode::numerical_failure);
  EXPECT_NE(ending.reason.find("step 4"), std::string::npos) << ending.reason;
  EXPECT_EQ(world.gauges[0].records.size(), 5U);
  EXPECT_EQ(writer.dump_count(), 2);
  EXPECT_EQ(log_of(scratch)["exit_code"], 4);
}

/// Steps of the checkpoints in the folder.
std::vector<long> checkpoints_of(Scratch const& scratch) {
  std::vector<long> steps;
  if (!std::filesystem::exists(scratch.path() / "checkpoints")) return steps;
  for (auto const& entry : std::filesystem::directory_iterator(scratch.path() / "checkpoints")) {
    if (entry.path().filename() == "stopped.brz") continue;
    steps.push_back(output::CheckpointReader(entry.path()).info().step);
  }
  std::sort(steps.begin(), steps.end());
  return steps;
}

std::vector<long> checkpoints_after(std::string const& table, std::atomic<bool>& stop, long stop_at = -1) {
  Scratch const scratch;
  run::World world(small_case("[end]\ntime = \"1 s\"\nsteps = 50\n[checkpoint]\nkeep = 1000\n" + table));
  output::Writer writer(world, scratch.path());
  (void)drive(world, writer, stop, [&](run::World const& w) {
    if (w.clock.step == stop_at) stop = true;
  });
  return checkpoints_of(scratch);
}

TEST(Drive, WritesCheckpointsWhenTheDeckAsksForThem) {
  std::atomic<bool> stop{false};
  EXPECT_EQ(checkpoints_after("", stop), (std::vector<long>{50}));
  EXPECT_EQ(checkpoints_after("at_end = false\n", stop), (std::vector<long>{}));
  EXPECT_EQ(checkpoints_after("steps = 20\n", stop), (std::vector<long>{20, 40, 50}));
  EXPECT_EQ(checkpoints_after("steps = 25\n", stop), (std::vector<long>{25, 50})) << "the last one is written once";
  // The clock asks at once; then it waits twenty times as long as the writing took.
  EXPECT_GE(checkpoints_after("wall_clock = 1e-9\n", stop).size(), 2U);
  EXPECT_EQ(checkpoints_after("", stop, 30), (std::vector<long>{30}));
  stop = false;
  EXPECT_EQ(checkpoints_after("on_signal = false\n", stop, 30), (std::vector<long>{}));
}

TEST(Drive, WritesCheckpointsByTheSimulatedTime) {
  Scratch const scratch;
  run::World world(small_case("[end]\ntime = \"0.2 ms\"\n[checkpoint]\nkeep = 100\ninterval = \"30 us\"\n"));
  output::Writer writer(world, scratch.path());
  (void)drive(world, writer, go_on, ignore);
  EXPECT_EQ(checkpoints_of(scratch).size(), 7U) << "six multiples and the end";
}

TEST(Drive, CheckpointsDoNotChangeTheResults) {
  std::vector<double> times[2];
  for (int with = 0; with < 2; ++with) {
    Scratch const scratch;
    run::World world(small_case(std::string("[end]\ntime = \"0.1 ms\"\n[checkpoint]\n") +
                                (with != 0 ? "interval = \"1 us\"\n" : "wall_clock = 0\nat_end = false\n")));
    output::Writer writer(world, scratch.path());
    (void)drive(world, writer, go_on, ignore);
    for (auto const& record : world.gauges[0].records) times[with].push_back(record.time);
  }
  EXPECT_EQ(times[0], times[1]);
}

// The state of a step that failed is no state to go on from.
TEST(Drive, ANumericalFailureLeavesTheCheckpointsAndAFileOfItsOwn) {
  Scratch const scratch;
  run::World world(small_case("[end]\ntime = \"0.2 ms\"\n[checkpoint]\nsteps = 3\n"));
  output::Writer writer(world, scratch.path());
  auto const ending = drive(world, writer, go_on, [&](run::World const& w) {
    if (w.clock.step == 7) world.gas->fields().at(0, gas::energy)[3] = std::numeric_limits<double>::quiet_NaN();
  });
  EXPECT_EQ(ending.code, ExitCode::numerical_failure);
  EXPECT_EQ(checkpoints_of(scratch), (std::vector<long>{3, 6}));
  output::CheckpointReader stopped(scratch.path() / "checkpoints/stopped.brz");
  EXPECT_EQ(stopped.info().step, 7);
  run::World failed(small_case("[end]\ntime = \"0.2 ms\"\n"));
  EXPECT_NO_THROW(failed.archive(stopped.archive()));
  EXPECT_TRUE(std::isnan(failed.gas->fields().at(0, gas::energy)[3]));
}

/// A run whose floor of the pressure lies that far above the ambient one: the guards lift every cell that is awake, and
/// add 4 % of the charge's energy where that is 20 kPa.
run::Case guarded(double floor, std::string const& more) {
  run::Case setup = small_case(more + "[end]\ntime = \"20 us\"\n[checkpoint]\nsteps = 5\nkeep = 100\n");
  setup.numerics.pressure_floor = floor;
  setup.charges[0].detonation = run::Detonation::instantaneous;  // a cell that has not burnt takes far more
  return setup;
}

TEST(Drive, GuardsThatAddTooMuchStopTheRunAtThatStep) {
  Scratch const scratch;
  run::World world(guarded(1.2e5, ""));
  output::Writer writer(world, scratch.path());
  double within = 0.0;
  auto const ending = drive(world, writer, go_on, [&](run::World const& w) { within = w.audit.guard_energy; });
  EXPECT_EQ(ending.code, ExitCode::numerical_failure);
  EXPECT_NE(ending.reason.find("guards added"), std::string::npos) << ending.reason;
  double const charge = world.charges[0].realised_energy;
  EXPECT_LE(within, 0.01 * charge) << "until the step before";
  EXPECT_GT(world.audit.guard_energy, 0.01 * charge);
  output::CheckpointReader const stopped(scratch.path() / "checkpoints/stopped.brz");
  EXPECT_EQ(stopped.info().step, world.clock.step);
  auto const kept = checkpoints_of(scratch);
  EXPECT_TRUE(kept.empty() || kept.back() < world.clock.step) << "none of the state that was refused";
  auto const log = log_of(scratch);
  EXPECT_EQ(log["exit_code"], 4);
  EXPECT_EQ(log["status"], "stopped");
  EXPECT_EQ(log["audit"]["balanced"], false);
}

TEST(Drive, GuardsThatAddLessAreTold) {
  Scratch const scratch;
  run::Case setup = guarded(1.019e5, "");
  setup.end.steps = 5;  // before the gas expands below the floor
  run::World world(std::move(setup));
  output::Writer writer(world, scratch.path());
  EXPECT_EQ(drive(world, writer, go_on, ignore).code, ExitCode::done);
  double const part = world.audit.guard_energy / world.charges[0].realised_energy;
  EXPECT_GT(part, 1e-4);
  EXPECT_LT(part, 1e-2);
  EXPECT_FALSE(world.verdict().balanced);
  EXPECT_EQ(log_of(scratch)["audit"]["balanced"], false);
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "checkpoints/stopped.brz"));
}

TEST(Drive, WhatIsThereForComparisonAndWhatTheDeckLetsGoRunsOn) {
  for (char const* more : {"[numerics]\nscheme = \"lax-wendroff\"\n", "[audit]\nfail = 0\n"}) {
    Scratch const scratch;
    run::World world(guarded(1.2e5, more));
    output::Writer writer(world, scratch.path());
    EXPECT_EQ(drive(world, writer, go_on, ignore).code, ExitCode::done) << more;
    EXPECT_GT(world.audit.guard_energy, 0.01 * world.charges[0].realised_energy) << more;
    EXPECT_FALSE(world.verdict().balanced) << more;
  }
}

TEST(Drive, AnOutputFailureEndsTheRunAtOnce) {
  Scratch const scratch;
  run::World world(small_case("[output]\nfield_interval = \"50 us\"\n[end]\ntime = \"0.2 ms\"\n"));
  output::Writer writer(world, scratch.path());
  auto const ending = drive(world, writer, go_on, [&](run::World const& w) {
    if (w.clock.step > 1) return;
    std::filesystem::remove_all(scratch.path() / "fields");
    std::ofstream(scratch.path() / "fields") << "a file where a folder is needed\n";
  });
  EXPECT_EQ(ending.code, ExitCode::io_failure);
  EXPECT_NE(ending.reason.find(scratch.path().string()), std::string::npos) << ending.reason;
  EXPECT_LT(world.clock.time, 1e-4);
}

}  // namespace
}  // namespace brisance::app
