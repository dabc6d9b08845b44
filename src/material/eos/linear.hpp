/// Linear equation of state of elastic solids: p = K (rho/rho0 - 1), independent of energy.
#pragma once

#include <array>

#include "core/parameter.hpp"

namespace brisance::material {

struct Linear {
  double rho0 = 7850.0;  ///< stress-free density [kg/m3]
  double K = 160e9;      ///< bulk modulus [Pa]

  static constexpr char const* name = "linear";
  static constexpr bool bears_tension = true;  ///< can its pressure be negative?
  static constexpr bool of_solids = true;      ///< can `[solids.NAME]` have it?
  static constexpr auto parameters() {
    return std::array{Parameter<Linear>{"rho0", "kg/m3", &Linear::rho0, 1.0, 1e5, "stress-free density"},
                      Parameter<Linear>{"K", "Pa", &Linear::K, 1.0, 1e13, "bulk modulus"}};
  }

  /// The pressure knows no energy, so this one cannot be inverted for the energy.
  [[nodiscard]] double gruneisen() const { return 0.0; }
  [[nodiscard]] double reference(double rho) const { return K * (rho * (1.0 / rho0) - 1.0); }
  [[nodiscard]] double rho_d_reference(double rho) const { return K * (rho * (1.0 / rho0)); }
};

}  // namespace brisance::material
