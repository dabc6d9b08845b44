/// Printing that does not throw: a closed terminal must not end a calculation. `main` checks at the end whether all of
/// it arrived.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace brisance::app {

template <class... Arguments>
void print(std::FILE* out, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  auto const text = fmt::format(format, std::forward<Arguments>(arguments)...);
  [[maybe_unused]] auto const written = std::fwrite(text.data(), 1, text.size(), out);
}

}  // namespace brisance::app
