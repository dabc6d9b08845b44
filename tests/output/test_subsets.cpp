// Planes and boxes of the field output: their cells, their means, and what ParaView makes of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>
#include <variant>

#include "core/parallel.hpp"
#include "level_grid.hpp"
#include "output/file.hpp"
#include "output/level_fields.hpp"
#include "output/plane_fields.hpp"
#include "scratch.hpp"

namespace brisance::output::test {
namespace {

namespace fs = std::filesystem;
using grid::Geometry;
using nlohmann::json;

constexpr int finest = 2;
FieldOptions const doubles{.single_precision = false};

/// Differs from cell to cell, so that a mean tells whether each of its cells counts once.
double rough_at(Vec3 const& x) { return 2.0 + std::sin(40.0 * x[0] + 23.0 * x[1] + 17.0 * x[2]); }

std::vector<FieldSpec> const rough_specs{{"density", "kg/m3", 1, "density"}, {"velocity", "m/s", 3, "velocity"}};

RowValues rough_on(grid::Grid const& grid) {
  return [&grid](grid::Cell const& first, int count, double* out) {
    grid::Cell cell = first;
    for (int n = 0; n < count; ++n, ++cell.i, ++cell.offset) {
      Vec3 const x = grid.block(first).centre(cell);
      *out++ = rough_at(x);
      for (int d = 0; d < 3; ++d) *out++ = x[d];
    }
  };
}

run::FieldSubset subset_of(std::variant<run::Plane, shape::Box> place, std::optional<int> level = {}) {
  run::FieldSubset subset;
  subset.name = "part";
  subset.place = place;
  subset.level = level;
  return subset;
}

/// Geometry; cells of several sizes.
using Kind = std::tuple<Geometry, bool>;

class Subset : public testing::TestWithParam<Kind> {
 protected:
  void SetUp() override {
    if (std::get<1>(GetParam()) && !grid::Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  }
  [[nodiscard]] static Geometry geometry() { return std::get<0>(GetParam()); }
  [[nodiscard]] static int dims() { return grid::dimensions(geometry()); }
  [[nodiscard]] static int deepest() { return std::get<1>(GetParam()) ? finest : 0; }
  [[nodiscard]] static grid::Grid make_grid() {
    return std::get<1>(GetParam()) ? levels_grid(geometry()) : grid::Grid(domain_of(geometry()), 8);
  }
  /// Within the domain, and across cells of all levels.
  [[nodiscard]] static run::FieldSubset box(std::optional<int> level) {
    return subset_of(shape::Box{{2.1, -0.9, 4.1}, {4.45, 2.95, 6.9}}, level);
  }
  [[nodiscard]] static run::FieldSubset plane(int normal, double at, std::optional<int> level) {
    return subset_of(run::Plane{normal, at}, level);
  }
};

/// A cell as a file shows it.
struct Seen {
  Vec3 lower;
  Vec3 upper;
  double density = 0.0;
  Vec3 velocity{0.0, 0.0, 0.0};
};

std::string file_of(ScratchFolder const& folder) { return (folder.path() / "dump.hdf").string(); }

std::vector<Seen> cells_of_box(ScratchFolder const& folder, grid::Grid const& grid, observe::SubsetCells const& shown) {
  box_dump({2.5e-4, 7}, grid, shown, rough_specs, doubles, rough_on(grid))->write(file_of(folder));
  std::vector<Seen> cells;
  grid::Domain const box = shown.shown();
  int levels = 0;
  for (int level = 0; level <= finest; ++level) {
    std::string const group = "/VTKHDF/Level" + std::to_string(level);
    hid_t const file = H5Fopen(file_of(folder).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    bool const there = H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0;
    double spacing[3] = {0.0, 0.0, 0.0};
    if (there) {
      hid_t const own = H5Oopen(file, group.c_str(), H5P_DEFAULT);
      hid_t const attribute = H5Aopen(own, "Spacing", H5P_DEFAULT);
      H5Aread(attribute, H5T_NATIVE_DOUBLE, spacing);
      H5Aclose(attribute);
      H5Oclose(own);
    }
    H5Fclose(file);
    if (!there) continue;
    EXPECT_EQ(levels++, level) << "a gap";
    auto const bounds = read_numbers(file_of(folder), group + "/AMRBox");
    auto const density = read_numbers(file_of(folder), group + "/CellData/density");
    auto const velocity = read_numbers(file_of(folder), group + "/CellData/velocity");
    std::size_t at = 0;
    for (std::size_t b = 0; b < bounds.size(); b += 6) {
      grid::CellRange range;
      for (int d = 0; d < 3; ++d) {
        range.lower[d] = static_cast<int>(bounds[b + 2 * d]);
        range.upper[d] = static_cast<int>(bounds[b + 2 * d + 1]) + 1;
      }
      for_each_cell(range, [&](Index3 const& index) {
        Seen cell;
        for (int d = 0; d < 3; ++d) {
          cell.lower[d] = box.lower[d] + index[d] * spacing[d];
          cell.upper[d] = box.lower[d] + (index[d] + 1) * spacing[d];
        }
        cell.density = density.at(at);
        for (int d = 0; d < 3; ++d) cell.velocity[d] = velocity.at(3 * at + d);
        cells.push_back(cell);
        ++at;
      });
    }
    EXPECT_EQ(at, density.size());
  }
  return cells;
}

/// Squares or lines; along the normal they have no thickness.
std::vector<Seen> cells_of_plane(ScratchFolder const& folder, grid::Grid const& grid, observe::SubsetCells const& shown,
                                 double at) {
  plane_dump({2.5e-4, 7}, grid, shown, at, rough_specs, doubles, rough_on(grid))->write(file_of(folder));
  auto const read = [&](char const* name) { return read_numbers(file_of(folder), std::string("/VTKHDF/") + name); };
  auto const points = read("Points");
  auto const connectivity = read("Connectivity");
  auto const offsets = read("Offsets");
  auto const density = read("CellData/density");
  auto const velocity = read("CellData/velocity");
  EXPECT_EQ(read("NumberOfPoints")[0], points.size() / 3);
  EXPECT_EQ(read("NumberOfCells")[0], density.size());
  EXPECT_EQ(read("NumberOfConnectivityIds")[0], connectivity.size());
  EXPECT_EQ(read("Types"), std::vector<double>(density.size(), grid.domain().dimensions() == 3 ? 9.0 : 3.0));
  std::vector<Seen> cells;
  for (std::size_t n = 0; n < density.size(); ++n) {
    Seen cell{{1e9, 1e9, 1e9}, {-1e9, -1e9, -1e9}, density[n], {0.0, 0.0, 0.0}};
    for (int d = 0; d < 3; ++d) cell.velocity[d] = velocity[3 * n + d];
    for (auto c = static_cast<std::size_t>(offsets[n]); c < static_cast<std::size_t>(offsets[n + 1]); ++c) {
      for (int d = 0; d < 3; ++d) {
        double const x = points[3 * static_cast<std::size_t>(connectivity[c]) + d];
        cell.lower[d] = std::min(cell.lower[d], x);
        cell.upper[d] = std::max(cell.upper[d], x);
      }
    }
    cells.push_back(cell);
  }
  return cells;
}

/// The mean over the leaves' cells whose centres lie in a part of space, weighted by volume, and how many they are.
std::tuple<double, Vec3, int> mean_in(grid::Grid const& grid, Vec3 const& lower, Vec3 const& upper) {
  double density = 0.0;
  Vec3 velocity{0.0, 0.0, 0.0};
  double volume = 0.0;
  int count = 0;
  for (grid::Block const& block : grid.blocks()) {
    for_each_cell(block, [&](grid::Cell const& cell) {
      if (block.is_covered(cell)) return;
      Vec3 const x = block.centre(cell);
      for (int d = 0; d < grid.domain().dimensions(); ++d) {
        if (x[d] < lower[d] || x[d] > upper[d]) return;
      }
      double const own = block.volume(cell);
      density += own * rough_at(x);
      velocity = velocity + own * x;
      volume += own;
      ++count;
    });
  }
  return {density / volume, (1.0 / volume) * velocity, count};
}

void expect_means(grid::Grid const& grid, std::vector<Seen> const& cells, int least) {
  int merged = 0;
  for (Seen const& cell : cells) {
    auto const [density, velocity, count] = mean_in(grid, cell.lower, cell.upper);
    ASSERT_GT(count, 0);
    ASSERT_NEAR(cell.density, density, 1e-13);
    for (int d = 0; d < 3; ++d) ASSERT_NEAR(cell.velocity[d], velocity[d], 1e-13);
    merged += count > 1 ? 1 : 0;
  }
  EXPECT_GE(merged, least);
}

double measure(Seen const& cell, int dims, int without = -1) {
  double product = 1.0;
  for (int d = 0; d < dims; ++d) product *= d == without ? 1.0 : cell.upper[d] - cell.lower[d];
  return product;
}

TEST_P(Subset, BoxHoldsTheLeavesInItAsTheyAre) {
  grid::Grid const grid = make_grid();
  observe::SubsetCells const shown(box({}), grid.domain(), deepest());
  ScratchFolder folder;
  auto const cells = cells_of_box(folder, grid, shown);
  // Whole cells of 0.25 m around the box.
  Vec3 const lower{2.0, -1.0, 4.0};
  Vec3 const upper{4.5, 3.0, 7.0};
  double volume = 0.0;
  std::map<double, int> sizes;
  std::vector<Seen> merged;
  for (Seen const& cell : cells) {
    volume += measure(cell, dims());
    ++sizes[cell.upper[0] - cell.lower[0]];
    grid::Cell const leaf = grid.locate(0.5 * (cell.lower + cell.upper));
    if (cell.upper[0] - cell.lower[0] == grid.block(leaf).h()) {
      Vec3 const x = grid.block(leaf).centre(leaf);
      ASSERT_EQ(cell.density, rough_at(x));
      for (int d = 0; d < 3; ++d) ASSERT_EQ(cell.velocity[d], x[d]);
    } else {
      merged.push_back(cell);
    }
    for (int d = 0; d < dims(); ++d) ASSERT_TRUE(cell.lower[d] >= lower[d] && cell.upper[d] <= upper[d]);
  }
  // Those that let a level enclose the next finer one.
  EXPECT_LE(merged.size(), 2U * dims() * deepest());
  expect_means(grid, merged, static_cast<int>(merged.size()));
  EXPECT_EQ(sizes.size(), static_cast<std::size_t>(deepest() + 1)) << "the box should cross all levels";
  EXPECT_DOUBLE_EQ(volume, 2.5 * 4.0 * (dims() == 3 ? 3.0 : 1.0));
}

TEST_P(Subset, BoxOfLargerCellsHoldsTheirMeans) {
  grid::Grid const grid = make_grid();
  for (int const level : {1, 0, -1, -2}) {
    if (level > deepest()) continue;
    // Cells of level -2 do not end with the domain: this box ends before.
    observe::SubsetCells const shown(box(level), grid.domain(), deepest());
    ASSERT_EQ(shown.direction_beyond(), -1) << level;
    ScratchFolder folder;
    auto const cells = cells_of_box(folder, grid, shown);
    expect_means(grid, cells, level < deepest() ? 4 : 0);
    double volume = 0.0;
    double mass = 0.0;
    double const h = std::ldexp(0.25, -level);
    Vec3 lower = cells.front().lower;
    Vec3 upper = cells.front().upper;
    for (Seen const& cell : cells) {
      ASSERT_GE(cell.upper[0] - cell.lower[0], h);
      volume += measure(cell, dims());
      auto const radius = 0.5 * (cell.lower[0] + cell.upper[0]);
      mass += cell.density * measure(cell, dims()) * (geometry() == Geometry::axisymmetric2d ? radius : 1.0);
      for (int d = 0; d < dims(); ++d) {
        lower[d] = std::min(lower[d], cell.lower[d]);
        upper[d] = std::max(upper[d], cell.upper[d]);
      }
    }
    grid::Domain const box = shown.shown();
    double whole = 1.0;
    for (int d = 0; d < dims(); ++d) {
      EXPECT_DOUBLE_EQ(lower[d], box.lower[d]);
      EXPECT_DOUBLE_EQ(upper[d], box.upper(d));
      whole *= upper[d] - lower[d];
    }
    EXPECT_DOUBLE_EQ(volume, whole);
    // Nothing of the density is lost.
    double exact = 0.0;
    for (grid::Block const& block : grid.blocks()) {
      for_each_cell(block, [&](grid::Cell const& cell) {
        if (block.is_covered(cell)) return;
        Vec3 const x = block.centre(cell);
        for (int d = 0; d < dims(); ++d) {
          if (x[d] < lower[d] || x[d] > upper[d]) return;
        }
        exact += rough_at(x) * std::pow(block.h(), dims()) * (geometry() == Geometry::axisymmetric2d ? x[0] : 1.0);
      });
    }
    EXPECT_NEAR(mass / exact, 1.0, 1e-12) << level;
  }
}

TEST_P(Subset, PlaneHoldsTheCellsThatItCuts) {
  grid::Grid const grid = make_grid();
  for (int normal = 0; normal < dims(); ++normal) {
    // Within cells, on the face between two, and at both ends of the domain.
    double const low = grid.domain().lower[normal];
    double const high = grid.domain().upper(normal);
    for (double const at : {low + 2.13, low + 2.25, low, high}) {
      observe::SubsetCells const shown(plane(normal, at, {}), grid.domain(), deepest());
      ScratchFolder folder;
      auto const cells = cells_of_plane(folder, grid, shown, at);
      double area = 0.0;
      for (Seen const& cell : cells) {
        area += measure(cell, dims(), normal);
        ASSERT_EQ(cell.lower[normal], at);
        ASSERT_EQ(cell.upper[normal], at);
        Vec3 middle = 0.5 * (cell.lower + cell.upper);
        // On a face it is the upper cell, at the end of the domain the last one.
        middle[normal] = std::min(at + 1e-9, high - 1e-9);
        grid::Cell const leaf = grid.locate(middle);
        Vec3 const x = grid.block(leaf).centre(leaf);
        ASSERT_EQ(cell.density, rough_at(x)) << normal << " " << at;
        for (int d = 0; d < dims(); ++d) ASSERT_EQ(cell.velocity[d], x[d]);
      }
      double whole = 1.0;
      for (int d = 0; d < dims(); ++d) whole *= d == normal ? 1.0 : grid.domain().upper(d) - grid.domain().lower[d];
      EXPECT_DOUBLE_EQ(area, whole);
    }
  }
}

TEST_P(Subset, PlaneOfLargerCellsHoldsTheirMeans) {
  grid::Grid const grid = make_grid();
  for (int const level : {1, 0, -1}) {
    if (level > deepest()) continue;
    double const at = 0.3;
    observe::SubsetCells const shown(plane(1, at, level), grid.domain(), deepest());
    ScratchFolder folder;
    auto cells = cells_of_plane(folder, grid, shown, at);
    // A square stands for the cell that is as large along the normal.
    for (Seen& cell : cells) {
      double const h = cell.upper[0] - cell.lower[0];
      cell.lower[1] = -2.0 + std::floor((at + 2.0) / h) * h;
      cell.upper[1] = cell.lower[1] + h;
    }
    expect_means(grid, cells, level < deepest() ? 4 : 0);
  }
}

TEST_P(Subset, IsTheSameBytesForAnyNumberOfThreads) {
  grid::Grid const grid = make_grid();
  observe::SubsetCells const part(box(-1), grid.domain(), deepest());
  observe::SubsetCells const cut(plane(0, 3.3, {}), grid.domain(), deepest());
  std::vector<std::string> bytes;
  int const before = threads();
  for (int const count : {1, 2}) {
    set_threads(count);
    ScratchFolder folder;
    box_dump({0.0, 0}, grid, part, specs, {}, values_on(grid, 0))->write(folder.path() / "box");
    plane_dump({0.0, 0}, grid, cut, 3.3, specs, {}, values_on(grid, 0))->write(folder.path() / "plane");
    bytes.push_back(read_file(folder.path() / "box") + read_file(folder.path() / "plane"));
  }
  set_threads(before);
  EXPECT_TRUE(bytes[0] == bytes[1]);
}

/// Writes a series of two dumps and returns what ParaView reads of it.
json in_paraview(ScratchFolder const& folder, std::function<std::shared_ptr<Dump>(int)> const& dump) {
  DumpSeries series(folder.path(), "subsets/part", DumpForm::vtkhdf);
  for (int const t : {0, 1}) {
    double const time = t / 3.0;
    series.add(dump(t), DumpPlace::next, [time](auto const& file) { return level_index_entry(file, time); }).write();
  }
  auto const out = output_of("cd / && " BRISANCE_PVPYTHON " " TEST_SCRIPT_DIR "/open_subset_in_paraview.py " +
                             (folder.path() / "subsets/part.hdf.series").string() + " 2>/dev/null");
  auto const line = out.rfind("{\"readers\"");
  if (line == std::string::npos) {
    ADD_FAILURE() << out;
    return {};
  }
  return json::parse(out.substr(line));
}

TEST_P(Subset, OpensInParaView) {
  if (std::string(BRISANCE_PVPYTHON).empty())
    GTEST_SKIP() << "pvpython was not found when the tests were configured: ParaView is not tested";
  grid::Grid const grid = make_grid();
  for (std::optional<int> const level : {std::optional<int>{}, std::optional<int>{-1}}) {
    ScratchFolder folder;
    observe::SubsetCells const part(box(level), grid.domain(), deepest());
    auto const seen = in_paraview(folder, [&](int t) {
      return box_dump({t / 3.0, t}, grid, part, specs, {}, values_on(grid, t));
    });
    ASSERT_FALSE(seen.is_null());
    EXPECT_EQ(seen["readers"], 1);
    EXPECT_EQ(seen["times"], (std::vector{0.0, 1.0 / 3.0}));
    grid::Domain const shown = part.shown();
    double volume = dims() == 3 ? 1.0 : 0.25;  // in 2D ParaView sees cells as thick as those of the domain
    Vec3 middle{0.0, 0.0, grid.domain().lower[2] + 0.125};
    for (int d = 0; d < dims(); ++d) {
      volume *= shown.upper(d) - shown.lower[d];
      middle[d] = 0.5 * (shown.lower[d] + shown.upper(d));
    }
    double cells = 0.0;
    auto levels = leaves_of(grid, part);
    let_levels_enclose_finer_ones(levels, dims());
    for (ShownCells const& one : levels) cells += static_cast<double>(one.count());
    for (int const t : {0, 1}) {
      json const& step = seen["steps"][t];
      EXPECT_EQ(step["class"], "vtkOverlappingAMR");
      EXPECT_EQ(step["cells"], cells);
      EXPECT_NEAR(step["whole"]["Volume"][0].get<double>() / volume, 1.0, 1e-9);
      for (int d = 0; d < dims(); ++d) {
        EXPECT_NEAR(step["bounds"][2 * d].get<double>(), shown.lower[d], 1e-12);
        EXPECT_NEAR(step["bounds"][2 * d + 1].get<double>(), shown.upper(d), 1e-12);
      }
      // Of the linear velocity_y = y, which has the same means in planes, the value at the middle.
      EXPECT_NEAR(step["whole"]["velocity"][1].get<double>() / volume, middle[1], 1e-6);
      if (dims() == 3) {
        EXPECT_NEAR(step["whole"]["pressure"][0].get<double>() / volume / pressure_at(middle, t), 1.0, 1e-6);
      }
    }
  }
}

TEST_P(Subset, PlaneOpensInParaView) {
  if (std::string(BRISANCE_PVPYTHON).empty())
    GTEST_SKIP() << "pvpython was not found when the tests were configured: ParaView is not tested";
  grid::Grid const grid = make_grid();
  ScratchFolder folder;
  observe::SubsetCells const cut(plane(0, 3.3, {}), grid.domain(), deepest());
  auto const seen = in_paraview(folder, [&](int t) {
    return plane_dump({t / 3.0, t}, grid, cut, 3.3, specs, {}, values_on(grid, t));
  });
  ASSERT_FALSE(seen.is_null());
  EXPECT_EQ(seen["readers"], 1);
  EXPECT_EQ(seen["times"], (std::vector{0.0, 1.0 / 3.0}));
  double cells = 0.0;
  for (ShownCells const& one : leaves_of(grid, cut)) cells += static_cast<double>(one.count());
  for (int const t : {0, 1}) {
    json const& step = seen["steps"][t];
    EXPECT_EQ(step["class"], "vtkUnstructuredGrid");
    EXPECT_EQ(step["cells"], cells);
    std::string const of = dims() == 3 ? "Area" : "Length";
    double const area = dims() == 3 ? 5.0 * 5.0 : 5.0;
    EXPECT_NEAR(step["whole"][of][0].get<double>() / area, 1.0, 1e-9);
    EXPECT_NEAR(step["whole"]["velocity"][1].get<double>() / area, 0.5, 1e-6);  // the middle of the domain along y
    for (int const side : {0, 1}) EXPECT_NEAR(step["bounds"][side].get<double>(), 3.3, 1e-12);
    EXPECT_NEAR(step["values"]["pressure"][0].get<double>() - step["values"]["velocity"][0].get<double>() * 1024.0 -
                    step["values"]["velocity"][1].get<double>() * 64.0 -
                    step["values"]["velocity"][2].get<double>() * 4.0,
                4096.0 * t, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Output, Subset,
                         testing::Combine(testing::Values(Geometry::planar2d, Geometry::axisymmetric2d,
                                                          Geometry::cartesian3d),
                                          testing::Bool()),
                         [](auto const& one) {
                           return std::string(word_of(std::get<0>(one.param))) +
                                  (std::get<1>(one.param) ? "_levels" : "_uniform");
                         });

// Fine cells at the low end of x, and finer ones at one of its corners: the coarsest do not reach there.
TEST(LevelsThatReachBeyondCoarserOnes, AreEnclosedWithoutALossAndOpenInParaView) {
  if (!grid::Forest::can_refine(3)) GTEST_SKIP() << "built without p4est";
  for (Geometry const geometry : {Geometry::planar2d, Geometry::cartesian3d}) {
    grid::Domain const domain = domain_of(geometry);
    int const dims = domain.dimensions();
    Index3 const parts{3, 3, dims > 2 ? 3 : 1};
    grid::Forest forest(parts, dims, {false, false, false});
    for (int level = 0; level < 2; ++level) {
      std::vector<std::int8_t> marks;
      for (grid::Leaf const& leaf : forest.leaves()) {
        bool const wanted = leaf.place[0] == 0 && (level == 0 || leaf.place[1] == 0);
        marks.push_back(leaf.level == level && wanted ? 1 : 0);
      }
      forest.adapt(marks, level + 1);
    }
    grid::Grid const grid(domain, {8, 8, dims > 2 ? 8 : 1}, forest);
    ASSERT_EQ(grid.levels(), 3);
    auto levels = leaves_of(grid);
    double before = 0.0;
    for (ShownCells const& cells : levels) before += static_cast<double>(cells.count());
    let_levels_enclose_finer_ones(levels, dims);
    ASSERT_EQ(levels.size(), 3U);
    double after = 0.0;
    double volume = 0.0;
    std::array<grid::CellRange, 3> around;
    for (std::size_t n = 0; n < 3; ++n) {
      around[n] = levels[n].boxes.front().cells;
      for (CellBox const& box : levels[n].boxes) {
        volume += std::ldexp(static_cast<double>(box.cells.count()), -dims * box.level);
        for (int d = 0; d < dims; ++d) {
          around[n].lower[d] = std::min(around[n].lower[d], box.cells.lower[d]);
          around[n].upper[d] = std::max(around[n].upper[d], box.cells.upper[d]);
          EXPECT_EQ(box.cells.lower[d] % (1 << (box.level > 0 ? 1 : 0)), 0);
        }
      }
      after += static_cast<double>(levels[n].count());
    }
    EXPECT_EQ(volume, static_cast<double>(domain.cell_count()));
    EXPECT_LT(after, before);
    EXPECT_GT(after, before - 200.0);
    for (std::size_t n = 0; n < 2; ++n) {
      for (int d = 0; d < dims; ++d) {
        EXPECT_LE(2 * around[n].lower[d], around[n + 1].lower[d]);
        EXPECT_GE(2 * around[n].upper[d], around[n + 1].upper[d]);
      }
    }
    if (std::string(BRISANCE_PVPYTHON).empty()) continue;
    ScratchFolder folder;
    auto const seen = in_paraview(folder, [&](int t) {
      return level_dump({t / 3.0, t}, grid, specs, {}, values_on(grid, t));
    });
    ASSERT_FALSE(seen.is_null());
    EXPECT_EQ(seen["steps"][1]["cells"], after);
    double const whole = std::pow(0.25, 3) * static_cast<double>(domain.cell_count());
    EXPECT_NEAR(seen["steps"][1]["whole"]["Volume"][0].get<double>() / whole, 1.0, 1e-9);
    double const middle = 0.5 * (domain.lower[0] + domain.upper(0));
    EXPECT_NEAR(seen["steps"][1]["whole"]["velocity"][0].get<double>() / whole / middle, 1.0, 1e-6);
  }
}

TEST(SubsetCells, CountIsExactWithCellsOfOneSizeAndScaledWithSeveral) {
  grid::Domain const domain = domain_of(Geometry::cartesian3d);
  run::FieldSubset const cut = subset_of(run::Plane{2, 4.0});
  EXPECT_EQ(observe::SubsetCells(cut, domain, 0).count({8800.0}), 22.0 * 20.0);
  run::FieldSubset coarse = cut;
  coarse.level = -1;
  EXPECT_EQ(observe::SubsetCells(coarse, domain, 0).count({8800.0}), 11.0 * 10.0);
  // Half of the domain in cells of half the size, of which a plane cuts one layer in 40.
  EXPECT_DOUBLE_EQ(observe::SubsetCells(cut, domain, 1).count({4400.0, 35200.0}), 220.0 + 880.0);
}

TEST(SubsetCells, CellsThatReachBeyondTheDomainAreTold) {
  grid::Domain const domain = domain_of(Geometry::cartesian3d);  // of 22, 20 and 20 cells
  run::FieldSubset cut = subset_of(run::Plane{2, 4.0}, -2);
  EXPECT_EQ(observe::SubsetCells(cut, domain, 0).direction_beyond(), 0);
  cut.level = -1;
  EXPECT_EQ(observe::SubsetCells(cut, domain, 0).direction_beyond(), -1);
}

TEST(SubsetSeries, HasItsFilesAndListInOneFolder) {
  EXPECT_EQ(dump_name("subsets/street", 12, DumpForm::vtkhdf), "subsets/street_000012.hdf");
  EXPECT_EQ(dump_number("subsets/street", "subsets/street_000012.hdf", DumpForm::vtkhdf), 12);
  EXPECT_EQ(dump_number("subsets/street", "subsets/street_2_000012.hdf", DumpForm::vtkhdf), std::nullopt);
  EXPECT_EQ(index_name("subsets/street", DumpForm::vtkhdf), "subsets/street.hdf.series");
}

}  // namespace
}  // namespace brisance::output::test
