#include "core/units.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <mutex>
#include <optional>
#include <system_error>

#include "core/unit_table.hpp"
#include "core/unit_text.hpp"

namespace brisance::units {

namespace {

std::string_view trim(std::string_view text) {
  std::string_view const blank = " \t\r\n";
  auto const first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

/// Same dimension? Stricter than `ut_are_convertible`, which also takes a quantity and its reciprocal for convertible,
/// and an angle for a pure number.
bool same_dimension(Reading const& a, Reading const& b) {
  UnitPointer const ratio(ut_divide(a.unit.get(), b.unit.get()));
  return a.angle == b.angle && ratio && ut_is_dimensionless(ratio.get()) != 0 &&
         ut_are_convertible(a.unit.get(), b.unit.get()) != 0;
}

/// "a length (m)": the unit as it is asked for.
std::string expected(std::string_view si_unit) {
  return si_unit == "1" ? "a pure number" : fmt::format("{} ({})", dimension(si_unit), si_unit);
}

std::string dimension_name(Reading const& unit) {
  for (auto const& known : dimensions) {
    Reading const other = read_unit(known.unit);
    if (other.unit && same_dimension(unit, other)) return known.name;
  }
  return {};
}

/// A slip that explains why the dimension `has` is not the one that is `wanted`, with its remedy, or nothing.
std::string slip(Reading const& has, Reading const& wanted) {
  struct Slip {
    std::string_view has;
    std::string_view wanted;
    std::string_view remedy;
  };
  constexpr std::array slips{
      Slip{"kg/m2", "Pa", "lb and kg are masses: did you mean lbf/in2 (psi), lbf/ft2 or kgf/cm2?"},
      Slip{"kg", "N", "lb and kg are masses: did you mean lbf or kgf?"},
      Slip{"N/m3", "kg/m3", "lbf and kgf are forces: did you mean lb or kg?"},
      Slip{"kg", "m/s2", "g means gram: did you mean standard_gravity?"},
      Slip{"kg m3", "kg/m3", "\"/\" already inverts the next power: did you mean kg/m3?"},
      Slip{"J K/kg", "J/(kg K)", "\"/\" applies to the next unit only: did you mean J/(kg K)?"},
      Slip{"kg m", "J", "lb and kg are masses: did you mean ft lbf or kgf m?"},
  };
  for (Slip const& s : slips) {
    if (same_dimension(has, read_unit(s.has)) && same_dimension(wanted, read_unit(s.wanted)))
      return fmt::format("; {}", s.remedy);
  }
  return {};
}

/// The text with ASCII spellings of what people type or paste in UTF-8.
std::string ascii_text(std::string_view text) {
  struct Spelling {
    std::string_view from;
    std::string_view to;
  };
  constexpr std::array spellings{
      Spelling{"\u00b5", "u"}, Spelling{"\u03bc", "u"}, Spelling{"\u00b7", "*"}, Spelling{"\u22c5", "*"},
      Spelling{"\u00d7", "*"}, Spelling{"\u2212", "-"}, Spelling{"\u00a0", " "}, Spelling{"\u2009", " "},
      Spelling{"\u202f", " "}, Spelling{"\u2103", "degC"}, Spelling{"\u2109", "degF"}, Spelling{"\u00b0", "deg"},
      Spelling{"\u00ba", "deg"}, Spelling{"\u2032", "'"}, Spelling{"\u2033", "\""},
      // Raised digits are powers, and only that: "10\u00b2 kg" is no 102 kg.
      Spelling{"\u207b", "^-"}, Spelling{"\u2070", "^0"}, Spelling{"\u00b9", "^1"}, Spelling{"\u00b2", "^2"},
      Spelling{"\u00b3", "^3"}, Spelling{"\u2074", "^4"}, Spelling{"\u2075", "^5"}, Spelling{"\u2076", "^6"},
      Spelling{"\u2077", "^7"}, Spelling{"\u2078", "^8"}, Spelling{"\u2079", "^9"}};
  std::string out;
  while (!text.empty()) {
    std::string_view to = text.substr(0, 1);
    std::size_t length = 1;
    for (auto const& s : spellings) {
      if (!text.starts_with(s.from)) continue;
      to = s.to;
      length = s.from.size();
    }
    // "^-" and then "^1": one power.
    if (to.starts_with('^') && out.ends_with("^-")) to.remove_prefix(1);
    out += to;
    text.remove_prefix(length);
  }
  return out;
}

}  // namespace

std::string dimension(std::string_view si_unit) {
  for (auto const& known : dimensions) {
    if (si_unit == known.unit) return known.name;
  }
  return "a quantity";
}

Quantity parse(std::string_view text, std::string_view si_unit) {
  auto const failed = [](std::string problem) { return Quantity{std::nullopt, std::move(problem)}; };
  std::string const ascii = ascii_text(text);
  std::string_view const body = trim(ascii);
  std::string_view number = body;
  if (!number.empty() && number.front() == '+') number.remove_prefix(1);

  double value = 0.0;
  auto const [end, code] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (code == std::errc::invalid_argument || (number.size() < body.size() && number.starts_with('-'))) {
    return failed(fmt::format("{} is not a number, expected {}", shown(text), expected(si_unit)));
  }
  if (code == std::errc::result_out_of_range || !std::isfinite(value)) {
    return failed(fmt::format("{} is not a finite number, expected {}", shown(text), expected(si_unit)));
  }
  std::string const unit(trim(number.substr(static_cast<std::size_t>(end - number.data()))));
  if (unit.empty()) return {value, {}};
  if (unit.front() == ',') {
    return failed(fmt::format("{} contains a comma: write the number with a decimal point, expected {}", shown(text),
                              expected(si_unit)));
  }

  std::lock_guard const guard(lock());
  if (unit_system() == nullptr) return failed("cannot read the unit table of UDUNITS; give the number in SI units");
  Reading const from = read_unit(unit);
  if (!from.unit) {
    return failed(fmt::format("{} {}{} expected {}", shown(text), from.problem, from.problem.ends_with('?') ? "" : ",",
                              expected(si_unit)));
  }
  Reading const to = read_unit(si_unit);
  if (!to.unit) return failed(fmt::format("unknown unit {}", shown(si_unit)));
  if (!same_dimension(from, to)) {
    std::string const name = dimension_name(from);
    return failed(fmt::format("{} {}, expected {}{}", shown(text),
                              name.empty() ? "has the wrong dimension" : "is " + name, expected(si_unit),
                              slip(from, to)));
  }
  ConverterPointer const converter(ut_get_converter(from.unit.get(), to.unit.get()));
  if (!converter) return failed(fmt::format("{} cannot be converted, expected {}", shown(text), expected(si_unit)));
  double const converted = cv_convert_double(converter.get(), value);
  if (!std::isfinite(converted)) {
    return failed(fmt::format("{} is not a finite number, expected {}", shown(text), expected(si_unit)));
  }
  return {converted, {}};
}

}  // namespace brisance::units
