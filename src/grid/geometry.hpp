/// The geometry of a simulation: how many directions are resolved, and the metric: cell size, centres, volumes and
/// face areas of cells.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "core/models.hpp"
#include "core/vec.hpp"
#include "grid/cell.hpp"

namespace brisance::grid {

/// Resolved directions and symmetry. In the curvilinear geometries x is the radius; in `axisymmetric2d` y is the axis.
enum class Geometry { cartesian3d, planar2d, axisymmetric2d, planar1d, cylindrical1d, spherical1d };

/// Number of resolved directions, 1 to 3.
[[nodiscard]] constexpr int dimensions(Geometry g) {
  switch (g) {
    case Geometry::cartesian3d: return 3;
    case Geometry::planar2d:
    case Geometry::axisymmetric2d: return 2;
    default: return 1;
  }
}

/// Exponent m of the radial metric r^m along x: 0 plane, 1 cylinder, 2 sphere.
[[nodiscard]] constexpr int radial_exponent(Geometry g) {
  switch (g) {
    case Geometry::axisymmetric2d:
    case Geometry::cylindrical1d: return 1;
    case Geometry::spherical1d: return 2;
    default: return 0;
  }
}

constexpr auto words(Geometry) {
  return std::array{Word{Geometry::cartesian3d, "cartesian3d"},       Word{Geometry::planar2d, "planar2d"},
                    Word{Geometry::axisymmetric2d, "axisymmetric2d"}, Word{Geometry::planar1d, "planar1d"},
                    Word{Geometry::cylindrical1d, "cylindrical1d"},   Word{Geometry::spherical1d, "spherical1d"}};
}

/// What happens at one face of the domain. Through `outflow` waves leave without an echo, see gas/open_faces.hpp;
/// beyond `zero_gradient` the gas is as in the cell before it.
enum class Boundary { outflow, wall, symmetry, inflow, periodic, zero_gradient };

/// May gas and bodies leave through the face, and nothing is held there?
[[nodiscard]] constexpr bool is_open(Boundary b) { return b == Boundary::outflow || b == Boundary::zero_gradient; }

/// Is the state of the gas beyond the face given, that of the ambient gas unless the deck says otherwise? In empty
/// space there is no such face, and the particles of an MPM region stay away from it.
[[nodiscard]] constexpr bool is_given(Boundary b) { return b == Boundary::inflow; }

/// Does the face mirror what lies before it?
[[nodiscard]] constexpr bool is_mirror(Boundary b) { return b == Boundary::symmetry || b == Boundary::wall; }

/// Is what lies beyond the face an image of what lies in the domain, mirrored or repeated?
[[nodiscard]] constexpr bool has_images(Boundary b) { return is_mirror(b) || b == Boundary::periodic; }

constexpr auto words(Boundary) {
  return std::array{Word{Boundary::outflow, "outflow"},   Word{Boundary::wall, "wall"},
                    Word{Boundary::symmetry, "symmetry"}, Word{Boundary::inflow, "inflow"},
                    Word{Boundary::periodic, "periodic"}, Word{Boundary::zero_gradient, "zero_gradient"}};
}

/// The six faces in the order x low, x high, y low, y high, z low, z high: `2 * direction + side`.
enum class Face : int { x_low, x_high, y_low, y_high, z_low, z_high };

/// Names of the faces in decks and results, in `Face` order.
inline constexpr std::array<char const*, 6> face_names{"x_low", "x_high", "y_low", "y_high", "z_low", "z_high"};

/// Cubic cells of one size, and what they measure: the only place that knows it. Cell i lies between the faces i and
/// i + 1. Planar geometries count 1 m in each unresolved direction; the curvilinear ones count the whole ring, tube
/// (per metre) or shell.
struct Metric {
  Geometry geometry = Geometry::cartesian3d;
  Vec3 lower{0.0, 0.0, 0.0};  ///< low corner of the cell (0, 0, 0) [m]
  double h = 1.0;             ///< cell size [m]

