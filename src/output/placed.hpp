/// What was asked for and what the grid holds of it, for `check` and the run log.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "run/panels.hpp"
#include "setup/place_gas_regions.hpp"
#include "setup/solid_cells.hpp"

namespace brisance::output {

[[nodiscard]] nlohmann::json regions_json(std::vector<setup::RegionReport> const& regions);
[[nodiscard]] nlohmann::json obstacles_json(std::vector<setup::ObstacleReport> const& obstacles);
/// What became of the panels of a run.
[[nodiscard]] nlohmann::json panels_json(std::vector<run::PanelReport> const& panels);

}  // namespace brisance::output
