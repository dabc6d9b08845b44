/// A bundle: the rows or columns of a block that one sweep kernel works on at a time, gathered into contiguous arrays
/// that stay in the nearest caches.
///
/// Cells of all bundles are numbered so that the neighbours of cell q along the sweep are q - stride and q + stride:
///   sweep along x: whole rows, stride 1, each row with its ghost cells; several rows follow each other;
///   sweep along y or z: `stride` columns side by side, x fastest, layer after layer.
/// Face q lies between cells q and q + stride. At the ends of rows the arrays hold pairs of cells that are no
/// neighbours; what is computed there is never used.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "core/buffer.hpp"
#include "core/loops.hpp"
#include "grid/grid.hpp"

namespace brisance::grid {

/// Where the cells of one bundle lie in their block.
struct BundleLayout {
  int direction = 0;
  int stride = 1;  ///< distance of neighbours
  int length = 0;  ///< cells along the sweep, ghosts not counted
  int rows = 1;    ///< x: number of rows; else 1
  int total = 0;   ///< cells in the bundle, ghosts counted
  int first = 0;   ///< x: first row (j + ny k); y, z: first column
  int plane = 0;   ///< y: index k

  /// Place of a cell of the block in the bundle, if it is one of the bundle's.
  [[nodiscard]] int place(Block const& block, Cell const& cell) const {
    switch (direction) {
      case 0: return (cell.j + block.n[1] * cell.k - first) * (length + 2 * ghost_layers) + ghost_layers + cell.i;
      case 1: return (ghost_layers + cell.j) * stride + cell.i - first;
      default: return (ghost_layers + cell.k) * stride + cell.i + block.n[0] * cell.j - first;
    }
  }

  /// In the arrays of a block that the bundle passes through: the lowest cell of the first line, and the distances of
  /// lines and of layers across the sweep.
  [[nodiscard]] std::ptrdiff_t start_in(Block const& block) const {
    std::ptrdiff_t const nx = block.n[0];
    return direction == 0 ? nx * first : first + (direction == 1 ? nx * block.n[1] * plane : 0);
  }
  [[nodiscard]] std::ptrdiff_t line_in(Block const& block) const { return direction == 0 ? block.n[0] : 1; }
  [[nodiscard]] std::ptrdiff_t layer_in(Block const& block) const {
    return direction == 0 ? 1 : direction == 1 ? block.n[0] : static_cast<std::ptrdiff_t>(block.n[0]) * block.n[1];
  }

  /// Lines along the sweep: rows along x, columns along y or z.
  [[nodiscard]] int lines() const { return direction == 0 ? rows : stride; }
  /// The block's cell at the low (side 0) or high (1) end of a line.
  [[nodiscard]] Cell end_cell(Block const& block, int side, int line) const {
    int const end = side == 0 ? 0 : block.n[direction] - 1;
    int const number = first + line;
    switch (direction) {
      case 0: return block.cell(end, number % block.n[1], number / block.n[1]);
      case 1: return block.cell(number, end, plane);
      default: return block.cell(number % block.n[0], number / block.n[0], end);
    }
  }

  /// Cells from q0 = begin(r), q1 = q0 + count() are the block's own; r in [0, rows).
  [[nodiscard]] int begin(int r) const {
    return direction == 0 ? r * (length + 2 * ghost_layers) + ghost_layers : ghost_layers * stride;
  }
  [[nodiscard]] int count() const { return length * stride; }
};

/// Cells that a bundle has at most, ghosts counted, and the distance of its arrays: a constant, so that all of them are
/// addressed from one register. It is no multiple of a power of two: arrays lie in different cache sets. Kernels run
/// over the ends by less than a vector.
inline constexpr int most_bundle_cells = 384;
inline constexpr int bundle_margin = 16;
inline constexpr int bundle_pitch = most_bundle_cells + 2 * bundle_margin + 8;

/// The arrays of a bundle.
class BundleArrays {
 public:
  explicit BundleArrays(int names) : data_(static_cast<std::size_t>(bundle_pitch) * names) {}
  [[nodiscard]] double* operator[](int name) {
    return data_.data() + static_cast<std::size_t>(bundle_pitch) * name + bundle_margin;
  }

