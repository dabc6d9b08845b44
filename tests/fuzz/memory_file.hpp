/// What the fuzzers of binary readers share: a file in memory that has a path, and how seeds are written.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace brisance::fuzz {

/// The HDF5 library wants the true name of a file: one in the folder that Linux keeps in memory.
class MemoryFile {
 public:
  MemoryFile() : path_("/dev/shm/brisance_fuzz_XXXXXX"), descriptor_(::mkstemp(path_.data())) {
    if (descriptor_ < 0) std::abort();
  }
  ~MemoryFile() {
    ::close(descriptor_);
    ::unlink(path_.c_str());
  }
  MemoryFile(MemoryFile const&) = delete;
  MemoryFile& operator=(MemoryFile const&) = delete;

  [[nodiscard]] std::filesystem::path path() const { return path_; }
  void set(std::string_view bytes) {
    if (::ftruncate(descriptor_, 0) != 0) std::abort();
    for (std::size_t at = 0; at < bytes.size();) {
      auto const n = ::pwrite(descriptor_, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
      if (n <= 0) std::abort();
      at += static_cast<std::size_t>(n);
    }
  }

 private:
  std::string path_;
  int descriptor_;
};

/// Where seeds are to be written in place of fuzzing: the variable BRISANCE_FUZZ_SEEDS names the folder.
inline char const* seed_folder() { return std::getenv("BRISANCE_FUZZ_SEEDS"); }

inline void write_seed(std::string const& name, std::string_view bytes) {
  std::filesystem::create_directories(seed_folder());
  std::ofstream(std::filesystem::path(seed_folder()) / name, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// The bytes of an input, taken one after the other; 0 when there are no more.
class Bytes {
 public:
  Bytes(std::uint8_t const* data, std::size_t size) : data_(data), left_(size) {}
  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  template <class T>
  T value() {
    T out{};
    auto* to = reinterpret_cast<char*>(&out);
    for (std::size_t n = 0; n < sizeof out; ++n) to[n] = static_cast<char>(byte());
    return out;
  }
  [[nodiscard]] std::size_t left() const { return left_; }
  [[nodiscard]] std::string_view rest() const { return {reinterpret_cast<char const*>(data_), left_}; }

 private:
  std::uint8_t const* data_;
  std::size_t left_;
};

}  // namespace brisance::fuzz
