#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "output/fields.hpp"
#include "output/file.hpp"
#include "read_numbers.hpp"
#include "scratch.hpp"

namespace brisance::output::test {
namespace {

namespace fs = std::filesystem;

std::vector<FieldSpec> const specs{{"pressure", "Pa", 1, "pressure"}, {"velocity", "m/s", 3, "velocity"}};

grid::Grid small_grid(Index3 cells, grid::Geometry geometry = grid::Geometry::cartesian3d, int block_cells = 4) {
  grid::Domain domain;
  domain.geometry = geometry;
  domain.lower = {1.0, -2.0, 3.0};
  domain.h = 0.125;
  domain.cells = cells;
  return grid::Grid(domain, block_cells);
}

/// A value that tells every cell, component and time apart; exact in single precision.
double value_of(Index3 const& cell, int component, int time) {
  return cell[0] + 32.0 * cell[1] + 1024.0 * cell[2] + 0.25 * component + 65536.0 * time;
}

RowValues numbered(grid::Grid const& grid, std::vector<FieldSpec> const& fields, int time) {
  return [&grid, &fields, time](grid::Cell const& first, int count, double* out) {
    grid::Cell cell = first;
    for (int n = 0; n < count; ++n, ++cell.i, ++cell.offset) {
      for (FieldSpec const& field : fields) {
        for (int c = 0; c < field.components; ++c) *out++ = value_of(grid.index(cell), c, time);
      }
    }
  };
}

struct Variant {
  char const* name;
  Index3 cells;
  grid::Geometry geometry;
  FieldOptions options;
};

std::string name_of(testing::TestParamInfo<Variant> const& info) { return info.param.name; }

void PrintTo(Variant const& variant, std::ostream* out) { *out << variant.name; }

class FieldsRoundTrip : public testing::TestWithParam<Variant> {};

TEST_P(FieldsRoundTrip, EveryCellOfEveryBlockComesBack) {
  auto const& variant = GetParam();
  auto const grid = small_grid(variant.cells, variant.geometry);
  ASSERT_GT(grid.block_count(), 1);
  ScratchFolder folder;
  FieldSeries series(folder.path(), variant.options);
  series.dump(2.5e-4, 7, grid, specs, numbered(grid, specs, 1)).write();

  fs::path const file = folder.path() / "fields/fields_000000.h5";
  auto const pressure = read_numbers(file, "/cells/pressure");
  auto const velocity = read_numbers(file, "/cells/velocity");
  ASSERT_EQ(pressure.size(), std::size_t(grid.domain().cell_count()));
  ASSERT_EQ(velocity.size(), 3 * pressure.size());
  std::size_t at = 0;
  for (int k = 0; k < variant.cells[2]; ++k)
    for (int j = 0; j < variant.cells[1]; ++j)
      for (int i = 0; i < variant.cells[0]; ++i, ++at) {
        ASSERT_EQ(pressure[at], value_of({i, j, k}, 0, 1));
        for (int c = 0; c < 3; ++c) ASSERT_EQ(velocity[3 * at + c], value_of({i, j, k}, c, 1));
      }
}

INSTANTIATE_TEST_SUITE_P(Fields, FieldsRoundTrip,
                         testing::Values(Variant{"single_3d", {9, 6, 5}, grid::Geometry::cartesian3d, {true, 1}},
                                         Variant{"double_3d", {9, 6, 5}, grid::Geometry::cartesian3d, {false, 2}},
                                         Variant{
                                             "several_chunks", {130, 68, 6}, grid::Geometry::cartesian3d, {false, 4}},
                                         Variant{"axisymmetric", {10, 7, 1}, grid::Geometry::axisymmetric2d, {true, 9}},
                                         Variant{"spherical", {17, 1, 1}, grid::Geometry::spherical1d, {false, 1}}),
                         name_of);

TEST(Fields, IndexListsEveryDumpWithItsTime) {
  ScratchFolder folder;
  auto const grid = small_grid({8, 8, 8});
  FieldSeries series(folder.path(), {});
  series.dump(0.0, 0, grid, specs, numbered(grid, specs, 0)).write();
  series.dump(1.0 / 3.0, 5, grid, specs, numbered(grid, specs, 1)).write();
  EXPECT_EQ(series.series().count(), 2);
  EXPECT_EQ(series.series().written(), 2);
  auto const index = read_file(folder.path() / "fields.xmf2");
  EXPECT_NE(index.find("<Time Value=\"0\"/>"), std::string::npos) << index;
  EXPECT_NE(index.find("<Time Value=\"0.3333333333333333\"/>"), std::string::npos) << index;
  EXPECT_NE(index.find("fields/fields_000001.h5:/cells/velocity"), std::string::npos);
  EXPECT_NE(index.find("Dimensions=\"9 9 9\""), std::string::npos);
  EXPECT_NE(index.find("</Xdmf>"), std::string::npos);
  for (auto const& entry : fs::recursive_directory_iterator(folder.path()))
    EXPECT_NE(entry.path().extension(), ".part") << "a temporary file is left: " << entry.path();
}

TEST(Fields, H5pyReadsAttributesUnitsAndShape) {
  ScratchFolder folder;
  auto const grid = small_grid({9, 6, 5});
  FieldSeries(folder.path(), {}).dump(2.5e-4, 7, grid, specs, numbered(grid, specs, 0)).write();
  std::string const script =
      "import h5py, json, sys; f = h5py.File(sys.argv[1], 'r'); d = f['cells/velocity']; "
      "text = lambda v: v.decode() if isinstance(v, bytes) else str(v); "
      "print(json.dumps(dict(time=float(f.attrs['time']), step=int(f.attrs['step']), "
      "geometry=text(f.attrs['geometry']), origin=list(f.attrs['origin']), spacing=float(f.attrs['spacing']), "
      "cells=[int(n) for n in f.attrs['cells']], shape=d.shape, type=str(d.dtype), unit=text(d.attrs['unit']), "
      "sample=float(d[4, 3, 2, 1]))))";
  std::string const python = BRISANCE_PYTHON_EXECUTABLE;
  if (std::system((python + " -c 'import h5py' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "python3-h5py is not installed";
  auto const seen = nlohmann::json::parse(
      output_of(python + " -c \"" + script + "\" " + (folder.path() / "fields/fields_000000.h5").string()));
  EXPECT_EQ(seen["time"], 2.5e-4);
  EXPECT_EQ(seen["step"], 7);
  EXPECT_EQ(seen["geometry"], "cartesian3d");
  EXPECT_EQ(seen["origin"], (std::vector{1.0, -2.0, 3.0}));
  EXPECT_EQ(seen["spacing"], 0.125);
  EXPECT_EQ(seen["cells"], (std::vector{9, 6, 5}));
  EXPECT_EQ(seen["shape"], (std::vector{5, 6, 9, 3}));
  EXPECT_EQ(seen["type"], "float32");
  EXPECT_EQ(seen["unit"], "m/s");
  EXPECT_EQ(seen["sample"], value_of({2, 3, 4}, 1, 0));
}

class ParaView : public testing::TestWithParam<Variant> {};

TEST_P(ParaView, OpensTheSeriesWithItsTimesWithoutAsking) {
  std::string const pvpython = BRISANCE_PVPYTHON;
  if (pvpython.empty()) GTEST_SKIP() << "pvpython was not found when the tests were configured: ParaView is not tested";
  auto const& [name, cells, geometry, options] = GetParam();
  ScratchFolder folder;
  auto const grid = small_grid(cells, geometry);
  FieldSeries series(folder.path(), options);
  std::vector const times{0.0, 1.25e-4, 5e-4};
  for (int t = 0; t < 3; ++t) series.dump(times[t], t, grid, specs, numbered(grid, specs, t)).write();

  // From another working directory: the index must find the dumps by its own place. ParaView reports unrelated start-up
  // trouble on standard error.
  auto const out = output_of("cd / && " + pvpython + " " TEST_SCRIPT_DIR "/open_in_paraview.py " +
                             (folder.path() / "fields.xmf2").string() + " 2>/dev/null");
  auto const line = out.rfind("{\"readers\"");
  ASSERT_NE(line, std::string::npos) << out;
  auto const seen = nlohmann::json::parse(out.substr(line));
  EXPECT_EQ(seen["readers"], 1) << "ParaView would ask which reader to use";
  EXPECT_EQ(seen["times"], times);
  for (int t = 0; t < 3; ++t) {
    auto const& step = seen["steps"][t];
    EXPECT_EQ(step["cells"], grid.domain().cell_count());
    for (int d = 0; d < 3; ++d) {
      EXPECT_NEAR(step["bounds"][2 * d].get<double>(), grid.domain().lower[d], 1e-12);
      EXPECT_NEAR(step["bounds"][2 * d + 1].get<double>(), grid.domain().upper(d), 1e-12);
    }
    Index3 const last{cells[0] - 1, cells[1] - 1, cells[2] - 1};
    EXPECT_EQ(step["arrays"]["pressure"]["components"], 1);
    EXPECT_EQ(step["arrays"]["pressure"]["first"][0], value_of({0, 0, 0}, 0, t));
    EXPECT_EQ(step["arrays"]["pressure"]["last"][0], value_of(last, 0, t));
    EXPECT_EQ(step["arrays"]["velocity"]["components"], 3);
    EXPECT_EQ(step["arrays"]["velocity"]["last"][2], value_of(last, 2, t));
  }
}

INSTANTIATE_TEST_SUITE_P(Fields, ParaView,
                         testing::Values(Variant{"cartesian", {9, 6, 5}, grid::Geometry::cartesian3d, {true, 1}},
                                         Variant{
                                             "axisymmetric", {10, 7, 1}, grid::Geometry::axisymmetric2d, {false, 1}},
                                         Variant{"spherical", {17, 1, 1}, grid::Geometry::spherical1d, {true, 1}}),
                         name_of);

/// No file of this process may grow beyond the limit while this object lives: what a full disk does to a write.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : signal_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &saved_);
    rlimit const limit{bytes, saved_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &saved_);
    signal(SIGXFSZ, signal_);
  }
  FileSizeLimit(FileSizeLimit const&) = delete;
  FileSizeLimit& operator=(FileSizeLimit const&) = delete;

 private:
  rlimit saved_{};
  sighandler_t signal_;
};

TEST(Fields, FailedWriteIsAnErrorNamingTheFileAndLeavesTheSeriesIntact) {
  auto const grid = small_grid({32, 32, 32}, grid::Geometry::cartesian3d, 16);
  ScratchFolder folder;
  FieldSeries series(folder.path(), {false, 1});
  series.dump(0.0, 0, grid, specs, numbered(grid, specs, 0)).write();
  auto const index = read_file(folder.path() / "fields.xmf2");
  auto const second = [&](DumpPlace place) {
    return series.dump(1.0, 1, grid, specs, numbered(grid, specs, 1), place);
  };
  DumpPlace place = DumpPlace::next;
  for (rlim_t const limit : {rlim_t{100}, rlim_t{5000}}) {
    try {
      FileSizeLimit const full(limit);
      second(place).write();
      FAIL() << "the failed write went unnoticed";
    } catch (IoError const& error) {
      std::string const message = error.what();
      EXPECT_NE(message.find("fields/fields_000001.h5"), std::string::npos) << message;
      EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    }
    place = DumpPlace::again;
  }
  EXPECT_EQ(series.series().written(), 1);
  EXPECT_EQ(read_file(folder.path() / "fields.xmf2"), index);
  EXPECT_FALSE(fs::exists(folder.path() / "fields/fields_000001.h5"));
  EXPECT_FALSE(fs::exists(folder.path() / "fields/fields_000001.h5.part"));
  // The library must be usable afterwards.
  second(DumpPlace::again).write();
  EXPECT_EQ(series.series().written(), 2);
  EXPECT_EQ(read_numbers(folder.path() / "fields/fields_000001.h5", "/cells/pressure").front(),
            value_of({0, 0, 0}, 0, 1));
}

TEST(Fields, DumpInPlaceOfTheLastReplacesItInFileAndIndex) {
  auto const grid = small_grid({8, 8, 8});
  ScratchFolder folder;
  FieldSeries series(folder.path(), {});
  series.dump(0.0, 0, grid, specs, numbered(grid, specs, 0)).write();
  std::vector<FieldSpec> const one{specs.front()};
  series.dump(0.5, 1, grid, one, numbered(grid, one, 1)).write();
  series.dump(0.5, 1, grid, specs, numbered(grid, specs, 1), DumpPlace::again).write();
  EXPECT_EQ(series.series().written(), 2);
  EXPECT_FALSE(fs::exists(folder.path() / "fields/fields_000002.h5"));

  ScratchFolder other;
  FieldSeries whole(other.path(), {});
  for (int t = 0; t < 2; ++t) whole.dump(0.5 * t, t, grid, specs, numbered(grid, specs, t)).write();
  for (char const* name : {"fields.xmf2", "fields/fields_000001.h5", "files.txt"})
    EXPECT_EQ(read_file(folder.path() / name), read_file(other.path() / name)) << name;
}

TEST(Fields, UnwritablePlaceIsAnError) {
  auto const grid = small_grid({8, 8, 8});
  FieldSeries series("/proc/nowhere", {});
  EXPECT_THROW(series.dump(0.0, 0, grid, specs, numbered(grid, specs, 0)).write(), IoError);
}

TEST(Fields, SizeEstimateCountsComponents) {
  auto const grid = small_grid({9, 6, 5});
  EXPECT_EQ(FieldSeries::bytes_per_dump(grid.domain(), specs, true), 270 * 4 * 4.0);
  EXPECT_EQ(FieldSeries::bytes_per_dump(grid.domain(), specs, false), 270 * 4 * 8.0);
}

}  // namespace
}  // namespace brisance::output::test
