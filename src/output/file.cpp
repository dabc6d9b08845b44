#include "output/file.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "core/error.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

void write(fs::path const& path, std::string_view text, char const* mode, std::string_view what) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), mode), &std::fclose);
  if (!file) throw_io_error(what, path, errno);
  if (std::fwrite(text.data(), 1, text.size(), file.get()) != text.size()) throw_io_error("write", path, errno);
  // The last of the text goes out now, and some file systems report a failed write only now.
  if (std::fclose(file.release()) != 0) throw_io_error("write", path, errno);
}

}  // namespace

void throw_io_error(std::string_view what, fs::path const& path, int error_number) {
  throw IoError(fmt::format("cannot {} \"{}\": {}", what, path.string(), std::strerror(error_number)));
}

std::string read_file(fs::path const& path) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> const file(std::fopen(path.c_str(), "rb"), &std::fclose);
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

void write_file(fs::path const& path, std::string_view content) { write(path, content, "wb", "create"); }

void append_to_file(fs::path const& path, std::string_view text) { write(path, text, "ab", "open"); }

}  // namespace brisance::output
