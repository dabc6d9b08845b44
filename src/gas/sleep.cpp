/// Blocks that sleep, and quiescent bundles of those that are awake. What they leave out must be what a sweep would
/// have done, to the last bit: their cells stay as they are, and the accounts get what quiescent gas carries through
/// the domain's faces.
#include <algorithm>
#include <cmath>

#include "core/loops.hpp"
#include "core/parallel.hpp"
#include "gas/gas.hpp"
#include "gas/primitives.hpp"
#include "gas/schemes/schemes.hpp"

namespace brisance::gas {

namespace {

/// A row of quiescent gas, a whole number of vectors long.
constexpr int row_cells = 32;

BundleLayout row_layout(int direction) {
  BundleLayout layout;
  layout.direction = direction;
  layout.length = row_cells;
  layout.total = row_cells + 2 * grid::ghost_layers;
  return layout;
}

BundleArrays row_of(Components const& quiet, BundleLayout const& layout) {
  BundleArrays a(array_count);
  for (int c = 0; c <= shock; ++c) std::fill_n(a[state_array(c)], layout.total, quiet[c]);
  return a;
}

}  // namespace

void Gas::find_quiescence() {
  quiet_ = {};
  quiet_.state = conserved_of(fluids_, quiescent_);
  int const dims = grid_->domain().dimensions();
  for (int direction = 0; direction < dims; ++direction) {
    BundleLayout const layout = row_layout(direction);
    BundleArrays a = row_of(quiet_.state, layout);
    int const middle = layout.begin(0) + row_cells / 2;
    GuardCount guards;
    SweepContext s = sweep_context(direction, short_step());
    set_present(1, s);
    s.radial = false;
    primitives(s, layout, a, guards);
    face_fluxes(options_.scheme, s, layout, a, guards);
    for (int c = 0; c <= energy; ++c) quiet_.flux[direction][c] = a[a_flux + c][middle];
    quiet_.signal = signals(s, layout, a, layout.begin(0), row_cells, dims, guards);
    quiet_.pressure = a[a_p][middle];
  }
}

double Gas::short_step() const {
  double const rho = quiet_.state[partial_density(0)];
  double const c = std::sqrt(std::max(0.0, mixture(fluids_, {rho}, {}).bulk_modulus(quiescent_.pressure)) / rho);
  return 0.1 * grid_->smallest_cell() / (norm(quiescent_.velocity) + c);
}

void Gas::wake_where_wind_changes() {
  Components const& quiet = quiet_.state;
  grid::AwakeBlocks everything(*grid_, 1);
  grid::AwakeBlocks slept = awake_;
  for (auto& block : slept) block = block == 0 ? 1 : 0;
  for (int direction = 0; direction < grid_->domain().dimensions(); ++direction) {
    exchange_.fill(fields_, direction, everything);
    SweepContext const context = sweep_context(direction, short_step());
    for (auto const& of_level : parts_) {
      std::vector<Part> const& parts = of_level[direction];
      parallel_for(static_cast<int>(parts.size()),
                   [&](int n, int thread) { sweep_part(parts[n], context, slept, false, workspaces_[thread]); });
    }
    parallel_for(grid_->block_count(), [&](int b, int) {
      if (is_swept(b, slept) && !is_quiescent_block(b)) awake_[b] = 1;
    });
    // Back to what they were; not before all have seen their neighbours.
    for (int b = 0; b < grid_->block_count(); ++b) {
      if (slept[b] == 0) continue;
      for (int component = 0; component < components(); ++component)
        std::fill_n(fields_.at(b, component), grid_->blocks()[b].cell_count(), quiet[component]);
    }
  }
  coupling.clear_watched();
}

bool Gas::ghosts_rest(int b, BundleLayout const& layout, grid::KeptLayers const& kept) const {
  grid::GhostSide const low = ghosts_beyond(b, 0, layout);
  grid::GhostSide const high = ghosts_beyond(b, 1, layout);
  for (int c = 0; c < components(); ++c) {
    auto const differs = [value = quiet_.state[c]](double const* run, int count) {
      return !all_equal(run, count, value);
    };
    if (kept.cells_below(layout, c, low).any_run(layout, differs)) return false;
    if (high.cells(c).any_run(layout, differs)) return false;
  }
  return true;
}

bool Gas::rests(int b, int bundle, BundleLayout const& layout, grid::KeptLayers const& kept) {
  if (disturbance_.touches(b, layout)) return false;
  return coupling.faces(b, layout.direction, bundle).empty() && ghosts_rest(b, layout, kept);
}

void Gas::account_quiet(int b, BundleLayout const& layout, int direction, double dt, Account& account) const {
  grid::Block const& block = grid_->blocks()[b];
  Components const& flux = quiet_.flux[direction];
  Components& outflow = account.outflow;
  // In the order of `account_boundaries`.
  for (int side = 0; side < 2; ++side) {
    if (!block.at_boundary(2 * direction + side) || block.covered) continue;
    double const sign = side == 0 ? -1.0 : 1.0;
    for (int line = 0; line < layout.lines(); ++line) {
      grid::Cell const cell = layout.end_cell(block, side, line);
      if (!coupling.is_own(cell) || block.is_covered(cell)) continue;
      double const area = cut.area(cell, direction, side);
      for (int c = 0; c <= energy; ++c) outflow[c] += sign * area * dt * flux[c];
    }
  }
}

void Gas::account_asleep(int b, Part const& part, int direction, double dt, Account& account) const {
  grid::Block const& block = grid_->blocks()[b];
  if (coupling.all_frozen(b)) return;
  if (!block.at_boundary(2 * direction) && !block.at_boundary(2 * direction + 1)) return;
  grid::Bundles const bundles(block, direction, options_.bundle_cells);
  for (int index = part.first; index < part.end; ++index)
    account_quiet(b, bundles.layout(index), direction, dt, account);
}

}  // namespace brisance::gas
