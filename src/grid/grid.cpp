#include "grid/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/error.hpp"
#include "grid/forest.hpp"
#include "grid/partition.hpp"
#include "grid/pieces.hpp"

namespace brisance::grid {

namespace {

/// Fewer cells than this in a resolved direction leave no room for the ghost layers of a neighbour, and let the nodes
/// of material points in the blocks on both sides meet.
constexpr int minimum_cells = 4;

/// More cells than this along a direction make rows too long for the arrays that sweeps work on, see bundle.hpp.
constexpr int most_cells = 376;

/// Cells of a block along a direction with n cells: as many blocks as of `target` cells, as equal as can be. The last
/// block is left with `minimum_cells` or more; if no size up to the target does that, the next one above does.
int block_size(int n, int target) {
  int const parts = n / target + (n % target != 0 ? 1 : 0);
  if (parts <= 1) return n;
  auto const fits = [n](int size) { return n % size == 0 || n % size >= minimum_cells; };
  int const equal = std::max(n / parts + (n % parts != 0 ? 1 : 0), minimum_cells);
  for (int size = equal; size <= target; ++size) {
    if (fits(size)) return size;
  }
  for (int size = equal - 1; size >= minimum_cells; --size) {
    if (fits(size)) return size;
  }
  int size = target + 1;
  while (!fits(size)) ++size;
  return size;
}

/// The sizes of blocks that sweeps run through fastest, along each direction of n cells, in 2D and 3D: few ghost cells
/// for each cell, rows of whole vectors, and columns in 3D that do not lie a multiple of 4096 bytes apart, where their
/// cells would share a few sets of the caches.
Index3 fast_block_sizes(Index3 const& n, int dims) {
  constexpr int page = 512;  // in doubles
  constexpr std::array sizes{40, 36, 32, 28, 24};
  auto const cost_of = [&](int cells, int size) {
    int const parts = cells / size + (cells % size != 0 ? 1 : 0);
    return 4.0 * parts / cells + (size % 8 != 0 ? 0.03 : 0.0);
  };
  auto const candidates = [&](int cells) {
    std::vector<int> found;
    for (int const size : sizes) {
      if (size < cells && (cells % size == 0 || cells % size >= minimum_cells)) found.push_back(size);
    }
    if (found.empty() || cells <= sizes.front()) found.assign(1, block_size(cells, sizes.front()));
    return found;
  };
  Index3 best{1, 1, 1};
  double least = std::numeric_limits<double>::infinity();
  for (int const x : candidates(n[0])) {
    for (int const y : candidates(n[1])) {
      bool const shared_sets = dims == 3 && x * y % page == 0;
      double const cost = cost_of(n[0], x) + cost_of(n[1], y) + (shared_sets ? 0.08 : 0.0);
      if (cost < least) {
        least = cost;
        best = {x, y, 1};
      }
    }
  }
  if (dims == 3) {
    least = std::numeric_limits<double>::infinity();
    for (int const z : candidates(n[2])) {
      if (double const cost = cost_of(n[2], z); cost < least) {
        least = cost;
        best[2] = z;
      }
    }
  }
  return best;
}

/// Do finer blocks cover all parts of a block at a face?
bool is_covered_at(Block const& block, int face) {
  for (int n = 0; n < part_count(block); ++n) {
    CellRange const cells = part(block, n);
    int const d = face / 2;
    bool const there = face % 2 == 0 ? cells.lower[d] == 0 : cells.upper[d] == block.n[d];
    if (there && !cells.empty() && !is_part_covered(block, n)) return false;
  }
  return true;
}

}  // namespace

int part_of(Block const& block, Index3 const& within) {
  int number = 0;
  for (int d = 0; d < block.metric.dimensions(); ++d) number |= (2 * within[d] >= block.size[d] ? 1 : 0) << d;
  return number;
}

CellRange part(Block const& block, int number) {
  CellRange cells = block.interior();
  for (int d = 0; d < block.metric.dimensions(); ++d) {
    int const half = block.size[d] / 2;
    if ((number >> d & 1) != 0)
      cells.lower[d] = std::min(half, block.n[d]);
    else
      cells.upper[d] = std::min(half, block.n[d]);
  }
  return cells;
}

std::array<bool, 3> periodic_directions(Domain const& domain) {
  std::array<bool, 3> periodic{};
  for (int d = 0; d < domain.dimensions(); ++d)
    periodic[d] = domain.boundary[2 * d] == Boundary::periodic && domain.boundary[2 * d + 1] == Boundary::periodic;
  return periodic;
}

Partition partition_of(Domain const& domain, int block_cells) {
  constexpr int cells_of_a_row = 320;
  int const dims = domain.dimensions();
  Partition p;
  if (block_cells == 0 && dims > 1) p.size = fast_block_sizes(domain.cells, dims);
  for (int d = 0; d < dims; ++d) {
    int const n = domain.cells[d];
    if (block_cells > 0 || dims == 1) {
      int const target = block_cells > 0 ? block_cells : cells_of_a_row;
      p.size[d] = block_size(n, std::clamp(target, minimum_cells, most_cells));
    }
    p.parts[d] = n / p.size[d] + (n % p.size[d] != 0 ? 1 : 0);
  }
  return p;
}

Partition refinable_partition_of(Domain const& domain, int block_cells) {
  constexpr std::array candidates{16, 24, 20, 18, 14, 12, 22, 10, 8, 6, 4};
  Partition p;
  std::array<bool, 3> const periodic = periodic_directions(domain);
  for (int d = 0; d < domain.dimensions(); ++d) {
    int const n = domain.cells[d];
    auto const fits = [&](int size) {
      int const rest = n % size;
      return size >= 2 * ghost_layers && size % 2 == 0 && (rest == 0 || (!periodic[d] && rest >= ghost_layers));
    };
    auto const found = std::find_if(candidates.begin(), candidates.end(), fits);
    if (found == candidates.end()) {
      throw InputError(
          fmt::format("the domain has {} cells along {}, which cannot be divided into blocks that can be "
                      "refined: use an even number of at least 4",
                      n, "xyz"[d]));
    }
    p.size[d] = block_cells > 0 && fits(block_cells) ? block_cells : *found;
    p.parts[d] = (n + p.size[d] - 1) / p.size[d];
  }
  return p;
}

Grid::Grid(Domain const& domain, int block_cells) : domain_(domain), domains_{domain} {
  int const dims = domain.dimensions();
  for (int d = 0; d < dims; ++d) {
    if (domain.cells[d] < minimum_cells) {
      throw InputError(fmt::format("the domain has {} cell(s) in direction {}; at least {} are required",
                                   domain.cells[d], "xyz"[d], minimum_cells));
    }
  }
  Partition const partition = partition_of(domain, block_cells);
  block_size_ = partition.size;
  parts_ = partition.parts;
  number_blocks(pieces_of(Forest(parts_, dims, periodic_directions(domain)), domains_, block_size_));
  for (Block& block : blocks_) find_neighbours(block);
}

Grid::Grid(Domain const& domain, Index3 const& size, Forest const& forest) : domain_(domain) {
  int const dims = domain.dimensions();
  std::vector<Leaf> const& leaves = forest.leaves();
  if (forest.dimensions() != dims || forest.periodic() != periodic_directions(domain))
    throw InputError("the forest of blocks has other directions, or other periodic ones, than the domain");
  for (int d = 0; d < dims; ++d) {
    if (size[d] < 2 * ghost_layers || size[d] % 2 != 0) {
      throw InputError(
          fmt::format("blocks of {} cells along {} cannot be refined: an even number of at least {} is "
                      "required",
                      size[d], "xyz"[d], 2 * ghost_layers));
    }
    int const rest = domain.cells[d] % size[d];
    if (rest != 0 && rest < ghost_layers) {
      throw InputError(fmt::format("{} cells along {} leave {} in the last block of {}; at least {} are required",
                                   domain.cells[d], "xyz"[d], rest, size[d], ghost_layers));
    }
    if (rest != 0 && forest.periodic()[d]) {
      throw InputError(
          fmt::format("a domain that is periodic along {} needs a multiple of the {} cells of a block, not "
                      "{} cells",
                      "xyz"[d], size[d], domain.cells[d]));
    }
    block_size_[d] = size[d];
    parts_[d] = (domain.cells[d] + size[d] - 1) / size[d];
    if (parts_[d] != forest.parts()[d]) {
      throw InputError(
          fmt::format("a forest of {} blocks along {} for a domain of {}", forest.parts()[d], "xyz"[d], parts_[d]));
    }
  }
  int finest = 0;
  for (Leaf const& leaf : leaves) finest = std::max(finest, leaf.level);
  for (int level = 0; level <= finest; ++level) domains_.push_back(domain.refined(level));

  std::vector<Piece> pieces = pieces_of(forest, domains_, size);
  std::vector<Piece> const below = pieces_below(pieces, domains_, size);
  pieces.insert(pieces.end(), below.begin(), below.end());
  number_blocks(pieces);
  for (Block& block : blocks_) find_neighbours(block);
}

Block Grid::make_block(Piece const& piece) const {
  Block block;
  Domain const& domain = domains_[piece.at.level];
  block.level = piece.at.level;
  block.metric = static_cast<Metric const&>(domain);
  block.size = block_size_;
  for (int d = 0; d < 3; ++d) {
    block.origin[d] = piece.at.place[d] * block_size_[d];
    block.n[d] = std::min(block_size_[d], domain.cells[d] - block.origin[d]);
  }
  block.covered = piece.counting == 0;
  for (int n = 0; n < part_count(block); ++n) {
    if ((piece.counting >> n & 1U) == 0 && !part(block, n).empty())
      block.covered_parts = static_cast<std::uint8_t>(block.covered_parts | 1U << n);
  }
  return block;
}

void Grid::number_blocks(std::vector<Piece> const& blocks) {
  std::vector<Piece> sorted = blocks;
  int const finest = levels() - 1;
  // A covered block comes before those that cover it.
  auto const key = [&](Piece const& piece) {
    Index3 place = piece.at.place;
    for (int d = 0; d < domain_.dimensions(); ++d) place[d] <<= finest - piece.at.level;
    return std::pair{morton(place), piece.at.level};
  };
  std::sort(sorted.begin(), sorted.end(), [&](Piece const& a, Piece const& b) { return key(a) < key(b); });
  block_of_part_.assign(CellRange{{0, 0, 0}, parts_}.count(), no_neighbour);
  block_of_fine_part_.resize(finest + 1);
  of_level_.resize(finest + 1);
  for (Piece const& piece : sorted) {
    Leaf const& at = piece.at;
    Block block = make_block(piece);
    block.number = block_count();
    of_level_[at.level].push_back(block.number);
    if (at.level == 0)
      block_of_part_[CellRange{{0, 0, 0}, parts_}.offset(at.place)] = block.number;
    else
      block_of_fine_part_[at.level][morton(at.place)] = block.number;
    blocks_.push_back(block);
  }
}

int Grid::block_at(int level, Index3 const& part) const {
  if (level == 0) return block_of_part_[CellRange{{0, 0, 0}, parts_}.offset(part)];
  auto const found = block_of_fine_part_[level].find(morton(part));
  return found == block_of_fine_part_[level].end() ? no_neighbour : found->second;
}

void Grid::find_neighbours(Block& block) const {
  Domain const& domain = domain_of(block);
  for (int face = 0; face < 6; ++face) {
    int const d = face / 2;
    Index3 cell = block.origin;
    cell[d] += face % 2 == 0 ? -1 : block.n[d];
    block.neighbour[face] = no_neighbour;
    block.beyond[face] = Beyond::boundary;
    if (cell[d] < 0 || cell[d] >= domain.cells[d]) {
      if (d >= domain.dimensions() || domain.boundary[face] != Boundary::periodic) continue;
      cell[d] = (cell[d] + domain.cells[d]) % domain.cells[d];
    }
    block.neighbour[face] = block_of(block.level, cell);
    block.beyond[face] = block.neighbour[face] != no_neighbour ? Beyond::block
                         : is_covered_at(block, face)          ? Beyond::nothing
                                                               : Beyond::coarser;
  }
}

int Grid::block_of(Index3 const& cell) const { return block_of(0, cell); }

int Grid::block_of(int level, Index3 const& cell) const {
  Index3 p{};
  for (int d = 0; d < 3; ++d) p[d] = cell[d] / block_size_[d];
  return block_at(level, p);
}

Cell Grid::locate(Index3 const& cell) const {
  Block const& block = blocks_[static_cast<std::size_t>(block_of(cell))];
  return block.cell(cell[0] - block.origin[0], cell[1] - block.origin[1], cell[2] - block.origin[2]);
}

std::optional<Cell> Grid::locate(int level, Index3 const& cell) const {
  int const number = block_of(level, cell);
  if (number == no_neighbour) return std::nullopt;
  Block const& block = blocks_[static_cast<std::size_t>(number)];
  return block.cell(cell[0] - block.origin[0], cell[1] - block.origin[1], cell[2] - block.origin[2]);
}

Cell Grid::locate(Vec3 const& x) const {
  int const finest = levels() - 1;
  Index3 const place = cell_at(finest, x);
  for (int level = finest; level > 0; --level) {
    Index3 cell = place;
    for (int d = 0; d < domain_.dimensions(); ++d) cell[d] >>= finest - level;
    auto const found = locate(level, cell);
    if (found && !block(*found).is_covered(*found)) return *found;
  }
  return locate(cell_at(0, x));
}

Shell Grid::shell(Block const& block, int i) const {
  Domain const& domain = domain_of(block);
  Index3 const cell = block.index({i, 0, 0});
  int const at = image_cell(domain, {cell[0], 0, 0})[0];
  return {block.metric.cell_volume(at), block.metric.face_area(0, at), block.metric.face_area(0, at + 1),
          is_mirrored(domain, cell)};
}

Index3 Grid::cell_at(int level, Vec3 const& x) const {
  Domain const& domain = this->domain(level);
  Index3 cell{0, 0, 0};
  for (int d = 0; d < domain.dimensions(); ++d) {
    double const s = std::floor(domain.in_cells(d, x[d]));
    cell[d] = static_cast<int>(std::clamp(s, 0.0, static_cast<double>(domain.cells[d] - 1)));
  }
  return cell;
}

int coarser_block_beyond(Grid const& grid, Block const& block, int face) {
  int const d = face / 2;
  Index3 cell = block.origin;
  cell[d] += face % 2 == 0 ? -1 : block.n[d];
  Index3 coarse = image_cell(grid.domain_of(block), cell);
  for (int e = 0; e < grid.domain().dimensions(); ++e) coarse[e] /= 2;
  return grid.block_of(block.level - 1, coarse);
}

Index3 image_cell(Domain const& domain, Index3 const& cell) {
  Index3 image = cell;
  for (int d = 0; d < 3; ++d) {
    int const n = domain.cells[d];
    int const side = image[d] < 0 ? 0 : image[d] >= n ? 1 : -1;
    if (side < 0) continue;
    if (domain.boundary[2 * d + side] == Boundary::periodic) {
      image[d] = ((image[d] % n) + n) % n;
      continue;
    }
    if (domain.is_mirror(2 * d + side)) image[d] = side == 0 ? -1 - image[d] : 2 * n - 1 - image[d];
    image[d] = std::clamp(image[d], 0, n - 1);
  }
  return image;
}

NodeImage image_node(Domain const& domain, Index3 const& node) {
  NodeImage image{node};
  for (int d = 0; d < domain.dimensions(); ++d) {
    int& i = image.index[d];
    int const n = domain.cells[d];
    if (domain.boundary[2 * d] == Boundary::periodic) i = ((i % n) + n) % n;
    for (int side = 0; side < 2; ++side) {
      int const plane = side == 0 ? 0 : n;
      if (!domain.is_mirror(2 * d + side) || (side == 0 ? i > plane : i < plane)) continue;
      image.sign[d] = i == plane ? 0.0 : -1.0;
      i = 2 * plane - i;
    }
  }
  return image;
}

bool is_mirrored(Domain const& domain, Index3 const& cell) {
  int const side = cell[0] < 0 ? 0 : cell[0] >= domain.cells[0] ? 1 : -1;
  if (side < 0) return false;
  return domain.is_mirror(side);
}

}  // namespace brisance::grid
