#include "output/dump_plan.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "observe/gas_fields.hpp"
#include "observe/particle_fields.hpp"
#include "observe/subset_cells.hpp"
#include "output/fields.hpp"
#include "output/plane_fields.hpp"

namespace brisance::output {

namespace {

FieldSpec spec_of(std::string const& name, std::vector<observe::FieldInfo> const& known) {
  auto const found = std::ranges::find(known, name, &observe::FieldInfo::name);
  if (found == known.end()) throw InputError("unknown field \"" + name + "\"");
  return {found->name, found->unit, found->components, found->meaning};
}

}  // namespace

std::vector<FieldSpec> dumped_fields(run::Case const& setup, IsLast last) {
  if (setup.particles.any() && !setup.has_regions()) return {};
  std::vector<std::string> names = setup.output.fields;
  auto const add = [&names](char const* name) {
    if (std::ranges::find(names, name) == names.end()) names.emplace_back(name);
  };
  if (setup.output.peak_fields && last == IsLast::yes) {
    add("peak_overpressure");
    add("impulse");
  }
  if (!setup.obstacles.empty()) add("obstacle");
  if (setup.has_regions()) {
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
  if (!setup.particles.any() && !(setup.has_regions() && setup.output.gas_particles)) return specs;
  auto const& standing = observe::standing_particle_fields();
  specs.reserve(standing.size() + setup.output.particle_fields.size());
  for (auto const& field : standing) specs.push_back(spec_of(field.name, standing));
  for (auto const& name : setup.output.particle_fields) {
    bool const already = std::ranges::find(specs, name, &FieldSpec::name) != specs.end();
    if (!already) specs.push_back(spec_of(name, observe::known_particle_fields()));
  }
  return specs;
}

namespace {

/// Times closer than this are one [s].
double slack_of(double end_time) { return 1e-9 * end_time; }

/// 0, the multiples of an interval, others up to the end, and the end.
std::vector<double> times_of(double interval, std::vector<double> const& others, double end_time) {
  std::vector<double> times{0.0, end_time};
  if (interval > 0.0) {
    for (long n = 1; static_cast<double>(n) * interval < end_time; ++n)
      times.push_back(static_cast<double>(n) * interval);
  }
  for (double const t : others) {
    if (t <= end_time) times.push_back(t);
  }
  std::sort(times.begin(), times.end());
  times.erase(
      std::unique(times.begin(), times.end(), [end_time](double a, double b) { return b - a <= slack_of(end_time); }),
      times.end());
  times.back() = end_time;
  return times;
}

}  // namespace

std::vector<double> dump_times(run::Output const& output, double end_time) {
  if (!output.whole) return {};
  return times_of(output.field_interval, output.field_times, end_time);
}

std::string subset_kind(run::FieldSubset const& subset) { return "subsets/" + subset.name; }

std::vector<FieldSpec> dumped_fields(run::Case const& setup, run::FieldSubset const& subset) {
  if (subset.fields.empty()) return dumped_fields(setup, IsLast::no);
  std::vector<FieldSpec> specs;
  specs.reserve(subset.fields.size());
  for (auto const& name : subset.fields) specs.push_back(spec_of(name, observe::known_fields()));
  return specs;
}

std::vector<std::vector<double>> subset_times(run::Case const& setup) {
  double const slack = slack_of(setup.end.time);
  std::vector<double> known = dump_times(setup.output, setup.end.time);
  std::vector<std::vector<double>> times;
  for (run::FieldSubset const& subset : setup.output.subsets) {
    times.push_back(times_of(subset.interval, {}, setup.end.time));
    std::vector<double> fresh;
    for (double& time : times.back()) {
      // Steps to two times that are all but the same would be hardly any apart.
      auto const old = std::ranges::lower_bound(known, time - slack);
      if (old != known.end() && *old <= time + slack)
        time = *old;
      else
        fresh.push_back(time);
    }
    known.insert(known.end(), fresh.begin(), fresh.end());
    std::ranges::sort(known);
  }
  return times;
}

std::vector<double> subset_bytes(run::Case const& setup, std::vector<double> const& cells_of_level) {
  std::vector<double> bytes;
  for (run::FieldSubset const& subset : setup.output.subsets) {
    observe::SubsetCells const shown(subset, setup.domain, setup.adaptive.finest);
    double const cells = shown.count(cells_of_level);
    double const places = shown.normal() < 0 ? 0.0 : cells * plane_bytes_per_cell(setup.domain.dimensions());
    bytes.push_back(places +
                    FieldSeries::bytes_per_dump(cells, dumped_fields(setup, subset), setup.output.single_precision));
  }
  return bytes;
}

}  // namespace brisance::output
