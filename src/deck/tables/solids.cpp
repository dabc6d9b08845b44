/// [solids.NAME]: solids of the deck and of the library.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/library.hpp"
#include "deck/models.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

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

struct OfSolids {
  template <class Model>
  static constexpr bool takes = Model::of_solids;
};

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
  static Table const table = model_table<material::ParticleEos, OfSolids>(
      "Equation of state of a solid: pressure as a function of density and energy.", "Equation of state");
  return table;
}

Table const& strength_table() {
  static Table const table =
      model_table<material::Strength>("Strength of a solid: deviatoric stress.", "Strength model");
  return table;
}

Table const& failure_table() {
  static Table const table = model_table<material::Failure>(
      "Failure of a solid: damage grows; at damage 1 the material carries neither shear stress nor tension.",
      "Failure model");
  return table;
}

Settings<material::Material> const& settings() {
  using S = material::Material;
  static Settings<S> const all{
      density().required().like("2700").means("Initial density"),
      number("E", "Pa", 1.0, 1e13)
          .note("from `G` and `K`")
          .like("\"70 GPa\"")
          .means("Young's modulus; together with `nu` it gives `K` of the linear equation of state and `G` of the "
                 "strength"),
      number("nu", "1", -0.9, 0.4999).note("from `G` and `K`").like("0.33").means("Poisson's ratio"),
      {&S::specific_heat,
       number("specific_heat", "J/kg/K", 0.0, 1e6).like("896").means("Specific heat; 0: no heating by plastic work")},
      {&S::temperature, number("temperature", "K", 0.0, 1e5).like("293").means("Initial temperature")},
      {&S::taylor_quinney, number("taylor_quinney", "1", 0.0, 1.0)
                               .like("0.9")
                               .means("Fraction of plastic work converted to heat (Taylor-Quinney)")},
      {&S::minimum_pressure, number("minimum_pressure", "Pa", -1e13, 0.0)
                                 .note("none")
                                 .like("\"-2 GPa\"")
                                 .means("Tension cut-off: the pressure never falls below this value")},
      word<material::Spall>("spall")
          .of(word_of(S{}.spall))
          .like("\"pressure\"")
          .means("Behaviour of a metal at the tension cut-off. `limit`: the metal continues to carry this tension; "
                 "`pressure`: the metal fails and opens (damage 1); `principal_stress`: the metal fails when the "
                 "largest principal stress reaches `-minimum_pressure`"),
      nested(Type::table, "eos", solid_eos_table())
          .note("`linear` from `E` and `nu`")
          .like("{model = \"mie_gruneisen\", C0 = 3940, S = 1.489, Gamma = 2.02}")
          .means("Equation of state"),
      nested(Type::table, "strength", strength_table())
          .note("`elastic` if `E` and `nu` are given, otherwise none")
          .like("{model = \"von_mises\", yield = \"200 MPa\"}")
          .means("Strength"),
      nested(Type::table, "failure", failure_table())
          .note("none")
          .like("{model = \"johnson_cook\", D1 = 0.54, D2 = 4.89, D3 = -3.03, D4 = 0.014, D5 = 1.12}")
          .means("Failure")};
  ;
  return all;
}

std::vector<Key> solid_keys() { return settings().keys(); }

}  // namespace

Table const& solids_table() {
  static Table const table{
      "A solid defined in the deck, with the name NAME.", joined(solid_keys(), own_keys()), {}, {}};
  return table;
}

Table const& solid_file_schema() {
  static Table const table{"", joined(file_keys("solid"), solid_keys()), {}, {}};
  return table;
}

