/// The library of materials: the files of materials/, embedded in the program at build time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "material/material.hpp"

namespace brisance::deck {

template <class Material>
struct Named {
  Material material;
  std::vector<std::string> aliases;
  std::string note;  ///< what it is for and how far off it is; empty for most
};

struct Library {
  std::vector<Named<material::Explosive>> explosives;  ///< in alphabetical order
  std::vector<Named<material::Fluid>> fluids;          ///< in alphabetical order
  std::vector<Named<material::Material>> solids;       ///< in alphabetical order

  /// By name or alias, case aside; null when unknown.
  [[nodiscard]] material::Explosive const* explosive(std::string_view name) const;
  [[nodiscard]] material::Fluid const* fluid(std::string_view name) const;
  [[nodiscard]] material::Material const* solid(std::string_view name) const;
  /// The note of the material of that name, "" without one.
  [[nodiscard]] std::string note(std::string_view name) const;
  /// All names, without the aliases.
  [[nodiscard]] std::vector<std::string> explosive_names() const;
  [[nodiscard]] std::vector<std::string> fluid_names() const;
  [[nodiscard]] std::vector<std::string> solid_names() const;
};

/// The embedded library, read once. A file of it that does not fit the schema throws InputError.
[[nodiscard]] Library const& library();

/// For `brisance info`: all materials in one table each, and how to see more.
[[nodiscard]] std::string describe_library();

/// All parameters of a material with unit, meaning and source. Throws InputError with the nearest names for an unknown
/// one.
[[nodiscard]] std::string describe_material(std::string const& name);

/// For `brisance info`: geometries, boundaries, shapes, equations of state with their parameters, schemes, fields.
[[nodiscard]] std::string describe_models();

}  // namespace brisance::deck
