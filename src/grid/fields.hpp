/// Cell data of all blocks: `components` contiguous arrays per block.
#pragma once

#include <vector>

#include "core/buffer.hpp"
#include "grid/grid.hpp"

namespace brisance::grid {

class Fields {
 public:
  Fields(Grid const& grid, int components) : components_(components) {
    for (Block const& block : grid.blocks()) {
      pitch_.push_back(pitch_of(block.cell_count()));
      data_.emplace_back(static_cast<std::size_t>(pitch_.back()) * components);
    }
  }

  [[nodiscard]] int components() const { return components_; }
  /// Array of one component in one block, x fastest.
  [[nodiscard]] double* at(int block, int component) {
    return data_[block].data() + static_cast<std::size_t>(component) * pitch_[block];
  }
  [[nodiscard]] double const* at(int block, int component) const {
    return data_[block].data() + static_cast<std::size_t>(component) * pitch_[block];
  }

 private:
  /// Distance of two components: whole cache lines, and not a power of two of them, or the components of a column of
  /// cells would fall into the same few sets of the caches.
  static int pitch_of(int cells) {
    constexpr int line = 8;
    constexpr int apart = 5;
    return (cells + line - 1) / line * line + apart * line;
  }

  int components_;
  std::vector<int> pitch_;
  std::vector<Buffer> data_;
};

}  // namespace brisance::grid
