/// From TOML text to values: types, units, ranges and unknown keys are checked here against the schema. What the values
/// mean together is checked by the builders of tables/.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "deck/deck.hpp"
#include "deck/schema.hpp"

namespace brisance::deck {

/// Place in a deck.
struct Place {
  int line = 1;
  int column = 1;
};

class Section;

/// One key as given in the deck.
struct Entry {
  Place place;
  std::string shown;  ///< the value as text for messages
  std::string unit;   ///< SI unit that a string with a unit was converted to; "" for a bare number
  bool valid = false;
  std::variant<std::monostate, double, long, bool, std::string, std::vector<double>, std::vector<std::string>,
               std::vector<Section>>
      value;
  std::vector<std::string> elements_shown;
};

/// One table as given in the deck. Accessors return the value, else the schema's default, else nothing: either because
/// the key is absent without a default or because its value was wrong, which has been reported; `broken` tells the two
/// apart.
class Section {
 public:
  Table const* table = nullptr;
  std::string path;  ///< "charge[1]"
  std::string name;  ///< of `named` tables
  Place place;
  std::map<std::string, Entry, std::less<>> entries;
  std::vector<std::string> meant;  ///< for each unknown key the key that was probably meant, or ""

  /// Has it unknown keys? What is missing then may be what was misspelt.
  [[nodiscard]] bool doubtful() const { return !meant.empty(); }
  [[nodiscard]] bool given(std::string_view key) const { return entries.contains(key); }
  [[nodiscard]] bool broken(std::string_view key) const;
  [[nodiscard]] Place place_of(std::string_view key) const;
  [[nodiscard]] std::string shown(std::string_view key) const;
  [[nodiscard]] std::string path_of(std::string_view key) const;

  [[nodiscard]] std::optional<double> number(std::string_view key) const;
  [[nodiscard]] std::optional<long> integer(std::string_view key) const;
  [[nodiscard]] std::optional<bool> boolean(std::string_view key) const;
  [[nodiscard]] std::optional<std::string> text(std::string_view key) const;
  [[nodiscard]] std::vector<double> const* numbers(std::string_view key) const;
  [[nodiscard]] std::vector<std::string> const* strings(std::string_view key) const;
  [[nodiscard]] std::vector<Section> const* sections(std::string_view key) const;
  /// The single table under the key, when given and valid.
  [[nodiscard]] Section const* section(std::string_view key) const;

 private:
  template <class T>
  [[nodiscard]] std::optional<T> value_or_default(std::string_view key) const;
  template <class T>
  [[nodiscard]] T const* value(std::string_view key) const;
};

/// Gathers errors and warnings of one text.
class Report {
 public:
  explicit Report(std::string file) : file_(std::move(file)) {}
  void error(Place place, std::string key, std::string message);
  void warning(Place place, std::string const& key, std::string const& message);
  [[nodiscard]] std::string const& file() const { return file_; }
  [[nodiscard]] bool failed() const { return !errors_.empty(); }
  /// The errors in the order of the text.
  [[nodiscard]] std::vector<Diagnostic> errors() const;
  [[nodiscard]] std::vector<std::string> const& warnings() const { return warnings_; }

 private:
  std::string file_;
  std::vector<Diagnostic> errors_;
  std::vector<std::string> warnings_;
};

inline constexpr std::size_t largest_deck = 1U << 20U;  ///< bytes

/// Message about a deck with too many of them.
[[nodiscard]] std::string size_problem(std::string const& bytes);

/// Parses the text and reads it with the schema. Nothing only when the text is no TOML; else what could be read.
[[nodiscard]] std::optional<Section> read(std::string_view text, Table const& schema, Report& report);

}  // namespace brisance::deck
