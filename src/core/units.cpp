#include "core/units.hpp"

#include <fmt/format.h>
#include <udunits2.h>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
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

struct Named {
  char const* unit;
  char const* name;
};
constexpr std::array dimensions{
    Named{"1", "a pure number"},
    Named{"deg", "an angle"},
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
    Named{"J/kg/K", "an energy per mass and temperature"},
    Named{"W", "a power"},
    Named{"N", "a force"},
    Named{"Pa s", "an impulse per area"},
    Named{"J/m2", "an energy per area"},
    Named{"J/m3", "an energy per volume"},
    Named{"Hz", "a frequency"},
    Named{"s-1", "a rate"},
    Named{"1/s", "a rate"},
    Named{"rad/s", "an angular speed"},
    Named{"K", "a temperature"},
    Named{"mol", "an amount of substance"},
    Named{"A", "an electric current"},
};

// --- The units of decks
//
// UDUNITS computes the factors, but it knows far more than a deck needs, and some of it under spellings that mean
// something else to an engineer: "ton" is the American one, "kt" a knot, "oz" a volume, "C" a coulomb, "nmi" a
// nano-mile, "mph" a milliphot, "kilos" kiloseconds, "g0" the number 1. So a unit is looked up here first, and what is
// not in these tables is refused.

/// One symbol and the prefixes that it takes.
struct Symbol {
  std::string_view word;
  std::string_view udunits;
  std::string_view prefixes;  ///< one letter each, from large to small
  bool is_angle = false;
  std::string_view shifted = {};  ///< the same as a scale with a zero of its own, for a temperature that stands alone
};

// No megametre: "0.5 Mm" is a slip of the shift key. "Mg" is a tonne.
constexpr std::array symbols{
    Symbol{"m", "m", "kdcmun"},
    Symbol{"g", "g", "Mkmun"},
    Symbol{"s", "s", "kmunp"},
    Symbol{"K", "K", ""},
    Symbol{"mol", "mol", "k"},
    Symbol{"A", "A", "km"},
    Symbol{"V", "V", "km"},
    Symbol{"Pa", "Pa", "TGMkhmu"},
    Symbol{"N", "N", "GMkmu"},
    Symbol{"J", "J", "TGMkmu"},
    Symbol{"W", "W", "TGMkmu"},
    Symbol{"Hz", "Hz", "GMk"},
    Symbol{"l", "l", "mu"},
    Symbol{"L", "L", "mu"},
    Symbol{"bar", "bar", "Mkm"},
    Symbol{"t", "t", ""},
    Symbol{"min", "min", ""},
    Symbol{"h", "h", ""},
    Symbol{"hr", "h", ""},
    Symbol{"d", "d", ""},
    Symbol{"sec", "s", "mun"},
    Symbol{"cc", "(cm3)", ""},
    Symbol{"atm", "atm", ""},
    Symbol{"torr", "(atm/760)", ""},
    Symbol{"Torr", "(atm/760)", ""},
    Symbol{"mmHg", "mmHg", ""},
    Symbol{"inHg", "inHg", ""},
    Symbol{"psi", "psi", ""},
    Symbol{"psia", "psi", ""},
    Symbol{"ksi", "ksi", ""},
    Symbol{"lb", "lb", ""},
    Symbol{"lbs", "lb", ""},
    Symbol{"lbm", "lb", ""},
    Symbol{"lbf", "lbf", ""},
    Symbol{"ozf", "ozf", ""},
    Symbol{"kip", "kip", ""},
    Symbol{"kgf", "kgf", ""},
    Symbol{"gf", "gf", ""},
    Symbol{"in", "in", ""},
    Symbol{"ft", "ft", ""},
    Symbol{"yd", "yd", ""},
    Symbol{"mi", "mi", ""},
    Symbol{"mil", "mil", ""},
    Symbol{"dyne", "dyne", ""},
    Symbol{"erg", "erg", ""},
    Symbol{"eV", "eV", "GMk"},
    Symbol{"Btu", "Btu", ""},
    Symbol{"BTU", "Btu", ""},
    Symbol{"deg", "arc_degree", "", true},
    Symbol{"rad", "rad", "m", true},
    Symbol{"degC", "K", "", false, "degC"},
    Symbol{"degF", "degR", "", false, "degF"},
    Symbol{"degK", "K", ""},
    Symbol{"degR", "degR", ""},
    // Only by their names, below.
    Symbol{"long_ton", "long_ton", ""},
    Symbol{"short_ton", "short_ton", ""},
    Symbol{"ounce", "(0.0625 lb)", ""},
    Symbol{"grain", "grain", ""},
    Symbol{"slug", "(lbf.s2/ft)", ""},
    Symbol{"knot", "knot", ""},
    Symbol{"nautical_mile", "nautical_mile", ""},
    Symbol{"standard_gravity", "gravity", ""},
    Symbol{"percent", "percent", ""},
};

