/// The nodes of the background grid, block by block. Each block has a patch of its own: all nodes that its particles
/// can touch. Particles write into the patch of their block only; afterwards every patch sums what all patches hold for
/// its nodes, always in the same order, so that copies of a node agree and the result does not depend on the threads.
#pragma once

#include <array>
#include <vector>

#include "core/lanes.hpp"
#include "core/vec.hpp"
#include "grid/grid.hpp"
#include "grid/nodes.hpp"

namespace brisance::mpm {

/// Part of a patch that receives from the patch of block `source`: node i of the box gets node `flip * i + shift`
/// (storage indices, per direction). Where a direction is flipped, the source is the mirror image behind a symmetry
/// plane and the components along it change their sign.
struct Link {
  int source = 0;
  grid::CellRange to;  ///< the nodes that receive
  Index3 flip{1, 1, 1};
  Index3 shift{0, 0, 0};
  grid::NodeBox nodes;  ///< of the source's patch
  bool wall = false;    ///< the image is behind a `wall`: of bodies there is none

  /// Place of the source's node that stands for a node of the patch.
  [[nodiscard]] int source_index(Index3 const& node) const {
    return nodes.index(flip[0] * node[0] + shift[0], flip[1] * node[1] + shift[1], flip[2] * node[2] + shift[2]);
  }
};

/// What lies beyond one side of a block.
struct Side {
  int block = grid::no_neighbour;  ///< the block there; with `mirror` the block itself
  bool mirror = false;
};

/// Shape of a block's patch: its nodes, those beyond the block's faces included.
struct Patch : grid::NodeBox {
  double h = 1.0;             ///< size of the block's cells [m]
  Vec3 first{0.0, 0.0, 0.0};  ///< position of node (0, 0, 0) of the cells, that is without the reach [m]
  Index3 cells{1, 1, 1};
  int reach = 0;
  int dimensions = 3;
  std::vector<Link> links;  ///< of this block and all around it, in a fixed order

  [[nodiscard]] grid::CellRange cell_range() const { return {{0, 0, 0}, cells}; }
  /// Position of a node, by storage indices [m].
  [[nodiscard]] Vec3 position(Index3 const& i) const {
    Vec3 x = first;
    for (int d = 0; d < dimensions; ++d) x[d] += (i[d] - reach) * h;
    return x;
  }
};

/// Patches of all blocks of a grid for shape functions with the given reach.
[[nodiscard]] std::vector<Patch> make_patches(grid::Grid const& grid, int reach);

/// What lies beyond a block's low (0) or high (1) side in direction d; symmetry planes and walls mirror.
[[nodiscard]] Side beyond(grid::Grid const& grid, int block, int d, int side);

/// Number of the 27 blocks around a block: offsets -1, 0, 1 per direction.
[[nodiscard]] inline std::size_t around_index(Index3 const& offset) {
  return grid::CellRange{{-1, -1, -1}, {2, 2, 2}}.offset(offset);
}

/// A block and those around it, by `around_index`; `grid::no_neighbour` where there is none.
[[nodiscard]] std::array<int, 27> blocks_around(grid::Grid const& grid, int block);

/// Three components of a vector and one scalar: momentum or velocity with the mass.
using NodeVelocity = Lanes4;

/// What the particles give a node.
struct alignas(64) NodeSums {
  NodeVelocity momentum;  ///< [kg m/s], with the mass [kg]
  NodeVelocity force;     ///< [N], with the kinetic energy of the particles of APIC [J]
};

/// What a node does in a step.
struct alignas(64) NodeMotion {
  NodeVelocity velocity;  ///< the new one [m/s], with the mass [kg]
  NodeVelocity change;    ///< of the velocity over the step [m/s], with the kinetic energy of before and heat [J]
};

inline void add_to(NodeVelocity& sum, NodeVelocity const& part) { sum += part; }
inline void add_to(NodeVelocity& sum, NodeVelocity const& sign, NodeVelocity const& part) { sum += sign * part; }
inline void add_to(NodeSums& sum, NodeSums const& part) {
  sum.momentum += part.momentum;
  sum.force += part.force;
}
inline void add_to(NodeSums& sum, NodeVelocity const& sign, NodeSums const& part) {
  sum.momentum += sign * part.momentum;
  sum.force += sign * part.force;
}

/// Adds up what the links hold for each node of the patch. `raw(block)` is the array that the particles of a block
/// wrote, or null where that block has none. In a mirror the normal components of the vectors change their sign; not
/// those of `scalars`, records whose parts are no vectors. Without `walls` there are no images behind these.
template <class Record, class Raw>
void sum_links(Patch const& patch, Record* sum, Raw&& raw, bool scalars = false, bool walls = true) {
  bool first = true;
  for (Link const& link : patch.links) {
    if (link.wall && !walls) continue;
    Record const* from = raw(link.source);
    if (from == nullptr) continue;
    NodeVelocity sign{1.0, 1.0, 1.0, 1.0};
    bool mirrored = false;
    for (int d = 0; d < 3; ++d) {
      if (link.flip[d] > 0) continue;
      mirrored = true;
      sign[d] = scalars ? 1.0 : -1.0;
    }
    if (first) {
      for (int node = 0; node < patch.count(); ++node) sum[node] = Record{};
      first = false;
    }
    int const width = link.to.n(0);
    int const step = link.flip[0];
    grid::for_each_row(link.to, [&](Index3 const& node) {
      Record* to = sum + patch.index(node);
      Record const* row = from + link.source_index(node);
      if (mirrored) {
        for (int i = 0; i < width; ++i) add_to(to[i], sign, row[step * i]);
      } else {
        for (int i = 0; i < width; ++i) add_to(to[i], row[i]);
      }
    });
  }
  if (first) {
    for (int node = 0; node < patch.count(); ++node) sum[node] = Record{};
  }
}

}  // namespace brisance::mpm
