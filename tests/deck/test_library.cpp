#include <gtest/gtest.h>

#include <set>

#include "core/error.hpp"
#include "deck/library.hpp"
#include "files.hpp"
#include "material/chapman_jouguet.hpp"

namespace brisance {
namespace {

TEST(Library, HoldsEveryMaterialFile) {
  auto const files = test::files_in(test::root() / "materials", ".toml");
  EXPECT_EQ(deck::library().explosives.size() + deck::library().fluids.size() + deck::library().solids.size(),
            files.size());
}

TEST(Library, NamesAndAliasesAreUnique) {
  std::set<std::string> taken;
  auto const take = [&](std::string name, std::string const& owner) {
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    EXPECT_TRUE(taken.insert(name).second) << name << " of " << owner;
  };
  auto const all = [&](auto const& materials) {
    for (auto const& [material, aliases, note] : materials) {
      std::set<std::string> own;
      for (auto name : aliases) {
        for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        own.insert(name);
      }
      std::string lower = material.name;
      for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      own.insert(lower);
      for (auto const& name : own) take(name, material.name);
    }
  };
  all(deck::library().explosives);
  all(deck::library().fluids);
  all(deck::library().solids);
}

TEST(Library, ExplosivesAreConsistentAndSourced) {
  ASSERT_FALSE(deck::library().explosives.empty());
  for (auto const& [explosive, aliases, note] : deck::library().explosives) {
    EXPECT_TRUE(material::check(explosive).consistent()) << explosive.name;
    EXPECT_FALSE(explosive.source.empty()) << explosive.name;
  }
  for (auto const& [fluid, aliases, note] : deck::library().fluids) EXPECT_FALSE(fluid.source.empty()) << fluid.name;
  ASSERT_GE(deck::library().solids.size(), 6U);
  for (auto const& [solid, aliases, note] : deck::library().solids) EXPECT_FALSE(solid.source.empty()) << solid.name;
}

TEST(Library, TheValuesAreThoseOfTheFiles) {
  auto const* tnt = deck::library().explosive("trinitrotoluene");
  ASSERT_NE(tnt, nullptr);
  EXPECT_EQ(tnt->name, "TNT");
  EXPECT_EQ(tnt->products.rho0, 1630.0);
  EXPECT_EQ(tnt->products.A, 371.2e9);
  EXPECT_EQ(tnt->products.B, 3.21e9);
  EXPECT_EQ(tnt->products.R1, 4.15);
  EXPECT_EQ(tnt->products.R2, 0.95);
  EXPECT_EQ(tnt->products.omega, 0.3);
  EXPECT_EQ(tnt->energy, 6.993e9);
  EXPECT_EQ(tnt->detonation_speed, 6930.0);
  EXPECT_EQ(tnt->cj_pressure, 21e9);
  auto const* water = deck::library().fluid("water");
  ASSERT_NE(water, nullptr);
  EXPECT_EQ(std::get<material::StiffenedGas>(water->eos).p_inf, 6e8);
  auto const* steel = deck::library().fluid("STEEL");
  ASSERT_NE(steel, nullptr);
  EXPECT_EQ(std::get<material::MieGruneisen>(steel->eos).S, 1.49);
  EXPECT_EQ(deck::library().explosive("water"), nullptr);

  auto const* copper = deck::library().solid("ofhc");
  ASSERT_NE(copper, nullptr);
  EXPECT_EQ(copper->name, "OFHC-copper");
  EXPECT_EQ(std::get<material::MieGruneisen>(copper->eos).rho0, 8960.0);
  EXPECT_EQ(std::get<material::JohnsonCook>(copper->strength).B, 292e6);
  EXPECT_EQ(std::get<material::JohnsonCookFailure>(copper->failure).D3, -3.03);
  EXPECT_EQ(copper->specific_heat, 383.0);
  auto const* armour = deck::library().solid("RHA");
  ASSERT_NE(armour, nullptr);
  EXPECT_DOUBLE_EQ(std::get<material::JohnsonCook>(armour->strength).G, 210e9 / 2.56);
  // The straight line from the yield stress to the true stress at the ultimate load.
  auto const* plate = deck::library().solid("5086-H116");
  ASSERT_NE(plate, nullptr);
  double const ultimate = 290e6 * 1.12;
  double const plastic = std::log(1.12) - ultimate / 71e9;
  EXPECT_NEAR(std::get<material::VonMises>(plate->strength).hardening, (ultimate - 190e6) / plastic, 1e6);
}

TEST(Library, Descriptions) {
  std::string const list = deck::describe_library();
  for (auto const& name : deck::library().explosive_names())
    EXPECT_NE(list.find("  " + name + " "), std::string::npos) << name;
  for (auto const& name : deck::library().fluid_names())
    EXPECT_NE(list.find("  " + name + " "), std::string::npos) << name;

  for (auto const& name : deck::library().solid_names())
    EXPECT_NE(list.find("  " + name + " "), std::string::npos) << name;

  std::string const steel = deck::describe_material("4340-steel");
  EXPECT_EQ(steel.substr(0, 18), "4340-steel: solid\n");
  EXPECT_NE(steel.find("  T_melt                     1793 K       melting temperature\n"), std::string::npos) << steel;
  EXPECT_NE(steel.find("  D3                        -2.12         exponent of triaxiality D3\n"), std::string::npos)
      << steel;

  std::string const tnt = deck::describe_material("tnt");
  EXPECT_EQ(tnt.substr(0, 15), "TNT: explosive\n");
  EXPECT_NE(tnt.find("source: " + deck::library().explosive("TNT")->source), std::string::npos);
  EXPECT_NE(tnt.find("  R1                         4.15         JWL exponent R1\n"), std::string::npos) << tnt;
  EXPECT_NE(deck::describe_material("air").find("gamma"), std::string::npos);

  std::string const models = deck::describe_models();
  for (auto const* word : {"muscl-hancock", "lax-wendroff", "stiffened_gas", "mie_gruneisen", "hemisphere", "periodic",
                           "spherical1d", "peak_overpressure", "von_mises", "bspline", "musl", "plastic_strain"}) {
    EXPECT_NE(models.find(word), std::string::npos) << word;
  }
}

TEST(Library, UnknownMaterialsNameTheNearest) {
  try {
    (void)deck::describe_material("TNTT");
    FAIL();
  } catch (InputError const& error) {
    EXPECT_STREQ(error.what(), "\"TNTT\" is not a known material; did you mean \"TNT\"?");
  }
}

TEST(Library, UnknownTntEquivalentsStayUnknown) {
  auto const& all = deck::library();
  for (auto const& [explosive, aliases, note] : all.explosives) {
    if (!explosive.name.starts_with("TNT")) continue;
    EXPECT_EQ(explosive.tnt_equivalent_pressure, 1.0) << explosive.name;
    EXPECT_EQ(explosive.tnt_equivalent_impulse, 1.0) << explosive.name;
  }
  EXPECT_EQ(all.explosive("ANFO")->tnt_equivalent_pressure, 0.82);
  EXPECT_FALSE(all.explosive("ANFO")->tnt_equivalent_impulse);
  EXPECT_EQ(all.explosive("C-4")->tnt_equivalent_impulse, 1.19);
}

}  // namespace
}  // namespace brisance
