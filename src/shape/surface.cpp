#include "shape/surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace brisance::shape {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double most_facets = 4e6;  ///< of one primitive

Vec3 cross(Vec3 const& a, Vec3 const& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Pieces of primitives, before anything is known of what else there is.
class Pieces {
 public:
  Pieces(Shape const& whole, Shape const& region, grid::Domain const& domain, double spacing)
      : whole_(whole), region_(region), domain_(domain), spacing_(spacing), box_(bounds(whole)) {}

  std::vector<Facet> found;

  void of(Everywhere const&) {}

  void of(Sphere const& s) {
    if (dims() == 2) return arc(s.centre, s.radius, 0.0, 2.0 * pi);
    ball(s.centre, s.radius, {0.0, 0.0, 1.0}, -1.0);
  }

  void of(Hemisphere const& s) {
    if (dims() == 2) {
      if (std::abs(s.normal[2]) > 0.5) return arc(s.centre, s.radius, 0.0, 2.0 * pi);
      double const middle = std::atan2(s.normal[1], s.normal[0]);
      arc(s.centre, s.radius, middle - 0.5 * pi, middle + 0.5 * pi);
      Vec3 const along{-s.normal[1], s.normal[0], 0.0};
      return line(s.centre - s.radius * along, s.centre + s.radius * along, -1.0 * s.normal);
    }
    ball(s.centre, s.radius, s.normal, 0.0);
    disc(s.centre, s.radius, -1.0 * s.normal);
  }

  void of(Cylinder const& s) {
    if (dims() == 2) {
      if (std::abs(s.axis[2]) > 0.5) return arc(s.centre, s.radius, 0.0, 2.0 * pi);
      Vec3 const across{-s.axis[1], s.axis[0], 0.0};
      Vec3 const up = 0.5 * s.length * s.axis;
      Vec3 const out = s.radius * across;
      for (double const side : {-1.0, 1.0}) {
        line(s.centre + side * up - out, s.centre + side * up + out, side * s.axis);
        line(s.centre + side * out - up, s.centre + side * out + up, side * across);
      }
      return;
    }
    Vec3 const end = 0.5 * s.length * s.axis;
    disc(s.centre + end, s.radius, s.axis);
    disc(s.centre - end, s.radius, -1.0 * s.axis);
    double const step = coarsened(2.0 * pi * s.radius * s.length);
    auto const [u, v] = across(s.axis);
    int const around = count(2.0 * pi * s.radius, step, 12);
    int const along = count(s.length, step);
    double const chord = 2.0 * s.radius * std::sin(pi / around) * s.length / along;
    for (int j = 0; j < along; ++j) {
      Vec3 const middle = s.centre + ((j + 0.5) / along - 0.5) * s.length * s.axis;
      for (int i = 0; i < around; ++i) {
        double const phi = 2.0 * pi * (i + 0.5) / around;
        Vec3 const n = std::cos(phi) * u + std::sin(phi) * v;
        found.push_back({middle + s.radius * n, chord * n});
      }
    }
  }

  void of(Box const& s) {
    for (int d = 0; d < dims(); ++d) {
      for (int side = 0; side < 2; ++side) {
        double const at = side == 0 ? s.lower[d] : s.upper[d];
        if (!std::isfinite(at)) continue;
        Vec3 n{0.0, 0.0, 0.0};
        n[d] = side == 0 ? -1.0 : 1.0;
        face(s, d, at, n);
      }
    }
  }

  void of(HalfSpace const& s) {
    // As much of the plane as the domain may see of it.
    Vec3 middle{0.0, 0.0, 0.0};
    double reach = 0.0;
    for (int d = 0; d < dims(); ++d) {
      middle[d] = 0.5 * (domain_.lower[d] + domain_.upper(d));
      reach += domain_.upper(d) - domain_.lower[d];
    }
    Vec3 normal = s.normal;
    if (dims() == 2) normal[2] = 0.0;
    if (!(norm(normal) > 0.0)) return;
    normal = (1.0 / norm(normal)) * normal;
    Vec3 const foot = middle - dot(middle - s.point, normal) * normal;
    Vec3 const out = -1.0 * normal;
    if (dims() == 2) {
      Vec3 const along{-normal[1], normal[0], 0.0};
      return line(foot - (0.5 * reach) * along, foot + (0.5 * reach) * along, out);
    }
    auto const [u, v] = across(normal);
    int const n = count(reach, coarsened(reach * reach));
    double const step = reach / n;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i)
        found.push_back(
            {foot + ((i + 0.5) * step - 0.5 * reach) * u + ((j + 0.5) * step - 0.5 * reach) * v, (step * step) * out});
    }
  }

  void of(Mesh const& s) {
    if (dims() < 3) return section(s);
    double const step = coarsened(6.0 * std::pow(s.volume(), 2.0 / 3.0));
    for (auto const& t : s.triangles()) {
      Vec3 const a = t[1] - t[0];
      Vec3 const b = t[2] - t[0];
      Vec3 const area = 0.5 * cross(a, b);
      int const n = count(std::max({norm(a), norm(b), norm(b - a)}), step);
      double const part = 1.0 / (static_cast<double>(n) * n);
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i + j < n; ++i) {
          auto const middle = [&](double third) { return t[0] + ((i + third) / n) * a + ((j + third) / n) * b; };
          found.push_back({middle(1.0 / 3.0), part * area});
          if (i + j + 1 < n) found.push_back({middle(2.0 / 3.0), part * area});
        }
      }
    }
  }

  void of(std::shared_ptr<Combination const> const& /*parts come one by one*/) {}

  /// On a line every shape is made of intervals.
  void ends() {
    std::vector<Span> inside;
    spans(whole_, 1, 0.0, 0.0, inside);
    for (Span const& s : inside) {
      for (int side = 0; side < 2; ++side) {
        double const r = side == 0 ? s.from : s.to;
        if (std::isfinite(r)) found.push_back({{r, 0.0, 0.0}, {(side == 0 ? -1.0 : 1.0) * metric(r), 0.0, 0.0}});
      }
    }
  }

 private:
  [[nodiscard]] int dims() const { return domain_.dimensions(); }

  /// Length around the axis or area around the centre at a radius.
  [[nodiscard]] double metric(double r) const {
    int const m = grid::radial_exponent(domain_.geometry);
    return m == 0 ? 1.0 : m == 1 ? 2.0 * pi * std::abs(r) : 4.0 * pi * r * r;
  }
  [[nodiscard]] double coarsened(double area) const { return std::max(spacing_, std::sqrt(area / most_facets)); }
  static int count(double length, double step, int least = 1) {
    return std::max(least, static_cast<int>(std::ceil(length / step - 1e-9)));
  }
  static std::array<Vec3, 2> across(Vec3 const& n) {
    int const least = std::abs(n[0]) < 0.6 ? 0 : std::abs(n[1]) < 0.6 ? 1 : 2;
    Vec3 e{0.0, 0.0, 0.0};
    e[least] = 1.0;
    Vec3 u = cross(n, e);
    u = (1.0 / norm(u)) * u;
    return {u, cross(n, u)};
  }

  /// In two dimensions: the outline of the section through the centre of mass, a straight line in each triangle that is
  /// cut.
  void section(Mesh const& s) {
    double const z = s.centre()[2];
    for (auto const& t : s.triangles()) {
      Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
      normal[2] = 0.0;
      if (!(norm(normal) > 0.0)) continue;
      std::vector<Vec3> ends;
      for (int c = 0; c < 3; ++c) {
        Vec3 const& a = t[c];
        Vec3 const& b = t[(c + 1) % 3];
        // A corner on the plane counts as above it.
        if ((a[2] < z) == (b[2] < z)) continue;
        Vec3 x = a + ((z - a[2]) / (b[2] - a[2])) * (b - a);
        x[2] = 0.0;
        ends.push_back(x);
      }
      if (ends.size() == 2 && norm(ends[1] - ends[0]) > 0.0) line(ends[0], ends[1], (1.0 / norm(normal)) * normal);
    }
  }

  /// In two dimensions: a straight line, n is its normal.
  void line(Vec3 const& a, Vec3 const& b, Vec3 const& n) {
    double const length = norm(b - a);
    int const parts = count(length, std::max(spacing_, length / most_facets));
    for (int i = 0; i < parts; ++i) {
      Vec3 const x = a + ((i + 0.5) / parts) * (b - a);
      found.push_back({x, (length / parts * metric(x[0])) * n});
    }
  }

  /// Chords, so that their shadows add up; at places on the arc.
  void arc(Vec3 const& c, double radius, double from, double to) {
    double const length = (to - from) * radius;
    // Quarters, so that the rims of shadows lie between pieces.
    int const quarters = static_cast<int>(std::lround((to - from) / (0.5 * pi)));
    int const parts = quarters * count(length / quarters, std::max(spacing_, length / most_facets), 4);
    double const half = 0.5 * (to - from) / parts;
    for (int i = 0; i < parts; ++i) {
      double const phi = from + (2 * i + 1) * half;
      Vec3 const n{std::cos(phi), std::sin(phi), 0.0};
      double const r = c[0] + radius * std::cos(half) * n[0];  // in the middle of the chord
      found.push_back({c + radius * n, (2.0 * radius * std::sin(half) * metric(r)) * n});
    }
  }

  void disc(Vec3 const& c, double radius, Vec3 const& n) {
    double const step = coarsened(pi * radius * radius);
    auto const [u, v] = across(n);
    int const rings = count(radius, step);
    for (int j = 0; j < rings; ++j) {
      double const inner = radius * j / rings;
      double const outer = radius * (j + 1) / rings;
      int const around = count(2.0 * pi * outer, step, 8);
      double const area = pi * (outer * outer - inner * inner) / around;
      double const r = 2.0 / 3.0 * (inner + outer - inner * outer / (inner + outer));  // centre of mass, of a thin ring
      for (int i = 0; i < around; ++i) {
        double const phi = 2.0 * pi * (i + 0.5) / around;
        found.push_back({c + (r * std::cos(phi)) * u + (r * std::sin(phi)) * v, area * n});
      }
    }
  }

  /// A sphere above the height `from` (-1 or 0 radii) along an axis.
  void ball(Vec3 const& c, double radius, Vec3 const& axis, double from) {
    double const step = coarsened(4.0 * pi * radius * radius);
    auto const [u, v] = across(axis);
    double const angle = std::acos(from);
    int const bands = (from < 0.0 ? 2 : 1) * count(0.5 * pi * radius, step, 4);
    for (int j = 0; j < bands; ++j) {
      double const top = std::cos(angle * j / bands);
      double const bottom = std::cos(angle * (j + 1) / bands);
      double const z = 0.5 * (top + bottom);
      double const r = std::sqrt(1.0 - z * z);
      int const around = 4 * count(0.5 * pi * radius * r, step, 2);
      double const area = 2.0 * pi * radius * radius * (top - bottom) / around;
      for (int i = 0; i < around; ++i) {
        double const phi = 2.0 * pi * (i + 0.5) / around;
        Vec3 const n = z * axis + (r * std::cos(phi)) * u + (r * std::sin(phi)) * v;
        found.push_back({c + radius * n, area * n});
      }
    }
  }

  void face(Box const& s, int d, double at, Vec3 const& n) {
    std::array<std::vector<Station>, 2> along{{{{0.0, 1.0}}, {{0.0, 1.0}}}};
    std::array<int, 2> direction{-1, -1};
    double area = 1.0;
    for (int t = 0, k = 0; t < dims(); ++t) {
      if (t == d) continue;
      double const from = std::max({s.lower[t], domain_.lower[t], box_.lower[t]});
      double const to = std::min({s.upper[t], domain_.upper(t), box_.upper[t]});
      if (!(to > from)) return;
      double const slack = 1e-9 * domain_.smallest_cell();
      std::vector<double> ends;
      for (Shape const* one : {&whole_, &region_}) breaks(*one, t, from + slack, to - slack, ends);
      double const step = std::max(spacing_, (to - from) / std::sqrt(most_facets));
      direction[k] = t;
      along[k++] = stations(std::move(ends), from, to, count(to - from, step), slack);
      area *= to - from;
    }
    for (Station const& b : along[1]) {
      for (Station const& a : along[0]) {
        Vec3 x = centre(Shape(s));
        x[d] = at;
        if (direction[0] >= 0) x[direction[0]] = a.at;
        if (direction[1] >= 0) x[direction[1]] = b.at;
        found.push_back({x, (area * a.share * b.share * metric(x[0])) * n});
      }
    }
  }

  Shape const& whole_;
  Shape const& region_;
  grid::Domain const& domain_;
  double spacing_;
  Box box_;
};

