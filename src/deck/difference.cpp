/// May a run of one deck go on with another?
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <set>

#include "deck/deck.hpp"

namespace brisance::deck {

namespace {

/// Keys that do not change what has been calculated so far. Of [output] all but `peak_fields`, which are sums over
/// time.
bool is_free(std::string const& path) {
  if (path == "title" || path == "end" || path == "checkpoint" || path == "audit") return true;
  return path.starts_with("output.") && path != "output.peak_fields";
}

bool equal(toml::node const& a, toml::node const& b) {
  if (a.type() != b.type()) return false;
  return a.visit([&](auto const& value) { return value == *b.as<std::remove_cvref_t<decltype(value)>>(); });
}

std::optional<std::string> difference_of(toml::table const& a, toml::table const& b, std::string const& parent) {
  std::set<std::string> keys;
  for (auto const* table : {&a, &b}) {
    for (auto const& [key, value] : *table) keys.emplace(key.str());
  }
  static toml::table const none;
  for (std::string const& key : keys) {
    std::string const path = parent.empty() ? key : fmt::format("{}.{}", parent, key);
    if (is_free(path)) continue;
    toml::node const* const in_a = a.get(key);
    toml::node const* const in_b = b.get(key);
    toml::table const* const table_a = in_a == nullptr ? &none : in_a->as_table();
    toml::table const* const table_b = in_b == nullptr ? &none : in_b->as_table();
    if (table_a != nullptr && table_b != nullptr) {
      // Also where one deck lacks the table: what it holds in the other may be free.
      if (auto inner = difference_of(*table_a, *table_b, path)) return inner;
    } else if (in_a == nullptr || in_b == nullptr || !equal(*in_a, *in_b)) {
      return path;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> difference(std::string_view deck, std::string_view other) {
  if (deck == other) return std::nullopt;
  try {
    return difference_of(toml::parse(deck), toml::parse(other), "");
  } catch (toml::parse_error const& error) {
    return fmt::format("the text ({})", error.description());
  }
}

}  // namespace brisance::deck
