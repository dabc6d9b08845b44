/// From a coarse cell to the fine cells in it.
///
/// Linear, bounded and conservative. Slopes are those of volume fractions, of the density of each fluid alone, of
/// velocity and of pressure, limited to what the cell and its neighbours hold; their means are taken by the weight that
/// the conserved amount asks for:
///     alpha_k by volume,   rho_k by alpha_k,   velocity by rho,   pressure by xi,
/// so that masses, volumes of the fluids, momentum and energy are those of the coarse cell to round-off, and velocity
/// and pressure that are uniform stay so across an interface between fluids whose own densities are uniform.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gas/closure.hpp"
#include "grid/grid.hpp"

namespace brisance::gas {

/// What slopes are made of.
struct PhaseState {
  PerFluid alpha{};    ///< volume fractions
  PerFluid density{};  ///< of each fluid alone; 0 where there is none of it [kg/m3]
  Vec3 velocity{0.0, 0.0, 0.0};
  double pressure = 0.0;
};

/// All fluids are burnt.
[[nodiscard]] PhaseState phase_state_of(Fluids const& fluids, Components const& u);

class Prolongation {
 public:
  static constexpr int most_parts = 8;
  /// In the order of cells, x fastest.
  using Parts = std::array<Components, most_parts>;

  Prolongation(Fluids const& fluids, int components, int dimensions)
      : fluids_(&fluids), components_(components), dimensions_(dimensions) {}

  /// A coarse cell with its neighbours by their faces; null where there is none: then there is no slope in that
  /// direction. `low_part`: the part of the cell's volume that its low half along x takes.
  struct Coarse {
    Components const* conserved = nullptr;
    PhaseState const* state = nullptr;
    std::array<PhaseState const*, 6> beside{};
    double low_part = 0.5;
  };
  /// The states of the 2^dimensions cells. Where one of them would be unsound all are the coarse one's.
  void split(Coarse const& cell, Parts& parts) const;
  [[nodiscard]] int parts() const { return 1 << dimensions_; }

 private:
  Fluids const* fluids_;
  int components_;
  int dimensions_;
};

/// Coarse cells that are split, and one layer around them.
class CoarsePatch {
 public:
  /// `core`: the cells that are split, by their index in the domain of their level.
  CoarsePatch(Fluids const& fluids, int components, grid::Domain const& domain, grid::CellRange const& core);

  [[nodiscard]] grid::CellRange const& box() const { return box_; }
  /// The cell of the domain that a cell of the box stands for; false: none.
  [[nodiscard]] static bool find_image(grid::Domain const& domain, Index3& index);
  /// Gives a place of the box what its cell holds. Those that get nothing have no say.
  void set(std::size_t place, Components const& conserved);
  /// The same where an obstacle stands: its neighbours do not look at it, and its parts hold what it holds.
  void set_solid(std::size_t place, Components const& conserved);
  /// `fine`: the metric of the finer level.
  void split(Index3 const& index, grid::Metric const& fine, Prolongation::Parts& parts) const;

 private:
  Fluids const* fluids_;
  Prolongation prolongation_;
  int dimensions_;
  grid::CellRange box_;
  std::vector<Components> conserved_;
  std::vector<PhaseState> state_;
  std::vector<std::uint8_t> known_;
};

}  // namespace brisance::gas
