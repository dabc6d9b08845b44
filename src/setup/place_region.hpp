/// The MPM region of a case with gas: which cells it takes, its bodies and its gas.
#pragma once

#include "bridge/region.hpp"
#include "case/case.hpp"

namespace brisance::run {
class System;
}

namespace brisance::setup {

/// Layers of cells outside the region that act as particles.
[[nodiscard]] int proxy_reach(Case const& setup);

/// Cells between the bodies and the faces of a box that the program chooses.
[[nodiscard]] int margin_of(MpmRegion const& region);

/// The cells of the region: the boxes of the case, or the smallest box around the bodies with a margin. Throws
/// InputError where faces of a box do not lie on the grid or the region does not fit the domain.
[[nodiscard]] bridge::Region region_of(Case const& setup);

/// Builds `system.points` with the bodies and the gas of the region, and `system.bridge`. The gas cells have been
/// filled: the gas particles take their state. Throws InputError where bodies, charges or obstacles do not fit the
/// region.
void place_region(run::System& system);

}  // namespace brisance::setup
