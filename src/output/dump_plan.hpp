/// What the dumps of a case hold, when they are written, and how large they are.
#pragma once

#include <string>
#include <vector>

#include "case/case.hpp"
#include "output/field_spec.hpp"
#include "output/folder.hpp"

namespace brisance::output {

/// Is a dump the last one of its run?
enum class IsLast { no, yes };

/// The fields of the gas that the dumps of a case hold: the specified ones, in the last dump the peak fields where
/// asked, the obstacle mask where there are obstacles, region and solid where there is an MPM region, the level where
/// there are several. None without gas.
/// Throws InputError for an unknown name.
[[nodiscard]] std::vector<FieldSpec> dumped_fields(run::Case const& setup, IsLast last);

/// Those of material points: position, body, material and the specified ones. None where no particles are dumped.
/// Throws InputError for an unknown name.
[[nodiscard]] std::vector<FieldSpec> dumped_particle_fields(run::Case const& setup);

/// What the field dumps of a case are.
[[nodiscard]] DumpForm form_of_fields(run::Case const& setup);

/// Times at which the fields of the whole domain are written [s], rising: 0, the multiples of `field_interval`,
/// `field_times`, and the end; none where subsets alone are written. Times closer than 1e-9 of the end time are one.
[[nodiscard]] std::vector<double> dump_times(run::Output const& output, double end_time);

/// "subsets/NAME": the kind of the dumps of a subset.
[[nodiscard]] std::string subset_kind(run::FieldSubset const& subset);

/// The fields that its dumps hold: the specified ones, else those of the whole domain.
/// Throws InputError for an unknown name.
[[nodiscard]] std::vector<FieldSpec> dumped_fields(run::Case const& setup, run::FieldSubset const& subset);

/// Times at which each subset is written [s], rising: 0, the multiples of its interval, and the end. Where one is
/// closer than 1e-9 of the end time to one of the dumps of the whole domain, or of a subset before it, it is the same.
[[nodiscard]] std::vector<std::vector<double>> subset_times(run::Case const& setup);

/// Bytes of one dump of each subset without compression, estimated where cells have several sizes.
/// `cells_of_level`: in the whole domain.
[[nodiscard]] std::vector<double> subset_bytes(run::Case const& setup, std::vector<double> const& cells_of_level);

}  // namespace brisance::output
