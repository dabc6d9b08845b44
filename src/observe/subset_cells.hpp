/// The cells of a grid that a subset of the field output shows.
#pragma once

#include <vector>

#include "case/case.hpp"

namespace brisance::observe {

/// The shown part of the domain, as if all of it had cells of a level. A box begins and ends with whole cells of the
/// coarsest of the levels that it may show, so that no cell of any level is cut. A plane takes the layer of cells that
/// it lies in; on the face between two, the upper one.
///
/// Levels below 0 are larger than `domain.cell`: each doubles the cells of the one above it.
class SubsetCells {
 public:
  /// `finest`: level of the finest cells that the grid may have.
  SubsetCells(run::FieldSubset const& subset, grid::Domain const& domain, int finest);

  /// Level of the finest cells that are shown; finer ones are averaged to these.
  [[nodiscard]] int finest() const { return finest_; }
  /// Level of the coarsest: 0, or below.
  [[nodiscard]] int coarsest() const { return coarsest_; }
  /// The shown cells of a level, by their index in the domain with cells of that level.
  [[nodiscard]] grid::CellRange cells(int level) const;
  /// The shown part of the domain with cells of the coarsest level.
  [[nodiscard]] grid::Domain shown() const;
  /// A direction in which the last cells reach beyond the domain, which those that are larger than its own may do; -1:
  /// none.
  [[nodiscard]] int direction_beyond() const;
  /// Direction of the plane's normal; -1: a box.
  [[nodiscard]] int normal() const { return normal_; }

  /// Estimate of the number of cells that are shown where there are so many of each level in the whole domain, if those
  /// of a level are spread evenly. Exact where all cells have one size.
  [[nodiscard]] double count(std::vector<double> const& cells_of_level) const;

 private:
  grid::Domain domain_;
  int dimensions_;
  int deepest_;  ///< level by whose cells the place of a plane is told
  int finest_;
  int coarsest_;
  int normal_ = -1;
  int layer_ = 0;         ///< of the plane, of the deepest level
  grid::CellRange part_;  ///< of the coarsest level; along the normal of a plane all of it
};

/// The domain with cells of a level, which may lie below 0; cells that reach beyond its end count.
[[nodiscard]] grid::Domain with_level(grid::Domain const& domain, int level);

/// A box of cells of one level as cells of another, a finer one by default; of a coarser one those that it touches.
[[nodiscard]] grid::CellRange on_level(grid::CellRange const& cells, int from, int to, int dimensions);

}  // namespace brisance::observe
