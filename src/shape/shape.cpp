#include "shape/shape.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.hpp"
#include "shape/primitives.hpp"

namespace brisance::shape {

namespace {

bool inside(Shape const& shape, int dimensions, Vec3 const& x);

bool inside(Combination const& whole, int dimensions, Vec3 const& x) {
  auto const in = [&](Shape const& part) { return inside(part, dimensions, x); };
  switch (whole.operation) {
    case Operation::united: return std::any_of(whole.parts.begin(), whole.parts.end(), in);
    case Operation::intersection: return std::all_of(whole.parts.begin(), whole.parts.end(), in);
    case Operation::difference: break;
  }
  return in(whole.parts.front()) && std::none_of(whole.parts.begin() + 1, whole.parts.end(), in);
}

bool inside(Shape const& shape, int dimensions, Vec3 const& x) {
  return std::visit(
      [&](auto const& s) {
        using S = std::decay_t<decltype(s)>;
        if constexpr (is_primitive<S>) return distance(s, dimensions, x) <= 0.0;
        if constexpr (std::is_same_v<S, Mesh>) return s.contains(seen_from(s, dimensions, x));
        if constexpr (std::is_same_v<S, std::shared_ptr<Combination const>>) return inside(*s, dimensions, x);
      },
      shape);
}

Cover cover(Combination const& whole, int dimensions, Vec3 const& middle, double half) {
  bool const all = whole.operation == Operation::intersection;
  // Intersection: outside wins, inside needs all. Union: the reverse. Difference: the first without the union of
  // others.
  Cover const wins = all ? Cover::outside : Cover::inside;
  Cover const neutral = all ? Cover::inside : Cover::outside;
  bool const difference = whole.operation == Operation::difference;
  Cover rest = neutral;
  for (std::size_t n = difference ? 1 : 0; n < whole.parts.size(); ++n) {
    Cover const c = cover(whole.parts[n], dimensions, middle, half);
    if (c == wins) {
      rest = wins;
      break;
    }
    if (c == Cover::cut) rest = Cover::cut;
  }
  if (!difference) return rest;
  if (rest == Cover::inside) return Cover::outside;
  Cover const body = cover(whole.parts.front(), dimensions, middle, half);
  return body == Cover::outside || rest == Cover::outside ? body : Cover::cut;
}

}  // namespace

Shape combine(Operation operation, std::vector<Shape> parts) {
  if (parts.empty()) throw InputError("a combination of shapes needs at least one shape");
  if (parts.size() == 1) return std::move(parts.front());
  return std::make_shared<Combination const>(Combination{operation, std::move(parts)});
}

Shape tube(Vec3 const& centre, double inner_radius, double outer_radius, double length, Vec3 const& axis) {
  // The bore is a little longer, so that no skin is left at the ends.
  return combine(Operation::difference,
                 {Cylinder{centre, outer_radius, length, axis}, Cylinder{centre, inner_radius, 1.5 * length, axis}});
}

Shape turned(Shape const& shape, Index3 const& axes) {
  struct Visitor {
    Index3 const& axes;
    [[nodiscard]] Vec3 turn(Vec3 const& x) const { return {x[axes[0]], x[axes[1]], x[axes[2]]}; }
    Shape operator()(Everywhere const& s) const { return s; }
    Shape operator()(Sphere const& s) const { return Sphere{turn(s.centre), s.radius}; }
    Shape operator()(Hemisphere s) const {
      s.centre = turn(s.centre);
      s.normal = turn(s.normal);
      return s;
    }
    Shape operator()(Cylinder const& s) const { return Cylinder{turn(s.centre), s.radius, s.length, turn(s.axis)}; }
    Shape operator()(Box const& s) const { return Box{turn(s.lower), turn(s.upper)}; }
    Shape operator()(HalfSpace const& s) const { return HalfSpace{turn(s.point), turn(s.normal)}; }
    Shape operator()(Mesh const& s) const { return s.turned(axes); }
    Shape operator()(std::shared_ptr<Combination const> const& s) const {
      std::vector<Shape> parts;
      for (Shape const& part : s->parts) parts.push_back(turned(part, axes));
      return combine(s->operation, std::move(parts));
    }
  };
  return std::visit(Visitor{axes}, shape);
}

Cover cover(Shape const& shape, int dimensions, Vec3 const& middle, double half) {
  return std::visit(
      [&](auto const& s) {
        using S = std::decay_t<decltype(s)>;
        if constexpr (is_primitive<S>) {
          double const reach = half * std::sqrt(static_cast<double>(dimensions));
          double const d = distance(s, dimensions, middle);
          return d >= reach ? Cover::outside : d <= -reach ? Cover::inside : Cover::cut;
        }
        if constexpr (std::is_same_v<S, Mesh>) {
          Vec3 const x = seen_from(s, dimensions, middle);
          Vec3 low = x;
          Vec3 high = x;
          for (int d = 0; d < dimensions; ++d) {
            low[d] -= half;
            high[d] += half;
          }
          if (s.touches(low, high)) return Cover::cut;
          return s.contains(x) ? Cover::inside : Cover::outside;
        }
        if constexpr (std::is_same_v<S, std::shared_ptr<Combination const>>) return cover(*s, dimensions, middle, half);
      },
      shape);
}

bool contains(Shape const& shape, Vec3 const& x) { return inside(shape, 3, x); }

bool contains(Shape const& shape, grid::Metric const& cells, Vec3 const& x) {
  return inside(shape, cells.dimensions(), x);
}

Vec3 centre(Shape const& shape) {
  struct Visitor {
    Vec3 operator()(Everywhere const&) const { return {0.0, 0.0, 0.0}; }
    Vec3 operator()(Sphere const& s) const { return s.centre; }
    Vec3 operator()(Hemisphere const& s) const { return s.centre; }
    Vec3 operator()(Cylinder const& s) const { return s.centre; }
    Vec3 operator()(Box const& s) const { return 0.5 * (s.lower + s.upper); }
    Vec3 operator()(HalfSpace const& s) const { return s.point; }
    Vec3 operator()(Mesh const& s) const { return s.centre(); }
    Vec3 operator()(std::shared_ptr<Combination const> const& s) const {
      Box const box = bounds(s);
      Vec3 middle{0.0, 0.0, 0.0};
      for (int d = 0; d < 3; ++d) {
        if (std::isfinite(box.lower[d]) && std::isfinite(box.upper[d])) middle[d] = 0.5 * (box.lower[d] + box.upper[d]);
      }
      return middle;
    }
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
        double const rim = s.radius * std::sqrt(std::max(0.0, 1.0 - s.normal[d] * s.normal[d]));
        if (s.normal[d] > 0.0) box.lower[d] = s.centre[d] - rim;
        if (s.normal[d] < 0.0) box.upper[d] = s.centre[d] + rim;
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
    Box operator()(HalfSpace const& s) const {
      Box box = (*this)(Everywhere{});
      for (int d = 0; d < 3; ++d) {
        if (s.normal[d] == 1.0) box.lower[d] = s.point[d];
        if (s.normal[d] == -1.0) box.upper[d] = s.point[d];
      }
      return box;
    }
    Box operator()(Mesh const& s) const { return {s.lower(), s.upper()}; }
    Box operator()(std::shared_ptr<Combination const> const& s) const {
      Box box = bounds(s->parts.front());
      if (s->operation == Operation::difference) return box;
      bool const united = s->operation == Operation::united;
      for (Shape const& part : s->parts) {
        Box const b = bounds(part);
        for (int d = 0; d < 3; ++d) {
          box.lower[d] = united ? std::min(box.lower[d], b.lower[d]) : std::max(box.lower[d], b.lower[d]);
          box.upper[d] = united ? std::max(box.upper[d], b.upper[d]) : std::min(box.upper[d], b.upper[d]);
        }
      }
      for (int d = 0; d < 3; ++d) box.upper[d] = std::max(box.lower[d], box.upper[d]);  // nothing in common
      return box;
    }
  };
  return std::visit(Visitor{}, shape);
}

}  // namespace brisance::shape
