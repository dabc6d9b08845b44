/// Explosives of bodies whose products are gas of the MPM region.
#pragma once

#include "case/case.hpp"

namespace brisance::run {

/// Do the products of a body become gas as it burns? Those of an explosive in an MPM region whose gas knows them.
[[nodiscard]] bool becomes_gas(Case const& setup, Body const& body);
/// What has burnt of the explosives in the MPM region becomes gas.
void hand_over_products(Case const& setup, mpm::Mpm& points, int gas_body);

}  // namespace brisance::run
