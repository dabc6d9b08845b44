#include "exact_sedov.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "exact_riemann.hpp"

namespace brisance::exact {

namespace {

/// Below this y the profile is that of the centre for every purpose.
constexpr double y_centre = -2000.0;

}  // namespace

Sedov::Profile Sedov::profile(double y) const {
  // [KammTimmes07], standard case, for uniform density (omega = 0): x1 = a V, x2 = b (c V - 1), x3 = d (1 - e V), x4 =
  // b (1 - c V / gamma).
  double const j = j_;
  double const g = gamma_;
  double const a = (j + 2.0) * (g + 1.0) / 4.0;
  double const b = (g + 1.0) / (g - 1.0);
  double const c = (j + 2.0) * g / 2.0;
  double const d = (j + 2.0) * (g + 1.0) / ((j + 2.0) * (g + 1.0) - 2.0 * (2.0 + j * (g - 1.0)));
  double const e = (2.0 + j * (g - 1.0)) / 2.0;
  double const exponent0 = 2.0 / (j + 2.0);
  double const exponent2 = -(g - 1.0) / (2.0 * (g - 1.0) + j);
  double const exponent1 =
      (j + 2.0) * g / (2.0 + j * (g - 1.0)) * (2.0 * j * (2.0 - g) / (g * (j + 2.0) * (j + 2.0)) - exponent2);
  double const exponent3 = j / (2.0 * (g - 1.0) + j);
  double const exponent4 = exponent1 * (j + 2.0) / (2.0 - g);
  double const exponent5 = -2.0 / (2.0 - g);

  double const x2 = std::exp(y);
  double const v = (1.0 + x2 / b) / c;
  double const x1 = a * v;
  double const x3 = d * (1.0 - e * v);
  double const x4 = b * (1.0 - c * v / g);

  Profile s;
  s.lambda = std::pow(x1, -exponent0) * std::exp(-exponent2 * y) * std::pow(x3, -exponent1);
  s.u = x1 * s.lambda;
  s.rho = std::exp(exponent3 * y) * std::pow(x3, exponent4) * std::pow(x4, exponent5);
  s.p = std::pow(x1, exponent0 * j) * std::pow(x3, exponent4 - 2.0 * exponent1) * std::pow(x4, 1.0 + exponent5);
  return s;
}

Sedov::Profile Sedov::profile_at(double lambda) const {
  if (lambda <= profile(y_centre).lambda) return profile(y_centre);
  return profile(bracketed_root([&](double y) { return profile(y).lambda - lambda; }, y_centre, 0.0));
}

Sedov::Sedov(int dimensions, double gamma, double energy, double density)
    : j_(dimensions), gamma_(gamma), energy_(energy), density_(density) {
  if (dimensions < 1 || dimensions > 3 || !(gamma > 1.0) || !(gamma < 7.0) || std::abs(gamma - 2.0) < 1e-6) {
    throw std::domain_error("Sedov: 1 <= dimensions <= 3 and 1 < gamma < 7, gamma not 2, expected");
  }
  // Energy behind the front over density R^(j + 2) / t^2. Front: speed D = 2 R / ((j + 2) t), rho = density (gamma + 1)
  // / (gamma - 1), u = 2 D / (gamma + 1), p = 2 density D^2 / (gamma + 1).
  double const front_speed_squared = std::pow(2.0 / (j_ + 2.0), 2);
  double const kinetic = 2.0 / ((gamma + 1.0) * (gamma - 1.0)) * front_speed_squared;
  double const internal = 2.0 / ((gamma + 1.0) * (gamma - 1.0)) * front_speed_squared;
  // The integrand is smooth in lambda but for powers at the centre, where it vanishes or is flat: Simpson's rule on
  // lambda = s^2.
  constexpr int intervals = 4000;
  double sum = 0.0;
  for (int i = 0; i <= intervals; ++i) {
    double const s = static_cast<double>(i) / intervals;
    double const lambda = s * s;
    double const weight = i == 0 || i == intervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    Profile const at = lambda < 1.0 ? profile_at(lambda) : profile(0.0);
    sum += weight * (kinetic * at.rho * at.u * at.u + internal * at.p) * std::pow(lambda, j_ - 1) * 2.0 * s;
  }
  double const surface = j_ == 3 ? 4.0 * std::numbers::pi : (j_ == 2 ? 2.0 * std::numbers::pi : 1.0);
  alpha_ = surface * sum / (3.0 * intervals);
}

double Sedov::front_radius(double t) const { return std::pow(energy_ * t * t / (alpha_ * density_), 1.0 / (j_ + 2.0)); }

double Sedov::front_speed(double t) const { return 2.0 * front_radius(t) / ((j_ + 2.0) * t); }

Sedov::State Sedov::at(double r, double t) const {
  double const lambda = r / front_radius(t);
  if (lambda > 1.0) return {density_, 0.0, 0.0};
  Profile const s = profile_at(lambda);
  double const speed = front_speed(t);
  return {s.rho * density_ * (gamma_ + 1.0) / (gamma_ - 1.0), s.u * 2.0 * speed / (gamma_ + 1.0),
          s.p * 2.0 * density_ * speed * speed / (gamma_ + 1.0)};
}

}  // namespace brisance::exact
