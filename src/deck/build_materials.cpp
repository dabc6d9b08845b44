/// Materials of a deck: its own and those of the library.
#include <fmt/format.h>

#include <stdexcept>

#include "core/error.hpp"
#include "deck/build.hpp"
#include "deck/parameters.hpp"
#include "material/chapman_jouguet.hpp"

namespace brisance::deck {

void Builder::wrong_material(std::string const& name) {
  if (!report_.failed())
    throw std::logic_error(fmt::format("the material \"{}\" cannot be built, and nothing says why", name));
  wrong_materials_.insert(name);
}

void Builder::own_materials() {
  each("explosives", [&](Section const& section) {
    auto explosive = build_explosive(section, section.name);
    if (!explosive) {
      wrong_material(section.name);
      return;
    }
    try {
      auto const check = material::check(*explosive);
      if (!check.consistent()) {
        report_.warning(
            section.place, section.path,
            fmt::format(
                "the constants give a detonation speed of {:.0f} m/s and a Chapman-Jouguet pressure of {:.4g} GPa; "
                "listed are {:.0f} m/s and {:.4g} GPa",
                check.state.speed, check.state.pressure / 1e9, explosive->detonation_speed,
                explosive->cj_pressure / 1e9));
      }
    } catch (InputError const& e) {
      report_.error(section.place, section.path, fmt::format("these constants describe no detonation: {}", e.what()));
      wrong_material(section.name);
      return;
    }
    if (library().explosive(section.name) != nullptr) {
      report_.warning(section.place, section.path, "replaces the explosive of the same name in the library");
    }
    own_explosives_.push_back(std::move(*explosive));
  });
  each("fluids", [&](Section const& section) {
    auto fluid = build_fluid(section, section.name);
    if (!fluid) {
      wrong_material(section.name);
      return;
    }
    if (library().fluid(section.name) != nullptr) {
      report_.warning(section.place, section.path, "replaces the fluid of the same name in the library");
    }
    own_fluids_.push_back(std::move(*fluid));
  });
}

void Builder::own_solids() {
  each("solids", [&](Section const& section) {
    auto solid = build_solid(section, section.name, report_);
    if (!solid) {
      wrong_material(section.name);
      return;
    }
    if (library().solid(section.name) != nullptr) {
      report_.warning(section.place, section.path, "replaces the solid of the same name in the library");
    }
    own_solids_.push_back(std::move(*solid));
  });
}

material::Explosive const* Builder::explosive(std::string_view name) const {
  auto const* own = find_own(own_explosives_, name);
  return own != nullptr ? own : library().explosive(name);
}

material::Fluid const* Builder::fluid(std::string_view name) const {
  auto const* own = find_own(own_fluids_, name);
  return own != nullptr ? own : library().fluid(name);
}

material::Solid const* Builder::solid(std::string_view name) const {
  auto const* own = find_own(own_solids_, name);
  return own != nullptr ? own : library().solid(name);
}

void Builder::unknown_material(Section const& section, std::string_view key, std::string const& name, char const* kind,
                               std::vector<std::string> const& names) {
  if (wrong_materials_.contains(name)) return;  // reported where it is defined
  error(section, key,
        fmt::format("{} is not a known {}; {}", section.given(key) ? section.shown(key) : fmt::format("\"{}\"", name),
                    kind, suggestion(name, names, fmt::format("known {}s", kind))));
}

std::vector<std::string> Builder::fluid_names() const {
  auto names = library().fluid_names();
  for (auto const& f : own_fluids_) names.push_back(f.name);
  return names;
}

std::vector<std::string> Builder::explosive_names() const {
  auto names = library().explosive_names();
  for (auto const& e : own_explosives_) names.push_back(e.name);
  return names;
}

std::vector<std::string> Builder::solid_names() const {
  auto names = library().solid_names();
  for (auto const& s : own_solids_) names.push_back(s.name);
  return names;
}

std::vector<MaterialNumbers> Builder::materials(run::Case const& built) const {
  std::vector<MaterialNumbers> out;
  auto const add = [&](auto const* material, std::string_view table, bool used) {
    if (material == nullptr) return;
    for (auto const& known : out) {
      if (known.name == material->name) return;
    }
    MaterialNumbers one;
    one.name = material->name;
    one.used = used;
    one.numbers = numbers_of(*material);
    auto const* all = deck_.sections(table);
    for (std::size_t n = 0; all != nullptr && n < all->size(); ++n) {
      if ((*all)[n].name != material->name) continue;
      one.from_library = false;
      note_origin(one.numbers, (*all)[n]);
    }
    if (one.from_library) one.note = library().note(one.name);
    out.push_back(std::move(one));
  };
  if (has_gas_) {
    add(fluid(built.ambient.fluid.name), "fluids", true);
    if (built.second_fluid && built.charges.empty()) {
      add(fluid(built.second_fluid->name), "fluids", true);
      add(explosive(built.second_fluid->name), "explosives", true);
    }
    for (auto const& charge : built.charges) add(explosive(charge.explosive.name), "explosives", true);
  }
  for (auto const& body : built.points.bodies) {
    add(solid(body.solid.name), "solids", true);
    add(explosive(body.solid.name), "explosives", true);
    add(fluid(body.solid.name), "fluids", true);
  }
  for (auto const& own : own_explosives_) add(&own, "explosives", false);
  for (auto const& own : own_fluids_) add(&own, "fluids", false);
  for (auto const& own : own_solids_) add(&own, "solids", false);
  return out;
}

material::Fluid Builder::products(material::Explosive const& e) {
  return {e.name, e.source, e.products, e.density(), material::pressure(e.products, e.density(), e.specific_energy())};
}

}  // namespace brisance::deck
