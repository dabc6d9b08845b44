#include "session/driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "core/text.hpp"
#include "core/timer.hpp"
#include "output/checkpoint.hpp"
#include "run/world.hpp"
#include "session/ends.hpp"

namespace brisance::session {

namespace {

/// Gauge histories reach the disk this often, so that a killed run loses little; less often where that would take more
/// than a twentieth of the time.
constexpr std::chrono::seconds append_interval{2};
constexpr int append_share = 20;
/// By the clock, checkpoints take no more than this fraction of the time.
constexpr int checkpoint_share = 20;

std::string place_in_run(run::World const& world) {
  return fmt::format("at t = {}, {:.1f} % of the time, step {}", quantity(world.clock.time, "s"),
                     100.0 * world.clock.time / world.setup.end.time, world.clock.step);
}

/// The loop's bookkeeping of what has been written when.
class Recorder {
 public:
  Recorder(run::World& world, observe::Gauges& gauges, output::Writer& writer)
      : world_(&world),
        gauges_(&gauges),
        writer_(&writer),
        dump_times_(output::dump_times(world.setup.output, world.setup.end.time)),
        checkpoints_(writer.folder(), world.setup.checkpoint.keep) {
    plan_checkpoints();
    if (world.adaptation == nullptr) return;
    world.look = [this](int level, double time) { gauges_->sample_level(*world_, level, time); };
  }
  ~Recorder() { world_->look = nullptr; }
  Recorder(Recorder const&) = delete;
  Recorder& operator=(Recorder const&) = delete;

  /// Goes on from a checkpoint whose world has been read.
  void resume(Archive& archive) {
    rest_of_state(archive);
    archive.end();
    // A run that stopped here made this dump its last one.
    if (dumped_step_ == world_->clock.step) writer_->dump_again(*world_, output::IsLast::no);
    double const now = world_->clock.time;
    while (next_dump_ < dump_times_.size() && dump_times_[next_dump_] <= now) ++next_dump_;
    if (sampled_step_ >= 0) plan_sample();
    kept_step_ = world_->clock.step;
    plan_checkpoints();
  }

  /// The time that the next step may not pass [s].
  [[nodiscard]] double next_dump() const {
    double const whole = next_dump_ < dump_times_.size() ? dump_times_[next_dump_] : world_->setup.end.time;
    return std::min(whole, writer_->next_subset());
  }

  void record() {
    writer_->check();
    if (world_->clock.time >= next_gauge_) sample();
    double const now = world_->clock.time;
    if (next_dump_ < dump_times_.size() && now >= dump_times_[next_dump_]) {
      while (next_dump_ < dump_times_.size() && dump_times_[next_dump_] <= now) ++next_dump_;
      dump(next_dump_ == dump_times_.size() ? output::IsLast::yes : output::IsLast::no);
    } else if (now >= writer_->next_subset()) {
      dump_subsets(output::IsLast::no);
    }
    if (std::chrono::steady_clock::now() >= next_append_) append();
    if (checkpoint_is_due()) checkpoint();
  }

  /// Writes the state as it is after its step, before anything that only the end of the run adds to it.
  void checkpoint() {
    if (kept_step_ == world_->clock.step) return;
    auto const begin = std::chrono::steady_clock::now();
    {
      PhaseTimer const timer(world_->timings["checkpoints"]);
      writer_->finish_dumps();
      checkpoints_.write(info(), state());
    }
    kept_step_ = world_->clock.step;
    plan_checkpoints();
    next_by_clock_ += checkpoint_share * (std::chrono::steady_clock::now() - begin);
  }

  /// What ends the simulation in its present state.
  [[nodiscard]] std::optional<Ending> ending();

  /// Writes the state of a run that cannot go on.
  void keep_stopped() { checkpoints_.write_stopped(info(), state()); }

  /// Whatever of the present state has not been recorded yet.
  void record_last(bool state_is_sound) {
    if (state_is_sound && sampled_step_ != world_->clock.step) sample();
    if (state_is_sound && !world_->regions.empty()) gauges_->record_bodies(*world_);
    if (!world_->setup.output.whole) {
      dump_subsets(output::IsLast::yes);
    } else if (dumped_step_ != world_->clock.step || !state_is_sound) {
      dump(output::IsLast::yes);
    } else if (last_dumped_ == output::IsLast::no) {
      PhaseTimer const timer(world_->timings["output"]);
      writer_->dump_again(*world_, output::IsLast::yes);
      writer_->dump_subsets(*world_, output::IsLast::yes);
    }
  }

 private:
  void sample() {
    gauges_->sample(*world_);
    sampled_step_ = world_->clock.step;
    sampled_time_ = world_->clock.time;
    plan_sample();
  }

  void plan_sample() {
    double const interval = world_->setup.output.gauge_interval;
    if (interval > 0.0) next_gauge_ = (std::floor(sampled_time_ / interval * (1.0 + 1e-12)) + 1.0) * interval;
  }

  [[nodiscard]] output::CheckpointInfo info() const {
    return {"", world_->setup.deck_text, world_->clock.step, world_->clock.time};
  }

  [[nodiscard]] output::ArchiveState state() {
    return [this](Archive& archive) {
      world_->archive(archive);
      gauges_->archive(archive, *world_);
      rest_of_state(archive);
    };
  }

