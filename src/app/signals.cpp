#include "app/signals.hpp"

#include <unistd.h>

#include <array>
#include <csignal>
#include <string_view>

namespace brisance::app {

namespace {

std::atomic<bool> stop{false};
std::atomic<bool> announce_stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may use only lock-free atomics");

constexpr std::array stopping{SIGINT, SIGTERM, SIGHUP};
constexpr std::array ignored{SIGPIPE, SIGXFSZ};

/// Only async-signal-safe calls.
void on_stop(int /*signal*/) {
  stop = true;
  for (int const other : stopping) std::signal(other, SIG_DFL);
  if (!announce_stop) return;
  constexpr std::string_view heard =
      "\nbrisance: stopping after this step and writing the results; press Ctrl-C again to exit immediately\n";
  [[maybe_unused]] auto const written = write(STDERR_FILENO, heard.data(), heard.size());
}

}  // namespace

StopSignals::StopSignals(bool announce) {
  stop = false;
  announce_stop = announce;
  for (std::size_t n = 0; n < stopping.size(); ++n) {
    before_[n] = std::signal(stopping[n], on_stop);
    // nohup ignores the hang-up, and that is to last.
    if (stopping[n] == SIGHUP && before_[n] == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  }
  for (std::size_t n = 0; n < ignored.size(); ++n) before_[stopping.size() + n] = std::signal(ignored[n], SIG_IGN);
}

StopSignals::~StopSignals() {
  for (std::size_t n = 0; n < stopping.size(); ++n) std::signal(stopping[n], before_[n]);
  for (std::size_t n = 0; n < ignored.size(); ++n) std::signal(ignored[n], before_[stopping.size() + n]);
}

std::atomic<bool> const& StopSignals::requested() { return stop; }

}  // namespace brisance::app
