#include "deck/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/error.hpp"
#include "core/expression.hpp"
#include "core/units.hpp"

namespace brisance::deck {

namespace {

constexpr double coldest = 150.0;                ///< temperature [K] below which degrees Celsius are suspected
constexpr double right_angle_in_radians = 1.58;  ///< largest number alone that may be an angle in radians

/// For a temperature that looks like degrees Celsius.
std::string in_kelvin(toml::node const& node) {
  return node.is_number() ? fmt::format("; a number without a unit is in kelvin; did you mean \"{} degC\"?", show(node))
                          : "";
}

}  // namespace

Place place_in(toml::source_region const& source, Place fallback) {
  if (source.begin.line == 0) return fallback;
  return {static_cast<int>(source.begin.line), static_cast<int>(source.begin.column)};
}

std::string shortened(std::string_view text, std::size_t limit) {
  std::string out(text.substr(0, limit));
  if (text.size() > limit) {
    while (!out.empty() && (static_cast<unsigned char>(out.back()) & 0xC0U) == 0x80U) out.pop_back();
    if (!out.empty() && static_cast<unsigned char>(out.back()) >= 0xC0U) out.pop_back();
    out += "...";
  }
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20U || c == 0x7f) c = '?';
  }
  return out;
}

std::string show(toml::node const& node) {
  if (auto const* s = node.as_string()) return fmt::format("\"{}\"", shortened(s->get()));
  if (auto const* i = node.as_integer()) return fmt::format("{}", i->get());
  if (auto const* f = node.as_floating_point()) return fmt::format("{}", f->get());
  if (auto const* b = node.as_boolean()) return b->get() ? "true" : "false";
  if (auto const* a = node.as_array()) {
    std::string out = "[";
    for (std::size_t i = 0; i < a->size(); ++i) {
      if (i > 0) out += ", ";
      if (out.size() > 60) return out + "...]";
      out += (*a)[i].is_array() ? "[...]" : show((*a)[i]);
    }
    return out + "]";
  }
  if (node.is_table()) return "{...}";
  std::ostringstream date;
  node.visit([&](auto const& n) {
    if constexpr (toml::is_chronological<decltype(n)>) date << n.get();
  });
  return date.str();
}

std::string kind_of(toml::node const& node) {
  if (node.is_string()) return "is a string";
  if (node.is_integer()) return "is an integer";
  if (node.is_floating_point()) return "is a number";
  if (node.is_boolean()) return "is a boolean";
  if (node.is_array()) return "is a list";
  if (node.is_table()) return "is a table";
  return "is a date or time";
}

std::string example(Key const& key) { return fmt::format("{} = {}", key.name, key.sample); }

void Values::wrong_type(Key const& key, toml::node const& node, std::string const& path, Place place) {
  std::string const range = has_range(key) ? fmt::format(", {}", range_text(key)) : "";
  report_.error(place, path,
                fmt::format("{} {}, expected {}{}; write, for example, {}", show(node), kind_of(node), expectation(key),
                            range, example(key)));
}

std::optional<double> Values::with_unit(Key const& key, std::string const& text, std::string const& path, Place place,
                                        std::string* unit) {
  units::Quantity const read = units::parse(text, key.unit);
  std::optional<double> value = read.value;
  std::string given = key.unit;
  for (std::size_t n = 0; !read.value && n < key.also_unit.size(); ++n) {
    units::Quantity const again = units::parse(text, key.also_unit[n]);
    if (!again.value) continue;
    value = again.value;
    given = key.also_unit[n];
  }
  if (value && unit != nullptr) *unit = given;
  if (!value) {
    report_.error(place, path,
                  fmt::format("{}; allowed: {}; write, for example, {}", read.problem, range_text(key), example(key)));
  }
  return value;
}

bool Values::in_range(Key const& key, toml::node const& node, double value, std::string const& path, Place place) {
  if (!std::isfinite(value)) {
    report_.error(place, path,
                  fmt::format("{} is not a finite number; allowed: {}; write, for example, {}", show(node),
                              range_text(key), example(key)));
    return false;
  }
  if (value < key.minimum || value > key.maximum) {
    report_.error(place, path,
                  fmt::format("{} is out of range; allowed: {}{}; write, for example, {}", show(node), range_text(key),
                              key.unit == "K" && value < key.minimum ? in_kelvin(node) : "", example(key)));
    return false;
  }
  if (key.unit == "K" && value < coldest) {
    report_.warning(place, path,
                    fmt::format("{} is {:.6g} K or {:.6g} degrees Celsius, colder than any natural air{}", show(node),
                                value, value - 273.15, in_kelvin(node)));
  }
  if (key.unit == "deg" && node.is_number() && value > 0.0 && value < right_angle_in_radians) {
    report_.warning(place, path,
                    fmt::format("{} is {:g} degrees: a number without a unit is in degrees; did you mean \"{} rad\"?",
                                show(node), value, show(node)));
  }
  return true;
}

