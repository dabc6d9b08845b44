/// The JSON Schema of decks, by a validator of the keywords that it uses: it accepts every deck that the reader
/// accepts, and refuses what the reader refuses but for units and limits in strings.
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "deck/deck.hpp"
#include "deck/reader.hpp"
#include "deck/schema.hpp"
#include "files.hpp"

namespace brisance {
namespace {

using Json = nlohmann::json;

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

/// Draft 2020-12, the keywords of this schema; another keyword throws.
class Validator {
 public:
  explicit Validator(Json schema) : root_(std::move(schema)) {}

  /// What is wrong with the first value that does not fit; "" for a valid document.
  std::string operator()(Json const& value) { return problem(root_, value, "deck"); }

 private:
  using Check = std::string (Validator::*)(Json const& rule, Json const& schema, Json const& value,
                                           std::string const& path);

  std::string problem(Json const& schema, Json const& value, std::string const& path) {
    static std::map<std::string, Check> const checks{
        {"$ref", &Validator::reference},        {"type", &Validator::type},
        {"enum", &Validator::choice},           {"minimum", &Validator::minimum},
        {"maximum", &Validator::maximum},       {"pattern", &Validator::pattern},
        {"minLength", &Validator::shortest},    {"maxLength", &Validator::longest},
        {"properties", &Validator::properties}, {"additionalProperties", &Validator::additional},
        {"propertyNames", &Validator::names},   {"required", &Validator::required},
        {"items", &Validator::items},           {"minItems", &Validator::fewest},
        {"maxItems", &Validator::most},         {"anyOf", &Validator::any_of},
        {"oneOf", &Validator::one_of}};
    if (schema.is_boolean()) return schema.get<bool>() ? "" : path + " is not allowed";
    for (auto const& [keyword, rule] : schema.items()) {
      if (std::set<std::string>{"$schema", "$defs", "title", "description", "default", "examples"}.contains(keyword)) {
        continue;
      }
      auto const check = checks.find(keyword);
      if (check == checks.end()) throw std::logic_error("the validator does not know " + keyword);
      std::string const found = (this->*check->second)(rule, schema, value, path);
      if (!found.empty()) return found;
    }
    return "";
  }

  std::string reference(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    return problem(root_.at(Json::json_pointer(rule.get<std::string>().substr(1))), value, path);
  }
  std::string type(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    std::map<std::string, bool> const is{{"object", value.is_object()}, {"array", value.is_array()},
                                         {"string", value.is_string()}, {"boolean", value.is_boolean()},
                                         {"number", value.is_number()}, {"integer", value.is_number_integer()}};
    return is.at(rule) ? "" : path + " is not of type " + rule.get<std::string>();
  }
  std::string choice(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    return std::find(rule.begin(), rule.end(), value) != rule.end() ? "" : path + " is none of " + rule.dump();
  }
  std::string minimum(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    return !value.is_number() || value.get<double>() >= rule.get<double>() ? "" : path + " is below " + rule.dump();
  }
  std::string maximum(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    return !value.is_number() || value.get<double>() <= rule.get<double>() ? "" : path + " is above " + rule.dump();
  }
  std::string pattern(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    if (!value.is_string()) return "";
    auto& regex = patterns_.try_emplace(rule, rule.get<std::string>(), std::regex::ECMAScript).first->second;
    return std::regex_search(value.get<std::string>(), regex) ? "" : path + " does not match " + rule.dump();
  }
  std::string shortest(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    return !value.is_string() || value.get<std::string>().size() >= rule.get<std::size_t>() ? "" : path + " is short";
  }
  std::string longest(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    return !value.is_string() || value.get<std::string>().size() <= rule.get<std::size_t>() ? "" : path + " is long";
  }
  std::string properties(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    if (!value.is_object()) return "";
    for (auto const& [key, inner] : value.items()) {
      auto const known = rule.find(key);
      if (known == rule.end()) continue;
      if (auto found = problem(*known, inner, path + "." + key); !found.empty()) return found;
    }
    return "";
  }
  std::string additional(Json const& rule, Json const& schema, Json const& value, std::string const& path) {
    if (!value.is_object()) return "";
    for (auto const& [key, inner] : value.items()) {
      if (schema.contains("properties") && schema["properties"].contains(key)) continue;
      if (auto found = problem(rule, inner, path + "." + key); !found.empty()) return found;
    }
    return "";
  }
  std::string names(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    if (!value.is_object()) return "";
    for (auto const& [key, inner] : value.items()) {
      if (auto found = problem(rule, key, path + ": the name " + key); !found.empty()) return found;
    }
    return "";
  }
  std::string required(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    if (!value.is_object()) return "";
    for (auto const& key : rule) {
      if (!value.contains(key.get<std::string>())) return path + " lacks " + key.dump();
    }
    return "";
  }
  std::string items(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    if (!value.is_array()) return "";
    for (auto const& element : value) {
      if (auto found = problem(rule, element, path + "[]"); !found.empty()) return found;
    }
    return "";
  }
  std::string fewest(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    return !value.is_array() || value.size() >= rule.get<std::size_t>() ? "" : path + " has too few elements";
  }
  std::string most(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    return !value.is_array() || value.size() <= rule.get<std::size_t>() ? "" : path + " has too many elements";
  }
  std::size_t fitting(Json const& rule, Json const& value, std::string const& path, std::string& found) {
    std::size_t count = 0;
    for (auto const& one : rule) {
      std::string const wrong = problem(one, value, path);
      if (wrong.empty()) ++count;
      found += (found.empty() ? "" : ", or ") + wrong;
    }
    return count;
  }
  std::string any_of(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    std::string found;
    return fitting(rule, value, path, found) > 0 ? "" : found;
  }
  std::string one_of(Json const& rule, Json const& /*schema*/, Json const& value, std::string const& path) {
    std::string found;
    return fitting(rule, value, path, found) == 1 ? "" : found;
  }

