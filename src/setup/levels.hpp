/// Cells of several sizes: what a case asks for, where, and what obstacles are on each level.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "case/case.hpp"
#include "gas/gas.hpp"
#include "gas/refinement.hpp"
#include "grid/forest.hpp"

namespace brisance::setup {

/// Layers of cells around whatever asks for a level that get it too.
inline constexpr int level_margin = 4;

/// Obstacles on cells of all levels. Their surfaces lie on one level, `Adaptive::obstacles`, as far as they do not fit
/// the faces of larger cells: there the gas sees parts of cells.
class LevelObstacles {
 public:
  explicit LevelObstacles(Case const& setup);

  [[nodiscard]] bool any() const { return !shapes_.empty(); }
  /// Do the obstacles leave no cell of some, and of those around, open in part?
  [[nodiscard]] bool fit(int level, grid::CellRange const& cells) const;
  /// Marks the obstacles of blocks that are new and sets all cut cells. Throws InputError where a surface lies in cells
  /// of a finer level than its own.
  void furnish(gas::Gas& gas, std::vector<int> const& new_blocks) const;
  /// What a block of a level would mark, whether there is one or not. Threads may ask at once.
  [[nodiscard]] bool solid(int level, Index3 const& cell) const;

 private:
  /// What obstacles make of a block.
  struct OfBlock {
    std::vector<std::uint8_t> solid;  ///< over `Block::with_ghosts`; empty: none
    std::vector<shape::CutCell> cut;
  };
  /// Of a block that has some cells of the domain.
  [[nodiscard]] OfBlock const& of(int level, grid::CellRange const& cells) const;
  [[nodiscard]] OfBlock find(int level, grid::CellRange const& cells) const;

  std::vector<shape::Shape> shapes_;
  grid::Domain domain_;
  Index3 block_size_;
  int level_;
  int finest_;
  bool cut_;
  /// By the level and the index of the first cell.
  mutable std::map<std::pair<int, Index3>, OfBlock> known_;
  mutable std::mutex mutex_;
  mutable std::map<std::pair<int, Index3>, bool> fits_;
};

/// What the parts of the domain ask for whatever the gas does: [[refine]], gauges, the MPM region, obstacles.
[[nodiscard]] gas::RefinementRules::Bounds level_bounds(Case const& setup,
                                                        std::shared_ptr<LevelObstacles const> const& obstacles);

/// Two regions of different levels so near to each other that blocks, which have cells of one level, cannot give both
/// the cells that they need; nothing: there are none.
[[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> regions_without_own_blocks(Case const& setup);

/// What charges ask for until they have burst.
[[nodiscard]] gas::RefinementRules::Bounds charge_bounds(Case const& setup);

/// How the gas of a case is refined.
[[nodiscard]] gas::RefinementRules refinement_rules(Case const& setup,
                                                    std::shared_ptr<LevelObstacles const> const& obstacles);

/// Steps between two changes of the blocks.
[[nodiscard]] int steps_between_changes(Case const& setup);

/// The blocks of the start, as far as they do not depend on the gas. Throws InputError where they have more cells than
/// `Adaptive::most_cells`.
[[nodiscard]] grid::Forest start_forest(Case const& setup, std::shared_ptr<LevelObstacles const> const& obstacles);

}  // namespace brisance::setup
