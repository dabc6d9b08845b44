/// Amounts of a gas of several fluids.
#pragma once

#include "core/vec.hpp"
#include "material/primitive.hpp"

namespace brisance::material {

/// Mass of each fluid, momentum and energy: of a cell, a face, a whole domain, or of what is under way between two
/// places, then of either sign. What `energy` counts, and what all is per, is told where amounts are kept.
struct Amounts {
  PerFluid mass{};               ///< of each fluid [kg]
  Vec3 momentum{0.0, 0.0, 0.0};  ///< [kg m/s]
  double energy = 0.0;           ///< [J]
  double volume = 0.0;           ///< that this gas fills, where that is kept [m3]

  /// Mass of all fluids [kg].
  [[nodiscard]] double total() const {
    double sum = mass[0];
    for (int k = 1; k < most_fluids; ++k) sum += mass[k];
    return sum;
  }
  void add(Amounts const& other, double factor = 1.0);
};

}  // namespace brisance::material
