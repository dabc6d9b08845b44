#include "output/checkpoint.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "core/error.hpp"
#include "output/file.hpp"
#include "output/folder.hpp"
#include "output/manifest.hpp"

namespace brisance::output {

namespace fs = std::filesystem;

namespace {

/// Changes with every change of what the archive holds.
constexpr std::uint32_t format_version = 13;

/// The line break shows a transfer that takes the file for text.
constexpr std::string_view magic = "BRISANCE STATE\r\n";
constexpr std::size_t at_version = magic.size();
constexpr std::size_t at_checksum = at_version + 4;
constexpr std::size_t at_size = at_checksum + 4;
constexpr std::size_t at_header_checksum = at_size + 8;
constexpr std::size_t header_size = at_header_checksum + 4;

constexpr std::size_t stream_buffer = 1U << 20U;

using Header = std::array<char, header_size>;

template <class T>
void put(Header& header, std::size_t at, T value) {
  std::memcpy(header.data() + at, &value, sizeof value);
}

template <class T>
T get(Header const& header, std::size_t at) {
  T value{};
  std::memcpy(&value, header.data() + at, sizeof value);
  return value;
}

File buffered(File file) {
  std::setvbuf(file.get(), nullptr, _IOFBF, stream_buffer);
  return file;
}

File opened(fs::path const& path) {
  File file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) throw_io_error("open", path, errno);
  return buffered(std::move(file));
}

void write(std::FILE* file, void const* bytes, std::size_t count, fs::path const& path) {
  if (std::fwrite(bytes, 1, count, file) != count) throw_io_error("write", path, errno);
}

[[noreturn]] void refuse(fs::path const& path, std::string const& why) {
  throw IoError(fmt::format("the checkpoint \"{}\" cannot be used: {}", path.string(), why));
}

/// Opens a checkpoint to read it; what is no file, a pipe for one, could keep the program waiting for ever.
File opened_to_read(fs::path const& path) {
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) refuse(path, "it is not a regular file");
  return opened(path);
}

void archive_info(Archive& a, CheckpointInfo& info) {
  a.section("checkpoint");
  a(info.program, info.deck, info.step, info.time);
}

/// A rename stands only when the folder is on the disk.
void flush_folder(fs::path const& folder) {
  int const descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

void write_part(fs::path const& part, CheckpointInfo& info, ArchiveState const& state) {
  File file = buffered(create_file(part));
  Header header{};
  write(file.get(), header.data(), header.size(), part);
  std::uint32_t sum = 0;
  Archive archive([&](void const* bytes, std::size_t count) {
    sum = checksum(bytes, count, sum);
    write(file.get(), bytes, count, part);
  });
  archive_info(archive, info);
  state(archive);
  std::copy(magic.begin(), magic.end(), header.begin());
  put(header, at_version, format_version);
  put(header, at_checksum, sum);
  put(header, at_size, archive.position());
  put(header, at_header_checksum, checksum(header.data(), at_header_checksum));
  if (std::fseek(file.get(), 0, SEEK_SET) != 0) throw_io_error("write", part, errno);
  write(file.get(), header.data(), header.size(), part);
  if (std::fflush(file.get()) != 0 || ::fsync(fileno(file.get())) != 0) throw_io_error("write", part, errno);
  if (std::fclose(file.release()) != 0) throw_io_error("write", part, errno);
}

struct Numbered {
  long step = 0;
  fs::path path;
};

/// The checkpoints of the folder, the newest first.
std::vector<Numbered> listed(fs::path const& folder) {
  constexpr std::string_view prefix = "checkpoint_";
  constexpr std::string_view suffix = ".brz";
  std::vector<Numbered> found;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    std::string const name = entry->path().filename().string();
    if (!name.starts_with(prefix) || !name.ends_with(suffix)) continue;
    char const* const last = name.data() + name.size() - suffix.size();
    long step = 0;
    auto const parsed = std::from_chars(name.data() + prefix.size(), last, step);
    if (parsed.ec == std::errc{} && parsed.ptr == last) found.push_back({step, entry->path()});
  }
  std::ranges::sort(found, std::ranges::greater{}, &Numbered::step);
  return found;
}

}  // namespace

std::string program_build() { return BRISANCE_VERSION " " BRISANCE_COMPILER " " BRISANCE_COMPILER_FLAGS; }

double state_bytes(ArchiveState const& state) {
  Archive archive([](void const* /*bytes*/, std::size_t /*count*/) {});
  state(archive);
  return static_cast<double>(archive.position());
}

