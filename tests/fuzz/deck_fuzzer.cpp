/// libFuzzer entry: no text may crash, hang or throw out of the deck reader, and its outcome is a case or errors, never
/// both.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "deck/deck.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const text(reinterpret_cast<char const*>(data), size);
  auto const result = brisance::deck::read_text(text, "fuzz");
  if (result.case_.has_value() != result.errors.empty()) std::abort();
  for (auto const& error : result.errors) {
    if (error.line < 1 || error.column < 1 || brisance::deck::format(error).empty()) std::abort();
  }
  return 0;
}
