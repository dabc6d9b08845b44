/// Shapes that are enlarged, turned and moved.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "shape/shape.hpp"

namespace brisance::shape {

namespace {

/// Does the motion leave what lies along the axes along the axes?
bool keeps_axes(Motion const& motion) {
  return std::all_of(motion.axes.begin(), motion.axes.end(), [](Vec3 const& axis) {
    return std::abs(axis[0]) == 1.0 || std::abs(axis[1]) == 1.0 || std::abs(axis[2]) == 1.0;
  });
}

/// The twelve triangles of a box.
Mesh mesh_of(Box const& box) {
  std::vector<Vec3> corners;
  auto const corner = [&](int n) {
    return Vec3{(n & 1) != 0 ? box.upper[0] : box.lower[0], (n & 2) != 0 ? box.upper[1] : box.lower[1],
                (n & 4) != 0 ? box.upper[2] : box.lower[2]};
  };
  constexpr std::array<std::array<int, 4>, 6> faces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (auto const& [a, b, c, d] : faces) {
    for (int const n : {a, b, c, a, c, d}) corners.push_back(corner(n));
  }
  return {corners, "the box"};
}

struct Mover {
  Motion const& motion;

  Shape operator()(Everywhere const& s) const { return s; }
  Shape operator()(Sphere const& s) const { return Sphere{motion.point(s.centre), motion.scale * s.radius}; }
  Shape operator()(Hemisphere const& s) const {
    return Hemisphere{motion.point(s.centre), motion.scale * s.radius, motion.direction(s.normal)};
  }
  Shape operator()(Cylinder const& s) const {
    return Cylinder{motion.point(s.centre), motion.scale * s.radius, motion.scale * s.length, motion.direction(s.axis)};
  }
  Shape operator()(Box const& s) const {
    if (!keeps_axes(motion)) return (*this)(mesh_of(s));
    Vec3 const a = motion.point(s.lower);
    Vec3 const b = motion.point(s.upper);
    Box box;
    for (int d = 0; d < 3; ++d) {
      box.lower[d] = std::min(a[d], b[d]);
      box.upper[d] = std::max(a[d], b[d]);
    }
    return box;
  }
  Shape operator()(HalfSpace const& s) const { return HalfSpace{motion.point(s.point), motion.direction(s.normal)}; }
  Shape operator()(Mesh const& s) const {
    return s.mapped([this](Vec3 const& x) { return motion.point(x); }, "the moved mesh");
  }
  Shape operator()(std::shared_ptr<Combination const> const& s) const {
    std::vector<Shape> parts;
    for (Shape const& part : s->parts) parts.push_back(moved(part, motion));
    return combine(s->operation, std::move(parts));
  }
};

}  // namespace

Motion then(Motion const& first, Motion const& second) {
  Motion both;
  both.scale = first.scale * second.scale;
  for (int d = 0; d < 3; ++d) both.axes[d] = second.direction(first.axes[d]);
  both.shift = second.point(first.shift);
  return both;
}

Motion turn_around(Vec3 const& axis, double angle, Vec3 const& point) {
  // Quarter turns are exact.
  double const quarters = angle / (0.5 * std::numbers::pi);
  bool const whole = std::abs(quarters - std::round(quarters)) < 1e-12;
  long const quarter = whole ? (std::lround(quarters) % 4 + 4) % 4 : 0;
  constexpr std::array<double, 4> cosines{1.0, 0.0, -1.0, 0.0};
  double const c = whole ? cosines[quarter] : std::cos(angle);
  double const s = whole ? cosines[(quarter + 3) % 4] : std::sin(angle);
  Motion motion;
  for (int d = 0; d < 3; ++d) {
    // Rodrigues' formula.
    Vec3 e{0.0, 0.0, 0.0};
    e[d] = 1.0;
    Vec3 const turned{axis[1] * e[2] - axis[2] * e[1], axis[2] * e[0] - axis[0] * e[2],
                      axis[0] * e[1] - axis[1] * e[0]};
    motion.axes[d] = c * e + s * turned + ((1.0 - c) * axis[d]) * axis;
  }
  motion.shift = point - motion.direction(point);
  return motion;
}

Shape moved(Shape const& shape, Motion const& motion) {
  bool const still = motion.scale == 1.0 && motion.axes == Motion{}.axes && motion.shift == Vec3{0.0, 0.0, 0.0};
  return still ? shape : std::visit(Mover{motion}, shape);
}

}  // namespace brisance::shape
