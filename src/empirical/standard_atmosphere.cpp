#include "empirical/standard_atmosphere.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"

namespace brisance::empirical {

namespace {

// Constants of ISO 2533.
constexpr double gravity = 9.80665;         // [m/s2]
constexpr double gas_constant = 287.05287;  // of air [J/(kg K)]
constexpr double gamma = 1.4;
constexpr double earth_radius = 6356766.0;  // [m], with which the gravity falls with the height

/// A layer in which the temperature is linear in the geopotential height.
struct Layer {
  double base;      // geopotential height [m]
  double gradient;  // [K/m]
};
constexpr Layer layers[] = {{0.0, -6.5e-3}, {11000.0, 0.0}, {20000.0, 1e-3}};

}  // namespace

AirState standard_atmosphere(double altitude) {
  if (!(altitude >= lowest_altitude && altitude <= highest_altitude)) {
    throw InputError(fmt::format("the standard atmosphere is defined from {:g} m to {:g} m, not at {:g} m",
                                 lowest_altitude, highest_altitude, altitude));
  }
  double const height = earth_radius * altitude / (earth_radius + altitude);  // geopotential
  AirState air;
  // From layer to layer: hydrostatic equilibrium of an ideal gas. The lowest layer goes on below the sea.
  for (Layer const& layer : layers) {
    bool const last = &layer == &layers[2] || height < (&layer + 1)->base;
    double const top = last ? height : (&layer + 1)->base;
    double const rise = top - layer.base;
    double const above = air.temperature + layer.gradient * rise;
    double const exponent = gravity / gas_constant;
    air.pressure *= layer.gradient == 0.0 ? std::exp(-exponent * rise / air.temperature)
                                          : std::pow(above / air.temperature, -exponent / layer.gradient);
    air.temperature = above;
    if (last) break;
  }
  air.density = air.pressure / (gas_constant * air.temperature);
  air.sound_speed = std::sqrt(gamma * gas_constant * air.temperature);
  return air;
}

}  // namespace brisance::empirical
