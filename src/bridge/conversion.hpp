/// From sums over points to the state of a gas, and from amounts to gas cells.
#pragma once

#include "bridge/averages.hpp"
#include "bridge/cell_states.hpp"
#include "bridge/traffic.hpp"
#include "gas/gas.hpp"

namespace brisance::bridge {

/// The state that sums stand for.
[[nodiscard]] Primitive primitive(material::Fluids const& fluids, CellSums const& sums);
/// Internal energy per mass [J/kg].
[[nodiscard]] double specific_energy(material::Fluids const& fluids, Primitive const& s);
/// What a mass of 1 kg of gas in a state amounts to, with an energy [J/kg]; its volume is left out.
[[nodiscard]] Amounts per_mass(Primitive const& s, double energy);

/// Adds an amount to a gas cell and wakes it, [Cui14] Eqs. (49)-(51).
void add_to_cell(gas::Gas& gas, grid::Cell const& cell, Amounts const& load);

}  // namespace brisance::bridge
