/// What the leaves of a forest make of the blocks of a grid.
#pragma once

#include <vector>

#include "grid/forest.hpp"
#include "grid/grid.hpp"

namespace brisance::grid {

/// A block that a grid needs, and which of its parts count, bit by bit: those that no finer blocks cover. See
/// `Block::covered_parts`.
struct Piece {
  Leaf at;
  unsigned counting = 0;
};

/// The place of a block.
[[nodiscard]] Leaf leaf_at(Block const& block);

/// Blocks of leaves, and those that hold the cells of leaves that are left coarse; no leaf outside the domain.
/// `domains`: of each level, `size`: cells of a block.
[[nodiscard]] std::vector<Piece> pieces_of(Forest const& forest, std::vector<Domain> const& domains,
                                           Index3 const& size);

/// The blocks below the leaves of finer levels that touch counting parts of their own level, be it at a corner.
[[nodiscard]] std::vector<Piece> pieces_below(std::vector<Piece> const& pieces, std::vector<Domain> const& domains,
                                              Index3 const& size);

}  // namespace brisance::grid
