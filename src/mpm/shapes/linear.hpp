/// Linear (tent) shape functions, in 3D the 8-node brick of [Cui14] Eq. (16).
#pragma once

namespace brisance::mpm {

struct Linear {
  static constexpr char const* name = "linear";
  static constexpr int support = 2;     ///< nodes per direction
  static constexpr int reach = 0;       ///< nodes that a particle may touch beyond those of its cell
  static constexpr double width = 1.0;  ///< how far it reaches from its node [cells]; `sized`: and half the particle
  static constexpr bool sized = false;

  /// First node, weights and gradients (per cell) at u, the coordinate in cells counted from the block's first node of
  /// which the block has `cells`. `half` (half the particle's length in cells) is not used.
  static void weights(double u, double /*half*/, int cells, int& first, double (&w)[support], double (&g)[support]) {
    double const last = cells - 1;
    double const inside = u > 0.0 ? u : 0.0;
    auto cell = static_cast<double>(static_cast<int>(inside));
    cell = cell < last ? cell : last;
    double const xi = inside - cell;
    first = static_cast<int>(cell);
    w[0] = 1.0 - xi;
    w[1] = xi;
    g[0] = -1.0;
    g[1] = 1.0;
  }
};

}  // namespace brisance::mpm
