/// MUSCL-Hancock [vanLeer84] with HLLC [Toro94]: piecewise-linear primitive variables, limited, evolved half a step, one Riemann problem per
/// face. Second order in smooth flow, total-variation bounded at jumps.
///
/// Two fluids: besides the volume fraction the closure sum B is reconstructed and evolved, dB/dt = -u dB/dx + (H - B) du/dx, so that the
/// energy at a face follows from p, alpha and B without a new evaluation of the equations of state. A contact with uniform p and u, and
/// uniform density of each fluid, stays uniform: B is then linear in alpha, and the limiter commutes with that.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/loops.hpp"
#include "gas/kernels.hpp"
#include "gas/riemann/hll.hpp"
#include "gas/riemann/hllc.hpp"

namespace brisance::gas {

/// Difference over a cell from the backward and forward differences: generalised monotonised-central limiter [vanLeer77],
/// minmod for beta = 1, the classical one for beta = 2.
[[nodiscard]] inline double limited(double backward, double forward, double beta) {
  double const centred = 0.5 * (backward + forward);
  double const bound = beta * std::min(std::abs(backward), std::abs(forward));
  double const size = std::min(std::abs(centred), bound);
  return backward * forward > 0.0 ? std::copysign(size, centred) : 0.0;
}

/// The compressive counterpart for contacts: Roe's superbee [Sweby84].
[[nodiscard]] inline double compressed(double backward, double forward) {
  double const a = std::abs(backward);
  double const b = std::abs(forward);
  double const size = std::max(std::min(2.0 * a, b), std::min(a, 2.0 * b));
  return backward * forward > 0.0 ? std::copysign(size, backward) : 0.0;
}

/// Face states of every cell from its own and its two neighbours' values.
template <bool Two, bool Radial, bool Solid>
void reconstruct(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  double const* const rho0 = a[density];
  double const* const rho1 = a[second_density];
  double const* const alpha = a[volume_fraction];
  double const* const u = a[a_u];
  double const* const v = a[a_v];
  double const* const w = a[a_w];
  double const* const p = a[a_p];
  double const* const xi = a[a_xi];
  double const* const B = a[a_B];
  double const* const H = a[a_H];
  double const* const F = a[a_burn];
  double const* const solid = a[a_solid];
  double const* const expansion = a[a_expansion];
  double* const p_half = a[a_p_half];
  double* const L_rho0 = a[a_left + f_density];
  double* const L_u = a[a_left + f_u];
  double* const L_v = a[a_left + f_v];
  double* const L_w = a[a_left + f_w];
  double* const L_p = a[a_left + f_p];
  double* const L_e = a[a_left + f_rho_e];
  double* const L_c = a[a_left + f_c];
  double* const L_rho1 = a[a_left + f_second];
  double* const L_alpha = a[a_left + f_alpha];
  double* const R_rho0 = a[a_right + f_density];
  double* const R_u = a[a_right + f_u];
  double* const R_v = a[a_right + f_v];
  double* const R_w = a[a_right + f_w];
  double* const R_p = a[a_right + f_p];
  double* const R_e = a[a_right + f_rho_e];
  double* const R_c = a[a_right + f_c];
  double* const R_rho1 = a[a_right + f_second];
  double* const R_alpha = a[a_right + f_alpha];

  int const st = b.stride;
  double const half_lambda = 0.5 * s.dt / s.h;
  double const beta = s.beta;
  double const lowest_density = 0.5 * s.density_floor;
  double const lowest_pressure = 0.5 * s.pressure_floor;
  bool const burning = s.burning;
  // What the volume fraction changes in xi; per-cell xi covers the burn fraction.
  double xi_slope = 0.0;
  if constexpr (Two) xi_slope = 1.0 / material::gruneisen(s.fluids->second) - 1.0 / material::gruneisen(s.fluids->ambient);

  BRISANCE_VECTOR_LOOP
  for (int q = st; q < b.total - st; ++q) {
    // Limited differences. Beside an obstacle the neighbour is the cell's own mirror image.
    double const see_back = Solid ? 1.0 - solid[q - st] : 1.0;
    double const see_forth = Solid ? 1.0 - solid[q + st] : 1.0;
    auto const difference = [&](double const* x) {
      return limited(see_back * (x[q] - x[q - st]), see_forth * (x[q + st] - x[q]), beta);
    };
    // A contact is smeared for good, for nothing in the flow steepens it again. Where the density jumps and the pressure does not, what jumps
    // with it is kept together by the compressive limiter, with the thresholds of contact steepening in [ColellaWoodward84].
    double const rho_back = Two ? rho0[q - st] + rho1[q - st] : rho0[q - st];
    double const rho_forth = Two ? rho0[q + st] + rho1[q + st] : rho0[q + st];
    bool const contact = (std::abs(rho_forth - rho_back) > 0.1 * std::min(rho_back, rho_forth)) &
                         (std::abs(p[q + st] - p[q - st]) < 0.05 * std::min(p[q - st], p[q + st]));
    auto const jump = [&](double const* x) {
      double const steep = compressed(see_back * (x[q] - x[q - st]), see_forth * (x[q + st] - x[q]));
      double const plain = difference(x);
      return contact ? steep : plain;
    };
    double const back_u = Solid ? (solid[q - st] > 0.5 ? 2.0 * u[q] : u[q] - u[q - st]) : u[q] - u[q - st];
    double const forth_u = Solid ? (solid[q + st] > 0.5 ? -2.0 * u[q] : u[q + st] - u[q]) : u[q + st] - u[q];
    double const d_u = limited(back_u, forth_u, beta);
    double const d_rho0 = jump(rho0);
    double const d_v = difference(v);
    double const d_w = difference(w);
    double const d_p = difference(p);
    double const d_rho1 = Two ? jump(rho1) : 0.0;
    double const d_alpha = Two ? jump(alpha) : 0.0;
    double const d_B = Two ? jump(B) : 0.0;

    double const rho = Two ? rho0[q] + rho1[q] : rho0[q];
    double const modulus = p[q] + (p[q] + H[q]) / xi[q];
    // Half a step of the primitive equations; `squeeze` is dt/2 div u, with the spreading of a radial flow.
    double const advance_u = half_lambda * u[q];
    double const squeeze = half_lambda * d_u + (Radial ? expansion[q] * u[q] : 0.0);
    double const t_rho0 = -advance_u * d_rho0 - rho0[q] * squeeze;
    double const t_u = -advance_u * d_u - half_lambda * d_p / rho;
    double const t_v = -advance_u * d_v;
    double const t_w = -advance_u * d_w;
    double const t_p = -advance_u * d_p - modulus * squeeze;
    double const t_rho1 = Two ? -advance_u * d_rho1 - rho1[q] * squeeze : 0.0;
    double const t_alpha = Two ? -advance_u * d_alpha : 0.0;
    double const t_B = Two ? -advance_u * d_B + (H[q] - B[q]) * squeeze : 0.0;

    // Fall back to the cell's own state where a face would be left without density or stiffness, and where the explosive burns:
    // there the pressure is no function of the neighbours' energy.
    double const drop_rho = 0.5 * std::abs(d_rho0 + d_rho1);
    double const xi_low = xi[q] + (Two ? (t_alpha - 0.5 * d_alpha) * xi_slope : 0.0);
    double const xi_high = xi[q] + (Two ? (t_alpha + 0.5 * d_alpha) * xi_slope : 0.0);
    double const p_low = p[q] + t_p - 0.5 * d_p;
    double const p_high = p[q] + t_p + 0.5 * d_p;
    bool good = (rho + t_rho0 + t_rho1 - drop_rho > lowest_density) &
                (p_low * (xi_low + 1.0) + H[q] > lowest_pressure * (xi_low + 1.0)) &
                (p_high * (xi_high + 1.0) + H[q] > lowest_pressure * (xi_high + 1.0));
    if (Two) {
      double const burnt = burning ? F[q] : 1.0;
      double const round_off = -1e-13 * rho;
      good = good & (burnt >= 1.0) & (rho0[q] + t_rho0 - 0.5 * std::abs(d_rho0) >= round_off) &
             (rho1[q] + t_rho1 - 0.5 * std::abs(d_rho1) >= round_off);
    }
    double const keep = good ? 1.0 : 0.0;
    double const half = 0.5 * keep;

    double const m_rho0 = rho0[q] + keep * t_rho0;
    double const m_u = u[q] + keep * t_u;
    double const m_v = v[q] + keep * t_v;
    double const m_w = w[q] + keep * t_w;
    double const m_p = p[q] + keep * t_p;
    L_rho0[q] = m_rho0 + half * d_rho0;
    R_rho0[q] = m_rho0 - half * d_rho0;
    L_u[q] = m_u + half * d_u;
    R_u[q] = m_u - half * d_u;
    L_v[q] = m_v + half * d_v;
    R_v[q] = m_v - half * d_v;
    L_w[q] = m_w + half * d_w;
    R_w[q] = m_w - half * d_w;
    double const pL = m_p + half * d_p;
    double const pR = m_p - half * d_p;
    L_p[q] = pL;
    R_p[q] = pR;
    if (Radial) p_half[q] = m_p;
    if constexpr (Two) {
      double const m_rho1 = rho1[q] + keep * t_rho1;
      double const m_alpha = alpha[q] + keep * t_alpha;
      double const m_B = B[q] + keep * t_B;
      double const aL = m_alpha + half * d_alpha;
      double const aR = m_alpha - half * d_alpha;
      // A fluid that all but vanished is not carried on: the diffuse interface ends here.
      L_alpha[q] = aL > vanishing_fraction ? aL : 0.0;
      R_alpha[q] = aR > vanishing_fraction ? aR : 0.0;
      double const rho1L = aL > vanishing_fraction ? m_rho1 + half * d_rho1 : 0.0;
      double const rho1R = aR > vanishing_fraction ? m_rho1 - half * d_rho1 : 0.0;
      L_rho1[q] = rho1L;
      R_rho1[q] = rho1R;
      double const xiL = good ? xi_high : xi[q];
      double const xiR = good ? xi_low : xi[q];
      L_e[q] = pL * xiL + (m_B + half * d_B);
      R_e[q] = pR * xiR + (m_B - half * d_B);
      L_c[q] = std::sqrt((pL * (xiL + 1.0) + H[q]) / (xiL * (L_rho0[q] + rho1L)));
      R_c[q] = std::sqrt((pR * (xiR + 1.0) + H[q]) / (xiR * (R_rho0[q] + rho1R)));
    } else {
      double const cell_xi = xi[q];
      double const m_B = B[q] + keep * (H[q] - B[q]) * squeeze;
      L_e[q] = pL * cell_xi + m_B;
      R_e[q] = pR * cell_xi + m_B;
      double const r = 1.0 / cell_xi;
      L_c[q] = std::sqrt((pL + (pL + H[q]) * r) / L_rho0[q]);
      R_c[q] = std::sqrt((pR + (pR + H[q]) * r) / R_rho0[q]);
    }
  }

  if constexpr (Solid) {
    // The other side of an obstacle's face is the mirror image of the fluid in front of it.
    for (int q = st; q < b.total - 2 * st; ++q) {
      bool const behind = solid[q + st] > 0.5;
      if ((solid[q] > 0.5) == behind) continue;
      for (int f = 0; f < 9; ++f) {
        double* const left = a[a_left + f];
        double* const right = a[a_right + f];
        double const sign = f == f_u ? -1.0 : 1.0;
        if (behind) right[q + st] = sign * left[q];
        else left[q] = sign * right[q + st];
      }
    }
  }
}

/// The state beside a face with its total energy.
[[nodiscard]] inline FaceSide face_side(double rho, double u, double v, double w, double p, double rho_e, double c) {
  return {rho, u, p, rho_e + 0.5 * rho * (u * u + v * v + w * w), c};
}

/// Beside an obstacle that is one cell thick both faces of the solid cell need a state of their own, so the Riemann problems read the left
/// state from q and the right state from q + stride: they never collide.
template <bool Two>
void riemann(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  double const* const L_rho0 = a[a_left + f_density];
  double const* const L_u = a[a_left + f_u];
  double const* const L_v = a[a_left + f_v];
  double const* const L_w = a[a_left + f_w];
  double const* const L_p = a[a_left + f_p];
  double const* const L_e = a[a_left + f_rho_e];
  double const* const L_c = a[a_left + f_c];
  double const* const L_rho1 = a[a_left + f_second];
  double const* const L_alpha = a[a_left + f_alpha];
  int const st = b.stride;
  double const* const R_rho0 = a[a_right + f_density] + st;
  double const* const R_u = a[a_right + f_u] + st;
  double const* const R_v = a[a_right + f_v] + st;
  double const* const R_w = a[a_right + f_w] + st;
  double const* const R_p = a[a_right + f_p] + st;
  double const* const R_e = a[a_right + f_rho_e] + st;
  double const* const R_c = a[a_right + f_c] + st;
  double const* const R_rho1 = a[a_right + f_second] + st;
  double const* const R_alpha = a[a_right + f_alpha] + st;
  double* const flux_rho0 = a[a_flux + density];
  double* const flux_u = a[a_flux + s.normal()];
  double* const flux_v = a[a_flux + s.transverse1()];
  double* const flux_w = a[a_flux + s.transverse2()];
  double* const flux_E = a[a_flux + energy];
  double* const flux_rho1 = a[a_flux + second_density];
  double* const flux_alpha = a[a_flux + volume_fraction];
  double* const face_speed = a[a_face_speed];

  BRISANCE_VECTOR_LOOP
  for (int q = st; q < b.total - 2 * st; ++q) {
    double const rhoL = Two ? L_rho0[q] + L_rho1[q] : L_rho0[q];
    double const rhoR = Two ? R_rho0[q] + R_rho1[q] : R_rho0[q];
    FaceSide const L = face_side(rhoL, L_u[q], L_v[q], L_w[q], L_p[q], L_e[q], L_c[q]);
    FaceSide const R = face_side(rhoR, R_u[q], R_v[q], R_w[q], R_p[q], R_e[q], R_c[q]);
    HllcFlux const f = hllc(L, R);
    // Loads stand outside the selections: a load under a condition would keep the loop from being vectorised.
    auto const upwind = [left = f.from_left](double l, double r) { return left ? l : r; };
    double const mass = f.speed * upwind(L.rho, R.rho);
    flux_rho0[q] = f.speed * upwind(L_rho0[q], R_rho0[q]);
    flux_u[q] = f.momentum;
    flux_v[q] = mass * upwind(L_v[q], R_v[q]);
    flux_w[q] = mass * upwind(L_w[q], R_w[q]);
    flux_E[q] = f.energy;
    if constexpr (Two) {
      flux_rho1[q] = f.speed * upwind(L_rho1[q], R_rho1[q]);
      flux_alpha[q] = f.speed * upwind(L_alpha[q], R_alpha[q]);
      face_speed[q] = f.speed;
    }
  }

  if (!s.shock_sensor) return;
  double const* const sensor = a[shock];
  if (count_above(sensor, b.total, 0.2) == 0) return;
  for (int q = st; q < b.total - 2 * st; ++q) {
    if (std::max(sensor[q], sensor[q + st]) <= 0.2) continue;
    double const rhoL = Two ? L_rho0[q] + L_rho1[q] : L_rho0[q];
    double const rhoR = Two ? R_rho0[q] + R_rho1[q] : R_rho0[q];
    FaceSide const L = face_side(rhoL, L_u[q], L_v[q], L_w[q], L_p[q], L_e[q], L_c[q]);
    FaceSide const R = face_side(rhoR, R_u[q], R_v[q], R_w[q], R_p[q], R_e[q], R_c[q]);
    HllFlux const f = hll(L, R);
    flux_rho0[q] = f.from_left * L_rho0[q] + f.from_right * R_rho0[q];
    flux_u[q] = f.from_left * L.rho * L.u + f.from_right * R.rho * R.u + f.pressure;
    flux_v[q] = f.from_left * L.rho * L_v[q] + f.from_right * R.rho * R_v[q];
    flux_w[q] = f.from_left * L.rho * L_w[q] + f.from_right * R.rho * R_w[q];
    flux_E[q] = f.from_left * L.E + f.from_right * R.E + f.work;
    if constexpr (Two) {
      flux_rho1[q] = f.from_left * L_rho1[q] + f.from_right * R_rho1[q];
      flux_alpha[q] = f.from_left * L_alpha[q] + f.from_right * R_alpha[q];
      face_speed[q] = f.from_left + f.from_right;
    }
  }
}

template <bool Two>
void muscl_hancock(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  if (s.radial) {
    if (s.solid) reconstruct<Two, true, true>(s, b, a);
    else reconstruct<Two, true, false>(s, b, a);
  } else {
    if (s.solid) reconstruct<Two, false, true>(s, b, a);
    else reconstruct<Two, false, false>(s, b, a);
  }
  riemann<Two>(s, b, a);
}

}  // namespace brisance::gas
