#include "observe/point_fields.hpp"

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

/// Points of a body in a block.
struct SetOf {
  run::System const& system;
  mpm::PointSet const& set;
  int body;
};

/// A field that is written as it is kept, from its first component on, or what finds it.
struct PointField {
  FieldInfo info;
  std::variant<Field, void (*)(SetOf const& s, double* out)> value;
};

void add_kept(mpm::PointSet const& set, Field first, int components, double* out) {
  for (int c = 0; c < components; ++c) {
    double const* const values = set.field(first + c);
    if (values == nullptr) continue;
    for (int q = 0; q < set.size(); ++q) out[q * components + c] = values[q];
  }
}

void add_displacement(SetOf const& s, double* out) {
  mpm::PointSet const& set = s.set;
  for (int d = 0; d < 3; ++d) {
    double const* const origin = set.field(Field::origin_x + d);
    double const* const position = set.field(Field::position_x + d);
    if (origin == nullptr) return;
    for (int q = 0; q < set.size(); ++q) out[3 * q + d] = position[q] - origin[q];
  }
}

void add_stress(SetOf const& s, double* out) {
  mpm::PointSet const& set = s.set;
  add_kept(set, Field::deviator_xx, 6, out);
  double const* const pressure = set.field(Field::pressure);
  for (int q = 0; q < set.size(); ++q) {
    for (int d = 0; d < 3; ++d) out[6 * q + d] -= pressure[q];
  }
}

/// The burn fraction that the pressure of the last step was taken with, [Cui14] Eqs. (52)-(53).
void add_burn_fraction(SetOf const& s, double* out) {
  mpm::PointSet const& set = s.set;
  double const* const lighting = set.field(Field::lighting_time);
  if (lighting == nullptr) return;
  double const speed = s.system.points->bodies()[s.body].solid.detonation_speed;
  double const rate = mpm::burn_rate(speed, s.system.points->grid().smallest_cell());
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

std::vector<PointField> const& specified_fields() {
  static std::vector<PointField> const fields{
      {{"velocity", "m/s", 3, "velocity"}, Field::velocity_x},
      {{"displacement", "m", 3, "displacement since the start; 0 in bodies without strength, which do not know it"},
       add_displacement},
      {{"pressure", "Pa", 1, "mean stress, compression positive, without the bulk viscosity"}, Field::pressure},
      {{"mises", "Pa", 1, "equivalent stress (von Mises)"}, add_mises},
      {{"stress", "Pa", 6, "Cauchy stress without the bulk viscosity, tension positive: xx yy zz xy yz zx"},
       add_stress},
      {{"density", "kg/m3", 1, "density"}, Field::density},
      {{"energy", "J/kg", 1, "specific internal energy, the elastic energy of shear included"}, Field::energy},
      {{"plastic_strain", "1", 1, "equivalent plastic strain"}, Field::plastic_strain},
      {{"plastic_work", "J/kg", 1, "plastic work"}, Field::plastic_work},
      {{"temperature", "K", 1, "temperature; 0 in bodies that do not heat"}, Field::temperature},
      {{"damage", "1", 1, "damage, 1: failed"}, Field::damage},
      {{"compression_damage", "1", 1, "concrete: damage by compression and shear, 1: crushed"}, Field::crushing},
      {{"tensile_damage", "1", 1, "concrete: damage by tension, 1: cracked through"}, Field::cracking},
      {{"burn_fraction", "1", 1, "burn fraction F of programmed burn"}, add_burn_fraction},
      {{"mass", "kg", 1, "mass of the point"}, Field::mass},
      {{"products", "1", 1, "mass fraction of the second fluid (detonation products) in gas points"},
       Field::mass_fraction},
      {{"bar_part", "1", 1, "part of steel of smeared reinforcement"}, Field::bar_part},
      {{"bar_stress", "Pa", 1, "stress of the bar that runs through the point"}, Field::bar_stress},
      {{"identity", "1", 1, "number of the point within its body"}, Field::identity},
      {{"viscosity", "Pa", 1, "bulk viscosity q of the last step"}, Field::viscosity},
  };
  return fields;
}

std::vector<PointField> const& standing_fields() {
  static std::vector<PointField> const fields{
      {{"position", "m", 3, "position"}, Field::position_x},
      {{"body", "1", 1, "number of the body in the deck, from 0"}, add_body},
      {{"material", "1", 1, "number of the first body of the same material"}, add_material},
  };
  return fields;
}

PointField const& field_of(std::string const& name) {
  for (auto const* list : {&specified_fields(), &standing_fields()}) {
    auto const found =
        std::find_if(list->begin(), list->end(), [&](PointField const& f) { return f.info.name == name; });
    if (found != list->end()) return *found;
  }
  throw InputError(fmt::format("there is no field \"{}\" of the material points", name));
}

std::vector<FieldInfo> infos_of(std::vector<PointField> const& fields) {
  std::vector<FieldInfo> all;
  all.reserve(fields.size());
  for (PointField const& field : fields) all.push_back(field.info);
  return all;
}

}  // namespace

std::vector<FieldInfo> const& known_point_fields() {
  static std::vector<FieldInfo> const infos = infos_of(specified_fields());
  return infos;
}

std::vector<FieldInfo> const& standing_point_fields() {
  static std::vector<FieldInfo> const infos = infos_of(standing_fields());
  return infos;
}

double mises_of(mpm::PointSet const& set, int q) {
  if (!set.fields().has(Field::deviator_xx)) return 0.0;
  double sum = 0.0;
  for (int c = 0; c < 6; ++c) {
    double const s = set.field(Field::deviator_xx + c)[q];
    sum += (c < 3 ? 1.0 : 2.0) * s * s;
  }
  return std::sqrt(1.5 * sum);
}

int dumped_bodies(run::System const& w) {
  int const count = static_cast<int>(w.points->bodies().size());
  return w.gas_body() >= 0 && !w.setup.output.gas_points ? count - 1 : count;
}

long dumped_points(run::System const& w) {
  long count = 0;
  for (int block = 0; block < w.points->grid().block_count(); ++block) {
    for (int body = 0; body < dumped_bodies(w); ++body) count += w.points->points(block, body).size();
  }
  return count;
}

void point_field(run::System const& w, std::string const& name, std::vector<double>& out) {
  PointField const& field = field_of(name);
  int const components = field.info.components;
  mpm::Mpm const& points = *w.points;
  out.assign(static_cast<std::size_t>(dumped_points(w)) * components, 0.0);
  double* at = out.data();
  int const bodies = dumped_bodies(w);
  for (int block = 0; block < points.grid().block_count(); ++block) {
    for (int body = 0; body < bodies; ++body) {
      mpm::PointSet const& set = points.points(block, body);
      if (Field const* kept = std::get_if<Field>(&field.value)) {
        add_kept(set, *kept, components, at);
      } else {
        std::get<1>(field.value)({w, set, body}, at);
      }
      at += static_cast<std::ptrdiff_t>(set.size()) * components;
    }
  }
}

}  // namespace brisance::observe
