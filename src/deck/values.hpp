/// Single values of TOML texts: their types, units and ranges against the schema.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "deck/reader.hpp"

namespace brisance::deck {

[[nodiscard]] Place place_in(toml::source_region const& source, Place fallback);

/// At most `limit` bytes, control characters replaced, never cut inside a UTF-8 character.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t limit = 60);

/// A value as text for messages.
[[nodiscard]] std::string show(toml::node const& node);

/// "is a string"
[[nodiscard]] std::string kind_of(toml::node const& node);

/// The example of a key: "cell = 0.05".
[[nodiscard]] std::string example(Key const& key);

/// The tables of a text, or nothing where it is no TOML, which has been reported.
[[nodiscard]] std::optional<toml::table> parse(std::string_view text, Report& report);

/// Reads values and reports what is wrong with them.
class Values {
 public:
  explicit Values(Report& report) : report_(report) {}

  void wrong_type(Key const& key, toml::node const& node, std::string const& path, Place place);
  /// One quantity: an element of a list or a value of its own.
  std::optional<double> quantity(Key const& key, toml::node const& node, std::string const& path, Place place,
                                 std::string* unit = nullptr);
  /// Pairs of quantities, one behind the other.
  std::optional<std::vector<double>> pairs(Key const& key, toml::array const& array, std::string const& path,
                                           Place place);
  /// Is it, or has it an element that is, a text but no quantity with a unit?
  [[nodiscard]] static bool has_expressions(Key const& key, toml::node const& node);
  /// Up to three expressions of x, y, z, or quantities as texts.
  std::optional<std::vector<std::string>> expressions(Key const& key, toml::node const& node, std::string const& path,
                                                      Place place);
  std::optional<long> whole(Key const& key, toml::node const& node, std::string const& path, Place place);
  /// One of the key's choices.
  std::optional<std::string> one_of(Key const& key, toml::node const& node, std::string const& path, Place place);

 private:
  std::optional<std::string> expression(Key const& key, toml::node const& node, std::string const& path, Place place);
  /// A string with a number and a unit: the key's or one of the further ones.
  std::optional<double> with_unit(Key const& key, std::string const& text, std::string const& path, Place place,
                                  std::string* unit);
  bool in_range(Key const& key, toml::node const& node, double value, std::string const& path, Place place);

  Report& report_;
};

}  // namespace brisance::deck