namespace {

/// The model of a solid's table [eos], [strength] or [failure]; what the table leaves out is taken from `derived`.
template <class List>
std::optional<List> model_of(Section const& section, std::map<std::string_view, double> const& derived) {
  auto const word = section.text("model");
  if (!word) return std::nullopt;
  std::optional<List> out;
  for_each_model<List>([&]<class Model>() {
    if (*word != Model::name) return;
    Model model;
    for (auto const& p : Model::parameters()) {
      if (section.broken(p.key)) return;
      auto const value = section.number(p.key);
      auto const other = derived.find(p.key);
      if (!value && other == derived.end()) return;
      model.*p.member = value ? *value : other->second;
    }
    out = model;
  });
  return out;
}

/// Young's modulus and Poisson's ratio of a solid's table as bulk and shear modulus; both or none of the two are given.
bool moduli(Section const& section, Report& report, std::map<std::string_view, double>& out) {
  if (section.broken("E") || section.broken("nu")) return false;
  auto const E = section.number("E");
  auto const nu = section.number("nu");
  if (E.has_value() != nu.has_value()) {
    report.error(section.place_of(E ? "E" : "nu"), section.path_of(E ? "E" : "nu"),
                 fmt::format("{} is given without {}: E and nu belong together; write, for example, {}",
                             section.shown(E ? "E" : "nu"), E ? "nu" : "E", E ? "nu = 0.33" : "E = \"70 GPa\""));
    return false;
  }
  if (!E) return true;
  out["K"] = material::bulk_modulus_of(*E, *nu);
  out["G"] = material::shear_modulus_of(*E, *nu);
  for (auto const& [table, key] : {std::pair{"eos", "K"}, std::pair{"strength", "G"}}) {
    auto const* given = section.section(table);
    if (given == nullptr || !given->given(key)) continue;
    report.error(given->place_of(key), given->path_of(key),
                 fmt::format("{} is given in addition to E and nu, which imply {:.6g} Pa: give only one of the two",
                             given->shown(key), out[key]));
    return false;
  }
  return true;
}

/// Is a modulus that is neither given nor derived the reason why a model could not be read? Reports it.
void missing_modulus(Section const& section, std::string_view key, char const* what,
                     std::map<std::string_view, double> const& derived, Report& report) {
  if (section.table->find(key) == nullptr || section.given(key) || derived.contains(key) || section.doubtful()) return;
  auto const word = section.text("model");
  if (!word) return;
  auto const variant = section.table->variants.find(*word);
  bool const has =
      std::any_of(variant->second.begin(), variant->second.end(), [&](Key const& k) { return k.name == key; });
  if (!has) return;
  report.error(section.place, section.path_of(key),
               fmt::format("the {} {} is missing: give it here, or E and nu of the solid", what, key));
}

/// Reports an error at a key of a solid's table, at the table itself or, where there is none, at the solid.
bool refuse(Section const& section, char const* name, std::string_view key, Report& report, std::string const& text) {
  auto const* table = section.section(name);
  if (table == nullptr) {
    report.error(section.place, section.path_of(name), text);
  } else {
    report.error(table->place_of(key), table->path_of(key), text);
  }
  return false;
}

/// Do the parts of concrete belong together?
bool concrete_fits(material::Material const& solid, Section const& section, Report& report) {
  using namespace material;
  auto const* hjc = std::get_if<Hjc>(&solid.strength);
  auto const* eos = std::get_if<Compaction>(&solid.eos);
  auto const* tensile = std::get_if<TensileDamage>(&solid.failure);
  if (tensile != nullptr && hjc == nullptr) {
    return refuse(section, "failure", "model", report,
                  "\"tensile_damage\" is a model for concrete: give the solid the strength hjc");
  }
  if (hjc != nullptr && eos == nullptr) {
    return refuse(section, "strength", "model", report,
                  "\"hjc\" needs the equation of state of concrete: give the solid an eos with model = \"compaction\"");
  }
  if (eos == nullptr) return true;
  if (hjc == nullptr) {
    return refuse(
        section, "eos", "model", report,
        "\"compaction\" stores its history in the strength model of concrete: give the solid the strength hjc");
  }
  if (!(eos->mu_lock > eos->mu_crush)) {
    return refuse(section, "eos", "mu_lock", report,
                  fmt::format("mu_lock = {:g} is not above mu_crush = {:g}", eos->mu_lock, eos->mu_crush));
  }
  if (!(eos->P_lock > eos->P_crush)) {
    return refuse(section, "eos", "P_lock", report,
                  fmt::format("P_lock = {:g} Pa is not above P_crush = {:g} Pa", eos->P_lock, eos->P_crush));
  }
  if (eos->K2 < 0.0 && !(eos->K2 * eos->K2 < 3.0 * eos->K1 * eos->K3)) {
    return refuse(section, "eos", "K2", report,
                  fmt::format("the dense curve K1 m + K2 m^2 + K3 m^3 is not monotonic: K2^2 is not below 3 K1 K3 (K2 "
                              "= {:g}, K1 = {:g}, K3 = {:g} Pa)",
                              eos->K2, eos->K1, eos->K3));
  }
  auto const curves = eos->curves();
  if (!(curves.slope < curves.K_e && curves.slope < curves.K_lock)) {
    return refuse(section, "eos", "P_lock", report,
                  fmt::format("the curve rises faster while the pores collapse ({:.4g} Pa) than before (P_crush / "
                              "mu_crush = {:.4g} Pa) or after (K1 / (1 + mu_lock) = {:.4g} Pa): lower P_lock",
                              curves.slope, curves.K_e, curves.K_lock));
  }
  if (tensile == nullptr) return true;
  double const most = 1.0 / (1.0 / (hjc->A * hjc->fc) + 1.0 / (3.0 * tensile->T_max));
  if (!(most > tensile->sigma0)) {
    return refuse(section, "failure", "T_max", report,
                  fmt::format("with T_max = {:g} Pa uniaxial tension is limited to {:.4g} Pa, which is not above "
                              "sigma0 = {:g} Pa, so there would be no damage: raise T_max",
                              tensile->T_max, most, tensile->sigma0));
  }
  return true;
}

/// Do the parts of soil belong together?
bool soil_fits(material::Material const& solid, Section const& section, Report& report) {
  using namespace material;
  auto const* soil = std::get_if<DruckerPrager>(&solid.strength);
  if (soil == nullptr) return true;
  if (!std::holds_alternative<Linear>(solid.eos)) {
    return refuse(section, "eos", "model", report,
                  "\"drucker_prager\" computes its own pressure with a constant bulk modulus: use eos.model = "
                  "\"linear\", or E and nu alone");
  }
  if (soil->dilation > soil->friction) {
    return refuse(section, "strength", "dilation", report,
                  fmt::format("the angle of dilation, {:g}, exceeds that of friction, {:g}: plastic flow would create "
                              "energy",
                              soil->dilation, soil->friction));
  }
  if (!(soil->k() > 0.0 || soil->friction > 0.0)) {
    return refuse(section, "strength", "cohesion", report,
                  "without cohesion and friction the solid has no strength: use strength.model = \"none\"");
  }
  return true;
}

/// The models of a solid, with what its own keys tell of them; false after an error.
bool models(Section const& section, std::map<std::string_view, double> const& derived, material::Material& out,
            Report& report) {
  using namespace material;
  bool const elastic = derived.contains("K");
  if (auto const* table = section.section("eos")) {
    auto const eos = model_of<ParticleEos>(*table, derived);
    if (!eos) {
      missing_modulus(*table, "K", "bulk modulus", derived, report);
      return false;
    }
    out.eos = *eos;
  } else if (elastic) {
    out.eos = Linear{out.density, derived.at("K")};
  } else {
    report.error(section.place, section.path_of("eos"),
                 "the solid has no equation of state; write E = \"70 GPa\" and nu = 0.33 or, for example, eos = {model "
                 "= \"mie_gruneisen\", C0 = 3940, S = 1.489, Gamma = 2.02}");
    return false;
  }
  if (auto const* table = section.section("strength")) {
    auto const strength = model_of<Strength>(*table, derived);
    if (!strength) {
      missing_modulus(*table, "G", "shear modulus", derived, report);
      return false;
    }
    out.strength = *strength;
  } else if (elastic) {
    out.strength = Elastic{derived.at("G")};
  }
  if (auto const* table = section.section("failure")) {
    auto const failure = model_of<Failure>(*table, derived);
    if (!failure) return false;
    out.failure = *failure;
    bool const by_plastic_strain = std::visit([](auto const& model) { return model.damages; }, out.failure);
    if (by_plastic_strain && !out.is_metal()) {
      report.error(table->place, table->path,
                   "this damage model depends on the plastic strain of a metal: give the solid the strength von_mises "
                   "or johnson_cook");
      return false;
    }
  }
  return true;
}

/// Has the solid what it needs to tear at its tension cut-off?
bool spall_fits(material::Material const& solid, Section const& section, Report& report) {
  using namespace material;
  if (solid.spall == Spall::limit) return true;
  if (!solid.is_metal()) {
    report.error(section.place_of("spall"), section.path_of("spall"),
                 fmt::format("{} is for metals with the strength von_mises or johnson_cook; for concrete use failure = "
                             "{{model = \"tensile_damage\"}}; soil has its own tension limit",
                             section.shown("spall")));
    return false;
  }
  if (!(solid.minimum_pressure > -unbounded && solid.minimum_pressure < 0.0)) {
    report.error(
        section.place_of("spall"), section.path_of("spall"),
        fmt::format("{} needs the tension at which the solid fails: write, for example, minimum_pressure = \"-2 GPa\"",
                    section.shown("spall")));
    return false;
  }
  return true;
}

}  // namespace

