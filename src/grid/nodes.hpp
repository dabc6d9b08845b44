/// Nodes of a box of cells, and arrays over them. As in cell.hpp, only here are their indices turned into places.
#pragma once

#include "core/vec.hpp"
#include "grid/cell.hpp"

namespace brisance::grid {

/// The nodes of a box: arrays over it hold x fastest. Parts of it are told by `CellRange`, as of cells.
struct NodeBox {
  Index3 n{1, 1, 1};  ///< nodes per direction

  [[nodiscard]] int count() const { return n[0] * n[1] * n[2]; }
  [[nodiscard]] int index(int i, int j, int k) const { return i + n[0] * (j + n[1] * k); }
  [[nodiscard]] int index(Index3 const& node) const { return index(node[0], node[1], node[2]); }
  /// How far apart neighbours along d stand in the arrays.
  [[nodiscard]] int stride(int d) const { return d == 0 ? 1 : d == 1 ? n[0] : n[0] * n[1]; }
  /// Index along d of the node at a place.
  [[nodiscard]] int along(int d, int place) const { return place / stride(d) % n[d]; }
  /// The node at a place.
  [[nodiscard]] Index3 at(int place) const { return {place % n[0], (place / n[0]) % n[1], place / (n[0] * n[1])}; }
  [[nodiscard]] CellRange all() const { return {{0, 0, 0}, n}; }
  /// Those with one index along d.
  [[nodiscard]] CellRange plane(int d, int index) const {
    CellRange part = all();
    part.lower[d] = index;
    part.upper[d] = index + 1;
    return part;
  }
};

/// Calls visit(place) for the nodes of a part of a box, in the order of arrays over the box.
template <class Visit>
void for_each_node(NodeBox const& box, CellRange const& part, Visit&& visit) {
  for_each_row(part, [&](Index3 const& first) {
    int const begin = box.index(first);
    for (int place = begin; place < begin + part.n(0); ++place) visit(place);
  });
}

}  // namespace brisance::grid
