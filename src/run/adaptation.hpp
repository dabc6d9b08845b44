/// Cells of several sizes: when blocks are refined and merged while a simulation goes on.
#pragma once

#include <functional>
#include <vector>

#include "gas/refinement.hpp"
#include "grid/forest.hpp"

namespace brisance {
class Archive;
}
namespace brisance::gas {
class Gas;
}

namespace brisance::run {

class System;

class Adaptation {
 public:
  /// Gives new blocks what the case alone determines: obstacles, lighting times; and the gas its cut cells.
  using Furnish = std::function<void(gas::Gas& gas, std::vector<int> const& new_blocks)>;

  /// `interval`: steps between two changes.
  Adaptation(gas::RefinementRules rules, int interval, Furnish furnish)
      : refinement_(std::move(rules)), interval_(interval), furnish_(std::move(furnish)) {}

  /// To be called after every step: changes the blocks where it is time.
  void follow(System& system);
  void furnish(gas::Gas& gas, std::vector<int> const& new_blocks) const {
    if (furnish_) furnish_(gas, new_blocks);
  }
  /// Changes of the blocks since the start.
  [[nodiscard]] long changes() const { return changes_; }
  /// Was refinement held back by the limit on the number of cells?
  [[nodiscard]] bool held_back() const { return refinement_.held_back(); }
  void archive(Archive& a);  ///< in a checkpoint

 private:
  gas::Refinement refinement_;
  int interval_;
  Furnish furnish_;
  long changes_ = 0;
};

}  // namespace brisance::run
