/// The output folder: refused before the run starts where it cannot serve.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace brisance::output {

/// What becomes of the results that the folder holds already.
enum class Earlier {
  refuse,   ///< the run does not start
  replace,  ///< they are removed, and nothing else
  keep,     ///< the run goes on with them
};

/// Makes the folder ready for a run's results.
///
/// Creates it (with its parents) where it does not exist and proves by a trial file that it can be written. Throws
/// IoError when it holds the results of another run and `earlier` refuses them, and when less than `needed_bytes` are
/// free on its file system.
void prepare_folder(std::filesystem::path const& folder, Earlier earlier, double needed_bytes);

/// The dumps of a kind ("fields" or "points") that the folder holds, with their numbers, unfinished ones included.
[[nodiscard]] std::vector<std::pair<int, std::filesystem::path>> dumps_of(std::filesystem::path const& folder,
                                                                          std::string const& kind);

/// Removes what only the end of a run writes: summary and report.
void drop_summary(std::filesystem::path const& folder);

}  // namespace brisance::output
