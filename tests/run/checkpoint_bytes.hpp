/// A world as the bytes of a checkpoint, and back.
#pragma once

#include <cstring>
#include <string>

#include "core/archive.hpp"

namespace brisance::run {

template <class World>
std::string written(World& world) {
  std::string bytes;
  Archive a([&](void const* from, std::size_t count) { bytes.append(static_cast<char const*>(from), count); });
  world.archive(a);
  return bytes;
}

template <class World>
void read(World& world, std::string const& bytes) {
  Archive a(
      [&, at = std::size_t{0}](void* to, std::size_t count) mutable {
        std::memcpy(to, bytes.data() + at, count);
        at += count;
      },
      bytes.size());
  world.archive(a);
  a.end();
}

}  // namespace brisance::run
