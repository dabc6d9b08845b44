/// Zones of broken concrete in summaries and run log.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "observe/zones.hpp"

namespace brisance::output {

/// A list with one entry per body of concrete; empty without one.
[[nodiscard]] nlohmann::json broken_zones_json(run::System const& system);

}  // namespace brisance::output
