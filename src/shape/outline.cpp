#include "shape/outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "core/error.hpp"

namespace brisance::shape {

namespace {

/// Twice the signed area of the triangle (a, b, c).
double turn(Corner const& a, Corner const& b, Corner const& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Lies c, which is in line with a and b, between them?
bool between(Corner const& a, Corner const& b, Corner const& c) {
  for (int d = 0; d < 2; ++d) {
    if (c[d] < std::min(a[d], b[d]) || c[d] > std::max(a[d], b[d])) return false;
  }
  return true;
}

/// Have two straight lines a point in common?
bool meet(Corner const& a, Corner const& b, Corner const& c, Corner const& d) {
  double const abc = turn(a, b, c);
  double const abd = turn(a, b, d);
  double const cda = turn(c, d, a);
  double const cdb = turn(c, d, b);
  if (((abc > 0.0 && abd < 0.0) || (abc < 0.0 && abd > 0.0)) && ((cda > 0.0 && cdb < 0.0) || (cda < 0.0 && cdb > 0.0)))
    return true;
  return (abc == 0.0 && between(a, b, c)) || (abd == 0.0 && between(a, b, d)) || (cda == 0.0 && between(c, d, a)) ||
         (cdb == 0.0 && between(c, d, b));
}

/// " of hole 2"; nothing of the outline.
std::string of_ring(std::size_t ring) { return ring == 0 ? std::string() : fmt::format(" of hole {}", ring); }

/// The outline and the holes, with what is wrong with them.
class Rings {
 public:
  Rings(std::vector<Polygon> const& rings, std::string const& what) : rings_(rings), what_(what) {}

  void check() const {
    for (std::size_t r = 0; r < rings_.size(); ++r) check_corners(r);
    auto const first = first_meeting();
    if (first) {
      auto const& [e, f] = *first;
      refuse(
          fmt::format("the edge from point {} to point {}{} meets the one from {} to {}{}; the points must follow the "
                      "outline",
                      e.at + 1, next(e) + 1, of_ring(e.ring), f.at + 1, next(f) + 1, of_ring(f.ring)));
    }
    for (std::size_t r = 1; r < rings_.size(); ++r) {
      Corner const& x = rings_[r].front();
      if (!contains(rings_.front(), x)) refuse(fmt::format("hole {} lies outside the outline; remove it", r));
      for (std::size_t s = 1; s < rings_.size(); ++s) {
        if (s != r && contains(rings_[s], x)) refuse(fmt::format("hole {} lies within hole {}; remove it", r, s));
      }
    }
  }

 private:
  struct Edge {
    std::size_t ring = 0;
    std::size_t at = 0;
    bool operator==(Edge const&) const = default;
    bool operator<(Edge const& other) const { return std::tie(ring, at) < std::tie(other.ring, other.at); }
  };

  [[noreturn]] void refuse(std::string const& message) const { throw InputError(what_ + ": " + message); }
  [[nodiscard]] std::size_t next(Edge const& e) const { return (e.at + 1) % rings_[e.ring].size(); }
  [[nodiscard]] Corner const& from(Edge const& e) const { return rings_[e.ring][e.at]; }
  [[nodiscard]] Corner const& to(Edge const& e) const { return rings_[e.ring][next(e)]; }
  [[nodiscard]] double low(Edge const& e, int d) const { return std::min(from(e)[d], to(e)[d]); }
  [[nodiscard]] double high(Edge const& e, int d) const { return std::max(from(e)[d], to(e)[d]); }
  [[nodiscard]] bool neighbours(Edge const& e, Edge const& f) const {
    return e.ring == f.ring && (next(e) == f.at || next(f) == e.at);
  }

  void check_corners(std::size_t ring) const {
    Polygon const& polygon = rings_[ring];
    std::size_t const n = polygon.size();
    if (n < 3) refuse(fmt::format("a polygon of {} points bounds nothing{}; give at least three", n, of_ring(ring)));
    for (std::size_t i = 0; i < n; ++i) {
      if (polygon[i] == polygon[(i + 1) % n]) {
        refuse(fmt::format("the points {} and {}{} are the same; the polygon is closed by itself, remove one of them",
                           i + 1, (i + 1) % n + 1, of_ring(ring)));
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      Corner const& before = polygon[i];
      Corner const& at = polygon[(i + 1) % n];
      Corner const& after = polygon[(i + 2) % n];
      bool const back = (at[0] - before[0]) * (after[0] - at[0]) + (at[1] - before[1]) * (after[1] - at[1]) < 0.0;
      if (turn(before, at, after) == 0.0 && back) {
        refuse(fmt::format("at point {}{} the edge goes back over the one before; remove the point", (i + 1) % n + 1,
                           of_ring(ring)));
      }
    }
  }

  /// The first two edges, in the order of the corners, that cross or touch. Only edges whose extents in x overlap are
  /// compared.
  [[nodiscard]] std::optional<std::pair<Edge, Edge>> first_meeting() const {
    std::vector<Edge> edges;
    for (std::size_t r = 0; r < rings_.size(); ++r) {
      for (std::size_t n = 0; n < rings_[r].size(); ++n) edges.push_back({r, n});
    }
    std::sort(edges.begin(), edges.end(),
              [this](Edge const& e, Edge const& f) { return std::pair(low(e, 0), e) < std::pair(low(f, 0), f); });
    std::optional<std::pair<Edge, Edge>> first;
    for (std::size_t m = 0; m < edges.size(); ++m) {
      double const end = high(edges[m], 0);
      for (std::size_t n = m + 1; n < edges.size() && low(edges[n], 0) <= end; ++n) {
        auto const& [e, f] = std::minmax(edges[m], edges[n]);
        if (low(e, 1) > high(f, 1) || low(f, 1) > high(e, 1) || neighbours(e, f)) continue;
        if ((!first || std::pair(e, f) < *first) && meet(from(e), to(e), from(f), to(f))) first = std::pair(e, f);
      }
    }
    return first;
  }

  std::vector<Polygon> const& rings_;
  std::string const& what_;
};

/// Joins holes to the outline by bridges and cuts off ear by ear [Eberly02]. Corners have numbers; a bridge makes its
/// two corners occur twice.
class Ears {
 public:
  explicit Ears(std::vector<Corner> const& corners) : corners_(corners) {}

  /// Numbers of the corners from `from` on.
  void start(std::size_t from, std::size_t to) { left_ = numbers(from, to); }

  /// A hole, clockwise, whose rightmost corner is joined to a corner of what is there. Holes come in the order of these
  /// corners, from the right.
  void join(std::size_t from, std::size_t to) {
    std::vector<std::size_t> hole = numbers(from, to);
    std::rotate(hole.begin(), rightmost(hole), hole.end());
    std::size_t const where = seen_from(corners_[hole.front()]);
    std::vector<std::size_t> detour{left_[where]};
    detour.insert(detour.end(), hole.begin(), hole.end());
    detour.push_back(hole.front());
    left_.insert(left_.begin() + static_cast<std::ptrdiff_t>(where), detour.begin(), detour.end());
  }

  [[nodiscard]] std::vector<std::size_t>::iterator rightmost(std::vector<std::size_t>& ring) const {
    return std::max_element(ring.begin(), ring.end(),
                            [this](std::size_t a, std::size_t b) { return corners_[a] < corners_[b]; });
  }

  std::vector<std::array<std::size_t, 3>> cut() {
    std::vector<std::array<std::size_t, 3>> triangles;
    std::size_t begin = 0;
    while (left_.size() > 3) {
      std::size_t const n = left_.size();
      std::size_t at = n;
      for (std::size_t i = 0; i < n && at == n; ++i) {
        if (is_ear((begin + i) % n)) at = (begin + i) % n;
      }
      // What has no ear consists of corners in line with their neighbours: one of them is taken out as a flat triangle.
      for (std::size_t i = 0; i < n && at == n; ++i) {
        auto const [a, b, c] = around(i);
        if (turn(corners_[a], corners_[b], corners_[c]) == 0.0) at = i;
      }
      if (at == n) at = 0;
      triangles.push_back(around(at));
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
      begin = at;
    }
    triangles.push_back({left_[0], left_[1], left_[2]});
    return triangles;
  }

 private:
  static std::vector<std::size_t> numbers(std::size_t from, std::size_t to) {
    std::vector<std::size_t> all(to - from);
    std::iota(all.begin(), all.end(), from);
    return all;
  }

  [[nodiscard]] std::array<std::size_t, 3> around(std::size_t i) const {
    std::size_t const n = left_.size();
    return {left_[(i + n - 1) % n], left_[i], left_[(i + 1) % n]};
  }

  [[nodiscard]] bool is_ear(std::size_t i) const {
    auto const numbers = around(i);
    Corner const& a = corners_[numbers[0]];
    Corner const& b = corners_[numbers[1]];
    Corner const& c = corners_[numbers[2]];
    if (!(turn(a, b, c) > 0.0)) return false;
    Corner const low{std::min({a[0], b[0], c[0]}), std::min({a[1], b[1], c[1]})};
    Corner const high{std::max({a[0], b[0], c[0]}), std::max({a[1], b[1], c[1]})};
    return std::none_of(left_.begin(), left_.end(), [&](std::size_t n) {
      Corner const& p = corners_[n];
      if (p[0] < low[0] || p[0] > high[0] || p[1] < low[1] || p[1] > high[1]) return false;
      if (n == numbers[0] || n == numbers[1] || n == numbers[2]) return false;
      return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    });
  }

  /// The place in `left_` of a corner that a point within the region sees: an end of the edge that lies to the right of
  /// it, or the corner before that edge at the least angle.
  [[nodiscard]] std::size_t seen_from(Corner const& m) const {
    std::size_t const n = left_.size();
    std::size_t best = n;
    Corner hit{};
    for (std::size_t i = 0; i < n; ++i) {
      Corner const& a = corners_[left_[i]];
      Corner const& b = corners_[left_[(i + 1) % n]];
      // With the region on its left, an edge to the right of a point of it leads upwards.
      if (!(a[1] <= m[1] && b[1] >= m[1] && b[1] > a[1])) continue;
      double const x = a[0] + (m[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
      if (x < m[0] || (best < n && x >= hit[0])) continue;
      best = a[0] > b[0] ? i : (i + 1) % n;
      hit = {x, m[1]};
    }
    if (best == n) return 0;
    Corner const p = corners_[left_[best]];
    double least = std::abs(p[1] - m[1]) / (p[0] - m[0]);
    bool const above = p[1] > m[1];
    for (std::size_t i = 0; i < n; ++i) {
      auto const [before, at, after] = around(i);
      Corner const& q = corners_[at];
      if (q == p || !(q[0] > m[0]) || turn(corners_[before], q, corners_[after]) > 0.0) continue;
      double const s = above ? 1.0 : -1.0;
      if (s * turn(m, hit, q) < 0.0 || s * turn(hit, p, q) < 0.0 || s * turn(p, m, q) < 0.0) continue;
      double const slope = std::abs(q[1] - m[1]) / (q[0] - m[0]);
      if (slope > least || (slope == least && q[0] >= corners_[left_[best]][0])) continue;
      least = slope;
      best = i;
    }
    return opening_to(best, m);
  }

  /// Of a corner that occurs several times the place whose angle opens to m.
  [[nodiscard]] std::size_t opening_to(std::size_t place, Corner const& m) const {
    for (std::size_t i = 0; i < left_.size(); ++i) {
      if (left_[i] != left_[place]) continue;
      auto const numbers = around(i);
      Corner const& a = corners_[numbers[0]];
      Corner const& b = corners_[numbers[1]];
      Corner const& c = corners_[numbers[2]];
      bool const left_of_first = turn(a, b, m) > 0.0;
      bool const left_of_second = turn(b, c, m) > 0.0;
      bool const convex = turn(a, b, c) > 0.0;
      if (convex ? left_of_first && left_of_second : left_of_first || left_of_second) return i;
    }
    return place;
  }

  std::vector<Corner> const& corners_;
  std::vector<std::size_t> left_;
};

void turn_to(Polygon& polygon, bool anticlockwise) {
  if ((area(polygon) > 0.0) != anticlockwise) std::reverse(polygon.begin(), polygon.end());
}

}  // namespace

bool contains(Polygon const& polygon, Corner const& x) {
  bool inside = false;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    Corner const& a = polygon[n];
    Corner const& b = polygon[(n + 1) % polygon.size()];
    if ((a[1] > x[1]) == (b[1] > x[1])) continue;
    if (x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
  }
  return inside;
}

Polygon checked_outline(Polygon polygon, std::string const& what) {
  Rings({polygon}, what).check();
  turn_to(polygon, true);
  return polygon;
}

Cut cut_into_triangles(Region region, std::string const& what) {
  std::vector<Polygon> rings{std::move(region.outline)};
  for (Polygon& hole : region.holes) rings.push_back(std::move(hole));
  Rings(rings, what).check();
  Cut cut;
  std::vector<std::size_t> starts{0};
  double wanted = 0.0;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    turn_to(rings[r], r == 0);
    wanted += area(rings[r]);
    std::size_t const first = starts.back();
    for (std::size_t n = 0; n < rings[r].size(); ++n) {
      cut.corners.push_back(rings[r][n]);
      cut.edges.push_back({first + n, first + (n + 1) % rings[r].size()});
    }
    starts.push_back(cut.corners.size());
  }
  Ears ears(cut.corners);
  ears.start(0, starts[1]);
  auto const right_end = [&](std::size_t r) { return *std::max_element(rings[r].begin(), rings[r].end()); };
  std::vector<std::size_t> order(rings.size() - 1);
  std::iota(order.begin(), order.end(), 1);
  std::sort(order.begin(), order.end(), [&](std::size_t r, std::size_t s) { return right_end(r) > right_end(s); });
  for (std::size_t const r : order) ears.join(starts[r], starts[r + 1]);
  cut.triangles = ears.cut();
  double covered = 0.0;
  for (auto const& [a, b, c] : cut.triangles)
    covered += 0.5 * std::abs(turn(cut.corners[a], cut.corners[b], cut.corners[c]));
  constexpr double round_off = 1e-9;
  if (!(std::abs(covered - wanted) <= round_off * std::abs(area(rings.front())))) {
    throw InputError(what +
                     ": its triangles do not add up to its area: points lie too close together for their coordinates; "
                     "simplify the outline, or move its origin closer");
  }
  return cut;
}

}  // namespace brisance::shape
