/// The list of the files that runs have written into a folder, `files.txt`: one path a line, relative to the folder.
///
/// A file is listed before it is created, so that whatever ends a run, its list is complete. A name may stand there
/// twice, and a listed file need not exist (any more).
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace brisance::output {

inline constexpr char const* manifest_name = "files.txt";

/// The listed files that a run may have written; lines that lead anywhere else are passed over. Empty without a list.
[[nodiscard]] std::set<std::string> listed_files(std::filesystem::path const& folder);

/// Adds files to the list.
void list_files(std::filesystem::path const& folder, std::vector<std::string> const& names);

/// Replaces the list.
void replace_list(std::filesystem::path const& folder, std::set<std::string> const& names);

/// Is it a file itself, neither a link nor reached through one?
[[nodiscard]] bool is_own_file(std::filesystem::path const& folder, std::string const& name);

}  // namespace brisance::output
