/// The standard atmosphere of ISO 2533 [ISO2533], the same as that of ICAO: pressure and temperature by height.
#pragma once

namespace brisance::empirical {

inline constexpr double lowest_altitude = -2000.0;   ///< [m]
inline constexpr double highest_altitude = 32000.0;  ///< [m]

struct AirState {
  double pressure = 101325.0;    ///< [Pa]
  double temperature = 288.15;   ///< [K]
  double density = 1.225;        ///< [kg/m3]
  double sound_speed = 340.294;  ///< [m/s]
};

/// State of the air at a geometric height above the mean sea level [m]. Throws InputError outside the heights above.
[[nodiscard]] AirState standard_atmosphere(double altitude);

}  // namespace brisance::empirical
