#include "grid/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "core/error.hpp"
#include "grid/forest.hpp"
#include "grid/partition.hpp"

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

}  // namespace

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

Grid::Grid(Domain const& domain, int block_cells) : domain_(domain) {
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

  std::array<bool, 3> periodic{};
  for (int d = 0; d < dims; ++d) {
    periodic[d] = domain.boundary[2 * d] == Boundary::periodic && domain.boundary[2 * d + 1] == Boundary::periodic;
  }
  Forest const forest(parts_, dims, periodic);
  std::vector<Leaf> const& leaves = forest.leaves();
  CellRange const all{{0, 0, 0}, parts_};
  block_of_part_.resize(leaves.size());
  blocks_.resize(leaves.size());
  for (int b = 0; b < block_count(); ++b) {
    Block& block = blocks_[b];
    Index3 const& p = leaves[b].place;
    block_of_part_[all.offset(p)] = b;
    block.number = b;
    block.metric = static_cast<Metric const&>(domain);
    for (int d = 0; d < 3; ++d) {
      block.size[d] = partition.size[d];
      block.origin[d] = p[d] * partition.size[d];
      block.n[d] = std::min(partition.size[d], domain.cells[d] - block.origin[d]);
    }
    for (int face = 0; face < 6; ++face) {
      std::optional<Leaf> const next = forest.across(leaves[b], face);
      block.neighbour[face] = next ? forest.find(*next) : no_neighbour;
    }
  }
}

int Grid::block_of(Index3 const& cell) const {
  Index3 p{};
  for (int d = 0; d < 3; ++d) p[d] = cell[d] / block_size_[d];
  return block_of_part_[CellRange{{0, 0, 0}, parts_}.offset(p)];
}

Cell Grid::locate(Index3 const& cell) const {
  Block const& block = blocks_[static_cast<std::size_t>(block_of(cell))];
  return block.cell(cell[0] - block.origin[0], cell[1] - block.origin[1], cell[2] - block.origin[2]);
}

Shell Grid::shell(Block const& block, int i) const {
  Index3 const cell = block.index({i, 0, 0});
  int const at = image_cell(domain_, {cell[0], 0, 0})[0];
  return {block.metric.cell_volume(at), block.metric.face_area(0, at), block.metric.face_area(0, at + 1),
          is_mirrored(domain_, cell)};
}

Index3 Grid::cell_at(Vec3 const& x) const {
  Index3 cell{0, 0, 0};
  for (int d = 0; d < domain_.dimensions(); ++d) {
    double const s = std::floor(domain_.in_cells(d, x[d]));
    cell[d] = static_cast<int>(std::clamp(s, 0.0, static_cast<double>(domain_.cells[d] - 1)));
  }
  return cell;
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
