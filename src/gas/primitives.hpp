/// From conserved to primitive variables in a bundle, with the guards that keep density and internal energy positive.
#pragma once

#include <cmath>
#include <variant>

#include "gas/kernels.hpp"

namespace brisance::gas {

/// Closure sums where the ambient fluid is alone.
inline void closure_row_single(SweepContext const& s, int n, double const* rho, double* xi, double* B, double* H) {
  if (auto const* ideal = std::get_if<material::IdealGas>(&s.fluids->ambient())) {
    // The same in every cell: what the last bundle has left often still stands there.
    double const x = 1.0 / ideal->gruneisen();
    long other = 0;
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) other += (xi[q] != x) | (B[q] != 0.0) | (H[q] != 0.0) ? 1 : 0;
    if (other == 0) return;
    std::fill_n(xi, n, x);
    std::fill_n(B, n, 0.0);
    std::fill_n(H, n, 0.0);
    return;
  }
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

/// Closure of one state of N fluids; F: burn fraction.
template <int N>
[[nodiscard]] Mixture closure_of(Fluids const& fluids, PerFluid const& partial, PerFluid const& alpha, double F) {
  Mixture m;
  double rest = 1.0;
  for_fluids<1, N>([&](int k) { rest -= alpha[k]; });
  std::visit([&](auto const& eos) { add_fluid(eos, rest, phase_density(partial[0], rest), m); }, fluids.ambient());
  for_fluids<1, N>([&](int k) {
    std::visit(
        [&](auto const& eos) {
          add_burning_fluid(eos, alpha[k], phase_density(partial[k], alpha[k]), F, fluids.ambient_pressure, m);
        },
        fluids.eos[k]);
  });
  return m;
}

/// Is cell q of the bundle one of the block's own (and not a ghost cell)?
inline bool is_own(BundleLayout const& b, int q) {
  constexpr int g = grid::ghost_layers;
  int const layer = b.direction == 0 ? q % (b.length + 2 * g) : q / b.stride;
  return layer >= g && layer < g + b.length;
}

/// How far a state is from losing its meaning [Pa]: where a fluid bears tension (`most_H` infinite) the stiffness
/// xi rho c^2 = p (xi + 1) + H; where none does (0) a negative pressure has no meaning either, for the energy is then
/// less than that of the cold products.
[[nodiscard]] inline double margin(double p, double xi, double H, double most_H) {
  return p * (xi + 1.0) + std::min(H, most_H);
}

/// Is the cell above the floors of density and of `margin`? False for anything that is no number.
[[nodiscard]] inline bool is_sound(Floors const floors, double most_H, double rho, double p, double xi, double H) {
  return (rho >= 0.999999 * floors.density) & (margin(p, xi, H, most_H) >= 0.999999 * floors.pressure * (xi + 1.0));
}

/// Lifts one cell to the floors.
inline Lift lift_cell(SweepContext const& s, BundleArrays& a, int q) {
  Floors const floors = s.floors;
  Lift lift{q};
  double rho = mixture_density(s, a, q);
  double const E = a[energy][q];
  double const mx = a[momentum_x][q];
  double const my = a[momentum_y][q];
  double const mz = a[momentum_z][q];
  lift.finite = std::isfinite(rho + E + mx + my + mz);
  if (!lift.finite) return lift;
  if (rho < floors.density) {
    lift.mass = floors.density - rho;
    a[partial_density(0)][q] += lift.mass;
    rho = floors.density;
  }
  double const xi = a[a_xi][q];
  double const B = a[a_B][q];
  double const H = a[a_H][q];
  double const kinetic = 0.5 * (mx * mx + my * my + mz * mz) / rho;
  double const p = (E - kinetic - B) / xi;
  lift.finite = std::isfinite(p);
  if (lift.finite && !is_sound(floors, s.most_H, rho, p, xi, H)) {
    double const lifted = (floors.pressure - std::min(H, s.most_H) / (xi + 1.0)) * xi + B + kinetic;
    lift.energy = lifted - E;
    a[energy][q] = lifted;
  }
  return lift;
}

/// Lifts every unsound cell in [begin, begin + n) whose closure sums are known, and remembers the block's own. Seldom
/// called.
inline void lift_cells(SweepContext const& s, BundleLayout const& b, BundleArrays& a, int begin, int n,
                       GuardCount& guards) {
  Floors const floors = s.floors;
  for (int q = begin; q < begin + n; ++q) {
    double const rho = mixture_density(s, a, q);
    if (is_sound(floors, s.most_H, rho, a[a_p][q], a[a_xi][q], a[a_H][q])) continue;
    Lift const lift = lift_cell(s, a, q);
    if (is_own(b, q)) guards.lifts.push_back(lift);
  }
}

template <int N>
void primitives(SweepContext const& s, BundleLayout const& b, BundleArrays& a, GuardCount& guards) {
  int const n = b.total;
  Floors const floors = s.floors;
  double const most_H = s.most_H;
  auto const partial = rows_of_fluids<N>(a, 0);
  double* const E = a[energy];
  double const* const mu = a[s.normal()];
  double const* const mv = a[s.transverse1()];
  double const* const mw = a[s.transverse2()];
  double* const u = a[a_u];
  double* const v = a[a_v];
  double* const w = a[a_w];
  double* const p = a[a_p];
  double* const xi = a[a_xi];
  double* const B = a[a_B];
  double* const H = a[a_H];
  double* const inverse = a[a_inverse];

  closure_row<N>(s, n, partial, volume_fraction_rows<N>(a, 0), s.burning ? a[a_burn] : nullptr, xi, B, H);

  for (bool lifted = false;; lifted = true) {
    long unsound = 0;
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) {
      double const rho = sum_of_fluids<N>([&](int k) { return partial[k][q]; });
      double const r = 1.0 / rho;
      inverse[q] = r;
      u[q] = mu[q] * r;
      v[q] = mv[q] * r;
      w[q] = mw[q] * r;
      double const rho_e = E[q] - 0.5 * (mu[q] * u[q] + mv[q] * v[q] + mw[q] * w[q]);
      p[q] = (rho_e - B[q]) / xi[q];
      unsound += is_sound(floors, most_H, rho, p[q], xi[q], H[q]) ? 0 : 1;
    }
    if (unsound == 0 || lifted) break;
    lift_cells(s, b, a, 0, n, guards);
  }

