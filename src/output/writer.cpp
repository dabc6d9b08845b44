#include "output/writer.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "observe/gas_fields.hpp"
#include "observe/particle_fields.hpp"
#include "output/dump.hpp"
#include "output/file.hpp"
#include "output/folder.hpp"
#include "output/json.hpp"
#include "output/placed.hpp"
#include "output/profile_file.hpp"
#include "output/run_log.hpp"
#include "run/world.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

/// Fraction of their uncompressed size that the dumps are expected to take at least: the estimate must not refuse a run
/// that fits.
constexpr double expected_compression = 0.5;

/// Of several levels, how much larger the dumps may become than the first: shocks spread.
constexpr double expected_growth = 2.0;

/// Cells that the dumps will have on average.
double expected_cells(run::World const& world) {
  if (form_of_fields(world.setup) == DumpForm::xdmf) return static_cast<double>(world.setup.domain.cell_count());
  double cells = 0.0;
  for (grid::Block const& block : world.grid.blocks()) cells += block.covered ? 0 : block.cell_count();
  return expected_growth * cells;
}

double expected_bytes(run::World const& world, WriterOptions const& options) {
  run::Case const& setup = world.setup;
  bool const single = setup.output.single_precision;
  double dump = FieldSeries::bytes_per_dump(expected_cells(world), dumped_fields(setup, IsLast::no), single);
  if (world.particles != nullptr) {
    dump += ParticleSeries::bytes_per_dump(static_cast<double>(observe::dumped_particles(world)),
                                           dumped_particle_fields(setup), single);
  }
  return dump * static_cast<double>(dump_times(setup.output, setup.end.time).size()) * expected_compression +
         options.checkpoint_bytes;
}

/// The files of a run. Dumps and checkpoints are listed when they come.
Written files_of(run::World const& world, observe::Gauges const& histories) {
  run::Case const& setup = world.setup;
  Written files{{"run.json", "deck.toml", "summary.csv", "summary.json"}, {"checkpoints/stopped.brz"}};
  auto const series = [&](char const* kind, DumpForm form = DumpForm::xdmf) {
    files.first.push_back(index_name(kind, form));
    int const dumps = static_cast<int>(dump_times(setup.output, setup.end.time).size());
    // One more where the run is stopped between two.
    for (int n = 0; n <= dumps; ++n) files.later.push_back(dump_name(kind, n, form));
  };
  if (world.gas != nullptr) series("fields", form_of_fields(setup));
  if (!dumped_particle_fields(setup).empty()) series("points");
  if (world.particles != nullptr) files.first.emplace_back("energies.csv");
  if (world.particles != nullptr && world.gas != nullptr) files.first.emplace_back("bodies.csv");
  std::vector<std::string> gauges;
  for (auto const& history : histories.gas) gauges.push_back(history.gauge.name);
  for (auto const& history : histories.particles) gauges.push_back(history.gauge.name);
  for (auto& name : gauge_file_names(gauges)) files.first.push_back(std::move(name));
  if (setup.start.remap) {
    for (std::size_t n = 1; n <= setup.charges.size(); ++n)
      files.later.push_back(fmt::format("profiles/start_{}.h5", n));
  }
  if (setup.output.profile) files.later.emplace_back("profiles/end.h5");
  return files;
}

/// Prepares the folder before the members that write into it are built.
fs::path prepared(fs::path const& folder, run::World const& world, observe::Gauges const& gauges,
                  WriterOptions const& options) {
  // Before it is looked at whether it is a link: one that leads nowhere cannot be created.
  create_folder(folder);
  fs::path real = real_folder(folder);
  prepare_folder(real, options.earlier, expected_bytes(world, options), files_of(world, gauges),
                 form_of_fields(world.setup) == DumpForm::xdmf
                     ? ""
                     : " with twice the cells of the start, for shocks that spread take fine cells with them");
  return real;
}

FieldSpec spec_of(std::string const& name, std::vector<observe::FieldInfo> const& known) {
  auto const found = std::ranges::find(known, name, &observe::FieldInfo::name);
  if (found == known.end()) throw InputError("unknown field \"" + name + "\"");
  return {found->name, found->unit, found->components, found->meaning};
}

}  // namespace

