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
      cells_.push_back(block.cell_count());
      data_.emplace_back(static_cast<std::size_t>(block.cell_count()) * components);
    }
  }

  [[nodiscard]] int components() const { return components_; }
  /// Array of one component in one block, x fastest.
  [[nodiscard]] double* at(int block, int component) {
    return data_[block].data() + static_cast<std::size_t>(component) * cells_[block];
  }
  [[nodiscard]] double const* at(int block, int component) const {
    return data_[block].data() + static_cast<std::size_t>(component) * cells_[block];
  }

 private:
  int components_;
  std::vector<int> cells_;
  std::vector<Buffer> data_;
};

}  // namespace brisance::grid
