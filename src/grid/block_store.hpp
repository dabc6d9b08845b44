/// Data of blocks: one value for each block of a grid, by the block's number. The blocks of a grid may come, go and
/// change their numbers; whatever is kept per block lies in a store and follows them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/archive.hpp"
#include "grid/grid.hpp"

namespace brisance::grid {

template <class T>
class BlockStore {
 public:
  /// What a block has that is new.
  using Make = std::function<T(Block const&)>;

  BlockStore() = default;
  BlockStore(Grid const& grid, Make make) : make_(std::move(make)) {
    values_.reserve(grid.blocks().size());
    for (Block const& block : grid.blocks()) values_.push_back(make_(block));
  }
  /// The same value for all, also for those to come.
  explicit BlockStore(Grid const& grid, T value = {})
      : BlockStore(grid, Make([value = std::move(value)](Block const&) { return value; })) {}

  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] T& operator[](int block) { return values_[static_cast<std::size_t>(block)]; }
  [[nodiscard]] T const& operator[](int block) const { return values_[static_cast<std::size_t>(block)]; }
  [[nodiscard]] auto begin() { return values_.begin(); }
  [[nodiscard]] auto end() { return values_.end(); }
  [[nodiscard]] auto begin() const { return values_.begin(); }
  [[nodiscard]] auto end() const { return values_.end(); }

  /// Makes the value of a new block. Those of its number and above go up by one.
  void add(Block const& block) { values_.insert(values_.begin() + block.number, make_(block)); }
  /// Forgets a block. Those above go down by one.
  void drop(int block) { values_.erase(values_.begin() + block); }
  /// Gives a block another number. Those between go up or down by one.
  void move(int from, int to) {
    auto const at = values_.begin();
    if (from < to) std::rotate(at + from, at + from + 1, at + to + 1);
    if (from > to) std::rotate(at + to, at + from, at + from + 1);
  }
  /// All of that at once: block b of `blocks` takes the value that block before[b] had, each no more than once, or a
  /// new one where that is `no_neighbour`. What no block takes is forgotten.
  void rearrange(std::vector<Block> const& blocks, std::vector<int> const& before) {
    std::vector<T> values;
    values.reserve(blocks.size());
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      values.push_back(before[b] == no_neighbour ? make_(blocks[b]) : std::move((*this)[before[b]]));
    }
    values_ = std::move(values);
  }

  /// In a checkpoint: values whose number the reader knows, and what that is the number of.
  void sized(Archive& a, std::string_view what) { a.sized(values_, what); }

 private:
  Make make_;
  std::vector<T> values_;
};

/// Per block 1, or 0 where it sleeps.
using AwakeBlocks = BlockStore<std::uint8_t>;

}  // namespace brisance::grid
