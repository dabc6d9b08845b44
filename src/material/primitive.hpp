/// The state of a gas as people think of it: from the deck to the dump it is this one type.
#pragma once

#include <array>

#include "core/vec.hpp"

namespace brisance::material {

/// Fluids of a run at most. Number 0 is the ambient one.
inline constexpr int most_fluids = 2;

/// The fluid that detonation products are: it burns and burns on.
inline constexpr int products_fluid = 1;

/// A value for each fluid.
using PerFluid = std::array<double, most_fluids>;

/// Fractions of a mixture: the ambient fluid has what the others leave of 1.
class Fractions {
 public:
  [[nodiscard]] constexpr double operator[](int fluid) const {
    if (fluid > 0) return others_[fluid - 1];
    double rest = 1.0;
    for (double const other : others_) rest -= other;
    return rest;
  }
  /// Of a fluid from number 1 on.
  constexpr void set(int fluid, double fraction) { others_[fluid - 1] = fraction; }

  /// So much of one fluid, and ambient fluid.
  [[nodiscard]] static constexpr Fractions of(int fluid, double fraction) {
    Fractions fractions;
    if (fluid > 0) fractions.set(fluid, fraction);
    return fractions;
  }

  /// In a checkpoint.
  template <class Archive>
  void archive(Archive& a) {
    a(others_);
  }

 private:
  std::array<double, most_fluids - 1> others_{};
};

/// State of a gas, of one fluid or of a mixture. By default standard air.
struct Primitive {
  double density = 1.225;      ///< of the mixture [kg/m3]
  double pressure = 101325.0;  ///< [Pa]
  Vec3 velocity{0.0, 0.0, 0.0};
  Fractions mass_fraction{};
  Fractions volume_fraction{};
  double sound_speed = 0.0;  ///< frozen [m/s]; where it was read from a cell or particles
  double energy = 0.0;       ///< total, per volume [J/m3]; likewise
};

/// The state of a fluid alone.
[[nodiscard]] constexpr Primitive only(int fluid, Primitive state) {
  state.mass_fraction = Fractions::of(fluid, 1.0);
  state.volume_fraction = Fractions::of(fluid, 1.0);
  return state;
}

}  // namespace brisance::material