  Json root_;
  std::map<std::string, std::regex> patterns_;
};

Validator& validator() {
  static Validator all(Json::parse(deck::json_schema()));
  return all;
}

std::string problem(std::string_view deck) { return validator()(json_of(toml::parse(deck))); }

/// The reader's errors, without what the tables mean together.
std::vector<deck::Diagnostic> errors_of(std::string const& text) {
  deck::Report report("deck");
  (void)deck::read(text, deck::deck_schema(), report);
  return report.errors();
}

std::vector<std::filesystem::path> good_decks() {
  auto all = test::files_in(test::root() / "tests/deck/good", ".toml");
  for (auto const& folder : std::filesystem::directory_iterator(test::root() / "cases")) {
    if (std::filesystem::exists(folder.path() / "deck.toml")) all.push_back(folder.path() / "deck.toml");
  }
  return all;
}

TEST(JsonSchema, EveryGoodDeckFits) {
  auto const decks = good_decks();
  EXPECT_GT(decks.size(), 25U);
  for (auto const& path : decks) EXPECT_EQ(problem(test::file_text(path)), "") << path;
}

constexpr char const* sound = R"([domain]
size = [4, 4, 4]
cell = "50 mm"
[end]
time = "1 ms"
)";

TEST(JsonSchema, WrongDecksDoNotFit) {
  ASSERT_EQ(problem(sound), "");
  for (auto const& [wrong, told] : {
           std::pair{"[numerics]\ncourant = 7\n", "deck.numerics.courant is above 1.0"},
           std::pair{"[numerics]\ncourant = \"fast\"\n", "deck.numerics.courant does not match"},
           std::pair{"[numerics]\ncourrant = 0.5\n", "deck.numerics.courrant is not allowed"},
           std::pair{"[numerics]\nscheme = \"weno\"\n", "deck.numerics.scheme is none of"},
           std::pair{"[numerics]\nblock_cells = 8.5\n", "deck.numerics.block_cells is not of type integer"},
           std::pair{"[numerics]\nsleep = \"yes\"\n", "deck.numerics.sleep is not of type boolean"},
           std::pair{"[charge]\nmass = 1\n", "deck.charge is not of type array"},
           std::pair{"[[charge]]\nmass = -1\n", "deck.charge[].mass is below"},
           std::pair{"[[charge]]\nposition = [0, 0, 0, 0]\n", "deck.charge[].position has too many elements"},
           std::pair{"[[charge]]\naxis = \"w\"\n", "deck.charge[].axis is none of"},
           std::pair{"[[gauge]]\nname = \"a b\"\n", "deck.gauge[].name does not match"},
           std::pair{"[[gauge]]\nline = {from = 0, count = 5}\n", "deck.gauge[].line lacks \"to\""},
           std::pair{"[inflow.x_left]\nvelocity = 1\n", "deck.inflow.x_left is not allowed"},
           std::pair{"[fluids.gas]\ndensity = 1\ngamma = 1.4\nC0 = 1\n", "deck.fluids.gas.C0 is not allowed"},
           std::pair{"[fluids.gas]\neos = \"tait\"\ndensity = 1\n", "deck.fluids.gas.eos is none of"},
           std::pair{"[mpm_region]\nbox = \"all\"\n", "deck.mpm_region.box is none of"},
           std::pair{"[fluid.gas]\n", "deck.fluid is not allowed"},
       }) {
    std::string const found = problem(std::string(sound) + wrong);
    EXPECT_NE(found.find(told), std::string::npos) << wrong << found;
    EXPECT_FALSE(errors_of(std::string(sound) + wrong).empty()) << wrong;
  }
  EXPECT_EQ(problem("[end]\ntime = 1\n"), "deck lacks \"domain\"");
}

/// Calls visit(table, key) for every key of a table and the tables in it.
void for_each_key(toml::table& table, std::function<void(toml::table&, std::string const&)> const& visit) {
  std::vector<std::string> keys;
  for (auto const& [key, value] : table) keys.emplace_back(key.str());
  for (auto const& key : keys) {
    visit(table, key);
    if (auto* inner = table.get_as<toml::table>(key)) for_each_key(*inner, visit);
    if (auto* all = table.get_as<toml::array>(key)) {
      for (auto& element : *all) {
        if (auto* inner = element.as_table()) for_each_key(*inner, visit);
      }
    }
  }
}

std::string text_of(toml::table const& table) {
  std::ostringstream out;
  out << table;
  return out.str();
}

// Each key of the decks that have all keys is taken away, misspelt and given values of every kind. The reader and the
// schema must agree.
TEST(JsonSchema, AgreesWithTheReaderOnEveryKey) {
  std::vector<toml::table> const values = [] {
    std::vector<toml::table> out;
    for (auto const* value : {"true", "1", "-3", "0.37", "1e30", "-1e30", "\"x\"", "[]", "[1, 2, 3]", "[\"x\"]",
                              "[true]", "{}", "[{}]", "{x = 1}"}) {
      out.push_back(toml::parse(std::string("v = ") + value));
    }
    return out;
  }();
  int count = 0;
  int refused = 0;
  for (auto const* name : {"all_keys", "all_levels", "all_points", "all_region", "all_remap"}) {
    toml::table deck = toml::parse(test::file_text(test::root() / "tests/deck/good" / (std::string(name) + ".toml")));
    auto const agree = [&](std::string const& what) {
      auto const errors = errors_of(text_of(deck));
      std::string const found = validator()(json_of(deck));
      EXPECT_EQ(errors.empty(), found.empty())
          << name << ", " << what << ": " << (errors.empty() ? found : deck::format(errors.front()));
      ++count;
      refused += found.empty() ? 0 : 1;
    };
    for_each_key(deck, [&](toml::table& table, std::string const& key) {
      toml::table const before = table;
      for (auto const& value : values) {
        table.insert_or_assign(key, *value.get("v"));
        agree(key + " = " + text_of(value));
      }
      table.erase(key);
      agree("without " + key);
      table.insert_or_assign(key + "q", *before.get(key));
      agree("with " + key + "q");
      table = before;
    });
  }
  EXPECT_GT(count, 3000);
  EXPECT_GT(refused, count / 2);
}

// A string may hold any number and unit: what the unit means is the reader's matter.
TEST(JsonSchema, StringsThatAreQuantitiesFit) {
  std::string const before = "[domain]\nsize = [4, 4, 4]\ncell = ";
  for (auto const* cell : {"0.05", "\"50 mm\"", "\"5e-2\"", "\"5e1 mm\"", "\" +.05 m \"", "\"5.cm\"", "\"2in\""}) {
    EXPECT_EQ(problem(before + cell + "\n[end]\ntime = 1\n"), "") << cell;
    EXPECT_TRUE(errors_of(before + cell + "\n[end]\ntime = 1\n").empty()) << cell;
  }
  EXPECT_EQ(problem(std::string(sound) + "[[initial_state]]\nvelocity = [\"\u22123 m/s\", 0, 0]\n"), "");
  EXPECT_EQ(problem(before + "\"50 kg\"\n[end]\ntime = 1\n"), "");
  for (auto const* cell : {"\"\"", "\"mm\"", "\"50,0 mm\"", "\"5.0.1 mm\"", "\"++5 mm\""}) {
    EXPECT_NE(problem(before + cell + "\n[end]\ntime = 1\n"), "") << cell;
  }
}

}  // namespace
}  // namespace brisance
