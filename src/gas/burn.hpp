/// Programmed burn: when explosive in cells burns, [Cui14] Eqs. (52)-(53), and when charges burst.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "gas/closure.hpp"
#include "grid/block_store.hpp"
#include "grid/grid.hpp"

namespace brisance::gas {

class Gas;

/// When a cell's explosive begins to burn and when all of it is burnt [s]: the burn fraction F grows evenly between,
/// from 0 to 1. By default what comes into the cell is burnt.
struct BurnTime {
  double begin = -std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();
};

/// What the burn knows of one charge.
struct LitCharge {
  double detonation_speed = 0.0;  ///< [m/s]
  double unburnt_density = 0.0;   ///< [kg/m3]
};

class Burn {
 public:
  explicit Burn(grid::Grid const& grid) : times_(grid), charge_of_(grid) {}

  /// Charges that burn; cells know them by their numbers.
  void set_charges(std::vector<LitCharge> charges) { charges_ = std::move(charges); }
  /// When the cells of a block burn, and which charge is in them, over `Block::with_ghosts`.
  void set_times(int block, std::vector<BurnTime> times, std::vector<std::uint16_t> charge_of);
  /// When the blocks change, see `BlockStore`: nothing burns in new ones.
  void rearrange(std::vector<grid::Block> const& blocks, std::vector<int> const& before) {
    times_.rearrange(blocks, before);
    charge_of_.rearrange(blocks, before);
  }
  /// The time after which everything is burnt [s], and the volume fraction up to which explosive in a cell is a trace
  /// that counts as burnt: with less of it than the pressure of the air in the cell asks for, the model of unburnt
  /// explosive would leave that air no pressure of its own.
  void set_end(double time, double trace);
  /// Tells that a charge bursts in an interval of time [s]: it burns or its products break out. What that means for the
  /// steps decides who takes them.
  void expect_burst(double begin, double end) { bursts_.push_back({begin, end}); }

  /// The gas is at `now` and will be at `step_end` after its step [s].
  void follow(double now, double step_end);
  /// Does anything burn still?
  [[nodiscard]] bool burning() const { return now_ < end_; }
  /// The same in one block.
  [[nodiscard]] bool burning_in(int block) const { return !times_[block].empty() && burning(); }
  /// Largest detonation speed of the charges that burn [m/s]; 0 without any.
  [[nodiscard]] double fastest() const;
  [[nodiscard]] bool bursting() const;
  /// When the next burst begins [s]; infinite: there is none to come.
  [[nodiscard]] double next_burst() const;

  /// Times over `Block::with_ghosts`; empty: nothing burns there.
  [[nodiscard]] std::vector<BurnTime> const& times(int block) const { return times_[block]; }
  /// The charge of a place of `times`, which must hold one.
  [[nodiscard]] LitCharge const& charge_at(int block, std::size_t place) const {
    return charges_[charge_of_[block][place]];
  }
  /// Burn fraction F at the end of the step.
  [[nodiscard]] double fraction(BurnTime const& times) const;
  /// Is so little explosive in a cell that it counts as burnt?
  [[nodiscard]] bool is_trace(double alpha) const;

 private:
  grid::BlockStore<std::vector<BurnTime>> times_;
  grid::BlockStore<std::vector<std::uint16_t>> charge_of_;
  std::vector<LitCharge> charges_;
  std::vector<std::array<double, 2>> bursts_;  ///< begin and end [s]
  double now_ = 0.0;
  double step_end_ = 0.0;
  double end_ = 0.0;
  double trace_ = vanishing_fraction;
};

/// Burn fraction F of a cell, see `BurnTime`.
[[nodiscard]] double burn_fraction(Gas const& gas, grid::Cell const& cell);

/// Largest compression, the products' own density over the unburnt one of their charge less 1, in cells that hold a
/// good part of explosive that will not burn for some cells' time yet; 0: none is compressed. Nothing but a blow from
/// elsewhere compresses it, and programmed burn leaves it no strength but the ambient pressure.
[[nodiscard]] double unlit_compression(Gas const& gas);

/// Progress lambda of the afterburn in a cell: 0 without products, without afterburn and before it.
[[nodiscard]] double afterburn_progress(Gas const& gas, grid::Cell const& cell);

}  // namespace brisance::gas
