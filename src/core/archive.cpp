#include "core/archive.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>

#include "core/error.hpp"

namespace brisance {

static_assert(std::endian::native == std::endian::little, "archives hold numbers as little-endian machines do");

namespace {

constexpr std::uint32_t section_mark = 0x54434553;  ///< "SECT"

}  // namespace

std::uint32_t checksum(void const* bytes, std::size_t count, std::uint32_t before) {
  return static_cast<std::uint32_t>(crc32_z(before, static_cast<Bytef const*>(bytes), count));
}

void Archive::bytes(void* data, std::size_t count) {
  if (reading()) {
    if (count > left())
      throw IoError(fmt::format("its data end at byte {}, but {} more bytes were expected", size_, count - left()));
    if (count > 0) take_(data, count);
  } else if (count > 0) {
    put_(data, count);
  }
  position_ += count;
}

std::uint64_t Archive::counted(std::uint64_t count, std::size_t element) {
  std::uint64_t const at = position_;
  bytes(&count, sizeof count);
  if (reading() && count > left() / element)
    throw IoError(fmt::format("at byte {} of its data it declares {} elements, more than it can contain", at, count));
  return count;
}

void Archive::visit(std::string& text) {
  std::uint64_t const count = counted(text.size(), 1);
  if (reading()) text.resize(count);
  bytes(text.data(), count);
}

void Archive::section(std::string_view name) {
  std::uint64_t const at = position_;
  std::uint32_t mark = section_mark;
  (*this)(mark);
  if (mark != section_mark)
    throw IoError(
        fmt::format("section \"{1}\" should begin at byte {0} of its data, but something else was found", at, name));
  std::string found(name);
  (*this)(found);
  if (found != name)
    throw IoError(
        fmt::format("section \"{1}\" should begin at byte {0} of its data, but \"{2}\" was found", at, name, found));
}

void Archive::differs(std::string_view what) const {
  throw IoError(fmt::format("{} differs from the case as this program builds it", what));
}

void Archive::require(bool sound, std::string_view what) const {
  if (reading() && !sound)
    throw IoError(fmt::format("before byte {} of its data the value of {} is invalid", position_, what));
}

void Archive::end() const {
  if (reading() && left() > 0)
    throw IoError(fmt::format("its data should end at byte {} but continue to byte {}", position_, size_));
}

}  // namespace brisance
