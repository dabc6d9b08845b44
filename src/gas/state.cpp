/// The state of the gas in a checkpoint: whatever the next step depends on, and the sums since the start. What the case
/// alone determines (obstacles, burn times) is built anew and only compared.
#include <cmath>

#include "core/archive.hpp"
#include "gas/gas.hpp"

namespace brisance::gas {

namespace {

void archive(Archive& a, Account& account) {
  a(account.outflow, account.guarded_cells, account.fallback_faces, account.guard_mass, account.guard_energy,
    account.afterburn_energy, account.opened);
}

void archive(Archive& a, FaceFlux& flux) {
  a(flux.mass, flux.momentum, flux.energy, flux.impulse, flux.work, flux.volume);
}

}  // namespace

void Gas::archive(Archive& a) {
  a.section("gas");
  a.same(components(), "the number of gas components");
  a.same(grid_->block_count(), "the number of gas blocks");
  a.same(grid_->block_size(), "the size of the gas blocks");
  a(time_, time_at_step_end_, fastest_signal_);
  a.require(std::isfinite(time_) && std::isfinite(time_at_step_end_) && fastest_signal_ >= 0.0, "the time of the gas");
  awake_.sized(a, "the number of gas blocks");
  a(timings_);
  a.same(watched_.size(), "the number of faces between gas and points");
  for (FaceFlux& flux : watched_) gas::archive(a, flux);
  open_faces_.archive(a);
  for (int b = 0; b < grid_->block_count(); ++b) {
    BlockData& data = blocks_[b];
    a.same(grid_->blocks()[b].n, "the size of a gas block");
    a.same(checksum(data.solid.data(), data.solid.size()), "the shape of the obstacles");
    a.same(checksum(data.roles.data(), data.roles.size()), "the MPM region");
    a.same(checksum(data.burn_times.data(), data.burn_times.size() * sizeof(BurnTime)), "the lighting of the charges");
    gas::archive(a, data.account);
    a(data.signal);
    auto const cells = static_cast<std::size_t>(grid_->blocks()[b].cell_count());
    for (int c = 0; c < components(); ++c) a.numbers(fields_.at(b, c), cells);
    if (options_.peak_fields) a.numbers(peaks_[b].data(), peaks_[b].size());
  }
}

}  // namespace brisance::gas
