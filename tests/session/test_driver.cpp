#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "../observe/watched.hpp"
#include "../run/particles_case.hpp"
#include "core/parallel.hpp"
#include "gas/layout.hpp"
#include "observe/kinetic_energy.hpp"
#include "output/checkpoint.hpp"
#include "output/gauges.hpp"
#include "session/driver.hpp"
#include "small_case.hpp"

namespace brisance::session {
namespace {

std::atomic<bool> const go_on{false};
void ignore(run::World const& /*world*/) {}

nlohmann::json log_of(Scratch const& scratch) {
  return nlohmann::json::parse(std::ifstream(scratch.path() / "run.json"));
}

TEST(Drive, WritesEveryDumpAtItsTimeAndReachesTheEnd) {
  Scratch const scratch;
  observe::Watched world(small_case("[output]\nfield_interval = \"50 us\"\n[end]\ntime = \"0.2 ms\"\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  long steps = 0;
  auto const ending = drive(world, world.gauges, writer, go_on, [&](run::World const& w) {
    ++steps;
    EXPECT_EQ(w.clock.step, steps);
  });
  EXPECT_EQ(ending.code, ExitCode::done);
  EXPECT_EQ(ending.reason, "reached the end time 200 us");
  EXPECT_EQ(world.clock.time, 2e-4);
  EXPECT_EQ(writer.dump_count(), 5);
  // One record per step and the initial one.
  EXPECT_EQ(world.gauges.gas[0].records.size(), static_cast<std::size_t>(steps) + 1);
  EXPECT_EQ(log_of(scratch)["status"], "done");
}

/// A charge in 0.5 m of air; `output` goes into the table [output] and behind it.
run::Case plane_case(std::string const& output) {
  auto const result = deck::read_text(
      "[domain]\ngeometry = \"planar2d\"\nsize = [0.5, 0.5]\ncell = \"25 mm\"\n[[charge]]\nradius = 0.08\n"
      "position = [0.25, 0.25]\n[end]\ntime = \"0.1 ms\"\n[output]\n" +
          output,
      "plane.toml");
  for (auto const& error : result.errors) ADD_FAILURE() << deck::format(error);
  return result.case_.value();
}

/// Times of a series of dumps, all of whose files are there.
std::vector<double> series_of(Scratch const& scratch, std::string const& name) {
  std::vector<double> times;
  auto const list = nlohmann::json::parse(std::ifstream(scratch.path() / "subsets" / (name + ".hdf.series")));
  for (auto const& file : list["files"]) {
    times.push_back(file["time"]);
    EXPECT_TRUE(std::filesystem::exists(scratch.path() / "subsets" / file["name"].get<std::string>()));
  }
  return times;
}

/// The same but for the last digits, in which 30 us and 3e-5 may differ.
void expect_times(std::vector<double> const& times, std::vector<double> const& expected) {
  ASSERT_EQ(times.size(), expected.size());
  for (std::size_t n = 0; n < times.size(); ++n) EXPECT_NEAR(times[n], expected[n], 1e-17) << n;
}

char const* const two_subsets =
    "[[output.subset]]\nname = \"cut\"\nplane = {normal = \"x\", at = 0.2}\ninterval = \"30 us\"\n"
    "[[output.subset]]\nname = \"box\"\nbox = {lower = [0, 0], upper = [0.2, 0.2]}\n";

TEST(Drive, SubsetsAreWrittenAtTimesOfTheirOwn) {
  Scratch const scratch;
  observe::Watched world(plane_case(std::string("field_interval = \"20 us\"\n") + two_subsets));
  output::Writer writer(world, world.gauges, scratch.path());
  std::vector<double> times{0.0};
  EXPECT_EQ(drive(world, world.gauges, writer, go_on, [&](run::World const& w) { times.push_back(w.clock.time); }).code,
            ExitCode::done);
  EXPECT_EQ(writer.dump_count(), 6);
  expect_times(series_of(scratch, "cut"), {0.0, 3e-5, 6e-5, 9e-5, 1e-4});
  // Without an interval of its own it has that of the whole domain.
  expect_times(series_of(scratch, "box"), {0.0, 2e-5, 4e-5, 2e-5 * 3.0, 8e-5, 1e-4});
  // 60 us is one time, whatever it is a multiple of.
  for (std::size_t n = 1; n < times.size(); ++n) EXPECT_GT(times[n] - times[n - 1], 1e-9) << times[n];
}

TEST(Drive, SubsetsAloneWriteNothingElse) {
  Scratch const scratch;
  observe::Watched world(plane_case(two_subsets));
  output::Writer writer(world, world.gauges, scratch.path());
  EXPECT_EQ(drive(world, world.gauges, writer, go_on, ignore).code, ExitCode::done);
  EXPECT_EQ(world.clock.time, 1e-4);
  expect_times(series_of(scratch, "cut"), {0.0, 3e-5, 6e-5, 9e-5, 1e-4});
  expect_times(series_of(scratch, "box"), {0.0, 1e-4});
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "fields"));
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "fields.xmf2"));
  EXPECT_EQ(log_of(scratch)["status"], "done");
}

