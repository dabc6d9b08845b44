/// How a domain is cut into blocks, by arithmetic alone: also of domains that no machine can hold.
#pragma once

#include "core/vec.hpp"
#include "grid/geometry.hpp"

namespace brisance::grid {

/// Blocks of one size, from the low corner of the domain on. The last ones of a direction may reach beyond the domain;
/// what lies there is no part of them.
struct Partition {
  Index3 size{1, 1, 1};   ///< cells of a block along each direction
  Index3 parts{1, 1, 1};  ///< blocks along each direction

  [[nodiscard]] double count() const { return static_cast<double>(parts[0]) * parts[1] * parts[2]; }
  /// Cells of the domain in the last block along a direction with so many cells.
  [[nodiscard]] int rest(int d, int cells) const { return cells - (parts[d] - 1) * size[d]; }
};

/// The partition into blocks of `block_cells`, see `Grid`.
[[nodiscard]] Partition partition_of(Domain const& domain, int block_cells);

/// The same of blocks that may be refined: of an even number of cells, with a rest that is large enough, or none along
/// periodic directions. `block_cells` = 0: 16. Throws InputError where there is none.
[[nodiscard]] Partition refinable_partition_of(Domain const& domain, int block_cells);

}  // namespace brisance::grid
