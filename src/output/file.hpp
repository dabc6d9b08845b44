/// Files whose every write is checked. All functions throw IoError naming the file and the system's reason.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
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

/// A text file that grows while the run lasts.
class AppendedFile {
 public:
  /// Creates the file, empty.
  explicit AppendedFile(std::filesystem::path path);
  /// Appends and hands the text to the operating system, so that an interrupted run keeps it.
  void append(std::string_view text);
  /// Closes the file; some file systems report a failed write only now.
  void close();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace brisance::output
