/// Values over time: of a pressure or a motion, in the deck or in a file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "deck/draft.hpp"
#include "deck/schema.hpp"

namespace brisance::deck {

struct History {
  std::vector<double> times;   ///< [s], rising, at least two
  std::vector<double> values;  ///< SI units
};

/// Keys of a history in a file beside those of one in the deck.
[[nodiscard]] std::vector<Key> history_file_keys(std::string const& values);
/// The times and the values under a key of a history, or those of its file; nothing after an error.
[[nodiscard]] std::optional<History> build_history(Draft const& draft, Section const& history, std::string_view values);

}  // namespace brisance::deck
