/// The grid: the domain cut into blocks, which are kept in the order of the forest's leaves (forest.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/vec.hpp"
#include "grid/cell.hpp"
#include "grid/geometry.hpp"

namespace brisance::grid {

class Forest;
struct Piece;

inline constexpr int no_neighbour = -1;

/// What lies beyond a face of a block.
enum class Beyond : std::uint8_t {
  block,     ///< a block of the same level
  boundary,  ///< the boundary of the domain, where nothing follows
  coarser,   ///< cells of the next coarser level
  nothing,   ///< of a covered block: a part of the domain in which this level has no cells
};

/// Layers of ghost cells that every block sees across each face.
inline constexpr int ghost_layers = 2;

/// A box of cells: the unit of work, of threads and of sleep. Cells are told by `Cell`, or by their index in the
/// domain; what a cell measures is told by its block.
///
/// All blocks of a grid have one `size`. Where a block reaches beyond the domain, only `n` cells per direction are
/// occupied: they are its cells. Arrays hold these and nothing else, densely, and loops, sweeps, exchange and output
/// run over them, so that the rest of the block costs neither time nor memory.
///
/// Blocks of level l have cells of 1/2^l of the coarsest size, and cells are counted by level: `origin` and whatever is
/// called an index in the domain count the cells of the block's level, as if the whole domain had them.
struct Block {
  int number = 0;        ///< in `Grid::blocks`
  int level = 0;         ///< 0: the coarsest
  bool covered = false;  ///< finer blocks cover it: it holds the means of their cells, and its own count for nothing
  /// Of its parts, the halves along each resolved direction, x fastest: bit n is set where a finer block covers part n.
  std::uint8_t covered_parts = 0;
  Index3 origin{0, 0, 0};  ///< index of its first cell in the domain
  Index3 n{1, 1, 1};       ///< cells per direction
  Index3 size{1, 1, 1};    ///< what `n` is in a block that lies in the domain as a whole
  /// Neighbouring block across each face (`Face` order; across a periodic face the one on the other side), or
  /// `no_neighbour`.
  std::array<int, 6> neighbour{};
  std::array<Beyond, 6> beyond{};
  Metric metric;  ///< of cells by their index in the domain

  [[nodiscard]] int cell_count() const { return n[0] * n[1] * n[2]; }
  /// Does a face of the block lie on the boundary of the domain, where nothing follows?
  [[nodiscard]] bool at_boundary(int face) const { return beyond[face] == Beyond::boundary; }

  /// Position of cell (i, j, k) of the block in its arrays: x fastest.
  [[nodiscard]] int offset(int i, int j, int k) const { return i + n[0] * (j + n[1] * k); }
  [[nodiscard]] Cell cell(int i, int j, int k) const { return {number, i, j, k, offset(i, j, k)}; }
  [[nodiscard]] Cell cell(Index3 const& within) const { return cell(within[0], within[1], within[2]); }
  /// The cell at a position in the arrays.
  [[nodiscard]] Cell cell_at(int offset) const {
    return {number, column(offset), offset / n[0] % n[1], offset / (n[0] * n[1]), offset};
  }
  /// Index i of the cell at a position in the arrays.
  [[nodiscard]] int column(int offset) const { return offset % n[0]; }

  /// Index in the domain of a cell of the block, or of one beyond its faces.
  [[nodiscard]] Index3 index(Index3 const& within) const {
    return {origin[0] + within[0], origin[1] + within[1], origin[2] + within[2]};
  }
  [[nodiscard]] Index3 index(Cell const& cell) const { return index(cell.within()); }
  /// That with an index in the domain.
  [[nodiscard]] Cell cell_with(Index3 const& index) const {
    return cell(index[0] - origin[0], index[1] - origin[1], index[2] - origin[2]);
  }
  /// Do finer cells cover a cell? Then it counts for nothing.
  [[nodiscard]] bool is_covered(Cell const& cell) const;
  /// Its cells by their index within it, and by their index in the domain.
  [[nodiscard]] CellRange interior() const { return {{0, 0, 0}, n}; }
  [[nodiscard]] CellRange in_domain() const { return interior().moved(origin); }
  /// Its cells by their index within it, and the ghost cells around them.
  [[nodiscard]] CellRange with_ghosts() const { return interior().grown(ghost_layers, metric.dimensions()); }

