#include "deck/library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "core/error.hpp"
#include "deck/embedded.hpp"
#include "deck/reader.hpp"
#include "deck/schema.hpp"

namespace brisance::deck {

namespace {

bool same_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  });
}

template <class Material>
Material const* find(std::vector<Named<Material>> const& all, std::string_view name) {
  for (auto const& entry : all) {
    if (same_name(entry.material.name, name)) return &entry.material;
  }
  for (auto const& entry : all) {
    for (auto const& alias : entry.aliases) {
      if (same_name(alias, name)) return &entry.material;
    }
  }
  return nullptr;
}

template <class Material>
std::vector<std::string> names_of(std::vector<Named<Material>> const& all) {
  std::vector<std::string> names;
  names.reserve(all.size());
  for (auto const& entry : all) names.push_back(entry.material.name);
  return names;
}

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

template <class Model>
bool fill_if(std::string const& word, material::Eos& eos, Section const& section) {
  if (word != Model::name) return true;
  Model model;
  bool const complete = fill(model, section);
  eos = model;
  return complete;
}

void check(Report const& report, EmbeddedFile const& file) {
  if (!report.failed()) return;
  std::string message = fmt::format("the material file {} of this build is wrong", file.name);
  for (auto const& error : report.errors()) message += fmt::format("\n{}", format(error));
  throw InputError(message);
}

template <class Material>
Named<Material> named(std::optional<Material> material, Section const& section) {
  Named<Material> out{std::move(*material), {}};
  if (auto const* aliases = section.strings("aliases")) out.aliases = *aliases;
  return out;
}

Library load() {
  Library out;
  for (auto const& file : embedded_materials()) {
    // Which of the two schemas holds is known from the text's own `kind`.
    Report as_explosive{std::string(file.name)};
    auto const explosive = read(file.text, explosive_file_schema(), as_explosive);
    if (explosive && explosive->text("kind")) {
      check(as_explosive, file);
      out.explosives.push_back(named(build_explosive(*explosive, *explosive->text("name")), *explosive));
      continue;
    }
    Report as_fluid{std::string(file.name)};
    auto const fluid = read(file.text, fluid_file_schema(), as_fluid);
    check(as_fluid, file);
    out.fluids.push_back(named(build_fluid(*fluid, *fluid->text("name")), *fluid));
  }
  auto const by_name = [](auto const& a, auto const& b) { return a.material.name < b.material.name; };
  std::sort(out.explosives.begin(), out.explosives.end(), by_name);
  std::sort(out.fluids.begin(), out.fluids.end(), by_name);
  return out;
}

}  // namespace

material::Explosive const* Library::explosive(std::string_view name) const { return find(explosives, name); }
material::Fluid const* Library::fluid(std::string_view name) const { return find(fluids, name); }
std::vector<std::string> Library::explosive_names() const { return names_of(explosives); }
std::vector<std::string> Library::fluid_names() const { return names_of(fluids); }

Library const& library() {
  static Library const loaded = load();
  return loaded;
}

std::optional<material::Explosive> build_explosive(Section const& section, std::string const& name) {
  material::Explosive out;
  out.name = name;
  out.source = section.text("source").value_or("");
  auto const energy = section.number("energy");
  auto const speed = section.number("detonation_speed");
  auto const pressure = section.number("cj_pressure");
  if (section.broken("eos") || !fill(out.products, section) || !energy || !speed || !pressure) return std::nullopt;
  out.energy = *energy;
  out.detonation_speed = *speed;
  out.cj_pressure = *pressure;
  if (section.broken("tnt_equivalent")) return std::nullopt;
  if (name == "TNT") out.tnt_equivalent_pressure = out.tnt_equivalent_impulse = 1.0;
  if (auto const* equivalent = section.section("tnt_equivalent")) {
    if (equivalent->broken("pressure") || equivalent->broken("impulse")) return std::nullopt;
    if (auto const by_pressure = equivalent->number("pressure")) out.tnt_equivalent_pressure = by_pressure;
    if (auto const by_impulse = equivalent->number("impulse")) out.tnt_equivalent_impulse = by_impulse;
    auto const source = equivalent->text("source").value_or("");
    if (!source.empty()) out.source += fmt::format("; TNT equivalent: {}", source);
  }
  return out;
}

std::optional<material::Fluid> build_fluid(Section const& section, std::string const& name) {
  material::Fluid out;
  out.name = name;
  out.source = section.text("source").value_or("");
  auto const word = section.text("eos");
  auto const density = section.number("density");
  auto const pressure = section.number("pressure");
  if (!word || !density || !pressure) return std::nullopt;
  bool const complete = fill_if<material::IdealGas>(*word, out.eos, section) &&
                        fill_if<material::Jwl>(*word, out.eos, section) &&
                        fill_if<material::StiffenedGas>(*word, out.eos, section) &&
                        fill_if<material::MieGruneisen>(*word, out.eos, section);
  if (!complete) return std::nullopt;
  out.density = *density;
  out.pressure = *pressure;
  return out;
}

}  // namespace brisance::deck
