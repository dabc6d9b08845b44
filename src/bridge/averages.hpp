/// The gas that particles carry, seen as gas cells, [Cui14] Eqs. (31)-(36).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bridge/traffic.hpp"
#include "grid/geometry.hpp"
#include "mpm/mpm.hpp"

namespace brisance::bridge {

/// Sums over the gas particles around the centre of a cell, each with its weight. The energy is the internal one.
struct CellSums : Amounts {
  PerFluid fluid_volume{};  ///< of it, of each fluid beside the ambient one [m3]
};

/// Weighted sums of the particles of one body around the centres of chosen cells.
///
/// The weight is the quadratic B-spline around the cell's centre. Eqs. (31)-(32) go from points to nodes and on to the
/// centre, which is a similar, somewhat wider weight, but Eq. (33) sums the energy of the particles that happen to lie
/// in the cell, and Eq. (34) divides by the cell's volume: both change whenever a particle crosses a cell's face. Here
/// mass, momentum, energy and volume have the same weights, and the caller divides by the volume of the particles: a
/// uniform gas gives uniform cells to round-off, wherever its particles lie.
class Averages {
 public:
  /// `domain`: of the cells; `shift`: index of a cell in the grid of the particles minus that in the domain.
  Averages(grid::Domain const& domain, mpm::Mpm const& particles, Index3 const& shift,
           std::vector<Index3> const& cells);

  void compute(mpm::Mpm const& particles, int body);
  [[nodiscard]] std::vector<CellSums> const& sums() const { return sums_; }

 private:
  /// Order of the values of a particle: its volume, those of the fluids from number 1 on, masses, energy, momentum.
  static constexpr int first_mass = most_fluids;
  static constexpr int first_momentum = first_mass + most_fluids + 1;
  static constexpr int values = first_momentum + 3;
  struct Source {
    int slot;           ///< of the block
    int offset;         ///< of the cell in the block's box
    std::uint8_t flip;  ///< bit d: an image behind a mirror in direction d
  };
  struct BlockPart {
    int block = 0;
    grid::CellRange box;               ///< its cells in the particles' grid, with one layer around
    std::vector<std::uint8_t> wanted;  ///< per cell of the box: a particle there counts for some cell
    std::vector<double> values;
  };
  void add_particles(mpm::Mpm const& particles, int body, BlockPart& part) const;

  grid::Domain domain_;  ///< of the particles
  int dims_;
  std::vector<BlockPart> parts_;
  std::vector<Source> sources_;
  std::vector<std::size_t> first_;  ///< of each cell in `sources_`, and the end
  std::vector<CellSums> sums_;
};

}  // namespace brisance::bridge
