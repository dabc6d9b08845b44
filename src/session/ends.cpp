#include "session/ends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/archive.hpp"
#include "observe/blast_summary.hpp"
#include "observe/kinetic_energy.hpp"
#include "run/world.hpp"

namespace brisance::session {

namespace {

constexpr long fewest_steps = 10;  // between two looks
constexpr long share_of_steps = 100;

/// Fraction of the time so far, up to now, in which the kinetic energy must have been small. A body that vibrates
/// stands still twice in a period T: about a turning point its energy is below the part f of its largest for T
/// asin(sqrt f) / pi. The first such particle comes at T / 4 at the earliest, a third of which is longer for f up to
/// 0.06.
constexpr double quiet_share = 1.0 / 3.0;

/// Kinetic energy that is round-off, of the energy at the start.
constexpr double noise_of_energy = 1e-12;

/// Overpressure below which a gauge has seen noise and no wave, of the ambient pressure.
constexpr double noise = 1e-4;

bool is_past_positive_phase(observe::GaugeSummary const& gauge, double ambient_pressure) {
  auto const& wave = gauge.wave;
  return wave.arrival_time && wave.positive_duration && wave.peak_overpressure > noise * ambient_pressure;
}

/// Has everything been lit that will burn?
bool has_been_lit(run::World const& world) {
  if (world.gas != nullptr && world.gas->burn.burning()) return false;
  for (auto const& body : world.setup.particles.bodies) {
    for (auto const& particle : body.initiation)
      if (world.clock.time <= particle.delay) return false;
  }
  return true;
}

}  // namespace

bool EndConditions::is_at_rest(run::World const& world) {
  double const now = world.clock.time;
  if (times_.empty() || times_.back() < now) {
    times_.push_back(now);
    motion_.push_back(observe::kinetic_energy(world));
  }
  double const largest = *std::ranges::max_element(motion_);
  // Before anything moves there is round-off.
  if (!(largest > noise_of_energy * std::abs(world.audit.initial.energy))) return false;
  double const small = world.setup.end.kinetic_energy * largest;
  for (std::size_t n = times_.size(); n-- > 0;) {
    if (!(motion_[n] < small)) return false;
    if (times_[n] <= (1.0 - quiet_share) * now) return true;
  }
  return false;
}

std::optional<std::string> EndConditions::met(run::World const& world, observe::Gauges const& gauges) {
  auto const& end = world.setup.end;
  if (!end.gauges && end.kinetic_energy <= 0.0) return std::nullopt;
  while (next_look_ < world.clock.step) next_look_ += std::max(fewest_steps, next_look_ / share_of_steps);
  if (world.clock.step != next_look_) return std::nullopt;
  bool const at_rest = end.kinetic_energy > 0.0 && is_at_rest(world);  // also keeps the record of it
  if (!has_been_lit(world)) return std::nullopt;
  if (at_rest) {
    return fmt::format("the kinetic energy has stayed below {:g} of its maximum (end.kinetic_energy)",
                       end.kinetic_energy);
  }
  if (end.gauges) {
    auto const summaries = observe::summarise(world.setup, gauges.gas);
    double const ambient = world.setup.ambient.state.pressure;
    if (std::ranges::all_of(summaries, [ambient](auto const& g) { return is_past_positive_phase(g, ambient); }))
      return "the positive phase has ended at all gauges (end.gauges)";
  }
  return std::nullopt;
}

void EndConditions::archive(Archive& a) { a(times_, motion_); }

}  // namespace brisance::session
