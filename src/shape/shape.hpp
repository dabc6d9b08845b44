/// Solid shapes of charges, obstacles, regions and bodies.
#pragma once

#include <array>
#include <memory>
#include <variant>
#include <vector>

#include "core/vec.hpp"
#include "grid/geometry.hpp"
#include "shape/mesh.hpp"

namespace brisance::shape {

/// All space.
struct Everywhere {};

struct Sphere {
  Vec3 centre{0.0, 0.0, 0.0};  ///< [m]
  double radius = 0.0;         ///< [m]
};

/// Half a sphere: the half on the side that `normal` (a unit vector) points to; its flat face holds the centre.
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

/// All that lies on one side of a plane.
struct HalfSpace {
  Vec3 point{0.0, 0.0, 0.0};   ///< on the plane
  Vec3 normal{0.0, 0.0, 1.0};  ///< unit vector, into the half-space
};

struct Combination;

using Shape =
    std::variant<Everywhere, Sphere, Hemisphere, Cylinder, Box, HalfSpace, Mesh, std::shared_ptr<Combination const>>;

/// How shapes are put together; `difference` takes all others away from the first.
enum class Operation { united, intersection, difference };

/// Shapes put together, to any depth. Never changes, so that copies of a shape may share it.
struct Combination {
  Operation operation = Operation::united;
  std::vector<Shape> parts;
};

/// Throws InputError when there are no parts.
[[nodiscard]] Shape combine(Operation operation, std::vector<Shape> parts);

/// The ring or tube between two coaxial cylinders.
[[nodiscard]] Shape tube(Vec3 const& centre, double inner_radius, double outer_radius, double length, Vec3 const& axis);

/// Where a shape is put: enlarged by a factor, then turned, then moved.
struct Motion {
  double scale = 1.0;  ///< > 0
  /// Where the unit vectors of the axes come to; right-handed and orthogonal.
  std::array<Vec3, 3> axes{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
  Vec3 shift{0.0, 0.0, 0.0};  ///< [m]

  [[nodiscard]] Vec3 direction(Vec3 const& v) const { return v[0] * axes[0] + v[1] * axes[1] + v[2] * axes[2]; }
  [[nodiscard]] Vec3 point(Vec3 const& x) const { return scale * direction(x) + shift; }
};

/// One motion and then another, as one.
[[nodiscard]] Motion then(Motion const& first, Motion const& second);

/// The motion that turns by an angle [rad], anticlockwise seen against `axis` (a unit vector), around a point.
[[nodiscard]] Motion turn_around(Vec3 const& axis, double angle, Vec3 const& point);

/// The shape after a motion. A box that no longer lies along the axes becomes a mesh.
[[nodiscard]] Shape moved(Shape const& shape, Motion const& motion);

/// The shape with its directions renamed: direction d of the new one is axes[d] of the old one.
[[nodiscard]] Shape turned(Shape const& shape, Index3 const& axes);

/// Is the point x inside?
[[nodiscard]] bool contains(Shape const& shape, Vec3 const& x);

/// The same among the cells of a metric: directions that it does not resolve do not count.
[[nodiscard]] bool contains(Shape const& shape, grid::Metric const& cells, Vec3 const& x);

/// Volume [m3] of the shape in the given geometry (per metre of the unresolved directions; curvilinear: the whole
/// body). The shape is taken whole, also where it reaches over a symmetry plane. Infinite for `Everywhere` and
/// half-spaces. Exact for primitives, for meshes in 3D and for all shapes in 1D; otherwise by integration over lines
/// along x, measured on closed forms: relative error below 1e-5. A mesh in fewer directions stands for its section
/// through its centre of mass.
[[nodiscard]] double volume(Shape const& shape, grid::Geometry geometry);

/// Radius [m] of the sphere, disc or half slab (whatever is round in the geometry) of the given volume.
[[nodiscard]] double equivalent_radius(double volume, grid::Geometry geometry);

/// Centre of mass; of a hemisphere the centre of its flat face, of a combination the middle of its box.
[[nodiscard]] Vec3 centre(Shape const& shape);

/// Axis-aligned box around the shape; what a difference takes away does not make it smaller.
[[nodiscard]] Box bounds(Shape const& shape);

/// What a cube sees of a shape. `cut` may be said too often, the others are certain.
enum class Cover { outside, cut, inside };

/// Of the cube around `middle` with edges of 2 `half`; of the given directions only the first `dimensions` count.
[[nodiscard]] Cover cover(Shape const& shape, int dimensions, Vec3 const& middle, double half);

/// Fraction of the cell's volume that lies in the shape, 0 to 1, by `samples` points per direction with the geometry's
/// volume weight; exact for spheres and boxes in 1D, and along x for combinations and meshes. Cells fully inside or
/// outside return exactly 1 or 0.
[[nodiscard]] double fill_fraction(Shape const& shape, grid::Metric const& cells, Index3 const& cell, int samples = 16);

/// The stretches of the line along x through (y, z) that lie in the shape, disjoint and in order; of the given
/// directions only the first `dimensions` count. Certain within `part` alone.
void spans(Shape const& shape, int dimensions, double y, double z, std::vector<Span>& out,
           Span const& part = whole_line);

/// Adds the coordinates between `from` and `to` at which parts of the shape begin, end or have flat faces: between them
/// its section changes without jumps.
void breaks(Shape const& shape, int direction, double from, double to, std::vector<double>& out);

/// The same of what lies in a box.
void breaks(Shape const& shape, int direction, Box const& box, std::vector<double>& out);

/// A place on a line and the share of the line that it stands for.
struct Station {
  double at = 0.0;
  double share = 0.0;
};

/// Stations between `from` and `to` for integrals over the shape: at least `count`, evenly within the pieces between
/// its breaks. Breaks closer than `slack` to each other or to the ends do not count.
[[nodiscard]] std::vector<Station> stations(Shape const& shape, int direction, double from, double to, int count,
                                            double slack);

/// The same for breaks that are known, in any order.
[[nodiscard]] std::vector<Station> stations(std::vector<double> ends, double from, double to, int count, double slack);

/// Volume [m3] of the part of the shape within a box, by lines along x, each of them exact, as many as it takes.
[[nodiscard]] double volume_within(Shape const& shape, grid::Geometry geometry, Box const& box);

/// Integral of the metric from 0 to the radius r, in the units of `Domain::cell_volume` per metre of the other resolved
/// directions.
[[nodiscard]] double radial_integral(grid::Geometry geometry, double r);

}  // namespace brisance::shape
