#include "output/subsets.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "observe/gas_fields.hpp"
#include "output/level_fields.hpp"
#include "output/plane_fields.hpp"
#include "run/world.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

Subsets::Subset::Subset(run::Case const& setup, run::FieldSubset const& subset, std::vector<double> when,
                        fs::path const& folder)
    : name(subset.name),
      place(subset.place),
      cells(subset, setup.domain, setup.adaptive.finest),
      fields(dumped_fields(setup, subset)),
      times(std::move(when)),
      series(folder, subset_kind(subset), DumpForm::vtkhdf) {}

Subsets::Subsets(run::Case const& setup, fs::path const& folder, FieldOptions options)
    : folder_(folder), options_(options) {
  auto const times = subset_times(setup);
  for (std::size_t n = 0; n < times.size(); ++n) all_.emplace_back(setup, setup.output.subsets[n], times[n], folder);
}

void Subsets::Subset::pass(double time) {
  while (next < times.size() && times[next] <= time) ++next;
}

double Subsets::next() const {
  double earliest = std::numeric_limits<double>::infinity();
  for (Subset const& subset : all_) {
    if (subset.next < subset.times.size()) earliest = std::min(earliest, subset.times[subset.next]);
  }
  return earliest;
}

std::vector<GatheredDump> Subsets::dump(run::World const& world, IsLast last, observe::GasView const* view) {
  std::vector<GatheredDump> dumps;
  DumpMoment const moment{world.clock.time, world.clock.step};
  for (Subset& subset : all_) {
    bool const due = subset.next < subset.times.size() && subset.times[subset.next] <= moment.time;
    if (!due && !(last == IsLast::yes && subset.step != moment.step)) continue;
    subset.pass(moment.time);
    subset.step = moment.step;
    std::vector<std::string> names;
    for (FieldSpec const& field : subset.fields) names.push_back(field.name);
    observe::FieldValues const values(world, names, view);
    RowValues const rows = [&values](grid::Cell const& first, int count, double* out) {
      values.row(first, count, out);
    };
    auto const* plane = std::get_if<run::Plane>(&subset.place);
    auto dump = plane == nullptr
                    ? box_dump(moment, world.grid, subset.cells, subset.fields, options_, rows)
                    : plane_dump(moment, world.grid, subset.cells, plane->at, subset.fields, options_, rows);
    dumps.push_back(subset.series.add(std::move(dump), DumpPlace::next, [&moment](std::string const& file) {
      return level_index_entry(file, moment.time);
    }));
  }
  return dumps;
}

void Subsets::archive(Archive& a, double time) {
  std::vector<std::string> names;
  for (Subset const& subset : all_) names.push_back(subset.name);
  a(names);
  for (std::string const& name : names) {
    auto const own = std::ranges::find(all_, name, &Subset::name);
    if (own != all_.end()) {
      a(own->step, own->series);
    } else {
      a.require(name.find('/') == std::string::npos, "the name of a subset");
      run::FieldSubset gone;
      gone.name = name;
      long step = 0;
      DumpSeries series(folder_, subset_kind(gone), DumpForm::vtkhdf);
      a(step, series);
    }
  }
  if (!a.reading()) return;
  for (Subset& subset : all_) subset.pass(time);
}

}  // namespace brisance::output
