/// How much of each cell of a grid shapes fill.
#pragma once

#include <functional>
#include <vector>

#include "shape/shape.hpp"

namespace brisance::shape {

using grid::CellRange;

/// The part of a cell's volume that belongs to a shape.
struct Share {
  int shape = 0;
  double fraction = 0.0;
};

/// The cells that a shape may reach into.
[[nodiscard]] CellRange cells_around(Shape const& shape, grid::Domain const& domain);
/// Volume of the cells of a range [m3], in the units of `Metric::cell_volume`.
[[nodiscard]] double volume_of(CellRange const& cells, grid::Metric const& metric);

/// Shares of one cell, of shapes of which later ones take space from earlier ones; none where no shape reaches. By
/// lines along x, each of them exact and so many to a cell that a ball of three cells' radius is within 1e-3 of its
/// volume, or as many as told; boxes, and everything in 1D, are exact. Less than a thousand-millionth of a cell is
/// round-off.
[[nodiscard]] std::vector<Share> shares_of_cell(std::vector<Shape> const& shapes, grid::Metric const& metric,
                                                Index3 const& cell, int lines = 0);

/// Sum of the parts.
[[nodiscard]] double sum_of(std::vector<Share> const& shares);

/// The same for all cells of a range that a shape reaches into, as boxes of cells in which the shares are equal: whole
/// boxes where one shape fills them, single cells where surfaces cut them. `visit` returns false to end it.
void for_each_share(std::vector<Shape> const& shapes, grid::Metric const& metric, CellRange const& range,
                    std::function<bool(CellRange const&, std::vector<Share> const&)> const& visit);

}  // namespace brisance::shape
