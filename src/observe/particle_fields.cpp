#include "observe/particle_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "core/error.hpp"
#include "mpm/burn.hpp"
#include "run/system.hpp"

namespace brisance::observe {

namespace {

using mpm::Field;

/// Particles of a body in a block.
struct SetOf {
  run::System const& system;
  mpm::ParticleSet const& set;
  int body;  ///< number in the system
};

/// A field that is written as it is kept, from its first component on, or what finds it.
struct ParticleField {
  FieldInfo info;
  std::variant<Field, void (*)(SetOf const& s, double* out)> value;
};

/// A row of a quantity that is written as it is kept, under its own name or another.
ParticleField kept(Field first, std::string meaning, std::string name = {}) {
  mpm::Quantity const& q = mpm::quantity_of(first);
  return {{name.empty() ? q.name : std::move(name), q.unit, q.components, std::move(meaning)}, first};
}

void add_kept(mpm::ParticleSet const& set, Field first, int components, double* out) {
  for (int c = 0; c < components; ++c) {
    double const* const values = set.field(first + c);
    if (values == nullptr) continue;
    for (int q = 0; q < set.size(); ++q) out[q * components + c] = values[q];
  }
}

void add_displacement(SetOf const& s, double* out) {
  mpm::ParticleSet const& set = s.set;
  for (int d = 0; d < 3; ++d) {
    double const* const origin = set.field(Field::origin_x + d);
    double const* const position = set.field(Field::position_x + d);
    if (origin == nullptr) return;
    for (int q = 0; q < set.size(); ++q) out[3 * q + d] = position[q] - origin[q];
  }
}

void add_stress(SetOf const& s, double* out) {
  mpm::ParticleSet const& set = s.set;
  add_kept(set, Field::deviator_xx, 6, out);
  double const* const pressure = set.field(Field::pressure);
  for (int q = 0; q < set.size(); ++q) {
    for (int d = 0; d < 3; ++d) out[6 * q + d] -= pressure[q];
  }
}

/// The burn fraction that the pressure of the last step was taken with, [Cui14] Eqs. (52)-(53).
void add_burn_fraction(SetOf const& s, double* out) {
  mpm::ParticleSet const& set = s.set;
  double const* const lighting = set.field(Field::lighting_time);
  if (lighting == nullptr) return;
  run::BodyPlace const at = s.system.place_of(s.body);
  mpm::Mpm const& particles = *s.system.regions[at.region].particles;
  double const rate =
      mpm::burn_rate(particles.bodies()[at.body].solid.detonation_speed, particles.grid().smallest_cell());
  double const time = s.system.clock.time;
  for (int q = 0; q < set.size(); ++q) out[q] = mpm::burn_fraction(time, lighting[q], rate);
}

int material_number(run::System const& w, int body) {
  auto const& bodies = w.bodies;
  auto const first = std::find_if(bodies.begin(), bodies.end(),
                                  [&](run::BodyReport const& b) { return b.material == bodies[body].material; });
  return static_cast<int>(first - bodies.begin());
}

void add_mises(SetOf const& s, double* out) {
  for (int q = 0; q < s.set.size(); ++q) out[q] = mises_of(s.set, q);
}

void add_body(SetOf const& s, double* out) { std::fill_n(out, s.set.size(), s.body); }

void add_material(SetOf const& s, double* out) { std::fill_n(out, s.set.size(), material_number(s.system, s.body)); }

std::vector<ParticleField> const& specified_fields() {
  static std::vector<ParticleField> const fields{
      kept(Field::velocity_x, "velocity"),
      {{"displacement", "m", 3, "displacement since the start; 0 in bodies without strength, which do not record it"},
       add_displacement},
      kept(Field::pressure, "pressure (mean stress, positive in compression), without the bulk viscosity"),
      {{"mises", "Pa", 1, "equivalent stress (von Mises)"}, add_mises},
      {{"stress", "Pa", 6, "Cauchy stress without the bulk viscosity, positive in tension: xx yy zz xy yz zx"},
       add_stress},
      kept(Field::density, "density"),
      kept(Field::energy, "specific internal energy, including the elastic shear energy"),
      kept(Field::plastic_strain, "equivalent plastic strain"),
      kept(Field::plastic_work, "plastic work"),
      kept(Field::temperature, "temperature; 0 in bodies without heating"),
      kept(Field::damage, "damage, 1: failed"),
      kept(Field::crushing, "concrete: damage by compression and shear, 1: crushed"),
      kept(Field::cracking, "concrete: damage by tension, 1: cracked through"),
      {{"burn_fraction", "1", 1, "burn fraction F of programmed burn"}, add_burn_fraction},
      kept(Field::mass, "mass of the particle"),
      kept(Field::mass_fraction, "mass fraction of the second fluid (detonation products) in gas particles",
           "products"),
      kept(Field::bar_fraction, "fraction of steel of smeared reinforcement"),
      kept(Field::bar_stress, "stress of the bar through the particle"),
      kept(Field::identity, "number of the particle within its body"),
      kept(Field::viscosity, "bulk viscosity q in the last step"),
  };
  return fields;
}

std::vector<ParticleField> const& standing_fields() {
  static std::vector<ParticleField> const fields{
      kept(Field::position_x, "position"),
      {{"body", "1", 1, "number of the body in the deck, from 0"}, add_body},
      {{"material", "1", 1, "number of the first body of the same material"}, add_material},
  };
  return fields;
}

ParticleField const& field_of(std::string const& name) {
  for (auto const* list : {&specified_fields(), &standing_fields()}) {
    auto const found =
        std::find_if(list->begin(), list->end(), [&](ParticleField const& f) { return f.info.name == name; });
    if (found != list->end()) return *found;
  }
  throw InputError(fmt::format("there is no field \"{}\" for material points", name));
}

std::vector<FieldInfo> infos_of(std::vector<ParticleField> const& fields) {
  std::vector<FieldInfo> all;
  all.reserve(fields.size());
  for (ParticleField const& field : fields) all.push_back(field.info);
  return all;
}

/// Calls use(set, body) for the particles that dumps hold, region by region and block by block.
template <class Use>
void for_each_dumped(run::System const& w, Use&& use) {
  for (run::Region const& region : w.regions) {
    for (int block = 0; block < region.particles->grid().block_count(); ++block) {
      for (std::size_t n = 0; n < region.bodies.size(); ++n) {
        int const body = region.bodies[n];
        if (w.is_gas(body) && !w.setup.output.gas_particles) continue;
        use(region.particles->particles(block, static_cast<int>(n)), body);
      }
    }
  }
}

}  // namespace

std::vector<FieldInfo> const& known_particle_fields() {
  static std::vector<FieldInfo> const infos = infos_of(specified_fields());
  return infos;
}

std::vector<FieldInfo> const& standing_particle_fields() {
  static std::vector<FieldInfo> const infos = infos_of(standing_fields());
  return infos;
}

double mises_of(mpm::ParticleSet const& set, int q) {
  if (!set.fields().has(Field::deviator_xx)) return 0.0;
  double sum = 0.0;
  for (int c = 0; c < 6; ++c) {
    double const s = set.field(Field::deviator_xx + c)[q];
    sum += (c < 3 ? 1.0 : 2.0) * s * s;
  }
  return std::sqrt(1.5 * sum);
}

long dumped_particles(run::System const& w) {
  long count = 0;
  for_each_dumped(w, [&](mpm::ParticleSet const& set, int) { count += set.size(); });
  return count;
}

void particle_field(run::System const& w, std::string const& name, std::vector<double>& out) {
  ParticleField const& field = field_of(name);
  int const components = field.info.components;
  out.assign(static_cast<std::size_t>(dumped_particles(w)) * components, 0.0);
  double* at = out.data();
  for_each_dumped(w, [&](mpm::ParticleSet const& set, int body) {
    if (Field const* kept = std::get_if<Field>(&field.value)) {
      add_kept(set, *kept, components, at);
    } else {
      std::get<1>(field.value)({w, set, body}, at);
    }
    at += static_cast<std::ptrdiff_t>(set.size()) * components;
  });
}

}  // namespace brisance::observe
