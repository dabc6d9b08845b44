/// One step of the calculation. The coupled step of [Cui14] Sec. 3.5 grows from here.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/timer.hpp"
#include "run/world.hpp"

namespace brisance::run {

double stable_step(World const& w) {
  // A diaphragm that has just been removed moves faster than either side's sound: start gently.
  double const ramp = std::min(1.0, 0.1 * static_cast<double>(w.clock.step + 1));
  if (w.points != nullptr) return ramp * w.points->stable_step();
  double signal = w.gas->fastest_signal();
  // A charge that burns releases its pressure within a step, and the products that break out of it run ahead of the
  // detonation at up to 1.3 D with the sound on top: twice D bounds both.
  if (w.gas->burning()) signal = std::max(signal, 2.0 * w.setup.charges.front().explosive.detonation_speed);
  return ramp * w.setup.numerics.courant * w.setup.domain.h / signal;
}

double advance(World& w, double latest) {
  double const stable = stable_step(w);  // (1)
  if (!std::isfinite(stable) || stable <= 1e-14 * std::max(w.setup.end.time, 1e-12)) {
    throw NumericalError(
        fmt::format("the time step vanished (dt = {:.3g} s at t = {:.6g} s, step {}); the state has lost its meaning",
                    stable, w.clock.time, w.clock.step));
  }
  double const left = latest - w.clock.time;
  bool const arrives = left <= stable;
  double const dt = arrives ? left : left < 2.0 * stable ? 0.5 * left : stable;  // no sliver before an output time
  if (w.gas != nullptr) w.gas->advance(dt, w.clock.step % 2 == 1);               // (8) Eq. (6)
  if (w.points != nullptr) w.points->advance(dt);  // (2)-(4), (6), (9)-(13) Eqs. (18)-(30)
  w.clock.time = arrives ? latest : w.clock.time + dt;
  w.clock.dt = dt;
  ++w.clock.step;
  if (w.gas != nullptr) {
    for (auto const& [phase, seconds] : w.gas->timings()) w.timings[phase] = seconds;
  }
  if (w.points != nullptr) {
    for (auto const& [phase, seconds] : w.points->timings()) w.timings[phase] = seconds;
  }
  return dt;
}

}  // namespace brisance::run
