/// A cell in small parts, to see which of its free parts hang together.
#pragma once

#include <cstdint>
#include <vector>

#include "shape/shares.hpp"

namespace brisance::shape {

/// Parts of one cell or of several, x fastest: 1 where shapes leave one free.
struct Parts {
  CellRange box;
  std::vector<std::uint8_t> free;
};

/// The parts of a cell that shapes leave free; `fine` has `per_direction` of them per cell and direction.
[[nodiscard]] Parts parts_of_cell(std::vector<Shape> const& shapes, grid::Metric const& fine, Index3 const& cell,
                                  int per_direction);

/// The pieces that free parts form by their faces.
struct Pieces {
  std::vector<int> number;  ///< of each part's piece, from 1 on; 0 where blocked
  std::vector<int> size;    ///< of the pieces [parts]; that of number 0 is 0

  /// The number of the largest piece, the first of equal ones; 0 where nothing is free.
  [[nodiscard]] int largest() const;
};
[[nodiscard]] Pieces pieces_of(Parts const& parts);

}  // namespace brisance::shape
