/// Where finer cells are: where shocks ask for them (`ShockNorm`), and where a user wants them.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "grid/forest.hpp"
#include "grid/grid.hpp"

namespace brisance {
class Archive;
}

namespace brisance::gas {

class Gas;

/// What a part of the domain asks for whatever the gas does.
struct LevelBounds {
  int least = 0;
  int most = std::numeric_limits<int>::max();  ///< shocks ask for no more here
};

struct RefinementRules {
  /// Of a box of cells of a level, by their index in the domain.
  using Bounds = std::function<LevelBounds(int level, grid::CellRange const& cells)>;

  int most_level = 0;       ///< of all
  int shock_level = 0;      ///< to which shocks are followed
  int products_level = -1;  ///< to which the surface of the products is followed; -1: it is not
  /// From this value of the norm on, 0 to 1, a cell asks for the finest level.
  double threshold = 0.3;
  /// Second differences of the pressure count by this part of the pressure itself: weaker waves do not ask.
  double filter = 0.1;
  /// Cells of its own level around one that asks which get the same: the way that a shock makes until blocks are
  /// changed again.
  int buffer = 4;
  /// Changes of blocks that a block must have been without need before it is left coarse or merged.
  int patience = 1;
  Bounds bounds;            ///< null: no part of the domain asks
  Bounds while_bursting;    ///< the same until all charges have burst
  double most_cells = 0.0;  ///< of all leaves; 0: no limit. What shocks ask for gives way, the weakest first
};

/// Refines the leaves of a forest until all cells are of the least level that is asked for; leaves that nothing asks
/// for are left coarse where that is possible. `size`: cells of a block.
void refine_to(grid::Forest& forest, grid::Domain const& domain, Index3 const& size, int most_level,
               RefinementRules::Bounds const& bounds);

/// Decides which leaves are refined or merged, and remembers how long they have been without need.
class Refinement {
 public:
  explicit Refinement(RefinementRules rules) : rules_(std::move(rules)) {}

  /// Changes the forest of the gas's grid; false: all leaves stay. Leaves and the gas alone decide, not the threads.
  bool adapt(Gas const& gas, grid::Forest& forest);
  /// Has the limit on the number of cells ever held it back?
  [[nodiscard]] bool held_back() const { return held_back_; }
  void archive(Archive& a);  ///< in a checkpoint

 private:
  /// What a leaf should have, and how strong the shock is that asks for it.
  struct Need {
    int level = 0;
    int least = 0;  ///< whatever the gas does
    int most = std::numeric_limits<int>::max();
    double norm = 0.0;
  };
  /// What is asked of a forest.
  struct Needs {
    std::vector<Need> of_leaf;
    /// Places in which shocks ask for blocks of a level or a finer one, by their Morton keys, from level 0 on.
    std::vector<std::unordered_set<std::uint64_t>> places;
  };
  [[nodiscard]] bool is_bursting(Gas const& gas) const;
  [[nodiscard]] Needs needs(Gas const& gas, grid::Forest const& forest) const;
  /// What the place of a leaf asks for whatever the gas does.
  [[nodiscard]] LevelBounds bounds_of(Gas const& gas, grid::Leaf const& leaf, bool bursting) const;
  /// What shocks ask for gives way, the weakest first, until about so many cells are left.
  void keep_within_limit(grid::Forest const& forest, Needs const& asked, double cells_per_leaf, double allowed,
                         std::vector<Need>& needs);

  RefinementRules rules_;
  bool held_back_ = false;
  std::vector<int> unneeded_;  ///< for how many changes, by the leaf
};

}  // namespace brisance::gas
