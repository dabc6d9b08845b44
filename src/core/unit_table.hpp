/// The units of decks: their symbols and names, the prefixes that they take, what they measure, and what people write
/// who mean something else. Private to this folder.
#pragma once

#include <array>
#include <string_view>

namespace brisance::units {

struct Named {
  char const* unit;
  char const* name;
};
inline constexpr std::array dimensions{
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
inline constexpr std::array symbols{
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
inline constexpr std::array names{
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
inline constexpr std::array long_prefixes{
    LongPrefix{"nano", 'n'}, LongPrefix{"micro", 'u'}, LongPrefix{"milli", 'm'}, LongPrefix{"centi", 'c'},
    LongPrefix{"deci", 'd'}, LongPrefix{"hecto", 'h'}, LongPrefix{"kilo", 'k'},  LongPrefix{"mega", 'M'},
    LongPrefix{"giga", 'G'}, LongPrefix{"tera", 'T'},
};

/// What people write, and what they may mean by it.
struct Remedy {
  std::string_view word;
  std::string_view text;
};
inline constexpr std::string_view tons = "t (metric, 1000 kg), short_ton (American, 907.185 kg) or long_ton (British)";
inline constexpr std::string_view kilotons =
    "1000 t (metric, 1e6 kg) or 1000 short_ton (American, 907185 kg); as an energy of TNT 4.184e12 J";
inline constexpr std::string_view megatons =
    "1e6 t (metric, 1e9 kg) or 1e6 short_ton (American, 9.07185e8 kg); as an energy of TNT 4.184e15 J";
inline constexpr std::string_view calories =
    "4.184 J (thermochemical, usual for explosives) or 4.1868 J (international)";
inline constexpr std::string_view kilocalories =
    "4.184 kJ (thermochemical, usual for explosives) or 4.1868 kJ (international)";
inline constexpr std::string_view ton_forces = "9.80665 kN (metric), 8.89644 kN (American) or 9.96402 kN (British)";
inline constexpr std::string_view gallons = "3.78541 l (American) or 4.54609 l (British)";
/// Units with several meanings.
inline constexpr std::array ambiguous{
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
inline constexpr std::array meant{
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
    Remedy{"psig", "\"psi\", with the ambient pressure added unless an overpressure is required?"},
    Remedy{"barg", "\"bar\", with the ambient pressure added unless an overpressure is required?"},
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
    Remedy{"TNT", "the unit alone, with the explosive in a separate key?"},
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

}  // namespace brisance::units
