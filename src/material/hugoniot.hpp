/// Shocks of a fluid with any equation of state, from the Rankine-Hugoniot relations: steady, normal, without reaction.
#pragma once

#include <cmath>

#include "material/eos/eos.hpp"

namespace brisance::material {

/// The state behind a shock.
struct Shocked {
  double density = 0.0;   ///< [kg/m3]
  double pressure = 0.0;  ///< [Pa]
  double speed = 0.0;     ///< of the shock, against the fluid ahead [m/s]
  double jump = 0.0;      ///< of the particle velocity [m/s]
};

/// The shock that raises a fluid of density `rho` and pressure `p` to the pressure `behind` (> p).
[[nodiscard]] inline Shocked shocked(Eos const& eos, double rho, double p, double behind) {
  double const c = sound_speed(eos, rho, p);
  double const rise = behind - p;
  Shocked s{rho, behind, c, rise / (rho * c)};
  if (!(rise > 0.0)) return s;
  // Excess of the internal energy behind over the Hugoniot's: positive for no compression, and falling with it.
  double const energy = internal_energy(eos, rho, p);
  auto const excess = [&](double density) {
    return internal_energy(eos, density, behind) - energy - 0.5 * (p + behind) * (1.0 / rho - 1.0 / density);
  };
  double const gamma = 1.0 + gruneisen(eos);
  double low = rho;
  double high = rho * (gamma + 1.0) / (gamma - 1.0);  // no shock compresses more
  if (excess(high) > 0.0) return s;
  for (int n = 0; n < 60; ++n) {
    double const middle = 0.5 * (low + high);
    (excess(middle) > 0.0 ? low : high) = middle;
  }
  double const volume = 1.0 / rho - 1.0 / high;
  // A shock so weak that its compression drowns in round-off is a sound wave.
  if (!(volume * rho > 1e-9)) return s;
  double const flux = std::sqrt(rise / volume);
  return {high, behind, flux / rho, flux * volume};
}

/// The shock that, reflected from a rigid wall, leaves the pressure `behind` (> p) there.
[[nodiscard]] inline Shocked incident_of_reflected(Eos const& eos, double rho, double p, double behind) {
  // The reflected shock brings the fluid to rest: both jumps of the velocity are the same.
  double low = p;
  double high = behind;
  for (int n = 0; n < 60; ++n) {
    double const middle = 0.5 * (low + high);
    Shocked const first = shocked(eos, rho, p, middle);
    (first.jump < shocked(eos, first.density, middle, behind).jump ? low : high) = middle;
  }
  return shocked(eos, rho, p, high);
}

}  // namespace brisance::material
