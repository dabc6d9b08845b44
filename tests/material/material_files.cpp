#include "material_files.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>

#include "material/chapman_jouguet.hpp"

namespace brisance::test {

namespace {

/// One table of a file. Remembers what was asked for, so that anything else is found.
class Keys {
 public:
  Keys(toml::table const& table, std::string where) : table_(table), where_(std::move(where)) {}

  double number(std::string_view key) { return get<double>(key, "a number"); }
  std::string text(std::string_view key) {
    auto const value = get<std::string>(key, "a string");
    if (value.empty()) fail(key, "is empty");
    return value;
  }
  std::vector<std::string> texts(std::string_view key) {
    auto const* array = node(key).as_array();
    if (array == nullptr) fail(key, "is not an array");
    std::vector<std::string> values;
    for (auto const& item : *array) values.push_back(item.value_exact<std::string>().value());
    return values;
  }
  bool has(std::string_view key) const { return table_.contains(key); }
  toml::table const* table(std::string_view key) {
    asked_.insert(std::string(key));
    return table_[key].as_table();
  }
  template <class Model>
  Model model() {
    Model m;
    for (auto const& parameter : Model::parameters()) {
      double const value = number(parameter.key);
      if (!(value >= parameter.minimum && value <= parameter.maximum)) fail(parameter.key, "is out of range");
      m.*parameter.member = value;
    }
    return m;
  }
  void refuse_others() const {
    for (auto const& [key, value] : table_) {
      if (!asked_.contains(std::string(key.str()))) fail(key.str(), "is unknown");
    }
  }
  [[noreturn]] void fail(std::string_view key, std::string const& problem) const {
    throw std::runtime_error(where_ + ": " + std::string(key) + " " + problem);
  }

 private:
  toml::node const& node(std::string_view key) {
    asked_.insert(std::string(key));
    auto const* found = table_.get(key);
    if (found == nullptr) fail(key, "is missing");
    return *found;
  }
  template <class T>
  T get(std::string_view key, std::string const& expected) {
    auto const value = node(key).value_exact<T>();
    if (!value) fail(key, "is not " + expected);
    return *value;
  }

