/// Every broken deck of bad/ gives exactly the messages of its .expected file, word for word. `{Boundary}` in such a
/// file stands for the words of the enumeration, `{Eos}` for the names of the models: see `lists`.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/error.hpp"
#include "deck/deck.hpp"
#include "deck/models.hpp"
#include "files.hpp"
#include "grid/forest.hpp"
#include "observe/gas_fields.hpp"
#include "observe/particle_fields.hpp"

namespace brisance {
namespace {

std::string all_errors(deck::Result const& result) {
  std::string out;
  for (auto const& error : result.errors) out += deck::format(error) + "\n";
  return out;
}

/// The lists that the program has once, by what stands for them in the files.
std::vector<std::pair<std::string, std::vector<std::string>>> lists() {
  auto const names = [](std::vector<observe::FieldInfo> const& fields) {
    std::vector<std::string> all;
    for (auto const& field : fields) all.push_back(field.name);
    return all;
  };
  auto empty = all_words<grid::Boundary>();
  std::erase_if(empty, [](std::string const& name) { return grid::is_given(*value_of<grid::Boundary>(name)); });
  return {{"{Boundary}", all_words<grid::Boundary>()},
          {"{Boundary in empty space}", empty},
          {"{Scheme}", all_words<gas::Scheme>()},
          {"{ShapeFunction}", all_words<mpm::ShapeFunction>()},
          {"{Transfer}", all_words<mpm::Transfer>()},
          {"{Eos}", deck::model_names<material::Eos>()},
          {"{Strength}", deck::model_names<material::Strength>()},
          {"{gas fields}", names(observe::known_fields())},
          {"{particle fields}", names(observe::known_particle_fields())}};
}

std::string expected_of(std::filesystem::path const& file) {
  std::string text = test::file_text(file);
  for (auto const& [mark, words] : lists()) {
    std::string const list = deck::quoted_list(words);
    for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark, at + list.size()))
      text.replace(at, mark.size(), list);
  }
  return text;
}

class BadDeck : public testing::TestWithParam<std::filesystem::path> {};

/// Decks whose messages are other ones in a program whose grids have one level.
bool needs_levels(std::filesystem::path const& deck) { return deck.stem().string().starts_with("levels_"); }

TEST_P(BadDeck, GivesItsMessages) {
  if (needs_levels(GetParam()) && !grid::Forest::can_refine(2)) GTEST_SKIP() << "built without p4est";
  auto expected = GetParam();
  expected.replace_extension(".expected");
  auto const result = deck::read_text(test::file_text(GetParam()), GetParam().filename().string());
  EXPECT_FALSE(result.case_.has_value());
  EXPECT_EQ(all_errors(result), expected_of(expected));
}

INSTANTIATE_TEST_SUITE_P(Decks, BadDeck, testing::ValuesIn(test::files_in(test::root() / "tests/deck/bad", ".toml")),
                         [](auto const& deck) { return deck.param.stem().string(); });

TEST(BadDecks, AreEnough) { EXPECT_GE(test::files_in(test::root() / "tests/deck/bad", ".toml").size(), 20U); }

TEST(BadDecks, ErrorsComeInTheOrderOfTheText) {
  for (auto const& path : test::files_in(test::root() / "tests/deck/bad", ".toml")) {
    auto const result = deck::read_text(test::file_text(path), "deck");
    EXPECT_TRUE(std::is_sorted(result.errors.begin(), result.errors.end(), [](auto const& a, auto const& b) {
      return std::pair(a.line, a.column) < std::pair(b.line, b.column);
    })) << path;
  }
}

TEST(BadDecks, AllErrorsInOneGo) {
  std::string const deck = R"([domain]
size = [4, 4, 3.93]
cell = 0.05
sizee = 2
[boundaries]
x_low = "mirror"
[ambient]
pressure = "1 kg"
[[charge]]
explosive = "TMT"
mass = -1
[[gauge]]
point = [9, 9, 9]
[numerics]
courant = 7
[end]
time = "1 m"
)";
  auto const result = deck::read_text(deck, "d");
  std::vector<int> lines;
  for (auto const& error : result.errors) lines.push_back(error.line);
  // The extent of line 2 and the gauge of line 13 are not judged: the misspelt key of line 4 may be what was meant for
  // the size.
  EXPECT_EQ(lines, (std::vector{4, 6, 8, 10, 11, 15, 17}));
}

TEST(BadDecks, HugeCountsAreRefusedBeforeAnythingIsAllocated) {
  std::string const head = "[domain]\nsize = [4, 4, 4]\ncell = 0.1\n[end]\ntime = 1\n";
  auto const line =
      deck::read_text(head + "[[gauge]]\nline = {from = [0,0,0], to = [1,1,1], count = 9223372036854775807}", "d");
  EXPECT_EQ(all_errors(line),
            "d:7:47: error: gauge[1].line.count: 9223372036854775807 is out of range; allowed: 2 to 100000; write, for "
            "example, count = 5\n");
  std::string many = head;
  for (int i = 0; i < 3; ++i) many += "[[gauge]]\nline = {from = [0,0,0], to = [1,1,1], count = 60000}\n";
  auto const lines = deck::read_text(many, "d");
  ASSERT_EQ(lines.errors.size(), 2U);
  EXPECT_EQ(deck::format(lines.errors[0]),
            "d:9:47: error: gauge[2].line.count: 60000 further gauges give 120000 in total; allowed: at most 100000; "
            "use field dumps for dense data");
}

TEST(BadDecks, HostileTextsAreErrors) {
  EXPECT_EQ(all_errors(deck::read_text(std::string(2U << 20U, '#'), "d")),
            "d:1:1: error: the deck has 2097152 bytes; allowed: at most 1048576\n");
  EXPECT_EQ(all_errors(deck::read_text("a = " + std::string(100000, '['), "d")).substr(0, 38),
            "d:1:261: error: this is not valid TOML");
  std::string dotted = "a";
  for (int i = 0; i < 100000; ++i) dotted += ".a";
  EXPECT_EQ(all_errors(deck::read_text(dotted + " = 1", "d")),
            "d:1:2: error: a key with more than 32 parts; every key of a deck has only a few\n");
  EXPECT_FALSE(deck::read_text("title = \"\xff\xfe\"", "d").errors.empty());
  EXPECT_FALSE(deck::read_text(std::string_view("a\0b = 1", 7), "d").errors.empty());
}

TEST(BadDecks, AMissingFileIsAnInputOutputError) {
  EXPECT_THROW((void)deck::read_file("/nonexistent/deck.toml"), IoError);
}

TEST(BadDecks, AFolderIsAnInputOutputErrorAndAnEmptyFileIsADeckWithErrors) {
  EXPECT_THROW((void)deck::read_file(testing::TempDir()), IoError);
  EXPECT_FALSE(deck::read_file((test::root() / "tests/deck/bad/empty.toml").string()).errors.empty());
}

}  // namespace
}  // namespace brisance
