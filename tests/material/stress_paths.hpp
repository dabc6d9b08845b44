/// Paths of prescribed stress: the lateral strain of each step is found so that the lateral stress is what it should
/// be.
#pragma once

#include <cmath>

#include "particle_driver.hpp"

namespace brisance::material {

/// Stress component xx or yy [Pa] with all of the pressure.
inline double axial_stress(Particles const& p) { return p.deviator[0][0] - p.pressure[0]; }
inline double lateral_stress(Particles const& p) { return p.deviator[1][0] - p.pressure[0]; }

/// One step with the axial strain increment `axial` and the lateral increment, equal in y and z, at which the lateral
/// stress is `lateral` [Pa]: bisection between bounds that hold the answer of every material here, to the last bits.
inline void step_with_lateral_stress(Particles& particle, double axial, double lateral) {
  auto const with = [&](double side) {
    Increment d;
    d.strain = {axial, side, side, 0.0, 0.0, 0.0};
    // The density follows the true volume.
    d.volumetric = std::exp(axial + 2.0 * side) - 1.0;
    Particles after = particle;
    after.step(d);
    return after;
  };
  double low = -5.0 * std::abs(axial);  // more tension on the upper side
  double high = 5.0 * std::abs(axial);
  for (int pass = 0; pass < 60; ++pass) {
    double const middle = 0.5 * (low + high);
    (lateral_stress(with(middle)) > lateral ? high : low) = middle;
  }
  particle = with(0.5 * (low + high));
}

}  // namespace brisance::material
