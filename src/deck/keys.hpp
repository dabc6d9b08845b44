/// Makers of keys, for the tables of tables/.
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
  Key key = word(std::move(name), all_words<E>());
  for (auto const& w : words(E{})) key.add_meaning(w.name, w.meaning);
  return key;
}
inline Key nested(Type type, std::string name, Table const& table) {
  Key key = typed(type, std::move(name));
  key.table = &table;
  return key;
}
/// A table, or a word in its place.
inline Key nested_or(Type type, std::string name, Table const& table, std::vector<std::string> choices) {
  Key key = nested(type, std::move(name), table);
  key.choices = std::move(choices);
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

/// The key of a deck's own materials beside those of their kind.
[[nodiscard]] std::vector<Key> own_keys();
/// Those of a material file.
[[nodiscard]] std::vector<Key> file_keys(char const* kind);

}  // namespace brisance::deck
