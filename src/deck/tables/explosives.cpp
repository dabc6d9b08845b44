/// [explosives.NAME]: explosives of the deck and of the library.
#include <fmt/format.h>

#include "core/error.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/library.hpp"
#include "deck/models.hpp"
#include "deck/tables/tables.hpp"
#include "material/chapman_jouguet.hpp"

namespace brisance::deck {

namespace {

Table const& tnt_equivalent_table() {
  static Table const table{
      "Mass of TNT with the same effect per mass of the explosive.",
      {number("pressure", "1", 0.01, 100.0).note("unknown").like("1.37").means("For peak overpressure"),
       number("impulse", "1", 0.01, 100.0).note("unknown").like("1.19").means("For impulse and times"),
       typed(Type::text, "source").of("").like("\"TM 5-855-1\"").means("Source of the two numbers")},
      {},
      {}};
  return table;
}

Table const& afterburn_energy_table() {
  static Table const table{
      "What the products can release after the detonation.",
      {number("energy", "J/kg", 0.0, 1e9)
           .required()
           .like("\"10.2 MJ/kg\"")
           .means("Energy Q of the products' complete combustion in air, per mass of the explosive, without the energy "
                  "of the detonation"),
       typed(Type::text, "source").of("").like("\"handbook, page 12\"").means("Source of the number")},
      {},
      {}};
  return table;
}

std::vector<Key> explosive_keys() {
  return {
      word("eos", {material::Jwl::name})
          .of(material::Jwl::name)
          .like("\"jwl\"")
          .means("Equation of state of the products"),
      number("energy", "J/m3", 1e6, 1e12)
          .required()
          .like("\"6.993 GJ/m3\"")
          .means("Energy E0 per unit volume of the unreacted explosive"),
      number("detonation_speed", "m/s", 100.0, 2e4).required().like("6930").means("Chapman-Jouguet detonation speed D"),
      number("cj_pressure", "Pa", 1e6, 1e12).required().like("\"21 GPa\"").means("Chapman-Jouguet pressure"),
      nested(Type::table, "tnt_equivalent", tnt_equivalent_table())
          .note("unknown")
          .like("{pressure = 1.37, impulse = 1.19}")
          .means(
              "TNT equivalents for the Kingery-Bulmash comparison, which leaves out what an unknown one decides; those "
              "of TNT are 1"),
      nested(Type::table, "afterburn", afterburn_energy_table())
          .note("unknown")
          .like("{energy = \"10.2 MJ/kg\"}")
          .means(
              "What the products can release after the detonation; without effect unless the deck has `[afterburn]`")};
}

std::map<std::string, std::vector<Key>> explosive_variants() {
  return {{material::Jwl::name, parameter_keys<material::Jwl>()}};
}

}  // namespace

Table const& explosives_table() {
  static Table const table{"An explosive of the deck's own, under the name NAME.", joined(explosive_keys(), own_keys()),
                           "eos", explosive_variants()};
  return table;
}

Table const& explosive_file_schema() {
  static Table const table{"", joined(file_keys("explosive"), explosive_keys()), "eos", explosive_variants()};
  return table;
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
  if (section.broken("afterburn")) return std::nullopt;
  if (auto const* afterburn = section.section("afterburn")) {
    out.afterburn_energy = afterburn->number("energy");
    if (!out.afterburn_energy) return std::nullopt;
    auto const source = afterburn->text("source").value_or("");
    if (!source.empty()) out.source += fmt::format("; afterburn: {}", source);
  }
  return out;
}

void build_explosives(Draft& draft) {
  draft.each("explosives", [&](Section const& section) {
    auto explosive = build_explosive(section, section.name);
    if (!explosive) {
      wrong_material(draft, section.name);
      return;
    }
    try {
      auto const check = material::check(*explosive);
      if (!check.consistent()) {
        draft.report.warning(
            section.place, section.path,
            fmt::format(
                "the constants give a detonation speed of {:.0f} m/s and a Chapman-Jouguet pressure of {:.4g} GPa; "
                "listed are {:.0f} m/s and {:.4g} GPa",
                check.state.speed, check.state.pressure / 1e9, explosive->detonation_speed,
                explosive->cj_pressure / 1e9));
      }
    } catch (InputError const& e) {
      draft.report.error(section.place, section.path,
                         fmt::format("these constants describe no detonation: {}", e.what()));
      wrong_material(draft, section.name);
      return;
    }
    if (library().explosive(section.name) != nullptr) {
      draft.report.warning(section.place, section.path, "replaces the explosive of the same name in the library");
    }
    draft.materials.explosives.push_back(std::move(*explosive));
  });
}

}  // namespace brisance::deck
