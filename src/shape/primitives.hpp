/// The primitives among the shapes, by their distance and by lines along x. Private to this folder.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>

#include "shape/shape.hpp"

namespace brisance::shape {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

template <typename T>
constexpr bool is_primitive =
    !std::is_same_v<T, Mesh> && !std::is_same_v<T, std::shared_ptr<Combination const>>;  // has a signed distance

inline double signed_distance(Everywhere const&, Vec3 const&) { return -infinity; }
inline double signed_distance(Sphere const& s, Vec3 const& x) { return norm(x - s.centre) - s.radius; }
inline double signed_distance(Hemisphere const& s, Vec3 const& x) {
  Vec3 const r = x - s.centre;
  return std::max(norm(r) - s.radius, -dot(r, s.normal));
}
inline double signed_distance(Cylinder const& s, Vec3 const& x) {
  Vec3 const r = x - s.centre;
  double const along = dot(r, s.axis);
  double const across = norm(r - along * s.axis);
  return std::max(across - s.radius, std::abs(along) - 0.5 * s.length);
}
inline double signed_distance(Box const& s, Vec3 const& x) {
  double d = -infinity;
  for (int i = 0; i < 3; ++i) d = std::max({d, s.lower[i] - x[i], x[i] - s.upper[i]});
  return d;
}

inline double signed_distance(HalfSpace const& s, Vec3 const& x) { return -dot(x - s.point, s.normal); }

/// A primitive as it counts with so many directions: what it does in the others does not matter.
template <typename Primitive>
Primitive resolved(Primitive shape, int dimensions) {
  if constexpr (std::is_same_v<Primitive, Box>) {
    for (int d = dimensions; d < 3; ++d) {
      shape.lower[d] = -infinity;
      shape.upper[d] = infinity;
    }
  } else if constexpr (std::is_same_v<Primitive, Cylinder>) {
    if (dimensions < 3 && std::abs(shape.axis[2]) > 0.5) shape.length = infinity;
  }
  return shape;
}

/// The point with the coordinates of the shape's own centre in the directions that do not count.
template <typename Part>
Vec3 seen_from(Part const& part, int dimensions, Vec3 x) {
  if (dimensions == 3) return x;
  Vec3 const c = centre(Shape(part));
  for (int d = dimensions; d < 3; ++d) x[d] = c[d];
  return x;
}

/// Negative inside; outside a lower bound of the distance, so that "farther than half a cell" decides without sampling.
template <typename Primitive>
double distance(Primitive const& shape, int dimensions, Vec3 const& x) {
  return signed_distance(resolved(shape, dimensions), seen_from(shape, dimensions, x));
}

/// Where the line x + t e_x, x[0] = 0, lies in a convex primitive; empty when from > to.
inline Span stretch(Everywhere const&, Vec3 const&) { return {-infinity, infinity}; }
inline Span stretch(Sphere const& s, Vec3 const& x) {
  double const y = x[1] - s.centre[1];
  double const z = x[2] - s.centre[2];
  double const left = s.radius * s.radius - y * y - z * z;
  if (left < 0.0) return {infinity, -infinity};
  double const half = std::sqrt(left);
  return {s.centre[0] - half, s.centre[0] + half};
}
/// The part of the stretch where offset + slope x >= 0.
inline Span above(Span s, double offset, double slope) {
  if (slope > 0.0) s.from = std::max(s.from, -offset / slope);
  if (slope < 0.0) s.to = std::min(s.to, -offset / slope);
  if (slope == 0.0 && offset < 0.0) return {infinity, -infinity};
  return s;
}
inline Span stretch(Hemisphere const& s, Vec3 const& x) {
  Vec3 const r = x - s.centre;
  return above(stretch(Sphere{s.centre, s.radius}, x), dot(r, s.normal), s.normal[0]);
}
inline Span stretch(HalfSpace const& s, Vec3 const& x) {
  return above({-infinity, infinity}, dot(x - s.point, s.normal), s.normal[0]);
}
inline Span stretch(Cylinder const& s, Vec3 const& x) {
  Vec3 const r = x - s.centre;
  Vec3 const& a = s.axis;
  double const along = dot(r, a);
  // |r + t e - (along + t a0) a|^2 = radius^2, with e the direction of the line.
  Vec3 const p = r - along * a;
  Vec3 const q{1.0 - a[0] * a[0], -a[0] * a[1], -a[0] * a[2]};
  double const qq = dot(q, q);
  double const excess = dot(p, p) - s.radius * s.radius;
  Span line{-infinity, infinity};
  if (qq > 1e-24) {
    double const half_b = dot(p, q);
    double const root = half_b * half_b - qq * excess;
    if (root < 0.0) return {infinity, -infinity};
    line = {(-half_b - std::sqrt(root)) / qq, (-half_b + std::sqrt(root)) / qq};
  } else if (excess > 0.0) {
    return {infinity, -infinity};
  }
  if (std::isinf(s.length)) return line;
  return above(above(line, 0.5 * s.length + along, a[0]), 0.5 * s.length - along, -a[0]);
}
inline Span stretch(Box const& s, Vec3 const& x) {
  for (int d = 1; d < 3; ++d) {
    if (x[d] < s.lower[d] || x[d] > s.upper[d]) return {infinity, -infinity};
  }
  return {s.lower[0], s.upper[0]};
}

}  // namespace brisance::shape
