/// The gas as gauges and dumps see it, wherever it is: in cells, or, deeper in an MPM region than its bridge, in
/// particles.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bridge/averages.hpp"
#include "bridge/region.hpp"
#include "gas/gas.hpp"

namespace brisance::run {
class System;
}

namespace brisance::observe {

/// A cell by its level and its index in the domain: other blocks may hold it from step to step.
struct PlacedCell {
  int level = 0;
  Index3 index{0, 0, 0};
};

/// Only cells of the MPM region's level lie in it.
class GasView {
 public:
  /// Of the cells that will be asked for, those that particles hold are prepared. `cells`: of the level of the MPM
  /// region; those outside it do not matter. Keeps a reference to the system.
  GasView(run::System const& system, std::vector<Index3> const& cells);
  /// Averages of the particles as they are now.
  void update();
  /// What solids fill now.
  void update_solids();
  /// Does the cell lie deeper in the MPM region than its bridge?
  [[nodiscard]] bool in_particles(PlacedCell const& cell) const;
  /// The gas in a cell, which must be there; nothing in obstacles, and where solids leave the gas less than a tenth of
  /// the cell.
  [[nodiscard]] std::optional<gas::Primitive> at(PlacedCell const& cell) const;
  /// Fraction of a cell that solids fill, 0 to 1. Each particle counts where its box lies, which has the size that it
  /// had at the start.
  [[nodiscard]] double solid_at(PlacedCell const& cell) const;

 private:
  [[nodiscard]] bridge::Region const* region_at(int level) const;

  run::System const* system_;
  std::vector<Index3> cells_;  ///< in particles, in the order of `averages_`
  std::vector<int> number_;    ///< of the cells of the particles' grid in `cells_`; -1: none
  std::unique_ptr<bridge::Averages> averages_;
  std::vector<double> solids_;  ///< fractions of the cells of the particles' grid
};

}  // namespace brisance::observe
