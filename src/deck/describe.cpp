/// Texts for `brisance info`.
#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"
#include "core/parameter.hpp"
#include "deck/library.hpp"
#include "deck/parameters.hpp"
#include "deck/schema.hpp"
#include "material/afterburn.hpp"
#include "observe/gas_fields.hpp"
#include "observe/particle_fields.hpp"

namespace brisance::deck {

namespace {

std::string unit_text(std::string_view unit) { return unit == "1" ? "" : std::string(unit); }

std::string value_line(std::string_view key, double value, std::string_view unit, std::string_view meaning) {
  return fmt::format("  {:<18} {:>12.6g} {:<7} {}\n", key, value, unit_text(unit), meaning);
}

std::string number_lines(std::vector<MaterialNumber> const& numbers) {
  std::string out;
  for (auto const& n : numbers) {
    out += n.word.empty() ? value_line(n.key.substr(n.key.find('.') + 1), n.value, n.unit, n.meaning)
                          : fmt::format("  {:<18} {:>12}\n", n.key, n.word);
  }
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

template <class List>
std::string lines_of_models() {
  std::string out;
  for_each_model<List>([&]<class Model>() { out += model_lines<Model>(); });
  return out;
}

template <class Variant>
char const* model_name(Variant const& model) {
  return std::visit([](auto const& m) { return m.name; }, model);
}

/// Yield stress at the start [Pa], of concrete f'c, of soil that at no pressure; 0 without one.
double yield_of(material::Strength const& strength) {
  return std::visit(
      [](auto const& model) {
        if constexpr (requires { model.first_yield(); }) {
          return model.first_yield();
        } else {
          return 0.0;
        }
      },
      strength);
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
  out += fmt::format("  source: {}\n", source);
  if (auto const note = library().note(name); !note.empty()) out += fmt::format("  {}\n", note);
  return out + "\n";
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
  for (auto const& [e, aliases, note] : library().explosives) {
    out += fmt::format("  {:<18}{:<9.4g}{:<13.4g}{:<13.4g}{:<9.3g}{:<10}{}\n", e.name, e.density(), e.detonation_speed,
                       e.cj_pressure / 1e9, e.specific_energy() / 1e6, equivalent_text(e.tnt_equivalent_pressure),
                       equivalent_text(e.tnt_equivalent_impulse));
  }
  out +=
      "\nFluids              density  pressure     equation\n"
      "                    kg/m3    kPa          of state\n";
  for (auto const& [f, aliases, note] : library().fluids) {
    out += fmt::format("  {:<18}{:<9.4g}{:<13.6g}{}\n", f.name, f.density, f.pressure / 1e3, model_name(f.eos));
  }
  for (auto const& [f, aliases, note] : library().fluids) {
    if (!note.empty()) out += fmt::format("  {}: {}\n", f.name, note);
  }
  out +=
      "\nSolids              density  bulk sound   shear        yield    equation       strength       failure\n"
      "                    kg/m3    speed m/s    modulus GPa  MPa      of state\n";
  for (auto const& [s, aliases, note] : library().solids) {
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
    return head(e->name, "explosive", aliases_of(all.explosives, e->name), e->source) + number_lines(numbers_of(*e)) +
           value_line("", e->specific_energy(), "J/kg", "energy per mass");
  }
  if (auto const* f = all.fluid(name)) {
    return head(f->name, "fluid", aliases_of(all.fluids, f->name), f->source) + number_lines(numbers_of(*f)) +
           value_line("", material::sound_speed(f->eos, f->density, f->pressure), "m/s", "sound speed of this state");
  }
  if (auto const* s = all.solid(name)) {
    return head(s->name, "solid", aliases_of(all.solids, s->name), s->source) + number_lines(numbers_of(*s)) +
           value_line("", material::sound_speed(*s, s->density, 0.0), "m/s", "longitudinal sound speed");
  }
  auto names = all.explosive_names();
  for (auto const& more : {all.fluid_names(), all.solid_names()}) names.insert(names.end(), more.begin(), more.end());
  throw InputError(fmt::format("\"{}\" is not a known material; {}", name, suggestion(name, names, "known materials")));
}

std::string describe_models() {
  std::string out = words_line("Geometries", "domain", "geometry") + words_line("Boundaries", "boundaries", "all") +
                    words_line("Shapes", "charge", "shape") + words_line("Detonation", "charge", "detonation") +
                    words_line("Schemes", "numerics", "scheme") + words_line("Shape fn.", "points", "shape_function") +
                    words_line("Stress order", "points", "stress_order") + words_line("Transfer", "points", "transfer");
  out += "\nEquations of state and their parameters\n";
  out += lines_of_models<material::ParticleEos>();
  out += "\nAfterburn models and their parameters\n";
  out += lines_of_models<material::AfterburnRate>();
  out += "\nStrength models and their parameters\n";
  out += lines_of_models<material::Strength>();
  out += "\nFailure models and their parameters\n";
  out += lines_of_models<material::Failure>();
  out += "\nOutput fields of the gas\n";
  for (auto const& field : observe::known_fields()) {
    out += fmt::format("  {:<18} {:<7} {}\n", field.name, unit_text(field.unit), field.meaning);
  }
  out += "\nOutput fields of the material points\n";
  for (auto const& field : observe::known_particle_fields()) {
    out += fmt::format("  {:<18} {:<7} {}\n", field.name, unit_text(field.unit), field.meaning);
  }
  return out;
}

}  // namespace brisance::deck
