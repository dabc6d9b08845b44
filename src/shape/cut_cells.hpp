/// Cells that the surfaces of bodies cut: the part of their volume and of their faces that the bodies leave open.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shape/shares.hpp"

namespace brisance::shape {

/// A cell whose faces or volume bodies leave open in part.
struct CutCell {
  Index3 cell{0, 0, 0};                ///< index in the domain
  double open = 1.0;                   ///< fraction of its volume, in (0, 1]
  double open_section = 1.0;           ///< the same without the weight of a radius
  std::array<double, 6> open_faces{};  ///< fraction of each face's area, `grid::Face` order
};

/// What bodies make of the cells of a domain.
struct CutGeometry {
  grid::CellRange range;            ///< the cells that have been looked at
  std::vector<std::uint8_t> solid;  ///< of all of them, x fastest: 1 where nothing is open
  std::vector<CutCell> cells;       ///< those that are cut, by their place in the domain
  /// Cells in which bodies part the gas: walls thinner than a cell. The largest piece of gas stays, the others become
  /// solid, so that nothing gets through.
  std::vector<Index3> parted;
};

/// Openings smaller than this fraction of a face or of a cell are closed, and walls that take no more than that are
/// left out: coordinates in single precision leave slivers.
inline constexpr double sliver = 1e-4;
/// Cells that bodies leave less of than this are solid.
inline constexpr double least_open = 1e-6;

/// The cells that shapes cut, taken together. Faces are measured on lines along the axes, each of them exact: exact in
/// 1D and 2D, in 3D for plane surfaces; curved ones and edges within a face to second order in the cell size.
/// Neighbours see their common face alike. Volumes as by `shares_of_cell`.
[[nodiscard]] CutGeometry cut_cells(std::vector<Shape> const& shapes, grid::Domain const& domain);

/// The same of a part of the domain. What a cell is depends on its neighbours: those in the outermost two layers of a
/// range that does not end with the domain are not all what they are in the whole.
[[nodiscard]] CutGeometry cut_cells(std::vector<Shape> const& shapes, grid::Domain const& domain,
                                    grid::CellRange const& range);

}  // namespace brisance::shape
