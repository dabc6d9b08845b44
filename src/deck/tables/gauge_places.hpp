/// Where gauges on obstacles stand: on the faces between solid cells and gas.
#pragma once

#include <cstddef>
#include <optional>

#include "grid/geometry.hpp"
#include "setup/solid_cells.hpp"

namespace brisance::deck {

/// The point nearest to the middle of a side of an obstacle (`grid::face_names`), on the faces of its cells that look
/// to that side and have gas before them [m]; nothing where there are none.
[[nodiscard]] std::optional<Vec3> middle_of_obstacle(grid::Domain const& domain, setup::SolidCells const& solid,
                                                     std::size_t obstacle, int face);

/// The point nearest to p on the faces between solid cells and gas [m].
[[nodiscard]] std::optional<Vec3> nearest_face(grid::Domain const& domain, setup::SolidCells const& solid,
                                               Vec3 const& p);

}  // namespace brisance::deck