std::vector<FieldSpec> dumped_fields(run::Case const& setup, IsLast last) {
  if (setup.particles.any() && !setup.mpm_region) return {};
  std::vector<std::string> names = setup.output.fields;
  auto const add = [&names](char const* name) {
    if (std::ranges::find(names, name) == names.end()) names.emplace_back(name);
  };
  if (setup.output.peak_fields && last == IsLast::yes) {
    add("peak_overpressure");
    add("impulse");
  }
  if (!setup.obstacles.empty()) add("obstacle");
  if (setup.mpm_region) {
    add("region");
    if (setup.particles.any()) add("solid");
  }
  if (form_of_fields(setup) == DumpForm::vtkhdf) add("level");

  std::vector<FieldSpec> specs;
  specs.reserve(names.size());
  for (auto const& name : names) specs.push_back(spec_of(name, observe::known_fields()));
  return specs;
}

DumpForm form_of_fields(run::Case const& setup) { return setup.adaptive.any() ? DumpForm::vtkhdf : DumpForm::xdmf; }

std::vector<FieldSpec> dumped_particle_fields(run::Case const& setup) {
  std::vector<FieldSpec> specs;
  if (!setup.particles.any() && !(setup.mpm_region && setup.output.gas_particles)) return specs;
  auto const& standing = observe::standing_particle_fields();
  specs.reserve(standing.size() + setup.output.particle_fields.size());
  for (auto const& field : standing) specs.push_back(spec_of(field.name, standing));
  for (auto const& name : setup.output.particle_fields) {
    bool const already = std::ranges::find(specs, name, &FieldSpec::name) != specs.end();
    if (!already) specs.push_back(spec_of(name, observe::known_particle_fields()));
  }
  return specs;
}

std::vector<double> dump_times(run::Output const& output, double end_time) {
  std::vector<double> times{0.0, end_time};
  if (output.field_interval > 0.0) {
    for (long n = 1; static_cast<double>(n) * output.field_interval < end_time; ++n) {
      times.push_back(static_cast<double>(n) * output.field_interval);
    }
  }
  for (double const t : output.field_times) {
    if (t <= end_time) times.push_back(t);
  }
  std::sort(times.begin(), times.end());
  double const slack = 1e-9 * end_time;
  times.erase(std::unique(times.begin(), times.end(), [slack](double a, double b) { return b - a <= slack; }),
              times.end());
  times.back() = end_time;
  return times;
}

Writer::Writer(run::World const& world, observe::Gauges const& gauges, fs::path const& folder,
               WriterOptions const& options)
    : histories_(&gauges),
      folder_(prepared(folder, world, gauges, options)),
      fields_(dumped_fields(world.setup, IsLast::no)),
      last_fields_(dumped_fields(world.setup, IsLast::yes)),
      particle_fields_(dumped_particle_fields(world.setup)),
      series_(folder_, {world.setup.output.single_precision, options.compression}, form_of_fields(world.setup)),
      particles_(folder_, {world.setup.output.single_precision, options.compression}),
      gauges_(folder_, gauges.gas, world.setup.ambient.state.pressure),
      particle_gauges_(folder_, world, gauges),
      begin_(std::chrono::steady_clock::now()),
      started_at_(fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))) {
  replace_file(folder_ / "deck.toml", world.setup.deck_text);
  write_log(world, "running", "", 0);
}

void Writer::dump(run::World const& world, IsLast last) {
  finish_dumps();
  std::vector<GatheredDump> dumps;
  if (!particle_fields_.empty()) {
    dumps.push_back(particles_.dump(
        world.clock.time, world.clock.step, world.setup.domain.geometry, observe::dumped_particles(world),
        particle_fields_,
        [&world](std::string const& field, std::vector<double>& out) { observe::particle_field(world, field, out); }));
  }
  if (world.gas != nullptr) dumps.push_back(gathered_fields(world, last, DumpPlace::next));
  write_later(world, std::move(dumps));
}

void Writer::dump_again(run::World const& world, IsLast last) {
  if (fields_.size() == last_fields_.size()) return;
  finish_dumps();
  std::vector<GatheredDump> dumps;
  dumps.push_back(gathered_fields(world, last, DumpPlace::again));
  write_later(world, std::move(dumps));
}

