/// Obstacles of a case in the gas: cut cells, or solid cells like stairs.
#pragma once

#include "case/case.hpp"
#include "gas/gas.hpp"
#include "setup/levels.hpp"
#include "setup/solid_cells.hpp"

namespace brisance::setup {

/// Does the gas see obstacles by the parts of cells that they leave open? Else a cell is solid or it is not.
[[nodiscard]] bool has_cut_cells(Case const& setup);

/// Puts the obstacles into the gas: their solid cells, which get ambient gas, and their cut cells.
void place_obstacles(Case const& setup, SolidCells const& solid, gas::Gas& gas);
/// The same on several levels.
void place_obstacles(Case const& setup, LevelObstacles const& obstacles, gas::Gas& gas);

/// The part of a cell's volume that obstacles leave to the gas of a case, 0 where it is solid. `cell` is one of those
/// of `solid`.
[[nodiscard]] double open_part(Case const& setup, SolidCells const& solid, Index3 const& cell);

}  // namespace brisance::setup
