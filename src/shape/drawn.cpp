#include "shape/drawn.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "shape/outline.hpp"

namespace brisance::shape {

namespace {

constexpr double pi = std::numbers::pi;

void add(std::vector<Vec3>& corners, Vec3 const& a, Vec3 const& b, Vec3 const& c) {
  if (a == b || b == c || c == a) return;
  corners.insert(corners.end(), {a, b, c});
}

}  // namespace

double area(Polygon const& polygon) {
  double twice = 0.0;
  for (std::size_t n = 1; n + 1 < polygon.size(); ++n) {
    Corner const& a = polygon[0];
    Corner const& b = polygon[n];
    Corner const& c = polygon[n + 1];
    twice += (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  }
  return 0.5 * twice;
}

Mesh prism(Polygon const& polygon, double from, double to, std::string const& what) {
  Cut const cut = cut_into_triangles({polygon, {}}, what);
  std::vector<Vec3> corners;
  auto const at = [&](std::size_t n, double z) { return Vec3{cut.corners[n][0], cut.corners[n][1], z}; };
  for (auto const& [a, b, c] : cut.triangles) {
    add(corners, at(a, to), at(b, to), at(c, to));
    add(corners, at(a, from), at(c, from), at(b, from));
  }
  for (auto const& [a, b] : cut.edges) {
    add(corners, at(a, from), at(b, from), at(b, to));
    add(corners, at(a, from), at(b, to), at(a, to));
  }
  return {corners, what};
}

Mesh turned_profile(Polygon const& profile, std::string const& what, int edges) {
  Polygon const outline = checked_outline(profile, what);
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
