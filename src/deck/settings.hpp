/// Keys of decks that set members of options: each is declared once, with the member that it sets. The member's value
/// in fresh options is the key's default, unless the key is required or notes what holds without it.
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/models.hpp"
#include "deck/reader.hpp"
#include "deck/schema.hpp"

namespace brisance::deck {

/// The value that a section has for a key, as a member of type T takes it. A member that is true or false may have a
/// word: the first of the key's choices is true.
template <class T>
[[nodiscard]] std::optional<T> value_for(Section const& section, Key const& key) {
  if constexpr (std::is_enum_v<T>) {
    auto const word = section.text(key.name);
    return word ? value_of<T>(*word) : std::nullopt;
  } else if constexpr (std::is_same_v<T, bool>) {
    if (key.type == Type::boolean) return section.boolean(key.name);
    auto const word = section.text(key.name);
    return word ? std::optional(*word == key.choices.front()) : std::nullopt;
  } else if constexpr (std::is_integral_v<T>) {
    auto const whole = section.integer(key.name);
    return whole ? std::optional(static_cast<T>(*whole)) : std::nullopt;
  } else if constexpr (std::is_same_v<T, double>) {
    return section.number(key.name);
  } else if constexpr (std::is_same_v<T, std::vector<double>>) {
    auto const* all = section.numbers(key.name);
    return all == nullptr ? std::nullopt : std::optional(*all);
  } else {
    static_assert(std::is_same_v<T, std::vector<std::string>>);
    auto const* all = section.strings(key.name);
    return all == nullptr ? std::nullopt : std::optional(*all);
  }
}

/// Makes a member's value the default of its key.
template <class T>
void set_default(Key& key, T const& value) {
  if (key.needed || !key.fallback_note.empty()) return;
  if constexpr (std::is_enum_v<T>) {
    key.of(word_of(value));
  } else if constexpr (std::is_same_v<T, bool>) {
    if (key.type == Type::boolean) {
      key.of(value);
    } else {
      key.of(key.choices[value ? 0 : 1].c_str());
    }
  } else if constexpr (std::is_integral_v<T>) {
    key.of(static_cast<long>(value));
  } else if constexpr (std::is_same_v<T, double>) {
    key.of(value);
  }
}

template <class T>
struct Written {
  using type = T;
};
template <class T>
struct Written<std::optional<T>> {
  using type = T;
};

template <class Options>
class Settings {
 public:
  struct Setting {
    template <class T>
    Setting(T Options::*member, Key declared) : key(std::move(declared)) {
      set_default(key, Options{}.*member);
      read = [member, own = key](Section const& section, Options& options) {
        auto const value = value_for<typename Written<T>::type>(section, own);
        if (value) options.*member = *value;
        return value || (!own.needed && !section.broken(own.name));
      };
    }
    /// A key among the others that is read elsewhere.
    Setting(Key declared) : key(std::move(declared)) {}  // NOLINT(google-explicit-constructor)

    Key key;
    std::function<bool(Section const&, Options&)> read;
  };

  Settings(std::initializer_list<Setting> all) : all_(all) {}

  [[nodiscard]] std::vector<Key> keys() const {
    std::vector<Key> out;
    for (auto const& setting : all_) out.push_back(setting.key);
    return out;
  }

  /// Sets what the section gives, and the defaults of the rest; false when a value is wrong or a required one missing,
  /// which is reported.
  bool read(Section const& section, Options& options) const {
    bool sound = true;
    for (auto const& setting : all_) sound = (!setting.read || setting.read(section, options)) && sound;
    return sound;
  }

 private:
  std::vector<Setting> all_;
};

}  // namespace brisance::deck
