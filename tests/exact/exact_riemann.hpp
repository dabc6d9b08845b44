/// Exact solution of the Riemann problem between two materials, each with any equation of state of `material/eos`.
/// Follows [Toro09] ch. 4 and [Godunov59] in idea; shock and rarefaction curves are computed for the general equation
/// of state: a shock from its Hugoniot relation, a rarefaction by integrating its isentrope.
#pragma once

#include <cmath>
#include <vector>

#include "material/eos/eos.hpp"

namespace brisance::exact {

struct State {
  double rho = 0.0;  ///< [kg/m3]
  double u = 0.0;    ///< [m/s]
  double p = 0.0;    ///< [Pa]
};

/// Solves f(x) = 0 between a and b, where f changes sign, to the last bits of x [Chandrupatla97].
template <class F>
double bracketed_root(F const& f, double a, double b);

/// One side of the problem: everything that a wave running to the left into a material at rest or in motion can do to
/// it.
class Side {
 public:
  /// `ahead` in the frame in which the wave runs to the left.
  Side(material::Eos const& eos, State const& ahead);

  /// State behind the wave that brings the material to pressure p.
  [[nodiscard]] State behind(double p) const;

  /// Lowest pressure that a rarefaction can reach before the density is e^-60 of the initial one or the material loses
  /// its sound speed. Integrates the isentrope as far as that.
  double lowest_pressure();

  /// Integrates the isentrope at least down to p, so that `behind(p)` and `fan` may be called there. False where it
  /// does not get there.
  bool reach(double p);

  /// The state inside the rarefaction fan where u - c equals the given speed, between head and tail.
  [[nodiscard]] State fan(double speed) const;

  [[nodiscard]] double sound_speed(State const& s) const { return material::sound_speed(eos_, s.rho, s.p); }

 private:
  /// Particle of the isentrope at x = ln(rho / rho_ahead) = -index * step.
  struct Node {
    double p = 0.0;
    double phi = 0.0;  ///< integral of c dx from 0 [m/s]; the velocity is u_ahead - phi
  };

  [[nodiscard]] bool valid(double rho, double p) const;
  [[nodiscard]] Node advance(Node const& from, double x, double dx) const;
  [[nodiscard]] State state(Node const& node, double x) const;
  [[nodiscard]] double shock_density(double p) const;
  [[nodiscard]] double hugoniot_residual(double rho, double p) const;

  material::Eos eos_;
  State ahead_;
  double energy_;  ///< specific internal energy ahead [J/kg]
  std::vector<Node> isentrope_;
  bool ended_ = false;
};

class Riemann {
 public:
  /// A wave of the solution; head and tail coincide in a shock.
  struct Wave {
    bool shock = false;
    double head = 0.0;  ///< speed of the edge towards the undisturbed state [m/s]
    double tail = 0.0;  ///< speed of the edge towards the contact [m/s]
  };
  struct Sample {
    State s;
    bool left_material = true;
  };

  /// Throws std::domain_error when the materials separate (vacuum, or a liquid torn apart).
  Riemann(material::Eos const& left_eos, State const& left, material::Eos const& right_eos, State const& right);

  double p_star = 0.0;
  double u_star = 0.0;
  double rho_star_l = 0.0;
  double rho_star_r = 0.0;
  Wave left_wave;
  Wave right_wave;

  /// The solution at (x - x_interface) / t [m/s].
  [[nodiscard]] Sample at(double x_over_t) const;

 private:
  State left_;
  State right_mirrored_;
  Side left_side_;
  Side right_side_;  ///< in the mirrored frame
  State left_star_;
  State right_star_mirrored_;
};

template <class F>
double bracketed_root(F const& f, double a, double b) {
  double fa = f(a);
  double fb = f(b);
  if (fa == 0.0) return a;
  if (fb == 0.0) return b;
  double c = a;
  double fc = fa;
  double t = 0.5;
  // Bisection alone ends within 2100 halvings of any two doubles.
  for (int i = 0; i < 2200; ++i) {
    double const x = a + t * (b - a);
    double const fx = f(x);
    if (fx == 0.0) return x;
    if ((fx > 0.0) == (fa > 0.0)) {
      c = a;
      fc = fa;
    } else {
      c = b;
      fc = fb;
      b = a;
      fb = fa;
    }
    a = x;
    fa = fx;
    double const best = std::abs(fa) < std::abs(fb) ? a : b;
    double const tolerance = 2e-16 * std::abs(best) + 1e-300;
    double const least = tolerance / std::abs(b - a);
    if (least > 0.5) return best;
    // Inverse quadratic interpolation where the three particles allow it, otherwise halving.
    double const xi = (a - b) / (c - b);
    double const phi = (fa - fb) / (fc - fb);
    t = 0.5;
    if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi) {
      t = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb);
    }
    t = t < least ? least : (t > 1.0 - least ? 1.0 - least : t);
  }
  return a;
}

}  // namespace brisance::exact
