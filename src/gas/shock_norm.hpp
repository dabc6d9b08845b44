/// Where shocks ask for finer cells: a norm of second differences of the pressure [Lohner87] that does not count where
/// the gas expands. Contacts and rarefactions do not ask.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "grid/grid.hpp"

namespace brisance::gas {

class Gas;
struct RefinementRules;

/// How a cell asks: that it does, and towards which faces what asks moves.
inline constexpr std::uint8_t asking_bit = 1;
inline constexpr std::uint8_t asks_everywhere = 0x7f;
[[nodiscard]] constexpr std::uint8_t asks_towards(int face) {
  return static_cast<std::uint8_t>(2U << static_cast<unsigned>(face));
}

/// Works on one block after the other and keeps its arrays: one for each thread.
class ShockNorm {
 public:
  /// Largest norm in a block's cells, and how each asks: 0 where the norm is below the threshold. Where but a pocket
  /// of cells reaches it, none asks and the norm is 0.
  double find(Gas const& gas, grid::Block const& block, RefinementRules const& rules, std::vector<std::uint8_t>& asks);

 private:
  /// Takes pressure and velocity of the block's cells and of one layer beyond each face, as far as blocks of its level
  /// reach.
  void take_surroundings(Gas const& gas, grid::Block const& block);
  /// Takes cells of a block, each to the place of its index moved by some cells.
  void take(Gas const& gas, int block, grid::CellRange const& cells, Index3 const& move);
  void take_row(Gas const& gas, int block, int at, int count, std::size_t to);
  static void take_mixture(Gas const& gas, int block, int at, std::array<double*, 4> const& to);
  /// The squares of the norm along a row; 0 where gas expands or the norm does not exist.
  void square_row(grid::Block const& block, Index3 const& first, int count, double filter);
  [[nodiscard]] std::uint8_t way_of(grid::Block const& block, Index3 const& cell) const;

  grid::CellRange box_;                                      ///< the block's cells with a layer around
  std::array<std::vector<double>, 4> values_;                ///< of the box: velocity, pressure
  std::array<bool, 6> known_{};                              ///< is there a layer beyond a face?
  std::vector<double> above_, below_, divergence_, square_;  ///< of a row
};

}  // namespace brisance::gas
