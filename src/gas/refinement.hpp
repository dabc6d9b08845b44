/// Where the gas asks for finer cells: at shocks, by a norm of second differences of the pressure [Lohner87] that
/// counts only where the gas is compressed, and where a user wants them. Contacts and rarefactions do not ask.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "grid/forest.hpp"
#include "grid/grid.hpp"

namespace brisance::gas {

class Gas;

struct RefinementRules {
  int most_level = 0;
  /// From this value of the norm on, 0 to 1, a cell asks for the finest level.
  double threshold = 0.3;
  /// Second differences of the pressure count by this part of the pressure itself: weaker waves do not ask.
  double filter = 0.02;
  /// Cells of its own level around one that asks which get the same: the way that a shock makes until blocks are
  /// changed again.
  int buffer = 4;
  /// Changes of blocks that a block must have been without need before it is merged.
  int patience = 2;
  /// The least level in a box; null: 0 everywhere.
  std::function<int(Vec3 const& lower, Vec3 const& upper)> least_level;
};

/// Largest norm in a block's cells, and in which of them it reaches the threshold.
[[nodiscard]] double shock_norm(Gas const& gas, grid::Block const& block, RefinementRules const& rules,
                                std::vector<std::uint8_t>& asks);

/// Decides which leaves are refined or merged, and remembers how long they have been without need.
class Refinement {
 public:
  explicit Refinement(RefinementRules rules) : rules_(std::move(rules)) {}

  /// Changes the forest of the gas's grid; false: all leaves stay. Leaves and the gas alone decide, not the threads.
  bool adapt(Gas const& gas, grid::Forest& forest);

 private:
  RefinementRules rules_;
  std::vector<int> unneeded_;  ///< for how many changes, by the leaf
};

}  // namespace brisance::gas
