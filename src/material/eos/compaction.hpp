/// Pressure of porous concrete, [HJC93], in three zones of the compression mu = rho/rho0 - 1:
///     elastic     p = K_e mu, K_e = P_crush / mu_crush, up to mu_crush;
///     transition  the pores are crushed: a straight line from (mu_crush, P_crush) to (mu_plock, P_lock);
///     dense       p = K1 m + K2 m^2 + K3 m^3,  m = (mu - mu_lock) / (1 + mu_lock).
/// mu_plock is where the third curve reaches P_lock: the curve is continuous by construction.
///
/// Below the largest compression so far, mu_max, a straight line is followed down and up. Its slope is K_e in the
/// elastic zone, K1 / (1 + mu_lock) - K1 of m - in the dense one, and linear in mu_max between; in the dense zone not
/// below the slope of the curve itself, or a loop would create energy. Where the line meets p = 0 lies the plastic
/// volume strain.
#pragma once

#include <array>

#include "core/parameter.hpp"

namespace brisance::material {

struct Compaction {
  double rho0 = 2440.0;     ///< stress-free density [kg/m3]
  double P_crush = 16e6;    ///< pressure at which the pores begin to collapse [Pa]
  double mu_crush = 0.001;  ///< compression there
  double P_lock = 0.8e9;    ///< pressure at which no pores are left [Pa]
  double mu_lock = 0.1;     ///< compression of the dense material without pressure
  double K1 = 85e9;         ///< [Pa]
  double K2 = -171e9;       ///< [Pa]
  double K3 = 208e9;        ///< [Pa]

  static constexpr char const* name = "compaction";
  static constexpr bool bears_tension = true;  ///< can its pressure be negative?
  static constexpr bool of_solids = true;      ///< can `[solids.NAME]` have it?
  static constexpr auto parameters() {
    using P = Parameter<Compaction>;
    return std::array{
        P{"rho0", "kg/m3", &Compaction::rho0, 1.0, 1e5, "stress-free density"},
        P{"P_crush", "Pa", &Compaction::P_crush, 1.0, 1e12, "pressure at which pore collapse begins"},
        P{"mu_crush", "1", &Compaction::mu_crush, 1e-8, 1.0, "volumetric strain mu at P_crush"},
        P{"P_lock", "Pa", &Compaction::P_lock, 1.0, 1e13, "pressure at which all pores are closed"},
        P{"mu_lock", "1", &Compaction::mu_lock, 1e-6, 10.0,
          "volumetric strain mu of the dense material at zero pressure"},
        P{"K1", "Pa", &Compaction::K1, 1.0, 1e13, "dense material: linear coefficient"},
        P{"K2", "Pa", &Compaction::K2, -1e14, 1e14, "dense material: quadratic coefficient"},
        P{"K3", "Pa", &Compaction::K3, -1e14, 1e14, "dense material: cubic coefficient"},
    };
  }

  [[nodiscard]] double elastic_modulus() const { return P_crush / mu_crush; }

  /// The compression at which the dense curve reaches P_lock: Newton from the left, where a curve bent downwards is
  /// approached without overshoot.
  [[nodiscard]] double mu_plock() const {
    double m = P_lock / K1;
    for (int pass = 0; pass < 50; ++pass) {
      double const next = m - (m * (K1 + m * (K2 + m * K3)) - P_lock) / (K1 + m * (2.0 * K2 + 3.0 * m * K3));
      if (!(next > m)) break;
      m = next;
    }
    return mu_lock + (1.0 + mu_lock) * m;
  }

  /// The constants of the curves, found once for a loop over particles.
  struct Curves {
    double rho0, K_e, mu_crush, P_crush, mu_plock, slope, mu_lock, per_dense, K_lock, K1, K2, K3;

    /// Pressure [Pa] of first loading.
    [[nodiscard]] double loading(double mu) const {
      double const m = (mu - mu_lock) * per_dense;
      double const dense = m * (K1 + m * (K2 + m * K3));
      double const crushed = P_crush + slope * (mu - mu_crush);
      double const above = mu < mu_plock ? crushed : dense;
      return mu < mu_crush ? K_e * mu : above;
    }
    /// Its slope dp / dmu [Pa].
    [[nodiscard]] double loading_slope(double mu) const {
      double const m = (mu - mu_lock) * per_dense;
      double const dense = per_dense * (K1 + m * (2.0 * K2 + 3.0 * m * K3));
      double const above = mu < mu_plock ? slope : dense;
      return mu < mu_crush ? K_e : above;
    }
    /// Slope dp / dmu [Pa] below the largest compression so far.
    [[nodiscard]] double unloading_slope(double most) const {
      double const part = (most - mu_crush) / (mu_plock - mu_crush);
      double const above = part > 0.0 ? part : 0.0;
      double const K = K_e + (K_lock - K_e) * (above < 1.0 ? above : 1.0);
      double const own = loading_slope(most);
      return K > own ? K : own;
    }
    /// Plastic volume strain: the compression that is left without pressure.
    [[nodiscard]] double residual(double most) const { return most - loading(most) / unloading_slope(most); }
    /// Pressure [Pa], negative in tension; `most` is not below mu.
    [[nodiscard]] double pressure(double mu, double most) const {
      return loading(most) - unloading_slope(most) * (most - mu);
    }
  };
  [[nodiscard]] Curves curves() const {
    double const plock = mu_plock();
    return {rho0,
            elastic_modulus(),
            mu_crush,
            P_crush,
            plock,
            (P_lock - P_crush) / (plock - mu_crush),
            mu_lock,
            1.0 / (1.0 + mu_lock),
            K1 / (1.0 + mu_lock),
            K1,
            K2,
            K3};
  }

  /// The pressure knows no energy. As an equation of state without history, that of first loading.
  [[nodiscard]] double gruneisen() const { return 0.0; }
  [[nodiscard]] double reference(double rho) const { return curves().loading(rho / rho0 - 1.0); }
  [[nodiscard]] double rho_d_reference(double rho) const {
    return rho / rho0 * curves().loading_slope(rho / rho0 - 1.0);
  }
};

}  // namespace brisance::material
