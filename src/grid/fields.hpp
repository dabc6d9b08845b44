/// Cell data of all blocks: `components` contiguous arrays per block.
#pragma once

#include <cstddef>
#include <vector>

#include "core/buffer.hpp"
#include "grid/block_store.hpp"
#include "grid/grid.hpp"

namespace brisance::grid {

class Fields {
 public:
  /// All zeros.
  Fields(Grid const& grid, int components)
      : components_(components), data_(grid, [components](Block const& block) {
          auto const pitch = static_cast<std::size_t>(pitch_of(block.cell_count()));
          return Arrays{pitch, Buffer(pitch * components)};
        }) {}

  [[nodiscard]] int components() const { return components_; }
  /// Array of one component in one block, x fastest.
  [[nodiscard]] double* at(int block, int component) {
    Arrays& arrays = data_[block];
    return arrays.data.data() + static_cast<std::size_t>(component) * arrays.pitch;
  }
  [[nodiscard]] double const* at(int block, int component) const {
    Arrays const& arrays = data_[block];
    return arrays.data.data() + static_cast<std::size_t>(component) * arrays.pitch;
  }

  /// When the blocks change, see `BlockStore`; those that are new hold zeros.
  void rearrange(std::vector<Block> const& blocks, std::vector<int> const& before) { data_.rearrange(blocks, before); }

 private:
  struct Arrays {
    std::size_t pitch = 0;
    Buffer data;
  };

  /// Distance of two components: whole cache lines, and not a power of two of them, or the components of a column of
  /// cells would fall into the same few sets of the caches.
  static int pitch_of(int cells) {
    constexpr int line = 8;
    constexpr int apart = 5;
    return (cells + line - 1) / line * line + apart * line;
  }

  int components_;
  BlockStore<Arrays> data_;
};

}  // namespace brisance::grid