  if (s.shock_sensor) {
    // A cell remembers a shock for the next sweeps, whatever their direction, because the carbuncle grows along the
    // shock.
    double* const sensor = a[shock];
    double* const found = a[a_sensor];
    int const st = b.stride;
    BRISANCE_VECTOR_LOOP
    for (int q = st; q < n - st; ++q) {
      double const jump = std::abs(p[q + st] - p[q - st]);
      double const least = std::min(p[q - st], std::min(p[q], p[q + st]));
      bool const shocked = (jump > 0.5 * std::abs(least)) & (u[q - st] > u[q + st]);
      double const kept = sensor[q] > 0.3 ? 0.5 * sensor[q] : 0.0;
      found[q] = shocked ? 1.0 : kept;
    }
  }
}

/// Pressure and |u| + c of the cells [begin, begin + n) after an update, with the guards: the step may not end with a
/// cell below the floors either, for gauges and dumps would show it. Returns the largest signal [m/s].
template <int N>
double signals(SweepContext const& s, BundleLayout const& b, BundleArrays& a, int begin, int n, int dimensions,
               GuardCount& guards) {
  auto const partial = rows_of_fluids<N>(a, begin);
  double const* const E = a[energy] + begin;
  double const* const mx = a[momentum_x] + begin;
  double const* const my = a[momentum_y] + begin;
  double const* const mz = a[momentum_z] + begin;
  double* const xi = a[a_xi] + begin;
  double* const B = a[a_B] + begin;
  double* const H = a[a_H] + begin;
  double* const p = a[a_p] + begin;
  double* const signal = a[a_signal] + begin;
  closure_row<N>(s, n, partial, volume_fraction_rows<N>(a, begin), s.burning ? a[a_burn] + begin : nullptr, xi, B, H);
  Floors const floors = s.floors;
  double const most_H = s.most_H;
  double const use_y = dimensions > 1 ? 1.0 : 0.0;
  double const use_z = dimensions > 2 ? 1.0 : 0.0;
  for (bool lifted = false;; lifted = true) {
    long unsound = 0;
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) {
      double const rho = sum_of_fluids<N>([&](int k) { return partial[k][q]; });
      double const inverse = 1.0 / rho;
      double const rho_e = E[q] - 0.5 * (mx[q] * mx[q] + my[q] * my[q] + mz[q] * mz[q]) * inverse;
      p[q] = (rho_e - B[q]) / xi[q];
      double const c = std::sqrt(std::max(0.0, p[q] + (p[q] + H[q]) / xi[q]) * inverse);
      double const x = std::abs(mx[q]);
      double const y = use_y * std::abs(my[q]);
      double const z = use_z * std::abs(mz[q]);
      signal[q] = std::max(x, std::max(y, z)) * inverse + c;
      unsound += is_sound(floors, most_H, rho, p[q], xi[q], H[q]) ? 0 : 1;
    }
    if (unsound == 0 || lifted) break;
    lift_cells(s, b, a, begin, n, guards);
  }
  return largest_of(signal, n);
}

}  // namespace brisance::gas
