/// Where another method calculates too: what cells are to the gas, and a register of what goes through chosen faces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gas/layout.hpp"
#include "grid/block_store.hpp"
#include "grid/bundle.hpp"

namespace brisance {
class Archive;
}

namespace brisance::gas {

/// What a cell is to the gas where another method calculates too.
enum class Role : std::uint8_t {
  own,     ///< advanced, and counted
  shadow,  ///< advanced, but its content is counted by the other method
  frozen,  ///< keeps what others put into it; seen by its neighbours
};

/// What went through one face, integrated over time, per area; positive along the direction.
struct FaceFlux {
  Amounts carried;       ///< mass, what goes along with it, and the volume of the gas [kg/m2, kg/(m s), J/m2, m]
  double impulse = 0.0;  ///< of the pressure [Pa s]
  double work = 0.0;     ///< of the pressure [J/m2]
};

class Coupling {
 public:
  struct WatchedFace {
    grid::Cell cell;
    int number = 0;
  };

  /// `bundle_cells`: those of the sweeps.
  Coupling(grid::Grid const& grid, int bundle_cells);

  /// Gives the cells of a block their roles; without them all are the gas's own.
  void set_roles(int block, std::vector<Role> roles);
  /// Roles of a block's cells; empty: all own.
  [[nodiscard]] std::vector<Role> const& roles(int block) const { return blocks_[block].roles; }
  [[nodiscard]] Role role(int block, int offset) const {
    return blocks_[block].roles.empty() ? Role::own : blocks_[block].roles[offset];
  }
  [[nodiscard]] bool all_frozen(int block) const { return blocks_[block].all_frozen; }
  /// Does a cell's content count?
  [[nodiscard]] bool is_own(grid::Cell const& cell) const { return role(cell.block, cell.offset) == Role::own; }

  /// Keeps account of the face at the high side of a cell (not beyond the domain's last but one) in a direction, from
  /// which a block of the same level follows. Returns its number.
  int watch(grid::Cell const& cell, int direction);
  /// What went through the watched faces since `clear_watched`, by their numbers. Through faces between sleeping blocks
  /// nothing goes.
  [[nodiscard]] std::vector<FaceFlux> const& watched() const { return watched_; }
  void clear_watched();
  /// The watched faces of a bundle of a sweep.
  [[nodiscard]] std::vector<WatchedFace> const& faces(int block, int direction, int bundle) const;
  /// The register of a face.
  [[nodiscard]] FaceFlux& flux(int number) { return watched_[number]; }
  /// When the blocks change, see `BlockStore`. All cells of new blocks are the gas's own, and their faces unwatched.
  void rearrange(std::vector<grid::Block> const& blocks, std::vector<int> const& before);
  void archive(Archive& a);  ///< the register, in a checkpoint

 private:
  struct OfBlock {
    std::vector<Role> roles;  ///< empty: all own
    bool all_frozen = false;
    std::array<std::vector<std::vector<WatchedFace>>, 3> watched;  ///< per direction and bundle
  };
  grid::Grid const* grid_;
  int bundle_cells_;
  grid::BlockStore<OfBlock> blocks_;
  std::vector<FaceFlux> watched_;
};

}  // namespace brisance::gas
