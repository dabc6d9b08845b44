/// Gives traces of products the room that their density asks for.
///
/// In the five-equation model of [Allaire02] both fluids of a cell are compressed alike. Where a shock runs through gas
/// with a trace of products, their own density rises with that of the gas, far beyond what the pressure of the cell can
/// hold: at one pressure the closure then finds them colder than their cold curve, with an energy that is missing in
/// the gas, and the pressure of the cell falls, below zero in the end. Where the pressure falls and the products miss
/// more energy than the pressure stands for, they expand at once, and squeeze the gas, until they are just on their
/// cold curve:
///     p = p_c(rho_1),   rho e = (1 - alpha_1) xi_0 p + alpha_1 rho_1 e_c(rho_1),   alpha_1 rho_1 kept.
/// Mass, momentum and energy of the cell stay what they are. Elsewhere the model is left alone: acting wherever
/// products are too cold would slow a front by 0.2 % on 200 cells per charge radius.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>

#include "gas/kernels.hpp"

namespace brisance::gas {

/// Energy that a cell lacks for products of a partial density [kg/m3] in a part of it to be on their cold curve
/// [J/m3], negative where they are warmer. rho_e: its internal energy; xi0 = 1/G of the ambient fluid, an ideal gas.
template <class Products>
[[nodiscard]] double missing_heat(Products const& products, double xi0, double partial, double fraction, double rho_e) {
  double const own = partial / fraction;
  return (1.0 - fraction) * xi0 * products.cold_pressure(own) + partial * products.cold_energy(own) - rho_e;
}

/// The volume fraction above `alpha` with which nothing is missing. What is missing falls with the fraction; where it
/// does not reach 0, `alpha` stays.
template <class Products>
[[nodiscard]] double room_for_products(Products const& products, double xi0, double partial, double alpha,
                                       double rho_e) {
  auto const is_too_cold = [&](double fraction) { return missing_heat(products, xi0, partial, fraction, rho_e) > 0.0; };
  double low = alpha;
  double high = alpha;
  do {
    low = high;
    high = std::min(2.0 * high, 1.0);
  } while (high < 1.0 && is_too_cold(high));
  constexpr int bisections = 40;
  for (int n = 0; n < bisections; ++n) {
    double const middle = 0.5 * (low + high);
    (is_too_cold(middle) ? low : high) = middle;
  }
  return high < 1.0 ? high : alpha;
}

/// The cells of a bundle after its update, where fluxes were checked. `a_p` holds the pressure before it.
inline void expand_cold_products(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  auto const* gas = std::get_if<material::IdealGas>(&s.fluids->ambient());
  auto const* products = std::get_if<material::Jwl>(&s.fluids->eos[products_fluid]);
  if (gas == nullptr || products == nullptr) return;
  constexpr double falling = 0.999;  // of the pressure before: less is no round-off
  int const st = b.stride;
  double const xi0 = 1.0 / gas->gruneisen();
  double const* const risk = a[a_risk];
  double* const alpha = a[volume_fraction(products_fluid)];
  for (int r = 0; r < b.rows; ++r) {
    for (int q = b.begin(r); q < b.begin(r) + b.count(); ++q) {
      if (risk[q - st] + risk[q] + risk[q + st] < 0.5) continue;
      if (!(alpha[q] > vanishing_fraction) || alpha[q] >= 1.0) continue;
      if (s.burning && a[a_burn][q] < 1.0) continue;
      double const partial = a[partial_density(products_fluid)][q];
      double const rho = mixture_density(s, a, q);
      double const mx = a[momentum_x][q];
      double const my = a[momentum_y][q];
      double const mz = a[momentum_z][q];
      double const rho_e = a[energy][q] - 0.5 * (mx * mx + my * my + mz * mz) / rho;
      if (!(partial > 0.0) || !(rho_e > 0.0)) continue;
      Mixture const m = mixture_at(s, a, q);
      double const p = m.pressure(rho_e);
      if (p >= falling * a[a_p][q]) continue;
      if (missing_heat(*products, xi0, partial, alpha[q], rho_e) < m.xi * std::max(p, 0.0)) continue;
      alpha[q] = room_for_products(*products, xi0, partial, alpha[q], rho_e);
    }
  }
}

}  // namespace brisance::gas
