/// Reading of decks: one TOML file describes a case. Only this folder knows TOML.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "case/case.hpp"

namespace brisance::deck {

/// One error in a deck, with its place.
struct Diagnostic {
  std::string file;
  int line = 1;
  int column = 1;
  std::string key;      ///< e.g. "charge[1].mass"; empty for errors of the TOML syntax
  std::string message;  ///< the value, what is allowed and what to do
};

/// "file:line:column: error: key: message"
[[nodiscard]] std::string format(Diagnostic const& diagnostic);

/// One number of a material, as it is calculated with.
struct MaterialNumber {
  std::string key;      ///< in the material's table: "density", "strength.friction"
  double value = 0.0;   ///< [unit]
  std::string unit;     ///< SI, or deg
  std::string meaning;  ///< in words
  std::string word;     ///< a model in the place of a number, e.g. "drucker_prager"
  std::string said;     ///< what the deck says, or where else the value is from
};

/// A material of a deck as it was understood.
struct MaterialNumbers {
  std::string name;
  bool from_library = true;
  bool used = true;  ///< is it in the simulation, or only defined?
  std::string note;  ///< of the library: what it is for and how far off it is
  std::vector<MaterialNumber> numbers;
};

/// Outcome of reading a deck: a case, or all its errors in the order of the text.
struct Result {
  std::optional<run::Case> case_;
  std::vector<Diagnostic> errors;
  std::vector<std::string> warnings;       ///< of a deck without errors; complete lines in the format of errors
  std::vector<MaterialNumbers> materials;  ///< of a deck without errors: those in use, then the deck's others
};

/// Reads a deck from a file. A file that cannot be read throws IoError; everything else ends in `Result::errors`.
[[nodiscard]] Result read_file(std::string const& path);

/// The text of a deck's file, up to a byte more than a deck may have. Throws IoError where it cannot be read.
[[nodiscard]] std::string text_of(std::string const& path);

/// Reads a deck from memory; `name` stands for the file in messages. Does not throw on any text.
[[nodiscard]] Result read_text(std::string_view text, std::string_view name);

/// The first key in which two decks differ so that one cannot go on with a run of the other, e.g. "domain.cell". The
/// title, [end], [output] (but for peak_fields), [checkpoint] and [audit] are free; order, comments and layout never
/// count.
[[nodiscard]] std::optional<std::string> difference(std::string_view deck, std::string_view other);

/// Reference manual of the deck in Markdown, made from the schema (docs/deck.md).
[[nodiscard]] std::string reference_manual();

/// JSON Schema of decks for editors, made from the schema (draft 2020-12).
[[nodiscard]] std::string json_schema();

}  // namespace brisance::deck
