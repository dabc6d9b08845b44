/// What the forest leaves to p4est. Only forest_p4est.cpp includes the headers of that library.
#pragma once

#include <cstdint>
#include <vector>

#include "grid/forest.hpp"

namespace brisance::grid {

/// The leaves after `Forest::adapt`, in order. Only for forests that can be refined.
[[nodiscard]] std::vector<Leaf> leaves_by_p4est(Forest const& forest, std::vector<std::int8_t> const& marks,
                                                int most_level);

}  // namespace brisance::grid
