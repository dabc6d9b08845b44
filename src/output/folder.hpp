/// The output folder: refused before the run starts where it cannot serve.
#pragma once

#include <filesystem>

namespace brisance::output {

/// Makes the folder ready for a run's results.
///
/// Creates it (with its parents) where it does not exist and proves by a trial file that it can be written. Throws
/// IoError when it holds the results of another run, unless `force` is set: then those results are removed, and nothing
/// else. Throws IoError when less than `needed_bytes` are free on its file system.
void prepare_folder(std::filesystem::path const& folder, bool force, double needed_bytes);

}  // namespace brisance::output
