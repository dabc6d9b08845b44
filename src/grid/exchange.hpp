/// Exchange between blocks: the only way by which data of one block reaches another. Message passing can stand behind
/// the same two functions.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/buffer.hpp"
#include "grid/block_store.hpp"
#include "grid/exchange_plan.hpp"
#include "grid/fields.hpp"
#include "grid/grid.hpp"

namespace brisance::grid {

/// What the ghost cells outside the domain and the sleeping blocks need to know of the data.
struct ExchangeRules {
  /// Per direction the component that changes sign in a mirror (the momentum along it).
  std::array<int, 3> mirrored_component{-1, -1, -1};
  /// Per face the values of all components beyond it, where they are given (`is_given`).
  std::array<std::vector<double>, 6> inflow;
  /// Values of all components in a quiescent cell.
  std::vector<double> quiescent;
};

class Exchange {
 public:
  /// Between the blocks of the plan's chains nothing is copied.
  Exchange(Grid const& grid, int components, ExchangeRules rules, int bundle_cells = 0);

  [[nodiscard]] ExchangePlan const& plan() const { return plan_; }

  /// Fills the ghost layers of every block that is awake on both faces of `direction`, and wakes the sleeping blocks
  /// that get to see anything but quiescent cells. Calls then(block) for each block whose ghost cells have been filled,
  /// from several threads.
  void fill(Fields const& fields, int direction, AwakeBlocks& awake, std::function<void(int)> const& then = {}) {
    for (int level = 0; level < grid_->levels(); ++level) fill(fields, level, direction, awake, then, {});
  }
  /// The same for the blocks of one level. finer(block, face, ghosts) makes the ghost cells beyond which cells are
  /// coarser: per component an array over `ghost_box`.
  void fill(Fields const& fields, int level, int direction, AwakeBlocks& awake, std::function<void(int)> const& then,
            std::function<void(int, int, double*)> const& finer);

  /// Ghost cells of a block beyond its low (side 0) or high (side 1) face, as last filled: per component an array over
  /// `ghost_box`, which is like the block but with `ghost_layers` cells in the direction of the fill. Where the plan
  /// `links` the face there are none.
  [[nodiscard]] double const* ghosts(int block, int side) const { return slabs_[block][side].data(); }
  /// To overwrite them; beyond outflow boundaries they hold copies of the cells next to the face.
  [[nodiscard]] double* ghosts(int block, int side) { return slabs_[block][side].data(); }

  /// When the grid's blocks have changed, see `BlockStore`: makes the plan again. `fill` comes next.
  void follow_blocks(std::vector<int> const& before);

 private:
  using Slabs = std::array<Buffer, 2>;  ///< of a block's low and high side, for the direction with the largest faces

  /// Gives the blocks slabs of the size that the plan asks for, as far as theirs have another.
  void fit_slabs();
  void execute(Transfer const& transfer, Fields const& fields, Block const& block,
               std::function<void(int, int, double*)> const& finer);
  /// Could a sleeping block see anything but quiescent cells across its two faces of `direction`?
  [[nodiscard]] bool anything_to_see(int block, int direction) const;
  /// Are the ghost cells quiescent that a transfer has filled, or those that the sweep will read in its place?
  [[nodiscard]] bool sees_quiescence(Transfer const& transfer, Fields const& fields, int block) const;
  /// Does a transfer make anything but quiescent cells for a block that is asleep?
  [[nodiscard]] bool disturbs(Transfer const& transfer) const;

  Grid const* grid_;
  int components_;
  int bundle_cells_;
  ExchangeRules rules_;
  ExchangePlan plan_;
  BlockStore<Slabs> slabs_;
  AwakeBlocks was_awake_;
};

}  // namespace brisance::grid
