/// A case in the making: the deck, what its tables have given so far, and what is known by then. The builders of
/// tables/ fill it, one for each table.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "case/case.hpp"
#include "deck/library.hpp"
#include "deck/reader.hpp"
#include "setup/solid_cells.hpp"

namespace brisance::deck {

using grid::Boundary;
using grid::Geometry;

inline constexpr char const* directions = "xyz";

/// "[1, 2, 3]", the resolved directions.
[[nodiscard]] std::string point_text(Vec3 const& p, int dimensions);

/// "x", "x and y" or "x, y and z".
[[nodiscard]] std::string direction_list(int count);

/// Sets a choice to the word that a section gives, if it gives one.
template <class E>
void choose(Section const& section, std::string_view key, E& choice) {
  auto const word = section.text(key);
  if (auto const value = word ? value_of<E>(*word) : std::nullopt) choice = *value;
}

/// The materials that a deck can name: its own come before those of the library.
struct Materials {
  std::vector<material::Explosive> explosives;  ///< the deck's own
  std::vector<material::Fluid> fluids;
  std::vector<material::Material> solids;
  std::set<std::string, std::less<>> wrong;  ///< names of own materials with an error of their own

  [[nodiscard]] material::Explosive const* explosive(std::string_view name) const;
  [[nodiscard]] material::Fluid const* fluid(std::string_view name) const;
  [[nodiscard]] material::Material const* solid(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> explosive_names() const;
  [[nodiscard]] std::vector<std::string> fluid_names() const;
  [[nodiscard]] std::vector<std::string> solid_names() const;
};

template <class Material>
Material const* find_own(std::vector<Material> const& all, std::string_view name) {
  for (auto const& m : all) {
    if (m.name == name) return &m;
  }
  return nullptr;
}

/// What may begin later than at the start.
struct Onset {
  Section const* section;
  double time;             ///< [s]
  std::string_view key;    ///< that tells it
  std::string_view never;  ///< what does not happen where it lies after the end
};

struct Draft {
  Draft(Section const& the_deck, Report& the_report) : deck(the_deck), report(the_report) {}

  Section const& deck;
  Report& report;
  run::Case out;
  Materials materials;

  bool geometry_known = false;  ///< without it, nothing about positions can be said
  bool domain_known = false;    ///< extents are known and sound
  bool boundaries_known = false;
  bool ambient_known = false;  ///< the fluid is known
  bool products_known = true;  ///< false when a charge's explosive was wrong
  bool end_known = false;
  bool has_gas = true;

  std::vector<std::pair<std::size_t, shape::Shape>> obstacle_shapes;  ///< index of the section, shape
  std::vector<std::pair<Section const*, shape::Shape>> charge_shapes;
  std::vector<Section const*> initial_state_sections;    ///< of those of the case, in their order
  std::vector<Section const*> constraint_sections;       ///< of its constraints
  std::vector<std::string> body_names;                   ///< of all bodies, also of those with errors
  std::vector<std::optional<shape::Shape>> body_shapes;  ///< in the same order; nothing after an error
  std::vector<Onset> onsets;
  std::map<std::string, Section, std::less<>> absent;  ///< tables that the deck does not have, see `table`
  std::vector<int> region_levels{0};  ///< of the cells that material points see: of each MPM region, one at least
  std::vector<int> body_regions;      ///< number of the region that holds each body
  bool bodies_assigned = true;        ///< false where some body has none, or several

  [[nodiscard]] Geometry geometry() const { return out.domain.geometry; }
  [[nodiscard]] int dims() const { return out.domain.dimensions(); }
  [[nodiscard]] bool radial() const { return grid::radial_exponent(geometry()) > 0; }
  /// Lengths below this are round-off [m].
  [[nodiscard]] double tiny() const { return 1e-6 * out.domain.h; }
  /// The cells that the particles of a body see; -1: those of all bodies, with several regions their coarsest.
  [[nodiscard]] grid::Domain particle_domain(int body = -1) const {
    auto const known = static_cast<std::size_t>(body) < body_regions.size();
    return out.domain_of(known ? region_levels[static_cast<std::size_t>(body_regions[static_cast<std::size_t>(body)])]
                               : *std::ranges::min_element(region_levels));
  }
  /// The tables of the MPM regions; none where the deck leaves the region to the program.
  [[nodiscard]] std::vector<Section> const& region_sections() const;
  [[nodiscard]] bool has_several_regions() const { return region_levels.size() > 1; }
  /// The domain as if all its cells were as large as those at surfaces of obstacles.
  [[nodiscard]] grid::Domain obstacle_domain() const { return out.domain_of(out.adaptive.obstacles); }
  /// The key that sets the size of those cells.
  [[nodiscard]] char const* obstacle_cell_key() const {
    return out.adaptive.any() ? "adaptive.obstacles" : "domain.cell";
  }
  [[nodiscard]] bool has_bodies() const { return deck.given("body"); }

  void error(Section const& section, std::string_view key, std::string const& message) const {
    report.error(section.place_of(key), section.path_of(key), message);
  }
  void warn(Section const& section, std::string_view key, std::string const& message) const {
    report.warning(section.place_of(key), section.path_of(key), message);
  }
  /// The table under the key; without one in the deck an empty one, which holds the defaults.
  [[nodiscard]] Section const& table(std::string_view key);
  template <class F>
  void each(std::string_view key, F f) const {
    auto const* all = deck.sections(key);
    if (all == nullptr) return;
    for (auto const& section : *all) f(section);
  }
  /// A point or vector: one element per resolved direction; the others may be written as 0.
  [[nodiscard]] std::optional<Vec3> point(Section const& section, std::string_view key) const;
};

/// Notes that a material of the deck has an error; throws std::logic_error where none was reported.
void wrong_material(Draft& draft, std::string const& name);

/// Reports a material that is neither the deck's own nor of the library.
void unknown_material(Draft const& draft, Section const& section, std::string_view key, std::string const& name,
                      char const* kind, std::vector<std::string> const& names);

/// The products of an explosive as a fluid; density and pressure are those of an instantaneous detonation.
[[nodiscard]] material::Fluid products(material::Explosive const& e);

}  // namespace brisance::deck
