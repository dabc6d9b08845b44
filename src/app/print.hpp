/// Printing that does not throw: a closed terminal must not end a simulation. `main` checks at the end whether all of
/// it arrived.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

namespace brisance::app {

/// Text of a deck reaches the terminal as text: a title or a name must not move the cursor or change colours.
inline std::string harmless(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](unsigned char c) { return (c < 0x20U && c != '\n' && c != '\r' && c != '\t') || c == 0x7fU; }, '?');
  // The control characters above ASCII, which some terminals obey: 0xC2 0x80 to 0xC2 0x9F in UTF-8.
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    if (text[i] == '\xc2' && (static_cast<unsigned char>(text[i + 1]) & 0xe0U) == 0x80U) text.replace(i, 2, "?");
  }
  return text;
}

template <class... Arguments>
void print(std::FILE* out, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  auto const text = harmless(fmt::format(format, std::forward<Arguments>(arguments)...));
  [[maybe_unused]] auto const written = std::fwrite(text.data(), 1, text.size(), out);
}

}  // namespace brisance::app
