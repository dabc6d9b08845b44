#include "mpm/patches.hpp"

#include <algorithm>

namespace brisance::mpm {

Side beyond(grid::Grid const& grid, int block, int d, int side) {
  int const neighbour = grid.blocks()[block].neighbour[2 * d + side];
  if (neighbour != grid::no_neighbour) return {neighbour, false};
  grid::Boundary const boundary = grid.domain().boundary[2 * d + side];
  return grid::is_mirror(boundary) ? Side{block, true} : Side{};
}

namespace {

/// One direction of a link: which nodes of the patch it feeds, and from where.
struct Span {
  int lower = 0;
  int upper = 0;
  int flip = 1;
  int shift = 0;
};

/// Nodes that a block of `cells` shares with what lies at `offset` (-1, 0, 1) in one direction.
Span span_of(int cells, int other_cells, int reach, int offset, bool mirror) {
  int const last = cells + 2 * reach;  // storage index of the last node
  if (offset == 0) return {0, last, 1, 0};
  if (offset < 0) {
    // Nodes -reach..reach around the low side, in storage 0..2 reach.
    if (mirror) return {0, 2 * reach, -1, 2 * reach};
    return {0, 2 * reach, 1, other_cells};
  }
  if (mirror) return {cells, last, -1, 2 * (cells + reach)};
  return {cells, last, 1, -cells};
}

}  // namespace

std::vector<Patch> make_patches(grid::Grid const& grid, int reach) {
  grid::Domain const& domain = grid.domain();
  int const dims = domain.dimensions();
  std::vector<Patch> patches(grid.blocks().size());
  auto const nodes_of = [&](grid::Block const& block) {
    Index3 n{1, 1, 1};
    for (int d = 0; d < dims; ++d) n[d] = block.n[d] + 1 + 2 * reach;
    return n;
  };
  for (int b = 0; b < grid.block_count(); ++b) {
    grid::Block const& block = grid.blocks()[b];
    Patch& patch = patches[b];
    patch.reach = reach;
    patch.dimensions = dims;
    patch.n = nodes_of(block);
    patch.cells = block.n;
    for (int d = 0; d < 3; ++d) {
      patch.first[d] = d < dims ? domain.lower[d] + block.origin[d] * domain.h : domain.centre({0, 0, 0})[d];
    }
    Index3 low{0, 0, 0};
    Index3 high{0, 0, 0};
    for (int d = 0; d < dims; ++d) {
      low[d] = -1;
      high[d] = 1;
    }
    for (int oz = low[2]; oz <= high[2]; ++oz) {
      for (int oy = low[1]; oy <= high[1]; ++oy) {
        for (int ox = low[0]; ox <= high[0]; ++ox) {
          Index3 const offset{ox, oy, oz};
          Link link;
          link.source = b;
          bool exists = true;
          for (int d = 0; d < dims && exists; ++d) {
            Side const side =
                offset[d] == 0 ? Side{link.source, false} : beyond(grid, link.source, d, offset[d] > 0 ? 1 : 0);
            exists = side.block != grid::no_neighbour;
            if (!exists) break;
            if (side.mirror && domain.boundary[2 * d + (offset[d] > 0 ? 1 : 0)] == grid::Boundary::wall)
              link.wall = true;
            link.source = side.block;
            Span const span = span_of(block.n[d], grid.blocks()[side.block].n[d], reach, offset[d], side.mirror);
            link.lower[d] = span.lower;
            link.upper[d] = span.upper;
            link.flip[d] = span.flip;
            link.shift[d] = span.shift;
          }
          if (!exists) continue;
          link.source_n = nodes_of(grid.blocks()[link.source]);
          patch.links.push_back(link);
        }
      }
    }
  }
  return patches;
}

}  // namespace brisance::mpm
