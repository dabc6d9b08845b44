/// Drives material points along strain paths and keeps account of the work from outside.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "material/stress.hpp"

namespace brisance::material {

/// What happens to a particle in one step.
struct Increment {
  std::array<double, 6> strain{};    ///< xx yy zz xy yz zx
  std::array<double, 3> spin{};      ///< axial vector [rad]
  std::optional<double> volumetric;  ///< trace of the strain if absent
  double burn = 1.0;
};

/// Simple shear v_x = rate y over one step: gamma = rate dt.
inline Increment shear_xy(double gamma) {
  Increment d;
  d.strain[3] = 0.5 * gamma;
  d.spin[2] = -0.5 * gamma;
  return d;
}

/// Shear of the same amount without rotation.
inline Increment pure_shear_xy(double gamma) {
  Increment d;
  d.strain[3] = 0.5 * gamma;
  return d;
}

/// Stretch along x by the factor `ratio` per step: the density falls by exactly this factor.
inline Increment stretch_x(double ratio) {
  Increment d;
  d.strain[0] = std::log(ratio);
  d.volumetric = ratio - 1.0;
  return d;
}

/// The same in all directions; `ratio` is that of the volume.
inline Increment swell(double ratio) {
  Increment d;
  for (int c = 0; c < 3; ++c) d.strain[c] = std::log(ratio) / 3.0;
  d.volumetric = ratio - 1.0;
  return d;
}

/// `n` particles of one solid. All arrays exist; only those that the solid has are handed over.
class Particles {
 public:
  explicit Particles(Material solid_, int n_ = 1) : solid(std::move(solid_)), n(n_) {
    for (auto* x : {&pressure, &viscosity, &density, &energy, &plastic_strain, &plastic_work, &temperature, &damage,
                    &crushing, &cracking, &compression, &sound_speed, &work, &path}) {
      x->assign(n, 0.0);
    }
    for (auto& x : deviator) x.assign(n, 0.0);
    for (int i = 0; i < n; ++i) {
      pressure[i] = start_pressure(solid);
      density[i] = solid.density;
      energy[i] = solid.specific_energy;
      temperature[i] = solid.temperature;
    }
  }

  Material solid;
  int n;
  StepData data{1e-6, 0.0};  ///< no length: no viscosity, unless a test asks for it
  std::array<std::vector<double>, 6> deviator;
  std::vector<double> pressure, viscosity, density, energy, plastic_strain, plastic_work, temperature, damage, crushing,
      cracking, compression, sound_speed;
  std::vector<double> mass_fraction, volume_fraction;  ///< handed over where they are not empty
  std::vector<double> work;  ///< done on the particles since the start, from the stresses before and after [J/kg]
  std::vector<double> path;  ///< sum of the magnitudes of its parts [J/kg]

  /// The same increment for all particles.
  void step(Increment const& d) { step(std::vector<Increment>(n, d)); }

  void step(std::vector<Increment> const& increments) {
    std::array<std::vector<double>, 6> strain;
    std::array<std::vector<double>, 3> spin;
    std::vector<double> volumetric;
    std::vector<double> burn;
    for (auto const& d : increments) {
      for (int c = 0; c < 6; ++c) strain[c].push_back(d.strain[c]);
      for (int c = 0; c < 3; ++c) spin[c].push_back(d.spin[c]);
      volumetric.push_back(d.volumetric.value_or(d.strain[0] + d.strain[1] + d.strain[2]));
      burn.push_back(d.burn);
    }
    ParticleArrays a;
    a.n = n;
    a.volumetric = volumetric.data();
    a.pressure = pressure.data();
    a.viscosity = viscosity.data();
    a.density = density.data();
    a.energy = energy.data();
    a.sound_speed = sound_speed.data();
    if (solid.burns()) a.burn = burn.data();
    if (!mass_fraction.empty()) a.mass_fraction = mass_fraction.data();
    if (!volume_fraction.empty()) a.volume_fraction = volume_fraction.data();
    if (solid.has_deviator()) {
      for (int c = 0; c < 6; ++c) a.strain[c] = strain[c].data();
      for (int c = 0; c < 3; ++c) a.spin[c] = spin[c].data();
      for (int c = 0; c < 6; ++c) a.deviator[c] = deviator[c].data();
    }
    if (solid.plastic()) {
      a.plastic_strain = plastic_strain.data();
      a.plastic_work = plastic_work.data();
    }
    if (solid.heats()) a.temperature = temperature.data();
    if (solid.damages()) a.damage = damage.data();
    if (solid.crushes()) {
      a.crushing = crushing.data();
      a.cracking = cracking.data();
      a.compression = compression.data();
    }

    Particles const before = *this;
    update_stress(solid, a, data);

    for (int i = 0; i < n; ++i) {
      double const V0 = 1.0 / before.density[i];
      double const V1 = 1.0 / density[i];
      double const mean = (strain[0][i] + strain[1][i] + strain[2][i]) / 3.0;
      double sheared = 0.0;
      for (int c = 0; c < 6; ++c) {
        double const s = 0.5 * (before.deviator[c][i] + deviator[c][i]);
        sheared += (c < 3 ? 1.0 : 2.0) * s * (strain[c][i] - (c < 3 ? mean : 0.0));
      }
      double const squeezed = -(0.5 * (before.pressure[i] + pressure[i]) + viscosity[i]) * (V1 - V0);
      work[i] += 0.5 * (V0 + V1) * sheared + squeezed;
      path[i] += 0.5 * (V0 + V1) * std::abs(sheared) + std::abs(squeezed);
    }
  }

  /// Mises stress [Pa].
  [[nodiscard]] double mises(int i = 0) const { return std::sqrt(1.5 * square(i)); }
  /// s : s [Pa2]
  [[nodiscard]] double square(int i = 0) const {
    double sum = 0.0;
    for (int c = 0; c < 6; ++c) sum += (c < 3 ? 1.0 : 2.0) * deviator[c][i] * deviator[c][i];
    return sum;
  }
};

}  // namespace brisance::material
