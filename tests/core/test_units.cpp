#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "core/units.hpp"

namespace brisance {
namespace {

struct Good {
  char const* text;
  char const* unit;
  double value;
};
void PrintTo(Good const& g, std::ostream* out) { *out << g.text << " in " << g.unit; }

class GoodQuantity : public testing::TestWithParam<Good> {};

TEST_P(GoodQuantity, IsConvertedToSi) {
  auto const q = units::parse(GetParam().text, GetParam().unit);
  ASSERT_TRUE(q.value) << q.problem;
  // A conversion is one or two multiplications and an addition.
  EXPECT_NEAR(*q.value, GetParam().value, 1e-14 * std::abs(GetParam().value));
  EXPECT_EQ(q.problem, "");
}

INSTANTIATE_TEST_SUITE_P(Units, GoodQuantity,
                         testing::Values(Good{"12.5 kg", "kg", 12.5}, Good{"20 us", "s", 20e-6},
                                         Good{"1 µs", "s", 1e-6}, Good{"25 MPa", "Pa", 25e6}, Good{"50 mm", "m", 0.05},
                                         Good{"50mm", "m", 0.05}, Good{"  7 ", "m", 7.0}, Good{"+3e-2 m", "m", 0.03},
                                         Good{"-4 cm", "m", -0.04}, Good{"15 degC", "K", 288.15},
                                         Good{"1 atm", "Pa", 101325.0}, Good{"1.5 bar", "Pa", 1.5e5},
                                         Good{"1.63 g/cm3", "kg/m3", 1630.0}, Good{"6.993 GJ/m3", "J/m3", 6.993e9},
                                         Good{"6.93 km/s", "m/s", 6930.0}, Good{"6.93 mm/us", "m/s", 6930.0},
                                         Good{"2 lb", "kg", 0.90718474}, Good{"1 ft", "m", 0.3048},
                                         Good{"50 %", "1", 0.5}, Good{"0.8", "1", 0.8}, Good{"10 kg/m", "kg/m", 10.0},
                                         Good{"3 m·s-1", "m/s", 3.0}, Good{"3 m²", "m2", 3.0},
                                         Good{"3 kg m^-3", "kg/m3", 3.0}, Good{"287 J/(kg K)", "J/(kg K)", 287.0},
                                         Good{"15 °C", "K", 288.15}));

// Angles are degrees where no unit is given.
INSTANTIATE_TEST_SUITE_P(Angles, GoodQuantity,
                         testing::Values(Good{"33", "deg", 33.0}, Good{"33 deg", "deg", 33.0},
                                         Good{"33 degree", "deg", 33.0}, Good{"33 degrees", "deg", 33.0},
                                         Good{"33°", "deg", 33.0}, Good{"33 °", "deg", 33.0}, Good{"33º", "deg", 33.0},
                                         Good{"0.5 rad", "deg", 0.5 * 180.0 / std::numbers::pi},
                                         Good{"0.5 radian", "deg", 0.5 * 180.0 / std::numbers::pi},
                                         Good{"0.5 radians", "deg", 0.5 * 180.0 / std::numbers::pi},
                                         Good{"500 mrad", "deg", 0.5 * 180.0 / std::numbers::pi},
                                         Good{"2 deg2/deg", "deg", 2.0}, Good{"2 deg/deg", "1", 2.0}));

// Factors of NIST Special Publication 811, exact where the unit is defined by SI units.
constexpr double pound = 0.45359237;
constexpr double foot = 0.3048;
constexpr double gravity = 9.80665;
constexpr double psi = pound * gravity / (foot * foot / 144.0);
INSTANTIATE_TEST_SUITE_P(
    Customary, GoodQuantity,
    testing::Values(
        Good{"5 lbs", "kg", 5.0 * pound}, Good{"5 lbm", "kg", 5.0 * pound}, Good{"5 pounds", "kg", 5.0 * pound},
        Good{"16 ounce", "kg", pound}, Good{"16 ounces", "kg", pound}, Good{"7000 grains", "kg", pound},
        Good{"1 slug", "kg", pound* gravity / foot}, Good{"1 short_ton", "kg", 2000.0 * pound},
        Good{"1 long_ton", "kg", 2240.0 * pound}, Good{"7.85e-9 t/mm^3", "kg/m3", 7850.0},
        Good{"3 tonnes", "kg", 3000.0}, Good{"2 metric_tons", "kg", 2000.0}, Good{"1.8 Mg/m3", "kg/m3", 1800.0},
        Good{"30 psi", "Pa", 30.0 * psi}, Good{"14.7 psia", "Pa", 14.7 * psi}, Good{"1 ksi", "Pa", 1000.0 * psi},
        Good{"30 lbf/in2", "Pa", 30.0 * psi}, Good{"144 lbf/ft2", "Pa", psi}, Good{"1 kip/in2", "Pa", 1000.0 * psi},
        Good{"1 kgf/cm2", "Pa", gravity * 1e4}, Good{"760 torr", "Pa", 101325.0}, Good{"1 N/mm2", "Pa", 1e6},
        Good{"1 psi ms", "Pa s", psi * 1e-3}, Good{"1 kPa·ms", "Pa s", 1.0},
        Good{"100 lb/ft3", "kg/m3", 100.0 * pound / (foot * foot * foot)}, Good{"60 mi/h", "m/s", 26.8224},
        Good{"10 knots", "m/s", 18520.0 / 3600.0}, Good{"36 km/h", "m/s", 10.0}, Good{"1 nautical_mile", "m", 1852.0},
        Good{"10 mils", "m", 254e-6}, Good{"1 standard_gravity", "m/s2", gravity},
        Good{"1 ft lbf", "J", pound* gravity* foot}, Good{"2 cc", "m3", 2e-6}, Good{"2 mL", "m3", 2e-6},
        Good{"59 degF", "K", 288.15}, Good{"59 °F", "K", 288.15}, Good{"15 ℃", "K", 288.15},
        Good{"15 celsius", "K", 288.15}, Good{"518.67 degR", "K", 288.15}));

// Spellings: blanks, signs of products, powers, names, prefixes, pasted characters.
INSTANTIATE_TEST_SUITE_P(
    Spellings, GoodQuantity,
    testing::Values(Good{"1e3kg", "kg", 1000.0}, Good{"1E3 kg", "kg", 1000.0}, Good{"2 kg m-3", "kg/m3", 2.0},
                    Good{"2 kg.m-3", "kg/m3", 2.0}, Good{"2 kg*m-3", "kg/m3", 2.0}, Good{"2 kg / m3", "kg/m3", 2.0},
                    Good{"2 kg/m/m/m", "kg/m3", 2.0}, Good{"2 kg·m⁻³", "kg/m3", 2.0}, Good{"2 kg⋅m^-3", "kg/m3", 2.0},
                    Good{"2 (m/s)2", "J/kg", 2.0}, Good{"2 1/s", "s-1", 2.0}, Good{"2/s", "s-1", 2.0},
                    Good{"2 s^-1", "1/s", 2.0}, Good{"2 Hz", "1/s", 2.0}, Good{"−5 mm", "m", -0.005},
                    Good{"5 mm", "m", 0.005}, Good{"5 μm", "m", 5e-6}, Good{"5 microns", "m", 5e-6},
                    Good{"5 Millimeters", "m", 0.005}, Good{"5 kilograms", "kg", 5.0},
                    Good{"5 KILOPASCALS", "Pa", 5000.0}, Good{"5 feet", "m", 5.0 * foot}, Good{"5 Bar", "Pa", 5e5},
                    Good{"5 msec", "s", 0.005}, Good{"2 hrs", "s", 7200.0},
                    // In a product a temperature is a difference.
                    Good{"287 J/(kg degC)", "J/(kg K)", 287.0}, Good{"1 Btu/(lb degF)", "J/(kg K)", 4186.8},
                    Good{"287 J/kg/K", "J/(kg K)", 287.0}, Good{"287 J/(kg K)", "J/kg/K", 287.0}));

struct Bad {
  char const* text;
  char const* unit;
  char const* problem;
};
void PrintTo(Bad const& b, std::ostream* out) { *out << b.text << " in " << b.unit; }

class BadQuantity : public testing::TestWithParam<Bad> {};

TEST_P(BadQuantity, IsExplained) {
  auto const q = units::parse(GetParam().text, GetParam().unit);
  EXPECT_FALSE(q.value);
  EXPECT_EQ(q.problem, GetParam().problem);
}

INSTANTIATE_TEST_SUITE_P(
    Units, BadQuantity,
    testing::Values(
        Bad{"12 kg", "m", "\"12 kg\" is a mass, expected a length (m)"},
        Bad{"5 Hz", "s", "\"5 Hz\" is a frequency, expected a time (s)"},
        Bad{"1 m2", "m", "\"1 m2\" is an area, expected a length (m)"},
        Bad{"3 m", "1", "\"3 m\" is a length, expected a pure number"},
        Bad{"5 V", "m", "\"5 V\" has the wrong dimension, expected a length (m)"},
        Bad{"5 kgg", "kg", "\"5 kgg\" has the unknown unit \"kgg\", expected a mass (kg)"},
        Bad{"1,5 m", "m", "\"1,5 m\" contains a comma: write the number with a decimal point, expected a length (m)"},
        Bad{"", "m", "\"\" is not a number, expected a length (m)"},
        Bad{"kg 5", "kg", "\"kg 5\" is not a number, expected a mass (kg)"},
        Bad{"+-5 m", "m", "\"+-5 m\" is not a number, expected a length (m)"},
        Bad{"nan m", "m", "\"nan m\" is not a finite number, expected a length (m)"},
        Bad{"inf", "m", "\"inf\" is not a finite number, expected a length (m)"},
        Bad{"1e999 m", "m", "\"1e999 m\" is not a finite number, expected a length (m)"},
        Bad{"1e300 km", "um", "\"1e300 km\" is not a finite number, expected a quantity (um)"},
        Bad{"5 m^9999", "m",
            "\"5 m^9999\" has the unknown unit \"m^9999\"; powers of units must be integers other than 0, as in m^2 or "
            "s^-1, expected a length (m)"},
        Bad{"5 m kg )", "kg", "\"5 m kg )\" has the unknown unit \"m kg )\", expected a mass (kg)"},
        Bad{"5 m/", "m", "\"5 m/\" has the unknown unit \"m/\", expected a length (m)"},
        // Time stamps, shifted and logarithmic units are known to UDUNITS, but are no quantities of a deck.
        Bad{"3 s since 1970-01-01", "s",
            "\"3 s since 1970-01-01\" has the unknown unit \"s since 1970-01-01\", expected a time (s)"},
        Bad{"3 lg(re 1 mW)", "W", "\"3 lg(re 1 mW)\" has the unknown unit \"lg(re 1 mW)\", expected a power (W)"}));

constexpr char const* tons = "t (metric, 1000 kg), short_ton (American, 907.185 kg) or long_ton (British)";
INSTANTIATE_TEST_SUITE_P(
    Angles, BadQuantity,
    testing::Values(Bad{"33 deg", "1", "\"33 deg\" is an angle, expected a pure number"},
                    Bad{"0.3 rad", "1", "\"0.3 rad\" is an angle, expected a pure number"},
                    Bad{"3 °", "1", "\"3 °\" is an angle, expected a pure number"},
                    Bad{"33 %", "deg", "\"33 %\" is a pure number, expected an angle (deg)"},
                    Bad{"33 1", "deg", "\"33 1\" is a pure number, expected an angle (deg)"},
                    Bad{"33 m/m", "deg", "\"33 m/m\" is a pure number, expected an angle (deg)"},
                    Bad{"33 deg2", "deg", "\"33 deg2\" has the wrong dimension, expected an angle (deg)"},
                    Bad{"5 rad/s", "s-1", "\"5 rad/s\" is an angular speed, expected a rate (s-1)"}));

/// Text, unit asked for, and what the message must contain: the unit by name and what to write in its place.
struct Trap {
  char const* text;
  char const* unit;
  std::vector<char const*> told;
};
void PrintTo(Trap const& t, std::ostream* out) { *out << t.text << " in " << t.unit; }

class TrapOfUnits : public testing::TestWithParam<Trap> {};

TEST_P(TrapOfUnits, IsRefusedWithItsRemedy) {
  auto const q = units::parse(GetParam().text, GetParam().unit);
  EXPECT_FALSE(q.value) << *q.value;
  for (auto const* told : GetParam().told) EXPECT_NE(q.problem.find(told), std::string::npos) << q.problem;
}

INSTANTIATE_TEST_SUITE_P(
    Ambiguous, TrapOfUnits,
    testing::Values(Trap{"5 ton", "kg", {"ambiguous unit \"ton\"", tons}},
                    Trap{"5 Tons", "kg", {"ambiguous unit \"Tons\"", tons}},
                    Trap{"7.85e-9 ton/mm^3", "kg/m3", {"ambiguous unit \"ton\"", tons}},
                    Trap{"7.85e-9 mm^-3 (ton)", "kg/m3", {"ambiguous unit \"ton\"", tons}},
                    Trap{"5 kton", "kg", {"1000 t (metric, 1e6 kg)", "1000 short_ton", "energy of TNT 4.184e12 J"}},
                    Trap{"5 kilotons", "kg", {"1000 t (metric, 1e6 kg)", "1000 short_ton", "4.184e12 J"}},
                    Trap{"5 kiloton", "J", {"1000 t (metric, 1e6 kg)", "energy of TNT 4.184e12 J"}},
                    Trap{"5 Mton", "J", {"1e6 t", "4.184e15 J"}}, Trap{"5 gr", "kg", {"g (gram) or grain (64.8 mg)"}},
                    Trap{"5 ton_force", "N", {"9.80665 kN", "8.89644 kN"}},
                    Trap{"1000 cal/g", "J/kg", {"4.184 J (thermochemical", "4.1868 J"}},
                    Trap{"1 kcal", "J", {"4.184 kJ"}}, Trap{"5 gal", "m3", {"3.78541 l", "4.54609 l"}}));

// To UDUNITS a knot, fluid ounces, a coulomb, a farad; a mass per area; unknown; 1e-9 miles; 10 phot; 1000 s; the
// number 1; 5 m^0; an are; 1e-12 are; a megametre.
INSTANTIATE_TEST_SUITE_P(
    DidYouMean, TrapOfUnits,
    testing::Values(
        Trap{"5 kt", "m/s", {"did you mean \"knot\""}}, Trap{"5 kt", "kg", {"\"1000 t\" (a mass)"}},
        Trap{"5 KT", "kg", {"\"1000 t\" (a mass)"}}, Trap{"5 PSF", "Pa", {"did you mean \"lbf/ft2\"?"}},
        Trap{"5 oz", "kg", {"did you mean \"ounce\""}}, Trap{"15 C", "K", {"did you mean \"degC\"?"}},
        Trap{"15 deg C", "K", {"did you mean \"degC\"?"}}, Trap{"59 F", "K", {"did you mean \"degF\"?"}},
        Trap{"30 lb/in2", "Pa", {"is a mass per area", "did you mean lbf/in2 (psi)"}},
        Trap{"30 kg/cm2", "Pa", {"is a mass per area", "kgf/cm2"}}, Trap{"30 psf", "Pa", {"did you mean \"lbf/ft2\"?"}},
        Trap{"100 pcf", "kg/m3", {"did you mean \"lb/ft3\"?"}}, Trap{"5 Kg", "kg", {"did you mean \"kg\"?"}},
        Trap{"5 KG", "kg", {"did you mean \"kg\"?"}}, Trap{"5 KPa", "Pa", {"did you mean \"kPa\"?"}},
        Trap{"5 Mpa", "Pa", {"did you mean \"MPa\" or"}}, Trap{"5 GPA", "Pa", {"did you mean \"GPa\"?"}},
        Trap{"5 MBAR", "Pa", {"did you mean \"Mbar\" or \"mbar\"?"}}, Trap{"5 pa", "Pa", {"did you mean \"Pa\"?"}},
        Trap{"5 PSI", "Pa", {"did you mean \"psi\"?"}},
        Trap{"5 psig", "Pa", {"did you mean \"psi\"", "ambient pressure added"}},
        Trap{"5 kg/m**3", "kg/m3", {"did you mean \"kg/m^3\"?"}}, Trap{"5 at", "Pa", {"did you mean \"atm\""}},
        Trap{"5 nmi", "m", {"did you mean \"nautical_mile\"?"}}, Trap{"5 mph", "m/s", {"did you mean \"mi/h\"?"}},
        Trap{"5 kph", "m/s", {"did you mean \"km/h\"?"}}, Trap{"5 kilos", "kg", {"did you mean \"kg\"?"}},
        Trap{"1 g0", "m/s2", {"did you mean \"standard_gravity\"?"}}, Trap{"1 g0", "1", {"unknown unit \"g0\""}},
        Trap{"1 g", "m/s2", {"is a mass", "did you mean standard_gravity?"}},
        Trap{"4 m^0.5", "m", {"powers of units must be integers"}},
        Trap{"4 m^1.5", "m", {"powers of units must be integers"}}, Trap{"4 m.5", "m", {"unknown unit \"m.5\""}},
        Trap{"4 m^0", "1", {"powers of units must be integers"}}, Trap{"5 m0", "1", {"unknown unit \"m0\""}},
        Trap{"5 a", "s", {"\"365.25 d\" (a year)"}}, Trap{"0.5 Mm", "m", {"did you mean \"mm\""}},
        Trap{"5 kg/m-3", "kg/m3", {"did you mean kg/m3?"}}, Trap{"5 kg-m-3", "kg/m3", {"did you mean \"kg m-3\"?"}},
        Trap{"5 kPa-ms", "Pa s", {"did you mean \"kPa ms\"?"}}, Trap{"5 Pas", "Pa s", {"did you mean \"Pa s\"?"}},
        Trap{"5 J/kg K", "J/(kg K)", {"did you mean J/(kg K)?"}},
        Trap{"5 J/kg.K", "J/kg/K", {"did you mean J/(kg K)?"}}, Trap{"5 lb", "N", {"did you mean lbf or kgf?"}},
        Trap{"5·22 m", "m", {"unknown unit"}}, Trap{"50 %2", "1", {"unknown unit \"%2\""}},
        Trap{"10^3 kg", "kg", {"as in 1e3"}}, Trap{"10² kg", "kg", {"as in 1e3"}},
        Trap{"1 000 kg", "kg", {"unknown unit \"000 kg\""}}, Trap{"1d3 kg", "kg", {"wrong dimension"}},
        Trap{"0x10 m", "m", {"unknown unit \"x10 m\""}}, Trap{"5 kg TNT", "kg", {"unknown unit \"TNT\""}},
        Trap{"5 e", "1", {"unknown unit \"e\""}}, Trap{"3 dB", "1", {"unknown unit \"dB\""}},
        Trap{"3 ln(re 1 Pa)", "Pa", {"unknown unit"}}, Trap{"3 days since 2000-01-01", "s", {"unknown unit"}},
        Trap{"3 K @ 273.15", "K", {"unknown unit"}}, Trap{"3 pi", "1", {"unknown unit \"pi\""}},
        Trap{"3 mdegC", "K", {"unknown unit \"mdegC\""}}, Trap{"5 Msec", "s", {"did you mean \"msec\"?"}},
        Trap{"5 u", "kg", {"\"um\", \"us\" or \"ug\""}}, Trap{"5'", "m", {"did you mean \"ft\"?"}}));

TEST(Units, NamesDimensions) {
  EXPECT_EQ(units::dimension("m"), "a length");
  EXPECT_EQ(units::dimension("1"), "a pure number");
  EXPECT_EQ(units::dimension("deg"), "an angle");
  EXPECT_EQ(units::dimension("J/m3"), "an energy per volume");
}

TEST(Units, LongTextIsCutInMessages) {
  auto const q = units::parse(std::string(100000, 'x'), "m");
  EXPECT_FALSE(q.value);
  EXPECT_LT(q.problem.size(), 100U);
}

TEST(Units, MayBeUsedFromSeveralThreads) {
  std::vector<std::thread> threads;
  std::vector<int> right(4, 0);
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&right, t] {
      for (int i = 0; i < 200; ++i) {
        right[t] += units::parse("50 mm", "m").value == 0.05 ? 1 : 0;
        right[t] += units::parse("50 kg", "m").problem == "\"50 kg\" is a mass, expected a length (m)" ? 1 : 0;
      }
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(right, std::vector<int>(4, 400));
}

}  // namespace
}  // namespace brisance
