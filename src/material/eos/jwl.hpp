/// Jones-Wilkins-Lee equation of state of detonation products, [Cui14] Eq. (54):
///     p = A (1 - w/(R1 V)) exp(-R1 V) + B (1 - w/(R2 V)) exp(-R2 V) + w E / V,   V = rho0 / rho,
/// with E the internal energy per unit initial volume, so that w E / V = w rho e.
#pragma once

#include <algorithm>
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
  /// Relative volume V beyond which the products are an ideal gas with gamma = 1 + omega: an option that saves the
  /// exponentials of thin products. The reference curve fades out from half of it on, as a smooth step of V: an energy
  /// goes with any reference curve, so that the equation of state stays a consistent one. Far beyond everything: none.
  double ideal_beyond = never_ideal;
  static constexpr double never_ideal = 1e300;

  static constexpr char const* name = "jwl";
  static constexpr bool bears_tension = false;  ///< can its pressure be negative?
  static constexpr bool of_solids = false;      ///< can `[solids.NAME]` have it?
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
  template <class V>
  [[nodiscard]] V reference(V const& rho) const {
    V const v = rho0 / rho;
    V const x = rho * (omega / rho0);  // omega / V
    V const full = curve(x, exp_nonpositive(-R1 * v), exp_nonpositive(-R2 * v));
    V const t = remaining(v);
    return full * (t * t * (3.0 - 2.0 * t));
  }
  template <class V>
  [[nodiscard]] V rho_d_reference(V const& rho) const {
    V const v = rho0 / rho;
    V const x = rho * (omega / rho0);
    V const e1 = exp_nonpositive(-R1 * v);
    V const e2 = exp_nonpositive(-R2 * v);
    V const derivative = A * (R1 * v - omega - x * (1.0 / R1)) * e1 + B * (R2 * v - omega - x * (1.0 / R2)) * e2;
    V const full = curve(x, e1, e2);
    V const t = remaining(v);
    return derivative * (t * t * (3.0 - 2.0 * t)) + full * (v * (6.0 * t * (1.0 - t)) * (2.0 / ideal_beyond));
  }
  /// Specific energy of the curve without thermal energy, the terms of A and B on an isentrope [J/kg].
  [[nodiscard]] double cold_energy(double rho) const {
    if (rho < negligible_below()) return 0.0;
    double const v = rho0 / rho;
    double const t = remaining(v);
    return (A / R1 * exp_nonpositive(-R1 * v) + B / R2 * exp_nonpositive(-R2 * v)) / rho0 * (t * t * (3.0 - 2.0 * t));
  }
  /// Pressure on that curve [Pa].
  [[nodiscard]] double cold_pressure(double rho) const { return reference(rho) + omega * rho * cold_energy(rho); }

  /// Density [kg/m3] below which both exponentials are lost beside any pressure in double precision (below exp(-60)):
  /// the products are then an ideal gas with gamma = 1 + omega. Or where they are to be one.
  [[nodiscard]] double negligible_below() const {
    return std::max((R1 < R2 ? R1 : R2) / 60.0, 1.0 / ideal_beyond) * rho0;
  }

 private:
  /// The terms of A and B, from omega / V and their exponentials [Pa].
  template <class V>
  [[nodiscard]] V curve(V const& x, V const& e1, V const& e2) const {
    return A * (1.0 - x * (1.0 / R1)) * e1 + B * (1.0 - x * (1.0 / R2)) * e2;
  }
  /// Way from `ideal_beyond` (0) back to half of it (1).
  template <class V>
  [[nodiscard]] V remaining(V const& v) const {
    using std::max;
    using std::min;
    V const t = (ideal_beyond - v) * (2.0 / ideal_beyond);
    return min(V(1.0), max(V(0.0), t));
  }
};

}  // namespace brisance::material
