/// Texts for `brisance info`.
#include <fmt/format.h>

#include "core/error.hpp"
#include "core/parameter.hpp"
#include "deck/library.hpp"
#include "deck/schema.hpp"
#include "run/world.hpp"

namespace brisance::deck {

namespace {

std::string unit_text(std::string_view unit) { return unit == "1" ? "" : std::string(unit); }

std::string value_line(std::string_view key, double value, std::string_view unit, std::string_view meaning) {
  return fmt::format("  {:<18} {:>12.6g} {:<7} {}\n", key, value, unit_text(unit), meaning);
}

template <class Model>
std::string parameter_lines(Model const& model) {
  std::string out;
  for (auto const& p : Model::parameters()) out += value_line(p.key, model.*p.member, p.unit, p.meaning);
  return out;
}

template <class Model>
std::string model_lines() {
  std::string out = fmt::format("  {}\n", Model::name);
  for (auto const& p : Model::parameters()) {
    out += fmt::format("    {:<8} {:<7} {:g} to {:g}: {}\n", p.key, unit_text(p.unit), p.minimum, p.maximum, p.meaning);
  }
  return out;
}

char const* eos_name(material::Eos const& eos) {
  return std::visit([](auto const& m) { return m.name; }, eos);
}

template <class Material>
std::string aliases_of(std::vector<Named<Material>> const& all, std::string const& name) {
  for (auto const& entry : all) {
    if (entry.material.name == name) return fmt::format("{}", fmt::join(entry.aliases, ", "));
  }
  return {};
}

std::string head(std::string const& name, char const* kind, std::string const& aliases, std::string const& source) {
  std::string out = fmt::format("{}: {}\n", name, kind);
  if (!aliases.empty()) out += fmt::format("  also called: {}\n", aliases);
  return out + fmt::format("  source: {}\n\n", source);
}

std::string words_line(char const* title, std::string_view table, std::string_view key) {
  Table const& t = *deck_schema().find(table)->table;
  return fmt::format("{:<12} {}\n", title, fmt::join(t.find(key)->choices, ", "));
}

std::string equivalent_text(std::optional<double> equivalent) {
  return equivalent ? fmt::format("{:.3g}", *equivalent) : "-";
}

}  // namespace

std::string describe_library() {
  std::string out =
      "Explosives          density  detonation   CJ pressure  energy   TNT equivalent\n"
      "                    kg/m3    speed m/s    GPa          MJ/kg    pressure  impulse\n";
  for (auto const& [e, aliases] : library().explosives) {
    out += fmt::format("  {:<18}{:<9.4g}{:<13.4g}{:<13.4g}{:<9.3g}{:<10}{}\n", e.name, e.density(), e.detonation_speed,
                       e.cj_pressure / 1e9, e.specific_energy() / 1e6, equivalent_text(e.tnt_equivalent_pressure),
                       equivalent_text(e.tnt_equivalent_impulse));
  }
  out +=
      "\nFluids              density  pressure     equation\n"
      "                    kg/m3    kPa          of state\n";
  for (auto const& [f, aliases] : library().fluids) {
    out += fmt::format("  {:<18}{:<9.4g}{:<13.6g}{}\n", f.name, f.density, f.pressure / 1e3, eos_name(f.eos));
  }
  return out + "\n\"brisance info NAME\" prints all parameters of a material and their source.\n";
}

std::string describe_material(std::string const& name) {
  Library const& all = library();
  if (auto const* e = all.explosive(name)) {
    std::string out = head(e->name, "explosive", aliases_of(all.explosives, e->name), e->source);
    out += parameter_lines(e->products);
    out += value_line("energy", e->energy, "J/m3", "energy E0 per unit volume of the unreacted explosive");
    out += value_line("detonation_speed", e->detonation_speed, "m/s", "Chapman-Jouguet detonation speed D");
    out += value_line("cj_pressure", e->cj_pressure, "Pa", "Chapman-Jouguet pressure");
    out += value_line("", e->specific_energy(), "J/kg", "energy per mass");
    if (e->tnt_equivalent_pressure) {
      out +=
          value_line("tnt_equivalent", *e->tnt_equivalent_pressure, "1", "mass of TNT with the same peak overpressure");
    }
    if (e->tnt_equivalent_impulse) {
      out += value_line("tnt_equivalent", *e->tnt_equivalent_impulse, "1", "mass of TNT with the same impulse");
    }
    return out;
  }
  if (auto const* f = all.fluid(name)) {
    std::string out = head(f->name, "fluid", aliases_of(all.fluids, f->name), f->source);
    out += fmt::format("  {:<18} {:>12}\n", "eos", eos_name(f->eos));
    out += std::visit([](auto const& m) { return parameter_lines(m); }, f->eos);
    out += value_line("density", f->density, "kg/m3", "default density");
    out += value_line("pressure", f->pressure, "Pa", "default pressure");
    return out +
           value_line("", material::sound_speed(f->eos, f->density, f->pressure), "m/s", "sound speed of this state");
  }
  auto names = all.explosive_names();
  auto const fluids = all.fluid_names();
  names.insert(names.end(), fluids.begin(), fluids.end());
  throw InputError(fmt::format("\"{}\" is not a known material; {}", name, suggestion(name, names, "known materials")));
}

std::string describe_models() {
  std::string out = words_line("Geometries", "domain", "geometry") + words_line("Boundaries", "boundaries", "all") +
                    words_line("Shapes", "charge", "shape") + words_line("Detonation", "charge", "detonation") +
                    words_line("Schemes", "numerics", "scheme");
  out += "\nEquations of state and their parameters\n";
  out += model_lines<material::IdealGas>() + model_lines<material::Jwl>() + model_lines<material::StiffenedGas>() +
         model_lines<material::MieGruneisen>();
  out += "\nFields for output\n";
  for (auto const& field : run::known_fields()) {
    out += fmt::format("  {:<18} {:<7} {}\n", field.name, unit_text(field.unit), field.meaning);
  }
  return out;
}

}  // namespace brisance::deck
