/// Bounds on the reconstruction of MUSCL-Hancock beside its limiter: slopes near rigid walls, and a fluid's own density
/// where that fluid is the lesser part of a cell.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/loops.hpp"
#include "gas/kernels.hpp"

namespace brisance::gas {

/// Marks the cells where a fluid's own density is to be bounded: where that fluid is the lesser part and its
/// density differs from that of the neighbours that hold some of it, in all by more than 1 %. Returns how many there
/// are.
inline long find_uneven_phase(BundleLayout const& b, BundleArrays& a, int fluid) {
  constexpr double lesser_part = 0.5;
  constexpr double even = 0.01;
  int const st = b.stride;
  double const* const partial = a[partial_density(fluid)];
  double const* const alpha = a[volume_fraction(fluid)];
  double* const uneven = a[a_uneven(fluid)];
  long count = 0;
  BRISANCE_VECTOR_LOOP
  for (int q = st; q < b.total - st; ++q) {
    // Multiplied by the three volume fractions, for a division is dear.
    double const own = alpha[q];
    bool const below = alpha[q - st] > vanishing_fraction;
    bool const above = alpha[q + st] > vanishing_fraction;
    double const alpha_below = below ? alpha[q - st] : own;
    double const alpha_above = above ? alpha[q + st] : own;
    double const partial_below = below ? partial[q - st] : partial[q];
    double const partial_above = above ? partial[q + st] : partial[q];
    double const step_below = std::abs(partial_below * own - partial[q] * alpha_below) * alpha_above;
    double const step_above = std::abs(partial_above * own - partial[q] * alpha_above) * alpha_below;
    bool const found = (own > vanishing_fraction) & (own <= lesser_part) & (partial[q] > 0.0) &
                       (step_below + step_above > even * partial[q] * alpha_below * alpha_above);
    uneven[q] = found ? 1.0 : 0.0;
    count += found ? 1 : 0;
  }
  return count;
}

/// Least and largest of a quantity of a fluid in a cell and the neighbours that hold some of that fluid.
struct PhaseRange {
  double least, most;

  template <class Quantity>
  PhaseRange(BundleLayout const& b, BundleArrays& a, int fluid, int q, Quantity const& quantity)
      : least(quantity(q)), most(least) {
    for (int const neighbour : {q - b.stride, q + b.stride}) {
      if (a[volume_fraction(fluid)][neighbour] <= vanishing_fraction || a[partial_density(fluid)][neighbour] <= 0.0)
        continue;
      double const x = quantity(neighbour);
      least = std::min(least, x);
      most = std::max(most, x);
    }
  }
};

/// Keeps a fluid's own density, partial density over volume fraction, at the faces of a cell between those of
/// the cell and its neighbours, compressed by the half step, where `find_uneven_phase` says so. The two are limited
/// independently, and where both fade out their ratio would drift away: a thousandth of the products then stands in the
/// air at more than the density of the explosive, where its reference curve has no meaning, and the air beside it gets
/// hot enough to run ahead of the shock. With fine cells and short steps it drifts farthest.
inline void bound_phase_density(BundleLayout const& b, BundleArrays& a, int fluid) {
  double const* const keep = a[a_keep];
  double const* const squeeze = a[a_squeeze];
  double const* const partial = a[partial_density(fluid)];
  double const* const alpha = a[volume_fraction(fluid)];
  double const* const L_alpha = a[a_left + f_alpha(fluid)];
  double const* const R_alpha = a[a_right + f_alpha(fluid)];
  double* const L_partial = a[a_left + f_partial(fluid)];
  double* const R_partial = a[a_right + f_partial(fluid)];
  double const* const uneven = a[a_uneven(fluid)];
  for (int q = b.stride; q < b.total - b.stride; ++q) {
    if (uneven[q] < 0.5) continue;
    PhaseRange const own(b, a, fluid, q, [=](int n) { return partial[n] / alpha[n]; });
    double const compressed = 1.0 - keep[q] * squeeze[q];
    double const least = own.least * compressed;
    double const most = own.most * compressed;
    L_partial[q] = std::min(std::max(L_partial[q], L_alpha[q] * least), L_alpha[q] * most);
    R_partial[q] = std::min(std::max(R_partial[q], R_alpha[q] * least), R_alpha[q] * most);
  }
}

/// Weakens the slopes of shocks near rigid surfaces, where they run towards the surface or have been reflected from it:
/// with full slopes a shock that is being reflected leaves a pressure that is 7 to 22 % too high at the surface for
/// tens of steps, and the peak at a wall is what is asked for. First order in the two cells at the surface, full slopes
/// from `near_wall_cells` on. A shock that leaves a plane of symmetry with gas at rest ahead of it keeps its slopes.
template <int N, bool Solid>
void flatten_near_walls(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  constexpr double strong = 0.1;   // least pressure jump over a cell, of the pressure
  constexpr double towards = 0.1;  // least velocity ahead of it, of the velocity's jump
  int const st = b.stride;
  double const* const p = a[a_p];
  double const* const u = a[a_u];
  double const* const solid = a[a_solid];
  double* const share = a[a_share];
  for (WallRun const& run : *s.near_walls) {
    double const nearest = (run.distance - 1.0) / (near_wall_cells - 1.0);
    double const change = run.change / (near_wall_cells - 1.0);
    double const side = run.above ? 1.0 : -1.0;
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
      double const kept = std::min(1.0, std::max(0.0, nearest + change * n));
      share[n] = found ? kept : 1.0;
      shocked += found ? 1 : 0;
    }
    if (shocked == 0) continue;
    for (int f = 0; f < face_values(N); ++f) {
      if (f == f_c || (N == 1 && f == f_rho_e)) continue;
      double* const slope = a[a_slope + f] + run.q;
      BRISANCE_VECTOR_LOOP
      for (int n = 0; n < run.count; ++n) slope[n] *= share[n];
    }
  }
}

