/// What coarse cells hold on the mean of the finer ones in them.
#pragma once

#include "grid/grid.hpp"

namespace brisance::grid {

/// Gives the coarse cells that a block covers the means of its cells by volume: `from` is an array over the block's
/// cells, `to` one over a box of coarse cells of the domain. Equal values stay what they are to the last bit.
void take_means(Block const& fine, double const* from, CellRange const& box, double* to);

}  // namespace brisance::grid
