/// Keys that had another name in earlier versions: errors name the new one, and `brisance migrate` rewrites decks.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace brisance::deck {

/// The present name of a key that `table` (names without indices, "" for the top of the deck) had under another name;
/// nothing where there was no such key.
[[nodiscard]] std::optional<std::string_view> present_name(std::string_view table, std::string_view key);

/// One key that was renamed in a text.
struct Renaming {
  int line = 1;
  std::string was;  ///< with its table: "constraint.region"
  std::string now;
};

struct Migration {
  std::string text;  ///< the deck with the present names; everything else, comments too, as it was
  std::vector<Renaming> renamings;
};

/// Renames the keys of a deck; `name` stands for the file in messages. Throws InputError where the text is not valid
/// TOML, or holds both the old and the new name of a key.
[[nodiscard]] Migration migrate(std::string_view text, std::string_view name);

}  // namespace brisance::deck
