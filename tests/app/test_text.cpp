#include <gtest/gtest.h>

#include "app/commands.hpp"
#include "app/print.hpp"
#include "app/text.hpp"

namespace brisance::app {
namespace {

TEST(Text, QuantitiesTakeThePrefixThatKeepsThemShort) {
  EXPECT_EQ(quantity(12345.0, "Pa"), "12.35 kPa");
  EXPECT_EQ(quantity(101325.0, "Pa", 6), "101.325 kPa");
  EXPECT_EQ(quantity(0.00123, "s"), "1.23 ms");
  EXPECT_EQ(quantity(2.5e-9, "s"), "2.5 ns");
  EXPECT_EQ(quantity(-2e6, "J"), "-2 MJ");
  EXPECT_EQ(quantity(0.0, "Pa"), "0 Pa");
  EXPECT_EQ(quantity(1500.0, "kg"), "1500 kg");
  EXPECT_EQ(quantity(999.96, "Pa"), "1 kPa");
  EXPECT_EQ(quantity(999.94, "Pa"), "999.9 Pa");
}

TEST(Text, AVerdictSaysBalancedOnlyWhereAllIs) {
  EXPECT_EQ(verdict_word({}), "balanced");
  EXPECT_EQ(verdict_reasons({}, false), "");
  run::Verdict const wrong{false, true, {"one thing", "another"}};
  EXPECT_EQ(verdict_word(wrong), "NOT BALANCED");
  EXPECT_EQ(verdict_reasons(wrong, false), "NOT BALANCED: one thing\nNOT BALANCED: another\n");
  EXPECT_NE(verdict_reasons(wrong, true).find("meant for comparison"), std::string::npos);
  EXPECT_EQ(verdict_word({true, false, {}}).find("balanced"), std::string::npos);
  EXPECT_EQ(verdict_word({false, false, {"a mass"}}), "NOT BALANCED");
}

TEST(Text, WallTimesReadLikeAClock) {
  EXPECT_EQ(wall_time(4.24), "4.2 s");
  EXPECT_EQ(wall_time(59.4), "59 s");
  EXPECT_EQ(wall_time(59.6), "1 min 00 s");
  EXPECT_EQ(wall_time(192.0), "3 min 12 s");
  EXPECT_EQ(wall_time(18420.0), "5 h 07 min");
}

TEST(Text, SizesAndCounts) {
  EXPECT_EQ(bytes(999.0), "999 B");
  EXPECT_EQ(bytes(1.234e9), "1.23 GB");
  EXPECT_EQ(bytes(999.9e6), "1 GB");
  EXPECT_EQ(large_count(6000.0), "6000");
  EXPECT_EQ(large_count(1.5e6), "1.5 million");
}

TEST(Text, TheOutputFolderIsNamedAfterTheDeck) {
  EXPECT_EQ(default_output_folder("somewhere/blast.toml"), "blast-results");
  EXPECT_EQ(default_output_folder("cases/hemisphere_3d/deck.toml"), "hemisphere_3d-results");
}

TEST(Text, ControlCharactersOfADeckDoNotReachTheTerminal) {
  EXPECT_EQ(harmless("a\x1b[31mb\ac\x7f"), "a?[31mb?c?");
  EXPECT_EQ(harmless("a\u009b31mb"), "a?31mb");
  EXPECT_EQ(harmless("\r1 \t Pr\u00fcfling, 33 \u00b0\n"), "\r1 \t Pr\u00fcfling, 33 \u00b0\n");
}

TEST(Text, ListsShowTheFirstMessages) {
  EXPECT_EQ(listed({}), "");
  std::vector<std::string> messages(most_messages, "x");
  EXPECT_EQ(listed(messages).size(), 100U);
  messages.resize(1000, "y");
  EXPECT_TRUE(listed(messages).ends_with("x\nand 950 more\n"));
}

}  // namespace
}  // namespace brisance::app