std::optional<material::Material> build_solid(Section const& section, std::string const& name, Report& report) {
  using namespace material;
  Material out;
  out.name = name;
  out.source = section.text("source").value_or("");
  auto const density = section.number("density");
  if (!density || section.doubtful()) return std::nullopt;
  out.density = *density;
  std::map<std::string_view, double> derived{{"rho0", *density}};
  if (!moduli(section, report, derived)) return std::nullopt;
  if (!settings().read(section, out)) return std::nullopt;
  for (auto const* key : {"eos", "strength", "failure"}) {
    if (section.broken(key)) return std::nullopt;
  }

  if (!models(section, derived, out, report)) return std::nullopt;
  choose(section, "spall", out.spall);
  if (!spall_fits(out, section, report)) return std::nullopt;
  if (auto const* jc = std::get_if<JohnsonCook>(&out.strength); jc != nullptr && !(jc->T_melt > jc->T_room)) {
    Section const& table = *section.section("strength");
    report.error(table.place_of("T_melt"), table.path_of("T_melt"),
                 fmt::format("{} is not above the room temperature T_room, {:g} K", table.shown("T_melt"), jc->T_room));
    return std::nullopt;
  }
  if (!concrete_fits(out, section, report) || !soil_fits(out, section, report)) return std::nullopt;
  return out;
}

void build_solids(Draft& draft) {
  draft.each("solids", [&](Section const& section) {
    auto solid = build_solid(section, section.name, draft.report);
    if (!solid) {
      wrong_material(draft, section.name);
      return;
    }
    if (library().solid(section.name) != nullptr) {
      draft.report.warning(section.place, section.path, "replaces the library solid of the same name");
    }
    draft.materials.solids.push_back(std::move(*solid));
  });
}

}  // namespace brisance::deck
