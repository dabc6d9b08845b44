/// What the schema*.cpp files share: makers of keys, and the tables that each of them holds.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/models.hpp"
#include "core/parameter.hpp"
#include "deck/schema.hpp"

namespace brisance::deck {

inline constexpr double far = 1e6;        ///< largest coordinate [m]
inline constexpr double longest = 1e4;    ///< longest time [s]
inline constexpr double smallest = 1e-6;  ///< smallest length [m]

inline Key number(std::string name, std::string unit, double minimum, double maximum) {
  Key key;
  key.name = std::move(name);
  key.unit = std::move(unit);
  key.minimum = minimum;
  key.maximum = maximum;
  return key;
}
inline Key typed(Type type, std::string name) {
  Key key;
  key.name = std::move(name);
  key.type = type;
  key.minimum = -unbounded;
  key.maximum = unbounded;
  return key;
}
inline Key typed(Type type, std::string name, std::string unit, double minimum, double maximum) {
  Key key = number(std::move(name), std::move(unit), minimum, maximum);
  key.type = type;
  return key;
}
inline Key word(std::string name, std::vector<std::string> choices) {
  Key key = typed(Type::word, std::move(name));
  key.choices = std::move(choices);
  return key;
}
/// One of the words of an enumeration.
template <class E>
Key word(std::string name) {
  return word(std::move(name), all_words<E>());
}
inline Key nested(Type type, std::string name, Table const& table) {
  Key key = typed(type, std::move(name));
  key.table = &table;
  return key;
}
inline Key position(std::string name) { return typed(Type::point, std::move(name), "m", -far, far); }
inline Key density() { return number("density", "kg/m3", 1e-4, 1e5).like("1.225"); }
inline Key pressure() { return number("pressure", "Pa", 1e-3, 1e13).like("\"101.325 kPa\""); }
inline Key velocity() { return typed(Type::point, "velocity", "m/s", -1e5, 1e5).like("[340, 0, 0]"); }

inline Key axis(std::string name) {
  Key key = typed(Type::axis, std::move(name));
  key.choices = {"x", "y", "z"};
  return key;
}
inline Key face_normal(std::string name) { return word(std::move(name), {"+x", "-x", "+y", "-y", "+z", "-z"}); }

[[nodiscard]] std::vector<Key> joined(std::vector<Key> first, std::vector<Key> const& second);

// --- schema_shapes.cpp

[[nodiscard]] std::vector<Key> shape_keys(std::vector<std::string> shapes);
/// Those of a body or of a region of material points, with what is added to them, cut out of them and kept of them.
[[nodiscard]] std::vector<Key> composed_shape_keys();

// --- schema_gas.cpp

/// Names of the domain's faces: x_low, x_high, ...
[[nodiscard]] std::vector<std::string> const& faces();
[[nodiscard]] Table const& domain_table();
[[nodiscard]] Table const& boundaries_table();
[[nodiscard]] Table const& inflow_table();
[[nodiscard]] Table const& ambient_table();
[[nodiscard]] Table const& initiation_table();
[[nodiscard]] Table const& charge_table();
[[nodiscard]] Table const& remap_table();
[[nodiscard]] Table const& gauge_table();
[[nodiscard]] Table const& obstacle_table();
[[nodiscard]] Table const& region_table();
[[nodiscard]] Table const& numerics_table();

// --- schema_points.cpp

[[nodiscard]] Table const& body_table();
[[nodiscard]] Table const& points_table();
[[nodiscard]] Table const& mpm_region_table();
[[nodiscard]] Table const& constraint_table();
[[nodiscard]] Table const& contact_table();
[[nodiscard]] Table const& surface_pressure_table();
[[nodiscard]] Table const& reinforcement_table();

// --- schema_materials.cpp

/// Keys of explosives, fluids and solids, in decks and material files.
[[nodiscard]] std::vector<Key> explosive_keys();
[[nodiscard]] std::vector<Key> fluid_keys();
[[nodiscard]] std::vector<Key> solid_keys();
[[nodiscard]] std::map<std::string, std::vector<Key>> explosive_variants();
[[nodiscard]] std::map<std::string, std::vector<Key>> fluid_variants();
/// Those of a material file beside them.
[[nodiscard]] std::vector<Key> file_keys(char const* kind);
[[nodiscard]] Table const& explosives_table();
[[nodiscard]] Table const& afterburn_table();
[[nodiscard]] Table const& fluids_table();
[[nodiscard]] Table const& solids_table();

}  // namespace brisance::deck
