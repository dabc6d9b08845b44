/// Gas cells around the MPM region as the particles see them: their state with limited slopes, at the times of three
/// steps.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bridge/region.hpp"
#include "bridge/traffic.hpp"
#include "gas/gas.hpp"
#include "grid/grid.hpp"

namespace brisance {
class Archive;
}

namespace brisance::bridge {

/// Do two positive values differ by more than this fraction of the smaller one?
[[nodiscard]] inline bool differ(double a, double b, double fraction) {
  return std::abs(a - b) > fraction * std::min(a, b);
}

/// Do pressure or density jump by more than this part between two states?
[[nodiscard]] inline bool is_jump(Primitive const& a, Primitive const& b, double fraction) {
  return differ(a.pressure, b.pressure, fraction) || differ(a.density, b.density, fraction);
}

/// Changes over one cell in each direction; composition is constant in a cell.
struct GasSlopes {
  Vec3 density{0.0, 0.0, 0.0};
  Vec3 pressure{0.0, 0.0, 0.0};
  std::array<Vec3, 3> velocity{};  ///< [direction][component]
};

/// The state at a place in a cell; `offset` from its centre in cells.
[[nodiscard]] Primitive at_offset(Primitive const& centre, GasSlopes const& slopes, Vec3 const& offset);

class CellStates {
 public:
  /// Prepares the given cells of the region's level and their neighbours.
  CellStates(grid::Grid const& grid, Region const& region, std::vector<Index3> const& cells);
  void follow_blocks(grid::Grid const& grid);  ///< when those of the gas have changed

  /// Reads the cells' states from the gas. Those of its present time become the later ones, those before the earlier;
  /// at the same time again they are read anew.
  void read(gas::Gas const& gas);

  /// State and slopes of the nth of the cells at a fraction of the way from the earlier to the later time, -1/2 to 1:
  /// parabolas through three times where the flow is smooth, else straight lines. Straight ones alone would take as
  /// much as 1 % of sound of 20 cells, and reflect it.
  void at(int n, double fraction, Primitive& state, GasSlopes& slopes) const;
  /// Their velocities alone.
  void velocity_at(int n, double fraction, Vec3& velocity, std::array<Vec3, 3>& slopes) const;
  /// Largest |u| + c of all cells at the later time [m/s].
  [[nodiscard]] double fastest_signal() const;
  [[nodiscard]] Primitive const& later(int n) const { return later_[n]; }
  void archive(Archive& a);  ///< in a checkpoint

 private:
  struct Neighbour {
    int index = -1;       ///< in `places_`; -1: none
    bool mirror = false;  ///< the velocity along the direction changes its sign
  };
  /// Weights of the three times at a fraction of the last step.
  struct TimeWeights {
    std::array<double, 3> parabola;
    std::array<double, 3> line;
  };
  void find_smooth();
  [[nodiscard]] TimeWeights time_weights(double fraction) const;
  [[nodiscard]] std::array<double, 3> const& weights_of(int index, TimeWeights const& weights) const {
    return smooth_[index] != 0 ? weights.parabola : weights.line;
  }
  [[nodiscard]] Primitive value(int index, TimeWeights const& weights) const;
  [[nodiscard]] Vec3 velocity(int index, TimeWeights const& weights) const;

  int level_;
  std::vector<Index3> cells_;                         ///< the given ones and their neighbours
  std::vector<grid::Cell> places_;                    ///< where they lie
  std::vector<std::array<Neighbour, 6>> neighbours_;  ///< of the nth cell
  int dims_;
  int levels_ = 0;                              ///< how many of the three times have been read
  std::array<double, 3> times_{0.0, 0.0, 0.0};  ///< [s]
  std::vector<Primitive> before_;               ///< at the first of them
  std::vector<Primitive> earlier_;
  std::vector<Primitive> later_;
  std::vector<char> smooth_;     ///< is the flow of a cell smooth over the three times?
  std::vector<double> signals_;  ///< per group of cells
};

}  // namespace brisance::bridge
