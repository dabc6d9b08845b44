/// The schema of decks and material files: every table and key with type, unit, range, default and meaning. It drives
/// reading, range checks, error messages and the reference manual.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace brisance::deck {

enum class Type {
  number,   ///< quantity: number in SI units or string with a unit
  integer,  ///< whole number
  boolean,
  text,      ///< free string
  name,      ///< string of letters, digits and . _ - + that may become part of a file name
  word,      ///< one of a closed list
  axis,      ///< one of a closed list of letters, or a vector
  words,     ///< list of words
  names,     ///< list of strings
  numbers,   ///< list of quantities
  integers,  ///< list of whole numbers
  point,     ///< one quantity per resolved direction
  field,     ///< like a point; each element may be an expression of x, y, z; read as texts where one is
  pairs,     ///< list of lists of two quantities; read as all of them in a row
  table,     ///< one table, or one of a closed list of words
  tables,    ///< array of tables; with `or_one` a single one stands for a list of it alone
  named,     ///< tables under names of the user's choice (or of a closed list)
};

struct Table;

struct Key {
  using Default = std::variant<std::monostate, double, long, bool, std::string>;

  std::string name;
  Type type = Type::number;
  std::string unit = "1";  ///< SI
  double minimum = 0.0;
  double maximum = 0.0;
  Default fallback;           ///< value of an absent key
  std::string fallback_note;  ///< for people, where the default is computed or the absence has a meaning
  bool needed = false;
  std::string explanation;
  std::string meanings;                ///< of its words, where they have one of their own: goes behind the explanation
  std::string sample;                  ///< right-hand side of an example, as TOML
  std::vector<std::string> choices;    ///< for words, words instead of a table, and the names of `named`
  std::vector<std::string> also_unit;  ///< further units accepted, e.g. kg/m for a mass in planar geometry
  Table const* table = nullptr;
  bool single = false;  ///< of `tables`: may be a single table too

  Key& or_one() {
    single = true;
    return *this;
  }
  Key& of(double value) {
    fallback = value;
    return *this;
  }
  Key& of(long value) {
    fallback = value;
    return *this;
  }
  Key& of(bool value) {
    fallback = value;
    return *this;
  }
  Key& of(char const* value) {
    fallback = std::string(value);
    return *this;
  }
  Key& note(std::string text) {
    fallback_note = std::move(text);
    return *this;
  }
  Key& required() {
    needed = true;
    return *this;
  }
  Key& means(std::string text) {
    explanation = std::move(text) + meanings;
    return *this;
  }
  void add_meaning(std::string const& word_, std::string const& text) {
    if (!text.empty()) meanings += "; `" + word_ + "`: " + text;
  }
  Key& like(std::string text) {
    sample = std::move(text);
    return *this;
  }
  Key& or_unit(std::string text) {
    also_unit.push_back(std::move(text));
    return *this;
  }
};

struct Table {
  std::string meaning;
  std::vector<Key> keys;
  /// Keys that depend on the word given for `selector`: word -> further keys.
  std::string selector;
  std::map<std::string, std::vector<Key>> variants;

  [[nodiscard]] Key const* find(std::string_view key) const;
};

/// The whole deck.
[[nodiscard]] Table const& deck_schema();

/// Material files.
[[nodiscard]] Table const& explosive_file_schema();
[[nodiscard]] Table const& fluid_file_schema();
[[nodiscard]] Table const& solid_file_schema();

/// The name nearest to `word`, or "" when none is near: at most a third of the letters differ, case aside.
[[nodiscard]] std::string nearest(std::string_view word, std::vector<std::string> const& names);

/// "did you mean "x"?" or, where nothing is near, "allowed: a, b, c".
[[nodiscard]] std::string suggestion(std::string_view word, std::vector<std::string> const& names,
                                     std::string_view label);

/// `"a", "b" or "c"`
[[nodiscard]] std::string quoted_list(std::vector<std::string> const& names);

/// Has its value a range?
[[nodiscard]] bool has_range(Key const& key);

/// The allowed range with its unit: "1e-06 to 10000 m", "at least 0", "any".
[[nodiscard]] std::string range_text(Key const& key);

/// The default of a key as Markdown: the value, what holds without it, or that it is required.
[[nodiscard]] std::string default_text(Key const& key);

/// What a key expects, its range and its default, in one sentence.
[[nodiscard]] std::string facts(Key const& key);

/// What a key expects, in words: "a length in m".
[[nodiscard]] std::string expectation(Key const& key);

}  // namespace brisance::deck
