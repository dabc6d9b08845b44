#include "app/progress.hpp"

#include <sys/ioctl.h>

#include <algorithm>

#include "app/print.hpp"
#include "core/reduce.hpp"
#include "core/text.hpp"
#include "run/system.hpp"

namespace brisance::app {

namespace {

/// Characters that fit on one line of the terminal.
std::size_t line_width(std::FILE* out) {
  winsize size{};
  bool const known = ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? size.ws_col - 1U : 79U;
}

}  // namespace

double part_done(run::System const& system) {
  double const by_time = system.clock.time / system.setup.end.time;
  double const by_steps = system.setup.end.steps > 0
                              ? static_cast<double>(system.clock.step) / static_cast<double>(system.setup.end.steps)
                              : 0.0;
  return std::clamp(std::max(by_time, by_steps), 0.0, 1.0);
}

bool Progress::due(double done, Clock::time_point now) const {
  using namespace std::chrono_literals;
  if (terminal_) return now - since_ >= 200ms;
  return now - since_ >= 10s || (done - done_ >= 0.1 && now - since_ >= 1s);
}

std::string Progress::remaining(double done, double before, double seconds) {
  return fmt::format("about {} left", wall_time(done > before ? (1.0 - done) * seconds / (done - before) : 0.0));
}

void Progress::step(setup::StartProgress const& start) {
  ++steps_;
  if (steps_ == 1) done_ = start.done;  // of this charge
  auto const now = Clock::now();
  if (!due(start.done, now)) return;
  double const seconds = std::chrono::duration<double>(now - since_).count();
  show(fmt::format("1D start {:5.1f} %  t {}  step {}  shock at {} of {}  {}", 100.0 * start.done,
                   quantity(start.time, "s"), start.step, quantity(start.front, "m"), quantity(start.radius, "m"),
                   remaining(start.done, done_, seconds)));
  since_ = now;
  done_ = start.done;
}

void Progress::start(run::System const& system) {
  done_ = part_done(system);
  since_ = Clock::now();
  steps_ = 0;
}

void Progress::step(run::System const& system) {
  ++steps_;
  bool const both = system.coupled();
  bool const particles = !system.regions.empty() && !both;
  active_updates_ += static_cast<double>(particles ? system.particle_count() : system.active_cells());
  auto const now = Clock::now();
  double const done = part_done(system);
  if (!due(done, now)) return;

  double const seconds = std::chrono::duration<double>(now - since_).count();
  std::string const place =
      fmt::format("{:5.1f} %  t {}  step {}  dt {}  ", 100.0 * done, quantity(system.clock.time, "s"),
                  system.clock.step, quantity(system.clock.dt, "s", 3));
  std::string speed;
  if (particles) {
    speed = fmt::format("{:.3g} Mparticles/s", active_updates_ / seconds / 1e6);
  } else {
    double const all_updates = static_cast<double>(steps_) * static_cast<double>(system.setup.domain.cell_count());
    int const awake = sum_at_hand(system.grid.block_count(), [&](int b) { return system.gas->awake(b) ? 1 : 0; });
    speed = fmt::format("{:.1f} Mcells/s ({:.1f} including sleeping)  {} of {} blocks awake",
                        active_updates_ / seconds / 1e6, all_updates / seconds / 1e6, awake, system.grid.block_count());
  }
  if (both) {
    bool const awake = std::ranges::any_of(system.regions, &run::Region::moves);
    speed += awake ? fmt::format("  {} particles", large_count(static_cast<double>(system.particle_count())))
                   : "  particles asleep";
  }
  show(fmt::format("{}{}  {}", place, speed, remaining(done, done_, seconds)));
  since_ = now;
  done_ = done;
  steps_ = 0;
  active_updates_ = 0.0;
}

void Progress::show(std::string const& line) {
  if (terminal_) {
    std::string const fitting = line.substr(0, line_width(out_));
    print(out_, "\r{:<{}}", fitting, shown_);
    shown_ = fitting.size();
  } else {
    print(out_, "{}\n", line);
  }
  std::fflush(out_);
}

void Progress::end() {
  if (terminal_ && shown_ > 0) print(out_, "\n");
  shown_ = 0;
}

}  // namespace brisance::app