/// A name and the symbol that it stands for. Case does not count, a plural may end in s.
struct Name {
  std::string_view word;
  std::string_view symbol;
};
constexpr std::array names{
    Name{"meter", "m"},
    Name{"metre", "m"},
    Name{"micron", "um"},
    Name{"gram", "g"},
    Name{"gramme", "g"},
    Name{"second", "s"},
    Name{"sec", "s"},
    Name{"minute", "min"},
    Name{"min", "min"},
    Name{"hour", "h"},
    Name{"hr", "h"},
    Name{"day", "d"},
    Name{"kelvin", "K"},
    Name{"mole", "mol"},
    Name{"ampere", "A"},
    Name{"volt", "V"},
    Name{"pascal", "Pa"},
    Name{"newton", "N"},
    Name{"joule", "J"},
    Name{"watt", "W"},
    Name{"hertz", "Hz"},
    Name{"liter", "l"},
    Name{"litre", "l"},
    Name{"bar", "bar"},
    Name{"atmosphere", "atm"},
    Name{"standard_atmosphere", "atm"},
    Name{"tonne", "t"},
    Name{"metric_ton", "t"},
    Name{"long_ton", "long_ton"},
    Name{"short_ton", "short_ton"},
    Name{"pound", "lb"},
    Name{"pound_force", "lbf"},
    Name{"pounds_force", "lbf"},
    Name{"ounce", "ounce"},
    Name{"grain", "grain"},
    Name{"slug", "slug"},
    Name{"kip", "kip"},
    Name{"inch", "in"},
    Name{"inches", "in"},
    Name{"foot", "ft"},
    Name{"feet", "ft"},
    Name{"yard", "yd"},
    Name{"mile", "mi"},
    Name{"mil", "mil"},
    Name{"nautical_mile", "nautical_mile"},
    Name{"knot", "knot"},
    Name{"dyne", "dyne"},
    Name{"erg", "erg"},
    Name{"electronvolt", "eV"},
    Name{"degree", "deg"},
    Name{"arc_degree", "deg"},
    Name{"radian", "rad"},
    Name{"celsius", "degC"},
    Name{"degree_celsius", "degC"},
    Name{"degrees_celsius", "degC"},
    Name{"degree_c", "degC"},
    Name{"degrees_c", "degC"},
    Name{"deg_c", "degC"},
    Name{"fahrenheit", "degF"},
    Name{"degree_fahrenheit", "degF"},
    Name{"degrees_fahrenheit", "degF"},
    Name{"degree_f", "degF"},
    Name{"degrees_f", "degF"},
    Name{"deg_f", "degF"},
    Name{"gravity", "standard_gravity"},
    Name{"standard_gravity", "standard_gravity"},
    Name{"percent", "percent"},
};
struct LongPrefix {
  std::string_view word;
  char letter;
};
constexpr std::array long_prefixes{
    LongPrefix{"nano", 'n'}, LongPrefix{"micro", 'u'}, LongPrefix{"milli", 'm'}, LongPrefix{"centi", 'c'},
    LongPrefix{"deci", 'd'}, LongPrefix{"hecto", 'h'}, LongPrefix{"kilo", 'k'},  LongPrefix{"mega", 'M'},
    LongPrefix{"giga", 'G'}, LongPrefix{"tera", 'T'},
};

/// What people write, and what they may mean by it.
struct Remedy {
  std::string_view word;
  std::string_view text;
};
constexpr std::string_view tons = "t (metric, 1000 kg), short_ton (American, 907.185 kg) or long_ton (British)";
constexpr std::string_view kilotons =
    "1000 t (metric, 1e6 kg) or 1000 short_ton (American, 907185 kg); as an energy of TNT 4.184e12 J";
