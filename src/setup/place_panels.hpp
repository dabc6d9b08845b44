/// Obstacles of a case that give way become panels.
#pragma once

#include <vector>

#include "run/panels.hpp"
#include "setup/solid_cells.hpp"

namespace brisance::setup {

/// Throws InputError where an obstacle cannot be a panel.
[[nodiscard]] run::PanelPlace place_panel(grid::Domain const& domain, std::vector<Obstacle> const& obstacles,
                                          SolidCells const& solid, std::size_t number);

/// All panels among the obstacles. Throws InputError where one cannot be a panel.
[[nodiscard]] std::vector<run::PanelReport> place_panels(grid::Domain const& domain,
                                                         std::vector<Obstacle> const& obstacles,
                                                         SolidCells const& solid);

}  // namespace brisance::setup
