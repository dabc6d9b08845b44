/// The paper's scheme: Lax-Wendroff with adaptive artificial viscosity, [Cui14] Eqs. (3)-(9), in conservative form.
///
/// Eqs. (7)-(9) as printed lack the Jacobian in the second-order term; the two-step form of [RichtmyerMorton67] is used, the same for linear
/// fluxes:    U_{i+1/2} = (U_i + U_{i+1})/2 - dt/(2h) (f_{i+1} - f_i),   flux f(U_{i+1/2}).
/// Eq. (4) needs an absolute value around the numerator, and Eq. (3) a coefficient per face to be conservative:
///     nu_{i+1/2} = eta/2 max(theta_i, theta_{i+1}), flux - nu h/dt (U_{i+1} - U_i).
/// eta of Eq. (5) uses |u| + c for the wave speed, the larger of the two cells.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/loops.hpp"
#include "gas/kernels.hpp"
#include "gas/primitives.hpp"

namespace brisance::gas {

template <bool Two>
void lax_wendroff(SweepContext const& s, BundleLayout const& b, BundleArrays& a, GuardCount& guards) {
  int const st = b.stride;
  int const n = b.total;
  double const lambda = s.dt / s.h;
  double* const rho0 = a[density];
  double* const rho1 = a[second_density];
  double* const alpha = a[volume_fraction];
  double* const mu = a[s.normal()];
  double* const mv = a[s.transverse1()];
  double* const mw = a[s.transverse2()];
  double* const E = a[energy];
  double* const u = a[a_u];
  double* const p = a[a_p];
  double* const xi = a[a_xi];
  double* const H = a[a_H];
  double const* const solid = a[a_solid];
  double const* const expansion = a[a_expansion];
  double* const theta = a[a_theta];
  double* const signal = a[a_signal];
  // States at half time on the faces, in the arrays of the face states.
  double* const h_rho0 = a[a_left + f_density];
  double* const h_mu = a[a_left + f_u];
  double* const h_mv = a[a_left + f_v];
  double* const h_mw = a[a_left + f_w];
  double* const h_p = a[a_left + f_p];
  double* const h_E = a[a_left + f_rho_e];
  double* const viscous = a[a_left + f_c];
  double* const h_rho1 = a[a_left + f_second];
  double* const h_alpha = a[a_left + f_alpha];
  double* const h_xi = a[a_right + 0];
  double* const h_B = a[a_right + 1];
  double* const h_H = a[a_right + 2];
  double* const h_burn = a[a_right + 3];
  double* const flux_rho0 = a[a_flux + density];
  double* const flux_u = a[a_flux + s.normal()];
  double* const flux_v = a[a_flux + s.transverse1()];
  double* const flux_w = a[a_flux + s.transverse2()];
  double* const flux_E = a[a_flux + energy];
  double* const flux_rho1 = a[a_flux + second_density];
  double* const flux_alpha = a[a_flux + volume_fraction];
  double* const face_speed = a[a_face_speed];
  bool const radial = s.radial;
  if (radial) std::copy_n(p, n, a[a_p_half]);

  // theta of Eq. (4) with its outer absolute value.
  BRISANCE_VECTOR_LOOP
  for (int q = st; q < n - st; ++q) {
    double const low = Two ? rho0[q - st] + rho1[q - st] : rho0[q - st];
    double const mid = Two ? rho0[q] + rho1[q] : rho0[q];
    double const high = Two ? rho0[q + st] + rho1[q + st] : rho0[q + st];
    double const forth = std::abs(high - mid);
    double const back = std::abs(mid - low);
    double const sum = forth + back;
    bool const smooth = sum <= 1e-12 * mid;
    theta[q] = smooth ? 0.0 : std::abs(forth - back) / (smooth ? 1.0 : sum);
  }
  BRISANCE_VECTOR_LOOP
  for (int q = 0; q < n; ++q) {
    double const rho = Two ? rho0[q] + rho1[q] : rho0[q];
    signal[q] = std::abs(u[q]) + std::sqrt(std::max(0.0, p[q] + (p[q] + H[q]) / xi[q]) / rho);
  }

  BRISANCE_VECTOR_LOOP
  for (int q = st; q < n - 2 * st; ++q) {
    int const r = q + st;
    double const half = 0.5 * lambda;
    // Spreading of a radial flow between the two cells.
    double const spread = radial ? 0.5 * (expansion[q] + expansion[r]) : 0.0;
    double const work_q = (E[q] + p[q]) * u[q];
    double const work_r = (E[r] + p[r]) * u[r];
    h_rho0[q] = 0.5 * (rho0[q] + rho0[r]) - half * (rho0[r] * u[r] - rho0[q] * u[q]) - spread * 0.5 * (rho0[q] * u[q] + rho0[r] * u[r]);
    h_mu[q] = 0.5 * (mu[q] + mu[r]) - half * (mu[r] * u[r] + p[r] - mu[q] * u[q] - p[q]) - spread * 0.5 * (mu[q] * u[q] + mu[r] * u[r]);
    h_mv[q] = 0.5 * (mv[q] + mv[r]) - half * (mv[r] * u[r] - mv[q] * u[q]) - spread * 0.5 * (mv[q] * u[q] + mv[r] * u[r]);
    h_mw[q] = 0.5 * (mw[q] + mw[r]) - half * (mw[r] * u[r] - mw[q] * u[q]) - spread * 0.5 * (mw[q] * u[q] + mw[r] * u[r]);
    h_E[q] = 0.5 * (E[q] + E[r]) - half * (work_r - work_q) - spread * 0.5 * (work_q + work_r);
    if constexpr (Two) {
      h_rho1[q] = 0.5 * (rho1[q] + rho1[r]) - half * (rho1[r] * u[r] - rho1[q] * u[q]) - spread * 0.5 * (rho1[q] * u[q] + rho1[r] * u[r]);
      h_alpha[q] = 0.5 * (alpha[q] + alpha[r]) - half * 0.5 * (u[q] + u[r]) * (alpha[r] - alpha[q]);
      if (s.burning) h_burn[q] = std::min(a[a_burn][q], a[a_burn][r]);
    }
    // Eq. (5); the sweep moves waves by `courant` cells.
    double const courant = std::min(1.0, std::max(signal[q], signal[r]) * lambda);
    double const eta = s.viscosity > 0.0 ? s.viscosity : courant * (1.0 - courant);
    viscous[q] = 0.5 * eta * std::max(theta[q], theta[r]) / lambda;
  }

  int const faces = n - 3 * st;
  if (faces <= 0) return;
  if constexpr (Two) {
    closure_row(s, faces, h_rho0 + st, h_rho1 + st, h_alpha + st, s.burning ? h_burn + st : nullptr, h_xi + st, h_B + st, h_H + st);
  } else {
    closure_row_single(s, faces, h_rho0 + st, h_xi + st, h_B + st, h_H + st);
  }

  long fallbacks = 0;
  BRISANCE_VECTOR_LOOP
  for (int q = st; q < n - 2 * st; ++q) {
    int const r = q + st;
    double const rho = Two ? h_rho0[q] + h_rho1[q] : h_rho0[q];
    double const safe = std::max(rho, 0.5 * s.density_floor);
    double const uh = h_mu[q] / safe;
    double const kinetic = 0.5 * (h_mu[q] * h_mu[q] + h_mv[q] * h_mv[q] + h_mw[q] * h_mw[q]) / safe;
    double const ph = (h_E[q] - kinetic - h_B[q]) / h_xi[q];
    bool const good = (rho > 0.5 * s.density_floor) & (ph * (h_xi[q] + 1.0) + h_H[q] > 0.0);
    // Rusanov's flux where the half-time state is not physical.
    double const S = std::max(signal[q], signal[r]);
    double const nu = good ? viscous[q] : 0.5 * S;
    double const k = good ? 1.0 : 0.0;
    double const c = 1.0 - k;
    double const speed = k * uh + c * 0.5 * (u[q] + u[r]);
    flux_rho0[q] = k * h_rho0[q] * uh + c * 0.5 * (rho0[q] * u[q] + rho0[r] * u[r]) - nu * (rho0[r] - rho0[q]);
    flux_u[q] = k * (h_mu[q] * uh + ph) + c * 0.5 * (mu[q] * u[q] + p[q] + mu[r] * u[r] + p[r]) - nu * (mu[r] - mu[q]);
    flux_v[q] = k * h_mv[q] * uh + c * 0.5 * (mv[q] * u[q] + mv[r] * u[r]) - nu * (mv[r] - mv[q]);
    flux_w[q] = k * h_mw[q] * uh + c * 0.5 * (mw[q] * u[q] + mw[r] * u[r]) - nu * (mw[r] - mw[q]);
    flux_E[q] = k * (h_E[q] + ph) * uh + c * 0.5 * ((E[q] + p[q]) * u[q] + (E[r] + p[r]) * u[r]) - nu * (E[r] - E[q]);
    if constexpr (Two) {
      flux_rho1[q] = k * h_rho1[q] * uh + c * 0.5 * (rho1[q] * u[q] + rho1[r] * u[r]) - nu * (rho1[r] - rho1[q]);
      flux_alpha[q] = k * h_alpha[q] * uh + c * 0.5 * (alpha[q] * u[q] + alpha[r] * u[r]) - nu * (alpha[r] - alpha[q]);
      face_speed[q] = speed;
    }
    h_p[q] = good ? 0.0 : 1.0;
    fallbacks += good ? 0 : 1;
  }
  if (fallbacks > 0) {
    for (int q = st; q < n - 2 * st; ++q) {
      if (h_p[q] > 0.5 && is_own(b, q)) ++guards.fallback_faces;
    }
  }

  if (s.solid) {
    // The face of an obstacle feels the pressure that stops the flow in front of it (acoustic estimate) and lets nothing through.
    for (int q = st; q < n - 2 * st; ++q) {
      int const r = q + st;
      bool const behind = solid[r] > 0.5;
      if ((solid[q] > 0.5) == behind) continue;
      int const f = behind ? q : r;
      double const rho = Two ? rho0[f] + rho1[f] : rho0[f];
      double const c = signal[f] - std::abs(u[f]);
      double const stopped = p[f] + (behind ? 1.0 : -1.0) * rho * c * u[f];
      for (int x = 0; x < 8; ++x) a[a_flux + x][q] = 0.0;
      flux_u[q] = std::max(stopped, 0.0);
      face_speed[q] = 0.0;
    }
  }
}

}  // namespace brisance::gas
