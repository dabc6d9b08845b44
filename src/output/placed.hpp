/// What was specified and what the grid holds of it, for `check` and the run log.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "run/panels.hpp"
#include "run/reports.hpp"

namespace brisance::output {

[[nodiscard]] nlohmann::json initial_states_json(std::vector<run::InitialStateReport> const& states);
[[nodiscard]] nlohmann::json obstacles_json(std::vector<run::ObstacleReport> const& obstacles);
/// What became of the panels of a run.
[[nodiscard]] nlohmann::json panels_json(std::vector<run::PanelReport> const& panels);

}  // namespace brisance::output
