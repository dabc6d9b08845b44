// What a run of material points writes.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "../observe/watched.hpp"
#include "../run/particles_case.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "observe/particle_fields.hpp"
#include "output/file.hpp"
#include "output/report.hpp"
#include "output/run_log.hpp"
#include "output/writer.hpp"
#include "read_numbers.hpp"
#include "scratch.hpp"

namespace brisance::output::test {
namespace {

namespace fs = std::filesystem;

/// Runs `steps` steps of a case into a folder, with a dump at the start and one at the end.
void write_run(observe::Watched& world, fs::path const& folder, int steps) {
  Writer writer(world, world.gauges, folder);
  world.sample_gauges();
  writer.dump(world, IsLast::no);
  while (world.clock.step < steps) {
    run::advance(world, 1.0);
    world.sample_gauges();
    if (world.clock.step % 7 == 0) writer.append_gauges();
  }
  world.update_audit();
  writer.dump(world, IsLast::no);
  writer.finish(world, "done", 0);
}

std::vector<std::string> lines(std::string const& text) {
  std::vector<std::string> out;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) out.push_back(line);
  return out;
}

std::vector<double> numbers(std::string const& line) {
  std::vector<double> out;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) out.push_back(cell.empty() ? NAN : std::stod(cell));
  return out;
}

TEST(Particles, DumpHoldsWhatTheParticlesCarry) {
  for (bool const single : {false, true}) {
    auto setup = run::two_blocks();
    setup.output.single_precision = single;
    observe::Watched world(std::move(setup));
    ScratchFolder folder;
    write_run(world, folder.path(), 25);
    fs::path const file = folder.path() / "points/points_000001.h5";
    std::vector<double> values;
    for (std::string const name :
         {"position", "body", "material", "velocity", "stress", "mises", "identity", "plastic_strain"}) {
      observe::particle_field(world, name, values);
      auto const read = read_numbers(file, "/points/" + name);
      ASSERT_EQ(read.size(), values.size()) << name;
      bool const rounded = single && name != "body" && name != "material" && name != "identity";
      for (std::size_t i = 0; i < read.size(); ++i)
        ASSERT_EQ(read[i], rounded ? double(float(values[i])) : values[i]) << name;
    }
    EXPECT_FALSE(fs::exists(folder.path() / "fields.xmf2")) << "there is no gas";
    EXPECT_FALSE(fs::exists(folder.path() / "fields"));
  }
}

TEST(Particles, IndexListsEveryDump) {
  observe::Watched world(run::two_blocks());
  ScratchFolder folder;
  write_run(world, folder.path(), 10);
  auto const index = read_file(folder.path() / "points.xmf2");
  for (std::string const part :
       {"<Time Value=\"0\"/>", "points/points_000000.h5:/points/position", "points/points_000001.h5:/points/stress",
        "TopologyType=\"Polyvertex\" NumberOfElements=\"3600\"", "GeometryType=\"XYZ\"", "Dimensions=\"3600 6\"",
        "</Xdmf>"})
    EXPECT_NE(index.find(part), std::string::npos) << part << "\n" << index;
  for (auto const& entry : fs::recursive_directory_iterator(folder.path()))
    EXPECT_NE(entry.path().extension(), ".part") << "a temporary file is left: " << entry.path();
}

TEST(Particles, OpenInParaViewWithoutAsking) {
  std::string const pvpython = BRISANCE_PVPYTHON;
  if (pvpython.empty()) GTEST_SKIP() << "pvpython was not found when the tests were configured: ParaView is not tested";
  observe::Watched world(run::two_blocks());
  ScratchFolder folder;
  write_run(world, folder.path(), 25);
  auto const out = output_of("cd / && " + pvpython + " " TEST_SCRIPT_DIR "/open_points_in_paraview.py " +
                             (folder.path() / "points.xmf2").string() + " 2>/dev/null");
  auto const line = out.rfind("{\"readers\"");
  ASSERT_NE(line, std::string::npos) << out;
  auto const seen = nlohmann::json::parse(out.substr(line));
  EXPECT_EQ(seen["readers"], 1) << "ParaView would ask which reader to use";
  EXPECT_EQ(seen["times"], (std::vector{0.0, world.clock.time}));
  auto const& last = seen["steps"][1];
  EXPECT_EQ(last["points"], 3600);
  EXPECT_EQ(last["cells"], 3600) << "one vertex for each point";
  std::vector<double> values;
  for (auto const& [name, components] : std::map<std::string, int>{
           {"velocity", 3}, {"stress", 6}, {"mises", 1}, {"identity", 1}, {"body", 1}, {"material", 1}}) {
    observe::particle_field(world, name, values);
    auto const& array = last["arrays"][name];
    ASSERT_EQ(array["components"], components) << name;
    for (int c = 0; c < components; ++c) {
      EXPECT_EQ(array["first"][c], double(float(values[c]))) << name;
      EXPECT_EQ(array["last"][c], double(float(values[values.size() - components + c]))) << name;
    }
  }
}

