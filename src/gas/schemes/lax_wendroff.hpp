/// The paper's scheme: Lax-Wendroff with adaptive artificial viscosity, [Cui14] Eqs. (3)-(9), in conservative form.
///
/// Eqs. (7)-(9) as printed lack the Jacobian in the second-order term; the two-step form of [RichtmyerMorton67] is
/// used, the same for linear fluxes:    U_{i+1/2} = (U_i + U_{i+1})/2 - dt/(2h) (f_{i+1} - f_i),   flux f(U_{i+1/2}).
/// Eq. (4) needs an absolute value around the numerator, and Eq. (3) a coefficient per face to be conservative:
///     nu_{i+1/2} = eta/2 max(theta_i, theta_{i+1}), flux - nu h/dt (U_{i+1} - U_i).
/// eta of Eq. (5) uses |u| + c for the wave speed, the larger of the two cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>

#include "core/loops.hpp"
#include "gas/kernels.hpp"
#include "gas/primitives.hpp"

namespace brisance::gas {

/// Closure sums where the ambient fluid is alone.
inline void closure_row_single(SweepContext const& s, int n, double const* rho, double* xi, double* B, double* H) {
  std::visit(
      [=](auto const eos) {
        double const x = 1.0 / eos.gruneisen();
        BRISANCE_VECTOR_LOOP
        for (int q = 0; q < n; ++q) {
          double const f = eos.reference(rho[q]);
          xi[q] = x;
          B[q] = -x * f;
          H[q] = x * (eos.rho_d_reference(rho[q]) - f);
        }
      },
      s.fluids->ambient());
}

/// Closure sums of `n` cells with the given partial densities and, of the fluids beside the ambient one, volume
/// fractions. `F`: burn fraction; null where all is burnt.
template <int N>
void closure_row(SweepContext const& s, int n, std::array<double const*, N> const& partial,
                 std::array<double const*, N> const& alpha, double const* F, double* xi, double* B, double* H) {
  if constexpr (N > 1) {
    material::Rest<N - 1> rest{};
    for_fluids<1, N>([&](int k) { rest.alpha[k - 1] = alpha[k]; });
    if (auto const* ideal = std::get_if<material::IdealGas>(&s.fluids->ambient())) {
      double const x = 1.0 / ideal->gruneisen();
      BRISANCE_VECTOR_LOOP
      for (int q = 0; q < n; ++q) xi[q] = rest(q) * x;
      std::fill_n(B, n, 0.0);
      std::fill_n(H, n, 0.0);
    } else {
      std::fill_n(xi, n, 0.0);
      std::fill_n(B, n, 0.0);
      std::fill_n(H, n, 0.0);
      std::visit([&](auto const& eos) { add_fluid_row(eos, n, rest, partial[0], nullptr, 0.0, xi, B, H); },
                 s.fluids->ambient());
    }
    for (int k = 1; k < N; ++k) {
      std::visit(
          [&](auto const& eos) {
            add_fluid_row(eos, n, material::Own{alpha[k]}, partial[k], F, s.fluids->ambient_pressure, xi, B, H);
          },
          s.fluids->eos[k]);
    }
  } else {
    closure_row_single(s, n, partial[0], xi, B, H);
  }
}

/// What the pressure does in the flux of a component: nothing, momentum flux p, or energy flux p u.
enum class PressurePart { none, force, work };

/// Half-time state on the faces of one conserved component x with flux x u (+ p or p u).
template <PressurePart Part, bool Radial>
void half_time(BundleLayout const& b, BundleArrays& a, double lambda, double const* x, double* half) {
  int const st = b.stride;
  double const* const u = a[a_u];
  double const* const p = a[a_p];
  double const* const expansion = a[a_expansion];
  BRISANCE_VECTOR_LOOP
  for (int q = st; q < b.total - 2 * st; ++q) {
    int const r = q + st;
    double low = x[q] * u[q];
    double high = x[r] * u[r];
    // Spreading of a radial flow between the two cells: the force of the pressure has no part in it.
    double const spread = Radial ? 0.25 * (expansion[q] + expansion[r]) : 0.0;
    if constexpr (Part == PressurePart::work) {
      low += p[q] * u[q];
      high += p[r] * u[r];
    }
    double const spreading = Radial ? spread * (low + high) : 0.0;
    if constexpr (Part == PressurePart::force) {
      low += p[q];
      high += p[r];
    }
    half[q] = 0.5 * (x[q] + x[r]) - 0.5 * lambda * (high - low) - spreading;
  }
}

/// Flux of one component: of the half-time state, or Rusanov's where that is not physical (`a_keep` 0), less the
/// viscosity.
template <PressurePart Part>
void face_flux(BundleLayout const& b, BundleArrays& a, double const* x, double const* half, double* flux) {
  int const st = b.stride;
  double const* const u = a[a_u];
  double const* const p = a[a_p];
  double const* const uh = a[a_half_u];
  double const* const ph = a[a_half_p];
  double const* const nu = a[a_viscosity];
  double const* const keep = a[a_keep];
  BRISANCE_VECTOR_LOOP
  for (int q = st; q < b.total - 2 * st; ++q) {
    int const r = q + st;
    double centred = half[q] * uh[q];
    double mean = x[q] * u[q] + x[r] * u[r];
    if constexpr (Part == PressurePart::force) {
      centred += ph[q];
      mean += p[q] + p[r];
    }
    if constexpr (Part == PressurePart::work) {
      centred += ph[q] * uh[q];
      mean += p[q] * u[q] + p[r] * u[r];
    }
    flux[q] = 0.5 * mean + keep[q] * (centred - 0.5 * mean) - nu[q] * (x[r] - x[q]);
  }
}

template <int N, bool Radial>
void lax_wendroff_faces(SweepContext const& s, BundleLayout const& b, BundleArrays& a, GuardCount& guards) {
  int const st = b.stride;
  int const n = b.total;
  double const lambda = s.dt / s.h;
  auto const partial = rows_of_fluids<N>(a, 0);
  auto const alpha = volume_fraction_rows<N>(a, 0);
  double const* const u = a[a_u];
  double const* const p = a[a_p];
  double const* const xi = a[a_xi];
  double const* const H = a[a_H];
  double const* const inverse = a[a_inverse];
  double* const theta = a[a_theta];
  double* const signal = a[a_signal];
  double* const viscosity = a[a_viscosity];
  double* const keep = a[a_keep];
  // Half-time states take the places of the left face states.
  auto const half = [&](int c) { return a[a_left + c]; };
  double* const h_xi = a[a_right + 0];
  double* const h_B = a[a_right + 1];
  double* const h_H = a[a_right + 2];
  double* const h_burn = a[a_right + 3];
  if constexpr (Radial) std::copy_n(p, n, a[a_p_half]);

  // theta of Eq. (4) with its outer absolute value.
  BRISANCE_VECTOR_LOOP
  for (int q = st; q < n - st; ++q) {
    double const low = sum_of_fluids<N>([&](int k) { return partial[k][q - st]; });
    double const mid = sum_of_fluids<N>([&](int k) { return partial[k][q]; });
    double const high = sum_of_fluids<N>([&](int k) { return partial[k][q + st]; });
    double const forth = std::abs(high - mid);
    double const back = std::abs(mid - low);
    double const sum = forth + back;
    bool const smooth = sum <= 1e-12 * mid;
    theta[q] = smooth ? 0.0 : std::abs(forth - back) / (smooth ? 1.0 : sum);
  }
  BRISANCE_VECTOR_LOOP
  for (int q = 0; q < n; ++q) {
    signal[q] = std::abs(u[q]) + std::sqrt(std::max(0.0, p[q] + (p[q] + H[q]) / xi[q]) * inverse[q]);
  }
  // Eq. (5); the sweep moves waves by `courant` cells.
  double const constant = s.viscosity;
  double const adaptive = constant > 0.0 ? 0.0 : 1.0;
  double const scale = 0.5 / lambda;
  BRISANCE_VECTOR_LOOP
  for (int q = st; q < n - 2 * st; ++q) {
    double const courant = std::min(1.0, std::max(signal[q], signal[q + st]) * lambda);
    double const eta = constant + adaptive * courant * (1.0 - courant);
    viscosity[q] = scale * eta * std::max(theta[q], theta[q + st]);
  }

  half_time<PressurePart::none, Radial>(b, a, lambda, partial[0], half(partial_density(0)));
  half_time<PressurePart::force, Radial>(b, a, lambda, a[s.normal()], half(s.normal()));
  half_time<PressurePart::none, Radial>(b, a, lambda, a[s.transverse1()], half(s.transverse1()));
  half_time<PressurePart::none, Radial>(b, a, lambda, a[s.transverse2()], half(s.transverse2()));
  half_time<PressurePart::work, Radial>(b, a, lambda, a[energy], half(energy));
  int const faces = n - 3 * st;
  if (faces <= 0) return;
  for (int k = 1; k < N; ++k) {
    half_time<PressurePart::none, Radial>(b, a, lambda, partial[k], half(partial_density(k)));
    double const* const own = alpha[k];
    double* const h_alpha = half(volume_fraction(k));
    BRISANCE_VECTOR_LOOP
    for (int q = st; q < n - 2 * st; ++q) {
      int const r = q + st;
      h_alpha[q] = 0.5 * (own[q] + own[r]) - 0.25 * lambda * (u[q] + u[r]) * (own[r] - own[q]);
    }
  }
  if (N > 1 && s.burning) {
    for (int q = st; q < n - 2 * st; ++q) h_burn[q] = std::min(a[a_burn][q], a[a_burn][q + st]);
  }
  FluidRows<N> h_partial{};
  FluidRows<N> h_fractions{};
  for_fluids<0, N>([&](int k) { h_partial[k] = half(partial_density(k)) + st; });
  for_fluids<1, N>([&](int k) { h_fractions[k] = half(volume_fraction(k)) + st; });
  closure_row<N>(s, faces, h_partial, h_fractions, s.burning ? h_burn + st : nullptr, h_xi + st, h_B + st, h_H + st);

  // Velocity and pressure at half time; Rusanov's viscosity where that state is not physical.
  {
    FluidRows<N> h_rho{};
    for_fluids<0, N>([&](int k) { h_rho[k] = half(partial_density(k)); });
    double const* const h_mu = half(s.normal());
    double const* const h_mv = half(s.transverse1());
    double const* const h_mw = half(s.transverse2());
    double const* const h_E = half(energy);
    double* const uh = a[a_half_u];
    double* const ph = a[a_half_p];
    double* const face_speed = a[a_face_speed];
    double const least = 0.5 * s.floors.density;
    long fallbacks = 0;
    BRISANCE_VECTOR_LOOP
    for (int q = st; q < n - 2 * st; ++q) {
      double const rho = sum_of_fluids<N>([&](int k) { return h_rho[k][q]; });
      double const r = 1.0 / std::max(rho, least);
      double const velocity = h_mu[q] * r;
      double const kinetic = 0.5 * (h_mu[q] * h_mu[q] + h_mv[q] * h_mv[q] + h_mw[q] * h_mw[q]) * r;
      double const pressure = (h_E[q] - kinetic - h_B[q]) / h_xi[q];
      bool const good = (rho > least) & (pressure * (h_xi[q] + 1.0) + h_H[q] > 0.0);
      double const rusanov = 0.5 * std::max(signal[q], signal[q + st]);
      double const mean = 0.5 * (u[q] + u[q + st]);
      uh[q] = velocity;
      ph[q] = pressure;
      keep[q] = good ? 1.0 : 0.0;
      viscosity[q] = good ? viscosity[q] : rusanov;
      face_speed[q] = good ? velocity : mean;
      fallbacks += good ? 0 : 1;
    }
    if (fallbacks > 0) {
      for (int q = st; q < n - 2 * st; ++q) guards.fallback_faces += keep[q] < 0.5 && is_own(b, q) ? 1 : 0;
    }
  }
  auto const flux = [&](int c) { return a[a_flux + c]; };
  face_flux<PressurePart::force>(b, a, a[s.normal()], half(s.normal()), flux(s.normal()));
  face_flux<PressurePart::none>(b, a, a[s.transverse1()], half(s.transverse1()), flux(s.transverse1()));
  face_flux<PressurePart::none>(b, a, a[s.transverse2()], half(s.transverse2()), flux(s.transverse2()));
  face_flux<PressurePart::work>(b, a, a[energy], half(energy), flux(energy));
  for (int k = 0; k < N; ++k) {
    int const c = partial_density(k);
    face_flux<PressurePart::none>(b, a, partial[k], half(c), flux(c));
    if (k > 0) face_flux<PressurePart::none>(b, a, alpha[k], half(volume_fraction(k)), flux(volume_fraction(k)));
  }
}

/// The face of an obstacle feels the pressure that stops the flow in front of it (acoustic estimate) and lets nothing
/// through.
inline void obstacle_faces(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  int const st = b.stride;
  double const* const solid = a[a_solid];
  for (int q = st; q < b.total - 2 * st; ++q) {
    bool const behind = solid[q + st] > 0.5;
    if ((solid[q] > 0.5) == behind) continue;
    int const f = behind ? q : q + st;
    double const u = a[a_u][f];
    double const c = a[a_signal][f] - std::abs(u);
    double const stopped = a[a_p][f] + (behind ? 1.0 : -1.0) * c * u / a[a_inverse][f];
    for (int x = 0; x < components_of(most_fluids); ++x) a[a_flux + x][q] = 0.0;
    a[a_flux + s.normal()][q] = std::max(stopped, 0.0);
    a[a_face_speed][q] = 0.0;
  }
}

template <int N>
void lax_wendroff(SweepContext const& s, BundleLayout const& b, BundleArrays& a, GuardCount& guards) {
  if (s.radial) {
    lax_wendroff_faces<N, true>(s, b, a, guards);
  } else {
    lax_wendroff_faces<N, false>(s, b, a, guards);
  }
  if (s.solid) obstacle_faces(s, b, a);
}

}  // namespace brisance::gas
