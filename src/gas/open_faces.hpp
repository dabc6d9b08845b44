/// Outflow boundaries that let waves out: what the ghost cells beyond them hold. Derivation and measurements stand in
/// docs/theory.md.
///
/// A face cell sees a Riemann problem between its own state and a wave that runs outwards into the gas beyond, whose
/// state (index a) is that of the cell at the start. Of the characteristics [Thompson87] those that leave come from the
/// cell; the one that enters carries what it carries in a wave that spreads from its source [BaylissTurkel80]:
///     u - u_a = cos(theta) ( (p - p_a) / Z(p) + H J / rho_a ).
/// Z is the impedance of a shock or rarefaction into the gas beyond, theta the angle between the face's normal and the
/// ray from the source, and H the mean curvature of the wave front, 1/r of a sphere, 1/(2r) of a cylinder. The second
/// term is the afterflow: behind a spherical pulse the gas still flows outwards when the pressure is back at that of
/// the ambient gas. Without it the negative phase of a blast is wrong. J, the impulse of the pressure,
///     J = sum_k w_k J_k,   dJ_k/dt = p - p_a + G/4 rho_a ((p - p_a) / Z)^2 - (rate_k lambda + drift) J_k,
/// is kept for every cell of the face. lambda = c (H^2 - K) / (2H) with the Gaussian curvature K is 0 for spheres.
///
/// Entropy, composition and transverse velocity come from the cell where the gas flows out, and from beyond where it
/// flows in. Where it leaves faster than the wave that turns to it nothing enters, and the ghost cells repeat the cell.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "core/vec.hpp"
#include "gas/closure.hpp"
#include "grid/block_store.hpp"
#include "grid/exchange.hpp"
#include "grid/fields.hpp"
#include "grid/grid.hpp"

namespace brisance {
class Archive;
}

namespace brisance::gas {

/// Where waves come from. In a direction that the source spans from end to end of the domain they do not spread.
struct WaveSource {
  Vec3 position{0.0, 0.0, 0.0};  ///< [m]
  std::array<bool, 3> spans{false, false, false};
};

class OpenFaces {
 public:
  static constexpr int poles = 3;
  using Memory = std::array<double, poles>;  ///< J_k of a cell [Pa s]

  OpenFaces(grid::Grid const& grid, Fluids const& fluids, int components);

  /// Without sources waves are taken to be plane and to run along the normal. Call `start` afterwards.
  void set_sources(std::vector<WaveSource> sources) { sources_ = std::move(sources); }
  /// Takes what the cells at the faces hold for the state beyond them, and `ambient` where `consumed` tells that a cell
  /// is about to burn.
  void start(grid::Fields const& fields, Components const& ambient,
             std::function<bool(grid::Cell const& cell)> const& consumed);

  /// When the grid's blocks have changed: takes over what is known beyond the faces of the blocks before. `numbers`: of
  /// each block before, see `BlockStore::rearrange`.
  void follow(grid::Grid const& before, std::vector<int> const& numbers);

  /// Has a block such faces in a direction?
  [[nodiscard]] bool at(int block, int direction) const {
    return faces_[block][2 * direction].has_value() || faces_[block][2 * direction + 1].has_value();
  }
  /// Fills the ghost cells of a block beyond its faces in `direction`, which hold copies of the cells next to them, for
  /// a sweep of length dt. Where products are `burning` in the block they stay copies of them.
  void fill(grid::Fields const& fields, int block, int direction, double dt, bool burning, grid::Exchange& exchange);

  /// Largest |u| + c beyond a block's faces, as last filled [m/s]: gas that flows back into a burst which has all but
  /// left moves faster than anything inside.
  [[nodiscard]] double fastest_signal(int block) const;

  void archive(Archive& a);  ///< in a checkpoint; what `start` finds is built anew

 private:
  /// The gas beyond a cell of a face.
  struct Beyond {
    Components conserved{};
    Vec3 velocity{0.0, 0.0, 0.0};
    double density = 0.0;
    double pressure = 0.0;
    double modulus = 0.0;  ///< rho c^2
    double nonlinearity = 0.0;
  };
  /// How waves meet a cell of a face.
  struct Ray {
    Vec3 direction{0.0, 0.0, 0.0};  ///< unit vector, outwards
    double cosine = 1.0;            ///< with the normal; 0: waves run along the face, and it repeats its cells
    double curvature = 0.0;         ///< H [1/m]
    double fading = 0.0;            ///< lambda [1/s]
    double drift = 0.0;             ///< by the wind [1/s]
  };
  struct Face {
    std::vector<Beyond> beyond;  ///< one, or one for each cell
    std::vector<Ray> rays;       ///< for each cell
    std::vector<Memory> memory;  ///< for each cell
    double signal = 0.0;         ///< largest |u| + c of the ghost cells that differ from the face's [m/s]
  };

  using Faces = grid::BlockStore<std::array<std::optional<Face>, 6>>;
  [[nodiscard]] static Faces open_faces_of(grid::Grid const& grid);
  /// One cell of a face before, and what is known of it.
  struct Known {
    Beyond const* beyond;
    Memory const* memory;
  };
  [[nodiscard]] static Known known_at(grid::Grid const& grid, Faces const& faces, Vec3 const& x, int face);
  [[nodiscard]] Beyond beyond(Components const& u) const;
  /// The source nearest to x, the way from it and its length [m]; null: there is none.
  [[nodiscard]] WaveSource const* nearest_source(Vec3 const& x, Vec3& way, double& distance) const;
  [[nodiscard]] Ray ray_to(Vec3 const& x, double h, int direction, int side, Beyond const& outside) const;
  /// Turns the state of a face cell into that of the ghost cells; false: they repeat it.
  bool outside_state(Beyond const& beyond, Ray const& ray, int direction, int side, double h, double dt, Memory& memory,
                     double& signal, Components& u) const;

  grid::Grid const* grid_;
  Fluids fluids_;
  int components_;
  std::vector<WaveSource> sources_;
  Faces faces_;  ///< where they are open
};

}  // namespace brisance::gas
