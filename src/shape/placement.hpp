/// Particles of a body.
#pragma once

#include <vector>

#include "shape/shape.hpp"

namespace brisance::shape {

struct Placement {
  std::vector<Vec3> positions;  ///< [m]
  std::vector<double> volumes;  ///< [m3], in the units of `Domain::cell_volume`
  double volume = 0.0;          ///< of the part of the shape that lies in the domain [m3]; the sum of `volumes`
};

/// Fills the part of a shape that lies in the domain with particles at the centres of sub-cells, `per_direction` to a
/// cell in each resolved direction, cell by cell with x running fastest, within a cell too. Sub-cells that the shape
/// fills carry their exact volume, so does a body whose faces lie on theirs; those that it fills by a quarter or more
/// carry their part; what smaller remnants hold goes to the nearest particles, where there are any. The particles of
/// cut sub-cells are then scaled so that the sum is the volume of the shape in the domain: exact for boxes, for shapes
/// with a closed form (also cut in half by the domain's faces), for meshes in 3D and in 1D; otherwise to the accuracy
/// of `volume`. Throws InputError when `per_direction` is not positive.
[[nodiscard]] Placement place_particles(Shape const& shape, grid::Domain const& domain, int per_direction);

/// Volume of the part of a shape that lies in the domain [m3], in the units of `Domain::cell_volume`: with the same
/// exactness.
[[nodiscard]] double volume_inside(Shape const& shape, grid::Domain const& domain);

}  // namespace brisance::shape
