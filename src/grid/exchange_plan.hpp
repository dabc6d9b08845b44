/// What an exchange between blocks does, as a list: for each direction and block the operations that fill its ghost
/// layers. It is made once from the blocks, and made again when they change.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "grid/grid.hpp"

namespace brisance::grid {

enum class TransferKind : std::uint8_t {
  copy,    ///< cells of a block
  mirror,  ///< cells in reverse order along the direction; one component changes its sign
  fill,    ///< values that are given for a face of the domain
  repeat,  ///< one layer of cells, over and over
};

/// Fills a box of the ghost cells beyond one face of a block.
struct Transfer {
  TransferKind kind = TransferKind::copy;
  int face = 0;               ///< of the block, across which it sees these ghost cells
  int source = no_neighbour;  ///< the block that gives; `fill`: none
  CellRange from{};           ///< cells that it gives, by their index within it
  CellRange to{};             ///< ghost cells, by their index in `ghost_box`
};

/// The ghost cells of a block beyond a face along a direction, by an index of their own.
[[nodiscard]] CellRange ghost_box(Block const& block, int direction);

class ExchangePlan {
 public:
  explicit ExchangePlan(Grid const& grid);

  /// What fills the ghost cells of a block along a direction: all of its low side, then of its high side.
  [[nodiscard]] std::span<Transfer const> into(int block, int direction) const {
    std::vector<std::size_t> const& first = first_[direction];
    return {transfers_[direction].data() + first[block], first[block + 1] - first[block]};
  }

 private:
  std::array<std::vector<Transfer>, 3> transfers_;
  std::array<std::vector<std::size_t>, 3> first_;  ///< of each block, and the number of all
};

}  // namespace brisance::grid
