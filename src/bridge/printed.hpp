/// Transport through the faces of the region as printed in [Cui14] Sec. 3.4. It counts twice what crosses, see
/// docs/theory: once by the fluxes of the gas and once by the particles.
#pragma once

#include "bridge/faces.hpp"
#include "bridge/gas_particles.hpp"
#include "bridge/shared_gas.hpp"
#include "bridge/traffic.hpp"
#include "gas/gas.hpp"

namespace brisance::bridge {

/// Makes the particles that come in during a step `dt` [s] of the particles, [Cui14] Eqs. (40)-(48). Returns how many.
long inject_as_printed(Faces const& faces, SharedGas const& shared, GasParticles& particles, double dt);
}  // namespace brisance::bridge
