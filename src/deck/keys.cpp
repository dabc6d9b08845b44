/// Keys that several tables share.
#include "deck/keys.hpp"

#include <fmt/format.h>

namespace brisance::deck {

std::vector<Key> joined(std::vector<Key> first, std::vector<Key> const& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::vector<Key> own_keys() {
  return {typed(Type::text, "source").of("the deck").like("\"handbook, page 12\"").means("Source of the numbers")};
}

std::vector<Key> file_keys(char const* kind) {
  return {word("kind", {kind}).required().like(fmt::format("\"{}\"", kind)).means("Kind of material"),
          typed(Type::text, "name").required().like("\"TNT\"").means("Name"),
          typed(Type::names, "aliases").note("none").like("[\"trotyl\"]").means("Other names"),
          typed(Type::text, "source").required().like("\"handbook, page 12\"").means("Source of the numbers"),
          typed(Type::text, "note")
              .of("")
              .like("\"for weak waves\"")
              .means("What the material is suited for and how accurate it is")};
}

}  // namespace brisance::deck
