/// The Chapman-Jouguet state of an explosive from its own JWL constants, and the check of a set of constants against
/// it.
#pragma once

#include "material/explosive.hpp"

namespace brisance::material {

/// Largest deviation of the detonation speed and of the Chapman-Jouguet pressure computed from the JWL constants from
/// the listed ones at which a set is consistent. JWL constants are fitted with both as constraints, so what is left is
/// rounding of the printed constants; sets that mix two fits miss by several per cent.
inline constexpr double speed_tolerance = 0.003;
inline constexpr double cj_pressure_tolerance = 0.01;

/// The state right behind a steady plane detonation that runs into the unreacted explosive at rest and at zero
/// pressure.
struct ChapmanJouguet {
  double speed = 0.0;              ///< detonation speed D [m/s]
  double pressure = 0.0;           ///< [Pa]
  double relative_volume = 0.0;    ///< V = rho0 / rho
  double density = 0.0;            ///< [kg/m3]
  double particle_velocity = 0.0;  ///< in the direction of the detonation [m/s]
  double sound_speed = 0.0;        ///< [m/s]; equals D - u
  double specific_energy = 0.0;    ///< internal energy of the products [J/kg]
};

/// Chapman-Jouguet state from the products' JWL and the energy E0 per unit initial volume [J/m3].
/// The detonation speed is the smallest that reaches the products' Hugoniot: rho0 D^2 = min over V of p_H(V) / (1 - V),
/// where the Rayleigh line touches it and the flow behind the front is sonic. Throws InputError when the constants have
/// no such state.
[[nodiscard]] ChapmanJouguet chapman_jouguet(Jwl const& products, double energy);

/// How far the listed detonation speed and pressure are from those of the constants.
struct ChapmanJouguetCheck {
  ChapmanJouguet state;             ///< from the constants
  double speed_deviation = 0.0;     ///< (computed - listed) / listed
  double pressure_deviation = 0.0;  ///< (computed - listed) / listed

  /// Whether both deviations are within the tolerances above.
  [[nodiscard]] bool consistent() const;
};

[[nodiscard]] ChapmanJouguetCheck check(Explosive const& explosive);

}  // namespace brisance::material