 private:
  Buffer data_;
};

/// Number of bundles in a block for a sweep, and the layout of each. `cells` is the wanted size of a bundle.
class Bundles {
 public:
  Bundles(Block const& block, int direction, int cells) : block_(&block), direction_(direction) {
    int const with_ghosts = block.n[direction] + 2 * ghost_layers;
    if (direction == 0) {
      lines_ = block.n[1] * block.n[2];
    } else {
      lines_ = direction == 1 ? block.n[0] : block.n[0] * block.n[1];
      planes_ = direction == 1 ? block.n[2] : 1;
    }
    width_ = std::clamp(cells / with_ghosts, 1, lines_);
    if (direction != 0 && lines_ > 8) width_ = std::max(8, width_ / 8 * 8);
    // Whole vectors of columns side by side, or an even part of one.
    while (width_ * with_ghosts > most_bundle_cells) width_ = (width_ + 1) / 2;
    width_ = std::min(width_, lines_);
    per_plane_ = (lines_ + width_ - 1) / width_;
  }
  /// Does each bundle hold the same lines as that of another block behind or before this one?
  [[nodiscard]] bool match(Bundles const& other) const {
    return width_ == other.width_ && lines_ == other.lines_ && planes_ == other.planes_;
  }
  [[nodiscard]] int count() const { return per_plane_ * planes_; }
  [[nodiscard]] int most_lines() const { return width_; }  ///< of a bundle
  /// The bundle that a cell of the block belongs to.
  [[nodiscard]] int index_of(Cell const& cell) const {
    switch (direction_) {
      case 0: return (cell.j + block_->n[1] * cell.k) / width_;
      case 1: return per_plane_ * cell.k + cell.i / width_;
      default: return (cell.i + block_->n[0] * cell.j) / width_;
    }
  }
  [[nodiscard]] BundleLayout layout(int index) const {
    BundleLayout b;
    b.direction = direction_;
    b.length = block_->n[direction_];
    b.plane = index / per_plane_;
    b.first = index % per_plane_ * width_;
    int const width = std::min(width_, lines_ - b.first);
    b.rows = direction_ == 0 ? width : 1;
    b.stride = direction_ == 0 ? 1 : width;
    b.total = width * (b.length + 2 * ghost_layers);
    return b;
  }

 private:
  Block const* block_;
  int direction_;
  int lines_ = 1;
  int planes_ = 1;
  int width_ = 1;
  int per_plane_ = 1;
};

/// Copies a short run. A call of the library's copy would cost more than the copying, and so would a loop of unknown
/// length for the eight columns that most bundles have.
inline void copy_run(double const* from, int count, double* to) {
  constexpr int usual = 8;
  if (count == usual) {
    std::array<double, usual> run;
    for (int n = 0; n < usual; ++n) run[n] = from[n];
    for (int n = 0; n < usual; ++n) to[n] = run[n];
    return;
  }
  BRISANCE_VECTOR_LOOP
  for (int n = 0; n < count; ++n) to[n] = from[n];
}

/// Calls visit(q, offset, count) for every run of the block's own cells that is contiguous in the bundle and in the
/// block.
template <class Visit>
void for_each_run(BundleLayout const& b, Block const& block, Visit&& visit) {
  constexpr int g = ghost_layers;
  if (b.direction == 0) {
    for (int r = 0; r < b.rows; ++r) visit(r * (b.length + 2 * g) + g, (b.first + r) * b.length, b.length);
    return;
  }
  auto const layer = static_cast<int>(b.layer_in(block));
  auto const start = static_cast<int>(b.start_in(block));
  for (int l = 0; l < b.length; ++l) visit((g + l) * b.stride, start + layer * l, b.stride);
}

/// What the next bundle reads of its block and of the block behind that. It lies scattered, where the processor does
/// not foresee it, and is asked for line by line while the present bundle is calculated: all at once, the requests
/// would wait for each other.
class Ahead {
 public:
  static constexpr int line = 8;  ///< doubles that come together

