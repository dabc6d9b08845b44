/// Gauges of the gas in the terminal: what `check` expects of them and what a run has read.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "observe/gauges.hpp"
#include "session/plan.hpp"

namespace brisance::app {

/// Lines about the peaks that the cells will clip; the worst first where there are many.
[[nodiscard]] std::string gauge_plan_text(std::vector<session::GaugePlan> const& gauges);
[[nodiscard]] nlohmann::json gauge_plan_json(std::vector<session::GaugePlan> const& gauges);

/// The tables at the end of a run; empty without gauges.
[[nodiscard]] std::string gauge_tables(run::Case const& setup, std::vector<observe::GaugeHistory> const& histories);

}  // namespace brisance::app
