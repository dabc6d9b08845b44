/// Where the gas may differ from the quiescent state: in tiles of some cells along each direction. A bundle that
/// touches no disturbed tile need not be swept, see sleep.cpp.
#pragma once

#include <cstdint>
#include <vector>

#include "gas/kernels.hpp"
#include "grid/block_store.hpp"
#include "grid/fields.hpp"
#include "grid/tiles.hpp"

namespace brisance::gas {

class Disturbance {
 public:
  explicit Disturbance(grid::Grid const& grid);

  /// Finds the disturbed tiles of all blocks. Tiles do not come to rest again.
  void find(grid::Fields const& fields, Components const& quiet);
  void find(grid::Fields const& fields, Components const& quiet, int block);
  /// When the blocks change, see `BlockStore`; for those that are new call `find`.
  void rearrange(std::vector<grid::Block> const& blocks, std::vector<int> const& before) {
    blocks_.rearrange(blocks, before);
  }
  /// Somebody has changed a cell.
  void note(grid::Cell const& cell);
  /// Notes what a sweep has disturbed in a bundle. Threads may do so for several bundles of a block at the same time.
  void note(int block, BundleLayout const& layout, SweepContext const& context, Components const& quiet,
            BundleArrays& arrays);
  /// Do a bundle's own cells touch a disturbed tile? Threads may ask while others note something.
  [[nodiscard]] bool touches(int block, BundleLayout const& layout);

 private:
  struct OfBlock {
    grid::Tiles tiles;
    std::vector<std::uint8_t> disturbed;
    std::uint8_t everywhere = 1;  ///< all tiles are
  };

  grid::Grid const* grid_;
  grid::BlockStore<OfBlock> blocks_;
};

}  // namespace brisance::gas
