/// The conserved state of a gas cell: which component stands where.
///
/// One fluid: [Cui14] Eqs. (1)-(2). More: the five-equation model of [Allaire02]. Every fluid has a partial density
/// alpha_k rho_k, and every one beside the ambient fluid, which is number 0, a volume fraction alpha_k. What a gas does
/// not have stands at the end: it has the first `components_of` its fluids.
#pragma once

#include <array>

#include "material/amounts.hpp"
#include "material/primitive.hpp"

namespace brisance::gas {

using material::Amounts;
using material::Fractions;
using material::most_fluids;
using material::PerFluid;
using material::Primitive;
using material::products_fluid;

inline constexpr int momentum_x = 1;  ///< [kg/(m2 s)]; y and z follow
inline constexpr int momentum_y = 2;
inline constexpr int momentum_z = 3;
inline constexpr int energy = 4;  ///< total energy per volume [J/m3]
inline constexpr int shock = 5;   ///< memory of the shock sensor, 0 to 1; no physical quantity

/// How many components a gas of some fluids has.
[[nodiscard]] constexpr int components_of(int fluids) { return shock + 1 + 2 * (fluids - 1); }
/// alpha_k rho_k [kg/m3].
[[nodiscard]] constexpr int partial_density(int fluid) { return fluid == 0 ? 0 : components_of(fluid); }
/// alpha_k of a fluid from number 1 on.
[[nodiscard]] constexpr int volume_fraction(int fluid) { return components_of(fluid) + 1; }

/// alpha rho lambda of the products [kg/m3]; only with a carried afterburn.
inline constexpr int progress = components_of(most_fluids);
inline constexpr int most_components = progress + 1;

/// One value per component; those that a gas does not have are 0.
using Components = std::array<double, most_components>;

/// Is it a volume fraction?
[[nodiscard]] constexpr bool is_volume_fraction(int component) {
  return component > shock && component < progress && (component - shock) % 2 == 0;
}

/// Density of the mixture; `component(c)` is the value of component c.
template <class Component>
[[nodiscard]] double mixture_density(int fluids, Component const& component) {
  double sum = component(partial_density(0));
  for (int k = 1; k < fluids; ++k) sum += component(partial_density(k));
  return sum;
}
[[nodiscard]] inline double mixture_density(int fluids, Components const& u) {
  return mixture_density(fluids, [&u](int c) { return u[c]; });
}

/// Partial densities and volume fractions of a state, for the closure.
[[nodiscard]] inline PerFluid partial_densities(int fluids, double const* u) {
  PerFluid partial{};
  for (int k = 0; k < fluids; ++k) partial[k] = u[partial_density(k)];
  return partial;
}
[[nodiscard]] inline Fractions volume_fractions(int fluids, double const* u) {
  Fractions alpha;
  for (int k = 1; k < fluids; ++k) alpha.set(k, u[volume_fraction(k)]);
  return alpha;
}

/// Masses, momentum and energy among the components.
[[nodiscard]] inline Amounts amounts_of(Components const& u) {
  Amounts amounts;
  for (int k = 0; k < most_fluids; ++k) amounts.mass[k] = u[partial_density(k)];
  for (int d = 0; d < 3; ++d) amounts.momentum[d] = u[momentum_x + d];
  amounts.energy = u[energy];
  return amounts;
}

}  // namespace brisance::gas
