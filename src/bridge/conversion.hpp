/// The state of a gas from sums over points, and its energy.
#pragma once

#include "bridge/averages.hpp"
#include "bridge/cell_states.hpp"
#include "gas/gas.hpp"

namespace brisance::bridge {

/// The state that sums stand for.
[[nodiscard]] gas::Primitive primitive(material::Fluids const& fluids, CellSums const& sums);
/// The same without the speed of sound.
[[nodiscard]] GasState state_of(material::Fluids const& fluids, CellSums const& sums);
/// Internal energy per mass [J/kg].
[[nodiscard]] double specific_energy(material::Fluids const& fluids, GasState const& s);

}  // namespace brisance::bridge
