/// Parameter tables: what a model can be given is declared once, next to the model, and drives deck reading,
/// range checks, error messages, `brisance info` and the reference manual.
#pragma once

#include <limits>
#include <string_view>

namespace brisance {

/// One numeric parameter of a model.
template <class Model>
struct Parameter {
  std::string_view key;      ///< name in decks and material files
  std::string_view unit;     ///< SI unit in UDUNITS spelling, "1" for a pure number
  double Model::*member;     ///< where the value lives
  double minimum;            ///< smallest allowed value
  double maximum;            ///< largest allowed value
  std::string_view meaning;  ///< one line for people, with the symbol used in the literature
  /// Value taken when the key is absent; NaN means that the key must be given.
  double default_value = std::numeric_limits<double>::quiet_NaN();
};

inline constexpr double unbounded = std::numeric_limits<double>::max();

}  // namespace brisance
