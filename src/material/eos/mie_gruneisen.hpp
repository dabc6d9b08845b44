/// Mie-Grueneisen with a cubic shock-velocity Hugoniot, [Cui14] Eqs. (65)-(66):
///     p = p_H (1 - G mu / 2) + G rho e,   mu = rho/rho0 - 1,
///     p_H = rho0 C0^2 [mu + (2S-1) mu^2 + (S-1)(3S-1) mu^3] in compression, rho0 C0^2 mu in expansion.
#pragma once

#include <array>

#include "core/math.hpp"
#include "core/parameter.hpp"

namespace brisance::material {

struct MieGruneisen {
  double rho0 = 7850.0;  ///< stress-free density [kg/m3]
  double C0 = 4569.0;    ///< bulk sound speed [m/s]
  double S = 1.49;       ///< slope of the shock velocity against the particle velocity
  double Gamma = 2.17;   ///< Grueneisen coefficient

  static constexpr char const* name = "mie_gruneisen";
  static constexpr bool bears_tension = true;  ///< can its pressure be negative?
  static constexpr bool of_solids = true;      ///< can `[solids.NAME]` have it?
  static constexpr auto parameters() {
    return std::array{
        Parameter<MieGruneisen>{"rho0", "kg/m3", &MieGruneisen::rho0, 1.0, 1e5, "stress-free density"},
        Parameter<MieGruneisen>{"C0", "m/s", &MieGruneisen::C0, 1.0, 1e5, "bulk sound speed"},
        Parameter<MieGruneisen>{"S", "1", &MieGruneisen::S, 0.0, 10.0,
                                "slope of shock speed Us over particle velocity up"},
        Parameter<MieGruneisen>{"Gamma", "1", &MieGruneisen::Gamma, 0.01, 10.0, "Grueneisen coefficient"}};
  }

  [[nodiscard]] double gruneisen() const { return Gamma; }
  template <class V>
  [[nodiscard]] V reference(V const& rho) const {
    V const mu = rho / rho0 - 1.0;
    return hugoniot(mu) * (1.0 - 0.5 * Gamma * mu);
  }
  template <class V>
  [[nodiscard]] V rho_d_reference(V const& rho) const {
    V const mu = rho / rho0 - 1.0;
    double const k = rho0 * C0 * C0;
    V const squeezed = select(mu > 0.0, mu, V(0.0));
    V const slope =
        k * (1.0 + 2.0 * (2.0 * S - 1.0) * squeezed + 3.0 * (S - 1.0) * (3.0 * S - 1.0) * squeezed * squeezed);
    return (1.0 + mu) * (slope * (1.0 - 0.5 * Gamma * mu) - 0.5 * Gamma * hugoniot(mu));
  }

 private:
  template <class V>
  [[nodiscard]] V hugoniot(V const& mu) const {
    double const k = rho0 * C0 * C0;
    V const squeezed = select(mu > 0.0, mu, V(0.0));
    return k *
           (mu + (2.0 * S - 1.0) * squeezed * squeezed + (S - 1.0) * (3.0 * S - 1.0) * squeezed * squeezed * squeezed);
  }
};

}  // namespace brisance::material
