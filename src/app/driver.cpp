#include "app/driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "app/text.hpp"
#include "core/timer.hpp"

namespace brisance::app {

namespace {

/// Gauge histories reach the disk this often, so that a killed run loses little; less often where that would take more
/// than a twentieth of the time.
constexpr std::chrono::seconds append_interval{2};
constexpr int append_share = 20;

/// The loop's bookkeeping of what has been written when.
class Recorder {
 public:
  Recorder(run::World& world, output::Writer& writer)
      : world_(&world), writer_(&writer), dump_times_(output::dump_times(world.setup.output, world.setup.end.time)) {}

  /// The time that the next step may not pass [s].
  [[nodiscard]] double next_dump() const {
    return next_dump_ < dump_times_.size() ? dump_times_[next_dump_] : world_->setup.end.time;
  }

  void record() {
    if (world_->clock.time >= next_gauge_) sample();
    if (world_->clock.time >= next_dump()) {
      while (next_dump_ < dump_times_.size() && dump_times_[next_dump_] <= world_->clock.time) ++next_dump_;
      dump();
    }
    if (std::chrono::steady_clock::now() >= next_append_) append();
  }

  /// Whatever of the present state has not been recorded yet.
  void record_last(bool state_is_sound) {
    if (state_is_sound && sampled_step_ != world_->clock.step) sample();
    if (dumped_step_ != world_->clock.step || !state_is_sound) dump();
  }

 private:
  void sample() {
    world_->sample_gauges();
    sampled_step_ = world_->clock.step;
    double const interval = world_->setup.output.gauge_interval;
    if (interval > 0.0) next_gauge_ = (std::floor(world_->clock.time / interval * (1.0 + 1e-12)) + 1.0) * interval;
  }

  void dump() {
    PhaseTimer const timer(world_->timings["output"]);
    world_->update_audit();
    writer_->dump_fields(*world_);
    dumped_step_ = world_->clock.step;
  }

  void append() {
    PhaseTimer const timer(world_->timings["output"]);
    auto const begin = std::chrono::steady_clock::now();
    writer_->append_gauges(*world_);
    auto const end = std::chrono::steady_clock::now();
    next_append_ = end + std::max<std::chrono::steady_clock::duration>(append_interval, append_share * (end - begin));
  }

  run::World* world_;
  output::Writer* writer_;
  std::vector<double> dump_times_;
  std::size_t next_dump_ = 0;
  double next_gauge_ = 0.0;
  long dumped_step_ = -1;
  long sampled_step_ = -1;
  std::chrono::steady_clock::time_point next_append_ = std::chrono::steady_clock::now() + append_interval;
};

std::string place_in_run(run::World const& world) {
  return fmt::format("at t = {}, {:.1f} % of the time, step {}", quantity(world.clock.time, "s"),
                     100.0 * world.clock.time / world.setup.end.time, world.clock.step);
}

Ending ending_of(run::World const& world) {
  bool const in_time = world.clock.time >= world.setup.end.time * (1.0 - 1e-12);
  return {ExitCode::done, in_time ? fmt::format("reached the end time {}", quantity(world.setup.end.time, "s"))
                                  : fmt::format("reached the step limit end.steps = {} {}", world.setup.end.steps,
                                                place_in_run(world))};
}

}  // namespace

Ending drive(run::World& world, output::Writer& writer, std::atomic<bool> const& stop,
             std::function<void(run::World const&)> const& after_step) {
  Recorder recorder(world, writer);
  std::optional<Ending> ending;
  bool sound = true;
  try {
    recorder.record();
    while (!world.finished() && !stop) {
      run::advance(world, recorder.next_dump());
      recorder.record();
      after_step(world);
    }
    ending = world.finished() ? ending_of(world)
                              : Ending{ExitCode::stopped_by_user, "stopped by the user " + place_in_run(world)};
  } catch (NumericalError const& error) {
    ending = Ending{error.code(), fmt::format("numerical failure {}: {}", place_in_run(world), error.what())};
    sound = false;
  } catch (IoError const& error) {
    ending = Ending{error.code(), error.what()};
  }
  // After an output failure the same again is to be expected; the first message is the one that counts.
  try {
    if (ending->code != ExitCode::io_failure) recorder.record_last(sound);
    world.update_audit();
    writer.finish(world, ending->reason, static_cast<int>(ending->code));
  } catch (IoError const& error) {
    if (ending->code != ExitCode::io_failure) ending = Ending{error.code(), error.what()};
  }
  return *ending;
}

}  // namespace brisance::app
