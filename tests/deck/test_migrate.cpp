/// Keys with new names: errors name them, and `migrate` rewrites a deck without touching anything else.
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "deck/deck.hpp"
#include "deck/migrate.hpp"

namespace brisance::deck {
namespace {

TEST(Migrate, RenamesEveryFormOfAKeyAndKeepsCommentsAndLayout) {
  std::string const old = R"(# region: high pressure
[[region]] # the first region
shape = "sphere"
[[ region ]]
fluid = "region"
note = "é [[region]]"
[[constraint]]
body = "plate"   # held
region = {shape = "box", lower = [0, 0], upper = [1, 1]}
held = ["x"]
[[constraint]]
"region" = {shape = "sphere", radius = 1}
[[constraint]]
body = "b"
[constraint.region]
shape = "box"
[[surface_pressure]]
held = 1
region.shape = "box"
[mpm_region]
width = 5
)";
  std::string const expected = R"(# region: high pressure
[[initial_state]] # the first region
shape = "sphere"
[[ initial_state ]]
fluid = "region"
note = "é [[region]]"
[[constraint]]
body = "plate"   # held
within = {shape = "box", lower = [0, 0], upper = [1, 1]}
components = ["x"]
[[constraint]]
"within" = {shape = "sphere", radius = 1}
[[constraint]]
body = "b"
[constraint.within]
shape = "box"
[[surface_pressure]]
held = 1
within.shape = "box"
[mpm_region]
width = 5
)";
  Migration const result = migrate(old, "deck.toml");
  EXPECT_EQ(result.text, expected);
  ASSERT_EQ(result.renamings.size(), 7U);
  EXPECT_EQ(result.renamings[0].line, 2);
  EXPECT_EQ(result.renamings[0].was, "region");
  EXPECT_EQ(result.renamings[2].now, "constraint.within");
  EXPECT_EQ(migrate(result.text, "deck.toml").text, result.text);
}

TEST(Migrate, RenamesWithinInlineTables) {
  std::string const text = R"(constraint = [{body = "é", region = {shape = "box"}}, {held = ["y"]}]
region = [{shape = "box"}]
)";
  EXPECT_EQ(migrate(text, "deck.toml").text,
            R"(constraint = [{body = "é", within = {shape = "box"}}, {components = ["y"]}]
initial_state = [{shape = "box"}]
)");
}

TEST(Migrate, RefusesWhatItCannotRename) {
  EXPECT_THROW((void)migrate("a = ", "deck.toml"), InputError);
  EXPECT_THROW((void)migrate("[[region]]\n[[initial_state]]\n", "deck.toml"), InputError);
}

TEST(Migrate, AnOldKeyIsAnErrorThatNamesTheNewOne) {
  Result const result = read_text(R"([domain]
size = [1, 1, 1]
cell = 0.1
[[region]]
shape = "sphere"
position = [0.5, 0.5, 0.5]
radius = 0.2
pressure = "2 bar"
[end]
time = 1
)",
                                  "deck.toml");
  ASSERT_EQ(result.errors.size(), 1U);
  EXPECT_EQ(result.errors[0].line, 4);
  EXPECT_NE(result.errors[0].message.find("\"region\" is now called \"initial_state\""), std::string::npos)
      << result.errors[0].message;
  EXPECT_NE(result.errors[0].message.find("brisance migrate"), std::string::npos);
}

}  // namespace
}  // namespace brisance::deck
