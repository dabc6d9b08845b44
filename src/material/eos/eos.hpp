/// The closed list of equations of state and what all of them share.
///
/// Contract. Every EOS is a trivially copyable value in Mie-Grueneisen form with a constant Grueneisen coefficient G,
///     p(rho, e) = f(rho) + G rho e,
/// and provides functions of a number or of a vector of numbers V, constants, and its parameter table:
///     gruneisen()           G, pure number
///     reference(rho)        f(rho) [Pa]; equals p_ref - G rho e_ref in the usual notation
///     rho_d_reference(rho)  rho f'(rho) [Pa]
///     bears_tension         whether its pressure can be negative; that of gases cannot
///     of_solids             whether a solid of a deck can have it
///     cold_energy(rho)      of gases: specific energy without thermal energy [J/kg], none has less
///     cold_pressure(rho)    and the pressure that goes with it [Pa]
/// Everything else (energy, sound speed) follows and is written once, below.
/// All equations of state of the method have a constant G; one that has not would add G(rho) to the contract.
#pragma once

#include <cmath>
#include <variant>

#include "material/eos/ideal_gas.hpp"
#include "material/eos/jwl.hpp"
#include "material/eos/mie_gruneisen.hpp"
#include "material/eos/stiffened_gas.hpp"

namespace brisance::material {

using Eos = std::variant<IdealGas, StiffenedGas, MieGruneisen, Jwl>;

/// Pressure [Pa] from density [kg/m3] and specific internal energy [J/kg].
template <class E>
[[nodiscard]] double pressure(E const& eos, double rho, double e) {
  return eos.reference(rho) + eos.gruneisen() * rho * e;
}

/// Specific internal energy [J/kg] from density [kg/m3] and pressure [Pa].
template <class E>
[[nodiscard]] double internal_energy(E const& eos, double rho, double p) {
  return (p - eos.reference(rho)) / (eos.gruneisen() * rho);
}

/// rho c^2 [Pa], c the isentropic sound speed: rho c^2 = (1 + G) p + rho f' - f.
template <class E>
[[nodiscard]] double bulk_modulus(E const& eos, double rho, double p) {
  return (1.0 + eos.gruneisen()) * p + eos.rho_d_reference(rho) - eos.reference(rho);
}

/// Isentropic sound speed [m/s].
template <class E>
[[nodiscard]] double sound_speed(E const& eos, double rho, double p) {
  return std::sqrt(bulk_modulus(eos, rho, p) / rho);
}

[[nodiscard]] inline bool bears_tension(Eos const& eos) {
  return std::visit([](auto const& m) { return m.bears_tension; }, eos);
}
/// Specific energy of a gas without thermal energy [J/kg]; 0 of what bears tension.
[[nodiscard]] inline double cold_energy(Eos const& eos, double rho) {
  return std::visit(
      [=](auto const& m) {
        if constexpr (requires { m.cold_energy(rho); }) {
          return m.cold_energy(rho);
        } else {
          return 0.0;
        }
      },
      eos);
}

/// Does the reference pressure f depend on the density?
[[nodiscard]] inline bool follows_density(Eos const& eos) {
  return !std::holds_alternative<IdealGas>(eos) && !std::holds_alternative<StiffenedGas>(eos);
}

[[nodiscard]] inline double pressure(Eos const& eos, double rho, double e) {
  return std::visit([=](auto const& m) { return pressure(m, rho, e); }, eos);
}
[[nodiscard]] inline double internal_energy(Eos const& eos, double rho, double p) {
  return std::visit([=](auto const& m) { return internal_energy(m, rho, p); }, eos);
}
[[nodiscard]] inline double bulk_modulus(Eos const& eos, double rho, double p) {
  return std::visit([=](auto const& m) { return bulk_modulus(m, rho, p); }, eos);
}
[[nodiscard]] inline double sound_speed(Eos const& eos, double rho, double p) {
  return std::visit([=](auto const& m) { return sound_speed(m, rho, p); }, eos);
}
[[nodiscard]] inline double gruneisen(Eos const& eos) {
  return std::visit([](auto const& m) { return m.gruneisen(); }, eos);
}

}  // namespace brisance::material
