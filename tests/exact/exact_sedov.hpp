/// Self-similar strong particle, line or plane blast in an ideal gas of uniform density and negligible pressure
/// [Sedov59], closed form as written by [KammTimmes07].
#pragma once

namespace brisance::exact {

class Sedov {
 public:
  struct State {
    double rho = 0.0;  ///< [kg/m3]
    double u = 0.0;    ///< radial velocity [m/s]
    double p = 0.0;    ///< [Pa]
  };

  /// `dimensions`: 1 planar, 2 cylindrical, 3 spherical. `energy`: the total released [J]; for a line per length [J/m];
  /// for a plane per area [J/m2] and into one of the two sides only. `density`: of the undisturbed gas [kg/m3]. Throws
  /// std::domain_error unless 1 < gamma < 7 and gamma is not 2, where the closed form divides by zero.
  Sedov(int dimensions, double gamma, double energy, double density);

  /// Dimensionless energy: R = (energy t^2 / (alpha density))^(1/(dimensions + 2)).
  [[nodiscard]] double alpha() const { return alpha_; }
  [[nodiscard]] double front_radius(double t) const;  ///< [m]
  [[nodiscard]] double front_speed(double t) const;   ///< [m/s]

  /// State at radius r > 0 and time t > 0.
  [[nodiscard]] State at(double r, double t) const;

 private:
  /// State relative to that right behind the front, at r / R = lambda.
  struct Profile {
    double lambda = 0.0;
    double rho = 0.0;
    double u = 0.0;
    double p = 0.0;
  };
  /// At the similarity variable y = ln(x2): 0 at the front, minus infinity at the centre.
  [[nodiscard]] Profile profile(double y) const;
  [[nodiscard]] Profile profile_at(double lambda) const;

  int j_;
  double gamma_;
  double energy_;
  double density_;
  double alpha_ = 0.0;
};

}  // namespace brisance::exact
