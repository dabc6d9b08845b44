#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/driver.hpp"
#include "gas/components.hpp"
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
