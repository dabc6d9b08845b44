/// Stiffened gas (water and other liquids at shock pressures): p = (gamma - 1) rho e - gamma p_inf.
#pragma once

#include <array>

#include "core/parameter.hpp"

namespace brisance::material {

struct StiffenedGas {
  double gamma = 4.4;
  double p_inf = 6.0e8;  ///< [Pa]

  static constexpr char const* name = "stiffened_gas";
  static constexpr bool bears_tension = true;  ///< can its pressure be negative?
  static constexpr bool of_solids = false;     ///< can `[solids.NAME]` have it?
  static constexpr auto parameters() {
    return std::array{Parameter<StiffenedGas>{"gamma", "1", &StiffenedGas::gamma, 1.0001, 20.0, "exponent gamma"},
                      Parameter<StiffenedGas>{"p_inf", "Pa", &StiffenedGas::p_inf, 0.0, 1e12, "stiffening pressure"}};
  }

  [[nodiscard]] double gruneisen() const { return gamma - 1.0; }
  template <class V>
  [[nodiscard]] V reference(V const& /*rho*/) const {
    return V(-gamma * p_inf);
  }
  template <class V>
  [[nodiscard]] V rho_d_reference(V const& /*rho*/) const {
    return V(0.0);
  }
};

}  // namespace brisance::material
