/// Reads the material files of the project for tests and for the table of docs/materials.md. Deliberately separate from
/// the deck reader: it takes every number through the models' parameter tables and accepts nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "material/material.hpp"

namespace brisance::test {

struct MaterialFiles {
  std::vector<material::Explosive> explosives;  ///< sorted by file name
  std::vector<material::Fluid> fluids;
  std::vector<material::Material> solids;
  std::vector<std::string> names;  ///< every name and alias, lower case, once per file
};

/// All files of the project's materials folder. Throws std::runtime_error, naming the file, on a missing or unknown
/// key.
[[nodiscard]] MaterialFiles read_material_files();

/// The Markdown table of docs/materials.md: listed detonation speed and pressure beside those of the constants.
[[nodiscard]] std::vector<std::string> chapman_jouguet_table(std::vector<material::Explosive> const& explosives);

/// The Markdown table of the solids in docs/materials.md.
[[nodiscard]] std::vector<std::string> solid_table(std::vector<material::Material> const& solids);

}  // namespace brisance::test
