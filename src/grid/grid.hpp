/// The grid: the domain cut into blocks that are kept along a space-filling (Morton) curve.
#pragma once

#include <array>
#include <vector>

#include "core/vec.hpp"
#include "grid/geometry.hpp"

namespace brisance::grid {

inline constexpr int no_neighbour = -1;

/// A box of cells: the unit of work, of threads and of sleep.
struct Block {
  Index3 origin{0, 0, 0};  ///< index of its first cell in the domain
  Index3 n{1, 1, 1};       ///< cells per direction
  /// Neighbouring block across each face (`Face` order; across a periodic face the one on the other side), or
  /// `no_neighbour`.
  std::array<int, 6> neighbour{};

  [[nodiscard]] int cell_count() const { return n[0] * n[1] * n[2]; }
  /// Position of cell (i, j, k) of the block in its arrays: x fastest.
  [[nodiscard]] int offset(int i, int j, int k) const { return i + n[0] * (j + n[1] * k); }
};

class Grid {
 public:
  /// Cuts the domain into blocks of at most `block_cells` per resolved direction, all of nearly equal size.
  /// `block_cells` = 0 takes 32 in 3D, 64 in 2D, 1024 in 1D. Throws InputError when a resolved direction has fewer than
  /// 4 cells.
  explicit Grid(Domain const& domain, int block_cells = 0);

  [[nodiscard]] Domain const& domain() const { return domain_; }
  [[nodiscard]] std::vector<Block> const& blocks() const { return blocks_; }
  [[nodiscard]] int block_count() const { return static_cast<int>(blocks_.size()); }
  /// The block that holds the cell with domain index `cell`.
  [[nodiscard]] int block_of(Index3 const& cell) const;
  /// Domain index of the cell that contains x; clamped to the domain.
  [[nodiscard]] Index3 cell_at(Vec3 const& x) const;

 private:
  Domain domain_;
  std::vector<Block> blocks_;
  std::array<std::vector<int>, 3> part_of_cell_;  ///< per direction: cell index -> part
  Index3 parts_{1, 1, 1};
  std::vector<int> block_of_part_;  ///< part (i, j, k) -> block
};

/// The cell inside the domain that a cell outside stands for: its mirror image, its periodic image or the nearest one.
[[nodiscard]] Index3 image_cell(Domain const& domain, Index3 const& cell);

/// Does that image come from an odd number of mirrors along x?
[[nodiscard]] bool is_mirrored(Domain const& domain, Index3 const& cell);

/// The node that a node on or beyond a periodic face or a mirror stands for.
struct NodeImage {
  Index3 index{0, 0, 0};
  /// Of a vector's components: -1 where they turn, 0 on a mirror, where the image's are against them.
  Vec3 sign{1.0, 1.0, 1.0};
};
[[nodiscard]] NodeImage image_node(Domain const& domain, Index3 const& node);

}  // namespace brisance::grid
