/// What becomes of the gas of a case, and what it costs.
#pragma once

#include "case/case.hpp"
#include "session/plan.hpp"

namespace brisance::session {

/// Cells around a shape, in the domain.
[[nodiscard]] double boxed_cells(shape::Shape const& shape, grid::Domain const& domain);

/// The gas: its cells and blocks, charges, initial states and obstacles, and what it takes of memory, steps and disk.
void plan_gas(run::Case const& setup, Plan& plan);

}  // namespace brisance::session
