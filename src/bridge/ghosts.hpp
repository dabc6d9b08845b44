/// Ghost cells: the gas cells deep in the bridge, which the particles fill, [Cui14] Eqs. (31)-(36).
#pragma once

#include <array>
#include <vector>

#include "bridge/region.hpp"
#include "bridge/shared_gas.hpp"
#include "gas/gas.hpp"

namespace brisance::bridge {

class Ghosts {
 public:
  /// Keeps references to all.
  Ghosts(gas::Gas& gas, Region const& region, SharedGas const& shared);

  /// Fills the ghost cells from the averages and wakes their blocks. `last_step`: of the particles [s].
  void fill(double last_step);
  void follow_blocks();  ///< when those of the gas have changed

 private:
  void fill_cell(int n, double last_step);

  gas::Gas* gas_;
  Region const* region_;
  SharedGas const* shared_;
  std::vector<std::array<int, 6>> neighbours_;  ///< of each ghost cell, in the averages; -1: none
  std::vector<int> blocks_;                     ///< of the gas
};

}  // namespace brisance::bridge
