/// Von Mises plasticity, perfect or with linear isotropic hardening: sigma_y = yield + hardening * ep.
#pragma once

#include <array>

#include "core/parameter.hpp"

namespace brisance::material {

struct VonMises {
  double G = 80e9;         ///< shear modulus [Pa]
  double yield = 300e6;    ///< yield stress of the virgin material [Pa]
  double hardening = 0.0;  ///< plastic modulus d sigma_y / d ep [Pa]: E Et / (E - Et) for a tangent modulus Et

  static constexpr char const* name = "von_mises";
  static constexpr bool deviatoric = true;
  static constexpr bool plastic = true;
  static constexpr auto parameters() {
    return std::array{Parameter<VonMises>{"G", "Pa", &VonMises::G, 1.0, 1e13, "shear modulus"},
                      Parameter<VonMises>{"yield", "Pa", &VonMises::yield, 0.0, 1e12, "yield stress"},
                      Parameter<VonMises>{"hardening", "Pa", &VonMises::hardening, 0.0, 1e13,
                                          "plastic modulus, d sigma_y / d eps_p (0: perfectly plastic)", 0.0}};
  }

  [[nodiscard]] double shear_modulus() const { return G; }
  [[nodiscard]] double first_yield() const { return yield; }

  /// Yield stress [Pa] at equivalent plastic strain ep.
  [[nodiscard]] double yield_stress(double ep) const { return yield + hardening * ep; }

  /// Increment of equivalent plastic strain that brings a trial Mises stress q [Pa] back to the yield surface (radial
  /// return [Wilkins64], closed form); 0 where q does not exceed it.
  [[nodiscard]] double plastic_increment(double q, double ep) const {
    double const excess = q - yield_stress(ep);
    return (excess > 0.0 ? excess : 0.0) * (1.0 / (3.0 * G + hardening));
  }
};

}  // namespace brisance::material
