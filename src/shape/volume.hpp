/// Volumes by lines along x. Private to this folder.
#pragma once

#include "shape/shape.hpp"

namespace brisance::shape {

/// Fraction of a box that lies in the shape, by so many lines in each direction across x.
[[nodiscard]] double fraction_of_box(Shape const& shape, grid::Geometry geometry, Box const& box, int lines);

}  // namespace brisance::shape
