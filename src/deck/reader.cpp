#include "deck/reader.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>

#include "deck/migrate.hpp"
#include "deck/values.hpp"

namespace brisance::deck {

namespace {

constexpr std::size_t longest_list = 10000;  ///< elements
constexpr int most_key_parts = 32;           ///< parts of one dotted key

/// toml++ builds one nested table per part of a dotted key and frees them recursively. Nothing in a deck has more than
/// a few parts.
std::optional<Place> overlong_key(std::string_view text) {
  Place place;
  Place start;
  int dots = 0;
  bool part_is_empty = true;
  for (char const c : text) {
    if (c == '.') {
      if (part_is_empty) dots = 0;
      if (dots == 0) start = place;
      part_is_empty = true;
      if (++dots > most_key_parts) return start;
    } else if (c == '=' || c == ',' || c == '[' || c == ']' || c == '{' || c == '}' || c == '#' || c == '\n') {
      dots = 0;
      part_is_empty = true;
    } else if (c != ' ' && c != '\t') {
      part_is_empty = false;
    }
    if (c == '\n') {
      ++place.line;
      place.column = 1;
    } else {
      ++place.column;
    }
  }
  return std::nullopt;
}

std::string lowered(std::string text) {
  // Not the first letter of an abbreviation.
  if (text.size() > 1 && std::islower(static_cast<unsigned char>(text[1])) != 0)
    text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

/// Reads the tables of one text.
class Walker : Values {
 public:
  explicit Walker(Report& report) : Values(report), report_(report) {}

  Section section(toml::table const& source, Table const& table, std::string path, Place place) {
    Section out;
    out.table = &table;
    out.path = std::move(path);
    out.place = place;
    std::vector<Key> const* further = variant(source, table);
    std::vector<std::string> names;
    for (auto const* keys : {&table.keys, further}) {
      if (keys == nullptr) continue;
      for (auto const& key : *keys) names.push_back(key.name);
    }
    for (auto const& [toml_key, node] : source) {
      std::string_view const name = toml_key.str();
      Place const key_place = place_in(toml_key.source(), place);
      Key const* key = find(table, further, name);
      if (key == nullptr) {
        // Keys of a model that was misspelt itself cannot be judged.
        if (!table.variants.empty() && further == nullptr && table.find(name) != nullptr) continue;
        auto const now = present_name(without_indices(out.path), name);
        report_.error(key_place, joined(out.path, shortened(name)),
                      now ? renamed_key(name, *now) : unknown_key(out, table, further, names, name, node));
        out.meant.push_back(now ? std::string(*now) : nearest(name, names));
        continue;
      }
      Place const value_place =
          node.is_table() || key->type == Type::tables ? key_place : place_in(node.source(), key_place);
      out.entries.emplace(name, entry(*key, node, joined(out.path, name), value_place));
    }
    for (auto const* keys : {&table.keys, further}) {
      if (keys == nullptr) continue;
      for (auto const& key : *keys) {
        bool const misspelt = std::find(out.meant.begin(), out.meant.end(), key.name) != out.meant.end();
        if (key.needed && !out.given(key.name) && !misspelt) missing(key, out);
      }
    }
    return out;
  }

 private:
  static std::string joined(std::string const& path, std::string_view key) {
    return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
  }

  /// The path of a table as `present_name` knows it: "constraint" of "constraint[2]".
  static std::string without_indices(std::string const& path) {
    std::string out;
    bool within = false;
    for (char const c : path) {
      within = within || c == '[';
      if (!within) out += c;
      if (c == ']') within = false;
    }
    return out;
  }

  static Key const* find(Table const& table, std::vector<Key> const* further, std::string_view name) {
    for (auto const* keys : {&table.keys, further}) {
      if (keys == nullptr) continue;
      for (auto const& key : *keys) {
        if (key.name == name) return &key;
      }
    }
    return nullptr;
  }

  /// The further keys that the table's selector (an equation of state) asks for; null when the word is not valid.
  static std::vector<Key> const* variant(toml::table const& source, Table const& table) {
    if (table.variants.empty()) return nullptr;
    std::string chosen;
    for (auto const& key : table.keys) {
      auto const* fallback = std::get_if<std::string>(&key.fallback);
      if (key.name == table.selector && fallback != nullptr) chosen = *fallback;
    }
    if (auto const* node = source.get(table.selector)) chosen = node->value<std::string>().value_or("");
    auto const found = table.variants.find(chosen);
    return found == table.variants.end() ? nullptr : &found->second;
  }

  static std::string renamed_key(std::string_view name, std::string_view now) {
    return fmt::format("\"{}\" is now called \"{}\"; `brisance migrate DECK` renames it and all other renamed keys",
                       name, now);
  }

  static std::string unknown_key(Section const& section, Table const& table, std::vector<Key> const* further,
                                 std::vector<std::string> const& names, std::string_view name, toml::node const& node) {
    std::string const where = section.path.empty() ? "at the top of the deck" : fmt::format("in {}", section.path);
    if (further != nullptr && table.find(name) != nullptr) {
      return fmt::format("unknown key \"{}\" (value {}) {}: this key belongs to another {}; allowed keys: {}",
                         shortened(name), show(node), where, table.selector == "eos" ? "equation of state" : "model",
                         fmt::join(names, ", "));
    }
    return fmt::format("unknown key \"{}\" (value {}) {}; {}", shortened(name), show(node), where,
                       suggestion(name, names, "allowed keys"));
  }

  void missing(Key const& key, Section const& out) {
    if (key.type == Type::table) {
      report_.error(out.place, joined(out.path, key.name),
                    fmt::format("the table [{}] is missing; write, for example, [{}] with {}",
                                joined(out.path, key.name), joined(out.path, key.name), key.sample));
      return;
    }
    std::string const range = has_range(key) ? fmt::format(" ({})", range_text(key)) : "";
    report_.error(out.place, joined(out.path, key.name),
                  fmt::format("the key \"{}\" is missing: {}; expected {}{}; write, for example, {}", key.name,
                              lowered(key.explanation), expectation(key), range, example(key)));
  }

  /// The list's elements, or nothing when it is no list or too long (reported).
  toml::array const* list(Key const& key, toml::node const& node, std::string const& path, Place place) {
    auto const* array = node.as_array();
    if (array == nullptr) {
      wrong_type(key, node, path, place);
      return nullptr;
    }
    if (array->size() > longest_list) {
      report_.error(place, path,
                    fmt::format("the list has {} elements; allowed: at most {}", array->size(), longest_list));
      return nullptr;
    }
    return array;
  }

  template <class T, class Read>
  void read_list(Entry& out, Key const& key, toml::node const& node, std::string const& path, Read read_element) {
    auto const* array = list(key, node, path, out.place);
    if (array == nullptr) return;
    std::vector<T> values;
    out.valid = true;
    for (auto const& element : *array) {
      out.elements_shown.push_back(show(element));
      auto const v = read_element(element, place_in(element.source(), out.place));
      if (v) {
        values.push_back(*v);
      } else {
        out.valid = false;
      }
    }
    out.value = std::move(values);
  }

  template <class T>
  static void accept(Entry& out, std::optional<T> const& value) {
    if (!value) return;
    out.value = *value;
    out.valid = true;
  }

  Entry entry(Key const& key, toml::node const& node, std::string const& path, Place place) {
    Entry out;
    out.place = place;
    out.shown = show(node);
    switch (key.type) {
      case Type::number: accept(out, quantity(key, node, path, place, &out.unit)); break;
      case Type::integer: accept(out, whole(key, node, path, place)); break;
      case Type::boolean:
        if (auto const* b = node.as_boolean()) {
          out.value = b->get();
          out.valid = true;
        } else {
          wrong_type(key, node, path, place);
        }
        break;
      case Type::text:
      case Type::name: string(out, key, node, path); break;
      case Type::word: accept(out, one_of(key, node, path, place)); break;
      case Type::axis: axis(out, key, node, path); break;
      case Type::words:
        read_list<std::string>(out, key, node, path,
                               [&](toml::node const& e, Place at) { return one_of(key, e, path, at); });
        break;
      case Type::names:
        read_list<std::string>(out, key, node, path, [&](toml::node const& e, Place at) {
          auto text = e.value<std::string>();
          if (!text) wrong_type(key, e, path, at);
          return text;
        });
        break;
      case Type::numbers:
        read_list<double>(out, key, node, path,
                          [&](toml::node const& e, Place at) { return quantity(key, e, path, at); });
        break;
      case Type::integers:
        read_list<double>(out, key, node, path, [&](toml::node const& e, Place at) {
          auto const v = whole(key, e, path, at);
          return v ? std::optional<double>(static_cast<double>(*v)) : std::nullopt;
        });
        break;
      case Type::point: point(out, key, node, path); break;
      case Type::field:
        if (has_expressions(key, node)) {
          accept(out, expressions(key, node, path, place));
        } else {
          point(out, key, node, path);
        }
        break;
      case Type::pairs:
        if (auto const* array = list(key, node, path, place)) accept(out, pairs(key, *array, path, place));
        break;
      case Type::table:
        if (auto const* t = node.as_table()) {
          out.value = std::vector<Section>{section(*t, *key.table, path, place)};
          out.valid = true;
        } else if (auto const word = node.value<std::string>();
                   word && std::find(key.choices.begin(), key.choices.end(), *word) != key.choices.end()) {
          accept(out, word);
        } else {
          wrong_type(key, node, path, place);
        }
        break;
      case Type::tables: tables(out, key, node, path); break;
      case Type::named: named(out, key, node, path); break;
    }
    return out;
  }

  void string(Entry& out, Key const& key, toml::node const& node, std::string const& path) {
    auto const* s = node.as_string();
    if (s == nullptr) {
      wrong_type(key, node, path, out.place);
      return;
    }
    std::string const& text = s->get();
    auto const plain = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-' || c == '+';
    };
    if (key.type == Type::name && (text.empty() || text.size() > 64 || !std::all_of(text.begin(), text.end(), plain))) {
      report_.error(out.place, path,
                    fmt::format("{} is not allowed, expected {}, 1 to 64 of them; write, for example, {}", show(node),
                                expectation(key), example(key)));
      return;
    }
    out.value = text;
    out.valid = true;
  }

  /// A point may be one number where one direction is resolved; the count is checked when the geometry is known.
  void point(Entry& out, Key const& key, toml::node const& node, std::string const& path) {
    if (node.is_number() || node.is_string()) {
      if (auto const v = quantity(key, node, path, out.place)) {
        out.value = std::vector<double>{*v};
        out.valid = true;
      }
      out.elements_shown = {show(node)};
      return;
    }
    auto const* array = node.as_array();
    if (array == nullptr) {
      wrong_type(key, node, path, out.place);
      return;
    }
    if (array->empty() || array->size() > 3) {
      report_.error(out.place, path,
                    fmt::format("{} has {} elements, expected {}; write, for example, {}", show(node), array->size(),
                                expectation(key), example(key)));
      return;
    }
    // A direction that is not resolved may be written as 0, also where 0 is out of the range.
    read_list<double>(out, key, node, path, [&](toml::node const& e, Place at) {
      auto const number = e.value<double>();
      if (number && *number == 0.0 && &e != array->get(0)) return std::optional<double>(0.0);
      return quantity(key, e, path, at);
    });
  }

  /// A letter becomes a unit vector.
  void axis(Entry& out, Key const& key, toml::node const& node, std::string const& path) {
    if (node.is_string()) {
      auto const letter = one_of(key, node, path, out.place);
      if (!letter) return;
      std::vector<double> unit(3, 0.0);
      unit[static_cast<std::size_t>((*letter)[0] - 'x')] = 1.0;
      out.value = unit;
      out.valid = true;
      return;
    }
    auto const* array = node.as_array();
    if (array == nullptr || array->size() != 3) {
      wrong_type(key, node, path, out.place);
      return;
    }
    read_list<double>(out, key, node, path, [&](toml::node const& e, Place at) { return quantity(key, e, path, at); });
  }

  void tables(Entry& out, Key const& key, toml::node const& node, std::string const& path) {
    auto const* array = node.as_array();
    if (key.single && node.is_table()) {
      out.value = std::vector<Section>{section(*node.as_table(), *key.table, path, out.place)};
      out.valid = true;
      return;
    }
    if (node.is_table() && path.find('.') == std::string::npos) {
      report_.error(out.place, path,
                    fmt::format("[{}] is a single table, expected an array of tables; write [[{}]]", path, path));
      return;
    }
    if (array == nullptr) {
      report_.error(
          out.place, path,
          fmt::format("{} {}, expected an array of tables; write {}", show(node), kind_of(node),
                      key.sample.empty() ? fmt::format("[[{}]]", path) : fmt::format("for example {}", example(key))));
      return;
    }
    if (array->size() > longest_list) {
      report_.error(out.place, path,
                    fmt::format("there are {} tables; allowed: at most {}", array->size(), longest_list));
      return;
    }
    // Wrong elements are reported and left out, so that the others are still checked.
    std::vector<Section> sections;
    out.valid = true;
    for (std::size_t i = 0; i < array->size(); ++i) {
      toml::node const& element = (*array)[i];
      Place const place = place_in(element.source(), out.place);
      std::string const element_path = fmt::format("{}[{}]", path, i + 1);
      if (auto const* t = element.as_table()) {
        sections.push_back(section(*t, *key.table, element_path, place));
      } else {
        report_.error(place, element_path, fmt::format("{} {}, expected a table", show(element), kind_of(element)));
      }
    }
    out.value = std::move(sections);
  }

  void named(Entry& out, Key const& key, toml::node const& node, std::string const& path) {
    auto const* table = node.as_table();
    if (table == nullptr) {
      wrong_type(key, node, path, out.place);
      return;
    }
    // Wrong elements are reported and left out, so that the others are still checked.
    std::vector<Section> sections;
    out.valid = true;
    for (auto const& [name, element] : *table) {
      Place const place = place_in(name.source(), out.place);
      std::string const element_path = joined(path, shortened(name.str()));
      if (!key.choices.empty() && std::find(key.choices.begin(), key.choices.end(), name.str()) == key.choices.end()) {
        report_.error(place, element_path,
                      fmt::format("unknown name \"{}\"; {}", shortened(name.str()),
                                  suggestion(name.str(), key.choices, "allowed names")));
        continue;
      }
      if (name.str().empty() || name.str().size() > 64) {
        report_.error(place, element_path, fmt::format("the name has {} bytes; allowed: 1 to 64", name.str().size()));
      } else if (auto const* t = element.as_table()) {
        sections.push_back(section(*t, *key.table, element_path, place));
        sections.back().name = name.str();
      } else {
        report_.error(place, element_path,
                      fmt::format("{} {}, expected a table; write [{}.NAME]", show(element), kind_of(element), path));
      }
    }
    out.value = std::move(sections);
  }

  Report& report_;
};

}  // namespace

std::string size_problem(std::string const& bytes) {
  return fmt::format("the deck has {} bytes; allowed: at most {}", bytes, largest_deck);
}

std::optional<toml::table> parse(std::string_view text, Report& report) {
  if (text.size() > largest_deck) {
    report.error({}, "", size_problem(fmt::format("{}", text.size())));
    return std::nullopt;
  }
  if (auto const place = overlong_key(text)) {
    report.error(*place, "",
                 fmt::format("a key with more than {} parts; every key of a deck has only a few", most_key_parts));
    return std::nullopt;
  }
  try {
    return toml::parse(text);
  } catch (toml::parse_error const& error) {
    report.error(place_in(error.source(), {}), "",
                 fmt::format("this is not valid TOML: {}; correct this first; the rest was not read",
                             shortened(error.description(), 300)));
    return std::nullopt;
  }
}

std::optional<Section> read(std::string_view text, Table const& schema, Report& report) {
  auto const root = parse(text, report);
  if (!root) return std::nullopt;
  return Walker(report).section(*root, schema, "", {});
}

}  // namespace brisance::deck
