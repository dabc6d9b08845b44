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

/// Only cells of an MPM region's level lie in it.
class GasView {
 public:
  /// Of the cells that will be asked for, those that particles hold are prepared; those outside the MPM regions do not
  /// matter. Keeps a reference to the system.
  GasView(run::System const& system, std::vector<PlacedCell> const& cells);
  /// Averages of the particles as they are now.
  void update();
  /// What solids fill now.
  void update_solids();
  /// Does the cell lie deeper in an MPM region than its bridge?
  [[nodiscard]] bool in_particles(PlacedCell const& cell) const;
  /// The gas in a cell, which must be there; nothing in obstacles, and where solids leave the gas less than a tenth of
  /// the cell.
  [[nodiscard]] std::optional<gas::Primitive> at(PlacedCell const& cell) const;
  /// Fraction of a cell that solids fill, 0 to 1. Each particle counts where its box lies, which has the size that it
  /// had at the start.
  [[nodiscard]] double solid_at(PlacedCell const& cell) const;

 private:
  /// What is prepared of a region.
  struct OfRegion {
    bridge::Region const* region;
    std::vector<int> number;  ///< of the cells of the particles' grid among those prepared; -1: none
    std::unique_ptr<bridge::Averages> averages;
    std::vector<double> solids;  ///< fractions of the cells of the particles' grid
  };
  /// The number of the region that holds a cell more than so many layers deep.
  [[nodiscard]] std::optional<std::size_t> region_around(PlacedCell const& cell, bool beyond_bridge) const;
  void update_solids(std::size_t number);

  run::System const* system_;
  std::vector<OfRegion> regions_;
};

}  // namespace brisance::observe
