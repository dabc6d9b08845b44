/// Cells of two levels: which fine ones lie in a coarse one, and the mean of what they hold.
#pragma once

#include <array>
#include <cstddef>

#include "grid/grid.hpp"

namespace brisance::grid {

/// The 2^dimensions cells of the next finer level in some cells, by their indices in the domain.
[[nodiscard]] inline CellRange fine_cells(CellRange const& coarse, int dimensions) {
  CellRange fine = coarse;
  for (int d = 0; d < dimensions; ++d) {
    fine.lower[d] = 2 * coarse.lower[d];
    fine.upper[d] = 2 * coarse.upper[d];
  }
  return fine;
}
[[nodiscard]] inline CellRange fine_cells(Index3 const& coarse, int dimensions) {
  return fine_cells(CellRange{coarse, {coarse[0] + 1, coarse[1] + 1, coarse[2] + 1}}, dimensions);
}
/// The coarse cell in which a cell lies.
[[nodiscard]] inline Index3 coarse_cell(Index3 fine, int dimensions) {
  for (int d = 0; d < dimensions; ++d) fine[d] = fine[d] >= 0 ? fine[d] / 2 : -((1 - fine[d]) / 2);
  return fine;
}
/// The coarse cells in which some cells lie that begin and end between coarse ones.
[[nodiscard]] inline CellRange coarse_cells(CellRange const& fine, int dimensions) {
  CellRange coarse = fine;
  for (int d = 0; d < dimensions; ++d) {
    coarse.lower[d] = fine.lower[d] / 2;
    coarse.upper[d] = fine.upper[d] / 2;
  }
  return coarse;
}

/// The ghost cells of a block beyond a face by their indices in the domain: in the order of `ghost_box`.
[[nodiscard]] inline CellRange ghosts_in_domain(Block const& block, int face) {
  CellRange cells = block.in_domain();
  int const d = face / 2;
  cells.lower[d] = face % 2 == 0 ? cells.lower[d] - ghost_layers : cells.upper[d];
  cells.upper[d] = cells.lower[d] + ghost_layers;
  return cells;
}

/// The finer cells in a cell. They all lie in one block, for blocks have an even number of cells.
struct Parts {
  int block = 0;
  int count = 0;
  std::array<int, 8> offset{};
  std::array<double, 8> share{};  ///< of the coarse cell's volume

  /// From the differences to one of them: equal values stay what they are to the last bit.
  [[nodiscard]] double mean(double const* values) const {
    double const first = values[offset[0]];
    double sum = 0.0;
    for (int n = 1; n < count; ++n) sum += share[n] * (values[offset[n]] - first);
    return first + sum;
  }
};

/// Those in a cell of the domain with an index at a level; the finer level must have cells there.
[[nodiscard]] inline Parts parts_of(Grid const& grid, int level, Index3 const& index) {
  int const dims = grid.domain().dimensions();
  Index3 const corner = fine_cells(index, dims).lower;
  Block const& fine = grid.blocks()[grid.block_of(level + 1, corner)];
  CellRange const cells = fine.in_domain();
  auto const first = static_cast<int>(cells.offset(corner));
  Parts parts;
  parts.block = fine.number;
  parts.count = 1 << dims;
  std::array<double, 2> volume{1.0, 1.0};  // of those with a low and a high index along x
  if (radial_exponent(fine.metric.geometry) > 0)
    volume = {fine.metric.cell_volume(corner[0]), fine.metric.cell_volume(corner[0] + 1)};
  double const whole = 0.5 * parts.count * (volume[0] + volume[1]);
  for (int n = 0; n < parts.count; ++n) {
    std::ptrdiff_t offset = 0;
    for (int d = 0; d < dims; ++d) offset += (n >> d & 1) * cells.stride(d);
    parts.offset[n] = first + static_cast<int>(offset);
    parts.share[n] = volume[n & 1] / whole;
  }
  return parts;
}

}  // namespace brisance::grid
