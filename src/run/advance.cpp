/// One step of the simulation: gas alone, particles alone, or both, [Cui14] Sec. 3.5.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/timer.hpp"
#include "run/products.hpp"
#include "run/system.hpp"

namespace brisance::run {

namespace {

/// A diaphragm that has just been removed moves faster than either side's sound: start gently.
double ramp_since(System const& w, long step) {
  return std::min(1.0, 0.1 * static_cast<double>(w.clock.step - step + 1));
}
double ramp(System const& w) { return ramp_since(w, 0); }

/// While products break out of a charge their pressure falls a hundredfold within a few steps of the usual length, and
/// what a gauge sees of the first shock would depend on the step by 20 to 60 %.
constexpr double bursting_courant = 0.2;

double stable_gas_step(System const& w) {
  gas::Gas const& gas = *w.gas;
  double signal = gas.fastest_signal();
  double const opening =
      w.panels == nullptr || w.panels->last_opening() == 0 ? 1.0 : ramp_since(w, w.panels->last_opening());
  double courant = std::min(ramp(w), opening) * w.setup.numerics.courant;
  if (gas.burn.bursting()) {
    // Gentle enough at the start too; and whatever Courant number is specified, the burst has the same steps.
    courant = std::min(opening * w.setup.numerics.courant, bursting_courant);
    // A charge that burns releases its pressure within a step, and the products that break out of it run ahead of the
    // detonation at up to 1.3 D with the sound on top: twice D bounds both.
    if (gas.burn.burning()) signal = std::max(signal, 2.0 * gas.burn.fastest());
  }
  double const step = courant * w.grid.domain().smallest_cell() / signal;
  // No step leads from quiet air into the burst of a charge with a delay.
  return std::min(step, gas.burn.next_burst() - gas.time());
}

/// A shock that is about to enter a region bounds the step of the particles as those do that are in it.
double stable_particle_step(System const& w, std::size_t number) {
  Region const& region = w.regions[number];
  double step = region.particles->stable_step();
  if (region.bridge != nullptr && region.bridge->incoming_signal() > 0.0) {
    bridge::Bridge const& bridge = *region.bridge;
    step = std::min(step, w.setup.mpm_regions[number].courant * bridge.region().metric().h / bridge.incoming_signal());
  }
  return ramp(w) * step;
}

/// Do any particles take part in the step?
bool particles_move(System const& w) { return std::ranges::any_of(w.regions, &Region::moves); }

constexpr double most_parts = 64;     // of a common step that the particles take
constexpr double most_gas_parts = 4;  // that the gas takes: its ghost cells wait meanwhile

/// Steps of at most `stable()` that fill `dt`.
template <class Stable, class Step>
void in_parts(double dt, Stable&& stable, Step&& step) {
  double done = 0.0;
  while (done < dt) {
    double const left = dt - done;
    double const parts = std::ceil(left / stable() * (1.0 - 1e-12));
    double const fraction = parts <= 1.0 ? left : left / parts;
    step(done, fraction);
    done = parts <= 1.0 ? dt : done + fraction;
  }
}

/// The particles of a region go through a step of the gas, in steps of their own. The gas went first, so that they find
/// the cells beside them at any time in between.
void advance_particles(System& w, std::size_t number, double dt) {
  Region& region = w.regions[number];
  bridge::Bridge& bridge = *region.bridge;
  {
    PhaseTimer const timer(w.timings["bridge"]);
    bridge.read_cells();
  }
  in_parts(
      dt, [&] { return stable_particle_step(w, number); },
      [&](double done, double fraction) {
        {
          PhaseTimer const timer(w.timings["bridge"]);
          bridge.lend_cells_to_nodes(done / dt, (done + fraction) / dt);  // (3), (5) Eqs. (37)-(39)
        }
        region.particles->advance(fraction);  // (2), (4), (6), (9)-(13) Eqs. (18)-(30)
        ++region.steps;
        ++w.clock.particle_steps;
        PhaseTimer const timer(w.timings["bridge"]);
        bridge.exchange(fraction / dt, fraction);  // (14)
        hand_over_products(w.setup, region);
        int const interval = w.setup.mpm_regions[number].population_interval;
        if (interval > 0 && region.steps % interval == 0) region.particles->control_population(bridge.gas_body());
      });
  forget_fluxes(w.gas->coupling, bridge.region());
  PhaseTimer const timer(w.timings["bridge"]);
  bridge.read_cells();  // with what the ledger gave back
  // Only now: in the midst of a step the mass is not balanced.
  if (std::string const solid = bridge.intruder(); !solid.empty()) throw NumericalError(solid);
}

/// One CFDMP step, [Cui14] Sec. 3.5; (k) is the paper's item k. Where the stable steps of gas and particles differ,
/// each takes several within the common one.
void advance_coupled(System& w, double dt) {
  {
    PhaseTimer const timer(w.timings["bridge"]);
    for (Region& region : w.regions) {
      if (region.moves()) region.bridge->lend_nodes_to_ghosts();  // (7) Eqs. (31)-(36), level n
    }
  }
  in_parts(
      dt, [&] { return stable_gas_step(w); },
      [&](double, double fraction) {
        w.gas->advance(fraction, w.clock.gas_steps % 2 == 1);  // (8) Eq. (6)
        ++w.clock.gas_steps;
      });
  for (std::size_t r = 0; r < w.regions.size(); ++r) {
    if (w.regions[r].moves()) advance_particles(w, r, dt);
  }
}

void wake(System& w, Region& region, double time) {
  if (!region.bridge->wake()) return;
  if (!region.awake_since) region.awake_since = time;
  PhaseTimer const timer(w.timings["bridge"]);
  region.bridge->read_cells();
}

/// The same where the gas has several levels: gas and particles meet at every step of a region's level.
void advance_coupled_levels(System& w, double dt) {
  gas::Companion companion;
  for (Region const& region : w.regions) companion.levels.push_back(region.bridge->region().level());
  companion.before = [&w](int level, double time, double) {
    for (Region& region : w.regions) {
      if (region.bridge->region().level() != level) continue;
      if (!region.bridge->awake()) wake(w, region, time);
      if (!region.bridge->awake()) continue;
      PhaseTimer const timer(w.timings["bridge"]);
      region.bridge->lend_nodes_to_ghosts();
    }
  };
  companion.after = [&w](int level, double, double step) {
    for (std::size_t r = 0; r < w.regions.size(); ++r) {
      bridge::Bridge const& bridge = *w.regions[r].bridge;
      if (bridge.region().level() == level && bridge.awake()) advance_particles(w, r, step);
    }
  };
  companion.look = w.look;
  w.gas->advance(dt, w.clock.gas_steps % 2 == 1, companion);
  ++w.clock.gas_steps;
}

/// Takes over what the gas and the particles have measured of themselves.
void take_timings(System& w) {
  if (w.gas != nullptr) {
    for (auto const& [phase, seconds] : w.gas->timings()) w.timings[phase] = seconds;
  }
  Timings of_particles;
  for (Region const& region : w.regions) {
    for (auto const& [phase, seconds] : region.particles->timings()) of_particles[phase] += seconds;
  }
  for (auto const& [phase, seconds] : of_particles) w.timings[phase] = seconds;
}

}  // namespace

double stable_step(System const& w) {
  if (w.gas == nullptr) return stable_particle_step(w, 0);
  double const gas = stable_gas_step(w);
  if (!particles_move(w)) return gas;
  // Steps of a region's level are shorter than those of the whole.
  double particles = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < w.regions.size(); ++r) {
    double const steps = std::ldexp(1.0, w.setup.mpm_regions[r].level);
    if (w.regions[r].moves()) particles = std::min(particles, steps * stable_particle_step(w, r));
  }
  if (!w.setup.mpm_regions.front().subcycling) return std::min(gas, particles);
  if (w.adaptation != nullptr) return std::min(gas, most_parts * particles);
  return std::min({std::max(gas, particles), most_gas_parts * gas, most_parts * particles});
}