  /// What a checkpoint holds beside the world.
  void rest_of_state(Archive& archive) {
    archive.section("records");
    archive(sampled_time_, sampled_step_, dumped_step_, conditions_);
    writer_->archive(archive, *world_);
  }

  [[nodiscard]] bool checkpoint_is_due() const {
    auto const& plan = world_->setup.checkpoint;
    auto const& clock = world_->clock;
    return (plan.steps > 0 && clock.step > 0 && clock.step % plan.steps == 0) ||
           (plan.interval > 0.0 && clock.time >= next_by_time_) ||
           (plan.wall_clock > 0.0 && std::chrono::steady_clock::now() >= next_by_clock_);
  }

  /// The next checkpoints after one of the present state.
  void plan_checkpoints() {
    auto const& plan = world_->setup.checkpoint;
    if (plan.interval > 0.0) next_by_time_ = (std::floor(world_->clock.time / plan.interval) + 1.0) * plan.interval;
    next_by_clock_ = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                            std::chrono::duration<double>(plan.wall_clock));
  }

  void dump(output::IsLast last) {
    PhaseTimer const timer(world_->timings["output"]);
    world_->update_audit();
    writer_->dump(*world_, last);
    dumped_step_ = world_->clock.step;
    last_dumped_ = last;
  }

  void dump_subsets(output::IsLast last) {
    PhaseTimer const timer(world_->timings["output"]);
    world_->update_audit();
    writer_->dump_subsets(*world_, last);
  }

  void append() {
    PhaseTimer const timer(world_->timings["output"]);
    auto const begin = std::chrono::steady_clock::now();
    writer_->append_gauges();
    auto const end = std::chrono::steady_clock::now();
    next_append_ = end + std::max<std::chrono::steady_clock::duration>(append_interval, append_share * (end - begin));
  }

  run::World* world_;
  observe::Gauges* gauges_;
  output::Writer* writer_;
  std::vector<double> dump_times_;
  std::size_t next_dump_ = 0;
  double next_gauge_ = 0.0;
  long dumped_step_ = -1;
  output::IsLast last_dumped_ = output::IsLast::no;
  long sampled_step_ = -1;
  double sampled_time_ = 0.0;
  EndConditions conditions_;
  output::CheckpointFiles checkpoints_;
  long kept_step_ = -1;        ///< of the last checkpoint
  double next_by_time_ = 0.0;  ///< [s]
  std::chrono::steady_clock::time_point next_by_clock_;
  std::chrono::steady_clock::time_point next_append_ = std::chrono::steady_clock::now() + append_interval;
};

std::optional<Ending> Recorder::ending() {
  run::World const& world = *world_;
  if (world.clock.time >= world.setup.end.time * (1.0 - 1e-12))
    return Ending{ExitCode::done, fmt::format("reached the end time {}", quantity(world.setup.end.time, "s"))};
  if (world.bodies_have_left()) return Ending{ExitCode::done, "all bodies have left the domain " + place_in_run(world)};
  if (world.finished())
    return Ending{ExitCode::done,
                  fmt::format("reached the step limit end.steps = {} {}", world.setup.end.steps, place_in_run(world))};
  if (auto const reason = conditions_.met(world, *gauges_))
    return Ending{ExitCode::done, fmt::format("ended {}: {}", place_in_run(world), *reason)};
  return std::nullopt;
}

/// Why the run ends before its end.
Ending stopped(run::World const& world, bool by_user) {
  return {ExitCode::stopped_by_user,
          by_user ? "stopped by the user " + place_in_run(world)
                  : fmt::format("stopped by the wall-clock limit, end.wall_clock = {}, {}; --resume continues the run",
                                clock_time(world.setup.end.wall_clock), place_in_run(world))};
}

}  // namespace

Ending drive(run::World& world, observe::Gauges& gauges, output::Writer& writer, std::atomic<bool> const& stop,
             std::function<void(run::World const&)> const& after_step, Archive* resumed,
             std::chrono::steady_clock::time_point begin) {
  Recorder recorder(world, gauges, writer);
  if (resumed != nullptr) recorder.resume(*resumed);
  std::optional<Ending> ending;
  bool sound = true;
  double const limit = world.setup.end.wall_clock;
  long const first_step = world.clock.step;
  // After one step at least, so that resumed runs get on, however short their time is.
  auto const time_is_up = [&world, limit, begin, first_step] {
    return limit > 0.0 && world.clock.step > first_step &&
           std::chrono::steady_clock::now() - begin >= std::chrono::duration<double>(limit);
  };
  try {
    if (resumed == nullptr) recorder.record();
    while (!(ending = recorder.ending()) && !stop && !time_is_up()) {
      run::advance(world, recorder.next_dump());
      world.follow_audit();  // before anything is recorded: a state that it refuses is none to go on from
      recorder.record();
      after_step(world);
    }
    auto const& plan = world.setup.checkpoint;
    bool const wanted = ending ? plan.at_end : !stop || plan.on_signal;
    if (!ending) ending = stopped(world, stop);
    if (wanted) recorder.checkpoint();
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
    if (!sound) recorder.keep_stopped();
  } catch (Error const& error) {
    // Also of a profile that the state at the end is not good for.
    if (ending->code != ExitCode::io_failure) ending = Ending{error.code(), error.what()};
    try {
      writer.close(world, ending->reason, static_cast<int>(ending->code));
    } catch (IoError const&) {  // the log stays what it was: it says that the run is under way
    }
  }
  return *ending;
}

}  // namespace brisance::session
