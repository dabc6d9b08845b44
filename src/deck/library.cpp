#include "deck/library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <string>

#include "core/error.hpp"
#include "deck/build_models.hpp"
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
                 fmt::format("{} is given without {}: E and nu belong together; write for example {}",
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
                 fmt::format("{} is given beside E and nu, which make it {:.6g} Pa: give only one of the two",
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
bool concrete_fits(material::Solid const& solid, Section const& section, Report& report) {
  using namespace material;
  auto const* hjc = std::get_if<Hjc>(&solid.strength);
  auto const* eos = std::get_if<Compaction>(&solid.eos);
  auto const* tensile = std::get_if<TensileDamage>(&solid.failure);
  if (tensile != nullptr && hjc == nullptr) {
    return refuse(section, "failure", "model", report,
                  "\"tensile_damage\" is that of concrete: give the solid the strength hjc");
  }
  if (hjc != nullptr && eos == nullptr) {
    return refuse(section, "strength", "model", report,
                  "\"hjc\" needs the pressure of concrete: give the solid an eos with model = \"compaction\"");
  }
  if (eos == nullptr) return true;
  if (hjc == nullptr) {
    return refuse(section, "eos", "model", report,
                  "\"compaction\" keeps its history with the strength of concrete: give the solid the strength hjc");
  }
  if (!(eos->mu_lock > eos->mu_crush)) {
    return refuse(section, "eos", "mu_lock", report,
                  fmt::format("mu_lock = {:g} does not lie above mu_crush = {:g}", eos->mu_lock, eos->mu_crush));
  }
  if (!(eos->P_lock > eos->P_crush)) {
    return refuse(section, "eos", "P_lock", report,
                  fmt::format("P_lock = {:g} Pa does not lie above P_crush = {:g} Pa", eos->P_lock, eos->P_crush));
  }
  if (eos->K2 < 0.0 && !(eos->K2 * eos->K2 < 3.0 * eos->K1 * eos->K3)) {
    return refuse(section, "eos", "K2", report,
                  fmt::format("the dense curve K1 m + K2 m^2 + K3 m^3 falls somewhere: K2^2 is not below 3 K1 K3 (K2 = "
                              "{:g}, K1 = {:g}, K3 = {:g} Pa)",
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
                  fmt::format("with T_max = {:g} Pa uniaxial tension ends at {:.4g} Pa, not above sigma0 = {:g} Pa: "
                              "nothing would be damaged; raise T_max",
                              tensile->T_max, most, tensile->sigma0));
  }
  return true;
}

/// Do the parts of soil belong together?
bool soil_fits(material::Solid const& solid, Section const& section, Report& report) {
  using namespace material;
  auto const* soil = std::get_if<DruckerPrager>(&solid.strength);
  if (soil == nullptr) return true;
  if (!std::holds_alternative<Linear>(solid.eos)) {
    return refuse(section, "eos", "model", report,
                  "\"drucker_prager\" has a pressure of its own, with a constant bulk modulus: use eos.model = "
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

void check(Report const& report, EmbeddedFile const& file) {
  if (!report.failed()) return;
  std::string message = fmt::format("the material file {} of this build is wrong", file.name);
  for (auto const& error : report.errors()) message += fmt::format("\n{}", format(error));
  throw InputError(message);
}

template <class Material>
Named<Material> named(std::optional<Material> material, Section const& section) {
  if (!material)
    throw std::logic_error(
        fmt::format("the material of {} cannot be built, and nothing says why", section.text("name").value_or("?")));
  Named<Material> out{std::move(*material), {}, {}};
  if (auto const* aliases = section.strings("aliases")) out.aliases = *aliases;
  out.note = section.text("note").value_or("");
  return out;
}

Library load() {
  Library out;
  for (auto const& file : embedded_materials()) {
    // Which of the three schemas holds is known from the text's own `kind`.
    Report as_explosive{std::string(file.name)};
    auto const explosive = read(file.text, explosive_file_schema(), as_explosive);
    if (explosive && explosive->text("kind")) {
      check(as_explosive, file);
      out.explosives.push_back(named(build_explosive(*explosive, *explosive->text("name")), *explosive));
      continue;
    }
    Report as_solid{std::string(file.name)};
    auto const solid = read(file.text, solid_file_schema(), as_solid);
    if (solid && solid->text("kind")) {
      check(as_solid, file);
      auto built = build_solid(*solid, *solid->text("name"), as_solid);
      check(as_solid, file);
      out.solids.push_back(named(std::move(built), *solid));
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
  std::sort(out.solids.begin(), out.solids.end(), by_name);
  return out;
}

}  // namespace

material::Explosive const* Library::explosive(std::string_view name) const { return find(explosives, name); }
material::Fluid const* Library::fluid(std::string_view name) const { return find(fluids, name); }
material::Solid const* Library::solid(std::string_view name) const { return find(solids, name); }
std::string Library::note(std::string_view name) const {
  auto const in = [name](auto const& all) {
    for (auto const& entry : all) {
      if (same_name(entry.material.name, name)) return entry.note;
    }
    return std::string();
  };
  for (std::string note : {in(explosives), in(fluids), in(solids)}) {
    if (!note.empty()) return note;
  }
  return {};
}
std::vector<std::string> Library::explosive_names() const { return names_of(explosives); }
std::vector<std::string> Library::fluid_names() const { return names_of(fluids); }
std::vector<std::string> Library::solid_names() const { return names_of(solids); }

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
  if (section.broken("afterburn")) return std::nullopt;
  if (auto const* afterburn = section.section("afterburn")) {
    out.afterburn_energy = afterburn->number("energy");
    if (!out.afterburn_energy) return std::nullopt;
    auto const source = afterburn->text("source").value_or("");
    if (!source.empty()) out.source += fmt::format("; afterburn: {}", source);
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
  auto const eos = filled<material::Eos>(*word, section);
  if (!eos) return std::nullopt;
  out.eos = *eos;
  out.density = *density;
  out.pressure = *pressure;
  return out;
}

std::optional<material::Solid> build_solid(Section const& section, std::string const& name, Report& report) {
  using namespace material;
  Solid out;
  out.name = name;
  out.source = section.text("source").value_or("");
  auto const density = section.number("density");
  if (!density || section.doubtful()) return std::nullopt;
  out.density = *density;
  std::map<std::string_view, double> derived{{"rho0", *density}};
  if (!moduli(section, report, derived)) return std::nullopt;
  for (auto const& [key, member] :
       {std::pair{"specific_heat", &Solid::specific_heat}, std::pair{"temperature", &Solid::temperature},
        std::pair{"taylor_quinney", &Solid::taylor_quinney}, std::pair{"minimum_pressure", &Solid::minimum_pressure}}) {
    if (section.broken(key)) return std::nullopt;
    out.*member = section.number(key).value_or(out.*member);
  }
  for (auto const* key : {"eos", "strength", "failure"}) {
    if (section.broken(key)) return std::nullopt;
  }

  bool const elastic = derived.contains("K");
  if (auto const* table = section.section("eos")) {
    auto const eos = model_of<PointEos>(*table, derived);
    if (!eos) {
      missing_modulus(*table, "K", "bulk modulus", derived, report);
      return std::nullopt;
    }
    out.eos = *eos;
  } else if (elastic) {
    out.eos = Linear{*density, derived["K"]};
  } else {
    report.error(
        section.place, section.path_of("eos"),
        "the solid has no equation of state; write E = \"70 GPa\" and nu = 0.33, or for example eos = {model = "
        "\"mie_gruneisen\", C0 = 3940, S = 1.489, Gamma = 2.02}");
    return std::nullopt;
  }
  if (auto const* table = section.section("strength")) {
    auto const strength = model_of<Strength>(*table, derived);
    if (!strength) {
      missing_modulus(*table, "G", "shear modulus", derived, report);
      return std::nullopt;
    }
    out.strength = *strength;
  } else if (elastic) {
    out.strength = Elastic{derived["G"]};
  }
  if (auto const* table = section.section("failure")) {
    auto const failure = model_of<Failure>(*table, derived);
    if (!failure) return std::nullopt;
    out.failure = *failure;
    bool const metal =
        std::holds_alternative<VonMises>(out.strength) || std::holds_alternative<JohnsonCook>(out.strength);
    if (std::holds_alternative<JohnsonCookFailure>(out.failure) && !metal) {
      report.error(table->place, table->path,
                   "this damage grows with the plastic strain of a metal: give the solid the strength von_mises or "
                   "johnson_cook");
      return std::nullopt;
    }
  }
  if (auto const spall = section.text("spall"); spall && *spall != "limit") {
    out.spall = *value_of<Spall>(*spall);
    if (!out.plastic() || std::holds_alternative<Hjc>(out.strength) ||
        std::holds_alternative<DruckerPrager>(out.strength)) {
      report.error(section.place_of("spall"), section.path_of("spall"),
                   fmt::format("{} is for metals, with the strength von_mises or johnson_cook; concrete tears by "
                               "failure = {{model = \"tensile_damage\"}}, soil by its own limit of tension",
                               section.shown("spall")));
      return std::nullopt;
    }
    if (!(out.minimum_pressure > -unbounded && out.minimum_pressure < 0.0)) {
      report.error(section.place_of("spall"), section.path_of("spall"),
                   fmt::format("{} needs the tension at which the solid tears: write for example minimum_pressure = "
                               "\"-2 GPa\"",
                               section.shown("spall")));
      return std::nullopt;
    }
  }
  if (auto const* jc = std::get_if<JohnsonCook>(&out.strength); jc != nullptr && !(jc->T_melt > jc->T_room)) {
    Section const& table = *section.section("strength");
    report.error(
        table.place_of("T_melt"), table.path_of("T_melt"),
        fmt::format("{} does not lie above the room temperature T_room, {:g} K", table.shown("T_melt"), jc->T_room));
    return std::nullopt;
  }
  if (!concrete_fits(out, section, report) || !soil_fits(out, section, report)) return std::nullopt;
  return out;
}

}  // namespace brisance::deck
