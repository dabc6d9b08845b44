/// Blocks that sleep. What a sleeping block leaves out must be what an awake one would have done, to the last bit: its
/// cells stay as they are, and the accounts get what quiescent gas carries through the domain's faces.
#include <algorithm>

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

Components Gas::quiescent_flux(SweepContext s) const {
  set_present(1, s);
  s.radial = false;
  BundleLayout const layout = row_layout(s.direction);
  BundleArrays a = row_of(conserved_of(fluids_, quiescent_), layout);
  GuardCount guards;
  primitives(s, layout, a, guards);
  face_fluxes(options_.scheme, s, layout, a, guards);
  Components flux{};
  for (int c = 0; c <= energy; ++c) flux[c] = a[a_flux + c][layout.begin(0) + row_cells / 2];
  return flux;
}

double Gas::quiescent_pressure() const {
  BundleLayout const layout = row_layout(0);
  BundleArrays a = row_of(conserved_of(fluids_, quiescent_), layout);
  GuardCount guards;
  SweepContext s = sweep_context(0, 0.0);
  set_present(1, s);
  signals(s, layout, a, layout.begin(0), row_cells, grid_->domain().dimensions(), guards);
  return a[a_p][layout.begin(0) + row_cells / 2];
}

void Gas::wake_where_wind_changes() {
  auto const quiet = conserved_of(fluids_, quiescent_);
  double const rho = quiet[partial_density(0)];
  double const c = std::sqrt(std::max(0.0, mixture(fluids_, {rho}, {}).bulk_modulus(quiescent_.pressure)) / rho);
  double const dt = 0.1 * grid_->smallest_cell() / (norm(quiescent_.velocity) + c);
  grid::AwakeBlocks everything(*grid_, 1);
  grid::AwakeBlocks const slept = awake_;
  for (int direction = 0; direction < grid_->domain().dimensions(); ++direction) {
    exchange_.fill(fields_, direction, everything);
    SweepContext const context = sweep_context(direction, dt);
    parallel_for(grid_->block_count(), [&](int b, int thread) {
      if (slept[b] != 0 || coupling.all_frozen(b)) return;
      Tally ignored;
      for (Part const& part : parts_of(b, direction)) sweep_part(part, context, false, workspaces_[thread], ignored);
      int const cells = grid_->blocks()[b].cell_count();
      for (int component = 0; component < components(); ++component) {
        double* const u = fields_.at(b, component);
        double const value = quiet[component];
        if (std::any_of(u, u + cells, [value](double x) { return x != value; })) awake_[b] = 1;
      }
    });
    // Back to what they were; not before all have seen their neighbours.
    for (int b = 0; b < grid_->block_count(); ++b) {
      if (slept[b] != 0) continue;
      for (int component = 0; component < components(); ++component)
        std::fill_n(fields_.at(b, component), grid_->blocks()[b].cell_count(), quiet[component]);
    }
  }
  coupling.clear_watched();
}

void Gas::account_asleep(Part const& part, SweepContext const& s, Components const& flux, Account& account) const {
  grid::Block const& block = grid_->blocks()[part.block];
  int const low = 2 * s.direction;
  if (!block.at_boundary(low) && !block.at_boundary(low + 1)) return;
  Components& outflow = account.outflow;
  grid::Bundles const bundles(block, s.direction, options_.bundle_cells);
  // In the order of `account_boundaries`.
  for (int index = part.first; index < part.end; ++index) {
    BundleLayout const layout = bundles.layout(index);
    for (int side = 0; side < 2; ++side) {
      if (!block.at_boundary(low + side)) continue;
      double const sign = side == 0 ? -1.0 : 1.0;
      for (int line = 0; line < layout.lines(); ++line) {
        grid::Cell const cell = layout.end_cell(block, side, line);
        if (!coupling.is_own(cell)) continue;
        double const area = block.face_area(s.direction, side, cell);
        for (int c = 0; c <= energy; ++c) outflow[c] += sign * area * s.dt * flux[c];
      }
    }
  }
}

}  // namespace brisance::gas
