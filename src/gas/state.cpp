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

}  // namespace

void Gas::archive(Archive& a) {
  a.section("gas");
  a.same(components(), "the number of gas components");
  a.same(grid_->block_count(), "the number of gas blocks");
  a.same(grid_->block_size(), "the size of the gas blocks");
  a(time_, time_at_step_end_, fastest_signal_);
  burn.follow(time_, time_at_step_end_);
  a.require(std::isfinite(time_) && std::isfinite(time_at_step_end_) && fastest_signal_ >= 0.0, "the time of the gas");
  awake_.sized(a, "the number of gas blocks");
  a(timings_);
  gas::archive(a, carried_);
  coupling.archive(a);
  open_faces_.archive(a);
  for (int b = 0; b < grid_->block_count(); ++b) {
    Tally& data = blocks_[b];
    a.same(grid_->blocks()[b].n, "the size of a gas block");
    auto const& solid = obstacles.solid(b);
    auto const& roles = coupling.roles(b);
    auto const& times = burn.times(b);
    a.same(checksum(solid.data(), solid.size()), "the shape of the obstacles");
    a.same(checksum(roles.data(), roles.size()), "the MPM region");
    // Blocks that came after the burn were told nothing of it.
    if (burn.burning())
      a.same(checksum(times.data(), times.size() * sizeof(BurnTime)), "the initiation of the charges");
    gas::archive(a, data.account);
    a(data.signal);
    auto const cells = static_cast<std::size_t>(grid_->blocks()[b].cell_count());
    for (int c = 0; c < components(); ++c) a.numbers(fields_.at(b, c), cells);
    peaks_.archive(a, b);
  }
  std::vector<double> open;
  for (CutCell const& cell : cut.cells()) {
    open.insert(open.end(), cell.area.begin(), cell.area.end());
    open.push_back(cell.volume);
  }
  a.same(checksum(open.data(), open.size() * sizeof(double)), "the cut cells of the obstacles");
  if (!a.reading()) return;
  disturbance_.find(fields_, quiet_.state);
  load_nodes();
}

}  // namespace brisance::gas
