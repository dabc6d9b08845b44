#include "app/commands.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/check.hpp"
#include "app/gauge_text.hpp"
#include "app/materials_text.hpp"
#include "app/print.hpp"
#include "app/progress.hpp"
#include "app/signals.hpp"
#include "app/text.hpp"
#include "core/parallel.hpp"
#include "core/units.hpp"
#include "deck/deck.hpp"
#include "deck/library.hpp"
#include "deck/schema.hpp"
#include "empirical/kingery_bulmash.hpp"
#include "empirical/standard_atmosphere.hpp"
#include "observe/blast_summary.hpp"
#include "observe/point_summary.hpp"
#include "observe/zones.hpp"
#include "output/checkpoint.hpp"
#include "output/file.hpp"
#include "output/json.hpp"
#include "output/lock.hpp"
#include "output/profile_file.hpp"
#include "output/report.hpp"
#include "output/run_log.hpp"
#include "output/writer.hpp"
#include "run/world.hpp"
#include "session/driver.hpp"
#include "setup/build.hpp"
#include "setup/profile_fit.hpp"
#include "setup/start.hpp"

namespace brisance::app {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_rows = 30;  // gauges that the terminal's table shows

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

run::Case load(std::string const& path) { return std::move(*load_deck(path).case_); }

/// Did a run of this very deck reach its end in the folder?
bool has_finished(fs::path const& folder, run::Case const& setup) {
  try {
    auto const log = nlohmann::json::parse(output::read_file(folder / "run.json"));
    return log.at("status") == "done" && log.at("deck") == setup.deck_text;
  } catch (IoError const&) {
    return false;
  } catch (nlohmann::json::exception const&) {
    return false;
  }
}

/// Is the folder one that this user cannot write, but may look at?
bool is_read_only(fs::path const& folder) { return access(folder.c_str(), W_OK) != 0; }

/// The lock for a run in the folder, unless it is a finished one: then null.
std::unique_ptr<output::FolderLock> lock_of(fs::path const& folder, RunArguments const& arguments,
                                            run::Case const& setup) {
  if (!arguments.resume) return std::make_unique<output::FolderLock>(folder);
  // Without a folder there is no run either, and none is made.
  if (!fs::is_directory(folder)) return nullptr;
  if (is_read_only(folder) && has_finished(folder, setup)) return nullptr;
  auto lock = std::make_unique<output::FolderLock>(folder);
  return has_finished(folder, setup) ? nullptr : std::move(lock);
}

/// Reads the profile that a deck begins with.
void load_profile(run::Case& setup) {
  run::Start& start = setup.start;
  if (start.profile.empty()) return;
  detonation::Profile const profile = output::read_profile(start.profile);
  try {
    for (std::size_t n = 0; n < setup.charges.size(); ++n)
      start.profiles.push_back(setup::fitted_profile(setup, n, profile));
  } catch (InputError const& problem) {
    throw InputError(fmt::format("{}: {}", start.place, problem.what()));
  }
}

/// The 1D calculations before a run. False where the user stopped them.
bool calculate_start(run::Case& setup, Progress& progress, bool show) {
  if (!setup.start.profiles.empty()) return true;
  setup.start.profiles = setup::calculate_start(setup, [&](setup::StartProgress const& at) {
    if (show) progress.step(at);
    return !StopSignals::requested();
  });
  if (show) progress.end();
  return !setup.start.profiles.empty();
}

void print_starts(run::World const& world) {
  for (std::size_t n = 0; n < world.starts.size(); ++n) {
    auto const& report = world.starts[n];
    auto const& r = report.remap;
    print(stdout, "{}: {}, remapped at {}; the burst has a radius of {}, {:.1f} cells{}\n",
          world.starts.size() == 1 ? "start" : fmt::format("start {}", n + 1),
          output::start_in_words(world.setup, report), quantity(r.time, "s"), quantity(r.radius, "m"),
          r.cells_per_radius, report.by.empty() ? "" : ", near " + report.by);
    print(stdout,
          "remap: {} {:.8g} kg, products {:.8g} kg and {} became {:.8g} kg, {:.8g} kg and {}; relative error {:.1e}\n",
          world.setup.ambient.fluid.name, r.before.mass[0], r.before.mass[1], quantity(r.before.energy, "J", 6),
          r.after.mass[0], r.after.mass[1], quantity(r.after.energy, "J", 6), r.error());
  }
}

void print_guards(run::Audit const& a) {
  if (a.guarded_cells == 0) return;
  print(stdout, "guards: {} cell updates lifted to the floors; they added {:.3g} kg and {:.3g} J\n", a.guarded_cells,
        a.guard_mass, a.guard_energy);
}

void print_panels(run::World const& world) {
  if (world.panels == nullptr) return;
  print(stdout, "\n");
  std::size_t shown = 0;
  auto const& panels = world.panels->reports();
  for (run::PanelReport const& p : panels) {
    if (++shown > most_rows) break;
    print(stdout, "panel {}: {}\n", p.name, panel_in_words(p, world.setup.domain));
  }
  if (panels.size() > most_rows) print(stdout, "... and {} more panels in summary.json\n", panels.size() - most_rows);
  auto const& a = world.audit;
  double const mass = a.panel_mass[0] + a.panel_mass[1];
  if (mass == 0.0 && a.panel_energy == 0.0) return;
  print(stdout, "panels: {:+.3g} kg and {} came with the cells that opened, which had counted as gas of the ambient\n",
        mass, quantity(a.panel_energy, "J", 3));
}

void print_audit(run::World const& world) {
  auto const error = world.audit.relative_error();
  bool const two = world.gas->fluids().two;
  std::string const products = two ? fmt::format(", second fluid {:.1e}", error[1]) : "";
  print(stdout, "\naudit: {} (relative error of the mass: {} {:.1e}{}; of the energy {:.1e})\n{}",
        verdict_word(world.verdict()), world.setup.ambient.fluid.name, error[0], products, error[2],
        verdict_reasons(world.verdict(), world.for_comparison()));
  auto const& a = world.audit;
  print_guards(a);
  if (world.setup.afterburn) {
    print(stdout, "afterburn: the products released {}, of {} in all\n", quantity(a.afterburn_energy, "J"),
          quantity(world.setup.afterburn->energy * a.initial.mass[1], "J"));
  }
  if (a.fallback_faces > 0)
    print(stdout, "fluxes: {} blended with first-order ones, so that density and pressure stay positive\n",
          a.fallback_faces);
}

std::string vector_text(Vec3 const& v, char const* unit, int dimensions) {
  std::string text;
  for (int d = 0; d < dimensions; ++d) text += (d == 0 ? "" : ", ") + quantity(v[d], unit);
  return dimensions == 1 ? text : "(" + text + ")";
}

void print_points(run::World const& world, observe::Gauges const& histories) {
  auto const gauges = observe::summarise_points(world, histories);
  auto const bodies = observe::summarise_bodies(world, histories);
  int const dims = world.setup.domain.dimensions();
  if (!gauges.empty()) {
    std::size_t width = 5;
    for (auto const& g : gauges) width = std::max(width, g.name.size());
    print(stdout, "\n{:<{}}  {:>14} {:>11} {:>15} {:>13} {:>12} {:>10}   {}\n", "gauge", width, "peak displ.", "at",
          "component", "peak speed", "peak Mises", "pl. strain", "displacement at the end");
    for (std::size_t n = 0; n < std::min(gauges.size(), most_rows); ++n) {
      auto const& g = gauges[n];
      print(stdout, "{:<{}}  {:>14} {:>11} {:>15} {:>13} {:>12} {:>10.3g}   {}{}\n", g.name, width,
            quantity(g.displacement.value, "m"), quantity(g.displacement.time, "s"),
            fmt::format("{} {}", "xyz"[g.component], quantity(g.component_displacement.value, "m")),
            quantity(g.velocity.value, "m/s"), quantity(g.mises.value, "Pa"), g.plastic_strain,
            vector_text(g.final_displacement, "m", dims), g.lost ? " (left the domain)" : "");
    }
    if (gauges.size() > most_rows) print(stdout, "... and {} more in summary.csv\n", gauges.size() - most_rows);
  }
  std::size_t width = 4;
  for (auto const& b : bodies) width = std::max(width, b.body.size());
  print(stdout, "\n{:<{}}  {:>12} {:>12} {:>12} {:>12} {:>12}   {}\n", "body", width, "mass", "deflection", "kinetic",
        "internal", "plastic", "mean velocity");
  std::vector<std::string> shown;
  for (auto const& b : bodies) {
    // A body that several gauges watch has one row.
    if (std::find(shown.begin(), shown.end(), b.body) != shown.end()) continue;
    shown.push_back(b.body);
    if (shown.size() > most_rows) continue;
    Vec3 const v = b.end.mass > 0.0 ? (1.0 / b.end.mass) * b.end.momentum : Vec3{0.0, 0.0, 0.0};
    print(stdout, "{:<{}}  {:>12} {:>12} {:>12} {:>12} {:>12}   {}\n", b.body, width, quantity(b.end.mass, "kg"),
          quantity(b.displacement.value, "m"), quantity(b.end.kinetic_energy, "J"),
          quantity(b.end.internal_energy, "J"), quantity(b.end.plastic_work, "J"), vector_text(v, "m/s", dims));
  }
  if (shown.size() > most_rows) print(stdout, "... and {} more in summary.csv\n", shown.size() - most_rows);
}

/// What is broken of the bodies of concrete, and how it looks from their faces.
void print_broken_zones(run::World const& world) {
  for (auto const& zones : observe::broken_zones(world)) {
    print(stdout, "\n{}: crushed {}, cracked {}, more than half damaged {}\n", world.bodies[zones.body].name,
          quantity(zones.crushed.mass, "kg"), quantity(zones.cracked.mass, "kg"), quantity(zones.damaged.mass, "kg"));
    for (auto const& face : zones.faces) {
      if (face.crushed_depth == 0.0 && face.cracked_depth == 0.0 && !face.spall_depth) continue;
      print(stdout, "  face {:<7} crushed: diameter {}, depth {}; cracked: diameter {}, depth {}{}\n",
            grid::face_names[static_cast<int>(face.face)], quantity(face.crushed_diameter, "m"),
            quantity(face.crushed_depth, "m"), quantity(face.cracked_diameter, "m"), quantity(face.cracked_depth, "m"),
            face.spall_depth ? fmt::format("; spall at {}", quantity(*face.spall_depth, "m")) : "");
    }
  }
}

/// Kinetic energy that the points lost, where it is known.
void print_dissipation(run::EnergyBalance const& energy) {
  auto const& [held, filtered, apic, friction] = energy.dissipated;
  if (held == 0.0 && filtered == 0.0 && apic == 0.0 && friction == 0.0) return;
  print(stdout,
        "kinetic energy lost and counted: {} at held nodes, {} by PIC and XPIC, {} by APIC, {} by the friction of "
        "contacts; {:.2g} % of the energy at work\n",
        quantity(held, "J"), quantity(filtered, "J"), quantity(apic, "J"), quantity(friction, "J"),
        energy.scale > 0.0 ? 100.0 * energy.dissipated.sum() / energy.scale : 0.0);
}

/// Energy that gas points were given because they had less than none.
void print_lifted(mpm::Mpm const& points) {
  if (points.floored().points == 0) return;
  print(stdout, "guards: {} updates of gas points lifted to no pressure; they added {:.3g} J\n",
        points.floored().points, points.floored().energy);
}

void print_point_audit(run::World const& world) {
  auto const& a = world.audit;
  auto const energy = world.energy_balance();
  print(stdout, "\naudit: {} (relative error of the mass {:.1e}; energy {} to {}{}, drift {:+.3g} % of {} at work)\n{}",
        verdict_word(world.verdict()), a.relative_error()[0], quantity(energy.initial, "J"),
        quantity(energy.current + energy.lost, "J"),
        energy.work != 0.0 ? fmt::format(" by the work {} of outer forces", quantity(energy.work, "J")) : "",
        100.0 * energy.drift(), quantity(energy.scale, "J"), verdict_reasons(world.verdict(), world.for_comparison()));
  print_dissipation(energy);
  print_lifted(*world.points);
  auto const& lost = world.points->losses();
  if (lost.points > 0) {
    print(stdout, "{} points left the domain with {:.4g} kg and {}\n", lost.points, lost.mass,
          quantity(lost.energy, "J"));
  }
}

void print_region_audit(run::World const& world) {
  auto const error = world.audit.relative_error();
  bool const two = world.gas->fluids().two;
  bridge::Account const ledger = world.bridge->ledger();
  auto const energy = world.energy_balance();
  print(stdout,
        "\naudit: {} (relative error of the mass: {} {:.1e}{}; energy {} to {}, drift {:+.3g} % of {} at work)\n{}",
        verdict_word(world.verdict()), world.setup.ambient.fluid.name, error[0],
        two ? fmt::format(", second fluid {:.1e}", error[1]) : "", quantity(energy.initial, "J"),
        quantity(energy.current + energy.lost, "J"), 100.0 * energy.drift(), quantity(energy.scale, "J"),
        verdict_reasons(world.verdict(), world.for_comparison()));
  print_dissipation(energy);
  print_lifted(*world.points);
  print_guards(world.audit);
  if (!world.awake_since) {
    print(stdout, "MPM region: no wave came near, its points slept\n");
    return;
  }
  double total = 0.0;
  for (auto const& [phase, seconds] : world.timings) total += seconds;
  auto const bridge = world.timings.find("bridge");
  print(stdout,
        "MPM region: awake since {}; {} steps of the gas and {} of the points; {} points of gas came in, {} left, {} "
        "under way in the ledger (at most {}); the bridge took {:.0f} % of the time\n",
        quantity(*world.awake_since, "s"), world.clock.gas_steps, world.clock.point_steps, world.bridge->traffic().born,
        world.bridge->traffic().left, quantity(ledger.total(), "kg", 3), quantity(world.audit.memory.content, "kg", 3),
        total > 0.0 && bridge != world.timings.end() ? 100.0 * bridge->second / total : 0.0);
}

double si_quantity(char const* option, std::string const& text, char const* unit) {
  units::Quantity const q = units::parse(text, unit);
  if (!q.value) throw InputError(fmt::format("{}: {}", option, q.problem));
  if (!(*q.value > 0.0) || !std::isfinite(*q.value))
    throw InputError(fmt::format("{}: \"{}\" must be positive", option, text));
  return *q.value;
}

/// The newest good checkpoint of the folder. Throws where there is none, or where it is of another case.
std::unique_ptr<output::CheckpointReader> checkpoint_of(fs::path const& folder, run::Case const& setup) {
  auto found = output::newest_checkpoint(folder);
  std::vector<std::string> warnings;
  for (auto const& problem : found.problems) warnings.push_back("warning: " + problem);
  print(stderr, "{}", listed(warnings));
  if (found.reader == nullptr) {
    throw IoError(fmt::format(
        "--resume: \"{}\" holds no {}checkpoint: the run ended before it wrote one, or --output names another folder; "
        "start anew with --force in place of --resume",
        folder.string(), found.problems.empty() ? "" : "good "));
  }
  auto const& info = found.reader->info();
  if (auto const key = deck::difference(info.deck, setup.deck_text)) {
    throw InputError(fmt::format(
        "--resume: {} of \"{}\" is not that of the deck that \"{}\" was calculated with; only [end], [output] (but for "
        "peak_fields), [checkpoint], [audit] and the title may change; start anew with --force, or see {} for the "
        "former deck",
        *key, setup.deck_path, found.reader->path().string(), (folder / "deck.toml").string()));
  }
  if (!found.problems.empty()) print(stderr, "the checkpoint \"{}\" is used\n", found.reader->path().string());
  if (info.program != output::program_build()) {
    print(stderr,
          "warning: \"{}\" was written by another build of the program ({}): the results may differ in their last "
          "digits from those of an uninterrupted run\n",
          found.reader->path().string(), info.program);
  }
  for (auto const& refused : found.refused) output::put_aside(refused);
  return std::move(found.reader);
}

void read_world(run::World& world, observe::Gauges& gauges, output::CheckpointReader& checkpoint) {
  try {
    world.archive(checkpoint.archive());
    gauges.archive(checkpoint.archive(), world);
  } catch (IoError const& problem) {
    throw IoError(fmt::format(
        "--resume: the checkpoint \"{}\" does not fit this case: {}; the program or a file that the deck names has "
        "changed: restore it, or start anew with --force in place of --resume",
        checkpoint.path().string(), problem.what()));
  }
}

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
  set_threads(arguments.threads);
  Plan const expected = plan(setup);
  refuse_unless_it_fits(expected);
  if (!arguments.resume) load_profile(setup);
  fs::path const folder =
      output::real_folder(arguments.output.empty() ? default_output_folder(arguments.deck) : arguments.output);
  auto const lock = lock_of(folder, arguments, setup);
  if (lock != nullptr && !lock->warning().empty()) print(stderr, "warning: {}\n", lock->warning());
  std::unique_ptr<output::CheckpointReader> checkpoint;
  if (arguments.resume) {
    if (lock == nullptr && has_finished(folder, setup)) {
      if (!arguments.quiet) print(stdout, "{}: this run had reached its end, nothing is left to do\n", folder.string());
      return ExitCode::done;
    }
    checkpoint = checkpoint_of(folder, setup);
  }
  if (!arguments.quiet) {
    if (!setup.title.empty()) print(stdout, "{}\n", setup.title);
    std::string const points = fmt::format("{} material points", large_count(expected.points));
    std::string const cells = fmt::format("{} cells", large_count(expected.cells));
    std::string const what = expected.region ? cells + " and " + points : expected.points > 0.0 ? points : cells;
    print(stdout, "{}, about {} steps, {} thread{}; results go to {}\n", what, large_count(expected.steps), threads(),
          threads() == 1 ? "" : "s", folder.string());
    for (auto const& body : expected.bodies) {
      print(stdout, "{}: {}, {} points, {:.8g} kg, the shape has {:.8g} kg\n", body.name, body.material, body.points,
            body.mass, body.geometric_mass);
    }
    for (auto const& charge : expected.charges) {
      bool const tried = std::isfinite(charge.realised_mass);
      print(stdout, "{}: asked {:.8g} kg, {}{}\n", charge.explosive, charge.asked_mass,
            tried ? fmt::format("realised {:.8g} kg and ", charge.realised_mass) : "",
            quantity(charge.realised_energy, "J"));
    }
    std::vector<std::string> warnings;
    for (auto const& warning : expected.warnings) warnings.push_back("warning: " + warning);
    print(stderr, "{}", listed(warnings));
    if (checkpoint != nullptr) {
      print(stdout, "going on from {}: t = {}, step {}\n", checkpoint->path().string(),
            quantity(checkpoint->info().time, "s"), checkpoint->info().step);
    }
    std::fflush(stdout);
  }

