/// Tables of materials, in decks and material files.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "deck/schema_keys.hpp"
#include "material/afterburn.hpp"
#include "material/explosive.hpp"
#include "material/solid.hpp"

namespace brisance::deck {

namespace {

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

/// Keys of a model that the solid's own keys tell may be left out.
void leave_to_solid(std::vector<Key>& keys) {
  for (auto& key : keys) {
    if (key.name == "rho0") {
      key.needed = false;
      key.note("the solid's `density`");
    }
    if (key.name == "K" || key.name == "G") {
      key.needed = false;
      key.note("from the solid's `E` and `nu`");
    }
  }
}

/// Which models of a list a table takes.
struct Every {
  template <class Model>
  static constexpr bool takes = true;
};
struct OfSolids {
  template <class Model>
  static constexpr bool takes = Model::of_solids;
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

/// The keys of each model of a list.
template <class List, class Which = Every>
std::map<std::string, std::vector<Key>> keys_of_models() {
  std::map<std::string, std::vector<Key>> keys;
  for_each_model<List>([&]<class Model>() {
    if (Which::template takes<Model>) keys[Model::name] = parameter_keys<Model>();
  });
  return keys;
}

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

}  // namespace

Table const& afterburn_table() {
  static Table const table{
      "Energy that the detonation products release after the detonation, in proportion to their mass and wherever they "
      "are: none of the models knows how much air has been mixed in. Absent: no afterburn. Gas cells only.",
      {word("model", model_names<material::AfterburnRate>())
           .required()
           .like("\"constant_rate\"")
           .means(
               "`constant_rate`: at a constant rate from `begin` to `end`; `miller`: d(lambda)/dt = a (1 - lambda)^m "
               "p^n [Miller95], lambda the part that has been released, carried along with the products"),
       number("energy", "J/kg", 0.0, 1e9)
           .note("that of the explosive, where it is known")
           .like("\"10.2 MJ/kg\"")
           .means("Energy Q in all, per mass of the products")},
      "model",
      keys_of_models<material::AfterburnRate>()};
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

std::vector<Key> fluid_keys() {
  return {word("eos", model_names<material::Eos>())
              .of(material::IdealGas::name)
              .like("\"ideal_gas\"")
              .means("Equation of state"),
          density().required().means("Default density, for gases at 288.15 K"),
          pressure().of(101325.0).means("Default pressure")};
}

std::map<std::string, std::vector<Key>> explosive_variants() {
  return {{material::Jwl::name, parameter_keys<material::Jwl>()}};
}

std::map<std::string, std::vector<Key>> fluid_variants() { return keys_of_models<material::Eos>(); }

namespace {

std::vector<Key> own_keys() {
  return {typed(Type::text, "source").of("the deck").like("\"handbook, page 12\"").means("Source of the numbers")};
}

}  // namespace

Table const& explosives_table() {
  static Table const table{"An explosive of the deck's own, under the name NAME.", joined(explosive_keys(), own_keys()),
                           "eos", explosive_variants()};
  return table;
}

Table const& fluids_table() {
  static Table const table{"A fluid of the deck's own, under the name NAME.", joined(fluid_keys(), own_keys()), "eos",
                           fluid_variants()};
  return table;
}

namespace {

template <class List, class Which = Every>
Table model_table(std::string meaning, std::string explanation) {
  std::vector<std::string> const names = model_names<List, Which>();
  std::map<std::string, std::vector<Key>> keys = keys_of_models<List, Which>();
  for (auto& [name, own] : keys) leave_to_solid(own);
  return {std::move(meaning),
          {word("model", names).required().like(fmt::format("\"{}\"", names.front())).means(std::move(explanation))},
          "model",
          std::move(keys)};
}

Table const& solid_eos_table() {
  static Table const table = model_table<material::PointEos, OfSolids>(
      "Equation of state of a solid: the pressure from density and energy.", "Equation of state");
  return table;
}
Table const& strength_table() {
  static Table const table =
      model_table<material::Strength>("Strength of a solid: the rest of the stress.", "Strength model");
  return table;
}
Table const& failure_table() {
  static Table const table = model_table<material::Failure>(
      "Failure of a solid: growing damage, at 1 neither shear stress nor tension.", "Failure model");
  return table;
}

}  // namespace

std::vector<Key> solid_keys() {
  static material::Solid const s;
  return {density().required().like("2700").means("Density at the start"),
          number("E", "Pa", 1.0, 1e13)
              .note("from `G` and `K`")
              .like("\"70 GPa\"")
              .means("Young's modulus; together with `nu` it gives `K` of the linear equation of state and `G` of the "
                     "strength"),
          number("nu", "1", -0.9, 0.4999).note("from `G` and `K`").like("0.33").means("Poisson's ratio"),
          number("specific_heat", "J/kg/K", 0.0, 1e6)
              .of(s.specific_heat)
              .like("896")
              .means("Specific heat; 0: plastic work does not heat"),
          number("temperature", "K", 0.0, 1e5).of(s.temperature).like("293").means("Temperature at the start"),
          number("taylor_quinney", "1", 0.0, 1.0)
              .of(s.taylor_quinney)
              .like("0.9")
              .means("Part of the plastic work that heats"),
          number("minimum_pressure", "Pa", -1e13, 0.0)
              .note("none")
              .like("\"-2 GPa\"")
              .means("Tension cut-off: the pressure never falls below it"),
          word<material::Spall>("spall")
              .of("limit")
              .like("\"pressure\"")
              .means("What happens to a metal at the tension cut-off. `limit`: it goes on pulling with this pressure; "
                     "`pressure`: it fails there and opens, with damage 1; `principal_stress`: it fails where the "
                     "largest principal stress reaches `-minimum_pressure`"),
          nested(Type::table, "eos", solid_eos_table())
              .note("`linear` from `E` and `nu`")
              .like("{model = \"mie_gruneisen\", C0 = 3940, S = 1.489, Gamma = 2.02}")
              .means("Equation of state"),
          nested(Type::table, "strength", strength_table())
              .note("`elastic` where `E` and `nu` are given, else none")
              .like("{model = \"von_mises\", yield = \"200 MPa\"}")
              .means("Strength"),
          nested(Type::table, "failure", failure_table())
              .note("none")
              .like("{model = \"johnson_cook\", D1 = 0.54, D2 = 4.89, D3 = -3.03, D4 = 0.014, D5 = 1.12}")
              .means("Failure")};
}

Table const& solids_table() {
  static Table const table{"A solid of the deck's own, under the name NAME.", joined(solid_keys(), own_keys()), {}, {}};
  return table;
}

std::vector<Key> file_keys(char const* kind) {
  return {word("kind", {kind}).required().like(fmt::format("\"{}\"", kind)).means("Kind of material"),
          typed(Type::text, "name").required().like("\"TNT\"").means("Name"),
          typed(Type::names, "aliases").note("none").like("[\"trotyl\"]").means("Other names"),
          typed(Type::text, "source").required().like("\"handbook, page 12\"").means("Source of the numbers"),
          typed(Type::text, "note")
              .of("")
              .like("\"for weak waves\"")
              .means("What the material is for and how far off it is")};
}

}  // namespace brisance::deck
