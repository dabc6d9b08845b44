/// Terrains from height grids.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/vec.hpp"
#include "shape/mesh.hpp"

namespace brisance::shape {

/// How the coordinates of a file become those of the domain: less the origin, times the scale, plus the position.
struct Frame {
  Vec3 origin{0.0, 0.0, 0.0};  ///< in the coordinates of the file
  double scale = 1.0;          ///< [m] per unit of the file
  Vec3 position{0.0, 0.0, 0.0};

  [[nodiscard]] Vec3 point(Vec3 const& x) const { return scale * (x - origin) + position; }
};

/// Heights [m] over the points of a grid in the plane (x, y). Between them they are linear in two triangles per cell.
struct Heights {
  std::vector<double> x;  ///< [m], rising
  std::vector<double> y;  ///< [m], rising
  std::vector<double> z;  ///< [m], x fastest

  [[nodiscard]] double at(std::size_t i, std::size_t j) const { return z[j * x.size() + i]; }
  [[nodiscard]] double lowest() const;
  /// Lies the point within the grid?
  [[nodiscard]] bool covers(double px, double py) const;
  /// The height over a point within the grid.
  [[nodiscard]] double over(double px, double py) const;
  /// The lowest height in the cells that a rectangle touches.
  [[nodiscard]] double lowest_between(double x0, double x1, double y0, double y1) const;
  /// The same grid, where it ends short of these coordinates with the heights of its edges up to them.
  [[nodiscard]] Heights reaching(double x0, double x1, double y0, double y1) const;
};

/// A height grid: CSV with the columns x, y, z, one row per point in any order; GeoJSON with points of three
/// coordinates; or an ESRI ASCII grid (.asc). Throws InputError with file, line and value where points are missing, are
/// there twice, or are not evenly spaced.
[[nodiscard]] Heights read_heights(std::filesystem::path const& file, Frame const& frame);

/// A profile: CSV with the columns x, z in any order and at any distance. Its heights lie over y = -0.5 and 0.5.
[[nodiscard]] Heights read_profile(std::filesystem::path const& file, Frame const& frame);

/// The ground from a surface down to the height `bottom`, which is lower than all heights.
[[nodiscard]] Mesh ground(Heights const& heights, double bottom, std::string const& what);

}  // namespace brisance::shape
