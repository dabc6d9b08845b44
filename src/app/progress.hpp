/// The progress line of a run.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

#include "setup/start.hpp"

namespace brisance::app {

/// Writes how far a run has come: on a terminal one line that renews itself, elsewhere a line every ten seconds or ten
/// per cent.
class Progress {
 public:
  Progress(std::FILE* out, bool terminal) : out_(out), terminal_(terminal) {}

  /// To be called after every step of a 1D simulation that comes before the run.
  void step(setup::StartProgress const& start);
  /// To be called before the first step of a run that does not begin at its start.
  void start(run::System const& system);
  /// To be called after every step.
  void step(run::System const& system);
  /// Ends the line.
  void end();

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] static std::string remaining(double done, double before, double seconds);
  [[nodiscard]] bool due(double done, Clock::time_point now) const;
  void show(std::string const& line);

  std::FILE* out_;
  bool terminal_;
  std::size_t shown_ = 0;  ///< characters on the terminal's line
  // What happened since the last line.
  Clock::time_point since_ = Clock::now();
  double done_ = 0.0;  ///< fraction of the run, 0 to 1
  long steps_ = 0;
  double active_updates_ = 0.0;  ///< of cells, or of particles
};

/// Fraction of the run that is done, 0 to 1, by time or by steps.
[[nodiscard]] double part_done(run::System const& system);

}  // namespace brisance::app
