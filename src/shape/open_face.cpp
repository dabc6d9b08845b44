#include "shape/open_face.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shape/cut_cells.hpp"

namespace brisance::shape {

namespace {

/// Distance from a face at which is looked for what lies beside it [cells]: bodies often end exactly at one.
constexpr double beside_face = 1e-7;
/// Lines through a quarter of a face where its edges do not tell how it is cut.
constexpr int lines_through_quarter = 8;

/// The directions in which a body lies when `direction` is turned to x.
Index3 axes_along(int dimensions, int direction) {
  if (dimensions < 3) return direction == 0 ? Index3{0, 1, 2} : Index3{1, 0, 2};
  return {direction, (direction + 1) % 3, (direction + 2) % 3};
}

/// What a stretch of a line is to the gas.
struct Edge {
  enum class Kind { closed, open, low_end, high_end, pieces };
  Kind kind = Kind::closed;
  double at = 0.0;      ///< where it is cut
  double length = 0.0;  ///< of what is open

  [[nodiscard]] bool low_open() const { return kind == Kind::open || kind == Kind::low_end || low; }
  [[nodiscard]] bool high_open() const { return kind == Kind::open || kind == Kind::high_end || high; }
  bool low = false;  ///< of pieces: is that end open?
  bool high = false;
  bool apart = false;  ///< of pieces: does one reach neither end?
};

/// The stretch between two coordinates, of which `open` tells what is free.
Edge edge_of(std::vector<Span> const& open, double from, double to) {
  double const slack = 1e-9 * (to - from);
  Edge edge;
  std::vector<Span> within;
  for (Span const& s : open) {
    Span const part{std::max(s.from, from), std::min(s.to, to)};
    if (part.to - part.from <= slack) continue;
    within.push_back(part);
    edge.length += part.to - part.from;
  }
  if (within.empty()) return edge;
  bool const low = within.front().from <= from + slack;
  bool const high = within.back().to >= to - slack;
  if (within.size() == 1 && (low || high)) {
    edge.kind = low && high ? Edge::Kind::open : low ? Edge::Kind::low_end : Edge::Kind::high_end;
    edge.at = low ? within.front().to : within.front().from;
    return edge;
  }
  edge.kind = Edge::Kind::pieces;
  edge.low = low;
  edge.high = high;
  edge.apart = within.size() > static_cast<std::size_t>(low) + static_cast<std::size_t>(high);
  return edge;
}

using Point = std::array<double, 2>;

double area_of(std::vector<Point> const& polygon) {
  double twice = 0.0;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    Point const& a = polygon[n];
    Point const& b = polygon[(n + 1) % polygon.size()];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return 0.5 * std::abs(twice);
}

/// A rectangle with its four edges: below and above along the first direction, left and right along the second.
struct Rectangle {
  Point low, high;
  Edge below, above, left, right;

