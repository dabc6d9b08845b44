/// The HTML report of a finished or running simulation, drawn by Python with matplotlib.
#pragma once

#include <filesystem>

namespace brisance::output {

/// Do the report's slices show the outlines of the grid's blocks?
enum class Outlines { no, yes };

/// Writes `report.html` into a run's output folder and returns its path.
///
/// The interpreter is the one found when the program was built, or the one that the environment variable
/// BRISANCE_PYTHON names. Throws IoError when the folder holds no run, or when Python or one of its packages is
/// missing.
std::filesystem::path write_report(std::filesystem::path const& folder, Outlines blocks = Outlines::no);

}  // namespace brisance::output
