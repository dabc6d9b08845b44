#include "gas/burn.hpp"

#include <cmath>
#include <utility>

#include "gas/gas.hpp"

namespace brisance::gas {

namespace {

/// Charges that are lit together begin at times that differ by rounding, and no step is that short: what is about to
/// begin within this fraction of a burst's duration has begun.
constexpr double at_once = 1e-3;

bool begun(std::array<double, 2> const& burst, double time) {
  return time >= burst[0] - at_once * (burst[1] - burst[0]);
}

}  // namespace

void Burn::set_times(int block, std::vector<BurnTime> times, std::vector<std::uint16_t> charge_of) {
  times_[block] = std::move(times);
  charge_of_[block] = std::move(charge_of);
}

void Burn::set_end(double time, double trace) {
  end_ = time;
  trace_ = std::max(trace, vanishing_fraction);
}

void Burn::follow(double now, double step_end) {
  now_ = now;
  step_end_ = step_end;
}

double Burn::fastest() const {
  double fastest = 0.0;
  for (LitCharge const& charge : charges_) fastest = std::max(fastest, charge.detonation_speed);
  return fastest;
}

bool Burn::bursting() const {
  return std::any_of(bursts_.begin(), bursts_.end(),
                     [this](auto const& burst) { return begun(burst, now_) && now_ < burst[1]; });
}

double Burn::next_burst() const {
  double next = std::numeric_limits<double>::infinity();
  for (auto const& burst : bursts_) {
    if (!begun(burst, now_)) next = std::min(next, burst[0]);
  }
  return next;
}

double Burn::fraction(BurnTime const& times) const {
  double const t = step_end_;
  if (t >= times.end) return 1.0;
  return t > times.begin ? std::max((t - times.begin) / (times.end - times.begin), smallest_burn_fraction)
                         : smallest_burn_fraction;
}

bool Burn::is_trace(double alpha) const { return std::abs(alpha) <= trace_; }

double burn_fraction(Gas const& gas, grid::Cell const& cell) {
  if (!gas.burn.burning_in(cell.block)) return 1.0;
  if (gas.burn.is_trace(gas.fields().at(cell.block, volume_fraction(products_fluid))[cell.offset])) return 1.0;
  std::size_t const place = gas.grid().block(cell).with_ghosts().offset(cell.within());
  return gas.burn.fraction(gas.burn.times(cell.block)[place]);
}

double unlit_compression(Gas const& gas) {
  if (!gas.fluids().mixed() || !gas.burn.burning()) return 0.0;
  constexpr double ahead = 6.0;  // cells that the detonation runs meanwhile: its own foot compresses what is nearer
  constexpr double a_good_part = 0.1;
  double most = 0.0;
  for (grid::Block const& block : gas.grid().blocks()) {
    int const b = block.number;
    auto const& times = gas.burn.times(b);
    if (times.empty()) continue;
    grid::CellRange const box = block.with_ghosts();
    for_each_cell(block, [&](grid::Cell const& cell) {
      double const alpha = gas.fields().at(b, volume_fraction(products_fluid))[cell.offset];
      std::size_t const place = box.offset(cell.within());
      LitCharge const& charge = gas.burn.charge_at(b, place);
      double const soonest = gas.time() + ahead * block.h() / charge.detonation_speed;
      if (times[place].begin < soonest || alpha < a_good_part || !gas.coupling.is_own(cell)) return;
      double const partial = gas.fields().at(b, partial_density(products_fluid))[cell.offset];
      most = std::max(most, partial / (alpha * charge.unburnt_density) - 1.0);
    });
  }
  return most;
}

double afterburn_progress(Gas const& gas, grid::Cell const& cell) {
  auto const& afterburn = gas.options().afterburn;
  if (!gas.fluids().mixed() || !afterburn) return 0.0;
  double const products = gas.fields().at(cell.block, partial_density(products_fluid))[cell.offset];
  if (!(products > 0.0)) return 0.0;
  if (auto const same = afterburn->progress(gas.time())) return *same;
  return std::clamp(gas.fields().at(cell.block, progress)[cell.offset] / products, 0.0, 1.0);
}

}  // namespace brisance::gas
