#include "shape/shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.hpp"

namespace brisance::shape {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

template <typename T>
constexpr bool is_primitive =
    !std::is_same_v<T, Mesh> && !std::is_same_v<T, std::shared_ptr<Combination const>>;  // has a signed distance

double signed_distance(Everywhere const&, Vec3 const&) { return -infinity; }
double signed_distance(Sphere const& s, Vec3 const& x) { return norm(x - s.centre) - s.radius; }
double signed_distance(Hemisphere const& s, Vec3 const& x) {
  Vec3 const r = x - s.centre;
  return std::max(norm(r) - s.radius, -dot(r, s.normal));
}
double signed_distance(Cylinder const& s, Vec3 const& x) {
  Vec3 const r = x - s.centre;
  double const along = dot(r, s.axis);
  double const across = norm(r - along * s.axis);
  return std::max(across - s.radius, std::abs(along) - 0.5 * s.length);
}
double signed_distance(Box const& s, Vec3 const& x) {
  double d = -infinity;
  for (int i = 0; i < 3; ++i) d = std::max({d, s.lower[i] - x[i], x[i] - s.upper[i]});
  return d;
}

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

/// Where the line x + t e_x, x[0] = 0, lies in a convex primitive; empty when from > to.
Span stretch(Everywhere const&, Vec3 const&) { return {-infinity, infinity}; }
Span stretch(Sphere const& s, Vec3 const& x) {
  double const y = x[1] - s.centre[1];
  double const z = x[2] - s.centre[2];
  double const left = s.radius * s.radius - y * y - z * z;
  if (left < 0.0) return {infinity, -infinity};
  double const half = std::sqrt(left);
  return {s.centre[0] - half, s.centre[0] + half};
}
/// The part of the stretch where offset + slope x >= 0.
Span above(Span s, double offset, double slope) {
  if (slope > 0.0) s.from = std::max(s.from, -offset / slope);
  if (slope < 0.0) s.to = std::min(s.to, -offset / slope);
  if (slope == 0.0 && offset < 0.0) return {infinity, -infinity};
  return s;
}
Span stretch(Hemisphere const& s, Vec3 const& x) {
  Vec3 const r = x - s.centre;
  return above(stretch(Sphere{s.centre, s.radius}, x), dot(r, s.normal), s.normal[0]);
}
Span stretch(Cylinder const& s, Vec3 const& x) {
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
Span stretch(Box const& s, Vec3 const& x) {
  for (int d = 1; d < 3; ++d) {
    if (x[d] < s.lower[d] || x[d] > s.upper[d]) return {infinity, -infinity};
  }
  return {s.lower[0], s.upper[0]};
}

/// Adds b to a; both disjoint and in order.
void unite(std::vector<Span>& a, std::vector<Span> const& b) {
  if (b.empty()) return;
  a.insert(a.end(), b.begin(), b.end());
  std::sort(a.begin(), a.end(), [](Span const& p, Span const& q) { return p.from < q.from; });
  std::size_t last = 0;
  for (std::size_t n = 1; n < a.size(); ++n) {
    if (a[n].from <= a[last].to) {
      a[last].to = std::max(a[last].to, a[n].to);
    } else {
      a[++last] = a[n];
    }
  }
  a.resize(last + 1);
}

std::vector<Span> intersect(std::vector<Span> const& a, std::vector<Span> const& b) {
  std::vector<Span> common;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    double const from = std::max(a[i].from, b[j].from);
    double const to = std::min(a[i].to, b[j].to);
    if (from < to) common.push_back({from, to});
    (a[i].to < b[j].to ? i : j) += 1;
  }
  return common;
}

/// All of the line that is not in the spans.
std::vector<Span> complement(std::vector<Span> const& spans) {
  std::vector<Span> rest;
  double from = -infinity;
  for (Span const& s : spans) {
    if (s.from > from) rest.push_back({from, s.from});
    from = s.to;
  }
  if (from < infinity) rest.push_back({from, infinity});
  return rest;
}

void spans(Combination const& whole, int dimensions, double y, double z, std::vector<Span>& out) {
  shape::spans(whole.parts.front(), dimensions, y, z, out);
  std::vector<Span> part;
  for (std::size_t n = 1; n < whole.parts.size(); ++n) {
    if (out.empty() && whole.operation != Operation::united) return;
    shape::spans(whole.parts[n], dimensions, y, z, part);
    switch (whole.operation) {
      case Operation::united: unite(out, part); break;
      case Operation::intersection: out = intersect(out, part); break;
      case Operation::difference: out = intersect(out, complement(part)); break;
    }
  }
}

/// Is the box bounded in all directions that count?
bool bounded(Box const& box, int dimensions) {
  for (int d = 0; d < dimensions; ++d) {
    if (!std::isfinite(box.lower[d]) || !std::isfinite(box.upper[d])) return false;
  }
  return true;
}

/// Volume of a shape without a closed form.
double integrated_volume(Shape const& shape, grid::Geometry geometry) {
  int const dims = grid::dimensions(geometry);
  Box const box = bounds(shape);
  if (!bounded(box, dims)) return infinity;
  return volume_within(shape, geometry, box);
}

/// Weight of the radius in a volume integral.
double radial_weight(grid::Geometry g, double r) {
  int const m = grid::radial_exponent(g);
  return m == 0 ? 1.0 : m == 1 ? std::abs(r) : r * r;
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

bool contains(Shape const& shape, grid::Domain const& domain, Vec3 const& x) {
  return inside(shape, domain.dimensions(), x);
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
    double operator()(Mesh const& s) const { return g == Geometry::cartesian3d ? s.volume() : integrated_volume(s, g); }
    double operator()(std::shared_ptr<Combination const> const& s) const { return integrated_volume(s, g); }
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

namespace {

/// Part of a box that lies in the shape, by so many lines in each direction across x.
double fraction_of_box(Shape const& shape, grid::Geometry geometry, Box const& box, int lines);

/// Of a combination or a mesh: lines along x, each of them exact.
double fraction_by_lines(Shape const& shape, grid::Domain const& domain, Index3 const& cell, int samples) {
  int const dims = domain.dimensions();
  Vec3 const middle = domain.centre(cell);
  double const half = 0.5 * domain.h;
  if (dims > 1) {
    Cover const seen = cover(shape, dims, middle, half);
    if (seen != Cover::cut) return seen == Cover::inside ? 1.0 : 0.0;
  }
  Box const box{{domain.face_radius(cell[0]), middle[1] - half, middle[2] - half},
                {domain.face_radius(cell[0] + 1), middle[1] + half, middle[2] + half}};
  double const f = fraction_of_box(shape, domain.geometry, box, samples);
  return f < 1e-12 ? 0.0 : f > 1.0 - 1e-12 ? 1.0 : f;
}

/// Of a primitive: points, where its distance does not decide.
template <typename Primitive>
double fraction_by_points(Primitive const& shape, grid::Domain const& domain, Index3 const& cell, int samples) {
  int const dims = domain.dimensions();
  Primitive const body = resolved(shape, dims);
  Vec3 const x = seen_from(shape, dims, domain.centre(cell));
  double const reach = 0.5 * domain.h * std::sqrt(static_cast<double>(dims));
  double const away = signed_distance(body, x);
  if (away >= reach) return 0.0;
  if (away <= -reach) return 1.0;

  if (dims == 1) {
    // Along a line every shape is an interval: integrate it exactly.
    Box const box = bounds(Shape(shape));
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

}  // namespace

double fill_fraction(Shape const& shape, grid::Domain const& domain, Index3 const& cell, int samples) {
  return std::visit(
      [&](auto const& s) {
        if constexpr (is_primitive<std::decay_t<decltype(s)>>) return fraction_by_points(s, domain, cell, samples);
        return fraction_by_lines(s, domain, cell, samples);
      },
      shape);
}

void spans(Shape const& shape, int dimensions, double y, double z, std::vector<Span>& out) {
  std::visit(
      [&](auto const& s) {
        using S = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<S, std::shared_ptr<Combination const>>) {
          spans(*s, dimensions, y, z, out);
        } else {
          Vec3 x = seen_from(s, dimensions, {0.0, y, z});
          if constexpr (std::is_same_v<S, Mesh>) {
            s.spans(x[1], x[2], out);
          } else {
            out.clear();
            Span const line = stretch(resolved(s, dimensions), {0.0, x[1], x[2]});
            if (line.from < line.to) out.push_back(line);
          }
        }
      },
      shape);
}

void breaks(Shape const& shape, int direction, double from, double to, std::vector<double>& out) {
  auto const add = [&](double at) {
    if (at > from && at < to) out.push_back(at);
  };
  if (auto const* mesh = std::get_if<Mesh>(&shape)) {
    auto const& faces = mesh->faces(direction);
    for (auto at = std::upper_bound(faces.begin(), faces.end(), from); at != faces.end() && *at < to; ++at) add(*at);
    return;
  }
  if (auto const* whole = std::get_if<std::shared_ptr<Combination const>>(&shape)) {
    for (Shape const& part : (*whole)->parts) breaks(part, direction, from, to, out);
    return;
  }
  Box const box = bounds(shape);
  add(box.lower[direction]);
  add(box.upper[direction]);
  if (auto const* half = std::get_if<Hemisphere>(&shape)) add(half->centre[direction]);
  if (auto const* cylinder = std::get_if<Cylinder>(&shape)) {
    // The two ends of an oblique cylinder begin and end within its box.
    double const a = cylinder->axis[direction];
    double const disc = cylinder->radius * std::sqrt(std::max(0.0, 1.0 - a * a));
    double const end = 0.5 * cylinder->length * std::abs(a);
    add(cylinder->centre[direction] + end - disc);
    add(cylinder->centre[direction] - end + disc);
  }
}

std::vector<Station> stations(Shape const& shape, int direction, double from, double to, int count, double slack) {
  std::vector<double> ends;
  breaks(shape, direction, from + slack, to - slack, ends);
  return stations(std::move(ends), from, to, count, slack);
}

std::vector<Station> stations(std::vector<double> ends, double from, double to, int count, double slack) {
  std::sort(ends.begin(), ends.end());
  ends.push_back(to);
  std::vector<Station> all;
  double low = from;
  for (double const end : ends) {
    double const width = end - low;
    if (width <= slack && end < to) continue;
    int const n = std::max(2, static_cast<int>(std::ceil(count * width / (to - from) - 1e-9)));
    for (int q = 0; q < n; ++q) all.push_back({low + (q + 0.5) / n * width, width / (to - from) / n});
    low = end;
  }
  return all;
}

double radial_integral(grid::Geometry geometry, double r) {
  using grid::Geometry;
  switch (geometry) {
    case Geometry::axisymmetric2d:
    case Geometry::cylindrical1d: return pi * r * r;
    case Geometry::spherical1d: return 4.0 / 3.0 * pi * r * r * r;
    default: return r;
  }
}

namespace {

/// A line through a shape and what it measures within a box.
class Line {
 public:
  Line(Shape const& shape, grid::Geometry geometry, Box const& box)
      : shape_(shape),
        geometry_(geometry),
        low_(grid::radial_exponent(geometry) > 0 ? std::max(box.lower[0], 0.0) : box.lower[0]),
        high_(box.upper[0]) {}

  [[nodiscard]] double whole() const {
    return high_ > low_ ? radial_integral(geometry_, high_) - radial_integral(geometry_, low_) : 0.0;
  }

  [[nodiscard]] double inside(double y, double z) {
    spans(shape_, grid::dimensions(geometry_), y, z, spans_);
    double sum = 0.0;
    for (Span const& s : spans_) {
      double const from = std::max(s.from, low_);
      double const to = std::min(s.to, high_);
      if (to > from) sum += radial_integral(geometry_, to) - radial_integral(geometry_, from);
    }
    return sum;
  }

 private:
  Shape const& shape_;
  grid::Geometry geometry_;
  double low_, high_;
  std::vector<Span> spans_;
};

/// Integral of f over [a, b] by Simpson's rule, halved where that changes it by more than `bound`: at the rims and ends
/// of bodies, where f has an infinite slope or a jump.
template <typename Function>
double simpson(Function const& f, double a, double b, Vec3 const& values, double bound, int halvings) {
  double const middle = 0.5 * (a + b);
  double const left = f(0.5 * (a + middle));
  double const right = f(0.5 * (middle + b));
  double const coarse = (values[0] + 4.0 * values[1] + values[2]) * (b - a) / 6.0;
  double const fine = (values[0] + 4.0 * left + 2.0 * values[1] + 4.0 * right + values[2]) * (b - a) / 12.0;
  if (halvings == 0 || std::abs(fine - coarse) <= bound) return fine;
  return simpson(f, a, middle, {values[0], left, values[1]}, bound, halvings - 1) +
         simpson(f, middle, b, {values[1], right, values[2]}, bound, halvings - 1);
}

/// Integral of f, which depends on a shape, between two coordinates.
template <typename Function>
double integral(Function const& f, Shape const& shape, int direction, double low, double high, double bound) {
  constexpr int halvings = 20;
  int const intervals = 32;
  double const slack = 1e-9 * (high - low);
  std::vector<double> ends;
  breaks(shape, direction, low + slack, high - slack, ends);
  std::sort(ends.begin(), ends.end());
  ends.push_back(high);
  double sum = 0.0;
  double from = low;
  for (double const to : ends) {
    if (to - from <= slack && to < high) continue;
    int const n = std::max(4, static_cast<int>(std::ceil(intervals * (to - from) / (high - low))));
    // Just within the piece, as f may jump at its ends.
    double const inset = std::min(slack, 1e-3 * (to - from));
    double const step = (to - from - 2.0 * inset) / n;
    double before = f(from + inset);
    double part = 0.0;
    for (int q = 0; q < n; ++q) {
      double const a = from + inset + q * step;
      double const after = f(a + step);
      part += simpson(f, a, a + step, {before, f(a + 0.5 * step), after}, bound, halvings);
      before = after;
    }
    sum += part * (to - from) / (to - from - 2.0 * inset);
    from = to;
  }
  return sum;
}

double fraction_of_box(Shape const& shape, grid::Geometry geometry, Box const& box, int lines) {
  int const dims = grid::dimensions(geometry);
  Line line(shape, geometry, box);
  std::vector<Station> const single{{0.0, 1.0}};
  auto const along = [&](int d) {
    return d < dims ? stations(shape, d, box.lower[d], box.upper[d], lines, 1e-9 * (box.upper[d] - box.lower[d]))
                    : single;
  };
  auto const ys = along(1);
  double sum = 0.0;
  for (Station const& z : along(2)) {
    for (Station const& y : ys) sum += z.share * y.share * line.inside(y.at, z.at);
  }
  return sum / line.whole();
}

}  // namespace

double volume_within(Shape const& shape, grid::Geometry geometry, Box const& box) {
  int const dims = grid::dimensions(geometry);
  Line line(shape, geometry, box);
  double const length = line.whole();
  Vec3 size{1.0, 1.0, 1.0};
  for (int d = 1; d < dims; ++d) size[d] = box.upper[d] - box.lower[d];
  if (!(length > 0.0 && size[1] > 0.0 && size[2] > 0.0)) return 0.0;
  // A ten-millionth of the box for each interval that is not halved further: some tens of them lie at rims.
  double const bound = 1e-7 * length * size[1];
  auto const row = [&](double z) {
    return integral([&](double y) { return line.inside(y, z); }, shape, 1, box.lower[1], box.upper[1], bound);
  };
  if (dims == 1) return line.inside(0.0, 0.0);
  if (dims == 2) return row(0.0);
  return integral(row, shape, 2, box.lower[2], box.upper[2], bound * size[2]);
}

}  // namespace brisance::shape
