#include "deck/parameters.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include "core/parameter.hpp"
#include "deck/reader.hpp"

namespace brisance::deck {

namespace {

MaterialNumber number(std::string key, double value, std::string_view unit, std::string_view meaning) {
  return {std::move(key), value, std::string(unit), std::string(meaning), {}, {}};
}

std::string place(std::string const& table, std::string_view key) {
  return table.empty() ? std::string(key) : table + "." + std::string(key);
}

template <class Model>
void add_parameters(std::vector<MaterialNumber>& out, std::string const& table, Model const& model) {
  for (auto const& p : Model::parameters()) {
    // Without the bound there is nothing to tell.
    if (model.*p.member >= unbounded || model.*p.member <= -unbounded) continue;
    out.push_back(number(place(table, p.key), model.*p.member, p.unit, p.meaning));
  }
}

/// The word for a model, then its parameters. `table` is the table that they stand in, empty for the material's own.
template <class Variant>
void add_model(std::vector<MaterialNumber>& out, char const* key, std::string const& table, Variant const& variant) {
  std::visit(
      [&](auto const& model) {
        out.push_back({key, 0.0, {}, {}, model.name, {}});
        add_parameters(out, table, model);
      },
      variant);
}

/// What the deck says about the key of a table, or where the value is from without it.
std::string origin(Section const* table, std::string const& key, bool elastic) {
  if (table != nullptr && table->given(key)) return table->shown(key);
  if (elastic && (key == "K" || key == "G" || key == "model")) return "from E and nu";
  return key == "rho0" ? "density" : "default";
}

}  // namespace

std::vector<MaterialNumber> numbers_of(material::Explosive const& e) {
  std::vector<MaterialNumber> out;
  out.push_back({"eos", 0.0, {}, {}, e.products.name, {}});
  add_parameters(out, "", e.products);
  out.push_back(number("energy", e.energy, "J/m3", "energy E0 per unit volume of the unreacted explosive"));
  out.push_back(number("detonation_speed", e.detonation_speed, "m/s", "Chapman-Jouguet detonation speed D"));
  out.push_back(number("cj_pressure", e.cj_pressure, "Pa", "Chapman-Jouguet pressure"));
  if (e.tnt_equivalent_pressure) {
    out.push_back(number("tnt_equivalent.pressure", *e.tnt_equivalent_pressure, "1",
                         "mass of TNT with the same peak overpressure"));
  }
  if (e.tnt_equivalent_impulse) {
    out.push_back(
        number("tnt_equivalent.impulse", *e.tnt_equivalent_impulse, "1", "mass of TNT with the same impulse"));
  }
  if (e.afterburn_energy) {
    out.push_back(number("afterburn.energy", *e.afterburn_energy, "J/kg", "energy of the products' combustion in air"));
  }
  return out;
}

std::vector<MaterialNumber> numbers_of(material::Fluid const& f) {
  std::vector<MaterialNumber> out;
  add_model(out, "eos", "", f.eos);
  out.push_back(number("density", f.density, "kg/m3", "default density"));
  out.push_back(number("pressure", f.pressure, "Pa", "default pressure"));
  return out;
}

std::vector<MaterialNumber> numbers_of(material::Material const& s) {
  std::vector<MaterialNumber> out;
  out.push_back(number("density", s.density, "kg/m3", "initial density"));
  add_model(out, "eos", "eos", s.eos);
  add_model(out, "strength", "strength", s.strength);
  add_model(out, "failure", "failure", s.failure);
  out.push_back(number("specific_heat", s.specific_heat, "J/kg/K", "specific heat"));
  out.push_back(number("temperature", s.temperature, "K", "initial temperature"));
  out.push_back(
      number("taylor_quinney", s.taylor_quinney, "1", "fraction of plastic work converted to heat (Taylor-Quinney)"));
  if (s.minimum_pressure > -unbounded)
    out.push_back(number("minimum_pressure", s.minimum_pressure, "Pa",
                         !s.tears() ? "tension cut-off"
                         : s.spall == material::Spall::pressure
                             ? "tension cut-off; the material fails when the pressure reaches it"
                             : "tension cut-off; the material fails when the principal stress reaches it"));
  return out;
}

void note_origin(std::vector<MaterialNumber>& numbers, Section const& own) {
  bool const elastic = own.given("E");
  for (MaterialNumber& n : numbers) {
    auto const dot = n.key.find('.');
    std::string const table = dot == std::string::npos ? "" : n.key.substr(0, dot);
    if (!n.word.empty() && own.table->find(n.key) != nullptr && own.table->find(n.key)->table != nullptr) {
      n.said = origin(own.section(n.key), "model", elastic && n.key != "failure");  // "eos = {model = ...}" of a solid
    } else {
      n.said = origin(table.empty() ? &own : own.section(table), n.key.substr(dot + 1), elastic);
    }
  }
  std::vector<MaterialNumber> given;
  for (auto const& [key, unit, meaning] :
       {std::array{"E", "Pa", "Young's modulus"}, std::array{"nu", "1", "Poisson's ratio"}}) {
    auto const value = own.given(key) ? own.number(key) : std::nullopt;
    if (!value) continue;
    given.push_back(number(key, *value, unit, meaning));
    given.back().said = own.shown(key);
  }
  auto const after = std::find_if(numbers.begin(), numbers.end(), [](auto const& n) { return n.key == "eos"; });
  numbers.insert(after, given.begin(), given.end());
}

}  // namespace brisance::deck