TEST(Drive, TheLastStateOfAStoppedRunIsInAllSubsetsUntilItGoesOn) {
  Scratch const scratch;
  std::atomic<bool> stop{false};
  observe::Watched world(plane_case(two_subsets));
  double stopped_at = 0.0;
  {
    output::Writer writer(world, world.gauges, scratch.path());
    auto const ending =
        drive(world, world.gauges, writer, stop, [&](run::World const& w) { stop = w.clock.time > 4e-5; });
    EXPECT_EQ(ending.code, ExitCode::stopped_by_user);
    stopped_at = world.clock.time;
  }
  expect_times(series_of(scratch, "cut"), {0.0, 3e-5, stopped_at});
  expect_times(series_of(scratch, "box"), {0.0, stopped_at});
  observe::Watched again(run::Case(world.setup));
  output::CheckpointReader checkpoint(scratch.path() / "checkpoints" /
                                      fmt::format("checkpoint_{:08d}.brz", world.clock.step));
  again.archive(checkpoint.archive());
  output::Writer resumed(again, again.gauges, scratch.path(), {.earlier = output::Earlier::keep});
  EXPECT_EQ(drive(again, again.gauges, resumed, go_on, ignore, &checkpoint.archive()).code, ExitCode::done);
  expect_times(series_of(scratch, "cut"), {0.0, 3e-5, 6e-5, 9e-5, 1e-4});
  expect_times(series_of(scratch, "box"), {0.0, 1e-4});
}

