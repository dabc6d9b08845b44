/// No strength: gases, liquids, detonation products. The particle carries no deviatoric stress.
#pragma once

#include <array>

#include "core/parameter.hpp"

namespace brisance::material {

struct NoStrength {
  static constexpr char const* name = "none";
  static constexpr bool deviatoric = false;
  static constexpr bool plastic = false;
  static constexpr auto parameters() { return std::array<Parameter<NoStrength>, 0>{}; }

  [[nodiscard]] double shear_modulus() const { return 0.0; }
};

}  // namespace brisance::material