constexpr std::string_view megatons =
    "1e6 t (metric, 1e9 kg) or 1e6 short_ton (American, 9.07185e8 kg); as an energy of TNT 4.184e15 J";
constexpr std::string_view calories = "4.184 J (thermochemical, usual for explosives) or 4.1868 J (international)";
constexpr std::string_view kilocalories =
    "4.184 kJ (thermochemical, usual for explosives) or 4.1868 kJ (international)";
constexpr std::string_view ton_forces = "9.80665 kN (metric), 8.89644 kN (American) or 9.96402 kN (British)";
constexpr std::string_view gallons = "3.78541 l (American) or 4.54609 l (British)";
/// Units with several meanings.
constexpr std::array ambiguous{
    Remedy{"ton", tons},
    Remedy{"tons", tons},
    Remedy{"kton", kilotons},
    Remedy{"ktons", kilotons},
    Remedy{"kiloton", kilotons},
    Remedy{"kilotons", kilotons},
    Remedy{"mton", megatons},
    Remedy{"mtons", megatons},
    Remedy{"megaton", megatons},
    Remedy{"megatons", megatons},
    Remedy{"gr", "g (gram) or grain (64.8 mg)"},
    Remedy{"grs", "g (gram) or grain (64.8 mg)"},
    Remedy{"cal", calories},
    Remedy{"calorie", calories},
    Remedy{"calories", calories},
    Remedy{"kcal", kilocalories},
    Remedy{"tonf", ton_forces},
    Remedy{"tonsf", ton_forces},
    Remedy{"ton_force", ton_forces},
    Remedy{"tons_force", ton_forces},
    Remedy{"gal", gallons},
    Remedy{"gallon", gallons},
    Remedy{"gallons", gallons},
};
/// Units that are none, or others than they look like.
constexpr std::array meant{
    Remedy{"kt", "\"knot\" (a speed) or \"1000 t\" (a mass)"},
    Remedy{"kts", "\"knot\""},
    Remedy{"Mt", "\"1e6 t\""},
    Remedy{"oz", "\"ounce\" (a mass, 28.35 g)"},
    Remedy{"floz", "\"ml\""},
    Remedy{"C", "\"degC\""},
    Remedy{"c", "\"degC\""},
    Remedy{"F", "\"degF\""},
    Remedy{"f", "\"degF\""},
    Remedy{"R", "\"degR\""},
    Remedy{"psf", "\"lbf/ft2\""},
    Remedy{"pcf", "\"lb/ft3\""},
    Remedy{"pci", "\"lb/in3\""},
    Remedy{"psig", "\"psi\", with the ambient pressure added where no overpressure is asked for?"},
    Remedy{"barg", "\"bar\", with the ambient pressure added where no overpressure is asked for?"},
    Remedy{"bara", "\"bar\""},
    Remedy{"kpsi", "\"ksi\""},
    Remedy{"Mpsi", "\"1000 ksi\""},
    Remedy{"msi", "\"1000 ksi\""},
    Remedy{"gm", "\"g\""},
    Remedy{"gms", "\"g\""},
    Remedy{"kgs", "\"kg\""},
    Remedy{"kgm", "\"kg\" or \"kg m\""},
    Remedy{"kilo", "\"kg\""},
    Remedy{"kilos", "\"kg\""},
    Remedy{"mcg", "\"ug\""},
    Remedy{"u", "\"um\", \"us\" or \"ug\""},
    Remedy{"mic", "\"um\""},
    Remedy{"thou", "\"mil\""},
    Remedy{"mtr", "\"m\""},
    Remedy{"mts", "\"m\""},
    Remedy{"nmi", "\"nautical_mile\""},
    Remedy{"sqm", "\"m2\""},
    Remedy{"sqcm", "\"cm2\""},
    Remedy{"sqmm", "\"mm2\""},
    Remedy{"sqft", "\"ft2\""},
    Remedy{"sqin", "\"in2\""},
    Remedy{"ccm", "\"cm3\""},
    Remedy{"cbm", "\"m3\""},
    Remedy{"cum", "\"m3\""},
    Remedy{"cuft", "\"ft3\""},
    Remedy{"cft", "\"ft3\""},
    Remedy{"cuin", "\"in3\""},
    Remedy{"gcc", "\"g/cm3\""},
    Remedy{"mph", "\"mi/h\""},
    Remedy{"kph", "\"km/h\""},
    Remedy{"kmh", "\"km/h\""},
    Remedy{"kmph", "\"km/h\""},
    Remedy{"fps", "\"ft/s\""},
    Remedy{"mps", "\"m/s\""},
    Remedy{"at", "\"atm\" or \"kgf/cm2\""},
    Remedy{"kp", "\"kgf\""},
    Remedy{"dyn", "\"dyne\""},
    Remedy{"daN", "\"10 N\""},
    Remedy{"pdl", "\"lb ft/s2\""},
    Remedy{"g0", "\"standard_gravity\""},
    Remedy{"G", "\"standard_gravity\" or \"g\""},
    Remedy{"gee", "\"standard_gravity\""},
    Remedy{"gn", "\"standard_gravity\""},
    Remedy{"a", "\"365.25 d\" (a year) or \"100 m2\" (an are)"},
    Remedy{"yr", "\"365.25 d\""},
    Remedy{"year", "\"365.25 d\""},
    Remedy{"gon", "\"0.9 deg\""},
    Remedy{"grad", "\"0.9 deg\""},
    Remedy{"rpm", "\"min-1\""},
    Remedy{"cps", "\"Hz\""},
    Remedy{"M", "\"m\""},
    Remedy{"TNT", "the unit alone, with the explosive in a key of its own?"},
    Remedy{"PS", "\"735.5 W\""},
    Remedy{"hp", "\"745.7 W\""},
    Remedy{"Nm", "\"N m\""},
    Remedy{"Pas", "\"Pa s\""},
    Remedy{"kPas", "\"kPa s\""},
    Remedy{"kPams", "\"kPa ms\""},
    Remedy{"psims", "\"psi ms\""},
    Remedy{"ftlb", "\"ft lbf\""},
    Remedy{"kgK", "\"(kg K)\""},
};

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lowered(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = lower(c);
  return out;
}

