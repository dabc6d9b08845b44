/// The closed list of strength models and what all of them share.
///
/// Contract. Every model is a trivially copyable value with a parameter table, the two flags `deviatoric` (a particle
/// carries deviatoric stress) and `plastic` (it can yield), and shear_modulus() [Pa]. A plastic model adds the scalar
/// functions of its return mapping; the loops over particles stand in stress.cpp, those of the two models whose
/// strength depends on the pressure in stress_concrete.cpp and stress_soil.cpp.
#pragma once

#include <variant>

#include "material/strength/drucker_prager.hpp"
#include "material/strength/elastic.hpp"
#include "material/strength/hjc.hpp"
#include "material/strength/johnson_cook.hpp"
#include "material/strength/none.hpp"
#include "material/strength/von_mises.hpp"

namespace brisance::material {

using Strength = std::variant<NoStrength, Elastic, VonMises, JohnsonCook, Hjc, DruckerPrager>;

/// Shear modulus [Pa].
[[nodiscard]] inline double shear_modulus(Strength const& strength) {
  return std::visit([](auto const& model) { return model.shear_modulus(); }, strength);
}

}  // namespace brisance::material
