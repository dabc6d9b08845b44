/// The plan of a case, for people and for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "session/plan.hpp"

namespace brisance::app {

[[nodiscard]] std::string plan_text(run::Case const& setup, session::Plan const& plan);
[[nodiscard]] nlohmann::json plan_json(run::Case const& setup, session::Plan const& plan);

}  // namespace brisance::app
