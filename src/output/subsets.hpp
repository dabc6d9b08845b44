/// Subsets of the field output: planes and boxes, each a series of its own at times of its own.
///
///     subsets/NAME.hdf.series    list of the dumps of a subset, opens in ParaView
///     subsets/NAME_NNNNNN.hdf    one dump: of a box see level_fields.hpp, of a plane see plane_fields.hpp
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "core/archive.hpp"
#include "observe/gas_view.hpp"
#include "observe/subset_cells.hpp"
#include "output/dump_plan.hpp"
#include "output/dump_series.hpp"
#include "output/fields.hpp"

namespace brisance::run {
class World;
}

namespace brisance::output {

class Subsets {
 public:
  /// Writes into `folder` (which exists). Nothing is created before the first dump.
  Subsets(run::Case const& setup, std::filesystem::path const& folder, FieldOptions options);

  /// The earliest time at which one is still to be written [s]; infinity: none is.
  [[nodiscard]] double next() const;
  /// Gathers those whose time has come; the `last` dumps of a run are those of all that do not hold its state yet.
  [[nodiscard]] std::vector<GatheredDump> dump(run::World const& world, IsLast last, observe::GasView const* view);

  /// What has been dumped, in a checkpoint. Reading drops the dumps that came after `time` [s], also of subsets that
  /// the case does not have any more; new ones begin with their next time.
  void archive(Archive& a, double time);

 private:
  struct Subset {
    Subset(run::Case const& setup, run::FieldSubset const& subset, std::vector<double> when,
           std::filesystem::path const& folder);
    void pass(double time);

    std::string name;
    std::variant<run::Plane, shape::Box> place;
    observe::SubsetCells cells;
    std::vector<FieldSpec> fields;
    std::vector<double> times;  ///< [s]
    DumpSeries series;
    std::size_t next = 0;  ///< of `times`
    long step = -1;        ///< of the last dump
  };

  std::filesystem::path folder_;
  FieldOptions options_;
  std::deque<Subset> all_;  ///< a series is written from where it stands
};

}  // namespace brisance::output