/// Energy at the faces where a fluid's own density is bounded: the closure sum B, the energy of that fluid's
/// reference curve, goes with its density, and bounded alone the two would not fit each other and leave a thin hot
/// layer with every step. Per mass of the fluid B stays between that of the cell and its neighbours, compressed
/// by the half step. No other fluid may have a reference curve.
inline void bound_reference_energy(SweepContext const& s, BundleLayout const& b, BundleArrays& a, int fluid) {
  static_assert(most_fluids == 2, "what B is of each of several fluids would have to be known");
  double const half_lambda = 0.5 * s.dt / s.h;
  double const* const partial = a[partial_density(fluid)];
  double const* const B = a[a_B];
  double const* const H = a[a_H];
  double const* const u = a[a_u];
  double const* const keep = a[a_keep];
  double const* const squeeze = a[a_squeeze];
  double const* const d_B = a[a_slope + f_rho_e];
  double const* const d_partial = a[a_slope + f_partial(fluid)];
  double const* const L_partial = a[a_left + f_partial(fluid)];
  double const* const R_partial = a[a_right + f_partial(fluid)];
  double* const L_e = a[a_left + f_rho_e];
  double* const R_e = a[a_right + f_rho_e];
  double const* const uneven = a[a_uneven(fluid)];
  for (int q = b.stride; q < b.total - b.stride; ++q) {
    if (uneven[q] < 0.5) continue;
    double const k = keep[q];
    double const middle = partial[q] + k * (-half_lambda * u[q] * d_partial[q] - partial[q] * squeeze[q]);
    if (middle <= 0.0) continue;
    PhaseRange const own(b, a, fluid, q, [=](int n) { return B[n] / partial[n]; });
    double const shift = k * H[q] / partial[q] * squeeze[q];
    double const least = own.least + shift;
    double const most = own.most + shift;
    double const m_B = B[q] + k * (-half_lambda * u[q] * d_B[q] + (H[q] - B[q]) * squeeze[q]);
    double const B_left = m_B + 0.5 * k * d_B[q];
    double const B_right = m_B - 0.5 * k * d_B[q];
    L_e[q] += std::min(std::max(B_left, L_partial[q] * least), L_partial[q] * most) - B_left;
    R_e[q] += std::min(std::max(B_right, R_partial[q] * least), R_partial[q] * most) - B_right;
  }
}

}  // namespace brisance::gas
