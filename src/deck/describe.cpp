/// Texts for `brisance info`.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/parameter.hpp"
#include "deck/library.hpp"
#include "deck/schema.hpp"
#include "material/afterburn.hpp"
#include "run/point_fields.hpp"
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

template <class Variant>
char const* model_name(Variant const& model) {
  return std::visit([](auto const& m) { return m.name; }, model);
}

template <class Variant>
std::string model_text(char const* title, Variant const& model) {
  return fmt::format("  {:<18} {:>12}\n", title, model_name(model)) +
         std::visit([](auto const& m) { return parameter_lines(m); }, model);
}

/// Yield stress at the start [Pa], of concrete f'c, of soil that at no pressure; 0 without one.
double yield_of(material::Strength const& strength) {
  if (auto const* v = std::get_if<material::VonMises>(&strength)) return v->yield;
  if (auto const* j = std::get_if<material::JohnsonCook>(&strength)) return j->A;
  if (auto const* h = std::get_if<material::Hjc>(&strength)) return h->fc;
  if (auto const* d = std::get_if<material::DruckerPrager>(&strength)) return std::numbers::sqrt3 * d->k();
  return 0.0;
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
    out += fmt::format("  {:<18}{:<9.4g}{:<13.6g}{}\n", f.name, f.density, f.pressure / 1e3, model_name(f.eos));
  }
  out +=
      "\nSolids              density  bulk sound   shear        yield    equation       strength       failure\n"
      "                    kg/m3    speed m/s    modulus GPa  MPa      of state\n";
  for (auto const& [s, aliases] : library().solids) {
    out += fmt::format("  {:<18}{:<9.4g}{:<13.4g}{:<13.4g}{:<9.4g}{:<15}{:<15}{}\n", s.name, s.density,
                       std::sqrt(material::bulk_modulus(s.eos, s.density, 0.0) / s.density),
                       material::shear_modulus(s.strength) / 1e9, yield_of(s.strength) / 1e6, model_name(s.eos),
                       model_name(s.strength), model_name(s.failure));
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
    if (e->afterburn_energy) {
      out += value_line("afterburn", *e->afterburn_energy, "J/kg", "energy of the products' combustion in air");
    }
    return out;
  }
  if (auto const* f = all.fluid(name)) {
    std::string out = head(f->name, "fluid", aliases_of(all.fluids, f->name), f->source);
    out += model_text("eos", f->eos);
    out += value_line("density", f->density, "kg/m3", "default density");
    out += value_line("pressure", f->pressure, "Pa", "default pressure");
    return out +
           value_line("", material::sound_speed(f->eos, f->density, f->pressure), "m/s", "sound speed of this state");
  }
  if (auto const* s = all.solid(name)) {
    std::string out = head(s->name, "solid", aliases_of(all.solids, s->name), s->source);
    out += value_line("density", s->density, "kg/m3", "density at the start");
    out += model_text("eos", s->eos) + model_text("strength", s->strength) + model_text("failure", s->failure);
    out += value_line("specific_heat", s->specific_heat, "J/kg/K", "specific heat");
    out += value_line("temperature", s->temperature, "K", "temperature at the start");
    out += value_line("taylor_quinney", s->taylor_quinney, "1", "part of the plastic work that heats");
    if (s->minimum_pressure > -unbounded) {
      out += value_line("minimum_pressure", s->minimum_pressure, "Pa", "tension cut-off");
    }
    return out + value_line("", material::sound_speed(*s, s->density, 0.0), "m/s", "longitudinal sound speed");
  }
  auto names = all.explosive_names();
  for (auto const& more : {all.fluid_names(), all.solid_names()}) names.insert(names.end(), more.begin(), more.end());
  throw InputError(fmt::format("\"{}\" is not a known material; {}", name, suggestion(name, names, "known materials")));
}

std::string describe_models() {
  std::string out = words_line("Geometries", "domain", "geometry") + words_line("Boundaries", "boundaries", "all") +
                    words_line("Shapes", "charge", "shape") + words_line("Detonation", "charge", "detonation") +
                    words_line("Schemes", "numerics", "scheme") +
                    words_line("Point shapes", "points", "shape_function") +
                    words_line("Stress order", "points", "stress_order") + words_line("Transfer", "points", "transfer");
  out += "\nEquations of state and their parameters\n";
  out += model_lines<material::IdealGas>() + model_lines<material::Jwl>() + model_lines<material::StiffenedGas>() +
         model_lines<material::MieGruneisen>() + model_lines<material::Linear>() + model_lines<material::Compaction>();
  out += "\nAfterburn models and their parameters\n";
  out += model_lines<material::ConstantRateAfterburn>() + model_lines<material::MillerAfterburn>();
  out += "\nStrength models and their parameters\n";
  out += model_lines<material::NoStrength>() + model_lines<material::Elastic>() + model_lines<material::VonMises>() +
         model_lines<material::JohnsonCook>() + model_lines<material::Hjc>() + model_lines<material::DruckerPrager>();
  out += "\nFailure models and their parameters\n";
  out += model_lines<material::NoFailure>() + model_lines<material::JohnsonCookFailure>() +
         model_lines<material::TensileDamage>();
  out += "\nFields for output\n";
  for (auto const& field : run::known_fields()) {
    out += fmt::format("  {:<18} {:<7} {}\n", field.name, unit_text(field.unit), field.meaning);
  }
  out += "\nFields of material points for output\n";
  for (auto const& field : run::known_point_fields()) {
    out += fmt::format("  {:<18} {:<7} {}\n", field.name, unit_text(field.unit), field.meaning);
  }
  return out;
}

}  // namespace brisance::deck
