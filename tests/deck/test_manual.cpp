#include <gtest/gtest.h>

#include "core/units.hpp"
#include "deck/deck.hpp"
#include "deck/schema.hpp"
#include "files.hpp"

namespace brisance {
namespace {

TEST(Manual, TheCommittedPageIsUpToDate) {
  // Print it anew with: brisance info --deck-reference >docs/deck.md
  EXPECT_EQ(deck::reference_manual(), test::file_text(test::root() / "docs/deck.md"));
}

TEST(Manual, ItsShortestDeckIsReadAndShort) {
  std::string const manual = deck::reference_manual();
  auto const start = manual.find("```toml\n") + 8;
  std::string const example = manual.substr(start, manual.find("```", start) - start);
  EXPECT_LT(std::count(example.begin(), example.end(), '\n'), 15);
  auto const result = deck::read_text(example, "manual");
  EXPECT_TRUE(result.case_.has_value()) << (result.errors.empty() ? "" : deck::format(result.errors.front()));
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
}

// What stands in backquotes in its paragraph on units is a unit; what it says to be refused is.
TEST(Manual, ItsUnitsAreUnits) {
  std::string const manual = deck::reference_manual();
  auto const begin = manual.find("The known units, also with prefixes");
  auto const end = manual.find("Symbols are case-sensitive");
  auto const last = manual.find("is rejected, and the message says what to write");
  ASSERT_LT(begin, end);
  ASSERT_LT(end, last);
  auto const words = [&manual](std::size_t from, std::size_t to) {
    std::vector<std::string> out;
    for (std::size_t at = manual.find('`', from); at < to; at = manual.find('`', at)) {
      std::size_t const close = manual.find('`', at + 1);
      std::string word = manual.substr(at + 1, close - at - 1);
      if (word.front() == '"') word = word.substr(1, word.size() - 2);
      out.push_back(word);
      at = close + 1;
    }
    return out;
  };
  auto const problem = [](std::string const& word) { return units::parse("1 " + word, "kg6").problem; };
  auto const good = words(begin, end);
  EXPECT_GT(good.size(), 50U);
  for (auto const& word : good) EXPECT_EQ(problem(word).find(" unit "), std::string::npos) << problem(word);
  auto const bad = words(end, last);
  EXPECT_GE(bad.size(), 10U);
  for (auto const& word : bad) {
    if (word == "lb/in2") continue;  // a mass per area
    EXPECT_NE(problem(word).find(" unit "), std::string::npos) << word;
  }
}

TEST(Manual, TheDecksOfTheUserGuideAreRead) {
  std::string const guide = test::file_text(test::root() / "docs/user-guide.md");
  int count = 0;
  for (std::size_t at = guide.find("```toml\n"); at != std::string::npos; at = guide.find("```toml\n", at)) {
    at += 8;
    auto const result = deck::read_text(guide.substr(at, guide.find("```", at) - at), "guide");
    EXPECT_TRUE(result.case_) << deck::format(result.errors.front());
    EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
    ++count;
  }
  EXPECT_EQ(count, 7);
}

void check_keys(deck::Table const& table, std::string const& where) {
  auto const check = [&](deck::Key const& key) {
    std::string const name = where + "." + key.name;
    if (key.table != nullptr) {
      check_keys(*key.table, name);
      return;
    }
    EXPECT_FALSE(key.explanation.empty()) << name;
    EXPECT_FALSE(key.sample.empty()) << name;
    if (key.type == deck::Type::number) {
      EXPECT_LT(key.minimum, key.maximum) << name;
      if (auto const* value = std::get_if<double>(&key.fallback)) {
        EXPECT_GE(*value, key.minimum) << name;
        EXPECT_LE(*value, key.maximum) << name;
      }
    }
    if (key.type == deck::Type::word) {
      EXPECT_FALSE(key.choices.empty()) << name;
    }
  };
  for (auto const& key : table.keys) check(key);
  for (auto const& [word, keys] : table.variants) {
    for (auto const& key : keys) check(key);
  }
}

TEST(Manual, EveryKeyIsExplainedAndEveryDefaultAllowed) { check_keys(deck::deck_schema(), "deck"); }

TEST(Schema, NearestNames) {
  std::vector<std::string> const names{"pressure", "density", "velocity", "TNT", "C-4"};
  EXPECT_EQ(deck::nearest("presure", names), "pressure");
  EXPECT_EQ(deck::nearest("PRESSURE", names), "pressure");
  EXPECT_EQ(deck::nearest("denisty", names), "density");
  EXPECT_EQ(deck::nearest("tn", names), "TNT");
  EXPECT_EQ(deck::nearest("c4", names), "C-4");
  EXPECT_EQ(deck::nearest("temperature", names), "");
  EXPECT_EQ(deck::nearest("x", names), "");
}

}  // namespace
}  // namespace brisance
