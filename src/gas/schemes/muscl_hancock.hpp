/// MUSCL-Hancock [VanLeer84] with HLLC [Toro94]: piecewise-linear primitive variables, limited, evolved half a step,
/// one Riemann problem per face. Second order in smooth flow, total-variation bounded at jumps.
///
/// Several fluids: besides the volume fractions the closure sum B is reconstructed and evolved, dB/dt = -u dB/dx + (H -
/// B) du/dx, so that the energy at a face follows from p, alpha and B without a new evaluation of the equations of
/// state. A contact with uniform p and u, and uniform density of each fluid, stays uniform: B is then linear in alpha,
/// and the limiter commutes with that.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/loops.hpp"
#include "gas/kernels.hpp"
#include "gas/riemann/hll.hpp"
#include "gas/riemann/hllc.hpp"
#include "gas/schemes/positivity.hpp"
#include "gas/schemes/slope_bounds.hpp"

namespace brisance::gas {

/// Difference over a cell from the backward and forward differences: generalised monotonised-central limiter
/// [VanLeer77], minmod for beta = 1, the classical one for beta = 2.
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

/// Limited difference over every cell. `Sign` is -1 for the velocity along the sweep: beside an obstacle the neighbour
/// is the cell's own mirror image.
template <bool Solid, bool Jump, int Sign>
void differences(SweepContext const& s, BundleLayout const& b, BundleArrays& a, double const* x, double* d) {
  int const st = b.stride;
  double const beta = s.beta;
  double const* const solid = a[a_solid];
  double const* const contact = a[a_contact];
  BRISANCE_VECTOR_LOOP
  for (int q = st; q < b.total - st; ++q) {
    double back = x[q] - x[q - st];
    double forth = x[q + st] - x[q];
    if constexpr (Solid) {
      double const mirrored = (1.0 - Sign) * x[q];
      back += solid[q - st] * (mirrored - back);
      forth -= solid[q + st] * (mirrored + forth);
    }
    double slope = limited(back, forth, beta);
    if constexpr (Jump) slope = contact[q] > 0.5 ? compressed(back, forth) : slope;
    d[q] = slope;
  }
}

/// Marks the contacts: cells where the density jumps and the pressure does not, neither between the neighbours nor from
/// them to the cell itself (explosive that has just been lit stands between two cells of low pressure). A contact is
/// smeared for good, for nothing in the flow steepens it again; what jumps with it is kept together by the compressive
/// limiter. Thresholds: contact steepening of [ColellaWoodward84].
///
/// Marks the risks too: cells beside which a high-order flux may leave an unsound state, see positivity.hpp. Returns
/// how many there are.
template <int N>
long find_contacts_and_risks(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  int const st = b.stride;
  double const most_H = s.most_H;
  auto const partial = rows_of_fluids<N>(a, 0);
  double const* const p = a[a_p];
  double const* const E = a[energy];
  double const* const xi = a[a_xi];
  double const* const B = a[a_B];
  double const* const H = a[a_H];
  double* const contact = a[a_contact];
  double* const risk = a[a_risk];
  long risks = 0;
  // What E may be where the kinetic energy times xi is `cold_flow` margins; one ideal gas has constant xi and no B and
  // H.
  auto const mark = [&](auto const& is_cold) {
    BRISANCE_VECTOR_LOOP
    for (int q = st; q < b.total - st; ++q) {
      double const back = sum_of_fluids<N>([&](int k) { return partial[k][q - st]; });
      double const forth = sum_of_fluids<N>([&](int k) { return partial[k][q + st]; });
      double const least = std::min(p[q], std::min(p[q - st], p[q + st]));
      double const most = std::max(p[q], std::max(p[q - st], p[q + st]));
      bool const found = (std::abs(forth - back) > 0.1 * std::min(back, forth)) & (most - least < 0.05 * least);
      contact[q] = found ? 1.0 : 0.0;
      bool const risky = (most > steep_pressure * least) | is_cold(q, E[q]);
      risk[q] = risky ? 1.0 : 0.0;
      risks += risky ? 1 : 0;
    }
  };
  auto const* ideal = N > 1 ? nullptr : std::get_if<material::IdealGas>(&s.fluids->ambient());
  if (ideal != nullptr) {
    double const x = 1.0 / ideal->gruneisen();
    double const factor = x + cold_flow * (x + 1.0) / x;
    mark([=](int q, double total) { return total > factor * p[q]; });
  } else {
    mark([=](int q, double total) {
      return (total - B[q] - p[q] * xi[q]) * xi[q] > cold_flow * margin(p[q], xi[q], H[q], most_H);
    });
  }
  if (s.radial) {
    // At an axis or centre a wave empties a cell two or three times as fast.
    double const* const expansion = a[a_expansion];
    double const fast = 0.5 * s.dt / s.h;
    BRISANCE_VECTOR_LOOP
    for (int q = st; q < b.total - st; ++q) {
      bool const small = std::abs(expansion[q]) > fast;
      risk[q] = small ? 1.0 : risk[q];
      risks += small ? 1 : 0;
    }
  }
  return risks;
}

/// Face states of something carried along: x evolves by -u dx, and by -x div u where it is a density.
template <bool Compressed>
void carried_to_faces(BundleLayout const& b, BundleArrays& a, double half_lambda, double const* x, int value) {
  double const* const u = a[a_u];
  double const* const keep = a[a_keep];
  double const* const squeeze = a[a_squeeze];
  double const* const d = a[a_slope + value];
  double* const left = a[a_left + value];
  double* const right = a[a_right + value];
  BRISANCE_VECTOR_LOOP
  for (int q = b.stride; q < b.total - b.stride; ++q) {
    double change = -half_lambda * u[q] * d[q];
    if constexpr (Compressed) change -= x[q] * squeeze[q];
    double const middle = x[q] + keep[q] * change;
    double const half = 0.5 * keep[q] * d[q];
    left[q] = middle + half;
    right[q] = middle - half;
  }
}

/// Face states of every cell from its own and its two neighbours' values. In small loops: the compiler then keeps what
/// each needs in registers.
template <int N, bool Radial, bool Solid>
void reconstruct(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  int const st = b.stride;
  int const end = b.total - st;
  double const half_lambda = 0.5 * s.dt / s.h;
  differences<Solid, true, 1>(s, b, a, a[partial_density(0)], a[a_slope + f_partial(0)]);
  differences<Solid, false, -1>(s, b, a, a[a_u], a[a_slope + f_u]);
  differences<Solid, false, 1>(s, b, a, a[a_v], a[a_slope + f_v]);
  differences<Solid, false, 1>(s, b, a, a[a_w], a[a_slope + f_w]);
  differences<Solid, false, 1>(s, b, a, a[a_p], a[a_slope + f_p]);
  bool const curved = N > 1 || material::follows_density(s.fluids->ambient());  // does B have a slope?
  if (curved) differences<Solid, true, 1>(s, b, a, a[a_B], a[a_slope + f_rho_e]);
  for (int k = 1; k < N; ++k) {
    differences<Solid, true, 1>(s, b, a, a[partial_density(k)], a[a_slope + f_partial(k)]);
    differences<Solid, true, 1>(s, b, a, a[volume_fraction(k)], a[a_slope + f_alpha(k)]);
  }
  if (s.near_walls != nullptr) flatten_near_walls<N, Solid>(s, b, a);

  auto const partial = rows_of_fluids<N>(a, 0);
  double const* const u = a[a_u];
  double const* const p = a[a_p];
  double const* const xi = a[a_xi];
  double const* const B = a[a_B];
  double const* const H = a[a_H];
  double const* const inverse = a[a_inverse];
  auto const d_partial = face_densities<N>(a, a_slope);
  double const* const d_u = a[a_slope + f_u];
  double const* const d_p = a[a_slope + f_p];
  double const* const d_B = a[a_slope + f_rho_e];
  auto const d_alpha = face_fractions<N>(a, a_slope);
  double* const keep = a[a_keep];
  double* const squeeze = a[a_squeeze];
  double* const L_p = a[a_left + f_p];
  double* const R_p = a[a_right + f_p];
  double* const L_u = a[a_left + f_u];
  double* const R_u = a[a_right + f_u];
  double* const L_e = a[a_left + f_rho_e];
  double* const R_e = a[a_right + f_rho_e];
  // What the volume fractions change in xi; the cell's own xi covers the burn fraction.
  std::array<double, N> xi_slope{};
  for_fluids<1, N>([&](int k) {
    xi_slope[k] = 1.0 / material::gruneisen(s.fluids->eos[k]) - 1.0 / material::gruneisen(s.fluids->ambient());
  });

  // Half a step of pressure and velocity, and where a cell must fall back to its own state at its faces: where a face
  // would be left without density or stiffness, and where explosive burns, for there the pressure is no function of the
  // neighbours' energy.
  {
    double const lowest_density = 0.5 * s.floors.density;
    double const lowest_pressure = 0.5 * s.floors.pressure;
    double const* const F = a[a_burn];
    double const* const expansion = a[a_expansion];
    double* const p_half = a[a_p_half];
    double const most_H = s.most_H;
    auto const advance_half = [&]<bool Burning>() {
      BRISANCE_VECTOR_LOOP
      for (int q = st; q < end; ++q) {
        double const advance_u = half_lambda * u[q];
        double const div = half_lambda * d_u[q] + (Radial ? expansion[q] * u[q] : 0.0);
        double const rho = sum_of_fluids<N>([&](int k) { return partial[k][q]; });
        double const d_rho = sum_of_fluids<N>([&](int k) { return d_partial[k][q]; });
        double const modulus = p[q] + (p[q] + H[q]) / xi[q];
        double const t_rho = -advance_u * d_rho - rho * div;
        double const t_p = -advance_u * d_p[q] - modulus * div;
        double const t_u = -advance_u * d_u[q] - half_lambda * d_p[q] * inverse[q];
        double const drop_p = 0.5 * std::abs(d_p[q]);
        // xi changes with the volume fraction.
        double const lowest_p = p[q] + t_p - drop_p;
        bool good = (rho + t_rho - 0.5 * std::abs(d_rho) > lowest_density) &
                    (margin(lowest_p, xi[q], H[q], most_H) > lowest_pressure * (xi[q] + 1.0));
        if constexpr (N > 1) {
          double most_xi = xi[q];
          for_fluids<1, N>([&](int k) {
            most_xi += std::abs(xi_slope[k]) * (0.5 + half_lambda * std::abs(u[q])) * std::abs(d_alpha[k][q]);
          });
          good = good & (margin(lowest_p, most_xi, H[q], most_H) > lowest_pressure * (most_xi + 1.0));
          if constexpr (Burning) good = good & (F[q] >= 1.0);
          double const round_off = -1e-13 * rho;
          for_fluids<0, N>([&](int k) {
            double const t_partial = -advance_u * d_partial[k][q] - partial[k][q] * div;
            good = good & (partial[k][q] + t_partial - 0.5 * std::abs(d_partial[k][q]) >= round_off);
          });
        }
        double const k = good ? 1.0 : 0.0;
        keep[q] = k;
        squeeze[q] = div;
        double const m_p = p[q] + k * t_p;
        double const m_u = u[q] + k * t_u;
        L_p[q] = m_p + 0.5 * k * d_p[q];
        R_p[q] = m_p - 0.5 * k * d_p[q];
        L_u[q] = m_u + 0.5 * k * d_u[q];
        R_u[q] = m_u - 0.5 * k * d_u[q];
        if (Radial) p_half[q] = m_p;
      }
    };
    // A condition within the loop would keep it from being vectorised.
    if (N > 1 && s.burning)
      advance_half.template operator()<true>();
    else
      advance_half.template operator()<false>();
  }
  carried_to_faces<true>(b, a, half_lambda, partial[0], f_partial(0));
  carried_to_faces<false>(b, a, half_lambda, a[a_v], f_v);
  carried_to_faces<false>(b, a, half_lambda, a[a_w], f_w);

  auto const L_partial = face_densities<N>(a, a_left);
  auto const R_partial = face_densities<N>(a, a_right);
  double* const L_c = a[a_left + f_c];
  double* const R_c = a[a_right + f_c];
  if constexpr (N > 1) {
    auto const alpha = volume_fraction_rows<N>(a, 0);
    auto const L_alpha = face_fractions<N>(a, a_left);
    auto const R_alpha = face_fractions<N>(a, a_right);
    for (int k = 1; k < N; ++k) {
      carried_to_faces<true>(b, a, half_lambda, partial[k], f_partial(k));
      carried_to_faces<false>(b, a, half_lambda, alpha[k], f_alpha(k));
      if (s.bounded_phase) bound_phase_density(b, a, k);
    }
    BRISANCE_VECTOR_LOOP
    for (int q = st; q < end; ++q) {
      double const k = keep[q];
      double const m_B = B[q] + k * (-half_lambda * u[q] * d_B[q] + (H[q] - B[q]) * squeeze[q]);
      double xiL = xi[q];
      double xiR = xi[q];
      for_fluids<1, N>([&](int f) {
        xiL += (L_alpha[f][q] - alpha[f][q]) * xi_slope[f];
        xiR += (R_alpha[f][q] - alpha[f][q]) * xi_slope[f];
      });
      L_e[q] = L_p[q] * xiL + (m_B + 0.5 * k * d_B[q]);
      R_e[q] = R_p[q] * xiR + (m_B - 0.5 * k * d_B[q]);
      // A fluid that all but vanished is not carried on: the diffuse interface ends here.
      for_fluids<1, N>([&](int f) {
        bool const presentL = L_alpha[f][q] > vanishing_fraction;
        bool const presentR = R_alpha[f][q] > vanishing_fraction;
        L_alpha[f][q] = presentL ? L_alpha[f][q] : 0.0;
        R_alpha[f][q] = presentR ? R_alpha[f][q] : 0.0;
        L_partial[f][q] = presentL ? L_partial[f][q] : 0.0;
        R_partial[f][q] = presentR ? R_partial[f][q] : 0.0;
      });
      double const rhoL = sum_of_fluids<N>([&](int f) { return L_partial[f][q]; });
      double const rhoR = sum_of_fluids<N>([&](int f) { return R_partial[f][q]; });
      L_c[q] = std::sqrt((L_p[q] * (xiL + 1.0) + H[q]) / (xiL * rhoL));
      R_c[q] = std::sqrt((R_p[q] * (xiR + 1.0) + H[q]) / (xiR * rhoR));
    }
    for (int k = 1; s.bounded_phase && k < N; ++k) bound_reference_energy(s, b, a, k);
  } else {
    BRISANCE_VECTOR_LOOP
    for (int q = st; q < end; ++q) {
      double const m_B = B[q] + keep[q] * (H[q] - B[q]) * squeeze[q];
      L_e[q] = L_p[q] * xi[q] + m_B;
      R_e[q] = R_p[q] * xi[q] + m_B;
      L_c[q] = std::sqrt((L_p[q] * (xi[q] + 1.0) + H[q]) / (xi[q] * L_partial[0][q]));
      R_c[q] = std::sqrt((R_p[q] * (xi[q] + 1.0) + H[q]) / (xi[q] * R_partial[0][q]));
    }
    // The slope of B, as with several fluids: a face between a row that has them and one that has not gets the
    // same flux from both sides.
    if (curved) {
      BRISANCE_VECTOR_LOOP
      for (int q = st; q < end; ++q) {
        double const change = half_lambda * u[q];
        L_e[q] += keep[q] * (0.5 - change) * d_B[q];
        R_e[q] -= keep[q] * (0.5 + change) * d_B[q];
      }
    }
  }

  if constexpr (Solid) {
    // The other side of an obstacle's face is the mirror image of the fluid in front of it.
    double const* const solid = a[a_solid];
    for (int q = st; q < b.total - 2 * st; ++q) {
      bool const behind = solid[q + st] > 0.5;
      if ((solid[q] > 0.5) == behind) continue;
      for (int f = 0; f < face_values(most_fluids); ++f) {
        double* const left = a[a_left + f];
        double* const right = a[a_right + f];
        double const sign = f == f_u ? -1.0 : 1.0;
        if (behind)
          right[q + st] = sign * left[q];
        else
          left[q] = sign * right[q + st];
      }
    }
  }
}

/// The state beside a face with its total energy.
[[nodiscard]] inline FaceSide face_side(double rho, double u, double v, double w, double p, double rho_e, double c) {
  return {rho, u, p, rho_e + 0.5 * rho * (u * u + v * v + w * w), c};
}

/// Beside an obstacle that is one cell thick both faces of the solid cell need a state of their own, so the Riemann
/// problems read the left state from q and the right state from q + stride: they never collide.
template <int N>
void riemann(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  auto const L_partial = face_densities<N>(a, a_left);
  auto const L_alpha = face_fractions<N>(a, a_left);
  double const* const L_u = a[a_left + f_u];
  double const* const L_v = a[a_left + f_v];
  double const* const L_w = a[a_left + f_w];
  double const* const L_p = a[a_left + f_p];
  double const* const L_e = a[a_left + f_rho_e];
  double const* const L_c = a[a_left + f_c];
  int const st = b.stride;
  auto R_partial = face_densities<N>(a, a_right);
  auto R_alpha = face_fractions<N>(a, a_right);
  for_fluids<0, N>([&](int k) { R_partial[k] += st; });
  for_fluids<1, N>([&](int k) { R_alpha[k] += st; });
  double const* const R_u = a[a_right + f_u] + st;
  double const* const R_v = a[a_right + f_v] + st;
  double const* const R_w = a[a_right + f_w] + st;
  double const* const R_p = a[a_right + f_p] + st;
  double const* const R_e = a[a_right + f_rho_e] + st;
  double const* const R_c = a[a_right + f_c] + st;
  auto const flux_partial = density_fluxes<N>(a);
  auto const flux_alpha = fraction_fluxes<N>(a);
  double* const flux_u = a[a_flux + s.normal()];
  double* const flux_v = a[a_flux + s.transverse1()];
  double* const flux_w = a[a_flux + s.transverse2()];
  double* const flux_E = a[a_flux + energy];
  double* const face_speed = a[a_face_speed];

  BRISANCE_VECTOR_LOOP
  for (int q = st; q < b.total - 2 * st; ++q) {
    double const rhoL = sum_of_fluids<N>([&](int k) { return L_partial[k][q]; });
    double const rhoR = sum_of_fluids<N>([&](int k) { return R_partial[k][q]; });
    FaceSide const L = face_side(rhoL, L_u[q], L_v[q], L_w[q], L_p[q], L_e[q], L_c[q]);
    FaceSide const R = face_side(rhoR, R_u[q], R_v[q], R_w[q], R_p[q], R_e[q], R_c[q]);
    HllcFlux const f = hllc(L, R);
    // Loads stand outside the selections: a load under a condition would keep the loop from being vectorised.
    auto const upwind = [left = f.from_left](double l, double r) { return left ? l : r; };
    double const mass = f.speed * upwind(L.rho, R.rho);
    for_fluids<0, N>([&](int k) { flux_partial[k][q] = f.speed * upwind(L_partial[k][q], R_partial[k][q]); });
    for_fluids<1, N>([&](int k) { flux_alpha[k][q] = f.speed * upwind(L_alpha[k][q], R_alpha[k][q]); });
    flux_u[q] = f.momentum;
    flux_v[q] = mass * upwind(L_v[q], R_v[q]);
    flux_w[q] = mass * upwind(L_w[q], R_w[q]);
    flux_E[q] = f.energy;
    face_speed[q] = f.speed;
  }

  if (!s.shock_sensor) return;
  double const* const sensor = a[shock];
  if (count_above(sensor, b.total, 0.2) == 0) return;
  for (int q = st; q < b.total - 2 * st; ++q) {
    if (std::max(sensor[q], sensor[q + st]) <= 0.2) continue;
    double const rhoL = sum_of_fluids<N>([&](int k) { return L_partial[k][q]; });
    double const rhoR = sum_of_fluids<N>([&](int k) { return R_partial[k][q]; });
    FaceSide const L = face_side(rhoL, L_u[q], L_v[q], L_w[q], L_p[q], L_e[q], L_c[q]);
    FaceSide const R = face_side(rhoR, R_u[q], R_v[q], R_w[q], R_p[q], R_e[q], R_c[q]);
    HllFlux const f = hll(L, R);
    for_fluids<0, N>(
        [&](int k) { flux_partial[k][q] = f.from_left * L_partial[k][q] + f.from_right * R_partial[k][q]; });
    for_fluids<1, N>([&](int k) { flux_alpha[k][q] = f.from_left * L_alpha[k][q] + f.from_right * R_alpha[k][q]; });
    flux_u[q] = f.from_left * L.rho * L.u + f.from_right * R.rho * R.u + f.pressure;
    flux_v[q] = f.from_left * L.rho * L_v[q] + f.from_right * R.rho * R_v[q];
    flux_w[q] = f.from_left * L.rho * L_w[q] + f.from_right * R.rho * R_w[q];
    flux_E[q] = f.from_left * L.E + f.from_right * R.E + f.work;
    face_speed[q] = f.from_left + f.from_right;
  }
}

/// Returns whether fluxes were checked for positivity.
template <int N>
bool muscl_hancock(SweepContext const& sweep, BundleLayout const& b, BundleArrays& a, GuardCount& guards) {
  SweepContext s = sweep;
  long const risks = find_contacts_and_risks<N>(s, b, a);
  if (s.bounded_phase) {
    long uneven = 0;
    for (int k = 1; k < N; ++k) uneven += find_uneven_phase(b, a, k);
    s.bounded_phase = uneven > 0;
  }
  if (s.radial) {
    if (s.solid)
      reconstruct<N, true, true>(s, b, a);
    else
      reconstruct<N, true, false>(s, b, a);
  } else {
    if (s.solid)
      reconstruct<N, false, true>(s, b, a);
    else
      reconstruct<N, false, false>(s, b, a);
  }
  riemann<N>(s, b, a);
  if (risks > 0) limit_fluxes<N>(s, b, a, guards);
  return risks > 0;
}

}  // namespace brisance::gas
