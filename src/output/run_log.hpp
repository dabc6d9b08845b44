/// The run log: what ran, on what, how far it came, where the time went, and whether the books balance.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "run/reports.hpp"

namespace brisance::run {
class World;
}

namespace brisance::output {

struct RunStatus {
  std::string status;      ///< "running", "done" or "stopped"
  std::string end_reason;  ///< one line for people; empty while running
  int exit_code = 0;
  std::string started_at;     ///< UTC, ISO 8601
  double wall_seconds = 0.0;  ///< since the start
  int dumps = 0;
  std::vector<long> resumed_at;  ///< steps
};

/// Versions of the program, the compiler and the libraries.
[[nodiscard]] nlohmann::json versions();

/// Processor model, number of cores and threads. Names neither host nor user.
[[nodiscard]] nlohmann::json machine();

/// How a charge was calculated before its remap, in words.
[[nodiscard]] std::string start_in_words(run::Case const& setup, run::StartReport const& report);

/// The remaps with which a run started: what the bursts held before and after.
[[nodiscard]] nlohmann::json starts(run::World const& world);

/// The run log of the present state.
[[nodiscard]] nlohmann::json run_log(run::World const& world, RunStatus const& status);

}  // namespace brisance::output
