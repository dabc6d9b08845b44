/// How much of a cell a shape fills.
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

#include "shape/primitives.hpp"
#include "shape/volume.hpp"

namespace brisance::shape {

namespace {

/// Weight of the radius in a volume integral.
double radial_weight(grid::Geometry g, double r) {
  int const m = grid::radial_exponent(g);
  return m == 0 ? 1.0 : m == 1 ? std::abs(r) : r * r;
}

/// Of a combination or a mesh: lines along x, each of them exact.
double fraction_by_lines(Shape const& shape, grid::Metric const& cells, Index3 const& cell, int samples) {
  int const dims = cells.dimensions();
  Vec3 const middle = cells.centre(cell);
  double const half = 0.5 * cells.h;
  if (dims > 1) {
    Cover const seen = cover(shape, dims, middle, half);
    if (seen != Cover::cut) return seen == Cover::inside ? 1.0 : 0.0;
  }
  Box const box{{cells.face_radius(cell[0]), middle[1] - half, middle[2] - half},
                {cells.face_radius(cell[0] + 1), middle[1] + half, middle[2] + half}};
  double const f = fraction_of_box(shape, cells.geometry, box, samples);
  return f < 1e-12 ? 0.0 : f > 1.0 - 1e-12 ? 1.0 : f;
}

/// Of a primitive: points, where its distance does not decide.
template <typename Primitive>
double fraction_by_points(Primitive const& shape, grid::Metric const& cells, Index3 const& cell, int samples) {
  int const dims = cells.dimensions();
  Primitive const body = resolved(shape, dims);
  Vec3 const x = seen_from(shape, dims, cells.centre(cell));
  double const reach = 0.5 * cells.h * std::sqrt(static_cast<double>(dims));
  double const away = signed_distance(body, x);
  if (away >= reach) return 0.0;
  if (away <= -reach) return 1.0;

  if (dims == 1) {
    // Along a line every shape is an interval: integrate it exactly.
    Box const box = bounds(Shape(shape));
    double const from = std::max(box.lower[0], cells.face_radius(cell[0]));
    double const to = std::min(box.upper[0], cells.face_radius(cell[0] + 1));
    if (to <= from) return 0.0;
    grid::Metric part = cells;
    part.lower[0] = from;
    part.h = to - from;
    return std::min(1.0, std::abs(part.cell_volume(0) / cells.cell_volume(cell[0])));
  }

  double const step = cells.h / samples;
  Vec3 const low = cells.low_corner(cell);
  double inside = 0.0;
  double all = 0.0;
  long hits = 0;
  long points = 0;
  grid::CellRange const all_samples{{0, 0, 0}, {samples, samples, dims > 2 ? samples : 1}};
  for_each_cell(all_samples, [&](Index3 const& at) {
    Vec3 y = x;
    for (int d = 0; d < dims; ++d) y[d] = low[d] + (at[d] + 0.5) * step;
    double const weight = radial_weight(cells.geometry, y[0]);
    all += weight;
    ++points;
    if (signed_distance(body, y) <= 0.0) {
      inside += weight;
      ++hits;
    }
  });
  if (hits == 0) return 0.0;
  if (hits == points) return 1.0;
  return inside / all;
}

}  // namespace

double fill_fraction(Shape const& shape, grid::Metric const& cells, Index3 const& cell, int samples) {
  return std::visit(
      [&](auto const& s) {
        if constexpr (is_primitive<std::decay_t<decltype(s)>>) return fraction_by_points(s, cells, cell, samples);
        return fraction_by_lines(s, cells, cell, samples);
      },
      shape);
}

}  // namespace brisance::shape
