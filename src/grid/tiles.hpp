/// A block in tiles of some cells along each direction, and the tiles that a bundle touches.
#pragma once

#include <algorithm>

#include "grid/bundle.hpp"

namespace brisance::grid {

class Tiles {
 public:
  explicit Tiles(Block const& block) : n_(block.n) {
    for (int d = 0; d < 3; ++d) count_[d] = (n_[d] + edge - 1) / edge;
    all_ = {{0, 0, 0}, count_};
  }

  [[nodiscard]] std::size_t count() const { return all_.count(); }
  [[nodiscard]] std::size_t of(Index3 const& cell) const {
    return all_.offset({cell[0] / edge, cell[1] / edge, cell[2] / edge});
  }
  /// The cells of a tile, by their index within the block.
  [[nodiscard]] CellRange cells(std::size_t tile) const {
    CellRange box;
    Index3 const at = all_.at(tile);
    for (int d = 0; d < 3; ++d) {
      box.lower[d] = at[d] * edge;
      box.upper[d] = std::min(box.lower[d] + edge, n_[d]);
    }
    return box;
  }

  /// Some lines of a bundle next to each other, and some cells of each, that lie in one tile.
  struct Piece {
    std::size_t tile;
    int line, lines;
    int begin, length;  ///< cells along the sweep
  };
  /// Calls visit(piece) until it returns true; returns whether it did.
  template <class Visit>
  [[nodiscard]] bool any_piece(Block const& block, BundleLayout const& layout, Visit const& visit) const {
    int const d = layout.direction;
    int const across = d == 0 ? 1 : 0;  // the direction in which lines follow each other
    for (int line = 0; line < layout.lines();) {
      Index3 const first = layout.end_cell(block, 0, line).within();
      int const room = std::min(edge - first[across] % edge, n_[across] - first[across]);
      int const lines = std::min(room, layout.lines() - line);
      std::size_t tile = of(first);
      for (int begin = 0; begin < layout.length; begin += edge, tile += static_cast<std::size_t>(all_.stride(d))) {
        if (visit(Piece{tile, line, lines, begin, std::min(edge, layout.length - begin)})) return true;
      }
      line += lines;
    }
    return false;
  }
  /// Calls visit(q, count) for the runs of a piece's cells that are contiguous in the bundle, until it returns true;
  /// returns whether it did.
  template <class Visit>
  [[nodiscard]] static bool any_run(Piece const& piece, BundleLayout const& layout, Visit const& visit) {
    bool const rows = layout.direction == 0;
    int const runs = rows ? piece.lines : piece.length;
    int const cells = rows ? piece.length : piece.lines;
    int const step = rows ? layout.begin(1) - layout.begin(0) : layout.stride;
    int q = rows ? layout.begin(piece.line) + piece.begin : layout.begin(0) + piece.begin * layout.stride + piece.line;
    for (int run = 0; run < runs; ++run, q += step) {
      if (visit(q, cells)) return true;
    }
    return false;
  }

 private:
  static constexpr int edge = 8;
  Index3 n_;
  Index3 count_{};
  CellRange all_;
};

}  // namespace brisance::grid
