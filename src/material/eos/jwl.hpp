/// Jones-Wilkins-Lee equation of state of detonation products, [Cui14] Eq. (54):
///     p = A (1 - w/(R1 V)) exp(-R1 V) + B (1 - w/(R2 V)) exp(-R2 V) + w E / V,   V = rho0 / rho,
/// with E the internal energy per unit initial volume, so that w E / V = w rho e.
#pragma once

#include <array>

#include "core/math.hpp"
#include "core/parameter.hpp"

namespace brisance::material {

struct Jwl {
  double rho0 = 1630.0;  ///< density of the unreacted explosive [kg/m3]
  double A = 371.2e9;    ///< [Pa]
  double B = 3.21e9;     ///< [Pa]
  double R1 = 4.15;
  double R2 = 0.95;
  double omega = 0.30;

  static constexpr char const* name = "jwl";
  static constexpr auto parameters() {
    return std::array{
        Parameter<Jwl>{"rho0", "kg/m3", &Jwl::rho0, 1.0, 1e5, "density of the unreacted explosive"},
        Parameter<Jwl>{"A", "Pa", &Jwl::A, 0.0, 1e13, "JWL coefficient A"},
        Parameter<Jwl>{"B", "Pa", &Jwl::B, -1e12, 1e12, "JWL coefficient B"},
        Parameter<Jwl>{"R1", "1", &Jwl::R1, 0.1, 100.0, "JWL exponent R1"},
        Parameter<Jwl>{"R2", "1", &Jwl::R2, 0.01, 100.0, "JWL exponent R2"},
        Parameter<Jwl>{"omega", "1", &Jwl::omega, 0.01, 2.0, "JWL Grueneisen coefficient omega"},
    };
  }

  [[nodiscard]] double gruneisen() const { return omega; }
  // Quotients of constants stand in brackets: they leave a loop, a division of a variable would not.
  [[nodiscard]] double reference(double rho) const {
    double const v = rho0 / rho;
    double const x = rho * (omega / rho0);  // omega / V
    return A * (1.0 - x * (1.0 / R1)) * exp_nonpositive(-R1 * v) +
           B * (1.0 - x * (1.0 / R2)) * exp_nonpositive(-R2 * v);
  }
  [[nodiscard]] double rho_d_reference(double rho) const {
    double const v = rho0 / rho;
    double const x = rho * (omega / rho0);
    return A * (R1 * v - omega - x * (1.0 / R1)) * exp_nonpositive(-R1 * v) +
           B * (R2 * v - omega - x * (1.0 / R2)) * exp_nonpositive(-R2 * v);
  }

  /// Density [kg/m3] below which both exponentials are lost beside any pressure in double precision (below exp(-60)):
  /// the products are then an ideal gas with gamma = 1 + omega.
  [[nodiscard]] double negligible_below() const { return (R1 < R2 ? R1 : R2) * rho0 / 60.0; }
};

}  // namespace brisance::material
