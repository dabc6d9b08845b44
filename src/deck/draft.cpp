/// A case in the making.
#include "deck/draft.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace brisance::deck {

/// "x", "x and y" or "x, y and z".
std::string direction_list(int count) { return count == 1 ? "x" : count == 2 ? "x and y" : "x, y and z"; }

std::string point_text(Vec3 const& p, int dimensions) {
  std::string out = "[";
  for (int d = 0; d < dimensions; ++d) out += fmt::format("{}{:.6g}", d > 0 ? ", " : "", p[d]);
  return out + "]";
}

Section const& Draft::table(std::string_view key) {
  if (auto const* given = deck.section(key)) return *given;
  Section& section = absent[std::string(key)];
  section.table = deck.table->find(key)->table;
  section.path = key;
  return section;
}

std::vector<Section> const& Draft::region_sections() const {
  static std::vector<Section> const none;
  auto const* given = deck.sections("mpm_region");
  return given == nullptr ? none : *given;
}

std::optional<Vec3> Draft::point(Section const& section, std::string_view key) const {
  auto const* values = section.numbers(key);
  if (values == nullptr) return std::nullopt;
  auto const count = static_cast<int>(values->size());
  if (count < dims()) {
    error(section, key,
          fmt::format("{} has {} element{}, but {} resolves {}: give {} elements", section.shown(key), count,
                      count == 1 ? "" : "s", word_of(geometry()), direction_list(dims()), dims()));
    return std::nullopt;
  }
  Vec3 p{0.0, 0.0, 0.0};
  for (int d = 0; d < count; ++d) {
    if (d >= dims() && (*values)[d] != 0.0) {
      error(section, key,
            fmt::format("{} has a value in direction {}, but {} resolves only {}: remove it or write 0",
                        section.shown(key), directions[d], word_of(geometry()), direction_list(dims())));
      return std::nullopt;
    }
    p[d] = (*values)[d];
  }
  return p;
}

namespace {

template <class Material>
Material const* own_or(std::vector<Material> const& own, std::string_view name, Material const* other) {
  auto const* found = find_own(own, name);
  return found != nullptr ? found : other;
}

template <class Material>
std::vector<std::string> with_own(std::vector<std::string> names, std::vector<Material> const& own) {
  for (auto const& material : own) names.push_back(material.name);
  return names;
}

}  // namespace

material::Explosive const* Materials::explosive(std::string_view name) const {
  return own_or(explosives, name, library().explosive(name));
}
material::Fluid const* Materials::fluid(std::string_view name) const {
  return own_or(fluids, name, library().fluid(name));
}
material::Material const* Materials::solid(std::string_view name) const {
  return own_or(solids, name, library().solid(name));
}

std::vector<std::string> Materials::explosive_names() const {
  return with_own(library().explosive_names(), explosives);
}
std::vector<std::string> Materials::fluid_names() const { return with_own(library().fluid_names(), fluids); }
std::vector<std::string> Materials::solid_names() const { return with_own(library().solid_names(), solids); }

void wrong_material(Draft& draft, std::string const& name) {
  if (!draft.report.failed())
    throw std::logic_error(fmt::format("the material \"{}\" cannot be built, but no error was reported", name));
  draft.materials.wrong.insert(name);
}

void unknown_material(Draft const& draft, Section const& section, std::string_view key, std::string const& name,
                      char const* kind, std::vector<std::string> const& names) {
  if (draft.materials.wrong.contains(name)) return;  // reported where it is defined
  draft.error(
      section, key,
      fmt::format("{} is not a known {}; {}", section.given(key) ? section.shown(key) : fmt::format("\"{}\"", name),
                  kind, suggestion(name, names, fmt::format("known {}s", kind))));
}

material::Fluid products(material::Explosive const& e) {
  return {e.name, e.source, e.products, e.density(), material::pressure(e.products, e.density(), e.specific_energy())};
}

}  // namespace brisance::deck
