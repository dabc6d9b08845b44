/// Which cell of its block each particle lies in, and which node is nearest.
#pragma once

#include <vector>

#include "mpm/particles.hpp"
#include "mpm/patches.hpp"

namespace brisance::mpm {

/// Place of each particle's cell in arrays over the cells of the patch.
void find_cells(ParticleSet const& set, Patch const& patch, std::vector<int>& cell);

/// Place of the node that is nearest to each particle in arrays over the nodes of the patch.
void find_nearest_nodes(ParticleSet const& set, Patch const& patch, std::vector<int>& node);

/// From the cells of the points to where in a list of the particles, cell by cell, each of `cells` cells starts; the
/// last entry is the number of particles.
void find_starts(std::vector<int> const& cell, std::size_t cells, std::vector<int>& start);

}  // namespace brisance::mpm
