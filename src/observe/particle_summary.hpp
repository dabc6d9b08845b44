/// What an engineer reads off the gauges of the material points and off the bodies.
#pragma once

#include <string>
#include <vector>

#include "observe/gauges.hpp"

namespace brisance::observe {

/// The largest value of a history and when it was.
struct Peak {
  double value = 0.0;
  double time = 0.0;  ///< [s]
};

/// What a gauge on a particle has seen.
struct ParticleSummary {
  std::string name;
  std::string body;
  Vec3 position{0.0, 0.0, 0.0};            ///< at the start [m]
  Peak displacement;                       ///< magnitude [m]
  int component = 0;                       ///< direction of the largest displacement: 0: x
  Peak component_displacement;             ///< in that direction, with its sign [m]
  Vec3 final_displacement{0.0, 0.0, 0.0};  ///< at the end of the record [m]
  Peak velocity;                           ///< magnitude [m/s]
  Peak mises;                              ///< [Pa]
  double plastic_strain = 0.0;             ///< largest
  double damage = 0.0;                     ///< largest
  bool lost = false;                       ///< the particle left the domain, and the record ended
};

/// What became of a body from the start to the end.
struct BodySummary {
  std::string name;  ///< of the gauge; empty: the body has none
  std::string body;
  std::string material;
  mpm::BodySums start;
  mpm::BodySums end;
  Peak displacement;  ///< largest displacement of any of its particles [m]
  Peak velocity;      ///< of its centre of mass [m/s]
};

[[nodiscard]] ParticleSummary summarise_particle(run::System const& system, ParticleGaugeHistory const& history);
/// One of each gauge that watches a body, then one of each body without such a gauge.
[[nodiscard]] std::vector<BodySummary> summarise_bodies(run::System const& system, Gauges const& gauges);
/// Of the gauges that ride on a particle.
[[nodiscard]] std::vector<ParticleSummary> summarise_particles(run::System const& system, Gauges const& gauges);

/// Velocity of a body's centre of mass [m/s].
[[nodiscard]] Vec3 mean_velocity(mpm::BodySums const& sums);

}  // namespace brisance::observe
