#include "app/commands.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/materials_text.hpp"
#include "app/plan_text.hpp"
#include "app/print.hpp"
#include "app/progress.hpp"
#include "app/run_text.hpp"
#include "app/signals.hpp"
#include "core/parallel.hpp"
#include "core/simd.hpp"
#include "core/text.hpp"
#include "deck/deck.hpp"
#include "deck/library.hpp"
#include "deck/migrate.hpp"
#include "deck/schema.hpp"
#include "output/file.hpp"
#include "output/report.hpp"
#include "session/session.hpp"

namespace brisance::app {

namespace fs = std::filesystem;

namespace {

/// What the deck says, with a case; its errors and warnings go to stderr.
deck::Result load_deck(std::string const& path) {
  deck::Result result = deck::read_file(path);
  print(stderr, "{}", listed(result.warnings));
  if (!result.case_) {
    std::vector<std::string> lines;
    for (std::size_t n = 0; n < result.errors.size(); ++n)
      lines.push_back(n < most_messages ? deck::format(result.errors[n]) : "");
    print(stderr, "{}", listed(lines));
    throw InputError(fmt::format("{}: {} error{}", path, result.errors.size(), result.errors.size() == 1 ? "" : "s"));
  }
  return result;
}

/// Throws InputError where there is no such set, or the processor has not got it.
void choose_simd_set(std::string const& word) {
  if (word == "auto") return;
  auto const set = value_of<SimdSet>(word);
  std::vector<std::string> usable{"auto"};
  for (Word<SimdSet> const& w : words(SimdSet{})) {
    if (has_simd_set(w.value)) usable.emplace_back(w.name);
  }
  if (!set || !has_simd_set(*set)) {
    throw InputError(fmt::format("--simd {}: {}; possible here: {}", word,
                                 set ? "this processor has no such instructions" : "no set of vector instructions",
                                 fmt::join(usable, ", ")));
  }
  use_simd_set(set);
}

run::Case load(std::string const& path) { return std::move(*load_deck(path).case_); }

}  // namespace

std::string default_output_folder(std::string const& deck) {
  fs::path const path = fs::absolute(deck).lexically_normal();
  fs::path const name =
      path.filename() == "deck.toml" && path.parent_path().has_filename() ? path.parent_path().filename() : path.stem();
  return name.string() + "-results";
}

ExitCode run_deck(RunArguments const& arguments) {
  auto const start = std::chrono::steady_clock::now();
  run::Case setup = load(arguments.deck);
  std::string const title = setup.title;
  set_threads(arguments.threads);
  choose_simd_set(arguments.simd);
  session::Session session(
      std::move(setup), {.folder = arguments.output.empty() ? default_output_folder(arguments.deck) : arguments.output,
                         .force = arguments.force,
                         .resume = arguments.resume,
                         .tell = [](std::string const& warning) { print(stderr, "{}", warning); },
                         .begin = start});
  std::string const folder = session.folder().string();
  if (session.had_finished()) {
    if (!arguments.quiet) print(stdout, "{}: this run has already finished; nothing left to do\n", folder);
    return ExitCode::done;
  }
  if (!arguments.quiet) print_head(session, title);

  bool const terminal = isatty(STDERR_FILENO) != 0;
  StopSignals const signals(terminal && !arguments.quiet);
  Progress progress(stderr, terminal);
  bool const show = arguments.progress && !arguments.quiet;
  bool const started = session.calculate_start([&](setup::StartProgress const& at) {
    if (show) progress.step(at);
    return !StopSignals::requested();
  });
  if (show) progress.end();
  if (!started) {
    if (!arguments.quiet) print(stdout, "stopped by the user during the 1D simulation; nothing was written\n");
    return ExitCode::stopped_by_user;
  }
  session.build();
  run::World const& world = session.world();
  if (!arguments.quiet) print_starts(world);
  std::fflush(stdout);
  progress.start(world);
  session::Ending const ending = session.run(StopSignals::requested(), [&](run::World const& w) {
    if (show) progress.step(w);
  });
  if (show) progress.end();

  if (ending.code != ExitCode::done && ending.code != ExitCode::stopped_by_user) {
    print(stderr, "brisance: error: {}\nAll output up to that point is in {}\n", ending.reason, folder);
    return ending.code;
  }
  if (arguments.quiet) return ending.code;
  double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  print(stdout, "{}: {} steps in {}\n", ending.reason, world.clock.step, wall_time(seconds));
  print_results(world, session.gauges());
  print(stdout, "\nresults: {}\nfigures and comparison: brisance report {}\n", folder, folder);
  return ending.code;
}

ExitCode check_deck(CheckArguments const& arguments) {
  deck::Result deck = load_deck(arguments.deck);
  run::Case& setup = *deck.case_;
  session::load_profile(setup);
  session::Plan const p = session::plan(setup);
  if (arguments.json) {
    nlohmann::json answer = plan_json(setup, p);
    answer["material_parameters"] = materials_json(deck.materials);
    print(stdout, "{}\n", answer.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    print(stdout, "{}{}", plan_text(setup, p), materials_text(deck.materials));
  }
  return ExitCode::done;
}

ExitCode migrate_deck(MigrateArguments const& arguments) {
  std::string const text = deck::text_of(arguments.deck);
  deck::Migration const migration = deck::migrate(text, arguments.deck);
  for (deck::Renaming const& one : migration.renamings)
    print(stdout, "{}:{}: {} is now {}\n", arguments.deck, one.line, one.was, one.now);
  std::string const target = arguments.output.empty() ? arguments.deck : arguments.output;
  if (target != arguments.deck || migration.text != text) output::replace_file(target, migration.text);
  print(stdout, "{}: {}\n", target,
        migration.renamings.empty() ? "all keys already have their current names" : "written with the current names");
  return ExitCode::done;
}

ExitCode info(InfoArguments const& arguments) {
  if (arguments.deck_reference) {
    print(stdout, "{}", deck::reference_manual());
  } else if (arguments.json_schema) {
    print(stdout, "{}", deck::json_schema());
  } else if (!arguments.name.empty()) {
    print(stdout, "{}", deck::describe_material(arguments.name));
  } else {
    print(stdout, "{}\n{}", deck::describe_library(), deck::describe_models());
  }
  return ExitCode::done;
}

ExitCode report(ReportArguments const& arguments) {
  auto const blocks = arguments.blocks ? output::Outlines::yes : output::Outlines::no;
  print(stdout, "{}\n", output::write_report(arguments.folder, blocks).string());
  return ExitCode::done;
}

}  // namespace brisance::app
