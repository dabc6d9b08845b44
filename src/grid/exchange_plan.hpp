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
  none,    ///< the sweep reads the cells of the next block in the chain itself
  mirror,  ///< cells in reverse order along the direction; one component changes its sign
  fill,    ///< values that are given for a face of the domain
  repeat,  ///< one layer of cells, over and over
  finer,   ///< made of coarser cells, by whoever calls the exchange
};

/// Fills a box of the ghost cells beyond one face of a block.
struct Transfer {
  TransferKind kind = TransferKind::copy;
  int face = 0;               ///< of the block, across which it sees these ghost cells
  int source = no_neighbour;  ///< the block that gives; `fill`: none; `finer`: the coarser block beyond the face
  CellRange from{};           ///< cells that it gives, by their index within it
  CellRange to{};             ///< ghost cells, by their index in `ghost_box`
};

/// The ghost cells of a block beyond a face along a direction, by an index of their own.
[[nodiscard]] CellRange ghost_box(Block const& block, int direction);

/// Blocks one behind the other along a direction. A sweep takes the same bundle of all of them in turn, from the low
/// end on, and between them no ghost cells are copied: those above a bundle still lie in the next block as they were,
/// and those below are kept from the block before (`KeptLayers`).
using Chain = std::vector<int>;

class ExchangePlan {
 public:
  /// Chains are made for bundles of about so many cells; 0: each block is a chain of its own.
  explicit ExchangePlan(Grid const& grid, int bundle_cells = 0);

  /// What fills the ghost cells of a block along a direction: all of its low side, then of its high side.
  [[nodiscard]] std::span<Transfer const> into(int block, int direction) const {
    std::vector<std::size_t> const& first = first_[direction];
    return {transfers_[direction].data() + first[block], first[block + 1] - first[block]};
  }
  /// All blocks, each in one chain. The chains do not depend on the number of threads.
  [[nodiscard]] std::vector<Chain> const& chains(int direction) const { return chains_[direction]; }
  /// Does the chain go on behind a face of the block?
  [[nodiscard]] bool links(int block, int face) const {
    return into(block, face / 2)[face % 2].kind == TransferKind::none;
  }

 private:
  void make_chains(Grid const& grid, int direction, int bundle_cells);

  std::array<std::vector<Transfer>, 3> transfers_;
  std::array<std::vector<Chain>, 3> chains_;
  std::array<std::vector<std::size_t>, 3> first_;  ///< of each block, and the number of all
};

}  // namespace brisance::grid
