#include "output/report.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "output/file.hpp"
#include "output/folder.hpp"
#include "output/manifest.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

std::string interpreter() {
  char const* chosen = std::getenv("BRISANCE_PYTHON");
  return chosen != nullptr && *chosen != '\0' ? chosen : BRISANCE_PYTHON_EXECUTABLE;
}

/// The folder that holds the Python package: the source tree where it still exists, else the installed one.
fs::path package_folder() {
  for (auto const* folder : {BRISANCE_PYTHON_SOURCE_DIR, BRISANCE_PYTHON_INSTALL_DIR})
    if (fs::exists(fs::path(folder) / "brisance" / "report.py")) return folder;
  throw IoError(fmt::format("the report's Python package is in neither \"{}\" nor \"{}\": install Brisance again",
                            BRISANCE_PYTHON_SOURCE_DIR, BRISANCE_PYTHON_INSTALL_DIR));
}

struct Outcome {
  int status;          ///< exit status, or 128 + signal
  std::string output;  ///< stdout and stderr
};

constexpr int not_started = 127;

/// Runs a program (searched for on PATH) and collects what it prints.
Outcome run_program(std::vector<std::string> arguments) {
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (auto& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);

  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw_io_error("start", arguments.front(), errno);
  pid_t const child = fork();
  if (child < 0) {
    int const reason = errno;
    close(ends[0]);
    close(ends[1]);
    throw_io_error("start", arguments.front(), reason);
  }
  if (child == 0) {
    // Only async-signal-safe calls from here to exec.
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    execvp(argv[0], argv.data());
    _exit(not_started);
  }
  close(ends[1]);
  Outcome outcome{0, ""};
  std::array<char, 4096> part{};
  for (;;) {
    ssize_t const got = read(ends[0], part.data(), part.size());
    if (got > 0)
      outcome.output.append(part.data(), std::size_t(got));
    else if (got == 0 || errno != EINTR)
      break;
  }
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

}  // namespace

fs::path write_report(fs::path const& folder, Outlines blocks) {
  if (!fs::exists(folder / "run.json"))
    throw IoError(
        fmt::format("\"{}\" is not the output folder of a run: it does not contain run.json", folder.string()));
  if (fs::exists(folder / manifest_name)) list_files(real_folder(folder), {"report.html"});
  std::string const python = interpreter();
  fs::path const script = package_folder() / "brisance" / "report.py";
  std::vector<std::string> arguments{python, script.string(), folder.string()};
  if (blocks == Outlines::yes) arguments.emplace_back("--blocks");
  auto const outcome = run_program(std::move(arguments));
  if (outcome.status == not_started)
    throw IoError(
        fmt::format("cannot start \"{}\", which writes the report: install python3, or set the environment variable "
                    "BRISANCE_PYTHON to an interpreter",
                    python));
  if (outcome.status != 0)
    throw IoError(fmt::format("cannot write the report of \"{}\": {}", folder.string(), outcome.output));
  return folder / "report.html";
}

}  // namespace brisance::output
