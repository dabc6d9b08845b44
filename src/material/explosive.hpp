/// Explosives and ambient fluids as named, sourced sets of constants.
#pragma once

#include <optional>
#include <string>

#include "material/eos/eos.hpp"

namespace brisance::material {

/// A high explosive: its products' JWL constants and its Chapman-Jouguet state as listed by the source.
struct Explosive {
  std::string name;
  std::string source;                             ///< literature source of the constants
  Jwl products;                                   ///< equation of state of the detonation products
  double energy = 0.0;                            ///< E0, energy per unit initial volume [J/m3]
  double detonation_speed = 0.0;                  ///< D as listed [m/s]
  double cj_pressure = 0.0;                       ///< Chapman-Jouguet pressure as listed [Pa]
  std::optional<double> tnt_equivalent_pressure;  ///< mass of TNT with the same peak overpressure per mass, if known
  std::optional<double> tnt_equivalent_impulse;   ///< mass of TNT with the same impulse per mass, if known
  std::optional<double> afterburn_energy;  ///< released by complete combustion of the products in air [J/kg], if known

  [[nodiscard]] double density() const { return products.rho0; }                   ///< [kg/m3]
  [[nodiscard]] double specific_energy() const { return energy / products.rho0; }  ///< [J/kg]
};

/// A fluid that fills a region at rest or in motion: air, water, a gas of the user's own.
struct Fluid {
  std::string name;
  std::string source;
  Eos eos;
  double density = 1.225;      ///< default density [kg/m3]
  double pressure = 101325.0;  ///< default pressure [Pa]
};

}  // namespace brisance::material
