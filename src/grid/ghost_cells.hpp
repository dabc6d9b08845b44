/// The ghost cells of a bundle: where they lie, and how a bundle is loaded with them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/buffer.hpp"
#include "grid/bundle.hpp"
#include "grid/exchange.hpp"
#include "grid/fields.hpp"
#include "grid/grid.hpp"

namespace brisance::grid {

/// Ghost cells of a bundle on one side, one component: that of the bundle's line n in layer l, counted upwards, is
/// first[n * line + l * layer]. Along y and z lines follow each other.
struct GhostCells {
  double const* first = nullptr;
  std::ptrdiff_t line = 1;
  std::ptrdiff_t layer = 1;

  /// In an array over `ghost_box`.
  static GhostCells in_slab(BundleLayout const& b, Block const& block, double const* slab) {
    constexpr int g = ghost_layers;
    std::ptrdiff_t const nx = block.n[0];
    switch (b.direction) {
      case 0: return {slab + static_cast<std::ptrdiff_t>(g) * b.first, g, 1};
      case 1: return {slab + b.first + nx * g * b.plane, 1, nx};
      default: return {slab + b.first, 1, nx * block.n[1]};
    }
  }
  /// In an array over the cells of the block that lies beyond the bundle's low (side 0) or high (1) end.
  static GhostCells in_block(BundleLayout const& b, Block const& beyond, int side, double const* cells) {
    std::ptrdiff_t const layer = b.layer_in(beyond);
    int const lowest = side == 0 ? beyond.n[b.direction] - ghost_layers : 0;
    return {cells + b.start_in(beyond) + layer * lowest, b.line_in(beyond), layer};
  }

  /// Calls visit(values, count) for contiguous runs of them until it returns true; returns whether it did.
  template <class Visit>
  bool any_run(BundleLayout const& b, Visit const& visit) const {
    constexpr int g = ghost_layers;
    if (b.direction != 0) {
      for (int l = 0; l < g; ++l) {
        if (visit(first + layer * l, b.stride)) return true;
      }
      return false;
    }
    if (line == g) return visit(first, g * b.rows);
    for (int r = 0; r < b.rows; ++r) {
      if (visit(first + line * r, g)) return true;
    }
    return false;
  }
};

/// Where a bundle finds the ghost cells of one side: in the block that follows in the chain on that side, or in a slab
/// that the exchange has filled.
class GhostSide {
 public:
  GhostSide(BundleLayout const& layout, Grid const& grid, Exchange const& exchange, Fields const& fields, int block,
            int side)
      : layout_(&layout), block_(&grid.blocks()[block]), fields_(&fields), side_(side) {
    int const face = 2 * layout.direction + side;
    if (exchange.plan().links(block, face)) {
      beyond_ = &grid.blocks()[block_->neighbour[face]];
    } else {
      slab_ = exchange.ghosts(block, side);
      pitch_ = static_cast<std::ptrdiff_t>(ghost_box(*block_, layout.direction).count());
    }
  }

  [[nodiscard]] bool in_slab() const { return beyond_ == nullptr; }
  [[nodiscard]] GhostCells cells(int component) const {
    if (in_slab()) return GhostCells::in_slab(*layout_, *block_, slab_ + pitch_ * component);
    return GhostCells::in_block(*layout_, *beyond_, side_, fields_->at(beyond_->number, component));
  }

 private:
  BundleLayout const* layout_;
  Block const* block_;
  Fields const* fields_;
  int side_;
  Block const* beyond_ = nullptr;
  double const* slab_ = nullptr;
  std::ptrdiff_t pitch_ = 0;
};

/// The uppermost layers of some bundles of a block as they were before the sweep: what the same bundles of the next
/// block in the chain have below them.
class KeptLayers {
 public:
  /// For bundles with the numbers [first, end) of no more than so many lines. A chain begins: nothing has been kept.
  void begin(int first, int end, int lines, int components) {
    first_ = first;
    components_ = components;
    pitch_ = (ghost_layers * lines + line - 1) / line * line;
    held_.assign(end - first, 0);
    auto const needed = static_cast<std::size_t>(end - first) * components * pitch_;
    if (data_.size() < needed) data_ = Buffer(needed);
  }
  /// A bundle of the next block in the chain begins: what has been kept now lies below it. Components that have not
  /// been kept are as they were in the block before, and so are all where that was not swept.
  void turn(int bundle) {
    bundle_ = bundle - first_;
    below_ = std::exchange(held_[bundle_], 0);
  }
  /// The cells below the bundle; `otherwise` is where they are as long as no sweep changes them.
  [[nodiscard]] GhostCells cells_below(BundleLayout const& b, int component, GhostSide const& otherwise) const {
    if ((below_ >> component & 1U) == 0) return otherwise.cells(component);
    double const* const first = data_.data() + place(component);
    return b.direction == 0 ? GhostCells{first, ghost_layers, 1} : GhostCells{first, 1, b.stride};
  }
  /// Keeps a component of the bundle, which has just been loaded.
  void keep(BundleLayout const& b, int component, double const* loaded) {
    constexpr int g = ghost_layers;
    double* const to = data_.data() + place(component);
    held_[bundle_] |= 1U << component;
    if (b.direction != 0) {
      copy_run(loaded + b.length * b.stride, g * b.stride, to);
      return;
    }
    for (int r = 0; r < b.rows; ++r) {
      double const* const end = loaded + b.begin(r) + b.length - g;
      for (int l = 0; l < g; ++l) to[g * r + l] = end[l];
    }
  }

 private:
  static constexpr int line = 8;

  [[nodiscard]] std::ptrdiff_t place(int component) const {
    return static_cast<std::ptrdiff_t>(pitch_) * (components_ * bundle_ + component);
  }

  Buffer data_;
  std::vector<std::uint32_t> held_;  ///< bits of the components
  std::uint32_t below_ = 0;
  int components_ = 0;
  int pitch_ = 0;
  int first_ = 0;
  int bundle_ = 0;
};

/// Copies one component of a bundle: the block's own cells, and the ghost cells.
inline void load(BundleLayout const& b, Block const& block, double const* from, GhostCells const& low,
                 GhostCells const& high, double* to) {
  constexpr int g = ghost_layers;
  if (b.direction == 0) {
    for (int r = 0; r < b.rows; ++r) {
      double* row = to + r * (b.length + 2 * g);
      for (int l = 0; l < g; ++l) {
        row[l] = low.first[low.line * r + l];
        row[g + b.length + l] = high.first[high.line * r + l];
      }
      copy_run(from + static_cast<std::ptrdiff_t>(b.first + r) * b.length, b.length, row + g);
    }
    return;
  }
  std::ptrdiff_t const layer = b.layer_in(block);
  double const* const start = from + b.start_in(block);
  for (int l = 0; l < g; ++l) {
    copy_run(low.first + low.layer * l, b.stride, to + l * b.stride);
    copy_run(high.first + high.layer * l, b.stride, to + (g + b.length + l) * b.stride);
  }
  for (int l = 0; l < b.length; ++l) {
    copy_run(start + layer * l, b.stride, to + (g + l) * b.stride);
  }
}

/// Asks for ghost cells before `load` reads them.
inline void prefetch(BundleLayout const& b, GhostCells const& cells) {
  constexpr int line = 8;
  // To the compiler a function that only fetches does nothing, and it leaves out the call: the statement keeps it.
  asm volatile("");
  cells.any_run(b, [](double const* run, int count) {
    for (int n = 0; n < count; n += line) __builtin_prefetch(run + n, 0, 2);
    return false;
  });
}

}  // namespace brisance::grid
