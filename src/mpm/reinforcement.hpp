/// Steel bars that are thinner than the grid can resolve: smeared over the particles around their axes.
///
/// A bar of area A gives the particles within one cell of its axis (or its own radius) a part f of steel, constant and
/// such that the volume of steel is that of the bar. The particles carry, beside the stress of their own material, f
/// sigma n n with the stress sigma of the bar in its direction n: perfect bond, no dowel action. sigma is
/// elastic-plastic with linear hardening under the strain n . d eps . n of the particle, and n turns with it (which for
/// small strain is the direction of the material line). What the bar displaces of its surroundings is not taken off.
/// The work of sigma is part of the particle's internal energy.
#pragma once

#include <cmath>

#include "core/vec.hpp"

namespace brisance::mpm {

struct Bar {
  int body = 0;
  Vec3 from{0.0, 0.0, 0.0};  ///< ends of the axis [m]
  Vec3 to{0.0, 0.0, 0.0};
  double diameter = 0.0;   ///< [m]
  double E = 200e9;        ///< Young's modulus [Pa]
  double yield = 500e6;    ///< [Pa]
  double hardening = 0.0;  ///< plastic modulus d sigma / d ep [Pa]
};

/// State of a bar at a particle.
struct BarState {
  double stress = 0.0;          ///< [Pa], tension positive
  double plastic_strain = 0.0;  ///< accumulated
};

/// After the strain increment `strain` along the bar.
[[nodiscard]] inline BarState stretched(Bar const& bar, BarState s, double strain) {
  double const trial = s.stress + bar.E * strain;
  double const excess = std::abs(trial) - (bar.yield + bar.hardening * s.plastic_strain);
  if (excess <= 0.0) return {trial, s.plastic_strain};
  double const flow = excess / (bar.E + bar.hardening);
  return {trial - std::copysign(bar.E * flow, trial), s.plastic_strain + flow};
}

}  // namespace brisance::mpm