  bool const terminal = isatty(STDERR_FILENO) != 0;
  StopSignals const signals(terminal && !arguments.quiet);
  Progress progress(stderr, terminal);
  bool const show = arguments.progress && !arguments.quiet;
  setup.start.from_checkpoint = checkpoint != nullptr;
  auto const burst = std::chrono::steady_clock::now();
  if (setup.start.remap && checkpoint == nullptr && !calculate_start(setup, progress, show)) {
    if (!arguments.quiet) print(stdout, "stopped by the user during the 1D calculation; nothing has been written\n");
    return ExitCode::stopped_by_user;
  }
  double const start_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - burst).count();
  run::World world = setup::build(std::move(setup));
  observe::Gauges gauges(world);
  if (world.setup.start.remap && checkpoint == nullptr) world.timings["start"] += start_seconds;
  if (checkpoint != nullptr) read_world(world, gauges, *checkpoint);
  // One more than stay: the newest is complete before the oldest goes.
  double const kept = (world.setup.checkpoint.keep + 1) * output::state_bytes([&](Archive& a) {
                        world.archive(a);
                        gauges.archive(a, world);
                      });
  output::Writer writer(world, gauges, folder,
                        {.earlier = checkpoint != nullptr ? output::Earlier::keep
                                    : arguments.force     ? output::Earlier::replace
                                                          : output::Earlier::refuse,
                         .checkpoint_bytes = kept});
  if (checkpoint == nullptr) output::write_start_profiles(world, folder);
  if (!arguments.quiet) print_starts(world);
  std::fflush(stdout);
  progress.start(world);
  auto const after_step = [&](run::World const& w) {
    if (show) progress.step(w);
  };
  Archive* const resumed = checkpoint != nullptr ? &checkpoint->archive() : nullptr;
  session::Ending const ending =
      session::drive(world, gauges, writer, StopSignals::requested(), after_step, resumed, start);
  if (show) progress.end();

  if (ending.code != ExitCode::done && ending.code != ExitCode::stopped_by_user) {
    print(stderr, "brisance: error: {}\nWhat was written until then is in {}\n", ending.reason, folder.string());
    return ending.code;
  }
  if (arguments.quiet) return ending.code;
  double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  print(stdout, "{}: {} steps in {}\n", ending.reason, world.clock.step, wall_time(seconds));
  if (world.bridge != nullptr) {
    print(stdout, "{}", gauge_tables(world.setup, gauges.gas));
    print_points(world, gauges);
    print_broken_zones(world);
    print_panels(world);
    print_region_audit(world);
  } else if (world.points != nullptr) {
    print_points(world, gauges);
    print_broken_zones(world);
    print_point_audit(world);
  } else {
    print(stdout, "{}", gauge_tables(world.setup, gauges.gas));
    print_panels(world);
    print_audit(world);
  }
  print(stdout, "\nresults: {}\npictures and comparison: brisance report {}\n", folder.string(), folder.string());
  return ending.code;
}

