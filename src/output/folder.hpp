/// The output folder: refused before the run starts where it cannot serve.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace brisance::output {

/// What becomes of the results that the folder holds already.
enum class Earlier {
  refuse,   ///< the run does not start
  replace,  ///< they are removed, and nothing else
  keep,     ///< the run goes on with them
};

/// What a run will write: paths relative to the folder.
struct Written {
  std::vector<std::string> first;  ///< before anything else, or named in advance
  std::vector<std::string> later;  ///< may come, and is listed when it does
};

/// The folder that a path leads to: itself unless it is a link. What is written below is written through no link.
[[nodiscard]] std::filesystem::path real_folder(std::filesystem::path folder);

/// Creates a folder with its parents.
void create_folder(std::filesystem::path const& folder);

/// Makes the folder ready for a run's results.
///
/// Creates it (with its parents) where it does not exist and proves by a trial file that it can be written. Results of
/// an earlier run are the files of its list (manifest.hpp): they refuse the run, or go, or stay, as `earlier` says; no
/// other file is touched. Throws IoError when they refuse it, when a file of somebody else, or a link, stands where
/// the run will write, and when less than `needed_bytes` are free on its file system; `how_estimated` is told with
/// them.
void prepare_folder(std::filesystem::path const& folder, Earlier earlier, double needed_bytes,
                    Written const& written = {}, std::string const& how_estimated = "");

/// What the files of a series of dumps are, and the index by which ParaView opens them.
enum class DumpForm {
  xdmf,    ///< HDF5, `.h5`, with an index `.xmf2`
  vtkhdf,  ///< HDF5 of the VTKHDF layout, `.hdf`, with a list of files and times, `.hdf.series`
};

/// "fields/fields_000012.h5": a dump of a kind ("fields" or "points"); "subsets/street_000012.hdf": of the subset
/// "subsets/street".
[[nodiscard]] std::string dump_name(std::string const& kind, int number, DumpForm form = DumpForm::xdmf);
/// Its number; nothing for other names.
[[nodiscard]] std::optional<int> dump_number(std::string const& kind, std::string const& name,
                                             DumpForm form = DumpForm::xdmf);
/// "fields.xmf2": the index of a kind.
[[nodiscard]] std::string index_name(std::string const& kind, DumpForm form = DumpForm::xdmf);

/// Removes a file that is listed in the folder, and its unfinished form, where they are files and not links.
void remove_listed(std::filesystem::path const& folder, std::string const& name);

/// Removes what only the end of a run writes: summary and report.
void drop_summary(std::filesystem::path const& folder);

/// Takes files off the folder's list that do not exist, of those whose names begin with `head`.
void tidy_list(std::filesystem::path const& folder, std::string const& head = "");

}  // namespace brisance::output
