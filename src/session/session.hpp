/// Runs a case from its plan to its results, without a terminal.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "case/case.hpp"
#include "observe/gauges.hpp"
#include "output/checkpoint.hpp"
#include "output/lock.hpp"
#include "output/writer.hpp"
#include "session/driver.hpp"
#include "session/plan.hpp"
#include "setup/build.hpp"
#include "setup/start.hpp"

namespace brisance::session {

struct Settings {
  std::filesystem::path folder;  ///< of the results
  bool force = false;            ///< replace earlier results
  bool resume = false;           ///< go on from the newest checkpoint
  /// Called with each warning, whole lines.
  std::function<void(std::string const&)> tell = [](std::string const&) {};
  /// When the program started, from which the case's `end.wall_clock` counts.
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
};

/// Reads the profile that a case begins with. Throws IoError, and InputError where it does not fit.
void load_profile(run::Case& setup);

/// One run. In this order: made, `calculate_start`, `build`, `run`.
class Session {
 public:
  /// Works out the plan, locks the folder and finds the checkpoint. Throws InputError where the machine cannot hold the
  /// case, where a profile or a checkpoint does not fit it; IoError.
  Session(run::Case setup, Settings settings);

  [[nodiscard]] Plan const& plan() const { return plan_; }
  [[nodiscard]] std::filesystem::path const& folder() const { return settings_.folder; }
  /// Is the run to be resumed one that had reached its end? Nothing is left to do then.
  [[nodiscard]] bool had_finished() const { return had_finished_; }
  /// From which the run goes on; null: from its start.
  [[nodiscard]] output::CheckpointReader const* checkpoint() const { return checkpoint_.get(); }

  /// The 1D simulations before a run that starts with a remap. False where the observer gave up.
  [[nodiscard]] bool calculate_start(setup::StartObserver const& observer);
  /// Builds the world, or reads it from the checkpoint, and prepares the folder.
  void build();
  /// Runs it to its end, see `drive`.
  [[nodiscard]] Ending run(std::atomic<bool> const& stop, std::function<void(run::World const&)> const& after_step);

  /// The results; after `build`.
  [[nodiscard]] run::World const& world() const { return *world_; }
  [[nodiscard]] observe::Gauges const& gauges() const { return *gauges_; }

 private:
  void read_world();

  Settings settings_;
  run::Case setup_;  ///< until `build`
  Plan plan_;
  std::unique_ptr<output::FolderLock> lock_;
  bool had_finished_ = false;
  std::unique_ptr<output::CheckpointReader> checkpoint_;
  double start_seconds_ = 0.0;  ///< that the 1D simulations took
  std::optional<run::World> world_;
  std::optional<observe::Gauges> gauges_;
  std::optional<output::Writer> writer_;
};

}  // namespace brisance::session