void collect(Shape const& shape, std::vector<Shape>& primitives) {
  if (auto const* whole = std::get_if<std::shared_ptr<Combination const>>(&shape)) {
    for (Shape const& part : (*whole)->parts) collect(part, primitives);
  } else {
    primitives.push_back(shape);
  }
}

/// Lies the point in the domain, and not on a mirror plane that n (a unit vector) points to?
bool counts(grid::Domain const& domain, Vec3 const& x, Vec3 const& n) {
  double const slack = 1e-6 * domain.smallest_cell();
  for (int d = 0; d < domain.dimensions(); ++d) {
    for (int side = 0; side < 2; ++side) {
      double const before = side == 0 ? x[d] - domain.lower[d] : domain.upper(d) - x[d];
      if (before < -slack) return false;
      double const outwards = side == 0 ? -n[d] : n[d];
      if (before < slack && outwards > 0.999 && grid::is_mirror(domain.boundary[2 * d + side])) return false;
    }
  }
  return true;
}

bool is_clear_between(Shape const& shape, int dims, Vec3 const& x, Vec3 const& direction, double from, double to,
                      double smallest) {
  double const half = 0.5 * (to - from);
  Vec3 const middle = x + (from + half) * direction;
  Cover const seen = cover(shape, dims, middle, half);
  if (seen != Cover::cut) return seen == Cover::outside;
  if (half < smallest) return cover(shape, dims, middle, 0.0) != Cover::inside;
  return is_clear_between(shape, dims, x, direction, from, from + half, smallest) &&
         is_clear_between(shape, dims, x, direction, from + half, to, smallest);
}

}  // namespace

