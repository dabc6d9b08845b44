#include "detonation/shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace brisance::detonation {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Negative inside; outside a lower bound of the distance, so that "farther than half a cell" decides without sampling.
double signed_distance(Shape const& shape, Vec3 const& x) {
  struct Visitor {
    Vec3 x;
    double operator()(Everywhere const&) const { return -infinity; }
    double operator()(Sphere const& s) const { return norm(x - s.centre) - s.radius; }
    double operator()(Hemisphere const& s) const {
      Vec3 const r = x - s.centre;
      return std::max(norm(r) - s.radius, -dot(r, s.normal));
    }
    double operator()(Cylinder const& s) const {
      Vec3 const r = x - s.centre;
      double const along = dot(r, s.axis);
      double const across = norm(r - along * s.axis);
      return std::max(across - s.radius, std::abs(along) - 0.5 * s.length);
    }
    double operator()(Box const& s) const {
      double d = -infinity;
      for (int i = 0; i < 3; ++i) d = std::max({d, s.lower[i] - x[i], x[i] - s.upper[i]});
      return d;
    }
  };
  return std::visit(Visitor{x}, shape);
}

/// The shape as it counts in a geometry: what it does in unresolved directions does not matter there.
Shape resolved(Shape const& shape, grid::Domain const& domain) {
  Shape s = shape;
  int const dims = domain.dimensions();
  if (dims == 3) return s;
  if (auto* box = std::get_if<Box>(&s)) {
    for (int d = dims; d < 3; ++d) {
      box->lower[d] = -infinity;
      box->upper[d] = infinity;
    }
  } else if (auto* cylinder = std::get_if<Cylinder>(&s)) {
    if (std::abs(cylinder->axis[2]) > 0.5) cylinder->length = infinity;
  }
  return s;
}

/// Weight of the radius in a volume integral.
double radial_weight(grid::Geometry g, double r) {
  int const m = grid::radial_exponent(g);
  return m == 0 ? 1.0 : m == 1 ? std::abs(r) : r * r;
}

}  // namespace

bool contains(Shape const& shape, Vec3 const& x) { return signed_distance(shape, x) <= 0.0; }

bool contains(Shape const& shape, grid::Domain const& domain, Vec3 const& x) {
  Vec3 at = x;
  Vec3 const c = centre(shape);
  for (int d = domain.dimensions(); d < 3; ++d) at[d] = c[d];
  return signed_distance(resolved(shape, domain), at) <= 0.0;
}

double volume(Shape const& shape, grid::Geometry geometry) {
  using grid::Geometry;
  struct Visitor {
    Geometry g;
    double operator()(Everywhere const&) const { return infinity; }
    double round(double R) const {
      switch (g) {
        case Geometry::planar1d: return 2.0 * R;
        case Geometry::planar2d:
        case Geometry::cylindrical1d: return pi * R * R;
        default: return 4.0 / 3.0 * pi * R * R * R;
      }
    }
    double operator()(Sphere const& s) const { return round(s.radius); }
    double operator()(Hemisphere const& s) const { return 0.5 * round(s.radius); }
    double operator()(Cylinder const& s) const {
      if (g == Geometry::planar1d) return 2.0 * s.radius;
      bool const unbounded = g == Geometry::planar2d || g == Geometry::cylindrical1d;
      return pi * s.radius * s.radius * (unbounded ? 1.0 : s.length);
    }
    double operator()(Box const& s) const {
      double const x0 = s.lower[0];
      double const x1 = s.upper[0];
      double const dy = s.upper[1] - s.lower[1];
      double const dz = s.upper[2] - s.lower[2];
      switch (g) {
        case Geometry::cartesian3d: return (x1 - x0) * dy * dz;
        case Geometry::planar2d: return (x1 - x0) * dy;
        case Geometry::planar1d: return x1 - x0;
        case Geometry::axisymmetric2d: return pi * (x1 * x1 - x0 * x0) * dy;
        case Geometry::cylindrical1d: return pi * (x1 * x1 - x0 * x0);
        case Geometry::spherical1d: return 4.0 / 3.0 * pi * (x1 * x1 * x1 - x0 * x0 * x0);
      }
      return 0.0;
    }
  };
  return std::visit(Visitor{geometry}, shape);
}

