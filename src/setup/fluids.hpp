/// The fluids of a case as the gas scheme takes them.
#pragma once

#include "case/case.hpp"
#include "gas/gas.hpp"

namespace brisance::setup {

/// The fluids of the gas of a case.
[[nodiscard]] gas::Fluids fluids_of(Case const& setup);

}  // namespace brisance::setup
