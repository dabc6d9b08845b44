/// Bodies from drawings: a polygon stands for a section, is extruded, or is turned around an axis.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/vec.hpp"
#include "shape/mesh.hpp"

namespace brisance::shape {

/// A corner of a polygon [m]: x and y of a section; the radius and the place along the axis of a profile.
using Corner = std::array<double, 2>;
/// Corner after corner, either way round; the last one is joined to the first.
using Polygon = std::vector<Corner>;

/// Area [m2]; positive where the corners go anticlockwise.
[[nodiscard]] double area(Polygon const& polygon);

/// The prism over a polygon in the plane (x, y) between two heights z [m]. In two dimensions it stands for the section.
/// Throws InputError, with `what` in front of the message, unless the polygon has at least three corners, an area, and
/// no edges that cross or touch.
[[nodiscard]] Mesh prism(Polygon const& polygon, double from, double to, std::string const& what);

/// The body that a polygon (r, z), r >= 0, describes when it is turned around the axis z. The circles become regular
/// polygons of so many edges and of the circles' area: volumes are exact, and radii by better than 1e-4 with 192 of
/// them. Throws as `prism`, and where a radius is negative.
[[nodiscard]] Mesh turned_profile(Polygon const& profile, std::string const& what, int edges = 192);

/// Profiles (r, z) of bodies that stand on the plane z = 0. A cone, or the frustum of one where `top` is not 0.
[[nodiscard]] Polygon cone_profile(double base, double top, double length);
/// A tangent ogive: an arc that leaves the base along the axis, of the radius (base^2 + length^2) / (2 base), and meets
/// the axis at the tip. `length` is not less than `base`. The arc becomes chords between points on it.
[[nodiscard]] Polygon ogive_profile(double base, double length);
/// A ring around the origin: a regular polygon of the area of the tube's circle. `tube` is less than `radius`.
[[nodiscard]] Polygon torus_profile(double radius, double tube);

}  // namespace brisance::shape