std::optional<double> Values::quantity(Key const& key, toml::node const& node, std::string const& path, Place place,
                                       std::string* unit) {
  double value = 0.0;
  if (auto const* s = node.as_string()) {
    auto const converted = with_unit(key, s->get(), path, place, unit);
    if (!converted) return std::nullopt;
    value = *converted;
  } else if (auto const* f = node.as_floating_point()) {
    value = f->get();
  } else if (auto const* i = node.as_integer()) {
    value = static_cast<double>(i->get());
  } else {
    wrong_type(key, node, path, place);
    return std::nullopt;
  }
  if (!in_range(key, node, value, path, place)) return std::nullopt;
  return value;
}

namespace {

bool is_expression(Key const& key, toml::node const& node) {
  auto const* text = node.as_string();
  return text != nullptr && !units::parse(text->get(), key.unit).value;
}

}  // namespace

bool Values::has_expressions(Key const& key, toml::node const& node) {
  auto const* array = node.as_array();
  if (array == nullptr) return is_expression(key, node);
  return array->size() <= 3 &&
         std::any_of(array->begin(), array->end(), [&](toml::node const& e) { return is_expression(key, e); });
}

std::optional<std::vector<std::string>> Values::expressions(Key const& key, toml::node const& node,
                                                            std::string const& path, Place place) {
  std::vector<std::string> out;
  bool sound = true;
  auto const add = [&](toml::node const& element) {
    auto const text = expression(key, element, path, place_in(element.source(), place));
    sound = sound && text;
    if (text) out.push_back(*text);
  };
  if (auto const* array = node.as_array()) {
    for (auto const& element : *array) add(element);
  } else {
    add(node);
  }
  return sound ? std::optional(out) : std::nullopt;
}

std::optional<std::string> Values::expression(Key const& key, toml::node const& node, std::string const& path,
                                              Place place) {
  if (!is_expression(key, node)) {
    auto const value = quantity(key, node, path, place);
    return value ? std::optional(fmt::format("{}", *value)) : std::nullopt;
  }
  std::string const& text = node.as_string()->get();
  try {
    Expression const read(text);
    return text;
  } catch (InputError const& problem) {
    report_.error(
        place, path,
        fmt::format("{} is neither {} in {} nor an expression of x, y and z: {}; write, for example, {}", show(node),
                    units::dimension(key.unit), key.unit, shortened(problem.what(), 200), example(key)));
    return std::nullopt;
  }
}

std::optional<std::vector<double>> Values::pairs(Key const& key, toml::array const& array, std::string const& path,
                                                 Place place) {
  std::vector<double> values;
  bool sound = true;
  for (auto const& element : array) {
    Place const at = place_in(element.source(), place);
    auto const* pair = element.as_array();
    if (pair == nullptr || pair->size() != 2) {
      report_.error(at, path,
                    fmt::format("{} is no pair, expected {}; write, for example, {}", show(element), expectation(key),
                                example(key)));
      sound = false;
      continue;
    }
    for (auto const& one : *pair) {
      auto const v = quantity(key, one, path, place_in(one.source(), at));
      sound = sound && v.has_value();
      values.push_back(v.value_or(0.0));
    }
  }
  return sound ? std::optional(values) : std::nullopt;
}

std::optional<long> Values::whole(Key const& key, toml::node const& node, std::string const& path, Place place) {
  auto const* i = node.as_integer();
  if (i == nullptr) {
    wrong_type(key, node, path, place);
    return std::nullopt;
  }
  auto const value = static_cast<double>(i->get());
  if (value < key.minimum || value > key.maximum) {
    report_.error(place, path,
                  fmt::format("{} is out of range; allowed: {}; write, for example, {}", show(node), range_text(key),
                              example(key)));
    return std::nullopt;
  }
  return static_cast<long>(i->get());
}

std::optional<std::string> Values::one_of(Key const& key, toml::node const& node, std::string const& path,
                                          Place place) {
  auto const* s = node.as_string();
  if (s == nullptr) {
    wrong_type(key, node, path, place);
    return std::nullopt;
  }
  if (std::find(key.choices.begin(), key.choices.end(), s->get()) != key.choices.end()) return s->get();
  std::string const near = nearest(s->get(), key.choices);
  report_.error(place, path,
                fmt::format("{} is unknown; {}allowed: {}", show(node),
                            near.empty() ? "" : fmt::format("did you mean \"{}\"? ", near), quoted_list(key.choices)));
  return std::nullopt;
}

}  // namespace brisance::deck
