/// Ideal gas, [Cui14] Eq. (55): p = (gamma - 1) rho e.
#pragma once

#include <array>

#include "core/parameter.hpp"

namespace brisance::material {

struct IdealGas {
  double gamma = 1.4;  ///< ratio of specific heats

  static constexpr char const* name = "ideal_gas";
  static constexpr bool bears_tension = false;  ///< can its pressure be negative?
  static constexpr bool of_solids = false;      ///< can `[solids.NAME]` have it?
  static constexpr auto parameters() {
    return std::array{Parameter<IdealGas>{"gamma", "1", &IdealGas::gamma, 1.0001, 10.0, "ratio of specific heats"}};
  }

  [[nodiscard]] double gruneisen() const { return gamma - 1.0; }
  template <class V>
  [[nodiscard]] V reference(V const& /*rho*/) const {
    return V(0.0);
  }
  template <class V>
  [[nodiscard]] V rho_d_reference(V const& /*rho*/) const {
    return V(0.0);
  }
  [[nodiscard]] double cold_energy(double /*rho*/) const { return 0.0; }
  [[nodiscard]] double cold_pressure(double /*rho*/) const { return 0.0; }
};

}  // namespace brisance::material
