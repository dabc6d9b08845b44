/// Obstacles on the grid: a cell is solid from half its volume on.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "case/case.hpp"
#include "run/reports.hpp"
#include "shape/shares.hpp"

namespace brisance::setup {

/// A place where gas would flow through an obstacle.
struct Leak {
  std::size_t obstacle = 0;
  Vec3 place{0.0, 0.0, 0.0};  ///< [m]
};

/// Which cells are solid: those of which obstacles together fill half or more.
class SolidCells {
 public:
  /// With `cut` the gas sees the parts of cells too, which counts for `reports` alone.
  SolidCells(grid::Domain const& domain, std::vector<Obstacle> const& obstacles, bool cut = false);

  [[nodiscard]] bool any() const { return !shapes_.empty(); }
  [[nodiscard]] grid::Domain const& domain() const { return domain_; }
  [[nodiscard]] std::vector<shape::Shape> const& shapes() const { return shapes_; }
  /// Do these shares of obstacles make a cell solid?
  [[nodiscard]] static bool solid(double fraction) { return fraction >= 0.5 - 1e-9; }
  [[nodiscard]] bool operator()(Index3 const& cell) const;
  /// Of all cells of the domain, x fastest: 1 where solid.
  [[nodiscard]] std::vector<std::uint8_t> all() const;

  /// What becomes of each obstacle; nothing where surfaces cut more cells than `most`.
  [[nodiscard]] std::optional<std::vector<run::ObstacleReport>> reports(long most) const;
  /// Does the obstacle make no cell solid, and not all its cells be solid by others?
  [[nodiscard]] bool vanishes(std::size_t obstacle) const;
  /// A face between two gas cells through which gas would flow although obstacles lie between what the two cells stand
  /// for: a wall that is too thin for the cells. Nothing where there is none. Looks at `most` cells at the surfaces of
  /// obstacles, which then says how many more it may look at; 0: not all have been seen.
  [[nodiscard]] std::optional<Leak> leak(long& most) const;
  [[nodiscard]] std::optional<Leak> leak() const {
    long most = std::numeric_limits<long>::max();
    return leak(most);
  }
  /// The solid cells that an obstacle has the largest part of; where it has as much as others, the first of them has
  /// it.
  [[nodiscard]] std::vector<Index3> cells_of(std::size_t obstacle) const;
  /// The least extent of an obstacle [m], in the directions that are resolved.
  [[nodiscard]] double thickness(std::size_t obstacle) const;

 private:
  [[nodiscard]] std::optional<Leak> leak_in(shape::CellRange const& range, long& most) const;
  /// May one obstacle alone be a wall with gaps?
  [[nodiscard]] bool may_leak(std::size_t obstacle) const;
  /// Cells around an obstacle, and so many more on each side.
  [[nodiscard]] shape::CellRange around(std::size_t obstacle, int layers) const;

  bool cut_;
  grid::Domain domain_;
  std::vector<Obstacle> obstacles_;
  std::vector<shape::Shape> shapes_;
};

}  // namespace brisance::setup
