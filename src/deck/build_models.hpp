/// Models from the tables of decks and material files, by the closed lists of core/models.hpp.
#pragma once

#include <optional>
#include <string>

#include "core/models.hpp"
#include "deck/reader.hpp"

namespace brisance::deck {

/// The model's parameters from the table; false when one is missing or wrong.
template <class Model>
bool fill(Model& model, Section const& section) {
  bool complete = true;
  for (auto const& p : Model::parameters()) {
    auto const value = section.number(p.key);
    if (value) {
      model.*p.member = *value;
    } else {
      complete = false;
    }
  }
  return complete;
}

/// The model of the list with this name, with the numbers of the section; none where they are not complete.
template <class List>
std::optional<List> filled(std::string const& word, Section const& section) {
  std::optional<List> out;
  for_each_model<List>([&]<class Model>() {
    Model model;
    if (word == Model::name && fill(model, section)) out = model;
  });
  return out;
}

}  // namespace brisance::deck
