/// Which cell of its block each particle lies in.
#pragma once

#include <vector>

#include "mpm/particles.hpp"
#include "mpm/patches.hpp"

namespace brisance::mpm {

/// Place of each particle's cell in arrays over the cells of the patch.
void find_cells(ParticleSet const& set, Patch const& patch, std::vector<int>& cell);

/// From the cells of the points to where in a list of the particles, cell by cell, each of `cells` cells starts; the
/// last entry is the number of particles.
void find_starts(std::vector<int> const& cell, std::size_t cells, std::vector<int>& start);

}  // namespace brisance::mpm
