/// The gas of a case in the cells of its grid.
#pragma once

#include <functional>
#include <string>

#include "detonation/charge.hpp"
#include "run/reports.hpp"

namespace brisance::run {
class System;
}

namespace brisance::setup {

/// What a charge would become on a grid, where obstacles leave parts of cells `open`; the cells that it takes are added
/// to `taken`. Throws InputError where it does not fit.
[[nodiscard]] run::ChargeReport realised_charge(Charge const& charge, grid::Grid const& grid, std::string const& what,
                                                std::function<double(Index3 const&)> const& open = nullptr,
                                                detonation::TakenCells* taken = nullptr, int level = 0);

/// Builds `system.gas`: ambient, regions, obstacles with their panels, and the charges or what a remap makes of them,
/// and reports what became of each. Throws InputError where the case cannot be realised.
void place_gas(run::System& system);

}  // namespace brisance::setup
