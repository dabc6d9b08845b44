/// Everything that a run leaves in its output folder:
///
///     run.json            run log: versions, machine, steps, timings, audit, charges; rewritten during the run
///     files.txt           the list of all that runs have written here, see manifest.hpp
///     deck.toml           the deck as read
///     fields.xmf2         index of the field dumps, opens in ParaView; fields/fields_NNNNNN.h5
///     fields.hdf.series   the same of runs with cells of several sizes; fields/fields_NNNNNN.hdf
///     subsets/            planes and boxes of the fields, see subsets.hpp
///     points.xmf2         index of the dumps of the material points; points/points_NNNNNN.h5
///     gauges/NAME.csv     histories, growing during the run
///     energies.csv        energies of every body, growing during the run
///     checkpoints/        the whole state, see checkpoint.hpp
///     summary.csv, .json  peaks, arrivals, durations, impulses of the gauges beside Kingery-Bulmash; of material
///                         particles the displacements, velocities and energies
///     bodies.csv          of simulations with gas and bodies: what summary.csv holds of material points alone
#pragma once

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/archive.hpp"
#include "core/task_queue.hpp"
#include "observe/gas_view.hpp"
#include "observe/gauges.hpp"
#include "output/dump_plan.hpp"
#include "output/fields.hpp"
#include "output/folder.hpp"
#include "output/gauges.hpp"
#include "output/particle_gauges.hpp"
#include "output/particles.hpp"
#include "output/subsets.hpp"

namespace brisance::run {
class World;
}

namespace brisance::output {

struct WriterOptions {
  Earlier earlier = Earlier::refuse;  ///< what becomes of the results of an earlier run
  int compression = 1;                ///< gzip level of the fields, 0 to 9
  double checkpoint_bytes = 0.0;      ///< space that all checkpoints will take
};

class Writer {
 public:
  /// Prepares the folder and writes the deck and the first run log. Keeps a reference to the gauges. Throws IoError.
  Writer(run::World const& world, observe::Gauges const& gauges, std::filesystem::path const& folder,
         WriterOptions const& options = {});
  ~Writer();

  /// Gathers one dump of the gas fields, of the material points or of both, and those of subsets whose time has come,
  /// with the last one those of all subsets. A thread of its own writes them and brings the run log up to date; a dump
  /// before it is waited for. The last one of a run also holds the peak fields.
  void dump(run::World const& world, IsLast last);

  /// The same of subsets alone.
  void dump_subsets(run::World const& world, IsLast last);

  /// The earliest time at which a subset is still to be written [s]; infinity: none is.
  [[nodiscard]] double next_subset() const { return subsets_.next(); }

  /// Gathers the fields of the last dump again, from the same state, where the last one of a run holds others.
  void dump_again(run::World const& world, IsLast last);

  /// Throws what kept a dump from being written.
  void check() { queue_.check(); }

  /// Waits until all dumps are written. Throws what kept one from it.
  void finish_dumps();

  /// Appends what the gauges recorded since the last call.
  void append_gauges();

  /// Waits for the dumps, writes the rest of the gauges, the summary, the end profile of a run that is done, and at
  /// last the run log that says so. `end_reason` is one line for people.
  void finish(run::World const& world, std::string const& end_reason, int exit_code);

  /// Writes the last run log alone: of a run whose other results could not be written.
  void close(run::World const& world, std::string const& end_reason, int exit_code);

  /// What has been written, in a checkpoint; dumps must be finished. Reading makes the folder what it was when the
  /// checkpoint was written: later dumps and records go; the world must have been read before.
  void archive(Archive& a, run::World const& world);

  [[nodiscard]] std::filesystem::path const& folder() const { return folder_; }
  /// Dumps on the disk.
  [[nodiscard]] int dump_count() const { return std::max(series_.series().written(), particles_.series().written()); }

 private:
  /// The gas of an MPM region as it is now; null without one.
  [[nodiscard]] observe::GasView const* present_view(run::World const& world);
  [[nodiscard]] GatheredDump gathered_fields(run::World const& world, IsLast last, DumpPlace place,
                                             observe::GasView const* view);
  void write_later(run::World const& world, std::vector<GatheredDump> dumps);
  [[nodiscard]] double wall_seconds() const;
  [[nodiscard]] std::string log_text(run::World const& world, std::string const& status, std::string const& end_reason,
                                     int exit_code, int dumps) const;
  void write_log(run::World const& world, std::string const& status, std::string const& end_reason, int exit_code);

  observe::Gauges const* histories_;
  std::filesystem::path folder_;
  std::vector<FieldSpec> fields_;
  std::vector<FieldSpec> last_fields_;  ///< of the last dump
  std::vector<FieldSpec> particle_fields_;
  std::unique_ptr<observe::GasView> view_;  ///< of all cells, made with the first dump
  FieldSeries series_;
  ParticleSeries particles_;
  Subsets subsets_;
  GaugeFiles gauges_;
  ParticleGaugeFiles particle_gauges_;
  std::chrono::steady_clock::time_point begin_;
  std::string started_at_;
  std::vector<long> resumed_at_;  ///< steps at which the run was taken up again
  std::vector<std::shared_ptr<Dump>> under_way_;
  TaskQueue queue_{1};  ///< ends before what it writes from
};

}  // namespace brisance::output
