/// Gauges of the gas in the terminal: what `check` expects of them and what a run has read.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "observe/expected_peak.hpp"
#include "observe/gauges.hpp"

namespace brisance::app {

/// What `check` expects at a gauge of the gas.
struct GaugePlan {
  std::string name;
  std::optional<observe::ExpectedPeak> peak;  ///< nothing where the curves do not tell
};

[[nodiscard]] std::vector<GaugePlan> plan_gauges(run::Case const& setup);

/// Lines about the peaks that the cells will clip; the worst first where there are many.
[[nodiscard]] std::string gauge_plan_text(std::vector<GaugePlan> const& gauges);
[[nodiscard]] nlohmann::json gauge_plan_json(std::vector<GaugePlan> const& gauges);

/// A warning where a peak will be clipped by much, with the cell that would do.
[[nodiscard]] std::optional<std::string> clipping_warning(std::vector<GaugePlan> const& gauges, double cell);

/// The tables at the end of a run; empty without gauges.
[[nodiscard]] std::string gauge_tables(run::Case const& setup, std::vector<observe::GaugeHistory> const& histories);

}  // namespace brisance::app