TEST(Drive, GaugeIntervalThinsTheRecordsButKeepsTheLast) {
  Scratch const scratch;
  observe::Watched world(small_case("[output]\ngauge_interval = \"20 us\"\n[end]\ntime = \"0.19 ms\"\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  EXPECT_EQ(drive(world, world.gauges, writer, go_on, ignore).code, ExitCode::done);
  auto const& records = world.gauges.gas[0].records;
  ASSERT_EQ(records.size(), 11U);  // 0, 20, ..., 180 us and the end
  EXPECT_EQ(records.back().time, 1.9e-4);
  for (std::size_t n = 0; n + 1 < records.size(); ++n) {
    EXPECT_GE(records[n].time, 2e-5 * static_cast<double>(n));
    EXPECT_LT(records[n].time, 2e-5 * static_cast<double>(n + 1));
  }
}

TEST(Drive, StopsAtTheStepLimit) {
  Scratch const scratch;
  observe::Watched world(small_case("[end]\ntime = \"0.2 ms\"\nsteps = 7\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  auto const ending = drive(world, world.gauges, writer, go_on, ignore);
  EXPECT_EQ(ending.code, ExitCode::done);
  EXPECT_EQ(world.clock.step, 7);
  EXPECT_NE(ending.reason.find("step limit end.steps = 7"), std::string::npos) << ending.reason;
}

TEST(Drive, StopsWhenAskedAndWritesWhatThereIs) {
  Scratch const scratch;
  observe::Watched world(small_case("[end]\ntime = \"0.2 ms\"\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  std::atomic<bool> stop{false};
  auto const ending = drive(world, world.gauges, writer, stop, [&](run::World const& w) { stop = w.clock.step == 5; });
  EXPECT_EQ(ending.code, ExitCode::stopped_by_user);
  EXPECT_NE(ending.reason.find("step 5"), std::string::npos) << ending.reason;
  EXPECT_EQ(writer.dump_count(), 2);
  EXPECT_EQ(world.gauges.gas[0].records.size(), 6U);
  EXPECT_EQ(log_of(scratch)["status"], "stopped");
  EXPECT_EQ(log_of(scratch)["exit_code"], 3);
}

TEST(Drive, ANumericalFailureLeavesTheResultsUntilThen) {
  Scratch const scratch;
  observe::Watched world(small_case("[end]\ntime = \"0.2 ms\"\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  auto const ending = drive(world, world.gauges, writer, go_on, [&](run::World const& w) {
    if (w.clock.step == 4) world.gas->fields().at(0, gas::energy)[3] = std::numeric_limits<double>::quiet_NaN();
  });
  EXPECT_EQ(ending.code, ExitCode::numerical_failure);
  EXPECT_NE(ending.reason.find("step 4"), std::string::npos) << ending.reason;
  EXPECT_EQ(world.gauges.gas[0].records.size(), 5U);
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
  observe::Watched world(small_case("[end]\ntime = \"1 s\"\nsteps = 50\n[checkpoint]\nkeep = 1000\n" + table));
  output::Writer writer(world, world.gauges, scratch.path());
  (void)drive(world, world.gauges, writer, stop, [&](run::World const& w) {
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
  observe::Watched world(small_case("[end]\ntime = \"0.2 ms\"\n[checkpoint]\nkeep = 100\ninterval = \"30 us\"\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  (void)drive(world, world.gauges, writer, go_on, ignore);
  EXPECT_EQ(checkpoints_of(scratch).size(), 7U) << "six multiples and the end";
}

TEST(Drive, CheckpointsDoNotChangeTheResults) {
  std::vector<double> times[2];
  for (int with = 0; with < 2; ++with) {
    Scratch const scratch;
    observe::Watched world(small_case(std::string("[end]\ntime = \"0.1 ms\"\n[checkpoint]\n") +
                                      (with != 0 ? "interval = \"1 us\"\n" : "wall_clock = 0\nat_end = false\n")));
    output::Writer writer(world, world.gauges, scratch.path());
    (void)drive(world, world.gauges, writer, go_on, ignore);
    for (auto const& record : world.gauges.gas[0].records) times[with].push_back(record.time);
  }
  EXPECT_EQ(times[0], times[1]);
}

// The state of a step that failed is no state to go on from.
TEST(Drive, ANumericalFailureLeavesTheCheckpointsAndAFileOfItsOwn) {
  Scratch const scratch;
  observe::Watched world(small_case("[end]\ntime = \"0.2 ms\"\n[checkpoint]\nsteps = 3\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  auto const ending = drive(world, world.gauges, writer, go_on, [&](run::World const& w) {
    if (w.clock.step == 7) world.gas->fields().at(0, gas::energy)[3] = std::numeric_limits<double>::quiet_NaN();
  });
  EXPECT_EQ(ending.code, ExitCode::numerical_failure);
  EXPECT_EQ(checkpoints_of(scratch), (std::vector<long>{3, 6}));
  output::CheckpointReader stopped(scratch.path() / "checkpoints/stopped.brz");
  EXPECT_EQ(stopped.info().step, 7);
  observe::Watched failed(small_case("[end]\ntime = \"0.2 ms\"\n"));
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
  observe::Watched world(guarded(1.2e5, ""));
  output::Writer writer(world, world.gauges, scratch.path());
  double within = 0.0;
  auto const ending =
      drive(world, world.gauges, writer, go_on, [&](run::World const& w) { within = w.audit.guard_energy; });
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
  observe::Watched world(std::move(setup));
  output::Writer writer(world, world.gauges, scratch.path());
  EXPECT_EQ(drive(world, world.gauges, writer, go_on, ignore).code, ExitCode::done);
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
    observe::Watched world(guarded(1.2e5, more));
    output::Writer writer(world, world.gauges, scratch.path());
    EXPECT_EQ(drive(world, world.gauges, writer, go_on, ignore).code, ExitCode::done) << more;
    EXPECT_GT(world.audit.guard_energy, 0.01 * world.charges[0].realised_energy) << more;
    EXPECT_FALSE(world.verdict().balanced) << more;
  }
}

TEST(Drive, AnOutputFailureEndsTheRunAtOnce) {
  Scratch const scratch;
  observe::Watched world(small_case("[output]\nfield_interval = \"50 us\"\n[end]\ntime = \"0.2 ms\"\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  auto const ending = drive(world, world.gauges, writer, go_on, [&](run::World const& w) {
    if (w.clock.step > 1) return;
    writer.finish_dumps();  // a dump that is being written would put its folder back
    std::filesystem::remove_all(scratch.path() / "fields");
    std::ofstream(scratch.path() / "fields") << "a file where a folder is needed\n";
  });
  EXPECT_EQ(ending.code, ExitCode::io_failure);
  EXPECT_NE(ending.reason.find(scratch.path().string()), std::string::npos) << ending.reason;
  // The dump at 50 us fails in a thread of its own: at the next one at the latest that is known.
  EXPECT_LE(world.clock.time, 1e-4 * (1.0 + 1e-9));
}

// All bodies gone is a normal end, and not a step of infinite length.
TEST(Drive, EndsWhenAllBodiesHaveLeft) {
  Scratch const scratch;
  auto setup = run::two_blocks();
  setup.particles.bodies = {setup.particles.bodies[0]};
  setup.particles.bodies[0].velocity = {-3000.0, 0.0, 0.0};
  setup.particles.gauges = {{"tip", 0, Vec3{0.0195, 0.012, 0.0}}, {"body", 0, {}}};
  setup.end.time = 1.0;
  observe::Watched world(std::move(setup));
  output::Writer writer(world, world.gauges, scratch.path());
  auto const ending = drive(world, world.gauges, writer, go_on, ignore);
  EXPECT_EQ(ending.code, ExitCode::done);
  EXPECT_TRUE(ending.reason.starts_with("all bodies have left the domain at t = ")) << ending.reason;
  // Its last particles start 22 mm from the face.
  EXPECT_NEAR(world.clock.time, 0.022 / 3000.0, 0.5e-6);
  EXPECT_EQ(log_of(scratch)["status"], "done");
  auto const summary = nlohmann::json::parse(std::ifstream(scratch.path() / "summary.json"));
  EXPECT_TRUE(summary["point_gauges"][0]["left_the_domain"]);
  EXPECT_EQ(summary["bodies"][0]["end"]["mass"], 0.0);
  // The checkpoint at the end is one from which nothing more comes.
  observe::Watched again(run::Case(world.setup));
  output::CheckpointReader checkpoint(scratch.path() / "checkpoints" /
                                      fmt::format("checkpoint_{:08d}.brz", world.clock.step));
  again.archive(checkpoint.archive());
  output::Writer resumed(again, again.gauges, scratch.path(), {.earlier = output::Earlier::keep});
  EXPECT_EQ(drive(again, again.gauges, resumed, go_on, ignore, &checkpoint.archive()).reason, ending.reason);
  EXPECT_EQ(again.clock.step, world.clock.step);
}

// What is left is rigid and at rest: nothing more happens, up to the end.
TEST(Drive, GoesOnToTheEndWithRigidBodiesAlone) {
  for (int const movers : {1, 0}) {
    Scratch const scratch;
    auto setup = run::two_blocks();
    run::Body anvil = setup.particles.bodies[1];
    anvil.rigid = true;
    setup.particles.bodies = {anvil, setup.particles.bodies[0]};
    setup.particles.bodies.resize(1 + movers);
    if (movers > 0) setup.particles.bodies[1].velocity = {-3000.0, 0.0, 0.0};
    setup.particles.gauges.clear();
    setup.end.time = 50e-6;
    setup.audit.fail = 0.0;  // the impact at 3 km/s on four cells loses 5 % of the energy
    observe::Watched world(std::move(setup));
    output::Writer writer(world, world.gauges, scratch.path());
    auto const ending = drive(world, world.gauges, writer, go_on, ignore);
    EXPECT_EQ(ending.code, ExitCode::done);
    EXPECT_EQ(ending.reason, "reached the end time 50 us");
    EXPECT_EQ(world.clock.time, 50e-6);
    EXPECT_EQ(mpm::sums(*world.regions.front().particles, 0).largest_displacement, 0.0);
  }
}

TEST(Drive, EndsWhenTheGaugesArePastTheirPositivePhase) {
  auto const run_with = [](std::string const& end, double far) {
    Scratch const scratch;
    auto setup = small_case("[[gauge]]\nname = \"far\"\npoint = 0.9\n[end]\ntime = \"10 ms\"\n" + end);
    setup.gauges[1].position[0] = far;
    observe::Watched world(std::move(setup));
    output::Writer writer(world, world.gauges, scratch.path());
    auto const ending = drive(world, world.gauges, writer, go_on, ignore);
    EXPECT_EQ(ending.code, ExitCode::done);
    return std::tuple(ending.reason, world.clock.step, observe::summarise(world.setup, world.gauges.gas));
  };
  auto const [reason, step, gauges] = run_with("gauges = \"positive_phase\"\n", 0.9);
  EXPECT_NE(reason.find("the positive phase has ended at all gauges (end.gauges)"), std::string::npos) << reason;
  ASSERT_EQ(gauges.size(), 2U);
  double last = 0.0;
  for (auto const& g : gauges) {
    ASSERT_TRUE(g.wave.positive_duration);
    last = std::max(last, *g.wave.arrival_time + *g.wave.positive_duration);
  }
  // Soon after the last of them: one look later at most.
  auto const [whole_reason, whole_step, whole] = run_with("", 0.9);
  EXPECT_EQ(whole_reason, "reached the end time 10 ms");
  EXPECT_GT(whole_step, step);
  for (int g = 0; g < 2; ++g) {
    EXPECT_EQ(gauges[g].wave.positive_impulse, whole[g].wave.positive_impulse);
    EXPECT_EQ(gauges[g].wave.positive_duration, whole[g].wave.positive_duration);
    EXPECT_EQ(gauges[g].wave.peak_overpressure, whole[g].wave.peak_overpressure);
  }
  EXPECT_LT(last, 3e-3);
  EXPECT_LT(step, whole_step / 2);
}

TEST(Drive, GaugesThatNothingReachedAreWaitedFor) {
  Scratch const scratch;
  auto setup = small_case("[end]\ntime = \"0.05 ms\"\ngauges = \"positive_phase\"\n");
  observe::Watched world(std::move(setup));
  output::Writer writer(world, world.gauges, scratch.path());
  EXPECT_EQ(drive(world, world.gauges, writer, go_on, ignore).reason, "reached the end time 50 us");
}

// A second charge is lit when the wave of the first is over: neither condition ends the run before.
TEST(Drive, ChargesThatAreLitLaterAreWaitedFor) {
  for (char const* condition : {"gauges = \"positive_phase\"\n", "kinetic_energy = 0.2\n"}) {
    Scratch const scratch;
    auto const result = deck::read_text(
        std::string("[domain]\ngeometry = \"planar2d\"\nsize = [1, 0.8]\ncell = \"40 mm\"\n[[charge]]\nmass = 2\n"
                    "position = [0.3, 0.4]\n[[charge]]\nmass = 2\nposition = [0.7, 0.4]\n"
                    "initiation = [{position = [0.7, 0.4], delay = \"0.8 ms\"}]\n"
                    "[[gauge]]\npoint = [0.5, 0.4]\n[end]\ntime = \"0.9 ms\"\n") +
            condition,
        "two.toml");
    for (auto const& error : result.errors) ADD_FAILURE() << deck::format(error);
    observe::Watched world{run::Case(result.case_.value())};
    output::Writer writer(world, world.gauges, scratch.path());
    EXPECT_EQ(drive(world, world.gauges, writer, go_on, ignore).code, ExitCode::done);
    EXPECT_GT(world.clock.time, 0.8e-3);
  }
}

TEST(Drive, EndsWhenTheMotionHasCeased) {
  Scratch const scratch;
  observe::Watched world(small_case("[end]\ntime = \"0.1 s\"\nkinetic_energy = 0.05\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  auto const ending = drive(world, world.gauges, writer, go_on, ignore);
  EXPECT_EQ(ending.code, ExitCode::done);
  EXPECT_NE(ending.reason.find("below 0.05 of its maximum (end.kinetic_energy)"), std::string::npos) << ending.reason;
  EXPECT_LT(world.clock.time, 0.1);
  EXPECT_GT(world.clock.time, 1e-3);
}

// A spring that swings comes to rest twice in a period, which is no end: a bar that is pulled apart and let go.
TEST(Drive, TurningPointsOfAVibrationAreNoEnd) {
  run::Case setup;
  setup.domain.geometry = grid::Geometry::planar1d;
  setup.domain.h = 1e-3;
  setup.domain.cells = {64, 1, 1};
  setup.domain.boundary.fill(grid::Boundary::wall);
  setup.domain.boundary[0] = grid::Boundary::symmetry;
  run::Body bar;
  bar.name = "bar";
  bar.solid = material::elastic_solid(8000.0, 200e9, 0.0);  // 5 km/s
  bar.shape = shape::Box{{0.0, 0.0, 0.0}, {0.05, 0.0, 0.0}};
  bar.velocity = {1.0, 0.0, 0.0};  // away from the plane that holds its other end
  setup.particles.bodies = {bar};
  double const period = 4.0 * 0.05 / 5000.0;
  setup.end.time = 3.0 * period;
  setup.end.kinetic_energy = 0.05;
  Scratch const scratch;
  observe::Watched world(run::Case{setup});
  output::Writer writer(world, world.gauges, scratch.path());
  EXPECT_EQ(drive(world, world.gauges, writer, go_on, ignore).reason, "reached the end time 120 us");
  auto const& records = world.gauges.bodies[0];
  double least = 1e300;
  for (auto const& r : records) least = std::min(least, r.sums.kinetic_energy);
  EXPECT_LT(least, 0.05 * records[0].sums.kinetic_energy) << "it never came to rest: the test shows nothing";
}

// Interrupted anywhere, a run comes to the same end by its own state.
TEST(Drive, ConditionalEndsOutliveAStop) {
  for (char const* condition : {"gauges = \"positive_phase\"\n", "kinetic_energy = 0.3\n"}) {
    auto const setup = small_case(std::string("[end]\ntime = \"20 ms\"\n") + condition);
    std::string reason;
    long steps = 0;
    for (long const stop_at : {-1L, 57L, 311L}) {
      Scratch const scratch;
      observe::Watched world{run::Case(setup)};
      std::atomic<bool> stop{false};
      Ending ending;
      {
        output::Writer writer(world, world.gauges, scratch.path());
        ending = drive(world, world.gauges, writer, stop, [&](run::World const& w) { stop = w.clock.step == stop_at; });
      }
      if (stop_at < 0) {
        EXPECT_EQ(ending.code, ExitCode::done);
        reason = ending.reason;
        steps = world.clock.step;
        ASSERT_GT(steps, 311);
        continue;
      }
      ASSERT_EQ(ending.code, ExitCode::stopped_by_user);
      observe::Watched again{run::Case(setup)};
      auto found = output::newest_checkpoint(scratch.path());
      again.archive(found.reader->archive());
      output::Writer writer(again, again.gauges, scratch.path(), {.earlier = output::Earlier::keep});
      EXPECT_EQ(drive(again, again.gauges, writer, go_on, ignore, &found.reader->archive()).reason, reason);
      EXPECT_EQ(again.clock.step, steps);
    }
  }
}

TEST(Drive, ConditionalEndsDoNotDependOnThreads) {
  std::vector<std::string> reasons;
  int const before = threads();
  for (int const count : {1, 4}) {
    set_threads(count);
    Scratch const scratch;
    observe::Watched world(small_case("[numerics]\nblock_cells = 16\n[end]\ntime = \"20 ms\"\nkinetic_energy = 0.3\n"));
    output::Writer writer(world, world.gauges, scratch.path());
    reasons.push_back(drive(world, world.gauges, writer, go_on, ignore).reason +
                      fmt::format(" {:a}", observe::kinetic_energy(world)));
  }
  set_threads(before);
  EXPECT_EQ(reasons[0], reasons[1]);
}

TEST(Drive, StopsByTheClockWithACheckpoint) {
  auto const deck = "[end]\ntime = \"1 s\"\nwall_clock = \"20 ms\"\n[checkpoint]\non_signal = false\nat_end = false\n";
  Scratch const scratch;
  observe::Watched world(small_case(deck));
  output::Writer writer(world, world.gauges, scratch.path());
  auto const ending = drive(world, world.gauges, writer, go_on, ignore);
  EXPECT_EQ(ending.code, ExitCode::stopped_by_user);
  EXPECT_NE(ending.reason.find("stopped by the wall-clock limit, end.wall_clock = 20 ms, at t = "), std::string::npos)
      << ending.reason;
  EXPECT_EQ(checkpoints_of(scratch), std::vector<long>{world.clock.step});
  EXPECT_EQ(log_of(scratch)["status"], "stopped");
  EXPECT_EQ(log_of(scratch)["exit_code"], 3);
  // Also one whose time was over before it began makes a step.
  Scratch const second;
  observe::Watched late(small_case(deck));
  output::Writer late_writer(late, late.gauges, scratch.path() / "late");
  auto const long_ago = std::chrono::steady_clock::now() - std::chrono::hours(1);
  EXPECT_EQ(drive(late, late.gauges, late_writer, go_on, ignore, nullptr, long_ago).code, ExitCode::stopped_by_user);
  EXPECT_EQ(late.clock.step, 1);
}

// A run is done when all of it is written: one whose profile cannot be is not.
TEST(Drive, IsNotDoneBeforeItsProfileIsWritten) {
  Scratch const scratch;
  observe::Watched world(small_case("[output]\nprofile = true\n[end]\ntime = \"0.02 ms\"\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  std::ofstream(scratch.path() / "profiles") << "in the way";
  auto const ending = drive(world, world.gauges, writer, go_on, ignore);
  EXPECT_EQ(ending.code, ExitCode::io_failure);
  EXPECT_NE(ending.reason.find("profiles"), std::string::npos) << ending.reason;
  EXPECT_EQ(log_of(scratch)["status"], "stopped");
  EXPECT_EQ(log_of(scratch)["exit_code"], 5);
}

TEST(Drive, IsNotDoneWithAStateThatIsNoProfile) {
  Scratch const scratch;
  observe::Watched world(small_case("[output]\nprofile = true\n[end]\ntime = \"2 us\"\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  auto const ending = drive(world, world.gauges, writer, go_on, ignore);
  EXPECT_EQ(ending.code, ExitCode::bad_input);
  EXPECT_NE(ending.reason.find("still burning"), std::string::npos) << ending.reason;
  EXPECT_EQ(log_of(scratch)["status"], "stopped");
  EXPECT_EQ(log_of(scratch)["exit_code"], 2);
}

TEST(Drive, WritesItsProfileBeforeItSaysDone) {
  Scratch const scratch;
  observe::Watched world(small_case("[output]\nprofile = true\n[end]\ntime = \"0.02 ms\"\n"));
  output::Writer writer(world, world.gauges, scratch.path());
  EXPECT_EQ(drive(world, world.gauges, writer, go_on, ignore).code, ExitCode::done);
  EXPECT_EQ(log_of(scratch)["status"], "done");
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "profiles/end.h5"));
}

}  // namespace
}  // namespace brisance::session
