/// Rigid bodies in a gas.
#pragma once

#include "gas/gas.hpp"
#include "shape/cut_cells.hpp"

namespace brisance::gas {

/// Marks the solid cells of bodies, gives them the state `inside`, and sets the cut cells. To be called before
/// `Gas::start`.
void place_obstacles(Gas& gas, shape::CutGeometry const& geometry, Primitive const& inside);

/// The part of a cell's volume that obstacles leave to the gas, 0 where it is solid.
[[nodiscard]] double open_part(Gas const& gas, grid::Cell const& cell);

}  // namespace brisance::gas
