#include "deck/library.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string>

#include "core/error.hpp"
#include "deck/embedded.hpp"
#include "deck/reader.hpp"
#include "deck/schema.hpp"
#include "deck/tables/tables.hpp"

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

void check(Report const& report, EmbeddedFile const& file) {
  if (!report.failed()) return;
  std::string message = fmt::format("the material file {} of this build is wrong", file.name);
  for (auto const& error : report.errors()) message += fmt::format("\n{}", format(error));
  throw InputError(message);
}

template <class Material>
Named<Material> named(std::optional<Material> material, Section const& section) {
  if (!material)
    throw std::logic_error(fmt::format("the material of {} cannot be built, but no error was reported",
                                       section.text("name").value_or("?")));
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
material::Material const* Library::solid(std::string_view name) const { return find(solids, name); }
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

}  // namespace brisance::deck
