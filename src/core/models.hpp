/// Closed lists, each written once: models are the alternatives of a variant, words those of an enumeration. Whatever
/// needs all of them (decks, the manual, reports) walks the list, so that a new entry cannot be forgotten anywhere.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace brisance {

/// Calls use.operator()<Model>() for each alternative of a variant, in its order.
template <class Variant, class Use>
constexpr void for_each_model(Use&& use) {
  [&]<class... Models>(std::type_identity<std::variant<Models...>>) {
    (use.template operator()<Models>(), ...);
  }(std::type_identity<Variant>{});
}

/// The variant of all alternatives of several variants and types, in their order.
template <class... Lists>
struct Joined;
template <class... Models>
struct Joined<std::variant<Models...>> {
  using type = std::variant<Models...>;
};
template <class... Models, class... More, class... Rest>
struct Joined<std::variant<Models...>, std::variant<More...>, Rest...> {
  using type = typename Joined<std::variant<Models..., More...>, Rest...>::type;
};

/// A value of an enumeration and its word in decks and results. An enumeration E that has words declares beside it
///     constexpr auto words(E) { return std::array{Word{E::first, "first"}, ...}; }
/// A meaning, where there is one, goes behind the description of the keys of decks that take the word.
template <class E>
struct Word {
  E value;
  char const* name;
  char const* meaning = "";
};
template <class E>
Word(E, char const*) -> Word<E>;
template <class E>
Word(E, char const*, char const*) -> Word<E>;

/// Does an enumeration have this value? The compiler writes the name of a value that it has, and the number of another
/// behind its type in brackets.
template <class E, E value>
[[nodiscard]] constexpr bool has_value() {
  std::string_view const name = __PRETTY_FUNCTION__;
  std::size_t const at = name.find("value = ");
  static_assert(std::string_view(__PRETTY_FUNCTION__).find("value = ") != std::string_view::npos);
  return name[at + std::string_view("value = ").size()] != '(';
}

/// Does `words` hold every value of an enumeration, in its order?
template <class E>
[[nodiscard]] constexpr bool has_all_words() {
  constexpr auto all = words(E{});
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (all[n].value != static_cast<E>(n)) return false;
  }
  return !has_value<E, static_cast<E>(all.size())>();
}

/// The word of a value.
template <class E>
[[nodiscard]] constexpr char const* word_of(E value) {
  static_assert(has_all_words<E>(), "words() beside the enumeration lacks a value of it, or has another order");
  for (Word<E> const& w : words(E{})) {
    if (w.value == value) return w.name;
  }
  return "";
}

/// The value of a word, or none.
template <class E>
[[nodiscard]] constexpr std::optional<E> value_of(std::string_view word) {
  for (Word<E> const& w : words(E{})) {
    if (w.name == word) return w.value;
  }
  return std::nullopt;
}

/// All words of an enumeration, in its order.
template <class E>
[[nodiscard]] std::vector<std::string> all_words() {
  std::vector<std::string> out;
  for (Word<E> const& w : words(E{})) out.emplace_back(w.name);
  return out;
}

}  // namespace brisance
