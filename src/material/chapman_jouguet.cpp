#include "material/chapman_jouguet.hpp"

#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace brisance::material {

namespace {

/// Products' Hugoniot from the unreacted explosive (p = 0, V = 1, E = E0): E_H = E0 + p_H (1 - V) / 2.
/// Put into p = f + w E / V it is linear in p_H. Infinite where the compression exceeds the strongest possible shock.
double hugoniot_pressure(Jwl const& products, double energy, double v) {
  double const half_width = 0.5 * products.omega * (1.0 - v) / v;
  if (half_width >= 1.0) return std::numeric_limits<double>::infinity();
  return (products.reference(products.rho0 / v) + products.omega * energy / v) / (1.0 - half_width);
}

/// rho c^2 minus its value in sonic flow behind a front with this state, p V / (1 - V). Positive on the branch of
/// overdriven (subsonic) states, negative on that of weak ones, zero at the Chapman-Jouguet point.
double sonic_residual(Jwl const& products, double energy, double v) {
  double const p = hugoniot_pressure(products, energy, v);
  return bulk_modulus(products, products.rho0 / v, p) - p * v / (1.0 - v);
}

}  // namespace

ChapmanJouguet chapman_jouguet(Jwl const& products, double energy) {
  // The Hugoniot has a pole at V = w / (2 + w), and p_H / (1 - V) grows without limit there and at V = 1. A scan finds
  // the lowest point between them, whatever the constants; the sonic condition then has exactly one sign change next to
  // it.
  double const pole = products.omega / (2.0 + products.omega);
  constexpr int samples = 4000;
  double const spacing = (1.0 - pole) / samples;
  double lowest = std::numeric_limits<double>::infinity();
  double at_lowest = 0.0;
  for (int i = 1; i < samples; ++i) {
    double const v = pole + i * spacing;
    double const slope = hugoniot_pressure(products, energy, v) / (1.0 - v);
    if (slope > 0.0 && slope < lowest) {
      lowest = slope;
      at_lowest = v;
    }
  }
  double compressed = at_lowest - spacing;
  double expanded = at_lowest + spacing;
  bool const bracketed = std::isfinite(lowest) && compressed > pole && expanded < 1.0 &&
                         sonic_residual(products, energy, compressed) > 0.0 &&
                         sonic_residual(products, energy, expanded) < 0.0;
  if (!bracketed) throw InputError("there is no Chapman-Jouguet state for the JWL constants and the energy");

  for (;;) {
    double const middle = 0.5 * (compressed + expanded);
    if (middle <= compressed || middle >= expanded) break;
    (sonic_residual(products, energy, middle) > 0.0 ? compressed : expanded) = middle;
  }

  ChapmanJouguet state;
  double const v = 0.5 * (compressed + expanded);
  state.relative_volume = v;
  state.pressure = hugoniot_pressure(products, energy, v);
  state.density = products.rho0 / v;
  state.speed = std::sqrt(state.pressure / (products.rho0 * (1.0 - v)));
  state.particle_velocity = state.speed * (1.0 - v);
  state.sound_speed = sound_speed(products, state.density, state.pressure);
  state.specific_energy = internal_energy(products, state.density, state.pressure);
  return state;
}

bool ChapmanJouguetCheck::consistent() const {
  return std::abs(speed_deviation) <= speed_tolerance && std::abs(pressure_deviation) <= cj_pressure_tolerance;
}

ChapmanJouguetCheck check(Explosive const& explosive) {
  ChapmanJouguetCheck result;
  result.state = chapman_jouguet(explosive.products, explosive.energy);
  result.speed_deviation = result.state.speed / explosive.detonation_speed - 1.0;
  result.pressure_deviation = result.state.pressure / explosive.cj_pressure - 1.0;
  return result;
}

}  // namespace brisance::material