void write_checkpoint(fs::path const& path, CheckpointInfo info, ArchiveState const& state) {
  std::error_code error;
  make_folder(path.parent_path());
  fs::path const part = path.parent_path() / "checkpoint.part";
  info.program = program_build();
  try {
    write_part(part, info, state);
  } catch (...) {
    fs::remove(part, error);
    throw;
  }
  rename_file(part, path);
  flush_folder(path.parent_path());
}

CheckpointReader::CheckpointReader(fs::path path) : path_(std::move(path)), file_(opened_to_read(path_)) {
  std::error_code error;
  auto const size = fs::file_size(path_, error);
  if (error) throw_io_error("read", path_, error.value());
  if (size < header_size) {
    refuse(path_, fmt::format("it is truncated: it has {} bytes, but the header alone needs {}", size, header_size));
  }
  auto const read = [this](void* bytes, std::size_t count) {
    if (std::fread(bytes, 1, count, file_.get()) == count) return;
    throw_io_error("read", path_, std::ferror(file_.get()) != 0 ? errno : EIO);
  };
  Header header{};
  read(header.data(), header.size());
  if (!std::equal(magic.begin(), magic.end(), header.begin()))
    refuse(path_, "it is damaged or not a checkpoint: it does not begin with \"BRISANCE STATE\"");
  std::uint32_t const header_sum = checksum(header.data(), at_header_checksum);
  if (auto const said = get<std::uint32_t>(header, at_header_checksum); said != header_sum)
    refuse(path_, fmt::format("its header is damaged: checksum {:08x}, stored checksum {:08x}", header_sum, said));
  if (auto const version = get<std::uint32_t>(header, at_version); version != format_version) {
    refuse(
        path_,
        fmt::format("it has format {}, but this program ({}) reads format {}: continue with the program that wrote it",
                    version, BRISANCE_VERSION, format_version));
  }
  auto const said = get<std::uint64_t>(header, at_size);
  if (said != size - header_size) {
    refuse(path_, fmt::format("it is {}: it has {} bytes but should have {}",
                              said > size - header_size ? "truncated" : "too long", size, said + header_size));
  }

  std::vector<char> part(stream_buffer);
  std::uint32_t sum = 0;
  for (std::uint64_t left = said; left > 0;) {
    auto const count = static_cast<std::size_t>(std::min<std::uint64_t>(left, part.size()));
    read(part.data(), count);
    sum = checksum(part.data(), count, sum);
    left -= count;
  }
  if (auto const written = get<std::uint32_t>(header, at_checksum); written != sum)
    refuse(path_, fmt::format("its data are damaged: checksum {:08x}, stored checksum {:08x}", sum, written));

  if (std::fseek(file_.get(), header_size, SEEK_SET) != 0) throw_io_error("read", path_, errno);
  archive_.emplace(read, said);
  try {
    archive_info(*archive_, info_);
  } catch (IoError const& problem) {
    refuse(path_, problem.what());
  }
}

FoundCheckpoint newest_checkpoint(fs::path const& folder) {
  FoundCheckpoint found;
  for (auto const& candidate : listed(folder / "checkpoints")) {
    try {
      found.reader = std::make_unique<CheckpointReader>(candidate.path);
      return found;
    } catch (IoError const& problem) {
      found.refused.push_back(candidate.path);
      found.problems.emplace_back(problem.what());
    }
  }
  return found;
}

void put_aside(fs::path const& refused) {
  fs::path const aside = refused.string() + ".refused";
  list_files(refused.parent_path().parent_path(), {"checkpoints/" + aside.filename().string()});
  rename_file(refused, aside);
}

void CheckpointFiles::write_listed(std::string const& name, CheckpointInfo const& info, ArchiveState const& state) {
  list_files(folder_.parent_path(), {"checkpoints/checkpoint.part", "checkpoints/" + name});
  write_checkpoint(folder_ / name, info, state);
}

void CheckpointFiles::write(CheckpointInfo const& info, ArchiveState const& state) {
  write_listed(fmt::format("checkpoint_{:08d}.brz", info.step), info, state);
  auto all = listed(folder_);
  auto const files = listed_files(folder_.parent_path());
  std::erase_if(all,
                [&](Numbered const& one) { return !files.contains("checkpoints/" + one.path.filename().string()); });
  for (std::size_t n = static_cast<std::size_t>(keep_); n < all.size(); ++n) {
    std::error_code error;
    fs::remove(all[n].path, error);
    if (error) throw_io_error("remove", all[n].path, error.value());
  }
  // The list is read for each checkpoint: those that have gone shall not make it long.
  constexpr long tidy_interval = 100;
  if (++written_ % tidy_interval == 0) tidy_list(folder_.parent_path(), "checkpoints/");
}

void CheckpointFiles::write_stopped(CheckpointInfo const& info, ArchiveState const& state) {
  write_listed("stopped.brz", info, state);
}

}  // namespace brisance::output
