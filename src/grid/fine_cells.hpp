/// Cells of two levels: which fine ones lie in a coarse one.
#pragma once

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

}  // namespace brisance::grid