std::vector<Facet> surface(Shape const& shape, Shape const& region, grid::Domain const& domain, double spacing) {
  int const dims = domain.dimensions();
  std::vector<Shape> primitives;
  collect(shape, primitives);
  Pieces pieces(shape, region, domain, spacing);
  std::vector<Facet> kept;
  double const step = 1e-4 * spacing;
  for (std::size_t m = 0; m < primitives.size(); ++m) {
    pieces.found.clear();
    if (dims == 1) {
      if (m > 0) break;
      pieces.ends();
    } else {
      std::visit([&](auto const& one) { pieces.of(one); }, primitives[m]);
    }
    for (Facet f : pieces.found) {
      double const area = norm(f.area);
      if (!(area > 0.0)) continue;
      Vec3 const n = (1.0 / area) * f.area;
      Vec3 const below = f.x - step * n;
      Vec3 const above = f.x + step * n;
      bool const in = contains(shape, domain, below);
      if (in == contains(shape, domain, above)) continue;  // within the body, or outside
      // Where surfaces of two primitives fall together, the first counts.
      bool const owned = std::any_of(
          primitives.begin(), primitives.begin() + static_cast<long>(m),
          [&](Shape const& p) { return dims > 1 && contains(p, domain, below) != contains(p, domain, above); });
      if (owned) continue;
      if (!in) f.area = -1.0 * f.area;
      if (!contains(region, domain, f.x) && !contains(region, domain, below) && !contains(region, domain, above))
        continue;
      if (counts(domain, f.x, in ? n : -1.0 * n)) kept.push_back(f);
    }
  }
  return kept;
}

bool is_clear(Shape const& shape, grid::Domain const& domain, Vec3 const& x, Vec3 const& direction, double smallest) {
  Box const box = bounds(shape);
  double far = 0.0;
  for (int d = 0; d < domain.dimensions(); ++d) {
    // No farther than the domain; the direction is one of the axes or not, the diagonal will do.
    double const low = std::max(box.lower[d], domain.lower[d]);
    double const high = std::min(box.upper[d], domain.upper(d));
    far += std::max(0.0, high - low);
  }
  // Behind the axis the other half of the same bodies is seen.
  if (grid::radial_exponent(domain.geometry) > 0 && direction[0] < 0.0) far = std::min(far, x[0] / -direction[0]);
  return is_clear_between(shape, domain.dimensions(), x, direction, 0.02 * smallest, far + 2.0 * smallest, smallest);
}

}  // namespace brisance::shape
