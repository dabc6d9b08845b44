/// Drucker-Prager plasticity with tension cut-off, [Cui14] Eqs. (59)-(63), [Itasca05]. With tau = sqrt(J2) and the mean
/// stress s_m (tension positive):
///     shear    tau + q s_m <= k,   q = 6 sin(phi) / (sqrt3 (3 - sin phi)),  k = 6 c cos(phi) / (sqrt3 (3 - sin phi)),
///     tension  s_m <= s_t, s_t not beyond the apex k / q,
/// with the friction angle phi and cohesion c: the cone that touches Mohr and Coulomb's pyramid at triaxial
/// compression. The flow in shear is that of the dilation angle psi, in tension along s_m; the line h = 0 decides
/// between the two, and what a shear return leaves beyond the tension plane goes to the corner.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "core/parameter.hpp"

namespace brisance::material {

struct DruckerPrager {
  double G = 38.5e6;        ///< shear modulus [Pa]
  double cohesion = 0.1e6;  ///< c [Pa]
  double friction = 30.0;   ///< phi [degrees]
  double dilation = 0.0;    ///< psi [degrees]
  double tension = 0.0;     ///< largest mean tension [Pa]

  static constexpr char const* name = "drucker_prager";
  static constexpr bool deviatoric = true;
  static constexpr bool plastic = true;
  static constexpr bool pressure_dependent = true;
  static constexpr auto parameters() {
    using P = Parameter<DruckerPrager>;
    return std::array{
        P{"G", "Pa", &DruckerPrager::G, 1.0, 1e13, "shear modulus"},
        P{"cohesion", "Pa", &DruckerPrager::cohesion, 0.0, 1e12, "cohesion c"},
        P{"friction", "deg", &DruckerPrager::friction, 0.0, 89.0, "angle of friction"},
        P{"dilation", "deg", &DruckerPrager::dilation, 0.0, 89.0, "angle of dilation, at most the angle of friction",
          0.0},
        P{"tension", "Pa", &DruckerPrager::tension, 0.0, 1e13,
          "maximum mean tension, unless the apex of the cone is reached first", 0.0},
    };
  }

  [[nodiscard]] double shear_modulus() const { return G; }
  [[nodiscard]] double first_yield() const { return std::numbers::sqrt3 * k(); }

  /// Slope q of the cone that touches the pyramid of an angle [degrees].
  [[nodiscard]] static double slope(double degrees) {
    double const s = std::sin(degrees * std::numbers::pi / 180.0);
    return 6.0 * s / (std::numbers::sqrt3 * (3.0 - s));
  }
  [[nodiscard]] double k() const {
    double const angle = friction * std::numbers::pi / 180.0;
    return 6.0 * cohesion * std::cos(angle) / (std::numbers::sqrt3 * (3.0 - std::sin(angle)));
  }
  /// s_t [Pa].
  [[nodiscard]] double tensile_strength() const {
    double const q = slope(friction);
    return q > 0.0 && k() < q * tension ? k() / q : tension;
  }

  struct State {
    double tau;   ///< sqrt(J2) [Pa]
    double mean;  ///< mean stress, tension positive [Pa]
  };

  /// The constants of the return, found once for a loop over particles.
  struct Cone {
    double q, q_flow, k, s_t, G, K, tau_p, alpha_p, per_flow;

    /// From the elastic trial state back to the surface.
    [[nodiscard]] State returned(double tau, double mean) const {
      double const excess = tau + q * mean - k;
      double const h = tau - tau_p - alpha_p * (mean - s_t);
      bool const tears = mean > s_t && h <= 0.0;
      double const multiplier = excess > 0.0 && !tears ? excess * per_flow : 0.0;
      double const slid = tau - G * multiplier;
      double const opened = mean - K * q_flow * multiplier;
      double const end = opened < s_t ? opened : s_t;
      // On the plane the shear is at most that of the corner, tau_p: there both multipliers are positive.
      return {opened < s_t ? slid : (tau < tau_p ? tau : tau_p), end};
    }
  };
  /// `K` is the bulk modulus [Pa].
  [[nodiscard]] Cone cone(double K) const {
    double const q = slope(friction);
    double const q_flow = slope(dilation);
    double const s_t = tensile_strength();
    return {q, q_flow, k(), s_t, G, K, k() - q * s_t, std::sqrt(1.0 + q * q) - q, 1.0 / (G + K * q * q_flow)};
  }
};

}  // namespace brisance::material
