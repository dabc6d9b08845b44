/// Weaker slopes of MUSCL-Hancock near rigid walls.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/loops.hpp"
#include "gas/kernels.hpp"

namespace brisance::gas {

/// Weakens the slopes of shocks near rigid surfaces, where they run towards the surface or have been reflected from it:
/// with full slopes a shock that is being reflected leaves a pressure that is 7 to 22 % too high at the surface for
/// tens of steps, and the peak at a wall is what is asked for. First order in the two cells at the surface, full slopes
/// from `near_wall_cells` on. A shock that leaves a plane of symmetry with gas at rest ahead of it keeps its slopes.
///
/// Puts the share of its slopes that a cell keeps into `a_share`; returns whether any keeps less than the whole.
template <bool Solid>
bool find_shocks_near_walls(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  constexpr double strong = 0.1;   // least pressure jump over a cell, of the pressure
  constexpr double towards = 0.1;  // least velocity ahead of it, of the velocity's jump
  int const st = b.stride;
  double const* const p = a[a_p];
  double const* const u = a[a_u];
  double const* const solid = a[a_solid];
  double* const share = a[a_share];
  bool any = false;
  for (WallRun const& run : *s.near_walls) {
    double const nearest = (run.distance - 1.0) / (near_wall_cells - 1.0);
    double const change = run.change / (near_wall_cells - 1.0);
    double const side = run.above ? 1.0 : -1.0;
    std::array<double, grid::most_bundle_cells> kept;
    long shocked = 0;
    BRISANCE_VECTOR_LOOP
    for (int n = 0; n < run.count; ++n) {
      int const q = run.q + n;
      double low_p = p[q - st];
      double high_p = p[q + st];
      double low_u = u[q - st];
      double high_u = u[q + st];
      if constexpr (Solid) {
        low_p += solid[q - st] * (p[q] - low_p);
        high_p += solid[q + st] * (p[q] - high_p);
        low_u -= solid[q - st] * (u[q] + low_u);
        high_u -= solid[q + st] * (u[q] + high_u);
      }
      double const least = std::min(p[q], std::min(low_p, high_p));
      double const jump = low_u - high_u;
      double const ahead = run.above ? low_u : high_u;
      bool const found =
          (std::abs(high_p - low_p) > strong * std::abs(least)) & (jump > 0.0) & (side * ahead > towards * jump);
      double const part = std::min(1.0, std::max(0.0, nearest + change * n));
      kept[n] = found ? part : 1.0;
      shocked += found ? 1 : 0;
    }
    if (shocked == 0) continue;
    if (!any) std::fill_n(share, b.total, 1.0);
    any = true;
    for (int n = 0; n < run.count; ++n) share[run.q + n] *= kept[n];
  }
  return any;
}

}  // namespace brisance::gas
