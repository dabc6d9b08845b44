#include <gtest/gtest.h>

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
        Bad{"1,5 m", "m", "\"1,5 m\" has a comma: write the number with a decimal point, expected a length (m)"},
        Bad{"", "m", "\"\" is not a number, expected a length (m)"},
        Bad{"kg 5", "kg", "\"kg 5\" is not a number, expected a mass (kg)"},
        Bad{"+-5 m", "m", "\"+-5 m\" is not a number, expected a length (m)"},
        Bad{"nan m", "m", "\"nan m\" is not a finite number, expected a length (m)"},
        Bad{"inf", "m", "\"inf\" is not a finite number, expected a length (m)"},
        Bad{"1e999 m", "m", "\"1e999 m\" is not a finite number, expected a length (m)"},
        Bad{"1e300 Mm", "mm", "\"1e300 Mm\" is not a finite number, expected a quantity (mm)"},
        Bad{"5 m^9999", "m", "\"5 m^9999\" has the unknown unit \"m^9999\", expected a length (m)"},
        Bad{"5 m kg )", "kg", "\"5 m kg )\" has the unknown unit \"m kg )\", expected a mass (kg)"},
        Bad{"5 m/", "m", "\"5 m/\" has the unknown unit \"m/\", expected a length (m)"},
        // Time stamps, shifted and logarithmic units are known to UDUNITS, but are no quantities of a deck.
        Bad{"3 s since 1970-01-01", "s",
            "\"3 s since 1970-01-01\" has the unknown unit \"s since 1970-01-01\", expected a time (s)"},
        Bad{"3 lg(re 1 mW)", "W", "\"3 lg(re 1 mW)\" has the unknown unit \"lg(re 1 mW)\", expected a power (W)"}));

TEST(Units, NamesDimensions) {
  EXPECT_EQ(units::dimension("m"), "a length");
  EXPECT_EQ(units::dimension("1"), "a pure number");
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
