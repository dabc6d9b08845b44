/// Rigid obstacles of the gas, and the cells near rigid surfaces: obstacles, walls and planes of symmetry that face a
/// sweep.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gas/kernels.hpp"
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
  /// The same by the index in the domain.
  [[nodiscard]] bool contain(Index3 const& cell) const { return contain(grid_->locate(cell)); }
  /// From now on these cells (domain indices) are gas. Returns the blocks that see it.
  std::vector<int> open(std::vector<Index3> const& cells);

  /// Finds the cells near rigid surfaces once all obstacles are there.
  void find_near_walls();
  /// Those of a bundle of a sweep; null: none.
  [[nodiscard]] std::vector<WallRun> const* near_walls(int block, int direction, int bundle) const;

 private:
  struct OfBlock {
    std::vector<std::uint8_t> solid;
    std::array<std::vector<std::vector<WallRun>>, 3> near_walls;  ///< per direction and bundle; empty: none near
  };
  void find_near_walls(std::vector<int> const& blocks);
  void find_near_walls(grid::Block const& block, int direction, bool any_obstacle);
  /// Blocks that reach, with so many layers around them, into the box of some cells; all where the domain is periodic.
  [[nodiscard]] std::vector<int> blocks_near(std::vector<Index3> const& cells, int layers) const;

  grid::Grid const* grid_;
  int bundle_cells_;
  std::vector<OfBlock> blocks_;
};

}  // namespace brisance::gas
