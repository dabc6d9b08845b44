/// Johnson-Cook failure [JohnsonCook85]: damage grows by d ep / ef,
///     ef = (D1 + D2 exp(D3 sigma*)) (1 + D4 ln r) (1 + D5 T*),   sigma* = -p / q,
/// with p the pressure and q the Mises stress. sigma* is limited to 1.5, where the range of the fit ends
/// [JohnsonCook85]. The scales of r and T* (rate0, T_room, T_melt) are those of the Johnson-Cook strength of the same
/// solid, for the D are fitted together with them; with any other strength rate0 = 1 /s and T* = 0.
#pragma once

#include <array>

#include "core/math.hpp"
#include "core/parameter.hpp"

namespace brisance::material {

struct JohnsonCookFailure {
  double D1 = 0.05;
  double D2 = 3.44;
  double D3 = -2.12;
  double D4 = 0.002;
  double D5 = 0.61;

  static constexpr char const* name = "johnson_cook";
  static constexpr bool damages = true;
  static constexpr auto parameters() {
    using P = Parameter<JohnsonCookFailure>;
    return std::array{P{"D1", "1", &JohnsonCookFailure::D1, -10.0, 100.0, "failure strain at high triaxiality, D1"},
                      P{"D2", "1", &JohnsonCookFailure::D2, 0.0, 100.0, "coefficient of triaxiality D2"},
                      P{"D3", "1", &JohnsonCookFailure::D3, -100.0, 100.0, "exponent of triaxiality D3"},
                      P{"D4", "1", &JohnsonCookFailure::D4, -1.0, 10.0, "coefficient of the strain rate D4"},
                      P{"D5", "1", &JohnsonCookFailure::D5, -1.0, 100.0, "coefficient of the temperature D5"}};
  }

  /// Largest triaxiality of the formula.
  static constexpr double largest_triaxiality = 1.5;
  /// Failure strains are not below this, however the D combine: damage must not fall.
  static constexpr double smallest_failure_strain = 1e-6;

  /// Equivalent plastic strain at failure; `log_rate` = ln r >= 0, `hot` = T*.
  [[nodiscard]] double failure_strain(double triaxiality, double log_rate, double hot) const {
    double const limited = triaxiality < largest_triaxiality ? triaxiality : largest_triaxiality;
    double const ef = (D1 + D2 * exp_bounded(D3 * limited)) * (1.0 + D4 * log_rate) * (1.0 + D5 * hot);
    return ef > smallest_failure_strain ? ef : smallest_failure_strain;
  }
};

}  // namespace brisance::material
