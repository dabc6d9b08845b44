/// Grids of several levels and fields on them, for tests of dumps.
#pragma once

#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "grid/forest.hpp"
#include "output/fields.hpp"
#include "read_numbers.hpp"

namespace brisance::output::test {

inline std::vector<FieldSpec> const specs{
    {"pressure", "Pa", 1, "pressure"}, {"velocity", "m/s", 3, "velocity"}, {"level", "1", 1, "level"}};

inline grid::Domain domain_of(grid::Geometry geometry) {
  grid::Domain domain;
  domain.geometry = geometry;
  domain.lower = {1.0, -2.0, 3.0};
  domain.h = 0.25;
  domain.cells = {22, 20, grid::dimensions(geometry) > 2 ? 20 : 1};  // the last blocks reach beyond
  return domain;
}

/// Blocks of 8 cells, two levels finer around a corner of blocks, where every third leaf that may be is left coarse;
/// `everywhere`: one level finer in all the domain.
inline grid::Grid levels_grid(grid::Geometry geometry, int levels = 2, bool everywhere = false) {
  grid::Domain const domain = domain_of(geometry);
  int const dims = domain.dimensions();
  Index3 const size{8, 8, dims > 2 ? 8 : 1};
  grid::Forest forest({3, 3, dims > 2 ? 3 : 1}, dims, {false, false, false});
  for (int level = 0; level < levels; ++level) {
    std::vector<std::int8_t> marks;
    for (grid::Leaf const& leaf : forest.leaves()) {
      double way = 0.0;
      for (int d = 0; d < dims; ++d) way += std::pow((leaf.place[d] + 0.5) * std::ldexp(8.0, -leaf.level) - 9.0, 2);
      bool const near = std::sqrt(way) < std::ldexp(8.0, -level);
      marks.push_back(leaf.level == level && (everywhere || near) ? 1 : 0);
    }
    forest.adapt(marks, level + 1);
  }
  std::vector<std::uint8_t> may(forest.leaves().size(), 0);
  for (std::size_t n = 1; n < may.size() && !everywhere; n += 3) may[n] = 1;
  forest.leave_coarse(may);
  return grid::Grid(domain, size, forest);
}

/// Linear, and exact in single precision.
inline double pressure_at(Vec3 const& x, int time) { return 1024.0 * x[0] + 64.0 * x[1] + 4.0 * x[2] + 4096.0 * time; }

inline RowValues values_on(grid::Grid const& grid, int time) {
  return [&grid, time](grid::Cell const& first, int count, double* out) {
    grid::Cell cell = first;
    grid::Block const& block = grid.block(first);
    for (int n = 0; n < count; ++n, ++cell.i, ++cell.offset) {
      Vec3 const x = block.centre(cell);
      *out++ = pressure_at(x, time);
      for (int d = 0; d < 3; ++d) *out++ = x[d];
      *out++ = block.level;
    }
  };
}

inline double leaf_cells(grid::Grid const& grid) {
  double cells = 0.0;
  for (grid::Block const& block : grid.blocks()) cells += uncovered_count(block);
  return cells;
}

}  // namespace brisance::output::test
