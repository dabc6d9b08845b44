/// Programmed burn of material points.
#pragma once

#include <algorithm>

namespace brisance::mpm {

/// Burn fraction of a particle at `time`, [Cui14] Eqs. (52)-(53). `rate` is `burn_rate`.
[[nodiscard]] inline double burn_fraction(double time, double lighting_time, double rate) {
  return std::clamp((time - lighting_time) * rate, 0.0, 1.0);
}

/// Rate of the burn [1/s] behind a front of the given speed [m/s] on cells of size h [m]: 1.5 cells long.
[[nodiscard]] inline double burn_rate(double detonation_speed, double h) { return detonation_speed / (1.5 * h); }

}  // namespace brisance::mpm
