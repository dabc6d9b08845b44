/// Which cell of its block each point lies in.
#pragma once

#include <vector>

#include "mpm/patches.hpp"
#include "mpm/points.hpp"

namespace brisance::mpm {

/// Place of each point's cell in arrays over the cells of the patch.
void find_cells(PointSet const& set, Patch const& patch, std::vector<int>& cell);

/// From the cells of the points to where in a list of the points, cell by cell, each of `cells` cells starts; the last
/// entry is the number of points.
void find_starts(std::vector<int> const& cell, std::size_t cells, std::vector<int>& start);

}  // namespace brisance::mpm
