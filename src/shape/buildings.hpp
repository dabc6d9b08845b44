/// Buildings from footprints with heights.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "shape/heights.hpp"
#include "shape/mesh.hpp"

namespace brisance::shape {

/// How a file of footprints is understood.
struct BuildingFile {
  std::filesystem::path path;
  std::string height = "height";         ///< column or property with the height of a building above its base
  std::string base = "base";             ///< the one with the height of its base
  std::optional<double> default_height;  ///< [m] of buildings that have none
  Frame frame;
};

/// The buildings of a file as one body: upright prisms, which may touch and overlap. GeoJSON with Polygons and
/// MultiPolygons, or CSV with the columns building, x, y and one row per corner, where a column `ring` numbers outline
/// and holes. A building without a base stands on `terrain`: it reaches into the ground, and its height counts from the
/// lowest ground under its corners; without a terrain it stands at the height of the frame's position. Throws
/// InputError with file, line or feature, and value.
[[nodiscard]] Mesh read_buildings(BuildingFile const& file, Heights const* terrain = nullptr);

}  // namespace brisance::shape
