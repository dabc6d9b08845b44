/// Tensile damage of concrete by growing micro-cracks, [Cui14] Eq. (58):
///     dD_t/dt = a D_t (1 - D_t) (s / sigma0 - 1)^gamma  where  s > sigma0,  from a seed D_t(0).
/// s is the largest principal stress between the cracks: that of the particle over 1 - D_t. (With the stress of the
/// particle itself the growth would end, and a tension sigma0 remain for ever, as soon as the damage has brought it
/// down there.) At a constant s the equation is logistic, D / (1 - D) grows exponentially; it is integrated so, which
/// is stable for any time step. Cracks of which 1 - D_t < `open` have joined: D_t = 1.
///
/// The rate law knows no length: the energy of a crack would be proportional to the cell. With a fracture energy G_f
/// the damage, once the softening has reached the stress of the particle, grows no faster than a crack opens,
///     d D_t = (1 - D_t) (sigma0 h / G_f) d e_open,
/// so that the stress falls as exp(-sigma0 w / G_f) with the opening w = h e_open: a crack band [BazantOh83] whose
/// energy is G_f where the fall begins at sigma0, and larger in proportion where the rate has raised the strength.
#pragma once

#include <array>

#include "core/math.hpp"
#include "core/parameter.hpp"

namespace brisance::material {

struct TensileDamage {
  double a = 1e4;                ///< rate of growth [1/s]
  double sigma0 = 3e6;           ///< threshold stress [Pa]
  double gamma = 1.0;            ///< exponent of the excess
  double seed = 0.01;            ///< D_t at the start
  double T_max = 30e6;           ///< mean tension that no rate exceeds [Pa]
  double fracture_energy = 0.0;  ///< G_f [J/m2]; 0: the rate law alone

  static constexpr char const* name = "tensile_damage";
  static constexpr bool damages = false;  ///< plastic strain has no part in it
  static constexpr auto parameters() {
    using P = Parameter<TensileDamage>;
    return std::array{
        P{"a", "1/s", &TensileDamage::a, 1e-6, 1e12, "growth rate a"},
        P{"sigma0", "Pa", &TensileDamage::sigma0, 1.0, 1e12, "threshold stress sigma_0"},
        P{"gamma", "1", &TensileDamage::gamma, 0.01, 20.0, "exponent gamma of the excess stress"},
        P{"seed", "1", &TensileDamage::seed, 1e-12, 0.5, "initial damage D_t(0)", 0.01},
        P{"T_max", "Pa", &TensileDamage::T_max, 1.0, 1e12,
          "mean tension that is never exceeded at any strain rate; replaces T of the strength model"},
        P{"fracture_energy", "J/m2", &TensileDamage::fracture_energy, 0.0, 1e9,
          "fracture energy G_f of the crack band (0: none)", 0.0},
    };
  }

  /// Smallest 1 - D_t: below, the cracks have joined.
  static constexpr double open = 0.01;

  /// D_t after the time dt [s] under the stress s [Pa] between the cracks.
  [[nodiscard]] double grown(double D, double s, double dt) const {
    double const before = D > seed ? D : seed;
    double const excess = s * (1.0 / sigma0) - 1.0;
    if (!(excess > 0.0) || before >= 1.0) return D;
    double const odds = before / (1.0 - before) * exp_bounded(a * dt * pow_nonnegative(excess, gamma));
    return odds / (1.0 + odds);
  }
};

}  // namespace brisance::material