  [[nodiscard]] int dimensions() const { return grid::dimensions(geometry); }
  /// Where the face below cell i lies along a direction [m].
  [[nodiscard]] double face(int d, int i) const { return lower[d] + i * h; }
  [[nodiscard]] double face_radius(int i) const { return face(0, i); }
  [[nodiscard]] Vec3 low_corner(Index3 const& i) const { return {face(0, i[0]), face(1, i[1]), face(2, i[2])}; }
  [[nodiscard]] Vec3 centre(Index3 const& i) const {
    return {lower[0] + (i[0] + 0.5) * h, lower[1] + (i[1] + 0.5) * h, lower[2] + (i[2] + 0.5) * h};
  }
  /// Where a place along a direction lies that is counted in cells [m], and back.
  [[nodiscard]] double place(int d, double cells) const { return lower[d] + cells * h; }
  /// A place along a direction, counted in cells: from i to i + 1 within cell i.
  [[nodiscard]] double in_cells(int d, double x) const { return (x - lower[d]) / h; }

  /// Area of the face between cells i - 1 and i along x, or of a face along y or z of cells with first index i [m2].
  [[nodiscard]] double face_area(int direction, int i) const {
    double const a = face_radius(i);
    switch (geometry) {
      case Geometry::cartesian3d: return h * h;
      case Geometry::planar2d: return h;
      case Geometry::planar1d: return 1.0;
      case Geometry::axisymmetric2d:
        return direction == 0 ? 2.0 * std::numbers::pi * a * h
                              : std::numbers::pi * (face_radius(i + 1) * face_radius(i + 1) - a * a);
      case Geometry::cylindrical1d: return 2.0 * std::numbers::pi * a;
      case Geometry::spherical1d: return 4.0 * std::numbers::pi * a * a;
    }
    return 0.0;
  }

  /// Volume of cells with first index i [m3].
  [[nodiscard]] double cell_volume(int i) const {
    double const a = face_radius(i);
    double const b = face_radius(i + 1);
    switch (geometry) {
      case Geometry::cartesian3d: return h * h * h;
      case Geometry::planar2d: return h * h;
      case Geometry::planar1d: return h;
      case Geometry::axisymmetric2d: return std::numbers::pi * (b * b - a * a) * h;
      case Geometry::cylindrical1d: return std::numbers::pi * (b * b - a * a);
      case Geometry::spherical1d: return 4.0 / 3.0 * std::numbers::pi * (b * b * b - a * a * a);
    }
    return 0.0;
  }
};

/// A box of uniform cubic cells. Directions that are not resolved have one cell.
struct Domain : Metric {
  Index3 cells{1, 1, 1};  ///< cells per direction
  std::array<Boundary, 6> boundary{Boundary::outflow, Boundary::outflow, Boundary::outflow,
                                   Boundary::outflow, Boundary::outflow, Boundary::outflow};

  [[nodiscard]] long cell_count() const { return static_cast<long>(cells[0]) * cells[1] * cells[2]; }
  /// Size of the smallest cells: what steps, resolution and tolerances of places count by [m].
  [[nodiscard]] double smallest_cell() const { return h; }
  [[nodiscard]] double upper(int d) const { return lower[d] + h * cells[d]; }
  [[nodiscard]] bool contains(Index3 const& cell) const { return all_cells().contains(cell); }
  [[nodiscard]] CellRange all_cells() const { return {{0, 0, 0}, cells}; }
  /// Is the face the axis or the centre of a curvilinear geometry?
  [[nodiscard]] bool is_axis(int face) const { return face == 0 && radial_exponent(geometry) > 0 && lower[0] == 0.0; }
  [[nodiscard]] bool is_mirror(int face) const { return grid::is_mirror(boundary[face]); }
  /// The same domain with cells of 1/2^level of the size.
  [[nodiscard]] Domain refined(int level) const {
    Domain fine = *this;
    fine.h = std::ldexp(h, -level);
    for (int d = 0; d < dimensions(); ++d) fine.cells[d] = cells[d] << level;
    return fine;
  }
};

}  // namespace brisance::grid
