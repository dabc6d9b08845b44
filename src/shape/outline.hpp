/// Outlines in the plane, with holes: what is wrong with them, and how they are cut into triangles.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "shape/drawn.hpp"

namespace brisance::shape {

/// A part of the plane: what lies within an outline and in none of the holes. Either way round.
struct Region {
  Polygon outline;
  std::vector<Polygon> holes;
};

/// A region in triangles. Its corners are those of the outline, anticlockwise, then those of each hole, clockwise.
struct Cut {
  std::vector<Corner> corners;
  std::vector<std::array<std::size_t, 3>> triangles;  ///< anticlockwise; of three corners in line flat
  std::vector<std::array<std::size_t, 2>> edges;      ///< of the outline and the holes, with the region on their left
};

/// Throws InputError, with `what` in front of the message, unless every polygon has at least three corners and an area,
/// no edges cross or touch, and the holes lie within the outline and beside each other.
[[nodiscard]] Cut cut_into_triangles(Region region, std::string const& what);

/// The same of an outline alone, without its triangles; returns it anticlockwise.
[[nodiscard]] Polygon checked_outline(Polygon polygon, std::string const& what);

/// Does a point lie within a polygon?
[[nodiscard]] bool contains(Polygon const& polygon, Corner const& x);

}  // namespace brisance::shape