TEST(Particles, GaugesHaveTheirColumns) {
  observe::Watched world(run::two_blocks());
  ScratchFolder folder;
  write_run(world, folder.path(), 25);
  auto const tip = lines(read_file(folder.path() / "gauges/tip.csv"));
  ASSERT_EQ(tip.size(), 27U);
  EXPECT_EQ(tip[0],
            "time [s],x [m],y [m],z [m],displacement_x [m],displacement_y [m],displacement_z [m],velocity_x [m/s],"
            "velocity_y [m/s],velocity_z [m/s],pressure [Pa],mises [Pa],density [kg/m3],plastic_strain [1],"
            "temperature [K],damage [1]");
  auto const row = numbers(tip.back());
  ASSERT_EQ(row.size(), 16U);
  auto const& r = world.gauges.particles[0].particles.back();
  auto const near = [](double read, double value) { EXPECT_NEAR(read, value, 1e-9 * std::abs(value)); };  // 10 digits
  near(row[0], r.time);
  near(row[1], r.position[0]);
  near(row[4], r.displacement[0]);
  near(row[7], r.velocity[0]);
  near(row[10], r.pressure);
  near(row[11], r.mises);
  near(row[14], r.temperature);

  auto const target = lines(read_file(folder.path() / "gauges/target.csv"));
  ASSERT_EQ(target.size(), 27U);
  auto const sums = numbers(target.back());
  ASSERT_EQ(sums.size(), 16U);
  auto const& s = world.gauges.particles[1].bodies.back().sums;
  near(sums[1], s.mass);
  near(sums[2], s.momentum[0]);
  near(sums[8], s.momentum[0] / s.mass);
  near(sums[11], s.kinetic_energy);
  near(sums[14], s.largest_displacement);

  auto const energies = lines(read_file(folder.path() / "energies.csv"));
  // A comma or a quote in a body's name would end the column.
  EXPECT_NE(energies[0].find("right_ _the_ other: kinetic_energy [J]"), std::string::npos) << energies[0];
  EXPECT_EQ(energies.size(), world.gauges.bodies[0].size() + 1);
  auto const first = numbers(energies[1]);
  ASSERT_EQ(first.size(), 10U);
  near(first[1], 0.5 * 8930.0 * 0.02 * 0.02 * 100.0 * 100.0);
}

TEST(Particles, SummaryReadsTheHistories) {
  observe::Watched world(run::two_blocks());
  auto& gauge = world.gauges.particles[0];
  ScratchFolder folder;
  Writer writer(world, world.gauges, folder.path());
  world.sample_gauges();
  auto const record = [&](double time, Vec3 const& u, double mises) {
    run::ParticleRecord r = gauge.particles.front();
    r.time = time;
    r.displacement = u;
    r.velocity = {0.0, 0.0, -time};
    r.mises = mises;
    gauge.particles.push_back(r);
  };
  record(1.0, {0.0, -3.0, 4.0}, 7.0);
  record(2.0, {4.2, 0.5, 0.0}, 9.0);
  record(3.0, {1.0, 2.0, -3.0}, 8.0);
  writer.finish(world, "done", 0);
  auto const summary = nlohmann::json::parse(read_file(folder.path() / "summary.json"));
  auto const& s = summary["point_gauges"][0];
  EXPECT_EQ(s["name"], "tip");
  EXPECT_EQ(s["file"], "gauges/tip.csv");
  EXPECT_EQ(s["peak_displacement"]["value"], 5.0);
  EXPECT_EQ(s["peak_displacement"]["time"], 1.0);
  EXPECT_EQ(s["component"], "x");  // 4.2 at another time than the peak of the magnitude
  EXPECT_EQ(s["component_displacement"]["value"], 4.2);
  EXPECT_EQ(s["component_displacement"]["time"], 2.0);
  EXPECT_EQ(s["final_displacement"], (std::vector{1.0, 2.0, -3.0}));
  EXPECT_EQ(s["peak_velocity"]["value"], 100.0);  // of the start
  EXPECT_EQ(s["peak_mises"]["value"], 9.0);
  EXPECT_EQ(s["peak_mises"]["time"], 2.0);
  // The gauge that watches the second body, then the bodies without a gauge.
  ASSERT_EQ(summary["bodies"].size(), 3U);
  EXPECT_EQ(summary["bodies"][0]["name"], "target");
  EXPECT_EQ(summary["bodies"][0]["file"], "gauges/target.csv");
  EXPECT_EQ(summary["bodies"][1]["body"], "left");
  EXPECT_EQ(summary["bodies"][2]["body"], "gas");
  auto const csv = lines(read_file(folder.path() / "summary.csv"));
  ASSERT_EQ(csv.size(), 5U);
  auto const columns = std::ranges::count(csv[0], ',');
  EXPECT_EQ(std::ranges::count(csv[1], ','), columns) << csv[1];
  EXPECT_EQ(csv[1].substr(0, 15), "tip,point,left,");
  EXPECT_EQ(csv[2].find("target,body,\"right, \"\"the\"\" other\","), 0U) << csv[2];
  EXPECT_EQ(std::ranges::count(csv[2], ','), columns + 1) << csv[2];
  EXPECT_EQ(std::ranges::count(csv[3], ','), columns) << csv[3];
}

