/// Cells of several sizes: how many a case has at the start, and estimates of how many it will have.
#pragma once

#include <optional>
#include <vector>

#include "case/case.hpp"
#include "grid/grid.hpp"
#include "session/plan.hpp"

namespace brisance::session {

/// The start, as far as it does not depend on the gas.
struct StartLevels {
  std::vector<double> cells;  ///< by level, from 0 on; estimates where there is no grid
  /// Nothing where it has more blocks than a look at the case may make.
  std::optional<grid::Grid> grid;
};

/// Throws InputError where `adaptive.cells` does not suffice, or where charges, the MPM region or [[refine]] ask for
/// finer cells than a surface of an obstacle may have.
[[nodiscard]] StartLevels start_levels(run::Case const& setup);

/// Cells by level. What shocks add later is an estimate: each charge sends out two, which spread freely, as those of
/// strong explosions do and not below the speed of sound, are reflected once by each wall of the domain, and keep a
/// layer of cells.
[[nodiscard]] std::vector<LevelPlan> plan_levels(run::Case const& setup, StartLevels const& start);

}  // namespace brisance::session
