/// One step of the simulation: gas alone, particles alone, or both, [Cui14] Sec. 3.5.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

/// A shock that is about to enter the region bounds the step of the particles as those do that are in it.
double stable_particle_step(System const& w) {
  double step = w.particles->stable_step();
  if (w.bridge != nullptr && w.bridge->incoming_signal() > 0.0) {
    step = std::min(step, w.setup.mpm_region->courant * w.bridge->region().metric().h / w.bridge->incoming_signal());
  }
  return ramp(w) * step;
}

/// Do the particles take part in the step?
bool particles_move(System const& w) { return w.particles != nullptr && (w.bridge == nullptr || w.bridge->awake()); }

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

/// The particles go through a step of the gas, in steps of their own. The gas went first, so that they find the cells
/// beside them at any time in between.
void advance_particles(System& w, double dt) {
  bridge::Bridge& bridge = *w.bridge;
  {
    PhaseTimer const timer(w.timings["bridge"]);
    bridge.read_cells();
  }
  in_parts(
      dt, [&] { return stable_particle_step(w); },
      [&](double done, double fraction) {
        {
          PhaseTimer const timer(w.timings["bridge"]);
          bridge.lend_cells_to_nodes(done / dt, (done + fraction) / dt);  // (3), (5) Eqs. (37)-(39)
        }
        w.particles->advance(fraction);  // (2), (4), (6), (9)-(13) Eqs. (18)-(30)
        ++w.clock.particle_steps;
        PhaseTimer const timer(w.timings["bridge"]);
        bridge.exchange(fraction / dt, fraction);  // (14)
        hand_over_products(w.setup, *w.particles, bridge.gas_body());
        int const interval = w.setup.mpm_region->population_interval;
        if (interval > 0 && w.clock.particle_steps % interval == 0) w.particles->control_population(bridge.gas_body());
      });
  w.gas->coupling.clear_watched();
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
    w.bridge->lend_nodes_to_ghosts();  // (7) Eqs. (31)-(36), level n
  }
  in_parts(
      dt, [&] { return stable_gas_step(w); },
      [&](double, double fraction) {
        w.gas->advance(fraction, w.clock.gas_steps % 2 == 1);  // (8) Eq. (6)
        ++w.clock.gas_steps;
      });
  advance_particles(w, dt);
}

void wake_region(System& w, double time) {
  if (!w.bridge->wake()) return;
  if (!w.awake_since) w.awake_since = time;
  PhaseTimer const timer(w.timings["bridge"]);
  w.bridge->read_cells();
}

/// The same where the gas has several levels: gas and particles meet at every step of the region's level.
void advance_coupled_levels(System& w, double dt) {
  gas::Companion companion;
  companion.level = w.bridge->region().level();
  companion.before = [&w](double time, double) {
    if (!w.bridge->awake()) wake_region(w, time);
    if (!w.bridge->awake()) return;
    PhaseTimer const timer(w.timings["bridge"]);
    w.bridge->lend_nodes_to_ghosts();
  };
  companion.after = [&w](double, double step) {
    if (w.bridge->awake()) advance_particles(w, step);
  };
  companion.look = w.look;
  w.gas->advance(dt, w.clock.gas_steps % 2 == 1, companion);
  ++w.clock.gas_steps;
}

}  // namespace

double stable_step(System const& w) {
  if (w.gas == nullptr) return stable_particle_step(w);
  double const gas = stable_gas_step(w);
  if (!particles_move(w)) return gas;
  double const particles = stable_particle_step(w);
  // Steps of the region's level are shorter than those of the whole.
  double const steps = std::ldexp(1.0, w.setup.mpm_region->level);
  if (!w.setup.mpm_region->subcycling) return std::min(gas, steps * particles);
  if (w.adaptation != nullptr) return std::min(gas, most_parts * steps * particles);
  return std::min({std::max(gas, particles), most_gas_parts * gas, most_parts * particles});
}

double advance(System& w, double latest) {
  if (w.bridge != nullptr) wake_region(w, w.clock.time);
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
  if (w.bridge != nullptr && w.adaptation != nullptr) {
    advance_coupled_levels(w, dt);
  } else if (w.gas != nullptr && particles_move(w)) {
    advance_coupled(w, dt);
  } else if (w.gas != nullptr) {
    gas::Companion companion;
    if (w.adaptation != nullptr) companion.look = w.look;
    w.gas->advance(dt, w.clock.gas_steps % 2 == 1, companion);  // (8) Eq. (6)
    ++w.clock.gas_steps;
  } else {
    w.particles->advance(dt);  // (2)-(4), (6), (9)-(13) Eqs. (18)-(30)
    ++w.clock.particle_steps;
  }
  w.clock.time = arrives ? latest : w.clock.time + dt;
  w.clock.dt = dt;
  ++w.clock.step;
  if (w.panels != nullptr) w.panels->follow(*w.gas, w.clock.time, dt, w.clock.step);
  if (w.adaptation != nullptr) w.adaptation->follow(w);
  if (w.gas != nullptr) {
    for (auto const& [phase, seconds] : w.gas->timings()) w.timings[phase] = seconds;
  }
  if (w.particles != nullptr) {
    for (auto const& [phase, seconds] : w.particles->timings()) w.timings[phase] = seconds;
  }
  return dt;
}

}  // namespace brisance::run
