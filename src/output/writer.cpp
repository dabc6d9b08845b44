#include "output/writer.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

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

/// Cells of each level that the dumps will have on average.
std::vector<double> expected_cells(run::World const& world) {
  if (form_of_fields(world.setup) == DumpForm::xdmf) return {static_cast<double>(world.setup.domain.cell_count())};
  std::vector<double> cells(static_cast<std::size_t>(world.grid.levels()), 0.0);
  for (grid::Block const& block : world.grid.blocks()) {
    cells[block.level] += expected_growth * uncovered_count(block);
  }
  return cells;
}

double expected_bytes(run::World const& world, WriterOptions const& options) {
  run::Case const& setup = world.setup;
  bool const single = setup.output.single_precision;
  std::vector<double> const cells = expected_cells(world);
  double dump = FieldSeries::bytes_per_dump(std::accumulate(cells.begin(), cells.end(), 0.0),
                                            dumped_fields(setup, IsLast::no), single);
  if (!world.regions.empty()) {
    dump += ParticleSeries::bytes_per_dump(static_cast<double>(observe::dumped_particles(world)),
                                           dumped_particle_fields(setup), single);
  }
  double dumps = dump * static_cast<double>(dump_times(setup.output, setup.end.time).size());
  auto const bytes = subset_bytes(setup, cells);
  auto const times = subset_times(setup);
  for (std::size_t n = 0; n < bytes.size(); ++n) dumps += bytes[n] * static_cast<double>(times[n].size());
  return dumps * expected_compression + options.checkpoint_bytes;
}

/// The files of a run. Dumps and checkpoints are listed when they come.
Written files_of(run::World const& world, observe::Gauges const& histories) {
  run::Case const& setup = world.setup;
  Written files{{"run.json", "deck.toml", "summary.csv", "summary.json"}, {"checkpoints/stopped.brz"}};
  auto const series = [&](std::string const& kind, DumpForm form, std::size_t dumps) {
    files.first.push_back(index_name(kind, form));
    // One more where the run is stopped between two.
    for (std::size_t n = 0; n <= dumps; ++n) files.later.push_back(dump_name(kind, static_cast<int>(n), form));
  };
  std::size_t const dumps = dump_times(setup.output, setup.end.time).size();
  if (world.gas != nullptr && dumps > 0) series("fields", form_of_fields(setup), dumps);
  if (!dumped_particle_fields(setup).empty() && dumps > 0) series("points", DumpForm::xdmf, dumps);
  auto const times = subset_times(setup);
  for (std::size_t n = 0; n < times.size(); ++n)
    series(subset_kind(setup.output.subsets[n]), DumpForm::vtkhdf, times[n].size());
  if (!world.regions.empty()) files.first.emplace_back("energies.csv");
  if (world.coupled()) files.first.emplace_back("bodies.csv");
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

}  // namespace

Writer::Writer(run::World const& world, observe::Gauges const& gauges, fs::path const& folder,
               WriterOptions const& options)
    : histories_(&gauges),
      folder_(prepared(folder, world, gauges, options)),
      fields_(dumped_fields(world.setup, IsLast::no)),
      last_fields_(dumped_fields(world.setup, IsLast::yes)),
      particle_fields_(dumped_particle_fields(world.setup)),
      series_(folder_, {world.setup.output.single_precision, options.compression}, form_of_fields(world.setup)),
      particles_(folder_, {world.setup.output.single_precision, options.compression}),
      subsets_(world.setup, folder_, {world.setup.output.single_precision, options.compression}),
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
  observe::GasView const* const view = present_view(world);
  if (world.gas != nullptr) dumps.push_back(gathered_fields(world, last, DumpPlace::next, view));
  for (GatheredDump& subset : subsets_.dump(world, last, view)) dumps.push_back(std::move(subset));
  write_later(world, std::move(dumps));
}

void Writer::dump_subsets(run::World const& world, IsLast last) {
  finish_dumps();
  write_later(world, subsets_.dump(world, last, present_view(world)));
}

void Writer::dump_again(run::World const& world, IsLast last) {
  if (fields_.size() == last_fields_.size()) return;
  finish_dumps();
  std::vector<GatheredDump> dumps;
  dumps.push_back(gathered_fields(world, last, DumpPlace::again, present_view(world)));
  write_later(world, std::move(dumps));
}

observe::GasView const* Writer::present_view(run::World const& world) {
  if (!world.coupled()) return nullptr;
  if (view_ == nullptr) {
    std::vector<observe::PlacedCell> cells;
    for (run::Region const& of_world : world.regions) {
      bridge::Region const& region = of_world.bridge->region();
      for (Index3 const& cell : region.cells()) cells.push_back({region.level(), cell});
    }
    view_ = std::make_unique<observe::GasView>(world, cells);
  }
  view_->update();
  view_->update_solids();
  return view_.get();
}

GatheredDump Writer::gathered_fields(run::World const& world, IsLast last, DumpPlace place,
                                     observe::GasView const* view) {
  std::vector<FieldSpec> const& fields = last == IsLast::yes ? last_fields_ : fields_;
  std::vector<std::string> names;
  names.reserve(fields.size());
  for (FieldSpec const& field : fields) names.push_back(field.name);
  observe::FieldValues const values(world, names, view);
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
  subsets_.archive(a, world.clock.time);
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
    nlohmann::json more = world.regions.empty() ? nlohmann::json::object()
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
