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
      "\nbrisance: stopping after this step and writing the results; once more ends it at once\n";
  [[maybe_unused]] auto const written = write(STDERR_FILENO, heard.data(), heard.size());
}

}  // namespace

StopSignals::StopSignals(bool announce) {
  stop = false;
  announce_stop = announce;
  for (int const signal : stopping) std::signal(signal, on_stop);
  for (int const signal : ignored) std::signal(signal, SIG_IGN);
}

StopSignals::~StopSignals() {
  for (int const signal : stopping) std::signal(signal, SIG_DFL);
  for (int const signal : ignored) std::signal(signal, SIG_DFL);
}

std::atomic<bool> const& StopSignals::requested() { return stop; }

}  // namespace brisance::app