struct Unit {
  Symbol const* symbol = nullptr;
  std::string_view prefix;
};

/// A symbol with or without a prefix, as written.
std::optional<Unit> unit_by_symbol(std::string_view word) {
  for (Symbol const& s : symbols) {
    if (word == s.word) return Unit{&s, {}};
  }
  for (Symbol const& s : symbols) {
    if (word.size() == s.word.size() + 1 && word.ends_with(s.word) &&
        s.prefixes.find(word.front()) != std::string_view::npos) {
      return Unit{&s, word.substr(0, 1)};
    }
  }
  return std::nullopt;
}

/// A name with or without a prefix, in the singular or plural.
std::optional<Unit> unit_by_name(std::string const& word) {
  auto const plain = [](std::string_view w) -> std::string_view {
    for (Name const& n : names) {
      if (w == n.word || (w.size() == n.word.size() + 1 && w.starts_with(n.word) && w.back() == 's')) return n.symbol;
    }
    return {};
  };
  if (auto const symbol = plain(word); !symbol.empty()) return unit_by_symbol(symbol);
  for (LongPrefix const& p : long_prefixes) {
    if (!word.starts_with(p.word)) continue;
    std::string_view const symbol = plain(std::string_view(word).substr(p.word.size()));
    if (symbol.empty()) continue;
    auto const unit = unit_by_symbol(symbol);
    std::size_t const at = unit ? unit->symbol->prefixes.find(p.letter) : std::string_view::npos;
    if (at != std::string_view::npos && unit->prefix.empty())
      return Unit{unit->symbol, unit->symbol->prefixes.substr(at, 1)};
  }
  return std::nullopt;
}

std::optional<Unit> find_unit(std::string_view word) {
  if (auto const unit = unit_by_symbol(word)) return unit;
  return unit_by_name(lowered(word));
}

