/// A closed surface from loose triangles: corners are welded, edges are checked. Private to this folder.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/vec.hpp"

namespace brisance::shape {

using Triangle = std::array<int, 3>;

struct Surface {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};

/// Welds nine coordinates per triangle, corner by corner: equal corners, or where that leaves open edges those within
/// single precision of the coordinates or 1e-6 of the size of all; triangles that lose a side vanish. Throws
/// InputError, with `what` in front of the message, unless every edge is shared by exactly two triangles of one
/// orientation.
[[nodiscard]] Surface closed_surface(std::vector<Vec3> const& corners, std::string const& what);

}  // namespace brisance::shape
