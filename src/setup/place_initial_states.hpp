/// Initial states of the gas on the grid: each fills its own volume, cut cells in part, and what its state holds there.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "detonation/charge.hpp"
#include "run/reports.hpp"
#include "shape/shares.hpp"

namespace brisance::setup {

/// The initial states of a case on its grid.
class InitialStatePlacing {
 public:
  /// `grid`: whose leaves are measured; null: the domain with cells of level 0.
  explicit InitialStatePlacing(Case const& setup, grid::Grid const* grid = nullptr);

  /// Fills the gas, which holds the ambient state. A cell that a initial fills in part gets that part of its mass of
  /// each fluid, momentum and energy. Throws InputError where the states that meet in a cell have no common one.
  void fill(gas::Gas& gas);
  /// Measures without a gas what `fill` would do. False, and nothing measured, where surfaces cut more cells than
  /// `most`.
  bool measure(long most);
  /// Takes off what charges have taken.
  void give_way(detonation::TakenCells const& taken);
  /// After `fill` or `measure`.
  [[nodiscard]] std::vector<run::InitialStateReport> reports() const;
  /// Does the initial get nothing, because later ones or obstacles take its place or it is outside the domain?
  [[nodiscard]] bool vanishes(std::size_t initial) const;

 private:
  using Visit = std::function<bool(shape::CellRange const&, std::vector<shape::Share> const&)>;
  /// Cells of one size.
  struct Piece {
    grid::Domain domain;
    shape::CellRange cells;
  };
  /// Calls visit for the cells of a range that are not solid and their shares of the initial states; it returns false
  /// to end.
  void for_each(grid::Domain const& domain, shape::CellRange const& range, Visit const& visit) const;
  /// Finds the mean kinetic energy of states whose velocity varies.
  void measure_motion();
  /// Makes the sum of a initial's cells its volume.
  void scale(std::vector<shape::Share>& shares) const;

  Case const* setup_;
  std::vector<Piece> pieces_;
  std::vector<shape::Shape> shapes_;
  std::vector<shape::Shape> all_;  ///< initial states, then obstacles
  std::vector<double> asked_;      ///< volume of each in the domain [m3]
  std::vector<double> scales_;     ///< of the cells that a initial fills in part
  std::vector<double> placed_;     ///< [m3]
  std::vector<double> kinetic_;    ///< mean kinetic energy [J/m3]
};

}  // namespace brisance::setup