  Ahead() = default;
  /// `block` is that of the next bundle, `behind` the next block of the chain or null.
  Ahead(BundleLayout const& b, Block const& block, Block const* behind) : own_(b, block) {
    if (b.direction == 0) {
      // Whole rows follow each other without a gap.
      own_.per_row = 1;
      own_.step = line;
      own_.lines = (b.rows * b.length + line - 1) / line;
    } else {
      own_.lines = own_.per_row * b.length;
    }
    if (behind == nullptr) return;
    behind_ = Lines(b, *behind);
    if (b.direction == 0) behind_.per_row = 1;
    behind_.lines = behind_.per_row * (b.direction == 0 ? b.rows : ghost_layers);
  }
  /// Adds an array over the cells of the block, and that over those of the block behind; null: none.
  void add(double const* array, double const* behind = nullptr) {
    if (array != nullptr) own_.add(array);
    if (behind != nullptr) behind_.add(behind);
  }

  [[nodiscard]] int lines() const { return own_.lines; }
  void fetch(int number) const {
    // To the compiler a function that only fetches does nothing, and it leaves out the call: the statement keeps it.
    asm volatile("");
    if (number >= own_.lines) return;
    std::ptrdiff_t const at = own_.at(number);
    for (int c = 0; c < own_.arrays; ++c) __builtin_prefetch(own_.from[c] + at, 0, 2);
    int const requests = behind_.arrays * behind_.lines;
    int const share = (requests + own_.lines - 1) / own_.lines;
    for (int n = number * share; n < std::min((number + 1) * share, requests); ++n)
      __builtin_prefetch(behind_.from[n % behind_.arrays] + behind_.at(n / behind_.arrays), 0, 2);
  }

 private:
  struct Lines {
    static constexpr int most_arrays = 12;
    std::array<double const*, most_arrays> from{};
    int arrays = 0;
    std::ptrdiff_t offset = 0;
    std::ptrdiff_t step = 0;  ///< from one row of cells to the next
    int per_row = 1;
    int lines = 0;

    Lines() = default;
    Lines(BundleLayout const& b, Block const& block)
        : offset(b.start_in(block)),
          step(b.direction == 0 ? b.line_in(block) : b.layer_in(block)),
          per_row(((b.direction == 0 ? b.length : b.stride) + line - 1) / line) {}
    void add(double const* array) {
      if (arrays < most_arrays) from[arrays++] = array + offset;
    }
    [[nodiscard]] std::ptrdiff_t at(int number) const {
      if (per_row == 1) return step * number;
      return step * (number / per_row) + static_cast<std::ptrdiff_t>(line) * (number % per_row);
    }
  };

  Lines own_, behind_;
};

/// Calls visit(q) for every cell of the block with the index i = 0 in a bundle.
template <class Visit>
void for_each_row_begin(BundleLayout const& b, Block const& block, Visit&& visit) {
  int const nx = block.n[0];
  for_each_run(b, block, [&](int q, int offset, int count) {
    for (int n = (nx - offset % nx) % nx; n < count; n += nx) visit(q + n);
  });
}

/// Copies data that is known in the ghost cells too, in arrays over `Block::with_ghosts`, into a bundle.
template <class T, class Convert>
void load_with_ghosts(BundleLayout const& b, Block const& block, T const* from, Convert&& convert, double* to) {
  constexpr int g = ghost_layers;
  CellRange const box = block.with_ghosts();
  std::ptrdiff_t const step = box.stride(b.direction);
  int const apart = b.direction == 0 ? 1 : b.stride;
  for (int line = 0; line < b.lines(); ++line) {
    Index3 begin = b.end_cell(block, 0, line).within();
    begin[b.direction] -= g;
    T const* value = from + box.offset(begin);
    double* cell = to + (b.direction == 0 ? line * (b.length + 2 * g) : line);
    for (int l = 0; l < b.length + 2 * g; ++l, value += step, cell += apart) *cell = convert(*value);
  }
}

}  // namespace brisance::grid
