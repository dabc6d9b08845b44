// Dumps of cells of several sizes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/parallel.hpp"
#include "level_grid.hpp"
#include "output/fields.hpp"
#include "output/file.hpp"
#include "output/manifest.hpp"
#include "output/particles.hpp"
#include "scratch.hpp"

namespace brisance::output::test {
namespace {

namespace fs = std::filesystem;
using grid::Geometry;
using nlohmann::json;

class LevelFields : public testing::TestWithParam<Geometry> {
 protected:
  void SetUp() override {
    if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  }
};

TEST_P(LevelFields, HoldEveryCellOfEveryLeafOnce) {
  grid::Grid const grid = levels_grid(GetParam());
  ASSERT_EQ(grid.levels(), 3);
  ScratchFolder folder;
  FieldSeries series(folder.path(), {}, DumpForm::vtkhdf);
  series.dump(2.5e-4, 7, grid, specs, values_on(grid, 1)).write();
  fs::path const file = folder.path() / "fields/fields_000000.hdf";
  double seen = 0.0;
  double volume = 0.0;
  for (int level = 0; level < 3; ++level) {
    std::string const group = "/VTKHDF/Level" + std::to_string(level);
    auto const boxes = read_numbers(file, group + "/AMRBox");
    auto const pressure = read_numbers(file, group + "/CellData/pressure");
    auto const velocity = read_numbers(file, group + "/CellData/velocity");
    auto const levels = read_numbers(file, group + "/CellData/level");
    std::size_t at = 0;
    for (std::size_t b = 0; b < boxes.size(); b += 6) {
      grid::CellRange box;
      for (int d = 0; d < 3; ++d) {
        box.lower[d] = static_cast<int>(boxes[b + 2 * d]);
        box.upper[d] = static_cast<int>(boxes[b + 2 * d + 1]) + 1;
      }
      for_each_cell(box, [&](Index3 const& index) {
        auto const cell = grid.locate(level, index);
        ASSERT_TRUE(cell);
        ASSERT_FALSE(grid.block(*cell).covered);
        Vec3 const x = grid.block(*cell).centre(*cell);
        ASSERT_EQ(pressure[at], pressure_at(x, 1));
        for (int d = 0; d < 3; ++d) ASSERT_EQ(velocity[3 * at + d], x[d]);
        ASSERT_EQ(levels[at], level);
        volume += std::pow(std::ldexp(0.25, -level), grid.domain().dimensions());
        ++at;
      });
    }
    EXPECT_EQ(at, pressure.size());
    seen += static_cast<double>(at);
  }
  EXPECT_EQ(seen, leaf_cells(grid));
  grid::Domain const& domain = grid.domain();
  EXPECT_DOUBLE_EQ(volume, static_cast<double>(domain.cell_count()) * std::pow(0.25, domain.dimensions()));
}

/// Integral over what the linear pressure has in the middle, which is exact.
double whole_pressure(grid::Grid const& grid, int time, double* volume) {
  grid::Domain const& domain = grid.domain();
  *volume = 1.0;
  Vec3 middle{0.0, 0.0, 0.0};
  for (int d = 0; d < 3; ++d) {
    *volume *= domain.upper(d) - domain.lower[d];
    middle[d] = 0.5 * (domain.lower[d] + domain.upper(d));
  }
  if (domain.dimensions() < 3) {
    // Cells of finer levels count their own size along the direction that is not resolved.
    double sum = 0.0;
    for (grid::Block const& block : grid.blocks()) {
      for_each_cell(block, [&](grid::Cell const& cell) {
        if (block.is_covered(cell)) return;
        sum += pressure_at(block.centre(cell), time) * block.h() * block.h() * domain.h;
      });
    }
    return sum;
  }
  return pressure_at(middle, time) * *volume;
}

TEST_P(LevelFields, OpenInParaViewWithValuesLevelsAndTimesBesidePoints) {
  std::string const pvpython = BRISANCE_PVPYTHON;
  if (pvpython.empty()) GTEST_SKIP() << "pvpython was not found when the tests were configured: ParaView is not tested";
  ScratchFolder folder;
  // From one level to three, and to one without cells of level 0.
  std::vector<grid::Grid> grids;
  grids.push_back(levels_grid(GetParam(), 0));
  grids.push_back(levels_grid(GetParam(), 2));
  grids.push_back(levels_grid(GetParam(), 1, true));
  std::vector const times{0.0, 1.25e-4, 1.0 / 3.0};
  FieldSeries series(folder.path(), {}, DumpForm::vtkhdf);
  ParticleSeries points(folder.path(), {});
  std::vector<FieldSpec> const of_points{{"position", "m", 3, "position"}};
  for (int t = 0; t < 3; ++t) {
    series.dump(times[t], t, grids[t], specs, values_on(grids[t], t)).write();
    points
        .dump(times[t], t, GetParam(), 5 + t, of_points,
              [t](std::string const&, std::vector<double>& out) { out.assign(std::size_t(3 * (5 + t)), 1.5); })
        .write();
    ASSERT_EQ(series.series().written(), t + 1);
  }
  auto const out = output_of("cd / && " + pvpython + " " TEST_SCRIPT_DIR "/open_levels_in_paraview.py " +
                             (folder.path() / "fields.hdf.series").string() + " " +
                             (folder.path() / "points.xmf2").string() + " 2>/dev/null");
  auto const line = out.rfind("{\"readers\"");
  ASSERT_NE(line, std::string::npos) << out;
  auto const seen = json::parse(out.substr(line));
  EXPECT_EQ(seen["readers"], 1) << "ParaView would ask which reader to use";
  EXPECT_EQ(seen["times"], times);
  for (int t = 0; t < 3; ++t) {
    grid::Grid const& grid = grids[t];
    json const& step = seen["steps"][t];
    EXPECT_EQ(step["class"], "vtkOverlappingAMR");
    EXPECT_EQ(step["cells"], leaf_cells(grid));
    EXPECT_EQ(step["points"], 5 + t);
    for (int d = 0; d < 3; ++d) {
      EXPECT_NEAR(step["bounds"][2 * d].get<double>(), grid.domain().lower[d], 1e-12);
      EXPECT_NEAR(step["bounds"][2 * d + 1].get<double>(), grid.domain().upper(d), 1e-12);
    }
    int const coarsest = t == 2 ? 1 : 0;
    for (json const& block : step["blocks"]) {
      int const level = block["level"].get<int>() + coarsest;
      ASSERT_LT(level, grid.levels());
      EXPECT_EQ(block["spacing"][0], grid.domain(level).h);
      std::size_t at = 0;
      grid::CellRange const cells{{0, 0, 0}, block["cells"].get<Index3>()};
      for_each_cell(cells, [&](Index3 const& within) {
        Vec3 x{0.0, 0.0, 0.0};
        for (int d = 0; d < 3; ++d)
          x[d] = block["origin"][d].get<double>() + (within[d] + 0.5) * block["spacing"][d].get<double>();
        if (grid.domain().dimensions() < 3) x[2] = grid.domain(level).centre({0, 0, 0})[2];
        ASSERT_EQ(block["values"]["pressure"][at], pressure_at(x, t));
        ASSERT_EQ(block["values"]["level"][at], level);
        ASSERT_EQ(block["values"]["velocity"][at][1], x[1]);
        ++at;
      });
    }
    // What ParaView makes of it: nothing counts twice.
    double volume = 0.0;
    double const pressure = whole_pressure(grid, t, &volume);
    EXPECT_NEAR(step["whole"]["Volume"][0].get<double>() / volume, 1.0, 1e-9);
    EXPECT_NEAR(step["whole"]["pressure"][0].get<double>() / pressure, 1.0, 1e-6);
    double const width = grid.domain().upper(0) - grid.domain().lower[0];
    EXPECT_NEAR(step["slice"]["Area"][0].get<double>() / (volume / width), 1.0, 1e-9);
    EXPECT_NEAR(step["clip"]["Volume"][0].get<double>() / (volume * (0.5 + 0.01 / width)), 1.0, 1e-9);
  }
}

TEST_P(LevelFields, AreReadByThePackage) {
  std::string const python = BRISANCE_PYTHON_EXECUTABLE;
  if (std::system((python + " -c 'import h5py' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "python3-h5py is not installed";
  grid::Grid const grid = levels_grid(GetParam());
  ScratchFolder folder;
  FieldSeries(folder.path(), {}, DumpForm::vtkhdf).dump(2.5e-4, 7, grid, specs, values_on(grid, 1)).write();
  std::string const script =
      "import json, sys; sys.path.insert(0, sys.argv[2]); from brisance.results import LevelDump; "
      "d = LevelDump(sys.argv[1]); finest = d.finest; d.level = 0; "
      "print(json.dumps(dict(time=d.time, step=d.step, geometry=d.geometry, fields=d.fields, finest=finest, "
      "cells=d.cells, cell_count=sum(v.size for _, _, v in d.leaf_values('level')), "
      "values=d.values('pressure').ravel().tolist())))";
  auto const seen =
      json::parse(output_of(python + " -c \"" + script + "\" " + (folder.path() / "fields/fields_000000.hdf").string() +
                            " " TEST_SCRIPT_DIR "/../../python"));
  EXPECT_EQ(seen["time"], 2.5e-4);
  EXPECT_EQ(seen["step"], 7);
  EXPECT_EQ(seen["geometry"], std::string(word_of(GetParam())));
  EXPECT_EQ(seen["fields"], (std::vector<std::string>{"level", "pressure", "velocity"}));
  EXPECT_EQ(seen["finest"], 2);
  EXPECT_EQ(seen["cells"].get<Index3>(), grid.domain().cells);
  EXPECT_EQ(seen["cell_count"], leaf_cells(grid));
  // Means of fine cells are what the linear field has in the coarse one; along z finer cells of planes are none.
  std::size_t at = 0;
  for_each_cell(grid.domain().all_cells(), [&](Index3 const& cell) {
    Vec3 x = grid.domain().centre(cell);
    auto const coarse = grid.locate(0, cell);
    if (grid.domain().dimensions() == 3 || (coarse && !grid.block(*coarse).covered)) {
      EXPECT_NEAR(seen["values"][at].get<double>(), pressure_at(x, 1), 1e-6);
    }
    ++at;
  });
}

TEST_P(LevelFields, AreTheSameBytesForAnyNumberOfThreadsAndInAnotherFolder) {
  grid::Grid const grid = levels_grid(GetParam());
  std::vector<std::string> bytes;
  int const before = threads();
  for (int const count : {1, 2}) {
    set_threads(count);
    ScratchFolder folder;
    FieldSeries series(folder.path(), {}, DumpForm::vtkhdf);
    series.dump(2.5e-4, 7, grid, specs, values_on(grid, 1)).write();
    bytes.push_back(read_file(folder.path() / "fields/fields_000000.hdf"));
  }
  set_threads(before);
  EXPECT_TRUE(bytes[0] == bytes[1]);
}

INSTANTIATE_TEST_SUITE_P(Output, LevelFields,
                         testing::Values(Geometry::planar2d, Geometry::axisymmetric2d, Geometry::cartesian3d),
                         [](auto const& one) { return std::string(word_of(one.param)); });

TEST(LevelSeries, IsAListOfFilesAndTimesThatAnArchiveCutsShort) {
  if (!grid::Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  grid::Grid const grid = levels_grid(Geometry::planar2d);
  ScratchFolder folder;
  FieldSeries series(folder.path(), {}, DumpForm::vtkhdf);
  auto const dump = [&](FieldSeries& to, double time, DumpPlace place = DumpPlace::next) {
    to.dump(time, 0, grid, specs, values_on(grid, 0), place).write();
  };
  auto const list = [&] { return json::parse(read_file(folder.path() / "fields.hdf.series")); };
  dump(series, 0.0);
  dump(series, 1.0 / 3.0);
  dump(series, 1.0 / 3.0, DumpPlace::again);
  EXPECT_EQ(list()["file-series-version"], "1.0");
  ASSERT_EQ(list()["files"].size(), 2U);
  EXPECT_EQ(list()["files"][1]["name"], "fields/fields_000001.hdf");
  EXPECT_EQ(list()["files"][1]["time"], 1.0 / 3.0);
  EXPECT_TRUE(listed_files(folder.path()).contains("fields/fields_000001.hdf"));

  std::string state;
  Archive out([&](void const* bytes, std::size_t count) { state.append(static_cast<char const*>(bytes), count); });
  series.archive(out);
  std::string const before = read_file(folder.path() / "fields.hdf.series");
  dump(series, 0.5);
  ASSERT_EQ(list()["files"].size(), 3U);
  FieldSeries resumed(folder.path(), {}, DumpForm::vtkhdf);
  std::size_t at = 0;
  Archive in(
      [&](void* bytes, std::size_t count) {
        std::memcpy(bytes, state.data() + at, count);
        at += count;
      },
      state.size());
  resumed.archive(in);
  EXPECT_EQ(read_file(folder.path() / "fields.hdf.series"), before);
  EXPECT_FALSE(fs::exists(folder.path() / "fields/fields_000002.hdf"));
  dump(resumed, 0.75);
  EXPECT_EQ(list()["files"][2]["time"], 0.75);
}

TEST(LevelSeries, HaveNamesThatAreToldFromOthers) {
  EXPECT_EQ(dump_name("fields", 12, DumpForm::vtkhdf), "fields/fields_000012.hdf");
  EXPECT_EQ(dump_number("fields", "fields/fields_000012.hdf", DumpForm::vtkhdf), 12);
  EXPECT_EQ(dump_number("fields", "fields/fields_000012.hdf"), std::nullopt);
  EXPECT_EQ(dump_number("fields", "fields/fields_000012.h5", DumpForm::vtkhdf), std::nullopt);
  EXPECT_EQ(index_name("fields", DumpForm::vtkhdf), "fields.hdf.series");
}

}  // namespace
}  // namespace brisance::output::test
