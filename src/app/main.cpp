/// The command line.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "app/commands.hpp"
#include "app/print.hpp"
#include "grid/forest.hpp"

namespace {

using brisance::ExitCode;
using brisance::app::print;

constexpr char const* exit_codes =
    "Exit codes: 0 done, 2 bad input, 3 stopped by the user or the clock, 4 numerical failure or stopped by the "
    "audit,\n"
    "5 input/output failure.\n"
    "Documentation: README.md and docs/ in the source tree; `brisance COMMAND --help` describes one command.";

/// The version, and the license of this binary: that of a library that is linked may be stricter than that of the
/// sources.
std::string version() {
  std::string const text = "brisance " BRISANCE_VERSION "\n";
  std::string const forest = brisance::grid::Forest::library();
  if (forest.empty()) return text + "built without p4est: grids have one level of blocks; BSD 3-Clause License";
  return text + "built with " + forest +
         " (GPL-2+): this binary may be distributed under the GNU GPL, version 2 or later; "
         "the sources are under the BSD 3-Clause License";
}

/// A file of results must not get the number of a standard stream that the caller has closed.
void occupy_standard_streams() {
  for (int descriptor = 0; descriptor <= 2; ++descriptor) {
    if (fcntl(descriptor, F_GETFD) >= 0) continue;
    // The lowest free number is this one.
    [[maybe_unused]] int const opened = open("/dev/null", O_RDWR);
  }
}

/// Whoever read the output has read enough, as `head` does: no failure.
bool reader_has_gone() {
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return poll(&out, 1, 0) == 1 && (out.revents & (POLLERR | POLLHUP)) != 0;
}

/// Runs a command and turns every failure into a message and an exit code.
template <class Command>
ExitCode guarded(Command const& command) {
  try {
    return command();
  } catch (brisance::Error const& error) {
    print(stderr, "brisance: error: {}\n", error.what());
    return error.code();
  } catch (std::bad_alloc const&) {
    print(stderr, "brisance: error: out of memory; `brisance check DECK` shows how much memory a case needs\n");
    return ExitCode::io_failure;
  } catch (std::exception const& error) {
    print(stderr, "brisance: internal error: {}; please report it with the deck\n", error.what());
    return ExitCode::numerical_failure;
  }
}

// Each command keeps references to its arguments and to the exit code.

void add_run(CLI::App& app, brisance::app::RunArguments& arguments, ExitCode& code) {
  auto* run = app.add_subcommand("run", "Run a deck");
  run->add_option("DECK", arguments.deck, "the case, a TOML file")->required();
  run->add_option("--output", arguments.output,
                  "folder for the results; default: NAME-results in the working directory");
  run->add_option("--threads", arguments.threads, "number of threads; default: all cores")->check(CLI::Range(1, 1024));
  run->add_option("--simd", arguments.simd,
                  "vector instructions: sse2, avx2, avx512, or scalar for none; default: auto, the best of this "
                  "processor");
  auto* force = run->add_flag("--force", arguments.force, "replace the results of an earlier run");
  run->add_flag("--resume", arguments.resume, "continue from the newest checkpoint of an earlier run")->excludes(force);
  run->add_flag("--quiet", arguments.quiet, "print only errors and warnings about the deck");
  run->add_flag("!--no-progress", arguments.progress, "do not show the progress line");
  run->footer(
      "Ctrl-C completes the current step, writes the results and a checkpoint and exits with code 3; a second Ctrl-C "
      "exits\n"
      "immediately.\n"
      "Example: brisance run cases/hemisphere_3d/deck.toml --output burst --threads 2");
  run->callback([&arguments, &code] { code = guarded([&] { return run_deck(arguments); }); });
}

void add_check(CLI::App& app, brisance::app::CheckArguments& arguments, ExitCode& code) {
  auto* check = app.add_subcommand("check", "Validate a deck and show what it will compute");
  check->add_option("DECK", arguments.deck, "the case, a TOML file")->required();
  check->add_flag("--json", arguments.json, "answer in JSON");
  check->footer("Example: brisance check cases/hemisphere_3d/deck.toml");
  check->callback([&arguments, &code] { code = guarded([&] { return check_deck(arguments); }); });
}

void add_migrate(CLI::App& app, brisance::app::MigrateArguments& arguments, ExitCode& code) {
  auto* migrate = app.add_subcommand("migrate", "Rename the keys of a deck that was written for an earlier version");
  migrate->add_option("DECK", arguments.deck, "the case, a TOML file; comments and layout are kept")->required();
  migrate->add_option("--output", arguments.output, "file for the result; default: the deck is overwritten");
  migrate->footer("Example: brisance migrate blast.toml");
  migrate->callback([&arguments, &code] { code = guarded([&] { return migrate_deck(arguments); }); });
}

void add_info(CLI::App& app, brisance::app::InfoArguments& arguments, ExitCode& code) {
  auto* info = app.add_subcommand("info", "List materials and models, or show all data of one material");
  info->add_option("NAME", arguments.name, "an explosive, a fluid or a solid");
  info->add_flag("--deck-reference", arguments.deck_reference, "print the deck reference manual in Markdown");
  info->add_flag("--json-schema", arguments.json_schema, "print the JSON Schema of the deck format, for editors");
  info->footer("Example: brisance info TNT");
  info->callback([&arguments, &code] { code = guarded([&] { return brisance::app::info(arguments); }); });
}

void add_report(CLI::App& app, brisance::app::ReportArguments& arguments, ExitCode& code) {
  auto* report = app.add_subcommand("report", "Write the HTML report of a run and print its path");
  report->add_option("DIR", arguments.folder, "the output folder of a run")->required();
  report->add_flag("--blocks", arguments.blocks, "show the outlines of the grid's blocks in slices of the gas");
  report->footer("Example: brisance report burst");
  report->callback([&arguments, &code] { code = guarded([&] { return brisance::app::report(arguments); }); });
}

void add_kb(CLI::App& app, brisance::app::KbArguments& arguments, ExitCode& code) {
  auto* kb = app.add_subcommand("kb", "Blast parameters according to Kingery and Bulmash");
  kb->add_option("--charge", arguments.charge, "mass of the charge with a unit; a number without a unit is in kg")
      ->required();
  kb->add_option("--distance", arguments.distance,
                 "distance from its centre with a unit; a number without a unit is in m")
      ->required();
  kb->add_option("--burst", arguments.burst, "hemispherical: on the ground; spherical: in free air")
      ->required()
      ->check(CLI::IsMember({"hemispherical", "spherical"}));
  kb->add_option("--explosive", arguments.explosive, "an explosive listed by `brisance info`; default: TNT");
  kb->add_option(
      "--altitude", arguments.altitude,
      "altitude above sea level in the standard atmosphere, with Sachs scaling; a number without a unit is in m");
  kb->add_flag("--json", arguments.json, "answer in JSON, SI units");
  kb->footer("Example: brisance kb --charge \"10 kg\" --distance \"5 m\" --burst hemispherical");
  kb->callback([&arguments, &code] { code = guarded([&] { return brisance::app::kb(arguments); }); });
}

}  // namespace

int main(int argc, char** argv) {
  occupy_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);  // a reader that goes away must not end a simulation
  CLI::App app("Brisance: explosive blast in air.", "brisance");
  app.set_version_flag("--version", version());
  app.require_subcommand(1);
  app.footer(exit_codes);
  app.get_formatter()->column_width(34);

  ExitCode code = ExitCode::done;
  brisance::app::RunArguments run;
  brisance::app::CheckArguments check;
  brisance::app::MigrateArguments migrate;
  brisance::app::InfoArguments info;
  brisance::app::ReportArguments report;
  brisance::app::KbArguments kb;
  add_run(app, run, code);
  add_check(app, check, code);
  add_migrate(app, migrate, code);
  add_info(app, info, code);
  add_report(app, report, code);
  add_kb(app, kb, code);

  try {
    app.parse(argc, argv);
  } catch (CLI::ParseError const& error) {
    code = app.exit(error) == 0 ? ExitCode::done : ExitCode::bad_input;
  }
  bool const printed = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (!printed && code == ExitCode::done && !reader_has_gone()) {
    print(stderr, "brisance: error: cannot write to standard output\n");
    code = ExitCode::io_failure;
  }
  return static_cast<int>(code);
}
