/// [fluids.NAME]: fluids of the deck and of the library.
#include <fmt/format.h>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/library.hpp"
#include "deck/models.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Settings<material::Fluid> const& settings() {
  using F = material::Fluid;
  static Settings<F> const all{word("eos", model_names<material::Eos>())
                                   .of(material::IdealGas::name)
                                   .like("\"ideal_gas\"")
                                   .means("Equation of state"),
                               {&F::density, density().required().means("Default density, for gases at 288.15 K")},
                               {&F::pressure, pressure().means("Default pressure")}};
  return all;
}

std::map<std::string, std::vector<Key>> fluid_variants() { return keys_of_models<material::Eos>(); }

}  // namespace

Table const& fluids_table() {
  static Table const table{"A fluid defined in the deck, with the name NAME.", joined(settings().keys(), own_keys()),
                           "eos", fluid_variants()};
  return table;
}

Table const& fluid_file_schema() {
  static Table const table{"", joined(file_keys("fluid"), settings().keys()), "eos", fluid_variants()};
  return table;
}

std::optional<material::Fluid> build_fluid(Section const& section, std::string const& name) {
  material::Fluid out;
  out.name = name;
  out.source = section.text("source").value_or("");
  auto const word = section.text("eos");
  if (!settings().read(section, out) || !word) return std::nullopt;
  auto const eos = filled<material::Eos>(*word, section);
  if (!eos) return std::nullopt;
  out.eos = *eos;
  return out;
}

void build_fluids(Draft& draft) {
  draft.each("fluids", [&](Section const& section) {
    auto fluid = build_fluid(section, section.name);
    if (!fluid) {
      wrong_material(draft, section.name);
      return;
    }
    if (library().fluid(section.name) != nullptr) {
      draft.report.warning(section.place, section.path, "replaces the library fluid of the same name");
    }
    draft.materials.fluids.push_back(std::move(*fluid));
  });
}

}  // namespace brisance::deck