double advance(System& w, double latest) {
  for (Region& region : w.regions) {
    if (region.bridge != nullptr) wake(w, region, w.clock.time);
  }
  double const stable = stable_step(w);  // (1)
  // Where nothing but rigid bodies at rest is left, nothing changes and a step may have any length.
  bool const at_rest = w.gas == nullptr && std::isinf(stable);
  if ((!std::isfinite(stable) && !at_rest) || stable <= 1e-14 * std::max(w.setup.end.time, 1e-12)) {
    throw NumericalError(
        fmt::format("the time step has become too small (dt = {:.3g} s at t = {:.6g} s, step {}); the state is no "
                    "longer meaningful",
                    stable, w.clock.time, w.clock.step));
  }
  double const left = latest - w.clock.time;
  bool const arrives = left <= stable;
  double const dt = arrives ? left : left < 2.0 * stable ? 0.5 * left : stable;  // no sliver before an output time
  if (w.coupled() && w.adaptation != nullptr) {
    advance_coupled_levels(w, dt);
  } else if (w.gas != nullptr && particles_move(w)) {
    advance_coupled(w, dt);
  } else if (w.gas != nullptr) {
    gas::Companion companion;
    if (w.adaptation != nullptr) companion.look = w.look;
    w.gas->advance(dt, w.clock.gas_steps % 2 == 1, companion);  // (8) Eq. (6)
    ++w.clock.gas_steps;
  } else {
    w.regions.front().particles->advance(dt);  // (2)-(4), (6), (9)-(13) Eqs. (18)-(30)
    ++w.regions.front().steps;
    ++w.clock.particle_steps;
  }
  w.clock.time = arrives ? latest : w.clock.time + dt;
  w.clock.dt = dt;
  ++w.clock.step;
  if (w.panels != nullptr) w.panels->follow(*w.gas, w.clock.time, dt, w.clock.step);
  if (w.adaptation != nullptr) w.adaptation->follow(w);
  take_timings(w);
  return dt;
}

}  // namespace brisance::run
