/// The surfaces of shapes in small pieces, with their normals: where outer pressures act.
#pragma once

#include <vector>

#include "grid/grid.hpp"
#include "shape/shape.hpp"

namespace brisance::shape {

/// A piece of a surface.
struct Facet {
  Vec3 x{0.0, 0.0, 0.0};     ///< its middle [m]
  Vec3 area{0.0, 0.0, 0.0};  ///< outer normal times its area, in the convention of `Domain::cell_volume`
};

/// The surface of a shape within a domain, in pieces not much longer than `spacing`, but a few million at most. What
/// lies on a mirror plane of the domain and faces it is no surface. Pieces end where the shape and `region` have flat
/// faces along the axes; those whose middle does not lie in `region` are left out. The areas of a closed surface add up
/// to zero, and those of a convex one that faces one side to its shadow.
[[nodiscard]] std::vector<Facet> surface(Shape const& shape, Shape const& region, grid::Domain const& domain,
                                         double spacing);

/// Does nothing of the shape lie in the direction (a unit vector) from the point x? Stretches shorter than `smallest`
/// may be overlooked.
[[nodiscard]] bool is_clear(Shape const& shape, grid::Domain const& domain, Vec3 const& x, Vec3 const& direction,
                            double smallest);

}  // namespace brisance::shape
