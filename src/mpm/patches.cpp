#include "mpm/patches.hpp"

#include <optional>

namespace brisance::mpm {

Side beyond(grid::Grid const& grid, int block, int d, int side) {
  int const neighbour = grid.blocks()[block].neighbour[2 * d + side];
  if (neighbour != grid::no_neighbour) return {neighbour, false};
  grid::Boundary const boundary = grid.domain().boundary[2 * d + side];
  return grid::is_mirror(boundary) ? Side{block, true} : Side{};
}

std::array<int, 27> blocks_around(grid::Grid const& grid, int block) {
  std::array<int, 27> around{};
  for_each_cell(grid::around({0, 0, 0}, 1, 3), [&](Index3 const& offset) {
    int there = block;
    for (int d = 0; d < 3 && there != grid::no_neighbour; ++d) {
      if (offset[d] != 0) there = grid.blocks()[there].neighbour[2 * d + (offset[d] > 0 ? 1 : 0)];
    }
    around[around_index(offset)] = there;
  });
  return around;
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

grid::NodeBox nodes_of(grid::Block const& block, int reach) {
  grid::NodeBox nodes;
  for (int d = 0; d < block.metric.dimensions(); ++d) nodes.n[d] = block.n[d] + 1 + 2 * reach;
  return nodes;
}

/// What a patch receives from what lies at an offset (-1, 0, 1 per direction) from its block, if anything does.
std::optional<Link> link_to(grid::Grid const& grid, int block, Index3 const& offset, int reach) {
  grid::Domain const& domain = grid.domain();
  Link link;
  link.source = block;
  for (int d = 0; d < domain.dimensions(); ++d) {
    int const face = 2 * d + (offset[d] > 0 ? 1 : 0);
    Side const side = offset[d] == 0 ? Side{link.source, false} : beyond(grid, link.source, d, face % 2);
    if (side.block == grid::no_neighbour) return std::nullopt;
    if (side.mirror && domain.boundary[face] == grid::Boundary::wall) link.wall = true;
    link.source = side.block;
    Span const span = span_of(grid.blocks()[block].n[d], grid.blocks()[side.block].n[d], reach, offset[d], side.mirror);
    link.to.lower[d] = span.lower;
    link.to.upper[d] = span.upper + 1;
    link.flip[d] = span.flip;
    link.shift[d] = span.shift;
  }
  link.nodes = nodes_of(grid.blocks()[link.source], reach);
  return link;
}

}  // namespace

std::vector<Patch> make_patches(grid::Grid const& grid, int reach) {
  int const dims = grid.domain().dimensions();
  std::vector<Patch> patches(grid.blocks().size());
  for (int b = 0; b < grid.block_count(); ++b) {
    grid::Block const& block = grid.blocks()[b];
    Patch& patch = patches[b];
    static_cast<grid::NodeBox&>(patch) = nodes_of(block, reach);
    patch.h = block.h();
    patch.reach = reach;
    patch.dimensions = dims;
    patch.cells = block.n;
    Vec3 const corner = block.metric.low_corner(block.in_domain().lower);
    Vec3 const centre = block.metric.centre({0, 0, 0});
    for (int d = 0; d < 3; ++d) patch.first[d] = d < dims ? corner[d] : centre[d];
    for_each_cell(grid::around({0, 0, 0}, 1, dims), [&](Index3 const& offset) {
      if (auto const link = link_to(grid, b, offset, reach)) patch.links.push_back(*link);
    });
  }
  return patches;
}

}  // namespace brisance::mpm
