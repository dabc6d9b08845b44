#include "core/units.hpp"

#include <fmt/format.h>
#include <udunits2.h>

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <memory>
#include <mutex>
#include <system_error>

namespace brisance::units {

namespace {

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
struct FreeConverter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};
using UnitPointer = std::unique_ptr<ut_unit, FreeUnit>;
using ConverterPointer = std::unique_ptr<cv_converter, FreeConverter>;

/// UDUNITS keeps its status and its scanner in globals, so all calls stand behind this lock.
std::mutex& lock() {
  static std::mutex mutex;
  return mutex;
}

/// The unit table, read once; null when UDUNITS is not properly installed.
ut_system* unit_system() {
  static ut_system* const system = [] {
    ut_set_error_message_handler(ut_ignore);
    return ut_read_xml(nullptr);
  }();
  return system;
}

struct Named {
  char const* unit;
  char const* name;
};
constexpr std::array dimensions{
    Named{"1", "a pure number"},
    Named{"m", "a length"},
    Named{"m2", "an area"},
    Named{"m3", "a volume"},
    Named{"kg", "a mass"},
    Named{"s", "a time"},
    Named{"m/s", "a speed"},
    Named{"m/s2", "an acceleration"},
    Named{"kg/m3", "a density"},
    Named{"kg/m2", "a mass per area"},
    Named{"kg/m", "a mass per length"},
    Named{"kg/mol", "a molar mass"},
    Named{"Pa", "a pressure"},
    Named{"J", "an energy"},
    Named{"J/kg", "an energy per mass"},
    Named{"J/(kg K)", "an energy per mass and temperature"},
    Named{"W", "a power"},
    Named{"N", "a force"},
    Named{"Pa s", "an impulse per area"},
    Named{"Hz", "a frequency"},
    Named{"s-1", "a rate"},
    Named{"K", "a temperature"},
    Named{"mol", "an amount of substance"},
    Named{"A", "an electric current"},
};

UnitPointer parse_unit(std::string const& text) { return UnitPointer(ut_parse(unit_system(), text.c_str(), UT_ASCII)); }

/// Same dimension? Stricter than `ut_are_convertible`, which also takes a quantity and its reciprocal for convertible.
bool same_dimension(ut_unit const* a, ut_unit const* b) {
  UnitPointer const ratio(ut_divide(a, b));
  return ratio && ut_is_dimensionless(ratio.get()) != 0 && ut_are_convertible(a, b) != 0;
}

/// "a length (m)": the unit as it is asked for.
std::string expected(std::string_view si_unit) {
  return si_unit == "1" ? "a pure number" : fmt::format("{} ({})", dimension(si_unit), si_unit);
}

std::string dimension_name(ut_unit const* unit) {
  for (auto const& known : dimensions) {
    UnitPointer const other = parse_unit(known.unit);
    if (other && same_dimension(unit, other.get())) return known.name;
  }
  return {};
}

/// The text with UDUNITS' ASCII spelling of what people type in UTF-8.
std::string ascii_unit(std::string_view text) {
  struct Spelling {
    std::string_view from;
    std::string_view to;
  };
  constexpr std::array spellings{Spelling{"\u00b5", "u"}, Spelling{"\u03bc", "u"}, Spelling{"\u00b2", "2"},
                                 Spelling{"\u00b3", "3"}, Spelling{"\u00b7", "."}, Spelling{"\u00b0", "deg"}};
  std::string out;
  while (!text.empty()) {
    std::string_view to = text.substr(0, 1);
    std::size_t length = 1;
    for (auto const& s : spellings) {
      if (!text.starts_with(s.from)) continue;
      to = s.to;
      length = s.from.size();
    }
    out += to;
    text.remove_prefix(length);
  }
  return out;
}

/// Checks that a unit is a product of powers of named units: `kg m2/s^2`, `J/(kg K)`, `s-1`. UDUNITS also reads time
/// stamps, logarithmic and shifted units, which are no quantities here, and loses memory at every syntax error; so it
/// gets only this.
class UnitSyntax {
 public:
  explicit UnitSyntax(std::string_view text) : rest_(text) {}
  bool valid() { return rest_.size() <= longest && product() && rest_.empty(); }

