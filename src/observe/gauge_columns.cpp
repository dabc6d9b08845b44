#include "observe/gauge_columns.hpp"

#include "observe/particle_summary.hpp"

namespace brisance::observe {

namespace {

double overpressure(GasMoment const& m) { return m.record.pressure - m.ambient_pressure; }

double dynamic_pressure(GasMoment const& m) {
  return 0.5 * m.record.density * dot(m.record.velocity, m.record.velocity);
}

}  // namespace

std::vector<GasColumn> const& gas_columns() {
  static std::vector<GasColumn> const columns{
      {"pressure", "Pa", [](GasMoment const& m) { return m.record.pressure; }},
      {"overpressure", "Pa", overpressure},
      {"density", "kg/m3", [](GasMoment const& m) { return m.record.density; }},
      {"velocity", "m/s", [](GasMoment const& m) { return m.record.velocity; }},
      {"dynamic_pressure", "Pa", dynamic_pressure},
      {"impulse", "Pa s", [](GasMoment const& m) { return m.impulse; }},
  };
  return columns;
}

std::vector<ParticleColumn> const& particle_columns() {
  static std::vector<ParticleColumn> const columns{
      {"", "m", [](ParticleMoment const& m) { return m.record.position; }},
      {"displacement", "m", [](ParticleMoment const& m) { return m.record.displacement; }},
      {"velocity", "m/s", [](ParticleMoment const& m) { return m.record.velocity; }},
      {"pressure", "Pa", [](ParticleMoment const& m) { return m.record.pressure; }},
      {"mises", "Pa", [](ParticleMoment const& m) { return m.record.mises; }},
      {"density", "kg/m3", [](ParticleMoment const& m) { return m.record.density; }},
      {"plastic_strain", "1", [](ParticleMoment const& m) { return m.record.plastic_strain; }},
      {"temperature", "K", [](ParticleMoment const& m) { return m.record.temperature; }},
      {"damage", "1", [](ParticleMoment const& m) { return m.record.damage; }},
  };
  return columns;
}

std::vector<BodyColumn> const& body_columns() {
  static std::vector<BodyColumn> const columns{
      {"mass", "kg", [](BodyMoment const& m) { return m.sums.mass; }},
      {"momentum", "kg m/s", [](BodyMoment const& m) { return m.sums.momentum; }},
      {"centre", "m", [](BodyMoment const& m) { return m.sums.centre; }},
      {"velocity", "m/s", [](BodyMoment const& m) { return mean_velocity(m.sums); }},
      {"kinetic_energy", "J", [](BodyMoment const& m) { return m.sums.kinetic_energy; }},
      {"internal_energy", "J", [](BodyMoment const& m) { return m.sums.internal_energy; }},
      {"plastic_work", "J", [](BodyMoment const& m) { return m.sums.plastic_work; }},
      {"largest_displacement", "m", [](BodyMoment const& m) { return m.sums.largest_displacement; }},
      {"damaged_mass", "kg", [](BodyMoment const& m) { return m.sums.damaged_mass; }},
  };
  return columns;
}

}  // namespace brisance::observe
