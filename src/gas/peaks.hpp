/// Peak fields of the gas: largest overpressure and largest running impulse of every cell.
#pragma once

#include <utility>
#include <vector>

#include "core/buffer.hpp"
#include "grid/block_store.hpp"
#include "grid/bundle.hpp"

namespace brisance {
class Archive;
}

namespace brisance::gas {

class Peaks {
 public:
  /// Keeps nothing unless `wanted`.
  Peaks(grid::Grid const& grid, bool wanted);

  /// Of a block, x fastest: peak overpressure [Pa], largest running impulse [Pa s]. Null where nothing is kept.
  [[nodiscard]] double const* overpressure(int block) const { return of(block, peak_pressure); }
  [[nodiscard]] double const* impulse(int block) const { return of(block, largest_impulse); }

  /// Takes in the pressures [Pa] of a bundle's own cells after a step dt [s]; `ambient`: of quiescent gas [Pa].
  void follow(int block, grid::BundleLayout const& layout, double const* pressure, double ambient, double dt);
  /// The same for one cell, of its overpressure [Pa].
  void follow(grid::Cell const& cell, double overpressure, double dt);
  /// Asks for what `follow` will read of a cell.
  void announce(grid::Cell const& cell) const;
  /// Adds what `follow` will read of a block.
  void announce(int block, grid::Ahead& ahead) const;
  /// Values that are kept of each cell.
  [[nodiscard]] int values() const { return wanted_ ? peak_count : 0; }
  [[nodiscard]] double const* values_of(int block, int value) const { return of(block, static_cast<Peak>(value)); }
  [[nodiscard]] double* values_of(int block, int value);
  /// All of a block, value by value.
  void put(int block, Buffer values) { blocks_[block] = std::move(values); }
  /// When the blocks change, see `BlockStore`.
  void rearrange(std::vector<grid::Block> const& blocks, std::vector<int> const& before) {
    blocks_.rearrange(blocks, before);
  }
  /// A block's fields in a checkpoint.
  void archive(Archive& a, int block);

 private:
  enum Peak : int { peak_pressure, running_impulse, largest_impulse, peak_count };
  [[nodiscard]] double const* of(int block, Peak peak) const;

  grid::Grid const* grid_;
  bool wanted_;
  grid::BlockStore<Buffer> blocks_;  ///< empty ones where nothing is kept
};

}  // namespace brisance::gas