TEST(Particles, LogTellsBodiesOptionsAndAudit) {
  observe::Watched world(run::two_blocks());
  ScratchFolder folder;
  write_run(world, folder.path(), 25);
  auto const log = nlohmann::json::parse(read_file(folder.path() / "run.json"));
  EXPECT_EQ(log["status"], "done");
  EXPECT_EQ(log["dumps"], 2);
  EXPECT_EQ(log["courant"], 0.4);
  auto const& particles = log["points"];
  EXPECT_EQ(particles["count"], 3600);
  EXPECT_EQ(particles["order"], "musl");
  EXPECT_EQ(particles["transfer"], "flip");
  EXPECT_EQ(particles["shape_function"], word_of(world.regions.front().particles->options().shape));
  EXPECT_GT(particles["point_updates_per_second"].get<double>(), 0.0);
  ASSERT_EQ(particles["bodies"].size(), 3U);
  auto const& left = particles["bodies"][0];
  EXPECT_EQ(left["material"], "copper");
  EXPECT_EQ(left["source"], "a test");
  EXPECT_EQ(left["points"], 1600);
  EXPECT_NEAR(left["mass"].get<double>(), 8930.0 * 0.0004, 1e-12);
  EXPECT_NEAR(left["geometric_mass"].get<double>(), 8930.0 * 0.0004, 1e-12);
  EXPECT_LT(particles["audit"]["mass"]["relative_error"].get<double>(), 1e-13);
  auto const& energy = particles["audit"]["energy"];
  EXPECT_EQ(energy["work"], 0.0);
  double const change =
      energy["current"].get<double>() + energy["lost"].get<double>() - energy["initial"].get<double>();
  EXPECT_DOUBLE_EQ(energy["drift"], change / energy["scale"].get<double>());
  EXPECT_EQ(energy["friction"], 0.0);
  EXPECT_TRUE(log["audit"]["balanced"].is_boolean());
  EXPECT_EQ(log["audit"]["findings"]["drift"]["warn"], 0.005);
  EXPECT_EQ(log["audit"]["findings"]["drift"]["fail"], 0.05);
  EXPECT_TRUE(energy["largest_drift"].is_number());
}

TEST(Particles, EarlierResultsAreRefusedAndReplaced) {
  observe::Watched world(run::two_blocks());
  ScratchFolder folder;
  write_run(world, folder.path(), 3);
  for (char const* name : {"run.json", "deck.toml", "summary.csv", "summary.json"}) fs::remove(folder.path() / name);
  EXPECT_THROW(Writer(world, world.gauges, folder.path()), IoError) << "points are results too";
  fs::remove(folder.path() / "points.xmf2");
  fs::remove(folder.path() / "energies.csv");
  fs::remove_all(folder.path() / "gauges");
  EXPECT_THROW(Writer(world, world.gauges, folder.path()), IoError);
  Writer const writer(world, world.gauges, folder.path(), {.earlier = Earlier::replace});
  EXPECT_TRUE(fs::is_empty(folder.path() / "points"));
}

