/// Afterburn of the products in a bundle: how its progress is carried along, and what it releases.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/loops.hpp"
#include "gas/kernels.hpp"
#include "gas/limiters.hpp"
#include "material/afterburn.hpp"

namespace brisance::gas {

/// Flux of the progress through every face: the mass flux of the products, which the scheme has found, times lambda
/// of the side that it comes from, linear in the cell and half a step ahead. Whatever the scheme: lambda thus moves
/// with the mass, and stays in its range.
inline void progress_fluxes(SweepContext const& s, BundleLayout const& b, BundleArrays& a) {
  int const st = b.stride;
  double const* const carried = a[a_progress];
  double const* const products = a[partial_density(products_fluid)];
  double const* const u = a[a_u];
  double const* const mass = a[a_flux + partial_density(products_fluid)];
  double* const lambda = a[a_lambda];
  double* const flux = a[a_progress_flux];
  double const ahead = s.dt / s.h;
  double const half_beta = 0.5 * s.beta;
  // Lax-Wendroff overshoots: where the partial density is negative so is what it carries, and their ratio still counts.
  constexpr double nothing = 1e-300;
  BRISANCE_VECTOR_LOOP
  for (int q = 0; q < b.total; ++q) {
    bool const present = std::abs(products[q]) > nothing;
    double const x = carried[q] / (present ? products[q] : 1.0);
    lambda[q] = std::min(1.0, std::max(0.0, x));
  }
  // Where a cell holds no products its lambda says nothing, also not about its neighbour's slope.
  BRISANCE_VECTOR_LOOP
  for (int q = st; q < b.total - 2 * st; ++q) {
    int const r = q + st;
    bool const has_left = std::abs(products[q]) > nothing;
    bool const has_right = std::abs(products[r]) > nothing;
    bool const forth = has_left & ((mass[q] >= 0.0) | !has_right);
    double const between = lambda[r] - lambda[q];
    double const behind = lambda[q] - lambda[q - st];
    double const beyond = lambda[r + st] - lambda[r];
    bool const left_known = (std::abs(products[q - st]) > nothing) & has_right;
    bool const right_known = has_left & (std::abs(products[r + st]) > nothing);
    double const left_slope = left_known ? limited_half(behind, between, half_beta) : 0.0;
    double const right_slope = right_known ? limited_half(between, beyond, half_beta) : 0.0;
    double const left = lambda[q] + (1.0 - std::min(1.0, std::max(0.0, u[q] * ahead))) * left_slope;
    double const right = lambda[r] - (1.0 - std::min(1.0, std::max(0.0, -u[r] * ahead))) * right_slope;
    flux[q] = mass[q] * (forth ? left : right);
  }
}

/// Adds the energy `per_mass` [J/kg] of burnt products to every cell of the bundle. What is booked is the difference
/// that the sum really made. The burn fraction must stand in `a_burn`.
inline void release_at_once(BundleLayout const& b, double per_mass, BundleArrays& a) {
  double const* const products = a[partial_density(products_fluid)];
  double const* const F = a[a_burn];
  double* const E = a[energy];
  double* const release = a[a_release];
  for (int r = 0; r < b.rows; ++r) {
    int const begin = b.begin(r);
    int const end = begin + b.count();
    BRISANCE_VECTOR_LOOP
    for (int q = begin; q < end; ++q) {
      double const mass = F[q] >= 1.0 ? std::max(0.0, products[q]) : 0.0;
      double const before = E[q];
      double const after = before + per_mass * mass;
      E[q] = after;
      release[q] = after - before;
    }
  }
}

/// The same by a law whose progress the products carry along, with the pressure that the cell had before the sweep;
/// energy [J/kg] is that of the whole progress from 0 to 1.
template <class Law>
void release_by_law(BundleLayout const& b, double dt, double energy_per_mass, Law const model, BundleArrays& a) {
  double const* const products = a[partial_density(products_fluid)];
  double const* const F = a[a_burn];
  double const* const p = a[a_p];
  double* const carried = a[a_progress];
  double* const E = a[energy];
  double* const release = a[a_release];
  for (int r = 0; r < b.rows; ++r) {
    int const begin = b.begin(r);
    int const end = begin + b.count();
    BRISANCE_VECTOR_LOOP
    for (int q = begin; q < end; ++q) {
      bool const burnt = (F[q] >= 1.0) & (products[q] > 0.0);
      double const mass = burnt ? products[q] : 1.0;
      double const x = carried[q] / mass;
      double const unburnt = 1.0 - std::min(1.0, std::max(0.0, x));
      double const left = model.advance(unburnt, p[q], dt);
      double const step = burnt ? unburnt - left : 0.0;
      double const before = E[q];
      double const after = before + energy_per_mass * mass * step;
      E[q] = after;
      release[q] = after - before;
      carried[q] += mass * step;
    }
  }
}

}  // namespace brisance::gas
