/// The MPM regions of a case with gas: which cells they take, their bodies and their gas.
#pragma once

#include "bridge/region.hpp"
#include "case/case.hpp"

namespace brisance::run {
class System;
}

namespace brisance::setup {

/// Layers of cells outside a region that act as particles.
[[nodiscard]] int proxy_reach(Case const& setup);

/// Cells between the bodies and the faces of a box that the program chooses.
[[nodiscard]] int margin_of(MpmRegion const& region);

/// The cells of a region: its boxes, or the smallest box around its bodies with a margin. Throws InputError where faces
/// of a box do not lie on the grid or the region does not fit the domain.
[[nodiscard]] bridge::Region region_of(Case const& setup, std::size_t number);

/// Builds the regions of a system one after the other: their bodies, their gas and their bridges. The gas cells have
/// been filled: the gas particles take their state. Throws InputError where bodies, charges or obstacles do not fit a
/// region.
void place_regions(run::System& system);

}  // namespace brisance::setup
