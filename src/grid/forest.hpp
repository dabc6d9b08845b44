/// Provisional.
#pragma once

#include "core/vec.hpp"

namespace brisance::grid {

/// A leaf of the forest: a block of a level.
struct Leaf {
  int level = 0;
  Index3 place{0, 0, 0};  ///< in blocks of its level
  bool operator==(Leaf const&) const = default;
};

}  // namespace brisance::grid
