/// From sums over points to the state of a gas, and from amounts to gas cells.
#pragma once

#include "bridge/account.hpp"
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

/// Adds an amount to a gas cell and wakes it, [Cui14] Eqs. (49)-(51).
void add_to_cell(gas::Gas& gas, Index3 const& cell, Account const& load);

}  // namespace brisance::bridge
