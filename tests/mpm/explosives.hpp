/// The TNT and the copper of the tests with explosives, and how their energy is counted.
#pragma once

#include "mpm/harness.hpp"

namespace brisance::test {

inline constexpr double detonation_speed = 6930.0;  // m/s

/// Particles of TNT with the constants of materials/tnt.toml.
inline material::Material tnt() {
  material::Explosive explosive;
  explosive.products = material::Jwl{};
  explosive.energy = 6.993e9;
  explosive.detonation_speed = detonation_speed;
  return material::of(explosive);
}

/// OFHC copper, [JohnsonCook83] with a Mie-Grueneisen equation of state [Steinberg96].
inline material::Material copper() {
  material::JohnsonCook strength;
  strength.G = 46e9;
  strength.A = 90e6;
  strength.B = 292e6;
  strength.n = 0.31;
  strength.C = 0.025;
  strength.m = 1.09;
  strength.T_melt = 1356.0;
  material::Material solid;
  solid.name = "copper";
  solid.density = 8960.0;
  solid.eos = material::MieGruneisen{8960.0, 3940.0, 1.489, 2.02};
  solid.strength = strength;
  solid.specific_heat = 383.0;
  return solid;
}

/// The energy of a simulation against that at its start. The velocity of the particles belongs to the middle of the
/// step (symplectic Euler), stress and internal energy to its end: the plain sum therefore lags by half a step's
/// exchange of energy, which comes and goes. `centred` takes the mean of the kinetic energies on both sides.
class EnergyWatch {
 public:
  explicit EnergyWatch(Problem const& problem) : problem_(problem), start_(problem.energy()) {
    kinetic_ = problem.kinetic_energy();
    total_ = start_;
  }

  /// Call after every step: the centred energy is that of the step before.
  void look() {
    double const kinetic = problem_.kinetic_energy();
    double const total = problem_.energy() + problem_.mpm->accounts().losses.energy;
    centred = (total_ + 0.5 * (kinetic - kinetic_)) / start_ - 1.0;
    drift = total / start_ - 1.0;
    worst_centred = std::max(worst_centred, std::abs(centred));
    worst = std::max(worst, std::abs(drift));
    kinetic_ = kinetic;
    total_ = total;
  }

  double drift = 0.0;          ///< relative
  double centred = 0.0;        ///< relative, of the step before
  double worst = 0.0;          ///< largest size of `drift` so far
  double worst_centred = 0.0;  ///< of `centred`

 private:
  Problem const& problem_;
  double start_;
  double kinetic_ = 0.0;
  double total_ = 0.0;
};

}  // namespace brisance::test
