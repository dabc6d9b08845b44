/// Closed triangle meshes as solid bodies.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/vec.hpp"

namespace brisance::shape {

struct Surface;

/// A stretch of a line along x [m].
struct Span {
  double from = 0.0;
  double to = 0.0;
};

inline constexpr Span whole_line{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

/// The body that a closed surface of triangles bounds, or several that may overlap: then it is all of them together.
/// Copies share the triangles, which never change.
class Mesh {
 public:
  /// The body of closed shells whose triangles, all facing outwards, share vertices only within a shell: shells may
  /// touch and lie within each other. Throws InputError where it has no volume.
  static Mesh of_shells(Surface surface, std::string const& what);

  /// Nine coordinates [m] per triangle, corner by corner. Equal corners are welded (exactly, or where that leaves open
  /// edges within single precision of the coordinates, or within 1e-6 of the body's size); a surface that is inside out
  /// as a whole is turned. Throws InputError, with `what` in front of the message, unless every edge is shared by
  /// exactly two triangles of one orientation, no shell lies in another one that faces the same way, none is inside
  /// out, and the volume is not zero.
  Mesh(std::vector<Vec3> const& corners, std::string const& what);

  [[nodiscard]] std::size_t triangle_count() const;
  /// Their corners [m], counter-clockwise as seen from outside.
  [[nodiscard]] std::vector<std::array<Vec3, 3>> triangles() const;
  [[nodiscard]] Vec3 const& lower() const;   ///< corners of the axis-aligned box around it [m]
  [[nodiscard]] Vec3 const& upper() const;   ///< [m]
  [[nodiscard]] Vec3 const& centre() const;  ///< of mass [m]; exact
  [[nodiscard]] double volume()
      const;  ///< [m3]; exact, by the divergence theorem; where shells overlap it counts twice
  [[nodiscard]] bool overlaps() const;  ///< do shells overlap?
  [[nodiscard]] bool contains(Vec3 const& x) const;

  /// The body with its directions renamed: direction d of the new one is axes[d] of this one.
  [[nodiscard]] Mesh turned(Index3 const& axes) const;

  /// The body with every corner x at f(x), where f keeps straight lines straight and closed surfaces closed.
  [[nodiscard]] Mesh mapped(std::function<Vec3(Vec3 const&)> const& f, std::string const& what) const;

  /// The stretches of the line along x through (y, z) that lie inside, in order. Shells that lie beside a part of the
  /// line may be left out: within the part nothing changes.
  void spans(double y, double z, std::vector<Span>& out, Span const& part = whole_line) const;

  /// May a triangle reach into the box? False is certain: then the box lies inside or outside as a whole.
  [[nodiscard]] bool touches(Vec3 const& low, Vec3 const& high) const;

  /// Coordinates along a direction where flat faces normal to it lie, and its ends; sorted.
  [[nodiscard]] std::vector<double> const& faces(int direction) const;
  /// Adds those between the corners of a box that bound the body there.
  void faces_in(int direction, Vec3 const& low, Vec3 const& high, std::vector<double>& out) const;
  /// Are all triangles level or upright? Then sections at heights between those of its faces do not change.
  [[nodiscard]] bool upright() const;

 private:
  struct Data;

  /// `joined`: shells within others are part of the body.
  Mesh(Surface surface, bool joined, std::string const& what);

  std::shared_ptr<Data const> data_;
};

}  // namespace brisance::shape