  toml::table const& table_;
  std::string where_;
  std::set<std::string> asked_;
};

material::Eos read_eos(Keys& keys) {
  auto const name = keys.text("eos");
  std::optional<material::Eos> eos;
  for_each_model<material::Eos>([&]<class Model>() {
    if (name == Model::name) eos = keys.model<Model>();
  });
  if (!eos) keys.fail("eos", "is unknown");
  return *eos;
}

/// A model of a solid: like model(), but a modulus may be left to E and nu, and rho0 to the density.
template <class Model>
Model read_model(Keys& keys, std::map<std::string, double> const& derived) {
  Model m;
  for (auto const& parameter : Model::parameters()) {
    std::string const key(parameter.key);
    auto const other = derived.find(key);
    if (other != derived.end() && keys.has(key)) keys.fail(key, "is given twice");
    bool const left_out = !keys.has(key) && !std::isnan(parameter.default_value);
    m.*parameter.member = other != derived.end() ? other->second
                          : left_out             ? parameter.default_value
                                                 : keys.number(key);
  }
  return m;
}

/// The model of a list that the table names.
template <class List>
void read_choice(Keys keys, std::map<std::string, double> const& derived, List& out) {
  auto const name = keys.text("model");
  bool known = false;
  for_each_model<List>([&]<class Model>() {
    if (name != Model::name) return;
    out = read_model<Model>(keys, derived);
    known = true;
  });
  if (!known) keys.fail("model", "is unknown");
  keys.refuse_others();
}

material::Material read_solid(Keys& keys, std::string const& where) {
  material::Material solid;
  solid.source = keys.text("source");
  solid.density = keys.number("density");
  std::map<std::string, double> derived{{"rho0", solid.density}};
  if (keys.has("E")) {
    double const E = keys.number("E");
    double const nu = keys.number("nu");
    derived["K"] = E / (3.0 * (1.0 - 2.0 * nu));
    derived["G"] = E / (2.0 * (1.0 + nu));
    solid.eos = material::Linear{solid.density, derived["K"]};
  }
  if (keys.has("specific_heat")) {
    solid.specific_heat = keys.number("specific_heat");
    solid.temperature = keys.number("temperature");
  }
  if (auto const* table = keys.table("eos")) read_choice(Keys(*table, where + ": eos"), derived, solid.eos);
  if (auto const* table = keys.table("strength"))
    read_choice(Keys(*table, where + ": strength"), derived, solid.strength);
  if (auto const* table = keys.table("failure")) read_choice(Keys(*table, where + ": failure"), derived, solid.failure);
  return solid;
}

material::Explosive read_explosive(Keys& keys, std::string const& where) {
  material::Explosive explosive;
  explosive.products = std::get<material::Jwl>(read_eos(keys));
  explosive.source = keys.text("source");
  explosive.energy = keys.number("energy");
  explosive.detonation_speed = keys.number("detonation_speed");
  explosive.cj_pressure = keys.number("cj_pressure");
  if (auto const* table = keys.table("tnt_equivalent")) {
    Keys equivalent(*table, where + ": tnt_equivalent");
    explosive.tnt_equivalent_pressure = equivalent.number("pressure");
    if (table->contains("impulse")) explosive.tnt_equivalent_impulse = equivalent.number("impulse");
    (void)equivalent.text("source");
    equivalent.refuse_others();
  }
  if (auto const* table = keys.table("afterburn")) {
    Keys afterburn(*table, where + ": afterburn");
    explosive.afterburn_energy = afterburn.number("energy");
    (void)afterburn.text("source");
    afterburn.refuse_others();
  }
  return explosive;
}

}  // namespace

MaterialFiles read_material_files() {
  std::vector<std::filesystem::path> paths;
  for (auto const& entry : std::filesystem::directory_iterator(BRISANCE_MATERIALS_DIR)) {
    if (entry.path().extension() == ".toml") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());

  MaterialFiles files;
  for (auto const& path : paths) {
    auto const table = toml::parse_file(path.string());
    Keys keys(table, path.filename().string());
    auto const name = keys.text("name");
    std::set<std::string> names{name};
    for (auto const& alias : keys.texts("aliases")) names.insert(alias);
    std::set<std::string> lower;
    for (auto text : names) {
      std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
      lower.insert(text);
    }
    files.names.insert(files.names.end(), lower.begin(), lower.end());

    if (keys.has("note")) (void)keys.text("note");
    auto const kind = keys.text("kind");
    if (kind == "explosive") {
      auto explosive = read_explosive(keys, path.filename().string());
      explosive.name = name;
      files.explosives.push_back(explosive);
    } else if (kind == "fluid") {
      material::Fluid fluid;
      fluid.name = name;
      fluid.eos = read_eos(keys);
      fluid.source = keys.text("source");
      fluid.density = keys.number("density");
      fluid.pressure = keys.number("pressure");
      files.fluids.push_back(fluid);
    } else if (kind == "solid") {
      auto solid = read_solid(keys, path.filename().string());
      solid.name = name;
      files.solids.push_back(solid);
    } else {
      keys.fail("kind", "is unknown");
    }
    keys.refuse_others();
  }
  return files;
}

std::vector<std::string> chapman_jouguet_table(std::vector<material::Explosive> const& explosives) {
  std::vector<std::string> lines{
      "| explosive | rho0 kg/m3 | E0 GJ/m3 | D listed m/s | D from JWL | deviation % | PCJ listed GPa | PCJ from JWL | "
      "deviation % |",
      "|---|---|---|---|---|---|---|---|---|"};
  for (auto const& explosive : explosives) {
    auto const check = material::check(explosive);
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(), "| %s | %.0f | %.3f | %.0f | %.0f | %+.2f | %.2f | %.2f | %+.2f |",
                  explosive.name.c_str(), explosive.density(), explosive.energy * 1e-9, explosive.detonation_speed,
                  check.state.speed, 100.0 * check.speed_deviation, explosive.cj_pressure * 1e-9,
                  check.state.pressure * 1e-9, 100.0 * check.pressure_deviation);
    lines.emplace_back(line.data());
  }
  return lines;
}

namespace {

/// With the given digits after the particle, or three significant ones where those would be lost.
std::string short_number(double value, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), value != 0.0 && value < 1.0 ? "%.3g" : digits == 0 ? "%.0f" : "%.1f", value);
  return text.data();
}

}  // namespace

std::vector<std::string> solid_table(std::vector<material::Material> const& solids) {
  std::vector<std::string> lines{
      "| solid | density kg/m3 | K GPa | G GPa | longitudinal sound speed m/s | strength | yield MPa | failure |",
      "|---|---|---|---|---|---|---|---|"};
  for (auto const& solid : solids) {
    auto const* mises = std::get_if<material::VonMises>(&solid.strength);
    auto const* cook = std::get_if<material::JohnsonCook>(&solid.strength);
    auto const* hjc = std::get_if<material::Hjc>(&solid.strength);
    auto const* soil = std::get_if<material::DruckerPrager>(&solid.strength);
    double const yield = mises != nullptr  ? mises->yield
                         : cook != nullptr ? cook->A
                         : hjc != nullptr  ? hjc->fc
                         : soil != nullptr ? std::numbers::sqrt3 * soil->k()
                                           : 0.0;
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(), "| %s | %.0f | %s | %s | %.0f | `%s` | %s | `%s` |", solid.name.c_str(),
                  solid.density, short_number(material::bulk_modulus(solid.eos, solid.density, 0.0) * 1e-9, 1).c_str(),
                  short_number(material::shear_modulus(solid.strength) * 1e-9, 1).c_str(),
                  material::sound_speed(solid, solid.density, 0.0),
                  std::visit([](auto const& m) { return m.name; }, solid.strength),
                  short_number(yield * 1e-6, 0).c_str(),
                  std::visit([](auto const& m) { return m.name; }, solid.failure));
    lines.emplace_back(line.data());
  }
  return lines;
}

}  // namespace brisance::test
