#include "deck/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/parameter.hpp"
#include "core/units.hpp"

namespace brisance::deck {

Key const* Table::find(std::string_view key) const {
  for (auto const& k : keys) {
    if (k.name == key) return &k;
  }
  for (auto const& [word_, more] : variants) {
    for (auto const& k : more) {
      if (k.name == key) return &k;
    }
  }
  return nullptr;
}

namespace {

/// Letters to change, insert, delete or swap with the neighbour (optimal string alignment), case aside.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  auto const lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      bool const same = lower(a[i - 1]) == lower(b[j - 1]);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0U : 1U)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1])) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest(std::string_view word_, std::vector<std::string> const& names) {
  std::string best;
  std::size_t best_distance = 0;
  for (auto const& name : names) {
    std::size_t const longer = std::max(word_.size(), name.size());
    std::size_t const shorter = std::min(word_.size(), name.size());
    std::size_t const allowed = std::max<std::size_t>(1, longer / 3);
    if (longer - shorter > allowed) continue;
    std::size_t const distance = edit_distance(word_, name);
    if (distance <= allowed && distance < longer && (best.empty() || distance < best_distance)) {
      best = name;
      best_distance = distance;
    }
  }
  return best;
}

std::string quoted_list(std::vector<std::string> const& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out += i + 1 == names.size() ? " or " : ", ";
    out += fmt::format("\"{}\"", names[i]);
  }
  return out;
}

std::string suggestion(std::string_view word_, std::vector<std::string> const& names, std::string_view label) {
  std::string const near = nearest(word_, names);
  if (!near.empty()) return fmt::format("did you mean \"{}\"?", near);
  if (names.empty()) return fmt::format("no {} are defined", label);
  return fmt::format("{}: {}", label, fmt::join(names, ", "));
}

bool has_range(Key const& key) {
  return key.type == Type::number || key.type == Type::integer || key.type == Type::point || key.type == Type::field ||
         key.type == Type::pairs || key.type == Type::numbers || key.type == Type::integers;
}

std::string range_text(Key const& key) {
  bool const low = key.minimum > -unbounded;
  bool const high = key.maximum < unbounded;
  std::string const unit = key.unit == "1" ? "" : fmt::format(" {}", key.unit);
  if (low && high) return fmt::format("{:g} to {:g}{}", key.minimum, key.maximum, unit);
  if (low) return fmt::format("at least {:g}{}", key.minimum, unit);
  if (high) return fmt::format("at most {:g}{}", key.maximum, unit);
  return "any";
}

std::string default_text(Key const& key) {
  if (key.needed) return "**required**";
  if (!key.fallback_note.empty()) return key.fallback_note;
  if (auto const* v = std::get_if<double>(&key.fallback)) return fmt::format("{:g}", *v);
  if (auto const* v = std::get_if<long>(&key.fallback)) return fmt::format("{}", *v);
  if (auto const* v = std::get_if<bool>(&key.fallback)) return *v ? "`true`" : "`false`";
  if (auto const* v = std::get_if<std::string>(&key.fallback)) return v->empty() ? "empty" : fmt::format("`{}`", *v);
  return "none";
}

std::string expectation(Key const& key) {
  std::string quantity = key.unit == "1" ? "a number" : fmt::format("{} in {}", units::dimension(key.unit), key.unit);
  switch (key.type) {
    case Type::number: return quantity;
    case Type::integer: return "an integer";
    case Type::boolean: return "true or false";
    case Type::text: return "a string";
    case Type::name: return "a name of letters, digits and . _ - +";
    case Type::word: return quoted_list(key.choices);
    case Type::axis: return fmt::format("{} or a vector of three numbers", quoted_list(key.choices));
    case Type::words: return fmt::format("a list of words from {}", quoted_list(key.choices));
    case Type::names: return "a list of strings";
    case Type::numbers: return fmt::format("a list, each element {}", quantity);
    case Type::integers: return "a list of integers";
    case Type::point: return fmt::format("a list with one element per resolved direction, each {}", quantity);
    case Type::field:
      return fmt::format(
          "a list with one element per resolved direction, each {} or an expression of x, y and z in quotes", quantity);
    case Type::pairs: return fmt::format("a list of pairs such as [1, 2], each element {}", quantity);
    case Type::table: return key.choices.empty() ? "a table" : quoted_list(key.choices) + " or a table";
    case Type::tables: return key.single ? "a table or an array of tables" : "an array of tables";
    case Type::named: return "a table of named tables";
  }
  return {};
}

std::string facts(Key const& key) {
  std::string const range = has_range(key) ? fmt::format(", {}", range_text(key)) : "";
  std::string const rest = key.needed ? "required" : fmt::format("default: {}", default_text(key));
  return fmt::format("Expected: {}{}; {}.", expectation(key), range, rest);
}

}  // namespace brisance::deck
