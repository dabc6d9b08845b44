/// Triangle meshes of simple bodies, corner by corner, normals outwards.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "core/vec.hpp"

namespace brisance::shape::test {

/// Twelve triangles.
inline std::vector<Vec3> cube(Vec3 const& low, Vec3 const& high) {
  auto const corner = [&](int n) {
    return Vec3{(n & 1) != 0 ? high[0] : low[0], (n & 2) != 0 ? high[1] : low[1], (n & 4) != 0 ? high[2] : low[2]};
  };
  std::vector<Vec3> corners;
  for (auto const& q :
       {Index3{0, 2, 3}, Index3{0, 3, 1}, Index3{4, 5, 7}, Index3{4, 7, 6}, Index3{0, 1, 5}, Index3{0, 5, 4},
        Index3{2, 6, 7}, Index3{2, 7, 3}, Index3{0, 4, 6}, Index3{0, 6, 2}, Index3{1, 3, 7}, Index3{1, 7, 5}}) {
    for (int const n : q) corners.push_back(corner(n));
  }
  return corners;
}

/// A sphere by n parallels and 2 n meridians, its poles on a line along z.
inline std::vector<Vec3> ball(Vec3 const& centre, double radius, int n) {
  auto const point = [&](int i, int j) {
    double const theta = std::numbers::pi * i / n;
    double const phi = std::numbers::pi * (j % (2 * n)) / n;
    double const across = i == 0 || i == n ? 0.0 : radius * std::sin(theta);
    return centre + Vec3{across * std::cos(phi), across * std::sin(phi), radius * std::cos(theta)};
  };
  std::vector<Vec3> corners;
  auto const add = [&](Vec3 const& a, Vec3 const& b, Vec3 const& c) { corners.insert(corners.end(), {a, b, c}); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      if (i < n - 1) add(point(i, j), point(i + 1, j), point(i + 1, j + 1));
      if (i > 0) add(point(i, j), point(i + 1, j + 1), point(i, j + 1));
    }
  }
  return corners;
}

}  // namespace brisance::shape::test
