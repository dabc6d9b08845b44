#include "observe/particle_summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "run/system.hpp"

namespace brisance::observe {

namespace {

void raise(Peak& peak, double value, double time) {
  if (value > peak.value) peak = {value, time};
}

BodySummary summary_of(run::System const& system, int body, std::string const& name,
                       std::vector<BodyRecord> const& records) {
  BodySummary s;
  s.name = name;
  s.body = system.bodies[body].name;
  s.material = system.bodies[body].material;
  s.end = system.sums(body);
  s.start = records.empty() ? s.end : records.front().sums;
  for (BodyRecord const& r : records) {
    raise(s.displacement, r.sums.largest_displacement, r.time);
    raise(s.velocity, norm(mean_velocity(r.sums)), r.time);
  }
  raise(s.displacement, s.end.largest_displacement, system.clock.time);
  raise(s.velocity, norm(mean_velocity(s.end)), system.clock.time);
  return s;
}

}  // namespace

Vec3 mean_velocity(mpm::BodySums const& s) { return s.mass > 0.0 ? (1.0 / s.mass) * s.momentum : Vec3{0.0, 0.0, 0.0}; }

ParticleSummary summarise_particle(run::System const& system, ParticleGaugeHistory const& history) {
  ParticleSummary s;
  s.name = history.gauge.name;
  s.body = system.bodies[history.gauge.body].name;
  s.lost = history.lost;
  if (history.particles.empty()) return s;
  s.position = history.particles.front().position;
  std::array<Peak, 3> components;
  for (ParticleRecord const& r : history.particles) {
    raise(s.displacement, norm(r.displacement), r.time);
    for (int d = 0; d < 3; ++d)
      if (std::abs(r.displacement[d]) > std::abs(components[d].value)) components[d] = {r.displacement[d], r.time};
    raise(s.velocity, norm(r.velocity), r.time);
    raise(s.mises, r.mises, r.time);
    s.plastic_strain = std::max(s.plastic_strain, r.plastic_strain);
    s.damage = std::max(s.damage, r.damage);
  }
  for (int d = 1; d < 3; ++d)
    if (std::abs(components[d].value) > std::abs(components[s.component].value)) s.component = d;
  s.component_displacement = components[s.component];
  s.final_displacement = history.particles.back().displacement;
  return s;
}

std::vector<ParticleSummary> summarise_particles(run::System const& system, Gauges const& gauges) {
  std::vector<ParticleSummary> out;
  for (auto const& history : gauges.particles)
    if (history.gauge.point) out.push_back(summarise_particle(system, history));
  return out;
}

std::vector<BodySummary> summarise_bodies(run::System const& system, Gauges const& gauges) {
  std::vector<BodySummary> out;
  std::vector<bool> watched(system.bodies.size(), false);
  for (auto const& history : gauges.particles) {
    if (history.gauge.point) continue;
    out.push_back(summary_of(system, history.gauge.body, history.gauge.name, history.bodies));
    watched[history.gauge.body] = true;
  }
  static std::vector<BodyRecord> const none;
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    if (watched[b]) continue;
    out.push_back(summary_of(system, static_cast<int>(b), "", gauges.bodies.empty() ? none : gauges.bodies[b]));
  }
  return out;
}

}  // namespace brisance::observe
