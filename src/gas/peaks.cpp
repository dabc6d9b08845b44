#include "gas/peaks.hpp"

#include <algorithm>
#include <cstddef>

#include "core/archive.hpp"
#include "core/loops.hpp"

namespace brisance::gas {

Peaks::Peaks(grid::Grid const& grid, bool wanted)
    : grid_(&grid), wanted_(wanted), blocks_(grid, [wanted](grid::Block const& block) {
        return Buffer(wanted ? static_cast<std::size_t>(block.cell_count()) * peak_count : 0);
      }) {}

double const* Peaks::of(int block, Peak peak) const {
  if (!wanted_) return nullptr;
  return blocks_[block].data() + static_cast<std::size_t>(peak) * grid_->blocks()[block].cell_count();
}

double* Peaks::values_of(int block, int value) {
  if (!wanted_) return nullptr;
  return blocks_[block].data() + static_cast<std::size_t>(value) * grid_->blocks()[block].cell_count();
}

void Peaks::follow(int b, grid::BundleLayout const& layout, double const* const p, double ambient, double dt) {
  if (!wanted_) return;
  grid::Block const& block = grid_->blocks()[b];
  int const cells = block.cell_count();
  double* const peak = blocks_[b].data() + static_cast<std::ptrdiff_t>(peak_pressure) * cells;
  double* const running = blocks_[b].data() + static_cast<std::ptrdiff_t>(running_impulse) * cells;
  double* const largest = blocks_[b].data() + static_cast<std::ptrdiff_t>(largest_impulse) * cells;
  for_each_run(layout, block, [&](int q, int offset, int count) {
    BRISANCE_VECTOR_LOOP
    for (int n = 0; n < count; ++n) {
      double const over = p[q + n] - ambient;
      peak[offset + n] = std::max(peak[offset + n], over);
      running[offset + n] += over * dt;
      largest[offset + n] = std::max(largest[offset + n], running[offset + n]);
    }
  });
}

void Peaks::follow(grid::Cell const& cell, double overpressure, double dt) {
  if (!wanted_) return;
  int const cells = grid_->block(cell).cell_count();
  auto const value = [&](Peak peak) -> double& {
    return blocks_[cell.block][static_cast<std::size_t>(peak) * cells + cell.offset];
  };
  value(peak_pressure) = std::max(value(peak_pressure), overpressure);
  value(running_impulse) += overpressure * dt;
  value(largest_impulse) = std::max(value(largest_impulse), value(running_impulse));
}

void Peaks::announce(grid::Cell const& cell) const {
  if (!wanted_) return;
  for (int peak = 0; peak < peak_count; ++peak)
    __builtin_prefetch(of(cell.block, static_cast<Peak>(peak)) + cell.offset, 1);
}

void Peaks::announce(int block, grid::Ahead& ahead) const {
  for (int peak = 0; peak < peak_count; ++peak) ahead.add(of(block, static_cast<Peak>(peak)));
}

void Peaks::archive(Archive& a, int block) {
  if (wanted_) a.numbers(blocks_[block].data(), blocks_[block].size());
}

}  // namespace brisance::gas
