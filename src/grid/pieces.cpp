#include "grid/pieces.hpp"

#include <cstdint>
#include <unordered_map>
#include <unordered_set>

#include "grid/cell.hpp"

namespace brisance::grid {

namespace {

/// The number of the part of its parent that a leaf is.
unsigned part_of_parent(Leaf const& leaf, int dimensions) {
  unsigned part = 0;
  for (int d = 0; d < dimensions; ++d) part |= static_cast<unsigned>(leaf.place[d] % 2) << static_cast<unsigned>(d);
  return part;
}

Leaf parent_of(Leaf const& leaf, int dimensions) {
  Leaf parent{leaf.level - 1, leaf.place};
  for (int d = 0; d < dimensions; ++d) parent.place[d] /= 2;
  return parent;
}

/// Does a counting part of a block touch the block at an offset of -1, 0 or 1 along each direction?
bool touches(unsigned counting, Index3 const& offset, int dimensions) {
  for (unsigned part = 0; part < 1U << static_cast<unsigned>(dimensions); ++part) {
    if ((counting >> part & 1U) == 0) continue;
    bool touches = true;
    for (int d = 0; d < dimensions; ++d) {
      int const side = (part >> static_cast<unsigned>(d) & 1U) == 0 ? -1 : 1;
      touches = touches && (offset[d] == 0 || offset[d] == side);
    }
    if (touches) return true;
  }
  return false;
}

/// The counting parts of pieces by the Morton keys of their places, level by level.
using Known = std::vector<std::unordered_map<std::uint64_t, unsigned>>;

/// Is a block part of a coarser piece, where that counts?
bool lies_in_coarser(Leaf block, Known const& known, int dimensions) {
  while (block.level > 0) {
    unsigned const part = part_of_parent(block, dimensions);
    block = parent_of(block, dimensions);
    auto const found = known[block.level].find(morton(block.place));
    if (found != known[block.level].end() && (found->second >> part & 1U) != 0) return true;
  }
  return false;
}

}  // namespace

Leaf leaf_at(Block const& block) {
  Leaf leaf{block.level, {0, 0, 0}};
  for (int d = 0; d < block.metric.dimensions(); ++d) leaf.place[d] = block.origin[d] / block.size[d];
  return leaf;
}

std::vector<Piece> pieces_of(Forest const& forest, std::vector<Domain> const& domains, Index3 const& size) {
  int const dims = forest.dimensions();
  unsigned const all = (1U << (1U << static_cast<unsigned>(dims))) - 1U;
  std::vector<Piece> pieces;
  pieces.reserve(forest.leaves().size());
  std::vector<std::unordered_map<std::uint64_t, std::size_t>> parents(domains.size());  // of leaves left coarse
  for (std::size_t n = 0; n < forest.leaves().size(); ++n) {
    Leaf const& leaf = forest.leaves()[n];
    bool inside = true;
    for (int d = 0; d < dims; ++d) inside = inside && leaf.place[d] * size[d] < domains[leaf.level].cells[d];
    if (!inside) continue;
    if (!forest.is_left_coarse(static_cast<int>(n))) {
      pieces.push_back({leaf, all});
      continue;
    }
    Leaf const parent = parent_of(leaf, dims);
    auto const [found, fresh] = parents[parent.level].try_emplace(morton(parent.place), pieces.size());
    if (fresh) pieces.push_back({parent, 0});
    pieces[found->second].counting |= 1U << part_of_parent(leaf, dims);
  }
  return pieces;
}

std::vector<Piece> pieces_below(std::vector<Piece> const& pieces, std::vector<Domain> const& domains,
                                Index3 const& size) {
  int const dims = domains.front().dimensions();
  Known known(domains.size());
  for (Piece const& piece : pieces) known[piece.at.level][morton(piece.at.place)] = piece.counting;
  std::vector<std::unordered_set<std::uint64_t>> found(domains.size());
  std::vector<Piece> below;
  for (Piece const& piece : pieces) {
    Leaf const& leaf = piece.at;
    Domain const& domain = domains[leaf.level];
    Index3 parts{1, 1, 1};
    for (int d = 0; d < dims; ++d) parts[d] = (domain.cells[d] + size[d] - 1) / size[d];
    for_each_cell(around({0, 0, 0}, 1, dims), [&](Index3 const& offset) {
      if (!touches(piece.counting, offset, dims)) return;
      Index3 place = leaf.place;
      for (int d = 0; d < dims; ++d) {
        place[d] += offset[d];
        if (place[d] >= 0 && place[d] < parts[d]) continue;
        if (domain.boundary[2 * d] != Boundary::periodic) return;
        place[d] = (place[d] + parts[d]) % parts[d];
      }
      // No piece: part of a coarser one, or it has been refined, and then one of the leaves in it touches this one.
      if (known[leaf.level].contains(morton(place)) || lies_in_coarser({leaf.level, place}, known, dims)) return;
      if (found[leaf.level].insert(morton(place)).second) below.push_back({{leaf.level, place}, 0});
    });
  }
  return below;
}

}  // namespace brisance::grid
