/// Generalised interpolation material point method, [Bardenhagen04]: the tent function averaged over the particle's
/// box. With a constant half length this is uGIMP; with one that is stretched with the material, cpGIMP [Wallstedt08].
#pragma once

namespace brisance::mpm {

struct Gimp {
  static constexpr char const* name = "gimp";
  static constexpr int support = 3;
  static constexpr int reach = 1;
  static constexpr double width = 1.0;
  static constexpr bool sized = true;
  static constexpr double longest_half = 0.5;    ///< in cells: a longer particle would touch a fourth node
  static constexpr double shortest_half = 1e-3;  ///< in cells: below, the average is the tent itself

  /// See `Linear::weights`; `half` is half the particle's length in cells.
  static void weights(double u, double half, int cells, int& first, double (&w)[support], double (&g)[support]) {
    double const last = cells;
    double const inside = u > 0.0 ? u : 0.0;
    double const shifted = inside + 0.5;
    auto nearest = static_cast<double>(static_cast<int>(shifted));
    nearest = nearest < last ? nearest : last;
    double const d = inside - nearest;
    double l = half > shortest_half ? half : shortest_half;
    l = l < longest_half ? l : longest_half;
    double const scale = 0.5 / l;
    first = static_cast<int>(nearest) - 1;
    // The box [d - l, d + l] lies in [-1, 1]. In each of the two cells the average of the tent is a mean ordinate times
    // the part of the box there, and the gradient is that part.
    double const low = d - l;
    double const high = d + l;
    double const left_end = low < 0.0 ? low : 0.0;  // part left of the nearest node: [left_end, left_top]
    double const left_top = high < 0.0 ? high : 0.0;
    double const right_end = high > 0.0 ? high : 0.0;  // part right of it: [right_foot, right_end]
    double const right_foot = low > 0.0 ? low : 0.0;
    double const left = (left_top - left_end) * scale;
    double const right = (right_end - right_foot) * scale;
    double const left_mean = 0.5 * (left_end + left_top);  // <= 0
    double const right_mean = 0.5 * (right_end + right_foot);
    w[0] = -left * left_mean;
    w[2] = right * right_mean;
    w[1] = left * (1.0 + left_mean) + right * (1.0 - right_mean);
    g[0] = -left;
    g[1] = left - right;
    g[2] = right;
  }
};

}  // namespace brisance::mpm
