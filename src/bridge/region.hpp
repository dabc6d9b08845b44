/// Where gas cells and material points calculate side by side: the MPM region of a gas simulation and its bridge,
/// [Cui14] Sec. 3.1. The region is a union of boxes of cells. From each of its faces that does not lie on the domain's
/// boundary the bridge reaches `width` cells inwards, around edges and corners too:
///
///     layer   0        gas cells alone; the first of them also act as particles ("proxy cells")
///             1..w     the bridge: gas cells and particles
///             w+1..2   ghost cells: filled by the particles, then advanced with the bridge, so that sweeps in one
///                      direction find them as the sweeps before have left them
///             w+3..4   ghost cells of the ghost cells
///             beyond   particles alone
#pragma once

#include <cstdint>
#include <vector>

#include "gas/gas.hpp"
#include "grid/grid.hpp"

namespace brisance::bridge {

/// Cells that the gas needs between the region and a boundary of the domain.
inline constexpr int least_gap = 4;

/// Cells of the domain.
using CellBox = grid::CellRange;

/// A face between a cell of the region and one outside.
struct Face {
  Index3 inside{0, 0, 0};
  int direction = 0;
  int side = 0;       ///< where the outside lies: 0: below, 1: above
  bool open = false;  ///< the outside lies beyond an outflow boundary of the domain
  int watch = -1;     ///< number of the face in `Gas::watched`

  [[nodiscard]] Index3 outside() const { return grid::beside(inside, direction, side); }
  /// Component of a vector along the direction into the region.
  [[nodiscard]] double inward(Vec3 const& v) const { return side == 0 ? v[direction] : -v[direction]; }
};

class Region {
 public:
  /// `domain`: with cells of the level that the region lies on. `proxy_layers`: how far outside the region cells act as
  /// particles. Throws InputError where the boxes do not fit the domain: too thin, too near to a boundary, on an inflow
  /// boundary, or on a part of a periodic direction.
  Region(grid::Domain const& domain, std::vector<CellBox> boxes, int width, int proxy_layers, int level = 0);

  [[nodiscard]] grid::Domain const& domain() const { return domain_; }
  [[nodiscard]] std::vector<CellBox> const& boxes() const { return boxes_; }
  /// Of its cells and those beside it.
  [[nodiscard]] int level() const { return level_; }
  /// One of them among those of the gas. Throws InputError where the gas has cells of another level there.
  [[nodiscard]] grid::Cell locate(grid::Grid const& grid, Index3 const& cell) const;
  /// Of its cells, which are all of one size, by their index in the domain.
  [[nodiscard]] grid::Metric const& metric() const { return domain_; }
  [[nodiscard]] int width() const { return width_; }
  /// Layer of a cell (domain index), as above; 0 outside. Beyond w + 4 all are w + 5.
  [[nodiscard]] int layer(Index3 const& cell) const;
  [[nodiscard]] bool inside(Index3 const& cell) const { return layer(cell) > 0; }
  [[nodiscard]] gas::Role role(Index3 const& cell) const;

  /// The background grid of the particles: the boxes with a margin for the proxy cells. It shares the domain's mirrors
  /// and periodic faces.
  [[nodiscard]] grid::Domain const& particles_domain() const { return particles_domain_; }
  /// Index of a cell in that grid minus its index in the domain.
  [[nodiscard]] Index3 const& shift() const { return shift_; }
  /// Index in that grid of a cell of the domain, and back.
  [[nodiscard]] Index3 to_particles(Index3 const& cell) const {
    return {cell[0] + shift_[0], cell[1] + shift_[1], cell[2] + shift_[2]};
  }
  [[nodiscard]] Index3 from_particles(Index3 const& cell) const {
    return {cell[0] - shift_[0], cell[1] - shift_[1], cell[2] - shift_[2]};
  }

  [[nodiscard]] std::vector<Face> const& faces() const { return faces_; }
  [[nodiscard]] std::vector<Face>& faces() { return faces_; }
  /// Ghost cells, layers w+1 to w+4.
  [[nodiscard]] std::vector<Index3> const& ghosts() const { return ghosts_; }
  /// Cells outside the region that act as particles; those beyond an open boundary are no cells of the domain.
  [[nodiscard]] std::vector<Index3> const& proxy_cells() const { return proxy_cells_; }
  /// All cells of the region.
  [[nodiscard]] std::vector<Index3> const& cells() const { return cells_; }
  /// The cell of the region that stands for one beyond an open boundary.
  [[nodiscard]] Index3 clamped(Index3 cell) const;

 private:
  [[nodiscard]] std::size_t at(Index3 const& cell) const { return space_.offset(cell); }
  void frame(CellBox const& hull, int proxy_layers);
  void find_layers(std::vector<CellBox> const& boxes);
  int list_cells();
  void list_proxy_cells(int proxy_layers);

  grid::Domain domain_;
  std::vector<CellBox> boxes_;
  int level_;
  int width_;
  CellBox space_;  ///< what `layers_` covers; it may reach beyond the domain
  std::vector<std::uint8_t> layers_;
  grid::Domain particles_domain_;
  Index3 shift_{0, 0, 0};
  std::vector<Face> faces_;
  std::vector<Index3> ghosts_;
  std::vector<Index3> proxy_cells_;
  std::vector<Index3> cells_;
};

}  // namespace brisance::bridge