 private:
  static constexpr std::size_t longest = 60;
  std::string_view rest_;

  static bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
  static bool digit(char c) { return c >= '0' && c <= '9'; }
  [[nodiscard]] bool next(char c) const { return !rest_.empty() && rest_.front() == c; }
  bool take(char c) {
    if (!next(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  bool product() {
    if (!factor()) return false;
    while (!rest_.empty() && !next(')')) {
      bool const blank = take(' ');
      while (take(' ')) {
      }
      bool const sign = take('*') || take('.') || take('/');
      if (!blank && !sign) return false;
      while (take(' ')) {
      }
      if (!factor()) return false;
    }
    return true;
  }

  bool factor() {
    if (take('(')) {
      if (!product() || !take(')')) return false;
    } else if (!take('%')) {
      std::string name;
      while (!rest_.empty() && letter(rest_.front())) {
        name += static_cast<char>(std::tolower(static_cast<unsigned char>(rest_.front())));
        rest_.remove_prefix(1);
      }
      // Words of the grammar of UDUNITS.
      for (auto const* word : {"", "since", "after", "from", "ref", "re", "per", "now"}) {
        if (name == word) return false;
      }
    }
    bool const power = take('^');
    bool const sign = take('-');
    int digits = 0;
    while (!rest_.empty() && digit(rest_.front())) {
      rest_.remove_prefix(1);
      ++digits;
    }
    return digits > 0 ? digits <= 2 : !power && !sign;
  }
};

std::string_view trim(std::string_view text) {
  std::string_view const blank = " \t\r\n";
  auto const first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::string shown(std::string_view text) {
  std::string out = "\"";
  for (char const c : text.substr(0, 40)) out += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  // Do not cut inside a UTF-8 character.
  if (text.size() > 40) {
    while (!out.empty() && (static_cast<unsigned char>(out.back()) & 0xC0U) == 0x80U) out.pop_back();
    if (!out.empty() && static_cast<unsigned char>(out.back()) >= 0xC0U) out.pop_back();
    out += "...";
  }
  return out + "\"";
}

}  // namespace

std::string dimension(std::string_view si_unit) {
  for (auto const& known : dimensions) {
    if (si_unit == known.unit) return known.name;
  }
  if (si_unit == "J/m3") return "an energy per volume";
  return "a quantity";
}

Quantity parse(std::string_view text, std::string_view si_unit) {
  auto const failed = [](std::string problem) { return Quantity{std::nullopt, std::move(problem)}; };
  std::string_view const body = trim(text);
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
    return failed(fmt::format("{} has a comma: write the number with a decimal point, expected {}", shown(text),
                              expected(si_unit)));
  }

  std::lock_guard const guard(lock());
  if (unit_system() == nullptr)
    return failed("the unit table of UDUNITS could not be read; give the number in SI units");
  std::string const ascii = ascii_unit(unit);
  UnitPointer const from = UnitSyntax(ascii).valid() ? parse_unit(ascii) : nullptr;
  if (!from)
    return failed(fmt::format("{} has the unknown unit {}, expected {}", shown(text), shown(unit), expected(si_unit)));
  UnitPointer const to = parse_unit(std::string(si_unit));
  if (!to) return failed(fmt::format("the unit {} is not known to UDUNITS", shown(si_unit)));
  if (!same_dimension(from.get(), to.get())) {
    std::string const name = dimension_name(from.get());
    return failed(name.empty() ? fmt::format("{} has the wrong dimension, expected {}", shown(text), expected(si_unit))
                               : fmt::format("{} is {}, expected {}", shown(text), name, expected(si_unit)));
  }
  ConverterPointer const converter(ut_get_converter(from.get(), to.get()));
  if (!converter) return failed(fmt::format("{} cannot be converted, expected {}", shown(text), expected(si_unit)));
  double const converted = cv_convert_double(converter.get(), value);
  if (!std::isfinite(converted)) {
    return failed(fmt::format("{} is not a finite number, expected {}", shown(text), expected(si_unit)));
  }
  return {converted, {}};
}

}  // namespace brisance::units
