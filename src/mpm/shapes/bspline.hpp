/// Quadratic B-splines with the nodes of the grid at their centres, [Steffen08].
#pragma once

namespace brisance::mpm {

struct BSpline {
  static constexpr char const* name = "bspline";
  static constexpr int support = 3;
  static constexpr int reach = 1;
  static constexpr double width = 1.5;
  static constexpr bool sized = false;

  /// See `Linear::weights`.
  static void weights(double u, double /*half*/, int cells, int& first, double (&w)[support], double (&g)[support]) {
    double const last = cells;
    double const inside = u > 0.0 ? u : 0.0;
    double const shifted = inside + 0.5;
    auto nearest = static_cast<double>(static_cast<int>(shifted));
    nearest = nearest < last ? nearest : last;
    double const d = inside - nearest;  // -1/2 to 1/2
    first = static_cast<int>(nearest) - 1;
    w[0] = 0.5 * (0.5 - d) * (0.5 - d);
    w[1] = 0.75 - d * d;
    w[2] = 0.5 * (0.5 + d) * (0.5 + d);
    g[0] = d - 0.5;
    g[1] = -2.0 * d;
    g[2] = d + 0.5;
  }
};

}  // namespace brisance::mpm