GatheredDump Writer::gathered_fields(run::World const& world, IsLast last, DumpPlace place) {
  if (world.bridge != nullptr) {
    if (view_ == nullptr) view_ = std::make_unique<observe::GasView>(world, world.bridge->region().cells());
    view_->update();
    view_->update_solids();
  }
  std::vector<FieldSpec> const& fields = last == IsLast::yes ? last_fields_ : fields_;
  std::vector<std::string> names;
  names.reserve(fields.size());
  for (FieldSpec const& field : fields) names.push_back(field.name);
  observe::FieldValues const values(world, names, view_.get());
  return series_.dump(
      world.clock.time, world.clock.step, world.grid, fields,
      [&values](grid::Cell const& first, int count, double* out) { values.row(first, count, out); }, place);
}

void Writer::write_later(run::World const& world, std::vector<GatheredDump> dumps) {
  for (GatheredDump const& one : dumps) under_way_.push_back(one.dump);
  int const count = std::max(series_.series().count(), particles_.series().count());
  queue_.add([this, dumps = std::move(dumps), log = log_text(world, "running", "", 0, count)] {
    for (GatheredDump const& one : dumps) one.write();
    replace_file(folder_ / "run.json", log);
  });
}

void Writer::finish_dumps() {
  // The calculation waits: its threads may as well help.
  for (auto const& dump : under_way_) parallel_for(threads(), [&dump](int, int) { dump->compress(); });
  queue_.finish();
  under_way_.clear();
}

Writer::~Writer() = default;

void Writer::append_gauges() {
  gauges_.append(histories_->gas);
  particle_gauges_.append(*histories_);
}

void Writer::archive(Archive& a, run::World const& world) {
  a.section("output");
  double wall = wall_seconds();
  a(series_, particles_, started_at_, wall, resumed_at_);
  constexpr double longest = 1e10;  // s, beyond all runs
  a.require(wall >= 0.0 && wall < longest, "the time by the clock");
  if (!a.reading()) return;
  using Duration = std::chrono::steady_clock::duration;
  begin_ = std::chrono::steady_clock::now() - std::chrono::duration_cast<Duration>(std::chrono::duration<double>(wall));
  resumed_at_.push_back(world.clock.step);
  drop_summary(folder_);
  append_gauges();  // their files are new
  write_log(world, "running", "", 0);
}

double Writer::wall_seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void Writer::finish(run::World const& world, std::string const& end_reason, int exit_code) {
  finish_dumps();
  append_gauges();
  if (world.gas == nullptr) {
    write_particle_summary(folder_, world, *histories_, particle_gauges_.names());
  } else {
    nlohmann::json more = world.particles == nullptr ? nlohmann::json::object()
                                                     : write_particle_table(folder_ / "bodies.csv", world, *histories_,
                                                                            particle_gauges_.names());
    if (world.setup.afterburn) more["afterburn_energy"] = json_or_null(world.audit.afterburn_energy);
    if (world.panels != nullptr) more["panels"] = panels_json(world.panels->reports());
    if (!world.starts.empty()) more["starts"] = starts(world);
    write_summary(folder_, world.setup, observe::summarise(world.setup, histories_->gas), gauges_.names(), more);
  }
  if (exit_code == 0 && world.setup.output.profile) write_end_profile(world, folder_);
  close(world, end_reason, exit_code);
}

void Writer::close(run::World const& world, std::string const& end_reason, int exit_code) {
  queue_.settle();
  tidy_list(folder_);
  write_log(world, exit_code == 0 ? "done" : "stopped", end_reason, exit_code);
}

std::string Writer::log_text(run::World const& world, std::string const& status, std::string const& end_reason,
                             int exit_code, int dumps) const {
  auto const log = run_log(world, {status, end_reason, exit_code, started_at_, wall_seconds(), dumps, resumed_at_});
  // A deck or a title may hold bytes that are not UTF-8: they are replaced, the log stays valid JSON.
  return log.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void Writer::write_log(run::World const& world, std::string const& status, std::string const& end_reason,
                       int exit_code) {
  replace_file(folder_ / "run.json", log_text(world, status, end_reason, exit_code, dump_count()));
}

}  // namespace brisance::output
