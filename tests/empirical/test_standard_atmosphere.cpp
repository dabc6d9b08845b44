// The standard atmosphere against rows of the tables of ISO 2533.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "empirical/standard_atmosphere.hpp"

namespace brisance::empirical {
namespace {

struct Row {
  double altitude;     // geometric [m]
  double temperature;  // [K]
  double pressure;     // [Pa]
  double density;      // [kg/m3]
  double sound_speed;  // [m/s]
};

// As printed, to six digits: the tolerance is half a unit of the last one.
constexpr Row table[] = {
    {0.0, 288.150, 1.01325e5, 1.22500, 340.294},       {1000.0, 281.651, 8.98763e4, 1.11166, 336.435},
    {3000.0, 268.659, 7.01212e4, 0.909254, 328.583},   {5000.0, 255.676, 5.40483e4, 0.736429, 320.545},
    {10000.0, 223.252, 2.64999e4, 0.413510, 299.532},  {15000.0, 216.650, 1.21118e4, 0.194755, 295.069},
    {20000.0, 216.650, 5.52930e3, 0.0889097, 295.069}, {30000.0, 226.509, 1.19703e3, 0.0184101, 301.709},
};

TEST(StandardAtmosphere, RowsOfTheTable) {
  for (Row const& row : table) {
    AirState const air = standard_atmosphere(row.altitude);
    EXPECT_NEAR(air.temperature / row.temperature, 1.0, 5e-6) << row.altitude;
    EXPECT_NEAR(air.pressure / row.pressure, 1.0, 1e-5) << row.altitude;
    EXPECT_NEAR(air.density / row.density, 1.0, 1e-5) << row.altitude;
    EXPECT_NEAR(air.sound_speed / row.sound_speed, 1.0, 5e-6) << row.altitude;
  }
}

TEST(StandardAtmosphere, TheBasesOfItsLayers) {
  // Geopotential heights of 11 and 20 km: the pressures that every textbook prints.
  auto const geometric = [](double h) { return 6356766.0 * h / (6356766.0 - h); };
  EXPECT_NEAR(standard_atmosphere(geometric(11000.0)).pressure, 22632.1, 0.1);
  EXPECT_NEAR(standard_atmosphere(geometric(20000.0)).pressure, 5474.89, 0.02);
}

TEST(StandardAtmosphere, IsInEquilibrium) {
  // dp/dz = -rho g, with the gravity of the height.
  for (double z = -1900.0; z < 31900.0; z += 850.0) {
    double const slope = (standard_atmosphere(z + 5.0).pressure - standard_atmosphere(z - 5.0).pressure) / 10.0;
    double const g = 9.80665 * std::pow(6356766.0 / (6356766.0 + z), 2.0);
    EXPECT_NEAR(slope / (-standard_atmosphere(z).density * g), 1.0, 1e-5) << z;  // less than (dz/scale height)^2
  }
}

TEST(StandardAtmosphere, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW((void)standard_atmosphere(-2001.0), InputError);
  EXPECT_THROW((void)standard_atmosphere(32001.0), InputError);
  EXPECT_THROW((void)standard_atmosphere(std::nan("")), InputError);
}

}  // namespace
}  // namespace brisance::empirical
