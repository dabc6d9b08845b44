/// What `brisance check` says about the numbers of materials.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "deck/deck.hpp"

namespace brisance::app {

/// A table of every number of every material, in SI units, with what the deck says.
[[nodiscard]] std::string materials_text(std::vector<deck::MaterialNumbers> const& materials);

/// The same by name: {"sand": {"library": false, "parameters": {"density": {"value", "unit", "deck"}}}}.
[[nodiscard]] nlohmann::json materials_json(std::vector<deck::MaterialNumbers> const& materials);

}  // namespace brisance::app
