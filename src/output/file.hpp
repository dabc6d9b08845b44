/// Files whose every write is checked. All functions throw IoError naming the file and the system's reason.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace brisance::output {

/// IoError "cannot WHAT "path": reason", the reason taken from `error_number` (an errno value).
[[noreturn]] void throw_io_error(std::string_view what, std::filesystem::path const& path, int error_number);

/// The whole file as text.
[[nodiscard]] std::string read_file(std::filesystem::path const& path);

/// Replaces the file in one step: a reader sees the old or the new content, never a part.
void replace_file(std::filesystem::path const& path, std::string_view content);

/// Renames a finished temporary file to its final name.
void rename_file(std::filesystem::path const& from, std::filesystem::path const& to);

/// Creates the file, or empties it, and writes the content.
void write_file(std::filesystem::path const& path, std::string_view content);

/// Appends to a file and closes it, so that an interrupted run keeps the text and any number of files may grow.
void append_to_file(std::filesystem::path const& path, std::string_view text);

}  // namespace brisance::output
