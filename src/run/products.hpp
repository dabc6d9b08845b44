/// Explosives of bodies whose products are gas of the MPM region.
#pragma once

#include <string>

#include "case/case.hpp"

namespace brisance::run {

struct Region;

/// Number of the fluid that the products of a body become as it burns: an explosive in an MPM region whose gas knows
/// them. 0: they become none.
[[nodiscard]] int products_of(Case const& setup, Body const& body);
/// A fluid of the gas in messages.
[[nodiscard]] std::string fluid_in_words(Case const& setup, int fluid);
/// What has burnt of the explosives in an MPM region becomes gas.
void hand_over_products(Case const& setup, Region& region);

}  // namespace brisance::run
