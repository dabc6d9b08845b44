/// Files whose every write is checked. All functions throw IoError naming the file and the system's reason.
///
/// Nothing is written through a link: neither where the file is one nor where the folder that it lies in is one.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace brisance::output {

/// IoError "cannot WHAT "path": reason", the reason taken from `error_number` (an errno value).
[[noreturn]] void throw_io_error(std::string_view what, std::filesystem::path const& path, int error_number);

/// IoError that says that the path is a link and what to do.
[[noreturn]] void refuse_link(std::filesystem::path const& path);

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// Creates a file, in place of one that is there, to be written.
[[nodiscard]] File create_file(std::filesystem::path const& path);

/// Makes one folder below an existing one, where it does not exist.
void make_folder(std::filesystem::path const& folder);

/// The whole file as text.
[[nodiscard]] std::string read_file(std::filesystem::path const& path);

/// Replaces the file in one step: a reader sees the old or the new content, never a part.
void replace_file(std::filesystem::path const& path, std::string_view content);

/// Renames a finished temporary file to its final name.
void rename_file(std::filesystem::path const& from, std::filesystem::path const& to);

/// Creates the file, in place of one that is there, and writes the content.
void write_file(std::filesystem::path const& path, std::string_view content);

/// Appends to a file and closes it, so that an interrupted run keeps the text and any number of files may grow.
void append_to_file(std::filesystem::path const& path, std::string_view text);

}  // namespace brisance::output
