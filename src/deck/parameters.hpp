/// What the program understood of a material: every number, with its unit, its meaning and where it is from.
#pragma once

#include <string>
#include <vector>

#include "deck/deck.hpp"
#include "material/material.hpp"

namespace brisance::deck {

class Section;

/// All numbers of a material and the models that they belong to, as they are calculated with.
[[nodiscard]] std::vector<MaterialNumber> numbers_of(material::Explosive const& explosive);
[[nodiscard]] std::vector<MaterialNumber> numbers_of(material::Fluid const& fluid);
[[nodiscard]] std::vector<MaterialNumber> numbers_of(material::Material const& solid);

/// Notes for each number what the deck's own table of the material says about it, and adds what the table gives instead
/// of numbers of the model: E and nu.
void note_origin(std::vector<MaterialNumber>& numbers, Section const& own);

}  // namespace brisance::deck
