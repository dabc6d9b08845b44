/// How a domain is cut into blocks, by arithmetic alone: also of domains that no machine can hold.
#pragma once

#include "core/vec.hpp"
#include "grid/geometry.hpp"

namespace brisance::grid {

/// Blocks along each direction. `block_cells` as in `Grid`.
[[nodiscard]] Index3 parts_of(Domain const& domain, int block_cells);

}  // namespace brisance::grid
