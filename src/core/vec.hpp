/// Small fixed vectors for positions [m], velocities [m/s] and cell indices.
#pragma once

#include <array>
#include <cmath>

namespace brisance {

using Vec3 = std::array<double, 3>;
using Index3 = std::array<int, 3>;

inline Vec3 operator+(Vec3 const& a, Vec3 const& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 operator-(Vec3 const& a, Vec3 const& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3 operator*(double s, Vec3 const& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(Vec3 const& a, Vec3 const& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double norm(Vec3 const& a) { return std::sqrt(dot(a, a)); }

}  // namespace brisance
