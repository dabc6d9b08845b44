#include "gas/disturbance.hpp"

#include <algorithm>
#include <atomic>

#include "core/loops.hpp"
#include "core/parallel.hpp"

namespace brisance::gas {

namespace {

/// Threads that sweep bundles of one block ask for its tiles and set them. Whether one sees what another sets at that
/// time makes no difference: it would sweep a bundle that rests.
bool is_set(std::uint8_t& tile) { return std::atomic_ref(tile).load(std::memory_order_relaxed) != 0; }
void set(std::uint8_t& tile) { std::atomic_ref(tile).store(1, std::memory_order_relaxed); }

}  // namespace

Disturbance::Disturbance(grid::Grid const& grid)
    : grid_(&grid), blocks_(grid, [](grid::Block const& block) {
        grid::Tiles const tiles(block);
        return OfBlock{tiles, std::vector<std::uint8_t>(tiles.count(), 1)};
      }) {}

void Disturbance::find(grid::Fields const& fields, Components const& quiet) {
  parallel_for(grid_->block_count(), [&](int b, int) { find(fields, quiet, b); });
}

void Disturbance::find(grid::Fields const& fields, Components const& quiet, int b) {
  OfBlock& of = blocks_[b];
  grid::CellRange const interior = grid_->blocks()[b].interior();
  for (std::size_t tile = 0; tile < of.disturbed.size(); ++tile) {
    grid::CellRange rows = of.tiles.cells(tile);
    int const length = rows.n(0);
    rows.upper[0] = rows.lower[0] + 1;
    of.disturbed[tile] = grid::any_cell(rows, [&](Index3 const& first) {
      for (int c = 0; c < fields.components(); ++c) {
        if (!all_equal(fields.at(b, c) + interior.offset(first), length, quiet[c])) return true;
      }
      return false;
    });
  }
  of.everywhere = std::find(of.disturbed.begin(), of.disturbed.end(), 0) == of.disturbed.end() ? 1 : 0;
}

void Disturbance::note(grid::Cell const& cell) {
  OfBlock& of = blocks_[cell.block];
  if (is_set(of.everywhere)) return;
  set(of.disturbed[of.tiles.of(cell.within())]);
}

void Disturbance::note(int b, BundleLayout const& layout, SweepContext const& s, Components const& quiet,
                       BundleArrays& a) {
  OfBlock& of = blocks_[b];
  if (is_set(of.everywhere)) return;
  int const count = components_of(s.present);
  int const sensor = s.shock_sensor ? a_sensor : state_array(shock);
  auto const differs = [&](int q, int cells) {
    for (int c = 0; c < count; ++c) {
      if (!all_equal(a[c == shock ? sensor : state_array(c)] + q, cells, quiet[c])) return true;
    }
    return false;
  };
  bool anything_new = false;
  static_cast<void>(of.tiles.any_piece(grid_->blocks()[b], layout, [&](grid::Tiles::Piece const& piece) {
    std::uint8_t& tile = of.disturbed[piece.tile];
    if (!is_set(tile) && grid::Tiles::any_run(piece, layout, differs)) {
      set(tile);
      anything_new = true;
    }
    return false;
  }));
  if (anything_new && std::all_of(of.disturbed.begin(), of.disturbed.end(), is_set)) set(of.everywhere);
}

bool Disturbance::touches(int b, BundleLayout const& layout) {
  OfBlock& of = blocks_[b];
  return is_set(of.everywhere) || of.tiles.any_piece(grid_->blocks()[b], layout, [&](grid::Tiles::Piece const& piece) {
    return is_set(of.disturbed[piece.tile]);
  });
}

}  // namespace brisance::gas
