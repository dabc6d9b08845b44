/// Elastic shear response without yielding (hypoelastic, Jaumann rate).
#pragma once

#include <array>

#include "core/parameter.hpp"

namespace brisance::material {

struct Elastic {
  double G = 80e9;  ///< shear modulus [Pa]

  static constexpr char const* name = "elastic";
  static constexpr bool deviatoric = true;
  static constexpr bool plastic = false;
  static constexpr auto parameters() {
    return std::array{Parameter<Elastic>{"G", "Pa", &Elastic::G, 1.0, 1e13, "shear modulus"}};
  }

  [[nodiscard]] double shear_modulus() const { return G; }
};

}  // namespace brisance::material
