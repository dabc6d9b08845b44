/// Errors and the exit codes they lead to. Nothing below `app` prints or exits: it throws one of these.
#pragma once

#include <stdexcept>
#include <string>

namespace brisance {

/// Exit codes of the program, documented in the README and in `brisance --help`.
enum class ExitCode : int {
  done = 0,
  bad_input = 2,
  stopped_by_user = 3,
  numerical_failure = 4,
  io_failure = 5,
};

/// Base of all errors that Brisance raises on purpose. `what()` is a complete message for the user.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, std::string const& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

/// The deck, a command-line value or an argument of a library call is wrong.
class InputError : public Error {
 public:
  explicit InputError(std::string const& message) : Error(ExitCode::bad_input, message) {}
};

/// The simulation produced a state that cannot be continued (not a number, vanished time step, ...).
class NumericalError : public Error {
 public:
  explicit NumericalError(std::string const& message) : Error(ExitCode::numerical_failure, message) {}
};

/// A file could not be read or written.
class IoError : public Error {
 public:
  explicit IoError(std::string const& message) : Error(ExitCode::io_failure, message) {}
};

}  // namespace brisance
