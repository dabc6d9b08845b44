/// Which nodes a constraint holds.
#pragma once

#include "grid/geometry.hpp"
#include "shape/shape.hpp"

namespace brisance::mpm {

/// Is a node in the region or on its surface?
[[nodiscard]] bool holds_node(shape::Shape const& region, grid::Domain const& domain, Vec3 const& x);

}  // namespace brisance::mpm
