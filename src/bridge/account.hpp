/// Amounts of gas, and counts of what went between gas and points.
#pragma once

#include <array>

#include "grid/geometry.hpp"

namespace brisance::bridge {

/// An amount of gas that is under way between gas and points, of either sign.
struct Account {
  std::array<double, 2> mass{0.0, 0.0};  ///< of the two fluids [kg]
  Vec3 momentum{0.0, 0.0, 0.0};          ///< [kg m/s]
  double energy = 0.0;                   ///< [J]
  double volume = 0.0;                   ///< that this gas fills [m3]

  [[nodiscard]] double total() const { return mass[0] + mass[1]; }
  void add(Account const& other, double factor = 1.0);
};

/// Counts since the start.
struct Traffic {
  long born = 0;  ///< points
  long left = 0;
  Account outflow;             ///< left the region through open boundaries of the domain, less what came in
  double pressure_work = 0.0;  ///< of the pressure at the region's faces, by the gas fluxes, into the region [J]
  Vec3 pressure_impulse{0.0, 0.0, 0.0};  ///< likewise [kg m/s]
};

}  // namespace brisance::bridge