ExitCode check_deck(CheckArguments const& arguments) {
  deck::Result deck = load_deck(arguments.deck);
  run::Case& setup = *deck.case_;
  load_profile(setup);
  Plan const p = plan(setup);
  if (arguments.json) {
    nlohmann::json answer = plan_json(setup, p);
    answer["material_parameters"] = materials_json(deck.materials);
    print(stdout, "{}\n", answer.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    print(stdout, "{}{}", plan_text(setup, p), materials_text(deck.materials));
  }
  return ExitCode::done;
}

ExitCode info(InfoArguments const& arguments) {
  if (arguments.deck_reference) {
    print(stdout, "{}", deck::reference_manual());
  } else if (!arguments.name.empty()) {
    print(stdout, "{}", deck::describe_material(arguments.name));
  } else {
    print(stdout, "{}\n{}", deck::describe_library(), deck::describe_models());
  }
  return ExitCode::done;
}

ExitCode report(std::string const& folder) {
  print(stdout, "{}\n", output::write_report(folder).string());
  return ExitCode::done;
}

ExitCode kb(KbArguments const& arguments) {
  auto const* explosive = deck::library().explosive(arguments.explosive);
  if (explosive == nullptr) {
    throw InputError(
        fmt::format("--explosive: \"{}\" is not a known explosive; {}", arguments.explosive,
                    deck::suggestion(arguments.explosive, deck::library().explosive_names(), "known explosives")));
  }
  auto const* air = deck::library().fluid("air");

  run::Ambient ambient;
  ambient.fluid = *air;
  ambient.state.density = air->density;
  ambient.state.pressure = air->pressure;
  if (!arguments.altitude.empty()) {
    units::Quantity const altitude = units::parse(arguments.altitude, "m");
    if (!altitude.value) throw InputError(fmt::format("--altitude: {}", altitude.problem));
    auto const state = empirical::standard_atmosphere(*altitude.value);
    ambient.state.pressure = state.pressure;
    ambient.state.density = state.density;
  }
  double const mass = si_quantity("--charge", arguments.charge, "kg");
  double const distance = si_quantity("--distance", arguments.distance, "m");
  // As a gauge of a case asks, so that both give the same answer.
  auto const blast = observe::empirical_blast(
      *explosive, mass, ambient, arguments.burst == "spherical" ? run::Burst::spherical : run::Burst::hemispherical,
      distance);
  auto const tnt_mass = [mass](std::optional<double> equivalent) -> std::optional<double> {
    if (!equivalent) return std::nullopt;
    return mass * *equivalent;
  };
  auto const by_pressure = tnt_mass(explosive->tnt_equivalent_pressure);
  auto const by_impulse = tnt_mass(explosive->tnt_equivalent_impulse);
  auto const scaled_distance = by_pressure ? std::optional(blast.scaled_distance) : std::nullopt;

  auto const burst = arguments.burst == "spherical" ? empirical::Burst::spherical : empirical::Burst::hemispherical;
  std::optional<double> other;  // incident impulse by the other fit over this one
  if (by_pressure && by_impulse) {
    double const z = blast.scaled_distance * std::cbrt(*by_pressure / *by_impulse);
    other = empirical::other_incident_impulse(z, burst);
  }

  if (arguments.json) {
    nlohmann::json quantities = nlohmann::json::object();
    for (auto const& field : empirical::blast_fields) {
      auto const range = empirical::validity(field, burst);
      quantities[std::string(field.key)] = {{"value", output::json_or_null(blast.*field.value)},
                                            {"unit", field.unit},
                                            {"scaled_distances", {range.lowest, range.highest}}};
    }
    nlohmann::json const answer{{"explosive", explosive->name},
                                {"mass", mass},
                                {"tnt_mass_for_pressure", output::json_or_null(by_pressure)},
                                {"tnt_mass_for_impulse", output::json_or_null(by_impulse)},
                                {"distance", distance},
                                {"burst", arguments.burst},
                                {"scaled_distance", output::json_or_null(scaled_distance)},
                                {"ambient_pressure", ambient.state.pressure},
                                {"ambient_density", ambient.state.density},
                                {"incident_impulse_of_other_fit", output::json_or_null(other)},
                                {"quantities", quantities}};
    print(stdout, "{}\n", answer.dump(2));
    return ExitCode::done;
  }

  print(stdout, "{:g} kg of {}, {} burst, {:g} m{}\n", mass, explosive->name, arguments.burst, distance,
        scaled_distance ? fmt::format(": Z = {:.4g} m/kg^(1/3)", *scaled_distance) : "");
  if (explosive->name != "TNT") {
    auto const mass_text = [](std::optional<double> m) { return m ? fmt::format("{:g} kg", *m) : "unknown"; };
    print(stdout, "TNT equivalent: {} for pressures, {} for impulses and times\n", mass_text(by_pressure),
          mass_text(by_impulse));
  }
  if (!arguments.altitude.empty()) {
    print(stdout, "air at {} and {:.4g} kg/m3; Z is scaled to the sea level, where it would be {:.4g} by mass alone\n",
          quantity(ambient.state.pressure, "Pa", 5), ambient.state.density,
          distance / std::cbrt(by_pressure.value_or(mass)));
  }
  print(stdout, "\n");
  for (auto const& field : empirical::blast_fields) {
    auto const value = blast.*field.value;
    bool const of_impulse = field.scaling == empirical::Scaling::impulse || field.scaling == empirical::Scaling::time;
    if (of_impulse ? !by_impulse : !by_pressure) {
      print(stdout, "{:<24} {:>10} (the TNT equivalent is unknown)\n", field.label, "-");
    } else if (value) {
      print(stdout, "{:<24} {:>10.4g} {}\n", field.label, *value * field.display_factor, field.display_unit);
    } else {
      auto const range = empirical::validity(field, burst);
      bool const derived = field.value == &empirical::Blast::dynamic_pressure;
      print(stdout, "{:<24} {:>10} (known for Z from {:.4g} to {:.4g}{})\n", field.label, "-", range.lowest,
            range.highest,
            derived && blast.scaled_distance < range.lowest
                ? fmt::format(": up to an overpressure of {:g} ambient pressures, where air is still an ideal gas",
                              empirical::strongest_ideal_shock)
                : "");
    }
  }
  if (other) {
    print(stdout,
          "\nThe incident impulse of hemispherical bursts circulates with two values of one coefficient. This one, of "
          "the\nmetric listings, joins the curve of small Z better; the other changes the impulse by {:+.1f} %.\n",
          100.0 * (*other - 1.0));
  }
  return ExitCode::done;
}

}  // namespace brisance::app
