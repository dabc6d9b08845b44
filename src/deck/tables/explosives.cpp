/// [explosives.NAME]: explosives of the deck and of the library.
#include <fmt/format.h>

#include "core/error.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/library.hpp"
#include "deck/models.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"
#include "material/chapman_jouguet.hpp"

namespace brisance::deck {

namespace {

Settings<material::Explosive> const& tnt_equivalents() {
  using E = material::Explosive;
  static Settings<E> const all{
      {&E::tnt_equivalent_pressure,
       number("pressure", "1", 0.01, 100.0).note("unknown").like("1.37").means("TNT equivalent for peak overpressure")},
      {&E::tnt_equivalent_impulse,
       number("impulse", "1", 0.01, 100.0).note("unknown").like("1.19").means("TNT equivalent for impulse and times")},
      typed(Type::text, "source").of("").like("\"TM 5-855-1\"").means("Source of the two numbers")};
  return all;
}

Table const& tnt_equivalent_table() {
  static Table const table{
      "Mass of TNT with the same effect, per mass of the explosive.", tnt_equivalents().keys(), {}, {}};
  return table;
}

Settings<material::Explosive> const& afterburn_energy() {
  using E = material::Explosive;
  static Settings<E> const all{
      {&E::afterburn_energy, number("energy", "J/kg", 0.0, 1e9)
                                 .required()
                                 .like("\"10.2 MJ/kg\"")
                                 .means("Energy Q of complete combustion of the products in air, per mass of the "
                                        "explosive, without the detonation energy")},
      typed(Type::text, "source").of("").like("\"handbook, page 12\"").means("Source of the number")};
  return all;
}

Table const& afterburn_energy_table() {
  static Table const table{
      "Energy that the products can release after the detonation.", afterburn_energy().keys(), {}, {}};
  return table;
}

Settings<material::Explosive> const& settings() {
  using E = material::Explosive;
  static Settings<E> const all{
      word("eos", {material::Jwl::name})
          .of(material::Jwl::name)
          .like("\"jwl\"")
          .means("Equation of state of the products"),
      {&E::energy, number("energy", "J/m3", 1e6, 1e12)
                       .required()
                       .like("\"6.993 GJ/m3\"")
                       .means("Energy E0 per unit volume of the unreacted explosive")},
      {&E::detonation_speed, number("detonation_speed", "m/s", 100.0, 2e4)
                                 .required()
                                 .like("6930")
                                 .means("Chapman-Jouguet detonation speed D")},
      {&E::cj_pressure,
       number("cj_pressure", "Pa", 1e6, 1e12).required().like("\"21 GPa\"").means("Chapman-Jouguet pressure")},
      nested(Type::table, "tnt_equivalent", tnt_equivalent_table())
          .note("unknown")
          .like("{pressure = 1.37, impulse = 1.19}")
          .means("TNT equivalents for the Kingery-Bulmash comparison; quantities whose TNT equivalent is unknown are "
                 "not compared. TNT has 1"),
      nested(Type::table, "afterburn", afterburn_energy_table())
          .note("unknown")
          .like("{energy = \"10.2 MJ/kg\"}")
          .means("Energy that the products can release after the detonation; used only if the deck has `[afterburn]`")};
  ;
  return all;
}

std::vector<Key> explosive_keys() { return settings().keys(); }

std::map<std::string, std::vector<Key>> explosive_variants() {
  return {{material::Jwl::name, parameter_keys<material::Jwl>()}};
}

}  // namespace

Table const& explosives_table() {
  static Table const table{"An explosive defined in the deck, with the name NAME.",
                           joined(explosive_keys(), own_keys()), "eos", explosive_variants()};
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
  bool const sound = settings().read(section, out);
  if (!sound || section.broken("eos") || !fill(out.products, section)) return std::nullopt;
  if (section.broken("tnt_equivalent")) return std::nullopt;
  if (name == "TNT") out.tnt_equivalent_pressure = out.tnt_equivalent_impulse = 1.0;
  if (auto const* equivalent = section.section("tnt_equivalent")) {
    if (!tnt_equivalents().read(*equivalent, out)) return std::nullopt;
    auto const source = equivalent->text("source").value_or("");
    if (!source.empty()) out.source += fmt::format("; TNT equivalent: {}", source);
  }
  if (section.broken("afterburn")) return std::nullopt;
  if (auto const* afterburn = section.section("afterburn")) {
    if (!afterburn_energy().read(*afterburn, out)) return std::nullopt;
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
                         fmt::format("these constants do not describe a detonation: {}", e.what()));
      wrong_material(draft, section.name);
      return;
    }
    if (library().explosive(section.name) != nullptr) {
      draft.report.warning(section.place, section.path, "replaces the library explosive of the same name");
    }
    draft.materials.explosives.push_back(std::move(*explosive));
  });
}

}  // namespace brisance::deck
