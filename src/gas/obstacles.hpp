/// Rigid obstacles of the gas, and the cells near rigid surfaces: obstacles, walls and planes of symmetry that face a
/// sweep.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "gas/kernels.hpp"
#include "grid/block_store.hpp"
#include "grid/grid.hpp"

namespace brisance::gas {

class Obstacles {
 public:
  /// `bundle_cells`: those of the sweeps.
  Obstacles(grid::Grid const& grid, int bundle_cells);

  /// Marks the obstacle cells of a block (1: solid), over `Block::with_ghosts`.
  void set(int block, std::vector<std::uint8_t> solid) { blocks_[block].solid = std::move(solid); }
  /// The marks of a block; empty: it holds none.
  [[nodiscard]] std::vector<std::uint8_t> const& solid(int block) const { return blocks_[block].solid; }
  [[nodiscard]] bool contain(grid::Cell const& cell) const;
  /// The same by the index in the domain of a level. Where the level has no cells `Elsewhere` tells.
  [[nodiscard]] bool contain(int level, Index3 const& cell) const;
  /// Is a cell solid in a place where its level has no blocks: what a block there would mark. What is near a wall must
  /// not depend on which blocks there are, for it is found when a block comes, and both sides of a face must agree.
  using Elsewhere = std::function<bool(int level, Index3 const& cell)>;
  /// Several threads ask at once. Without it nothing is solid there.
  void set_elsewhere(Elsewhere elsewhere) { elsewhere_ = std::move(elsewhere); }
  /// From now on these cells of a level (domain indices) are gas. Returns the blocks that see it.
  std::vector<int> open(int level, std::vector<Index3> const& cells);

  /// When the blocks change, see `BlockStore`: new ones hold none.
  void rearrange(grid::Grid const& old, std::vector<grid::Block> const& blocks, std::vector<int> const& before);
  /// Does any block hold some?
  [[nodiscard]] bool any() const;

  /// Finds the cells near rigid surfaces once all obstacles are there, in all blocks or in some.
  void find_near_walls();
  /// Where a block has been before they are known.
  void find_near_walls(std::vector<int> const& new_blocks);
  /// Those of a bundle of a sweep; null: none.
  [[nodiscard]] std::vector<WallRun> const* near_walls(int block, int direction, int bundle) const;

 private:
  using NearWalls = std::array<std::vector<std::vector<WallRun>>, 3>;  ///< per direction and bundle; empty: none near
  struct OfBlock {
    std::vector<std::uint8_t> solid;
    NearWalls near_walls;
  };
  void find_near_walls_of(std::vector<int> const& blocks);
  void find_near_walls(grid::Block const& block, int direction, bool any_obstacle);
  /// The marks of a block; no block: they are found cell by cell.
  struct Marks {
    grid::Block const* block = nullptr;
    std::vector<std::uint8_t> const* solid = nullptr;
    /// Of a cell on the line of one along a direction.
    [[nodiscard]] char at(grid::Cell const& line, Index3 const& cell, int d) const;
  };
  /// Of a block and of those below and above it, where they are of its level and at least so long.
  [[nodiscard]] std::array<Marks, 3> marks_along(grid::Block const& block, int d, int reach) const;
  /// Do a block or those beside it in a direction hold any?
  [[nodiscard]] bool reach_obstacle(grid::Block const& block, int direction) const;
  /// Blocks that reach, with so many layers around them, into the box of some cells; all where the domain is periodic.
  [[nodiscard]] std::vector<int> blocks_near(int level, std::vector<Index3> const& cells, int layers) const;

  grid::Grid const* grid_;
  int bundle_cells_;
  grid::BlockStore<OfBlock> blocks_;
  Elsewhere elsewhere_;
  /// Of blocks that have gone, by the level and the index of the first cell.
  std::map<std::pair<int, Index3>, NearWalls> gone_;
};

}  // namespace brisance::gas
