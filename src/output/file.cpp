#include "output/file.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "core/error.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

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
    AppendedFile file(temporary);
    file.append(content);
    file.close();
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

AppendedFile::AppendedFile(fs::path path) : path_(std::move(path)), file_(std::fopen(path_.c_str(), "wb")) {
  if (!file_) throw_io_error("create", path_, errno);
}

void AppendedFile::append(std::string_view text) {
  bool const written = std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size();
  if (!written || std::fflush(file_.get()) != 0) throw_io_error("write", path_, errno);
}

void AppendedFile::close() {
  if (std::fclose(file_.release()) != 0) throw_io_error("write", path_, errno);
}

}  // namespace brisance::output
