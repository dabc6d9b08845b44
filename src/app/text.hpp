/// What several parts of the program tell people.
#pragma once

#include <string>

#include "core/text.hpp"
#include "run/audit.hpp"
#include "run/panels.hpp"

namespace brisance::app {

/// What became of a panel.
[[nodiscard]] std::string panel_in_words(run::PanelReport const& panel, grid::Domain const& domain);

/// "balanced", "NOT BALANCED", or, where the drift of the energy is not judged, that.
[[nodiscard]] std::string verdict_word(run::Verdict const& verdict);

/// Why a run does not balance, a line each; a further line where it runs on because it is there for comparison.
[[nodiscard]] std::string verdict_reasons(run::Verdict const& verdict, bool for_comparison);

}  // namespace brisance::app
