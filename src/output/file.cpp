#include "output/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "core/error.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

File closing(std::FILE* file) { return {file, &std::fclose}; }

bool is_link(fs::path const& path) {
  std::error_code ignored;
  return fs::is_symlink(fs::symlink_status(path, ignored));
}

/// A folder held open, so that nobody puts a link in its place meanwhile.
class OpenFolder {
 public:
  explicit OpenFolder(fs::path const& folder, std::string_view what, fs::path const& file)
      : descriptor_(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC)) {
    if (descriptor_ >= 0) return;
    int const reason = errno;
    if (is_link(folder)) refuse_link(folder);
    throw_io_error(what, file, reason);
  }
  ~OpenFolder() { ::close(descriptor_); }
  OpenFolder(OpenFolder const&) = delete;
  OpenFolder& operator=(OpenFolder const&) = delete;
  [[nodiscard]] int at() const { return descriptor_; }

 private:
  int descriptor_;
};

/// Opens a file in its folder without following links. `how` are flags of open().
File opened(fs::path const& path, int how, char const* mode, std::string_view what) {
  fs::path const folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::string const name = path.filename().string();
  OpenFolder const opened(folder, what, path);
  struct stat there {};
  bool const exists = ::fstatat(opened.at(), name.c_str(), &there, AT_SYMLINK_NOFOLLOW) == 0;
  if (exists && S_ISLNK(there.st_mode)) refuse_link(path);
  if ((how & O_TRUNC) != 0 && exists && S_ISREG(there.st_mode)) {
    // A new file, not the old one emptied: another name of it (a hard link) keeps its content.
    if (::unlinkat(opened.at(), name.c_str(), 0) != 0) throw_io_error(what, path, errno);
    how |= O_EXCL;
  }
  // Without waiting for a reader, should it be a named pipe.
  int const descriptor = ::openat(opened.at(), name.c_str(), how | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, 0666);
  if (descriptor < 0) throw_io_error(what, path, errno);
  File file = closing(::fdopen(descriptor, mode));
  if (!file) {
    int const reason = errno;
    ::close(descriptor);
    throw_io_error(what, path, reason);
  }
  return file;
}

void write(File file, std::string_view text, fs::path const& path) {
  if (std::fwrite(text.data(), 1, text.size(), file.get()) != text.size()) throw_io_error("write", path, errno);
  // The last of the text goes out now, and some file systems report a failed write only now.
  if (std::fclose(file.release()) != 0) throw_io_error("write", path, errno);
}

}  // namespace

void refuse_link(fs::path const& path) {
  throw IoError(
      fmt::format("\"{}\" is a link, and the program does not write through links: remove it, or choose another folder "
                  "with --output",
                  path.string()));
}

File create_file(fs::path const& path) { return opened(path, O_WRONLY | O_CREAT | O_TRUNC, "wb", "create"); }

void make_folder(fs::path const& folder) {
  if (::mkdir(folder.c_str(), 0777) == 0) return;
  int const reason = errno;
  std::error_code ignored;
  if (is_link(folder)) refuse_link(folder);
  if (reason != EEXIST) throw_io_error("create", folder, reason);
  if (!fs::is_directory(fs::symlink_status(folder, ignored))) throw_io_error("create", folder, ENOTDIR);
}

void throw_io_error(std::string_view what, fs::path const& path, int error_number) {
  throw IoError(fmt::format("cannot {} \"{}\": {}", what, path.string(), std::strerror(error_number)));
}

std::string read_file(fs::path const& path) {
  File const file = closing(std::fopen(path.c_str(), "rb"));
  if (!file) throw_io_error("open", path, errno);
  std::string text;
  std::array<char, 65536> part{};
  std::size_t got = 0;
  while ((got = std::fread(part.data(), 1, part.size(), file.get())) > 0) text.append(part.data(), got);
  if (std::ferror(file.get()) != 0) throw_io_error("read", path, errno);
  return text;
}

void replace_file(fs::path const& path, std::string_view content) {
  fs::path const temporary = path.string() + ".part";
  try {
    write_file(temporary, content);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
  rename_file(temporary, path);
}

void rename_file(fs::path const& from, fs::path const& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) throw_io_error("write", to, error.value());
}

void write_file(fs::path const& path, std::string_view content) { write(create_file(path), content, path); }

void append_to_file(fs::path const& path, std::string_view text) {
  write(opened(path, O_WRONLY | O_CREAT | O_APPEND, "ab", "open"), text, path);
}

}  // namespace brisance::output
