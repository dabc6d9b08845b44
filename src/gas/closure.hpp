/// The mixture closure under the names of the gas region; it stands in material/fluids.hpp.
#pragma once

#include "gas/layout.hpp"
#include "material/fluids.hpp"

namespace brisance::gas {

using material::add_fluid;
using material::add_fluid_of_cell;
using material::add_fluid_row;
using material::Fluids;
using material::mixture;
using material::Mixture;
using material::phase_density;
using material::smallest_burn_fraction;
using material::vanishing_fraction;

}  // namespace brisance::gas
