#include "run/point_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/error.hpp"
#include "mpm/burn.hpp"

namespace brisance::run {

namespace {

using mpm::Field;

/// Fields that are written as they are kept.
std::optional<Field> kept(std::string const& name) {
  static std::map<std::string, Field> const fields{
      {"position", Field::position_x},
      {"velocity", Field::velocity_x},
      {"mass", Field::mass},
      {"density", Field::density},
      {"pressure", Field::pressure},
      {"viscosity", Field::viscosity},
      {"energy", Field::energy},
      {"identity", Field::identity},
      {"plastic_strain", Field::plastic_strain},
      {"plastic_work", Field::plastic_work},
      {"temperature", Field::temperature},
      {"damage", Field::damage},
      {"compression_damage", Field::crushing},
      {"tensile_damage", Field::cracking},
      {"products", Field::mass_fraction},
      {"bar_part", Field::bar_part},
      {"bar_stress", Field::bar_stress},
  };
  auto const found = fields.find(name);
  if (found == fields.end()) return std::nullopt;
  return found->second;
}

void add_kept(mpm::PointSet const& set, Field first, int components, double* out) {
  for (int c = 0; c < components; ++c) {
    double const* const values = set.field(first + c);
    if (values == nullptr) continue;
    for (int q = 0; q < set.size(); ++q) out[q * components + c] = values[q];
  }
}

void add_displacement(mpm::PointSet const& set, double* out) {
  for (int d = 0; d < 3; ++d) {
    double const* const origin = set.field(Field::origin_x + d);
    double const* const position = set.field(Field::position_x + d);
    if (origin == nullptr) return;
    for (int q = 0; q < set.size(); ++q) out[3 * q + d] = position[q] - origin[q];
  }
}

void add_stress(mpm::PointSet const& set, double* out) {
  add_kept(set, Field::deviator_xx, 6, out);
  double const* const pressure = set.field(Field::pressure);
  for (int q = 0; q < set.size(); ++q) {
    for (int d = 0; d < 3; ++d) out[6 * q + d] -= pressure[q];
  }
}

/// The burn fraction that the pressure of the last step was taken with, [Cui14] Eqs. (52)-(53).
void add_burn_fraction(mpm::PointSet const& set, World const& w, double detonation_speed, double* out) {
  double const* const lighting = set.field(Field::lighting_time);
  if (lighting == nullptr) return;
  double const rate = mpm::burn_rate(detonation_speed, w.setup.domain.h);
  double const time = w.clock.time;
  for (int q = 0; q < set.size(); ++q) out[q] = mpm::burn_fraction(time, lighting[q], rate);
}

int material_number(World const& w, int body) {
  auto const& bodies = w.bodies;
  auto const first = std::find_if(bodies.begin(), bodies.end(),
                                  [&](BodyReport const& b) { return b.material == bodies[body].material; });
  return static_cast<int>(first - bodies.begin());
}

FieldInfo const& info_of(std::string const& name) {
  for (auto const* list : {&known_point_fields(), &standing_point_fields()}) {
    auto const found = std::find_if(list->begin(), list->end(), [&](FieldInfo const& f) { return f.name == name; });
    if (found != list->end()) return *found;
  }
  throw InputError(fmt::format("there is no field \"{}\" of the material points", name));
}

}  // namespace

std::vector<FieldInfo> const& known_point_fields() {
  static std::vector<FieldInfo> const fields{
      {"velocity", "m/s", 3, "velocity"},
      {"displacement", "m", 3, "displacement since the start; 0 in bodies without strength, which do not know it"},
      {"pressure", "Pa", 1, "mean stress, compression positive, without the bulk viscosity"},
      {"mises", "Pa", 1, "equivalent stress (von Mises)"},
      {"stress", "Pa", 6, "Cauchy stress without the bulk viscosity, tension positive: xx yy zz xy yz zx"},
      {"density", "kg/m3", 1, "density"},
      {"energy", "J/kg", 1, "specific internal energy, the elastic energy of shear included"},
      {"plastic_strain", "1", 1, "equivalent plastic strain"},
      {"plastic_work", "J/kg", 1, "plastic work"},
      {"temperature", "K", 1, "temperature; 0 in bodies that do not heat"},
      {"damage", "1", 1, "damage, 1: failed"},
      {"compression_damage", "1", 1, "concrete: damage by compression and shear, 1: crushed"},
      {"tensile_damage", "1", 1, "concrete: damage by tension, 1: cracked through"},
      {"burn_fraction", "1", 1, "burn fraction F of programmed burn"},
      {"mass", "kg", 1, "mass of the point"},
      {"products", "1", 1, "mass fraction of the second fluid (detonation products) in gas points"},
      {"bar_part", "1", 1, "part of steel of smeared reinforcement"},
      {"bar_stress", "Pa", 1, "stress of the bar that runs through the point"},
      {"identity", "1", 1, "number of the point within its body"},
      {"viscosity", "Pa", 1, "bulk viscosity q of the last step"},
  };
  return fields;
}

std::vector<FieldInfo> const& standing_point_fields() {
  static std::vector<FieldInfo> const fields{
      {"position", "m", 3, "position"},
      {"body", "1", 1, "number of the body in the deck, from 0"},
      {"material", "1", 1, "number of the first body of the same material"},
  };
  return fields;
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

int dumped_bodies(World const& w) {
  int const count = static_cast<int>(w.points->bodies().size());
  return w.gas_body() >= 0 && !w.setup.output.gas_points ? count - 1 : count;
}

long dumped_points(World const& w) {
  long count = 0;
  for (int block = 0; block < w.points->grid().block_count(); ++block) {
    for (int body = 0; body < dumped_bodies(w); ++body) count += w.points->points(block, body).size();
  }
  return count;
}

void point_field(World const& w, std::string const& name, std::vector<double>& out) {
  int const components = info_of(name).components;
  mpm::Mpm const& points = *w.points;
  out.assign(static_cast<std::size_t>(dumped_points(w)) * components, 0.0);
  auto const field = kept(name);
  double* at = out.data();
  int const bodies = dumped_bodies(w);
  for (int block = 0; block < points.grid().block_count(); ++block) {
    for (int body = 0; body < bodies; ++body) {
      mpm::PointSet const& set = points.points(block, body);
      if (field) {
        add_kept(set, *field, components, at);
      } else if (name == "displacement") {
        add_displacement(set, at);
      } else if (name == "stress") {
        add_stress(set, at);
      } else if (name == "mises") {
        for (int q = 0; q < set.size(); ++q) at[q] = mises_of(set, q);
      } else if (name == "burn_fraction") {
        add_burn_fraction(set, w, points.bodies()[body].solid.detonation_speed, at);
      } else {
        std::fill_n(at, set.size(), name == "body" ? body : material_number(w, body));
      }
      at += static_cast<std::ptrdiff_t>(set.size()) * components;
    }
  }
}

}  // namespace brisance::run
