/// Counts of what went between gas and particles, and the words of the bridge for states and amounts of gas.
#pragma once

#include "material/amounts.hpp"

namespace brisance::bridge {

using material::Amounts;
using material::Fractions;
using material::most_fluids;
using material::PerFluid;
using material::Primitive;

/// Counts since the start.
struct Traffic {
  long injected = 0;  ///< particles
  long absorbed = 0;
  Amounts outflow;             ///< left the region through open boundaries of the domain, less what came in
  double pressure_work = 0.0;  ///< of the pressure at the region's faces, by the gas fluxes, into the region [J]
  Vec3 pressure_impulse{0.0, 0.0, 0.0};  ///< likewise [kg m/s]
};

}  // namespace brisance::bridge
