/// The closed list of strength models and what all of them share.
///
/// Contract. Every model is a trivially copyable value with a parameter table, the two flags `deviatoric` (a particle
/// carries deviatoric stress) and `plastic` (it can yield), and shear_modulus() [Pa]. A plastic model adds
///     first_yield()             yield stress at the start [Pa], for people
///     plastic_increment(q, ep)  increment of plastic strain that brings the trial Mises stress q [Pa] back to the
///                               yield surface, 0 where q lies within; ep: the plastic strain so far
/// or, where that needs more than q and ep, an overload of plastic_increments in stress_yield.hpp. The models whose
/// strength depends on the pressure have the flag `pressure_dependent` and loops of their own in stress_concrete.cpp
/// and stress_soil.cpp.
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