double equivalent_radius(double volume, grid::Geometry geometry) {
  switch (std::min(3, grid::dimensions(geometry) + grid::radial_exponent(geometry))) {
    case 1: return 0.5 * volume;
    case 2: return std::sqrt(volume / pi);
    default: return std::cbrt(0.75 * volume / pi);
  }
}

Vec3 centre(Shape const& shape) {
  struct Visitor {
    Vec3 operator()(Everywhere const&) const { return {0.0, 0.0, 0.0}; }
    Vec3 operator()(Sphere const& s) const { return s.centre; }
    Vec3 operator()(Hemisphere const& s) const { return s.centre; }
    Vec3 operator()(Cylinder const& s) const { return s.centre; }
    Vec3 operator()(Box const& s) const { return 0.5 * (s.lower + s.upper); }
  };
  return std::visit(Visitor{}, shape);
}

Box bounds(Shape const& shape) {
  struct Visitor {
    Box operator()(Everywhere const&) const {
      return {{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
    }
    static Box around(Vec3 const& c, Vec3 const& half) { return {c - half, c + half}; }
    Box operator()(Sphere const& s) const { return around(s.centre, {s.radius, s.radius, s.radius}); }
    Box operator()(Hemisphere const& s) const {
      Box box = around(s.centre, {s.radius, s.radius, s.radius});
      for (int d = 0; d < 3; ++d) {
        if (s.normal[d] > 0.5) box.lower[d] = s.centre[d];
        if (s.normal[d] < -0.5) box.upper[d] = s.centre[d];
      }
      return box;
    }
    Box operator()(Cylinder const& s) const {
      Vec3 half{};
      for (int d = 0; d < 3; ++d) {
        half[d] =
            0.5 * s.length * std::abs(s.axis[d]) + s.radius * std::sqrt(std::max(0.0, 1.0 - s.axis[d] * s.axis[d]));
      }
      return around(s.centre, half);
    }
    Box operator()(Box const& s) const { return s; }
  };
  return std::visit(Visitor{}, shape);
}

double fill_fraction(Shape const& shape, grid::Domain const& domain, Index3 const& cell, int samples) {
  int const dims = domain.dimensions();
  Shape const body = resolved(shape, domain);
  Vec3 x = domain.centre(cell);
  Vec3 const c = centre(shape);
  for (int d = dims; d < 3; ++d) x[d] = c[d];
  double const reach = 0.5 * domain.h * std::sqrt(static_cast<double>(dims));
  double const distance = signed_distance(body, x);
  if (distance >= reach) return 0.0;
  if (distance <= -reach) return 1.0;

  if (dims == 1) {
    // Along a line every shape is an interval: integrate it exactly.
    Box const box = bounds(shape);
    double const from = std::max(box.lower[0], domain.face_radius(cell[0]));
    double const to = std::min(box.upper[0], domain.face_radius(cell[0] + 1));
    if (to <= from) return 0.0;
    grid::Domain part = domain;
    part.lower[0] = from;
    part.h = to - from;
    return std::min(1.0, std::abs(part.cell_volume(0) / domain.cell_volume(cell[0])));
  }

  double const step = domain.h / samples;
  Vec3 const low{domain.lower[0] + cell[0] * domain.h, domain.lower[1] + cell[1] * domain.h,
                 domain.lower[2] + cell[2] * domain.h};
  double inside = 0.0;
  double all = 0.0;
  long hits = 0;
  long points = 0;
  for (int k = 0; k < (dims > 2 ? samples : 1); ++k) {
    for (int j = 0; j < samples; ++j) {
      for (int i = 0; i < samples; ++i) {
        Vec3 y = x;
        y[0] = low[0] + (i + 0.5) * step;
        y[1] = low[1] + (j + 0.5) * step;
        if (dims > 2) y[2] = low[2] + (k + 0.5) * step;
        double const weight = radial_weight(domain.geometry, y[0]);
        all += weight;
        ++points;
        if (signed_distance(body, y) <= 0.0) {
          inside += weight;
          ++hits;
        }
      }
    }
  }
  if (hits == 0) return 0.0;
  if (hits == points) return 1.0;
  return inside / all;
}

}  // namespace brisance::detonation
