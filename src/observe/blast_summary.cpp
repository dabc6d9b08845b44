#include "observe/blast_summary.hpp"

#include <algorithm>
#include <cmath>

#include "observe/expected_peak.hpp"
#include "shape/shape.hpp"

namespace brisance::observe {

namespace {

/// The charge whose centre is nearest to x, or null.
Charge const* nearest_charge(Case const& setup, Vec3 const& x) {
  Charge const* nearest = nullptr;
  for (auto const& charge : setup.charges)
    if (nearest == nullptr || norm(x - shape::centre(charge.shape)) < norm(x - shape::centre(nearest->shape)))
      nearest = &charge;
  return nearest;
}

}  // namespace

bool empirical_applies(Case const& setup) {
  return setup.burst != Burst::none && setup.charges.size() == 1 &&
         std::holds_alternative<material::IdealGas>(setup.ambient.fluid.eos);
}

empirical::Blast empirical_blast(material::Explosive const& explosive, double mass, Ambient const& air, Burst kind,
                                 double distance) {
  empirical::Atmosphere const atmosphere{air.state.pressure,
                                         material::sound_speed(air.fluid.eos, air.state.density, air.state.pressure)};
  auto const burst = kind == Burst::spherical ? empirical::Burst::spherical : empirical::Burst::hemispherical;
  auto const of_equivalent = [&](std::optional<double> tnt) {
    return tnt ? empirical::kingery_bulmash(mass * *tnt, distance, burst, atmosphere) : empirical::Blast{};
  };
  auto const by_pressure = of_equivalent(explosive.tnt_equivalent_pressure);
  auto blast = of_equivalent(explosive.tnt_equivalent_impulse);
  blast.scaled_distance = by_pressure.scaled_distance;
  blast.incident_overpressure = by_pressure.incident_overpressure;
  blast.reflected_overpressure = by_pressure.reflected_overpressure;
  blast.dynamic_pressure = by_pressure.dynamic_pressure;
  blast.shock_speed = by_pressure.shock_speed;
  return blast;
}

empirical::Blast empirical_blast(Case const& setup, double distance) {
  if (!empirical_applies(setup)) return {};
  Charge const& charge = setup.charges.front();
  auto blast = empirical_blast(charge.explosive, charge.mass, setup.ambient, setup.burst, distance);
  if (blast.arrival && charge.detonation == Detonation::programmed && !charge.initiation.empty()) {
    auto const first = std::ranges::min_element(charge.initiation, {}, &InitiationPoint::delay);
    *blast.arrival += first->delay;
  }
  return blast;
}

std::vector<GaugeSummary> summarise(Case const& setup, std::vector<GaugeHistory> const& gauges) {
  std::vector<GaugeSummary> summaries;
  std::vector<double> time;
  std::vector<double> overpressure;
  auto const& air = setup.ambient;
  Surroundings around{air.fluid.eos, air.state.density, air.state.pressure, 0.0, {}};
  for (auto const& history : gauges) {
    time.clear();
    overpressure.clear();
    around.velocity.clear();
    around.cell = expected_cell(setup, history.gauge.position);
    for (auto const& record : history.records) {
      time.push_back(record.time);
      overpressure.push_back(record.pressure - setup.ambient.state.pressure);
      around.velocity.push_back(record.velocity);
    }
    GaugeSummary summary{
        history.gauge.name, history.gauge.position, analyse_blast(time, overpressure, &around), {}, {}, {}};
    if (auto const* charge = nearest_charge(setup, history.gauge.position)) {
      double const distance = norm(history.gauge.position - shape::centre(charge->shape));
      summary.distance = distance;
      if (auto const tnt = charge->explosive.tnt_equivalent_pressure) {
        summary.scaled_distance = distance / std::cbrt(charge->mass * *tnt);
      }
      if (distance > 0.0) summary.empirical = empirical_blast(setup, distance);
    }
    summaries.push_back(std::move(summary));
  }
  return summaries;
}

}  // namespace brisance::observe
