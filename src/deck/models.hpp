/// Models of decks and material files by the closed lists of core/models.hpp: their keys, and the models that a table
/// makes.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/models.hpp"
#include "deck/keys.hpp"
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

/// The parameter table of a model as keys of the schema.
template <class Model>
std::vector<Key> parameter_keys() {
  std::vector<Key> keys;
  for (auto const& p : Model::parameters()) {
    Key key = number(std::string(p.key), std::string(p.unit), p.minimum, p.maximum);
    key.means(std::string(p.meaning));
    Model const model{};
    key.like(fmt::format("{}", model.*p.member));
    if (std::isnan(p.default_value)) {
      key.required();
    } else {
      key.of(p.default_value);
    }
    keys.push_back(std::move(key));
  }
  return keys;
}

/// Which models of a list a table takes.
struct Every {
  template <class Model>
  static constexpr bool takes = true;
};

/// The names of a list's models; "none" comes last.
template <class List, class Which = Every>
std::vector<std::string> model_names() {
  std::vector<std::string> names;
  for_each_model<List>([&]<class Model>() {
    if (Which::template takes<Model>) names.emplace_back(Model::name);
  });
  std::stable_partition(names.begin(), names.end(), [](std::string const& name) { return name != "none"; });
  return names;
}

/// The key that chooses a model of a list.
template <class List>
Key model_word(std::string name) {
  Key key = word(std::move(name), model_names<List>());
  for_each_model<List>([&]<class Model>() {
    if constexpr (requires { Model::meaning; }) key.add_meaning(Model::name, Model::meaning);
  });
  return key;
}

/// The keys of each model of a list.
template <class List, class Which = Every>
std::map<std::string, std::vector<Key>> keys_of_models() {
  std::map<std::string, std::vector<Key>> keys;
  for_each_model<List>([&]<class Model>() {
    if (Which::template takes<Model>) keys[Model::name] = parameter_keys<Model>();
  });
  return keys;
}

}  // namespace brisance::deck
