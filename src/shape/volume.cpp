/// Volumes of shapes: closed forms, or integrals over lines along x, each of them exact.
#include "shape/volume.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <variant>
#include <vector>

#include "shape/primitives.hpp"

namespace brisance::shape {

namespace {

constexpr double pi = std::numbers::pi;

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

}  // namespace

double volume(Shape const& shape, grid::Geometry geometry) {
  using grid::Geometry;
  struct Visitor {
    Geometry g;
    double operator()(Everywhere const&) const { return infinity; }
    double operator()(HalfSpace const&) const { return infinity; }
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
    double operator()(Mesh const& s) const {
      return g == Geometry::cartesian3d && !s.overlaps() ? s.volume() : integrated_volume(s, g);
    }
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
    spans(shape_, grid::dimensions(geometry_), y, z, spans_, {low_, high_});
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

/// Integral of f between two coordinates. Between the `ends`, in any order, it changes without jumps, or not at all.
template <typename Function>
double integral(Function const& f, std::vector<double> ends, bool constant, double low, double high, double bound) {
  constexpr int halvings = 20;
  int const intervals = 32;
  double const slack = 1e-9 * (high - low);
  std::sort(ends.begin(), ends.end());
  ends.push_back(high);
  double sum = 0.0;
  double from = low;
  for (double const to : ends) {
    if (to - from <= slack && to < high) continue;
    if (constant) {
      sum += (to - from) * f(0.5 * (from + to));
      from = to;
      continue;
    }
    int const n = std::max(4, static_cast<int>(std::ceil(intervals * (to - from) / (high - low))));
    // Just within the piece, as f may jump at its ends.
    double const inset = std::min(slack, 1e-3 * (to - from));
    double const step = (to - from - 2.0 * inset) / n;
    double before = f(from + inset);
    double fraction = 0.0;
    for (int q = 0; q < n; ++q) {
      double const a = from + inset + q * step;
      double const after = f(a + step);
      fraction += simpson(f, a, a + step, {before, f(a + 0.5 * step), after}, bound, halvings);
      before = after;
    }
    sum += fraction * (to - from) / (to - from - 2.0 * inset);
    from = to;
  }
  return sum;
}

/// Where the section of a shape may jump within a box, but for its ends.
std::vector<double> jumps(Shape const& shape, int dimensions, int direction, Box box) {
  double const slack = 1e-9 * (box.upper[direction] - box.lower[direction]);
  box.lower[direction] += slack;
  box.upper[direction] -= slack;
  std::vector<double> ends;
  if (dimensions == 3) {
    breaks(shape, direction, box, ends);
  } else {
    breaks(shape, direction, box.lower[direction], box.upper[direction], ends);
  }
  return ends;
}

bool is_upright(Shape const& shape) {
  auto const* mesh = std::get_if<Mesh>(&shape);
  return mesh != nullptr && mesh->upright();
}

double volume_by_lines(Shape const& shape, grid::Geometry geometry, Box const& box) {
  int const dims = grid::dimensions(geometry);
  Line line(shape, geometry, box);
  double const length = line.whole();
  Vec3 size{1.0, 1.0, 1.0};
  for (int d = 1; d < dims; ++d) size[d] = box.upper[d] - box.lower[d];
  if (!(length > 0.0 && size[1] > 0.0 && size[2] > 0.0)) return 0.0;
  if (dims == 1) return line.inside(0.0, 0.0);
  // A ten-millionth of the box for each interval that is not halved further: some tens of them lie at rims.
  double const bound = 1e-7 * length * size[1];
  auto const ys = jumps(shape, dims, 1, box);
  auto const row = [&](double z) {
    return integral([&](double y) { return line.inside(y, z); }, ys, false, box.lower[1], box.upper[1], bound);
  };
  if (dims == 2) return row(0.0);
  return integral(row, jumps(shape, dims, 2, box), is_upright(shape), box.lower[2], box.upper[2], bound * size[2]);
}

/// The same of a mesh with many faces, halved until few of them lie in each part.
double volume_in_parts(Mesh const& mesh, Box const& box, int halvings) {
  constexpr std::size_t few = 12;
  if (!mesh.touches(box.lower, box.upper)) {
    Vec3 const size = box.upper - box.lower;
    return mesh.contains(0.5 * (box.lower + box.upper)) ? size[0] * size[1] * size[2] : 0.0;
  }
  if (halvings == 0 || jumps(mesh, 3, 1, box).size() + jumps(mesh, 3, 2, box).size() <= few)
    return volume_by_lines(mesh, grid::Geometry::cartesian3d, box);
  int longest = 0;
  for (int d = 1; d < 3; ++d) {
    if (box.upper[d] - box.lower[d] > box.upper[longest] - box.lower[longest]) longest = d;
  }
  Box low = box;
  Box high = box;
  low.upper[longest] = high.lower[longest] = 0.5 * (box.lower[longest] + box.upper[longest]);
  return volume_in_parts(mesh, low, halvings - 1) + volume_in_parts(mesh, high, halvings - 1);
}

}  // namespace

double fraction_of_box(Shape const& shape, grid::Geometry geometry, Box const& box, int lines) {
  int const dims = grid::dimensions(geometry);
  Line line(shape, geometry, box);
  std::vector<Station> const single{{0.0, 1.0}};
  auto const along = [&](int d) {
    int const count = d == 2 && is_upright(shape) ? 1 : lines;
    return d < dims ? stations(jumps(shape, dims, d, box), box.lower[d], box.upper[d], count,
                               1e-9 * (box.upper[d] - box.lower[d]))
                    : single;
  };
  auto const ys = along(1);
  double sum = 0.0;
  for (Station const& z : along(2)) {
    for (Station const& y : ys) sum += z.share * y.share * line.inside(y.at, z.at);
  }
  return sum / line.whole();
}

double volume_within(Shape const& shape, grid::Geometry geometry, Box const& box) {
  constexpr std::size_t many = 64;
  constexpr int halvings = 48;
  auto const* mesh = std::get_if<Mesh>(&shape);
  bool const in_parts = mesh != nullptr && geometry == grid::Geometry::cartesian3d &&
                        mesh->faces(1).size() + mesh->faces(2).size() > many;
  for (int d = 0; in_parts && d < 3; ++d) {
    if (!(box.upper[d] > box.lower[d])) return 0.0;
  }
  return in_parts ? volume_in_parts(*mesh, box, halvings) : volume_by_lines(shape, geometry, box);
}

}  // namespace brisance::shape
