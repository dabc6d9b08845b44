/// How far a burst may spread before it meets something.
#pragma once

#include "setup/start.hpp"

namespace brisance::setup {

/// The nearest boundary of the domain that is no plane through the charge, obstacle, other burst, MPM region, and gauge
/// where gauges count; each less a margin, so that the burst touches none of the cells that matter there. `grounded`
/// is a face that does not count, -1: none.
[[nodiscard]] Reach reach_of(Case const& setup, std::size_t charge, bool with_gauges, int grounded = -1);

}  // namespace brisance::setup
