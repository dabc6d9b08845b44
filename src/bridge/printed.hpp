/// Transport through the faces of the region as printed in [Cui14] Sec. 3.4. It counts twice what crosses, see
/// docs/theory: once by the fluxes of the gas and once by the points.
#pragma once

#include "bridge/faces.hpp"
#include "bridge/gas_points.hpp"
#include "bridge/shared_gas.hpp"
#include "bridge/traffic.hpp"
#include "gas/gas.hpp"

namespace brisance::bridge {

/// Makes the points that come in during a step `dt` [s] of the points, [Cui14] Eqs. (40)-(48). Returns how many.
long give_birth_as_printed(Faces const& faces, SharedGas const& shared, GasPoints& points, double dt);
}  // namespace brisance::bridge
