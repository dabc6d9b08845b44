#include "shape/drawn.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace brisance::shape {

namespace {

constexpr double pi = std::numbers::pi;

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

/// Throws unless the polygon bounds an area without touching itself; returns it anticlockwise.
Polygon checked(Polygon polygon, std::string const& what) {
  auto const refuse = [&](std::string const& message) -> void { throw InputError(what + ": " + message); };
  std::size_t const n = polygon.size();
  if (n < 3) refuse(fmt::format("a polygon of {} points bounds nothing; give at least three", n));
  for (std::size_t i = 0; i < n; ++i) {
    if (polygon[i] == polygon[(i + 1) % n])
      refuse(fmt::format("the points {} and {} are the same; the polygon is closed by itself, remove one of them",
                         i + 1, (i + 1) % n + 1));
  }
  for (std::size_t i = 0; i < n; ++i) {
    Corner const& before = polygon[i];
    Corner const& at = polygon[(i + 1) % n];
    Corner const& after = polygon[(i + 2) % n];
    bool const back = (at[0] - before[0]) * (after[0] - at[0]) + (at[1] - before[1]) * (after[1] - at[1]) < 0.0;
    if (turn(before, at, after) == 0.0 && back)
      refuse(fmt::format("at point {} the edge goes back over the one before; remove the point", (i + 1) % n + 1));
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      if (!meet(before, at, polygon[j], polygon[(j + 1) % n])) continue;
      refuse(fmt::format(
          "the edge from point {} to point {} meets the one from {} to {}; the points must follow the outline", i + 1,
          i + 2, j + 1, (j + 1) % n + 1));
    }
  }
  if (area(polygon) < 0.0) std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

/// Cuts an anticlockwise polygon into triangles, ear by ear: numbers of its corners.
std::vector<std::array<std::size_t, 3>> ears(Polygon const& polygon) {
  std::vector<std::size_t> left(polygon.size());
  for (std::size_t n = 0; n < left.size(); ++n) left[n] = n;
  std::vector<std::array<std::size_t, 3>> triangles;
  auto const is_ear = [&](std::size_t a, std::size_t b, std::size_t c) {
    if (!(turn(polygon[a], polygon[b], polygon[c]) > 0.0)) return false;
    return std::none_of(left.begin(), left.end(), [&](std::size_t p) {
      if (p == a || p == b || p == c) return false;
      return turn(polygon[a], polygon[b], polygon[p]) >= 0.0 && turn(polygon[b], polygon[c], polygon[p]) >= 0.0 &&
             turn(polygon[c], polygon[a], polygon[p]) >= 0.0;
    });
  };
  while (left.size() > 3) {
    std::size_t const n = left.size();
    std::size_t cut = n;
    for (std::size_t i = 0; i < n && cut == n; ++i) {
      if (is_ear(left[(i + n - 1) % n], left[i], left[(i + 1) % n])) cut = i;
    }
    // What has no ear consists of corners in line with their neighbours: one of them is taken out as a flat triangle.
    for (std::size_t i = 0; i < n && cut == n; ++i) {
      if (turn(polygon[left[(i + n - 1) % n]], polygon[left[i]], polygon[left[(i + 1) % n]]) == 0.0) cut = i;
    }
    if (cut == n) cut = 0;
    triangles.push_back({left[(cut + n - 1) % n], left[cut], left[(cut + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(cut));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

void add(std::vector<Vec3>& corners, Vec3 const& a, Vec3 const& b, Vec3 const& c) {
  if (a == b || b == c || c == a) return;
  corners.insert(corners.end(), {a, b, c});
}

}  // namespace

double area(Polygon const& polygon) {
  double twice = 0.0;
  for (std::size_t n = 1; n + 1 < polygon.size(); ++n) twice += turn(polygon[0], polygon[n], polygon[n + 1]);
  return 0.5 * twice;
}

Mesh prism(Polygon const& polygon, double from, double to, std::string const& what) {
  Polygon const outline = checked(polygon, what);
  std::vector<Vec3> corners;
  auto const at = [&](std::size_t n, double z) { return Vec3{outline[n][0], outline[n][1], z}; };
  for (auto const& [a, b, c] : ears(outline)) {
    add(corners, at(a, to), at(b, to), at(c, to));
    add(corners, at(a, from), at(c, from), at(b, from));
  }
  for (std::size_t n = 0; n < outline.size(); ++n) {
    std::size_t const next = (n + 1) % outline.size();
    add(corners, at(n, from), at(next, from), at(next, to));
    add(corners, at(n, from), at(next, to), at(n, to));
  }
  return {corners, what};
}

Mesh turned_profile(Polygon const& profile, std::string const& what, int edges) {
  Polygon const outline = checked(profile, what);
  for (std::size_t n = 0; n < profile.size(); ++n) {
    if (profile[n][0] < 0.0)
      throw InputError(
          fmt::format("{}: point {} has the radius {:g} m; radii are 0 or more", what, n + 1, profile[n][0]));
  }
  double const angle = 2.0 * pi / edges;
  double const same_area = std::sqrt(angle / std::sin(angle));
  auto const at = [&](std::size_t n, int step) {
    double const r = same_area * outline[n][0];
    double const phi = angle * (step % edges);
    return Vec3{r == 0.0 ? 0.0 : r * std::cos(phi), r == 0.0 ? 0.0 : r * std::sin(phi), outline[n][1]};
  };
  std::vector<Vec3> corners;
  for (std::size_t n = 0; n < outline.size(); ++n) {
    std::size_t const next = (n + 1) % outline.size();
    for (int step = 0; step < edges; ++step) {
      add(corners, at(n, step), at(n, step + 1), at(next, step + 1));
      add(corners, at(n, step), at(next, step + 1), at(next, step));
    }
  }
  return {corners, what};
}

Polygon cone_profile(double base, double top, double length) {
  Polygon profile{{0.0, 0.0}, {base, 0.0}};
  if (top > 0.0) profile.push_back({top, length});
  profile.push_back({0.0, length});
  return profile;
}

Polygon ogive_profile(double base, double length) {
  double const radius = (base * base + length * length) / (2.0 * base);
  double const whole = std::asin(std::min(1.0, length / radius));
  double const angle = length > base ? whole : 0.5 * pi;
  constexpr int chords = 256;
  Polygon profile{{0.0, 0.0}};
  for (int n = 0; n < chords; ++n) {
    double const phi = angle * n / chords;
    profile.push_back({base - radius * (1.0 - std::cos(phi)), radius * std::sin(phi)});
  }
  profile.push_back({0.0, length});
  return profile;
}

Polygon torus_profile(double radius, double tube) {
  constexpr int edges = 128;
  double const angle = 2.0 * pi / edges;
  double const same_area = std::sqrt(angle / std::sin(angle));
  Polygon profile;
  for (int n = 0; n < edges; ++n) {
    double const phi = angle * n;
    profile.push_back({radius + same_area * tube * std::cos(phi), same_area * tube * std::sin(phi)});
  }
  return profile;
}

}  // namespace brisance::shape