TEST(Particles, EmptyDomainIsWritten) {
  auto setup = run::two_blocks();
  setup.particles.bodies.resize(1);
  setup.particles.gauges.resize(1);
  setup.particles.bodies[0].velocity = {-2000.0, 0.0, 0.0};
  observe::Watched world(std::move(setup));
  ScratchFolder folder;
  Writer writer(world, world.gauges, folder.path());
  writer.dump(world, IsLast::no);
  while (mpm::particle_count(*world.regions.front().particles) > 0) {
    run::advance(world, 1.0);
    world.sample_gauges();
    ASSERT_LT(world.clock.time, 1e-4);
  }
  writer.dump(world, IsLast::no);
  world.update_audit();
  writer.finish(world, "done", 0);
  EXPECT_TRUE(read_numbers(folder.path() / "points/points_000001.h5", "/points/velocity").empty());
  auto const index = read_file(folder.path() / "points.xmf2");
  EXPECT_EQ(index.find("points_000001"), std::string::npos) << "readers cannot take an empty grid";
  auto const summary = nlohmann::json::parse(read_file(folder.path() / "summary.json"));
  EXPECT_EQ(summary["point_gauges"][0]["left_the_domain"], true);
}

TEST(Particles, FailedWriteLeavesTheSeriesIntact) {
  ScratchFolder folder;
  std::vector<FieldSpec> const specs{{"position", "m", 3, ""}, {"mises", "Pa", 1, ""}};
  auto const values = [](std::string const& name, std::vector<double>& out) {
    out.resize(name == "position" ? 60000 : 20000);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::sin(double(i));
  };
  ParticleSeries series(folder.path(), {false, 1});
  auto const dump = [&](double time) {
    series.dump(time, 0, grid::Geometry::cartesian3d, 20000, specs, values).write();
  };
  dump(0.0);
  auto const index = read_file(folder.path() / "points.xmf2");
  rlimit saved{};
  getrlimit(RLIMIT_FSIZE, &saved);
  auto const handler = signal(SIGXFSZ, SIG_IGN);
  rlimit const limit{5000, saved.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
  EXPECT_THROW(dump(1.0), IoError);
  setrlimit(RLIMIT_FSIZE, &saved);
  signal(SIGXFSZ, handler);
  EXPECT_EQ(series.series().written(), 1);
  EXPECT_EQ(read_file(folder.path() / "points.xmf2"), index);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path() / "points"), fs::directory_iterator{}), 1);
}

TEST(Particles, SizeEstimateCountsWhatIsWritten) {
  std::vector<FieldSpec> const specs{
      {"position", "m", 3, ""}, {"body", "1", 1, ""}, {"identity", "1", 1, ""}, {"stress", "Pa", 6, ""}};
  EXPECT_EQ(ParticleSeries::bytes_per_dump(10.0, specs, true), 10.0 * (12 + 4 + 8 + 24));
  EXPECT_EQ(ParticleSeries::bytes_per_dump(10.0, specs, false), 10.0 * (24 + 4 + 8 + 48));
}

TEST(Particles, DumpedFieldsHoldTheStandingOnesOnce) {
  auto setup = run::two_blocks();
  setup.output.particle_fields = {"mises", "body", "mises"};
  std::vector<std::string> names;
  EXPECT_TRUE(dumped_fields(setup, IsLast::yes).empty());  // no gas
  for (auto const& spec : dumped_particle_fields(setup)) names.push_back(spec.name);
  EXPECT_EQ(names, (std::vector<std::string>{"position", "body", "material", "mises"}));
  setup.output.particle_fields = {"misses"};
  EXPECT_THROW((void)dumped_particle_fields(setup), InputError);
}

TEST(Particles, SameBytesForAnyNumberOfThreads) {
  std::map<std::string, std::string> reference;
  for (int const count : {1, 2, 4}) {
    set_threads(count);
    observe::Watched world(run::two_blocks());
    ScratchFolder folder;
    write_run(world, folder.path(), 40);
    std::map<std::string, std::string> written;
    for (auto const& entry : fs::recursive_directory_iterator(folder.path())) {
      // The log tells the time of day and the speed.
      if (entry.is_regular_file() && entry.path().filename() != "run.json")
        written[fs::relative(entry.path(), folder.path())] = read_file(entry.path());
    }
    EXPECT_EQ(written.size(), 10U);
    if (reference.empty()) reference = written;
    ASSERT_EQ(written.size(), reference.size());
    for (auto const& [name, content] : written)
      EXPECT_TRUE(content == reference[name]) << name << ", " << count << " threads";
  }
  set_threads(0);
}

TEST(Particles, ReportIsWritten) {
  if (std::system(BRISANCE_PYTHON_EXECUTABLE " -c 'import h5py, matplotlib' 2>/dev/null") != 0)
    GTEST_SKIP() << "python3-h5py or python3-matplotlib is not installed";
  observe::Watched world(run::two_blocks());
  ScratchFolder folder;
  write_run(world, folder.path(), 25);
  auto const html = read_file(write_report(folder.path()));
  for (char const* part : {"two blocks", "material points", ">Bodies<", ">Energies<", "</html>"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace brisance::output::test