/// The units that the word would be if case did not count: `"MPa" or "mPa"`.
std::string nearly(std::string_view word) {
  std::string const wanted = lowered(word);
  std::string out;
  auto const offer = [&](std::string const& unit) {
    if (lowered(unit) != wanted || unit == word) return;
    out += fmt::format("{}\"{}\"", out.empty() ? "" : " or ", unit);
  };
  for (Symbol const& s : symbols) {
    offer(std::string(s.word));
    for (char const prefix : s.prefixes) offer(std::string(1, prefix) + std::string(s.word));
  }
  // A megametre is none here, but what looks like one is near.
  if (word == "Mm" || word == "MM") return "\"mm\" or \"m\"";
  return out;
}

std::string_view remedy_in(auto const& table, std::string_view word) {
  for (Remedy const& r : table) {
    if (r.word == word) return r.text;
  }
  return {};
}

UnitPointer parse_unit(std::string const& text) { return UnitPointer(ut_parse(unit_system(), text.c_str(), UT_ASCII)); }

/// A unit as UDUNITS reads it, or what is wrong with it.
struct Reading {
  UnitPointer unit;
  int angle = 0;  ///< power of the angle, a pure number to UDUNITS
  std::string problem;
};

/// Reads a unit as a product of powers of the units above: `kg m2/s^2`, `J/(kg K)`, `s-1`, `1/s`. UDUNITS also reads
/// time stamps, logarithms, powers that are no whole numbers (m^0.5 as m^0 times 5) and numbers in between, and loses
/// memory at every syntax error; so it gets only what this writes.
class UnitText {
 public:
  explicit UnitText(std::string_view text) : text_(text), rest_(text) {}

  Reading read() {
    bool const fits = text_.size() <= longest;
    // "5 1/s" and "5/s".
    if (fits && (rest_.starts_with("1/") || rest_.starts_with("/"))) {
      rest_.remove_prefix(rest_.front() == '1' ? 1 : 0);
      out_ = "1";
      if (!factors()) return failed();
    } else if (!fits || !product()) {
      return failed();
    }
    if (!rest_.empty()) return failed();
    // Alone a temperature counts from the zero of its scale; in "J/(kg degC)" it is a difference.
    if (!shifted_.empty() && count_ == 1 && out_ == differences_) out_ = std::string(shifted_);
    Reading reading{parse_unit(out_), angle_, {}};
    if (!reading.unit) return failed();
    return reading;
  }

 private:
  static constexpr std::size_t longest = 60;
  std::string_view text_;
  std::string_view rest_;
  std::string out_;
  int angle_ = 0;
  int sign_ = 1;  ///< of the powers here: -1 below an odd number of slashes
  int count_ = 0;
  std::string_view shifted_;
  std::string_view differences_;
  std::string problem_;

  Reading failed() {
    if (problem_.empty()) problem_ = fmt::format("has the unknown unit {}{}", shown(text_), hint());
    return {nullptr, 0, std::move(problem_)};
  }

  /// What may be meant by a text that is no product of powers.
  [[nodiscard]] std::string hint() const {
    if (text_.find("**") != std::string_view::npos) {
      std::string power(text_);
      for (std::size_t at = power.find("**"); at != std::string::npos; at = power.find("**")) power.replace(at, 2, "^");
      return fmt::format("; did you mean {}?", shown(power));
    }
    auto const caret = text_.find('^');
    if (caret == 0) return "; a power of ten is written into the number, as in 1e3";
    if (caret != std::string_view::npos) return "; powers of units are whole numbers other than 0, as in m^2 or s^-1";
    auto const dash = text_.find('-');
    if (dash != std::string_view::npos && dash > 0 && dash + 1 < text_.size() && letter(text_[dash + 1])) {
      std::string product(text_);
      product[dash] = ' ';
      return fmt::format("; did you mean {}?", shown(product));
    }
    if (text_ == "'") return "; did you mean \"ft\"?";
    if (text_ == "\"" || text_ == "''") return "; did you mean \"in\"?";
    return {};
  }

