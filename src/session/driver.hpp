/// The run loop: steps, output times, and the end in all its forms. Prints nothing.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <string>

#include "core/error.hpp"
#include "output/writer.hpp"

namespace brisance::run {
class World;
}

namespace brisance::session {

/// How a run ended.
struct Ending {
  ExitCode code = ExitCode::done;
  std::string reason;  ///< one line for people
};

/// Runs the world to its end, gauges sampled on the way, until `stop` is set or until something fails, and writes what
/// there is. `after_step` is called after every step. `resumed` is a checkpoint from which the world has been read: the
/// run goes on with the rest of it, and the folder of the writer becomes what it was then. `begin` is when the program
/// started, from which the deck's `end.wall_clock` counts. Numerical and output failures end in the result; other
/// errors are thrown.
[[nodiscard]] Ending drive(run::World& world, observe::Gauges& gauges, output::Writer& writer,
                           std::atomic<bool> const& stop, std::function<void(run::World const&)> const& after_step,
                           Archive* resumed = nullptr,
                           std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now());

}  // namespace brisance::session