  /// The area of the open part if one straight line cuts it off; negative: that does not tell.
  [[nodiscard]] double open_area() const {
    std::vector<Point> open;
    int cuts = 0;
    bool simple = true;
    // Once around: the corner at the beginning of each edge if it is open, and where the edge is cut.
    auto const walk = [&](Edge const& edge, Point const& from, Point const& to, int along, bool forth) {
      simple = simple && edge.kind != Edge::Kind::pieces;
      bool const begins_open = forth ? edge.low_open() : edge.high_open();
      if (begins_open) open.push_back(from);
      if (edge.kind == Edge::Kind::low_end || edge.kind == Edge::Kind::high_end) {
        Point cut = to;
        cut[along] = edge.at;
        open.push_back(cut);
        ++cuts;
      }
    };
    walk(below, low, {high[0], low[1]}, 0, true);
    walk(right, {high[0], low[1]}, high, 1, true);
    walk(above, high, {low[0], high[1]}, 0, false);
    walk(left, {low[0], high[1]}, low, 1, false);
    if (!simple || cuts > 2) return -1.0;
    return area_of(open);
  }
};

}  // namespace

bool SurfaceLinks::connected() const {
  if (apart_) return false;
  std::array<int, surface_points> piece{};
  std::iota(piece.begin(), piece.end(), 0);
  auto const root = [&](int n) {
    while (piece[n] != n) n = piece[n];
    return n;
  };
  for (auto const& [a, b] : links_) piece[root(a)] = root(b);
  int first = -1;
  for (int n = 0; n < surface_points; ++n) {
    if (free_[n] == 0) continue;
    if (first < 0) first = root(n);
    if (root(n) != first) return false;
  }
  return true;
}

BodiesAlongAxes::BodiesAlongAxes(std::vector<Shape> const& shapes, grid::Domain const& domain) : domain_(domain) {
  int const dims = domain.dimensions();
  for (int d = 0; d < dims; ++d) {
    for (Shape const& shape : shapes) along_[d].push_back(d == 0 ? shape : turned(shape, axes_along(dims, d)));
  }
  for (Shape const& shape : shapes) around_.push_back(cells_around(shape, domain).grown(1, dims));
}

std::vector<int> BodiesAlongAxes::near(Index3 const& low, Index3 const& high) const {
  grid::CellRange const cells{low, {high[0] + 1, high[1] + 1, high[2] + 1}};
  std::vector<int> bodies;
  for (std::size_t n = 0; n < around_.size(); ++n) {
    if (!grid::common(around_[n], cells).empty()) bodies.push_back(static_cast<int>(n));
  }
  return bodies;
}

void BodiesAlongAxes::open_spans(std::vector<int> const& bodies, int direction, Vec3 x, double from, double to,
                                 std::vector<Span>& open) const {
  int const dims = domain_.dimensions();
  Index3 const axes = axes_along(dims, direction);
  thread_local std::vector<Span> solid;
  thread_local std::vector<Span> rest;
  open.assign(1, {from, to});
  for (int const n : bodies) {
    spans(along_[direction][n], dims, dims > 1 ? x[axes[1]] : 0.0, dims > 2 ? x[axes[2]] : 0.0, solid);
    for (Span const& s : solid) {
      rest.clear();
      for (Span const& f : open) {
        if (s.from >= f.to || s.to <= f.from) {
          rest.push_back(f);
          continue;
        }
        if (f.from < s.from) rest.push_back({f.from, s.from});
        if (s.to < f.to) rest.push_back({s.to, f.to});
      }
      open.swap(rest);
    }
  }
}

double BodiesAlongAxes::measure(int direction, double from, double to) const {
  if (direction != 0 || grid::radial_exponent(domain_.geometry) == 0) return to - from;
  return radial_integral(domain_.geometry, to) - radial_integral(domain_.geometry, from);
}

bool BodiesAlongAxes::lies_on_flat_face(std::vector<int> const& bodies, int direction, double at) const {
  double const slack = 2.0 * beside_face * domain_.smallest_cell();
  std::vector<double> found;
  for (int const n : bodies) breaks(along_[0][n], direction, at - slack, at + slack, found);
  return !found.empty();
}

double BodiesAlongAxes::open_face(Index3 const& cell, int direction) const {
  std::vector<int> const bodies = near(grid::beside(cell, direction, 0), cell);
  if (bodies.empty()) return 1.0;
  double const at = domain_.face(direction, cell[direction]);
  double part = 1.0;
  if (lies_on_flat_face(bodies, direction, at)) {
    double const off = beside_face * domain_.smallest_cell();
    part = std::min(open_part(bodies, cell, direction, at - off), open_part(bodies, cell, direction, at + off));
  } else {
    part = open_part(bodies, cell, direction, at);
  }
  return part < sliver ? 0.0 : part > 1.0 - sliver ? 1.0 : part;
}

double BodiesAlongAxes::open_part(std::vector<int> const& bodies, Index3 const& cell, int direction, double at) const {
  int const dims = domain_.dimensions();
  if (dims == 3) return open_square(bodies, cell, direction, at);
  Vec3 x = domain_.centre(cell);
  x[direction] = at;
  if (dims == 1) {
    return std::any_of(bodies.begin(), bodies.end(), [&](int n) { return contains(along_[0][n], domain_, x); }) ? 0.0
                                                                                                                : 1.0;
  }
  int const across = 1 - direction;
  double const low = domain_.face(across, cell[across]);
  double const high = domain_.face(across, cell[across] + 1);
  std::vector<Span> open;
  open_spans(bodies, across, x, low, high, open);
  double sum = 0.0;
  for (Span const& s : open) sum += measure(across, s.from, s.to);
  return sum / measure(across, low, high);
}

std::vector<Span> BodiesAlongAxes::pieces(std::vector<int> const& bodies, Index3 const& cell, int direction) const {
  double const low = domain_.face(direction, cell[direction]);
  double const high = domain_.face(direction, cell[direction] + 1);
  double const off = beside_face * domain_.smallest_cell();
  std::vector<double> ends{0.5 * (low + high)};
  for (int const n : bodies) breaks(along_[0][n], direction, low + 4.0 * off, high - 4.0 * off, ends);
  std::sort(ends.begin(), ends.end());
  ends.push_back(high);
  std::vector<Span> pieces;
  double from = low;
  for (double const to : ends) {
    if (to - from < 4.0 * off) continue;
    pieces.push_back({from + off, to - off});
    from = to;
  }
  return pieces;
}

double BodiesAlongAxes::open_square(std::vector<int> const& bodies, Index3 const& cell, int direction,
                                    double at) const {
  int const first = (direction + 1) % 3;
  int const second = (direction + 2) % 3;
  // Halves of the face in each direction, and what flat faces of bodies divide: boxes are exact.
  std::vector<Span> const across = pieces(bodies, cell, first);
  std::vector<Span> const along = pieces(bodies, cell, second);
  Vec3 x{0.0, 0.0, 0.0};
  x[direction] = at;
  double const low = across.front().from;
  double const high = across.back().to;
  std::vector<Span> open;
  auto const line = [&](int along_direction, int other, double place, double from, double to) {
    x[other] = place;
    open_spans(bodies, along_direction, x, from, to, open);
    return open;
  };
  // The edges of all rectangles: two lines at the ends of each piece.
  std::vector<std::array<std::vector<Span>, 2>> rows;
  std::vector<std::array<std::vector<Span>, 2>> columns;
  rows.reserve(along.size());
  columns.reserve(across.size());
  for (Span const& s : along)
    rows.push_back({line(first, second, s.from, low, high), line(first, second, s.to, low, high)});
  for (Span const& s : across) {
    columns.push_back({line(second, first, s.from, along.front().from, along.back().to),
                       line(second, first, s.to, along.front().from, along.back().to)});
  }
  double sum = 0.0;
  double whole = 0.0;
  for (std::size_t i = 0; i < across.size(); ++i) {
    for (std::size_t j = 0; j < along.size(); ++j) {
      Rectangle r;
      r.low = {across[i].from, along[j].from};
      r.high = {across[i].to, along[j].to};
      r.below = edge_of(rows[j][0], r.low[0], r.high[0]);
      r.above = edge_of(rows[j][1], r.low[0], r.high[0]);
      r.left = edge_of(columns[i][0], r.low[1], r.high[1]);
      r.right = edge_of(columns[i][1], r.low[1], r.high[1]);
      double area = r.open_area();
      if (area < 0.0) {
        area = 0.0;
        double const step = (r.high[1] - r.low[1]) / lines_through_quarter;
        for (int n = 0; n < lines_through_quarter; ++n) {
          for (Span const& s : line(first, second, r.low[1] + (n + 0.5) * step, r.low[0], r.high[0]))
            area += step * (s.to - s.from);
        }
      }
      sum += area;
      whole += (r.high[0] - r.low[0]) * (r.high[1] - r.low[1]);
    }
  }
  return sum / whole;
}

SurfaceLinks BodiesAlongAxes::links(Index3 const& cell) const {
  int const dims = domain_.dimensions();
  std::vector<int> const bodies = near(cell, cell);
  SurfaceLinks links;
  double const off = beside_face * domain_.smallest_cell();
  auto const place = [&](int d, int step) {
    double const low = domain_.face(d, cell[d]);
    double const high = domain_.face(d, cell[d] + 1);
    return step == 0 ? low + off : step == 1 ? 0.5 * (low + high) : high - off;
  };
  std::vector<Span> open;
  for (int d = 0; d < dims; ++d) {
    int const first = d == 0 ? 1 : 0;
    int const second = 3 - d - first;
    for (int n = 0; n < 3; ++n) {
      for (int m = 0; m < (dims > 2 ? 3 : 1); ++m) {
        // Lines through the middle of the cell do not lie in its surface.
        bool const in_surface = n != 1 || (dims > 2 && m != 1);
        if (!in_surface || (dims == 1 && n > 0)) continue;
        Index3 at{0, 0, 0};
        at[first] = n;
        if (dims > 2) at[second] = m;
        Vec3 x = domain_.centre(cell);
        x[first] = place(first, n);
        if (dims > 2) x[second] = place(second, m);
        open_spans(bodies, d, x, place(d, 0), place(d, 2), open);
        for (int step = 0; step < 2; ++step) {
          Edge const edge = edge_of(open, place(d, step), place(d, step + 1));
          Index3 from = at;
          Index3 to = at;
          from[d] = step;
          to[d] = step + 1;
          if (edge.low_open()) links.set_free(SurfaceLinks::point(from));
          if (edge.high_open()) links.set_free(SurfaceLinks::point(to));
          if (edge.kind == Edge::Kind::open) links.link(SurfaceLinks::point(from), SurfaceLinks::point(to));
          if (edge.apart) links.set_apart();
        }
      }
    }
  }
  return links;
}

}  // namespace brisance::shape
