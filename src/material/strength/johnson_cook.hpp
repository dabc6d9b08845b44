/// Johnson-Cook plasticity, [Cui14] Eq. (64), [JohnsonCook83]:
///     sigma_y = (A + B ep^n) (1 + C ln r) (1 - T*^m),
///     r = max(1, (d ep / dt) / rate0),  T* = (T - T_room) / (T_melt - T_room) kept in 0..1.
/// Below the reference rate there is no softening.
#pragma once

#include <array>

#include "core/math.hpp"
#include "core/parameter.hpp"

namespace brisance::material {

struct JohnsonCook {
  double G = 80e9;         ///< shear modulus [Pa]
  double A = 792e6;        ///< [Pa]
  double B = 510e6;        ///< [Pa]
  double n = 0.26;         ///< exponent of hardening
  double C = 0.014;        ///< coefficient of the rate
  double m = 1.03;         ///< exponent of thermal softening
  double rate0 = 1.0;      ///< reference rate [1/s]
  double T_room = 293.0;   ///< temperature below which nothing softens [K]
  double T_melt = 1793.0;  ///< [K]

  static constexpr char const* name = "johnson_cook";
  static constexpr bool deviatoric = true;
  static constexpr bool plastic = true;
  static constexpr auto parameters() {
    using P = Parameter<JohnsonCook>;
    return std::array{
        P{"G", "Pa", &JohnsonCook::G, 1.0, 1e13, "shear modulus"},
        P{"A", "Pa", &JohnsonCook::A, 0.0, 1e12, "yield stress at the reference rate, A"},
        P{"B", "Pa", &JohnsonCook::B, 0.0, 1e12, "hardening coefficient B"},
        P{"n", "1", &JohnsonCook::n, 0.01, 5.0, "hardening exponent n"},
        P{"C", "1", &JohnsonCook::C, 0.0, 1.0, "rate coefficient C"},
        P{"m", "1", &JohnsonCook::m, 0.01, 20.0, "thermal softening exponent m"},
        P{"rate0", "1/s", &JohnsonCook::rate0, 1e-9, 1e9, "reference strain rate", 1.0},
        P{"T_room", "K", &JohnsonCook::T_room, 0.0, 1e4, "room temperature", 293.0},
        P{"T_melt", "K", &JohnsonCook::T_melt, 1.0, 1e5, "melting temperature"},
    };
  }

  [[nodiscard]] double shear_modulus() const { return G; }
  [[nodiscard]] double first_yield() const { return A; }

  /// T*, 0..1, of a temperature [K].
  [[nodiscard]] double homologous_temperature(double T) const {
    double const x = (T - T_room) * (1.0 / (T_melt - T_room));
    double const y = x > 0.0 ? x : 0.0;
    return y < 1.0 ? y : 1.0;
  }

  /// The factor 1 - T*^m.
  [[nodiscard]] double softening(double T) const { return 1.0 - pow_nonnegative(homologous_temperature(T), m); }

  /// B ep^n [Pa].
  [[nodiscard]] double hardened(double ep) const { return B * pow_nonnegative(ep, n); }

  /// Yield stress [Pa] at or below the reference rate; `soft` from softening(), `hard` from hardened().
  [[nodiscard]] double slow_yield_stress(double hard, double soft) const { return (A + hard) * soft; }

  /// What is left of consistency, and its slope.
  struct Residual {
    double value;  ///< 3 G x + sigma_y(ep + x, x/dt) - q [Pa]
    double slope;  ///< its derivative with respect to u = ln x [Pa]
  };

  /// Consistency of the radial return from a trial Mises stress q by an increment x of plastic strain:
  /// q - 3 G x = sigma_y. In u = ln x every part of the residual rises and is convex, the kink at the reference rate
  /// included; Newton steps from a u right of the root therefore approach it from the right without overshoot, whatever
  /// n and C are. `hard` = hardened(ep + x), `log_rate` = ln(1 / (dt rate0)).
  [[nodiscard]] Residual residual(double u, double x, double q, double ep, double hard, double soft,
                                  double log_rate) const {
    double const log_r = u + log_rate;
    double const above = log_r > 0.0 ? log_r : 0.0;
    double const rate_slope = log_r > 0.0 ? C : 0.0;
    double const rate = 1.0 + C * above;
    return {3.0 * G * x + soft * (A + hard) * rate - q,
            3.0 * G * x + soft * (n * hard * (x / (ep + x)) * rate + (A + hard) * rate_slope)};
  }
};

}  // namespace brisance::material
