/// Ctrl-C and its relatives: the first asks the run to stop after its step, the second ends the program at once.
#pragma once

#include <array>
#include <atomic>

namespace brisance::app {

/// While it lives, SIGINT, SIGTERM and SIGHUP set `requested()`; a second one has its usual effect. Writing to a closed
/// pipe or beyond a file size limit returns an error instead of killing the program. One at a time.
class StopSignals {
 public:
  /// `announce`: say on stderr that the signal has been heard.
  explicit StopSignals(bool announce);
  ~StopSignals();
  StopSignals(StopSignals const&) = delete;
  StopSignals& operator=(StopSignals const&) = delete;

  [[nodiscard]] static std::atomic<bool> const& requested();

 private:
  std::array<void (*)(int), 5> before_{};  ///< handlers to restore
};

}  // namespace brisance::app
