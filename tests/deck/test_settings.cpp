/// Options from the declarations of their keys: a member's value in fresh options is the key's default.
#include <gtest/gtest.h>

#include "core/models.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"

namespace brisance::deck {
namespace {

enum class Colour { red, blue };
constexpr auto words(Colour) { return std::array{Word{Colour::red, "red"}, Word{Colour::blue, "blue"}}; }

struct Paint {
  double weight = 2.5;
  int layers = 3;
  long strokes = 0;
  bool dry = true;
  bool matt = false;
  Colour colour = Colour::blue;
  std::optional<double> gloss;
  std::vector<double> times{1.0, 2.0};
  std::vector<std::string> names{"wall"};
};

Settings<Paint> const& settings() {
  static Settings<Paint> const all{{&Paint::weight, number("weight", "kg", 0.0, 10.0)},
                                   {&Paint::layers, typed(Type::integer, "layers", "1", 1, 9)},
                                   {&Paint::strokes, typed(Type::integer, "strokes", "1", 0, 9).note("as it comes")},
                                   {&Paint::dry, typed(Type::boolean, "dry")},
                                   {&Paint::matt, word("finish", {"matt", "shiny"})},
                                   typed(Type::text, "title").of("none"),
                                   {&Paint::colour, word<Colour>("colour")},
                                   {&Paint::gloss, number("gloss", "1", 0.0, 1.0).note("unknown")},
                                   {&Paint::times, typed(Type::numbers, "times", "s", 0.0, 9.0)},
                                   {&Paint::names, typed(Type::names, "names")}};
  return all;
}

/// The paint of a text; `sound` is what the settings answered.
Paint paint_of(std::string const& text, Table const& table, Settings<Paint> const& of, bool& sound) {
  Report report("paint");
  auto const section = read(text, table, report);
  Paint paint;
  sound = of.read(*section, paint);
  EXPECT_EQ(sound, !report.failed());
  return paint;
}

TEST(Settings, DefaultsAreThoseOfFreshOptions) {
  auto const keys = settings().keys();
  ASSERT_EQ(keys.size(), 10U);
  EXPECT_EQ(std::get<double>(keys[0].fallback), 2.5);
  EXPECT_EQ(std::get<long>(keys[1].fallback), 3);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(keys[2].fallback)) << "the note says what holds without it";
  EXPECT_EQ(std::get<bool>(keys[3].fallback), true);
  EXPECT_EQ(std::get<std::string>(keys[4].fallback), "shiny");
  EXPECT_EQ(std::get<std::string>(keys[5].fallback), "none") << "a key that is read elsewhere keeps its own";
  EXPECT_EQ(std::get<std::string>(keys[6].fallback), "blue");
  EXPECT_TRUE(std::holds_alternative<std::monostate>(keys[7].fallback));
}

TEST(Settings, EveryKindOfMemberIsSet) {
  Table const table{"", settings().keys(), {}, {}};
  bool sound = false;
  Paint const p = paint_of(
      "weight = \"500 g\"\nlayers = 4\nstrokes = 5\ndry = false\nfinish = \"matt\"\ncolour = \"red\"\ngloss = 0.5\n"
      "times = [3]\nnames = [\"door\", \"roof\"]\n",
      table, settings(), sound);
  EXPECT_TRUE(sound);
  EXPECT_EQ(p.weight, 0.5);
  EXPECT_EQ(p.layers, 4);
  EXPECT_EQ(p.strokes, 5);
  EXPECT_FALSE(p.dry);
  EXPECT_TRUE(p.matt);
  EXPECT_EQ(p.colour, Colour::red);
  EXPECT_EQ(p.gloss, 0.5);
  EXPECT_EQ(p.times, std::vector<double>{3.0});
  EXPECT_EQ(p.names, (std::vector<std::string>{"door", "roof"}));
  Paint const untouched = paint_of("", table, settings(), sound);
  EXPECT_TRUE(sound);
  EXPECT_EQ(untouched.layers, 3);
  EXPECT_FALSE(untouched.matt);
  EXPECT_EQ(untouched.colour, Colour::blue);
  EXPECT_EQ(untouched.times.size(), 2U);
}

TEST(Settings, WrongAndMissingValuesAreNotSound) {
  Settings<Paint> const needed{{&Paint::weight, number("weight", "kg", 0.0, 10.0).required()},
                               {&Paint::layers, typed(Type::integer, "layers", "1", 1, 9)}};
  Table const table{"", needed.keys(), {}, {}};
  EXPECT_TRUE(std::holds_alternative<std::monostate>(table.keys[0].fallback)) << "what is required has no default";
  bool sound = false;
  (void)paint_of("weight = 1\n", table, needed, sound);
  EXPECT_TRUE(sound);
  (void)paint_of("layers = 4\n", table, needed, sound);
  EXPECT_FALSE(sound) << "the weight is missing";
  Paint const p = paint_of("weight = 1\nlayers = 40\n", table, needed, sound);
  EXPECT_FALSE(sound) << "40 is out of range";
  EXPECT_EQ(p.weight, 1.0);
  EXPECT_EQ(p.layers, 3) << "a wrong value leaves the default";
}

}  // namespace
}  // namespace brisance::deck
