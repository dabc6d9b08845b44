/// A binary archive: one function visits the members of an object, and writes or reads them, so that saving and loading
/// cannot diverge. Numbers lie there byte by byte as the (little-endian) machine holds them, and come back bit for bit.
///
/// A class has a member `void archive(Archive& a)`, a plain structure a function of its own namespace
/// `void archive(Archive& a, Structure& s)`; either lists the members: `a(s.time, s.pressure)`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace brisance {

/// Checksum of bytes, the CRC-32 of zlib; `before` is that of the bytes before them.
[[nodiscard]] std::uint32_t checksum(void const* bytes, std::size_t count, std::uint32_t before = 0);

class Archive {
 public:
  using Put = std::function<void(void const* bytes, std::size_t count)>;
  using Take = std::function<void(void* bytes, std::size_t count)>;

  /// An archive that hands everything to `put`, which throws where it cannot write.
  explicit Archive(Put put) : put_(std::move(put)) {}
  /// An archive that gets `size` bytes from `take`, which throws where it cannot read.
  Archive(Take take, std::uint64_t size) : take_(std::move(take)), size_(size) {}

  [[nodiscard]] bool reading() const { return static_cast<bool>(take_); }
  /// Bytes written or read so far.
  [[nodiscard]] std::uint64_t position() const { return position_; }
  /// Bytes that are left to read.
  [[nodiscard]] std::uint64_t left() const { return size_ - position_; }

  /// Visits values one after the other. Reading throws IoError where the archive holds something else.
  template <class... T>
  void operator()(T&... values) {
    (visit(values), ...);
  }

  /// `count` numbers without their count: the reader knows it.
  void numbers(double* values, std::size_t count) { bytes(values, count * sizeof(double)); }

  /// Begins a part of the archive. Reading throws IoError where another part, or none, begins there.
  void section(std::string_view name);

  /// A value that the reader must have arrived at by itself. Throws IoError where it has another.
  template <class T>
  void same(T const& own, std::string_view what) {
    T value = own;
    (*this)(value);
    if (!(value == own)) differs(what);
  }

  /// Values whose number the reader knows, because other things are counted by it. Throws IoError where the archive
  /// holds another number of them.
  template <class T>
  void sized(std::vector<T>& values, std::string_view what) {
    same(static_cast<std::uint64_t>(values.size()), what);
    for (T& value : values) visit(value);
  }

  /// Throws IoError unless what has been read makes sense; `what` says what does not.
  void require(bool sound, std::string_view what) const;

  /// After the last value. Throws IoError where the archive goes on.
  void end() const;

 private:
  template <class T>
  static constexpr bool plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

  template <class T>
  void visit(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      // No other byte than 0 and 1 may become a bool.
      std::uint8_t byte = value ? 1 : 0;
      bytes(&byte, 1);
      value = byte != 0;
    } else if constexpr (plain<T>) {
      bytes(&value, sizeof(T));
    } else if constexpr (requires { value.archive(*this); }) {
      value.archive(*this);
    } else {
      archive(*this, value);
    }
  }
  void visit(std::string& text);
  template <class T, std::size_t n>
  void visit(std::array<T, n>& values) {
    for (T& value : values) visit(value);
  }
  template <class T>
  void visit(std::vector<T>& values) {
    std::uint64_t const count = counted(values.size(), plain<T> ? sizeof(T) : 1);
    if constexpr (plain<T>) {
      if (reading()) values.resize(count);
      bytes(values.data(), count * sizeof(T));
    } else {
      // One at a time: the memory grows only with what is really there.
      if (reading()) values.clear();
      for (std::uint64_t n = 0; n < count; ++n) {
        if (reading()) values.emplace_back();
        visit(values[n]);
      }
    }
  }
  template <class T>
  void visit(std::map<std::string, T>& values) {
    std::uint64_t const count = counted(values.size(), 1);
    if (reading()) {
      values.clear();
      for (std::uint64_t n = 0; n < count; ++n) {
        std::string key;
        visit(key);
        visit(values[key]);
      }
    } else {
      for (auto& [key, value] : values) {
        std::string name = key;
        visit(name);
        visit(value);
      }
    }
  }

  void bytes(void* data, std::size_t count);
  /// The number of elements that follow, each of at least `element` bytes: no more than the archive can hold.
  [[nodiscard]] std::uint64_t counted(std::uint64_t count, std::size_t element);
  [[noreturn]] void differs(std::string_view what) const;

  Put put_;
  Take take_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
};

}  // namespace brisance
