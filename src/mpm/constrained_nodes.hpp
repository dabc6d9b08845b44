/// Which nodes a constraint holds.
#pragma once

#include "grid/geometry.hpp"
#include "shape/shape.hpp"

namespace brisance::mpm {

/// Is a node in the shape or on its surface?
[[nodiscard]] bool contains_node(shape::Shape const& shape, grid::Metric const& cells, Vec3 const& x);

}  // namespace brisance::mpm
