/// A JSON Schema of decks (draft 2020-12) for editors, printed from the schema. It says no more than one key or table
/// can tell: what tables mean together, and whether a unit fits, only reading a deck tells.
#include <fmt/format.h>
#include <toml++/toml.h>

#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/parameter.hpp"
#include "deck/deck.hpp"
#include "deck/schema.hpp"

namespace brisance::deck {

namespace {

using Json = nlohmann::ordered_json;

/// A string that begins with a number, with the sign on keyboards or that of typesetters; the rest is its unit.
constexpr char const* quantity_pattern =
    R"(^\s*(\+|-|−)?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?(\s+([^\s,].*)?|[^\s,0-9.].*)?$)";
constexpr char const* name_pattern = "^[A-Za-z0-9._+-]{1,64}$";
constexpr int longest_name = 64;  ///< of a table

Json json_of(toml::node const& node) {
  if (auto const* table = node.as_table()) {
    Json out = Json::object();
    for (auto const& [key, value] : *table) out[std::string(key.str())] = json_of(value);
    return out;
  }
  if (auto const* array = node.as_array()) {
    Json out = Json::array();
    for (auto const& value : *array) out.push_back(json_of(value));
    return out;
  }
  if (auto const* text = node.as_string()) return text->get();
  if (auto const* whole = node.as_integer()) return whole->get();
  if (auto const* number = node.as_floating_point()) return number->get();
  return node.value<bool>().value_or(false);
}

Json ranged(Json out, Key const& key) {
  if (key.minimum > -unbounded) out["minimum"] = key.minimum;
  if (key.maximum < unbounded) out["maximum"] = key.maximum;
  return out;
}

Json list_of(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

/// The schemas of tables, each once and under the name of the place where it comes first.
class Definitions {
 public:
  Json object(Table const& table, std::string const& path);
  Json take() { return std::move(all_); }

 private:
  /// The keys of a table; with a word for its selector, those that go with the word.
  Json keys(Table const& table, std::string const& path, std::string const& word);
  Json property(Key const& key, std::string const& path);
  Json value(Key const& key, std::string const& path);
  Json named(Key const& key, Json table);
  Json reference(Table const& table, std::string const& path);

  std::map<Table const*, std::string> names_;
  Json all_ = Json::object();
};

/// A number in SI units with its range, or a string with a unit, whose range only the program knows.
Json quantity(Key const& key) {
  return {{"anyOf", {ranged({{"type", "number"}}, key), {{"type", "string"}, {"pattern", quantity_pattern}}}}};
}

/// Only the program knows what is an expression.
Json quantity_or_expression(Key const& key) {
  return {{"anyOf", {ranged({{"type", "number"}}, key), {{"type", "string"}}}}};
}

Json words(Key const& key) { return {{"enum", key.choices}}; }

Json Definitions::value(Key const& key, std::string const& path) {
  switch (key.type) {
    case Type::number: return quantity(key);
    case Type::integer: return ranged({{"type", "integer"}}, key);
    case Type::boolean: return {{"type", "boolean"}};
    case Type::text: return {{"type", "string"}};
    case Type::name: return {{"type", "string"}, {"pattern", name_pattern}};
    case Type::word: return words(key);
    case Type::words: return list_of(words(key));
    case Type::names: return list_of({{"type", "string"}});
    case Type::numbers: return list_of(quantity(key));
    case Type::integers: return list_of(ranged({{"type", "integer"}}, key));
    case Type::axis: {
      Json vector = list_of(quantity(key));
      vector["minItems"] = vector["maxItems"] = 3;
      return {{"anyOf", {words(key), std::move(vector)}}};
    }
    case Type::point:
    case Type::field: {
      Json point = list_of(key.type == Type::field ? quantity_or_expression(key) : quantity(key));
      point["minItems"] = 1;
      point["maxItems"] = 3;
      Json out = key.type == Type::field ? quantity_or_expression(key) : quantity(key);
      out["anyOf"].push_back(std::move(point));
      return out;
    }
    case Type::pairs: {
      Json pair = list_of(quantity(key));
      pair["minItems"] = pair["maxItems"] = 2;
      return list_of(std::move(pair));
    }
    case Type::table:
      if (key.choices.empty()) return reference(*key.table, path);
      return {{"anyOf", {words(key), reference(*key.table, path)}}};
    case Type::tables:
      if (key.single) return {{"anyOf", {reference(*key.table, path), list_of(reference(*key.table, path))}}};
      return list_of(reference(*key.table, path));
    case Type::named: return named(key, reference(*key.table, path));
  }
  return {};
}

Json Definitions::named(Key const& key, Json table) {
  Json out{{"type", "object"}};
  if (key.choices.empty()) {
    out["propertyNames"] = {{"minLength", 1}, {"maxLength", longest_name}};
    out["additionalProperties"] = std::move(table);
    return out;
  }
  for (auto const& name : key.choices) out["properties"][name] = table;
  out["additionalProperties"] = false;
  return out;
}

Json Definitions::property(Key const& key, std::string const& path) {
  Json out = Json::object();
  if (key.table != nullptr && key.explanation.empty()) {
    out["description"] = key.table->meaning;
  } else {
    out["description"] = fmt::format("{}.\n\n{}", key.explanation, facts(key));
  }
  out.update(value(key, path));
  std::visit(
      [&](auto const& fallback) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(fallback)>, std::monostate>) out["default"] = fallback;
      },
      key.fallback);
  if (!key.explanation.empty()) {
    toml::table const example = toml::parse(fmt::format("value = {}", key.sample));
    out["examples"] = Json::array({json_of(*example.get("value"))});
  }
  return out;
}

Json Definitions::keys(Table const& table, std::string const& path, std::string const& word) {
  Json out{{"type", "object"}, {"properties", Json::object()}};
  Json required = Json::array();
  auto const add = [&](Key const& key) {
    Json one = property(key, path.empty() ? key.name : fmt::format("{}.{}", path, key.name));
    bool needed = key.needed;
    if (!word.empty() && key.name == table.selector) {
      one["enum"] = {word};
      auto const* fallback = std::get_if<std::string>(&key.fallback);
      needed = fallback == nullptr || *fallback != word;
    }
    out["properties"][key.name] = std::move(one);
    if (needed) required.push_back(key.name);
  };
  for (auto const& key : table.keys) add(key);
  if (auto const more = table.variants.find(word); more != table.variants.end()) {
    for (auto const& key : more->second) add(key);
  }
  if (!required.empty()) out["required"] = std::move(required);
  out["additionalProperties"] = false;
  return out;
}

Json Definitions::object(Table const& table, std::string const& path) {
  if (table.variants.empty()) return keys(table, path, "");
  Json out{{"type", "object"}, {"oneOf", Json::array()}};
  for (auto const& [word, more] : table.variants) {
    Json one = keys(table, path, word);
    one["title"] = fmt::format("{} = \"{}\"", table.selector, word);
    out["oneOf"].push_back(std::move(one));
  }
  return out;
}

Json Definitions::reference(Table const& table, std::string const& path) {
  auto const [name, fresh] = names_.try_emplace(&table, path);
  if (fresh) {
    Json definition{{"title", path}, {"description", table.meaning}};
    definition.update(object(table, path));
    all_[path] = std::move(definition);
  }
  return {{"$ref", fmt::format("#/$defs/{}", name->second)}};
}

}  // namespace

std::string json_schema() {
  Json out{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
           {"title", "Brisance deck"},
           {"description",
            "One TOML file that describes one simulation. `brisance check` checks the rest: units and the combination "
            "of tables."}};
  Definitions definitions;
  out.update(definitions.object(deck_schema(), ""));
  out["$defs"] = definitions.take();
  return out.dump(2) + "\n";
}

}  // namespace brisance::deck
