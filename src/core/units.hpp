/// Quantities with units: "12.5 kg", "20 us", "25 MPa". UDUNITS-2 knows the units; this is the only place that names
/// it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace brisance::units {

/// Outcome of reading a quantity. Exactly one of `value` and `problem` is set.
struct Quantity {
  std::optional<double> value;  ///< in the wanted SI unit
  std::string problem;          ///< one sentence for the user, e.g. `"12 kg" is a mass, expected a length (m)`
};

/// Reads "NUMBER UNIT" (the unit may be absent: then the number is already in `si_unit`) and converts to `si_unit` ("1"
/// for a pure number). Never throws. Temperatures with offset ("15 degC") convert as temperatures.
[[nodiscard]] Quantity parse(std::string_view text, std::string_view si_unit);

/// The dimension of an SI unit in words: "a length" for "m", "a pure number" for "1".
[[nodiscard]] std::string dimension(std::string_view si_unit);

}  // namespace brisance::units