  static bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
  static bool digit(char c) { return c >= '0' && c <= '9'; }
  [[nodiscard]] bool next(char c) const { return !rest_.empty() && rest_.front() == c; }
  bool take(char c) {
    if (!next(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  bool product() { return factor() && factors(); }

  bool factors() {
    while (!rest_.empty() && !next(')')) {
      bool const blank = take(' ');
      while (take(' ')) {
      }
      bool const over = take('/');
      bool const times = !over && (take('*') || take('.'));
      if (!blank && !over && !times) return false;
      while (take(' ')) {
      }
      out_ += over ? '/' : '.';
      if (over) sign_ = -sign_;
      bool const good = factor();
      if (over) sign_ = -sign_;
      if (!good) return false;
    }
    return true;
  }

  bool factor() {
    int const outer = angle_;
    ++count_;
    Symbol const* symbol = nullptr;
    if (take('(')) {
      out_ += '(';
      if (!product() || !take(')')) return false;
      out_ += ')';
    } else if (take('%')) {
      out_ += '%';
      return true;  // "50 %2" is a slip
    } else {
      std::size_t length = 0;
      while (length < rest_.size() && letter(rest_[length])) ++length;
      if (length == 0) return false;
      std::string_view const word = rest_.substr(0, length);
      rest_.remove_prefix(length);
      auto const unit = find_unit(word);
      if (!unit || is_remedied(word)) {
        unknown(word);
        return false;
      }
      symbol = unit->symbol;
      out_ += unit->prefix;
      out_ += symbol->udunits;
      if (!symbol->shifted.empty()) {
        shifted_ = symbol->shifted;
        differences_ = symbol->udunits;
      }
      if (symbol->is_angle) angle_ += sign_;
    }
    bool const power = take('^');
    bool const minus = take('-');
    int digits = 0;
    int exponent = 0;
    while (!rest_.empty() && digit(rest_.front())) {
      exponent = 10 * exponent + (rest_.front() - '0');
      rest_.remove_prefix(1);
      if (++digits > 2) return false;
    }
    if (digits == 0) return !power && !minus;
    if (exponent == 0) {
      if (symbol != nullptr && symbol->word == "g" && !power && !minus) unknown("g0");
      return false;
    }
    if (minus) exponent = -exponent;
    angle_ = outer + exponent * (angle_ - outer);
    out_ += fmt::format("^{}", exponent);
    return true;
  }

  /// Is it a unit by its letters, but another one to most people?
  static bool is_remedied(std::string_view word) {
    return !remedy_in(ambiguous, lowered(word)).empty() || !remedy_in(meant, word).empty();
  }

  void unknown(std::string_view word) {
    if (auto const choice = remedy_in(ambiguous, lowered(word)); !choice.empty()) {
      problem_ = fmt::format("has the ambiguous unit {}: write {}", shown(word), choice);
      return;
    }
    std::string better(remedy_in(meant, word));
    if (better.empty()) better = nearly(word);
    if (better.empty()) better = remedy_in(meant, lowered(word));
    bool const asked = better.find('?') != std::string::npos;
    // The whole unit is the better place to point at where the word does not tell.
    problem_ = fmt::format("has the unknown unit {}{}", shown(better.empty() ? text_ : word),
                           better.empty() ? hint() : fmt::format("; did you mean {}{}", better, asked ? "" : "?"));
  }
};

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

Reading read_unit(std::string_view text) {
  if (text == "1") return {parse_unit("1"), 0, {}};
  return UnitText(text).read();
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
      Slip{"kg", "m/s2", "g is the gram: did you mean standard_gravity?"},
      Slip{"kg m3", "kg/m3", "\"/\" already turns the next power round: did you mean kg/m3?"},
      Slip{"J K/kg", "J/(kg K)", "\"/\" holds for the next unit only: did you mean J/(kg K)?"},
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
    return failed(fmt::format("{} has a comma: write the number with a decimal point, expected {}", shown(text),
                              expected(si_unit)));
  }

  std::lock_guard const guard(lock());
  if (unit_system() == nullptr)
    return failed("the unit table of UDUNITS could not be read; give the number in SI units");
  Reading const from = read_unit(unit);
  if (!from.unit) {
    return failed(fmt::format("{} {}{} expected {}", shown(text), from.problem, from.problem.ends_with('?') ? "" : ",",
                              expected(si_unit)));
  }
  Reading const to = read_unit(si_unit);
  if (!to.unit) return failed(fmt::format("the unit {} is not known", shown(si_unit)));
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