  [[nodiscard]] double h() const { return metric.h; }  ///< cell size [m]
  [[nodiscard]] Vec3 centre(Cell const& cell) const { return metric.centre(index(cell)); }
  /// Volume of the cells with index i along x [m3].
  [[nodiscard]] double volume(int i) const { return metric.cell_volume(origin[0] + i); }
  [[nodiscard]] double volume(Cell const& cell) const { return volume(cell.i); }
  /// Area of a cell's low (side 0) or high (1) face in a direction [m2].
  [[nodiscard]] double face_area(int direction, int side, Cell const& cell) const {
    return metric.face_area(direction, origin[0] + cell.i + (direction == 0 ? side : 0));
  }
};

/// Calls visit(cell) for every cell of a block, in the order of its arrays.
template <class Visit>
void for_each_cell(Block const& block, Visit&& visit) {
  Cell cell{block.number, 0, 0, 0, 0};
  for (cell.k = 0; cell.k < block.n[2]; ++cell.k) {
    for (cell.j = 0; cell.j < block.n[1]; ++cell.j) {
      for (cell.i = 0; cell.i < block.n[0]; ++cell.i) {
        visit(static_cast<Cell const&>(cell));
        ++cell.offset;
      }
    }
  }
}

/// The parts of a block: halves along each resolved direction, x fastest. See `Block::covered_parts`.
[[nodiscard]] inline int part_count(Block const& block) { return 1 << block.metric.dimensions(); }
/// The part that a cell lies in.
[[nodiscard]] int part_of(Block const& block, Index3 const& within);
/// The cells of a part by their index within the block: none where it lies outside the domain.
[[nodiscard]] CellRange part(Block const& block, int number);
[[nodiscard]] inline bool is_part_covered(Block const& block, int number) {
  return (block.covered_parts >> number & 1) != 0;
}

inline bool Block::is_covered(Cell const& cell) const {
  return covered_parts != 0 && is_part_covered(*this, part_of(*this, cell.within()));
}

/// Calls visit(cells) for boxes, by their index in the domain, that make up the cells of a block which no finer ones
/// cover.
template <class Visit>
void for_each_uncovered_box(Block const& block, Visit&& visit) {
  if (block.covered_parts == 0) {
    visit(block.in_domain());
    return;
  }
  for (int n = 0; n < part_count(block); ++n) {
    CellRange const cells = part(block, n);
    if (!is_part_covered(block, n) && !cells.empty()) visit(cells.moved(block.origin));
  }
}
/// The number of these cells.
[[nodiscard]] inline int uncovered_count(Block const& block) {
  int count = 0;
  for_each_uncovered_box(block, [&](CellRange const& cells) { count += static_cast<int>(cells.count()); });
  return count;
}

/// Calls visit(cell) for the first cell of every row of a block; the others of the row follow it in the arrays.
template <class Visit>
void for_each_row(Block const& block, Visit&& visit) {
  CellRange first = block.interior();
  first.upper[0] = 1;
  for_each_cell(first, [&](Index3 const& within) { visit(block.cell(within)); });
}

/// Adds what add(cell, row) puts into `Sum{}` to a sum: by rows, then planes, for short sums keep their digits.
template <class Sum, class Add>
void add_cells(Block const& block, Sum& whole, Add&& add) {
  for (int k = 0; k < block.n[2]; ++k) {
    Sum plane{};
    for (int j = 0; j < block.n[1]; ++j) {
      Sum row{};
      for (int i = 0; i < block.n[0]; ++i) add(block.cell(i, j, k), row);
      plane += row;
    }
    whole += plane;
  }
}

/// Calls visit(cell) for every cell of a block next to its low (side 0) or high (1) face in a direction.
template <class Visit>
void for_each_face_cell(Block const& block, int direction, int side, Visit&& visit) {
  CellRange layer = block.interior();
  if (side == 0)
    layer.upper[direction] = 1;
  else
    layer.lower[direction] = block.n[direction] - 1;
  for_each_cell(layer, [&](Index3 const& within) { visit(block.cell(within)); });
}

/// A ring or shell of cells: all with the same index along a radius.
struct Shell {
  double volume = 0.0;     ///< [m3]
  double low_area = 0.0;   ///< of the inner and the outer face [m2]
  double high_area = 0.0;  ///< [m2]
  bool mirrored = false;   ///< stands for the one on this side of a mirror
};

class Grid {
 public:
  /// Cuts the domain into blocks of one size, of at most `block_cells` per resolved direction, or a few more where the
  /// last block of a direction would be left with fewer than 4; of 376 in any case. `block_cells` = 0 chooses a size
  /// between 24 and 40 in 2D and 3D, the one that sweeps run through fastest, and takes 320 in 1D.
  /// Throws InputError when a resolved direction has fewer than 4 cells.
  explicit Grid(Domain const& domain, int block_cells = 0);
  /// The leaves of a forest as blocks of `size` cells along each resolved direction, an even number. What reaches
  /// beyond the domain is left out, and so are leaves that lie outside; a periodic direction has none. Throws
  /// InputError where the size is odd, too small or leaves too small a rest, or where the forest is not one of this
  /// domain.
  ///
  /// A leaf that is left coarse has no block of its own: its cells are those of its parent's block, which the other
  /// leaves of the family cover in part.
  ///
  /// Beside the leaves there are covered blocks: where finer leaves touch coarser ones, those of the coarser level
  /// below the finer leaves. With them a level looks the same on both sides of its end, and steps of its own can be
  /// taken.
  Grid(Domain const& domain, Index3 const& size, Forest const& forest);

