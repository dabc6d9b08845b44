/// Cells by index, and boxes of them. Only here are indices turned into places in arrays, and back.
#pragma once

#include <cstddef>

#include "core/vec.hpp"

namespace brisance::grid {

/// The cell next to one (or to a box's corner) across its low (side 0) or high (1) face in a direction.
[[nodiscard]] inline Index3 beside(Index3 cell, int direction, int side) {
  cell[direction] += side == 0 ? -1 : 1;
  return cell;
}

/// A box of cells: from `lower` up to, but not including, `upper`. Arrays over it hold x fastest.
struct CellRange {
  Index3 lower{0, 0, 0};
  Index3 upper{1, 1, 1};

  [[nodiscard]] int n(int d) const { return upper[d] - lower[d]; }
  [[nodiscard]] Index3 n() const { return {n(0), n(1), n(2)}; }
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(n(0)) * n(1) * n(2); }
  [[nodiscard]] bool empty() const { return n(0) <= 0 || n(1) <= 0 || n(2) <= 0; }
  [[nodiscard]] bool single() const { return n(0) == 1 && n(1) == 1 && n(2) == 1; }
  [[nodiscard]] bool contains(Index3 const& cell) const {
    for (int d = 0; d < 3; ++d) {
      if (cell[d] < lower[d] || cell[d] >= upper[d]) return false;
    }
    return true;
  }
  /// Distance of neighbours along a direction in an array over the box.
  [[nodiscard]] std::ptrdiff_t stride(int d) const {
    return d == 0 ? 1 : d == 1 ? n(0) : static_cast<std::ptrdiff_t>(n(0)) * n(1);
  }
  /// Place of a cell in an array over the box.
  [[nodiscard]] std::size_t offset(Index3 const& cell) const {
    return static_cast<std::size_t>(cell[0] - lower[0]) +
           static_cast<std::size_t>(n(0)) *
               (cell[1] - lower[1] + static_cast<std::size_t>(n(1)) * (cell[2] - lower[2]));
  }
  /// The cell at a place.
  [[nodiscard]] Index3 at(std::size_t offset) const {
    auto const nx = static_cast<std::size_t>(n(0));
    auto const ny = static_cast<std::size_t>(n(1));
    return {lower[0] + static_cast<int>(offset % nx), lower[1] + static_cast<int>(offset / nx % ny),
            lower[2] + static_cast<int>(offset / (nx * ny))};
  }
  /// The box moved by some cells.
  [[nodiscard]] CellRange moved(Index3 const& by) const {
    CellRange box = *this;
    for (int d = 0; d < 3; ++d) {
      box.lower[d] += by[d];
      box.upper[d] += by[d];
    }
    return box;
  }
  /// The box with so many layers around it in the first `dimensions` directions.
  [[nodiscard]] CellRange grown(int layers, int dimensions) const {
    CellRange box = *this;
    for (int d = 0; d < dimensions; ++d) {
      box.lower[d] -= layers;
      box.upper[d] += layers;
    }
    return box;
  }
};

/// The cells that two boxes share.
[[nodiscard]] inline CellRange common(CellRange const& a, CellRange const& b) {
  CellRange both;
  for (int d = 0; d < 3; ++d) {
    both.lower[d] = a.lower[d] > b.lower[d] ? a.lower[d] : b.lower[d];
    both.upper[d] = a.upper[d] < b.upper[d] ? a.upper[d] : b.upper[d];
  }
  return both;
}

/// The cell itself and those within so many layers around it in the first `dimensions` directions.
[[nodiscard]] inline CellRange around(Index3 const& cell, int layers, int dimensions) {
  return CellRange{cell, {cell[0] + 1, cell[1] + 1, cell[2] + 1}}.grown(layers, dimensions);
}

/// Calls visit(index) for every cell of a box, in the order of arrays over it.
template <class Visit>
void for_each_cell(CellRange const& box, Visit&& visit) {
  for (int k = box.lower[2]; k < box.upper[2]; ++k) {
    for (int j = box.lower[1]; j < box.upper[1]; ++j) {
      for (int i = box.lower[0]; i < box.upper[0]; ++i) visit(Index3{i, j, k});
    }
  }
}

/// Calls visit(index) for the first cell of every row of a box; n(0) cells of it follow each other.
template <class Visit>
void for_each_row(CellRange const& box, Visit&& visit) {
  if (box.empty()) return;
  for (int k = box.lower[2]; k < box.upper[2]; ++k) {
    for (int j = box.lower[1]; j < box.upper[1]; ++j) visit(Index3{box.lower[0], j, k});
  }
}

/// Is there a cell in the box of which test(index) is true?
template <class Test>
[[nodiscard]] bool any_cell(CellRange const& box, Test&& test) {
  for (int k = box.lower[2]; k < box.upper[2]; ++k) {
    for (int j = box.lower[1]; j < box.upper[1]; ++j) {
      for (int i = box.lower[0]; i < box.upper[0]; ++i) {
        if (test(Index3{i, j, k})) return true;
      }
    }
  }
  return false;
}

/// A cell by the block that holds it: its index within the block and its place in the block's arrays. `Grid::locate`
/// and `for_each_cell` make them.
struct Cell {
  int block = 0;
  int i = 0;
  int j = 0;
  int k = 0;
  int offset = 0;

  Cell() = default;
  Cell(int in_block, int x, int y, int z, int place) : block(in_block), i(x), j(y), k(z), offset(place) {}
  [[nodiscard]] Index3 within() const { return {i, j, k}; }
};

}  // namespace brisance::grid
