/// Holmquist-Johnson-Cook strength and damage of concrete, [HJC93], [Cui14] Eqs. (56)-(57):
///     q / fc = [A (1 - D) + B p*^N] [1 + C ln r] <= S_max,   p* = p / fc >= 0,
///     q / fc = A [(1 - D) + p / T_max] [1 + C ln r],         p < 0: a line that falls to 0 at p = -T_max (1 - D),
/// r = max(1, rate / rate0) with the equivalent rate of the deviatoric strain: below the reference rate nothing
/// softens. T_max is T, the largest mean tension, or that of a tensile damage model where the solid has one.
/// Compression-shear damage grows with plastic strain and plastic volume strain,
///     dD_c = (d ep + d mu_p) / max(D1 (p* + T*)^D2, ef_min),   T* = T / fc.
/// plastic strain under mean tension left out where the solid has tensile damage, to which the opening of cracks
/// belongs: else D_c would cut it off at the strain ef_min, whatever the cell and the fracture energy. What has failed
/// (D = 1) keeps the part `residual` of the frictional strength B p*^N: 0 as [Cui14] lets failed particles carry
/// pressure alone, 1 as in [HJC93].
#pragma once

#include <array>

#include "core/math.hpp"
#include "core/parameter.hpp"

namespace brisance::material {

struct Hjc {
  double G = 14.86e9;     ///< shear modulus [Pa]
  double fc = 48e6;       ///< quasi-static uniaxial compressive strength f'_c [Pa]
  double A = 0.79;        ///< normalised cohesive strength
  double B = 1.6;         ///< normalised pressure hardening
  double N = 0.61;        ///< exponent of pressure hardening
  double C = 0.007;       ///< coefficient of the rate
  double S_max = 7.0;     ///< normalised maximum strength
  double T = 4e6;         ///< largest mean tension [Pa]
  double rate0 = 1.0;     ///< reference rate [1/s]
  double D1 = 0.04;       ///< damage constant
  double D2 = 1.0;        ///< exponent of the damage
  double ef_min = 0.01;   ///< smallest plastic strain to fracture
  double residual = 0.0;  ///< fraction of the frictional strength that failed material keeps

  static constexpr char const* name = "hjc";
  static constexpr bool deviatoric = true;
  static constexpr bool plastic = true;
  static constexpr bool pressure_dependent = true;
  static constexpr auto parameters() {
    using P = Parameter<Hjc>;
    return std::array{
        P{"G", "Pa", &Hjc::G, 1.0, 1e13, "shear modulus"},
        P{"fc", "Pa", &Hjc::fc, 1.0, 1e12, "quasi-static uniaxial compressive strength f'_c"},
        P{"A", "1", &Hjc::A, 0.0, 100.0, "normalised cohesive strength A"},
        P{"B", "1", &Hjc::B, 0.0, 100.0, "normalised pressure hardening B"},
        P{"N", "1", &Hjc::N, 0.01, 5.0, "pressure hardening exponent N"},
        P{"C", "1", &Hjc::C, 0.0, 1.0, "rate coefficient C"},
        P{"S_max", "1", &Hjc::S_max, 1e-3, 1e4, "normalised maximum strength S_max"},
        P{"T", "Pa", &Hjc::T, 1.0, 1e12, "maximum mean tension T"},
        P{"rate0", "1/s", &Hjc::rate0, 1e-9, 1e9, "reference strain rate", 1.0},
        P{"D1", "1", &Hjc::D1, 0.0, 100.0, "damage constant D1"},
        P{"D2", "1", &Hjc::D2, 0.0, 10.0, "damage exponent D2"},
        P{"ef_min", "1", &Hjc::ef_min, 1e-6, 10.0, "minimum plastic strain to fracture, EF_min"},
        P{"residual", "1", &Hjc::residual, 0.0, 1.0,
          "fraction of the frictional strength B p*^N that failed material retains; 1 in [HJC93]", 0.0},
    };
  }

  [[nodiscard]] double shear_modulus() const { return G; }
  [[nodiscard]] double first_yield() const { return fc; }

  /// 1 + C ln r of an equivalent strain rate [1/s].
  [[nodiscard]] double rate_factor(double rate) const {
    double const r = rate * (1.0 / rate0);
    return 1.0 + C * log_positive(r > 1.0 ? r : 1.0);
  }

  /// Largest Mises stress [Pa] at the pressure p [Pa], damage D, rate factor and largest mean tension [Pa].
  [[nodiscard]] double strength(double p, double D, double rate, double T_max) const {
    double const squeezed = p > 0.0 ? p * (1.0 / fc) : 0.0;
    double const friction = (D < 1.0 ? B : residual * B) * pow_nonnegative(squeezed, N);
    double const cohesion = A * (1.0 - D);
    double const stretched = cohesion + A * p * (1.0 / T_max);
    double const pulled = stretched > 0.0 ? stretched : 0.0;
    double const normalised = (p < 0.0 ? pulled : cohesion + friction) * rate;
    return fc * (normalised < S_max ? normalised : S_max);
  }

  /// Plastic strain to fracture at the pressure p [Pa].
  [[nodiscard]] double failure_strain(double p) const {
    double const x = (p + T) * (1.0 / fc);
    double const ef = D1 * pow_nonnegative(x, D2);
    return ef > ef_min ? ef : ef_min;
  }
};

}  // namespace brisance::material
