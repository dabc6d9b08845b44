/// Solid shapes of charges, obstacles and regions.
#pragma once

#include <variant>

#include "core/vec.hpp"
#include "grid/geometry.hpp"

namespace brisance::detonation {

/// All space.
struct Everywhere {};

struct Sphere {
  Vec3 centre{0.0, 0.0, 0.0};  ///< [m]
  double radius = 0.0;         ///< [m]
};

/// Half a sphere: the half on the side that `normal` (a unit vector along an axis) points to; its flat face holds the
/// centre.
struct Hemisphere {
  Vec3 centre{0.0, 0.0, 0.0};
  double radius = 0.0;
  Vec3 normal{0.0, 0.0, 1.0};
};

/// A right circular cylinder; in planar 2D a disc, in axisymmetric 2D around the axis.
struct Cylinder {
  Vec3 centre{0.0, 0.0, 0.0};  ///< middle of the axis
  double radius = 0.0;
  double length = 0.0;       ///< along the axis; ignored in planar 2D
  Vec3 axis{0.0, 0.0, 1.0};  ///< unit vector
};

struct Box {
  Vec3 lower{0.0, 0.0, 0.0};
  Vec3 upper{0.0, 0.0, 0.0};
};

using Shape = std::variant<Everywhere, Sphere, Hemisphere, Cylinder, Box>;

/// Is the point x inside?
[[nodiscard]] bool contains(Shape const& shape, Vec3 const& x);

/// The same in a domain: directions that it does not resolve do not count.
[[nodiscard]] bool contains(Shape const& shape, grid::Domain const& domain, Vec3 const& x);

/// Volume [m3] of the shape in the given geometry (per metre of the unresolved directions; curvilinear: the whole
/// body). The shape is taken whole, also where it reaches over a symmetry plane. Infinite for `Everywhere`.
[[nodiscard]] double volume(Shape const& shape, grid::Geometry geometry);

/// Radius [m] of the sphere, disc or half slab (whatever is round in the geometry) of the given volume.
[[nodiscard]] double equivalent_radius(double volume, grid::Geometry geometry);

/// Centre of mass.
[[nodiscard]] Vec3 centre(Shape const& shape);

/// Axis-aligned box around the shape.
[[nodiscard]] Box bounds(Shape const& shape);

/// Part of the cell's volume that lies in the shape, 0 to 1, by `samples` points per direction with the geometry's
/// volume weight; exact for spheres and boxes in 1D. Cells fully inside or outside return exactly 1 or 0.
[[nodiscard]] double fill_fraction(Shape const& shape, grid::Domain const& domain, Index3 const& cell,
                                   int samples = 16);

}  // namespace brisance::detonation