  /// The domain with the cells of level 0.
  [[nodiscard]] Domain const& domain() const { return domain_; }
  /// The domain as if all of it had the cells of a level.
  [[nodiscard]] Domain const& domain(int level) const { return domains_[static_cast<std::size_t>(level)]; }
  [[nodiscard]] Domain const& domain_of(Block const& block) const { return domain(block.level); }
  [[nodiscard]] int levels() const { return static_cast<int>(domains_.size()); }
  /// The numbers of a level's blocks, in their order.
  [[nodiscard]] std::vector<int> const& blocks_of(int level) const {
    return of_level_[static_cast<std::size_t>(level)];
  }
  [[nodiscard]] std::vector<Block> const& blocks() const { return blocks_; }
  [[nodiscard]] int block_count() const { return static_cast<int>(blocks_.size()); }
  [[nodiscard]] Block const& block(Cell const& cell) const { return blocks_[static_cast<std::size_t>(cell.block)]; }
  /// Cells per direction of every block that lies in the domain as a whole.
  [[nodiscard]] Index3 const& block_size() const { return block_size_; }
  /// Size of the smallest cells [m].
  [[nodiscard]] double smallest_cell() const { return domains_.back().smallest_cell(); }

  /// The block of level 0 that holds the cell with domain index `cell`.
  [[nodiscard]] int block_of(Index3 const& cell) const;
  /// The block of a level that holds the cell with an index in the domain; `no_neighbour`: there is none.
  [[nodiscard]] int block_of(int level, Index3 const& cell) const;
  /// Domain index of the cell of level 0 that contains x; clamped to the domain.
  [[nodiscard]] Index3 cell_at(Vec3 const& x) const { return cell_at(0, x); }
  [[nodiscard]] Index3 cell_at(int level, Vec3 const& x) const;
  /// The cell of level 0 with a domain index, which must lie in the domain.
  [[nodiscard]] Cell locate(Index3 const& cell) const;
  /// The cell of a level with an index in the domain; null: there is none.
  [[nodiscard]] std::optional<Cell> locate(int level, Index3 const& cell) const;
  /// The cell of a leaf that contains x; where x lies outside the domain the one nearest to it, direction by direction.
  /// A place on the face between two cells is that of the upper one, and on that between two levels the finer one's if
  /// it is the upper one.
  [[nodiscard]] Cell locate(Vec3 const& x) const;
  /// Calls visit(block, cells) for the blocks of a level that hold some of its cells (by their index in the domain, all
  /// of which lie in the domain) and those that each of them holds.
  template <class Visit>
  void for_each_block_in(int level, CellRange const& cells, Visit&& visit) const {
    CellRange parts;
    for (int d = 0; d < 3; ++d) {
      parts.lower[d] = cells.lower[d] / block_size_[d];
      parts.upper[d] = (cells.upper[d] - 1) / block_size_[d] + 1;
    }
    for_each_cell(parts, [&](Index3 const& part) {
      int const number = block_at(level, part);
      if (number == no_neighbour) return;
      Block const& block = blocks_[static_cast<std::size_t>(number)];
      visit(block, common(cells, block.in_domain()));
    });
  }
  /// The index in the domain of a cell.
  [[nodiscard]] Index3 index(Cell const& cell) const { return block(cell).index(cell); }

  /// The ring or shell of a block's cells with index i along x; beyond the domain that which it is an image of.
  [[nodiscard]] Shell shell(Block const& block, int i) const;

 private:
  [[nodiscard]] int block_at(int level, Index3 const& part) const;
  [[nodiscard]] Block make_block(Piece const& piece) const;
  void number_blocks(std::vector<Piece> const& blocks);
  void find_neighbours(Block& block) const;

  Domain domain_;
  std::vector<Domain> domains_;  ///< of each level
  std::vector<Block> blocks_;
  std::vector<std::vector<int>> of_level_;
  Index3 block_size_{1, 1, 1};
  Index3 parts_{1, 1, 1};
  std::vector<int> block_of_part_;  ///< part (i, j, k) of level 0 -> block
  /// The same of finer levels, by the number of the part.
  std::vector<std::unordered_map<std::uint64_t, int>> block_of_fine_part_;
};

/// The directions in which a domain is periodic.
[[nodiscard]] std::array<bool, 3> periodic_directions(Domain const& domain);

/// The coarser block that lies beyond a face of a block whose cells there are `Beyond::coarser`.
[[nodiscard]] int coarser_block_beyond(Grid const& grid, Block const& block, int face);

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
