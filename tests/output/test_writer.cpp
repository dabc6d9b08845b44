#include <cmath>
#include <nlohmann/json.hpp>

#include "../observe/watched.hpp"
#include "core/error.hpp"
#include "grid/forest.hpp"
#include "observe/gauge_columns.hpp"
#include "output/file.hpp"
#include "output/report.hpp"
#include "output/writer.hpp"
#include "scratch.hpp"

namespace brisance::output::test {
namespace {

namespace fs = std::filesystem;

run::Case air_box() {
  run::Case setup;
  setup.title = "air at rest";
  setup.deck_text = "# a deck \xff with a byte that is no UTF-8\n";
  setup.deck_path = "air.toml";
  setup.domain.cells = {8, 8, 8};
  setup.domain.h = 0.1;
  setup.ambient.fluid.name = "air";
  setup.ambient.fluid.eos = material::IdealGas{1.4};
  setup.gauges = {{"g", {0.25, 0.25, 0.25}}};
  setup.output.fields = {"pressure", "velocity"};
  setup.end.time = 1e-3;
  return setup;
}

/// Standard air at a time; sampled columns are 0.
void record_air(observe::GaugeHistory& gauge, double time) {
  gauge.records.push_back({time, 101325.0, 1.225, {0.0, 0.0, 0.0}});
  gauge.sampled.resize(gauge.records.size() * observe::sampled_columns(observe::gas_columns()), 0.0);
}

TEST(Writer, FolderHoldsDeckLogGaugesFieldsAndSummary) {
  observe::Watched world(air_box());
  ScratchFolder scratch;
  fs::path const folder = scratch.path() / "out";
  Writer writer(world, world.gauges, folder);
  EXPECT_EQ(read_file(folder / "deck.toml"), world.setup.deck_text);
  EXPECT_EQ(nlohmann::json::parse(read_file(folder / "run.json"))["status"], "running");

  writer.dump(world, IsLast::yes);
  record_air(world.gauges.gas[0], 0.0);
  writer.append_gauges();
  world.timings["sweeps"] = 0.5;
  world.audit.fallback_faces = 7;
  record_air(world.gauges.gas[0], 1e-3);
  writer.finish(world, "end time reached", 0);

  auto const log = nlohmann::json::parse(read_file(folder / "run.json"));
  EXPECT_EQ(log["status"], "done");
  EXPECT_EQ(log["end_reason"], "end time reached");
  EXPECT_EQ(log["title"], "air at rest");
  EXPECT_EQ(log["domain"]["cells"], (std::vector{8, 8, 8}));
  EXPECT_EQ(log["domain"]["geometry"], "cartesian3d");
  EXPECT_EQ(log["dumps"], 1);
  EXPECT_EQ(log["timings"]["sweeps"], 0.5);
  EXPECT_EQ(log["versions"]["brisance"], "0.1.0");
  EXPECT_FALSE(log["versions"]["compiler"].get<std::string>().empty());
  EXPECT_EQ(log["versions"]["forest"].is_null(), grid::Forest::library().empty());
  EXPECT_FALSE(log["machine"]["processor"].get<std::string>().empty());
  EXPECT_TRUE(log["audit"]["relative_error"]["energy"].is_number());
  EXPECT_EQ(log["audit"]["fallback_faces"], 7);
  EXPECT_EQ(log["audit"]["balanced"], true);
  EXPECT_EQ(log["audit"]["reasons"].size(), 0U);
  EXPECT_EQ(log["audit"]["for_comparison"], false);
  EXPECT_EQ(log["audit"]["findings"]["guard_energy"]["reported"], false);
  EXPECT_TRUE(fs::exists(folder / "fields/fields_000000.h5"));
  EXPECT_TRUE(fs::exists(folder / "summary.csv"));
  auto const gauge = read_file(folder / "gauges/g.csv");
  EXPECT_EQ(std::ranges::count(gauge, '\n'), 3) << gauge;

  EXPECT_THROW(Writer(world, world.gauges, folder), IoError);
  EXPECT_NO_THROW(Writer(world, world.gauges, folder, {.earlier = Earlier::replace}));
}

/// The same on two levels.
run::Case refined_box() {
  run::Case setup = air_box();
  setup.numerics.block_cells = 4;
  setup.adaptive.finest = 1;
  setup.adaptive.parts = {{shape::Sphere{{0.1, 0.1, 0.1}, 0.05}, 1}};
  return setup;
}

TEST(Writer, FieldsOfSeveralLevelsAreAListOfFiles) {
  if (!grid::Forest::can_refine(3)) GTEST_SKIP() << "built without p4est";
  observe::Watched world(refined_box());
  ASSERT_EQ(world.grid.levels(), 2);
  ScratchFolder scratch;
  fs::path const folder = scratch.path() / "out";
  Writer writer(world, world.gauges, folder);
  writer.dump(world, IsLast::no);
  writer.finish_dumps();
  auto const list = nlohmann::json::parse(read_file(folder / "fields.hdf.series"));
  EXPECT_EQ(list["files"][0]["name"], "fields/fields_000000.hdf");
  EXPECT_FALSE(fs::exists(folder / "fields.xmf2"));
  writer.finish(world, "end time reached", 0);
  auto const log = nlohmann::json::parse(read_file(folder / "run.json"));
  EXPECT_EQ(log["dumps"], 1);
  ASSERT_EQ(log["levels"]["cells"].size(), 2U);
  EXPECT_EQ(log["levels"]["cells"][0]["cell_size"], 0.1);
  EXPECT_EQ(log["levels"]["cells"][1]["cell_size"], 0.05);
  double volume = 0.0;
  for (auto const& level : log["levels"]["cells"])
    volume += level["cells"].get<double>() * std::pow(level["cell_size"].get<double>(), 3);
  EXPECT_NEAR(volume, 0.512, 1e-12);
  EXPECT_EQ(log["levels"]["changes"], 0);

  // A run of one level in its place takes all of it away.
  observe::Watched uniform(air_box());
  Writer other(uniform, uniform.gauges, folder, {.earlier = Earlier::replace});
  EXPECT_FALSE(fs::exists(folder / "fields.hdf.series"));
  EXPECT_FALSE(fs::exists(folder / "fields/fields_000000.hdf"));
}

TEST(Writer, DiskCheckOfSeveralLevelsTellsHowItCounts) {
  if (!grid::Forest::can_refine(3)) GTEST_SKIP() << "built without p4est";
  observe::Watched world(refined_box());
  ScratchFolder scratch;
  try {
    Writer const writer(world, world.gauges, scratch.path() / "out", {.checkpoint_bytes = 1e18});
    FAIL() << "a disk of 1e18 bytes";
  } catch (IoError const& error) {
    std::string const message = error.what();
    EXPECT_NE(message.find("with twice the cells of the start"), std::string::npos) << message;
    EXPECT_NE(message.find("write fewer fields or dumps"), std::string::npos) << message;
  }
}

TEST(Writer, LogTellsWhatDoesNotBalance) {
  observe::Watched world(air_box());
  ScratchFolder scratch;
  Writer writer(world, world.gauges, scratch.path());
  world.audit.guard_energy = 1e3;
  writer.finish(world, "end time reached", 0);
  auto const audit = nlohmann::json::parse(read_file(scratch.path() / "run.json"))["audit"];
  EXPECT_EQ(audit["balanced"], false);
  EXPECT_GE(audit["reasons"].size(), 1U);
  EXPECT_EQ(audit["findings"]["guard_energy"]["amount"], 1e3);
  EXPECT_EQ(audit["findings"]["guard_energy"]["reported"], true);
}

TEST(Writer, StoppedRunSaysSo) {
  observe::Watched world(air_box());
  ScratchFolder scratch;
  Writer writer(world, world.gauges, scratch.path());
  writer.finish(world, "stopped by the user at 0.5 ms", 3);
  auto const log = nlohmann::json::parse(read_file(scratch.path() / "run.json"));
  EXPECT_EQ(log["status"], "stopped");
  EXPECT_EQ(log["exit_code"], 3);
}

TEST(Writer, DumpedFieldsAddPeaksToTheLastAndTheObstacleMaskOnce) {
  auto setup = air_box();
  setup.output.fields = {"pressure", "impulse"};
  setup.obstacles.push_back({"wall", shape::Box{}});
  auto const names = [&setup](IsLast last) {
    std::vector<std::string> all;
    for (auto const& spec : dumped_fields(setup, last)) all.push_back(spec.name);
    return all;
  };
  EXPECT_EQ(names(IsLast::no), (std::vector<std::string>{"pressure", "impulse", "obstacle"}));
  EXPECT_EQ(names(IsLast::yes), (std::vector<std::string>{"pressure", "impulse", "peak_overpressure", "obstacle"}));
  setup.output.fields = {"presure"};
  EXPECT_THROW((void)dumped_fields(setup, IsLast::no), InputError);
}

// What a run writes while it goes on does not depend on how far the thread that writes has come.
TEST(Writer, LogCountsADumpWhenItIsOnTheDisk) {
  observe::Watched world(air_box());
  ScratchFolder scratch;
  Writer writer(world, world.gauges, scratch.path());
  for (int n = 1; n <= 3; ++n) {
    writer.dump(world, IsLast::no);
    writer.finish_dumps();
    EXPECT_EQ(writer.dump_count(), n);
    EXPECT_EQ(nlohmann::json::parse(read_file(scratch.path() / "run.json"))["dumps"], n);
  }
}

TEST(Writer, FailedDumpIsReportedOnceAndNotCounted) {
  observe::Watched world(air_box());
  ScratchFolder scratch;
  Writer writer(world, world.gauges, scratch.path());
  writer.dump(world, IsLast::no);
  writer.finish_dumps();
  fs::create_directory(scratch.path() / "fields/fields_000001.h5.part");  // where the dump is to be written
  writer.dump(world, IsLast::no);
  EXPECT_THROW(writer.finish_dumps(), IoError);
  EXPECT_NO_THROW(writer.check());
  EXPECT_EQ(writer.dump_count(), 1);
  writer.close(world, "cannot write", 4);
  auto const log = nlohmann::json::parse(read_file(scratch.path() / "run.json"));
  EXPECT_EQ(log["dumps"], 1);
  EXPECT_EQ(log["status"], "stopped");
}

TEST(DumpTimes, HoldStartMultiplesExtraTimesAndEnd) {
  run::Output output;
  EXPECT_EQ(dump_times(output, 1.0), (std::vector{0.0, 1.0}));
  output.field_interval = 0.25;
  output.field_times = {0.3, 0.5, 2.0};
  EXPECT_EQ(dump_times(output, 1.0), (std::vector{0.0, 0.25, 0.3, 0.5, 0.75, 1.0}));
}

// 3 * 0.1 and 0.3 differ in the last bit, and so do 10 * 0.1 and 1: they are one dump, and the last is the end time
// exactly.
TEST(DumpTimes, MergeWhatOnlyRoundOffKeepsApart) {
  run::Output output;
  output.field_interval = 0.1;
  output.field_times = {0.3};
  auto const times = dump_times(output, 1.0);
  EXPECT_EQ(times.size(), 11U);
  EXPECT_EQ(times.back(), 1.0);
}

TEST(DumpTimes, SubsetsShareTheTimesThatOnlyRoundOffKeepsApart) {
  run::Case setup = air_box();
  setup.end.time = 1.0;
  setup.output.field_interval = 0.1;
  setup.output.subsets.resize(3);
  setup.output.subsets[0].interval = 0.3;
  setup.output.subsets[1].interval = 0.15;
  auto const whole = dump_times(setup.output, 1.0);
  auto const times = subset_times(setup);
  ASSERT_EQ(times.size(), 3U);
  EXPECT_EQ(times[0], (std::vector{0.0, whole[3], whole[6], whole[9], 1.0}));
  EXPECT_EQ(times[1][1], 0.15);
  EXPECT_EQ(times[1][2], whole[3]);
  EXPECT_EQ(times[2], (std::vector{0.0, 1.0}));
  setup.output.whole = false;
  EXPECT_TRUE(dump_times(setup.output, 1.0).empty());
  EXPECT_EQ(subset_times(setup)[1][2], subset_times(setup)[0][1]);
}

TEST(Report, FolderWithoutRunIsAnError) {
  ScratchFolder scratch;
  try {
    write_report(scratch.path());
    FAIL();
  } catch (IoError const& error) {
    EXPECT_EQ(std::string(error.what()),
              "\"" + scratch.path().string() + "\" is not the output folder of a run: it does not contain run.json");
  }
}

class ChosenPython {
 public:
  explicit ChosenPython(char const* name) { setenv("BRISANCE_PYTHON", name, 1); }
  ~ChosenPython() { unsetenv("BRISANCE_PYTHON"); }
  ChosenPython(ChosenPython const&) = delete;
  ChosenPython& operator=(ChosenPython const&) = delete;
};

TEST(Report, MissingInterpreterIsAnErrorThatSaysWhatToDo) {
  ScratchFolder scratch;
  replace_file(scratch.path() / "run.json", "{}");
  ChosenPython const chosen("/nowhere/python3");
  try {
    write_report(scratch.path());
    FAIL();
  } catch (IoError const& error) {
    EXPECT_EQ(std::string(error.what()),
              "cannot start \"/nowhere/python3\", which writes the report: install python3, or set the environment "
              "variable BRISANCE_PYTHON to an interpreter");
  }
}

TEST(Report, IsWrittenForAFinishedRun) {
  if (std::system(BRISANCE_PYTHON_EXECUTABLE " -c 'import h5py, matplotlib' 2>/dev/null") != 0)
    GTEST_SKIP() << "python3-h5py or python3-matplotlib is not installed";
  observe::Watched world(air_box());
  ScratchFolder scratch;
  Writer writer(world, world.gauges, scratch.path());
  writer.dump(world, IsLast::yes);
  writer.finish(world, "end time reached", 0);
  auto const html = read_file(write_report(scratch.path()));
  EXPECT_NE(html.find("air at rest"), std::string::npos);
  EXPECT_NE(html.find("</html>"), std::string::npos);
}

}  // namespace
}  // namespace brisance::output::test
