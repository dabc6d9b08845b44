/// The material files of the project: complete, sourced, consistent, and described in the documentation.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "material/chapman_jouguet.hpp"
#include "material_files.hpp"

namespace {

using namespace brisance;

TEST(MaterialFiles, EveryExplosiveIsConsistentWithItsChapmanJouguetState) {
  auto const files = test::read_material_files();
  EXPECT_GE(files.explosives.size(), 25U);
  for (auto const& explosive : files.explosives) {
    auto const check = material::check(explosive);
    EXPECT_TRUE(check.consistent()) << explosive.name << ": D " << check.state.speed << " m/s, listed "
                                    << explosive.detonation_speed << "; P " << check.state.pressure << " Pa, listed "
                                    << explosive.cj_pressure;
  }
}

TEST(MaterialFiles, TheDefaultTntIsThatOfThePaper) {
  auto const files = test::read_material_files();
  auto const tnt =
      std::find_if(files.explosives.begin(), files.explosives.end(), [](auto const& e) { return e.name == "TNT"; });
  ASSERT_NE(tnt, files.explosives.end());
  EXPECT_EQ(tnt->products.rho0, 1630.0);
  EXPECT_EQ(tnt->products.A, 371.2e9);
  EXPECT_EQ(tnt->products.B, 3.21e9);
  EXPECT_EQ(tnt->products.R1, 4.15);
  EXPECT_EQ(tnt->products.R2, 0.95);
  EXPECT_EQ(tnt->products.omega, 0.3);
  EXPECT_EQ(tnt->energy, 6.993e9);
}

TEST(MaterialFiles, NamesAreUnique) {
  auto names = test::read_material_files().names;
  std::sort(names.begin(), names.end());
  auto const twice = std::adjacent_find(names.begin(), names.end());
  EXPECT_EQ(twice, names.end()) << *twice;
}

TEST(MaterialFiles, FluidsAtRestHaveTheSoundSpeedOfTheHandbooks) {
  // Measured sound speeds at 15 to 20 degrees Celsius [Kinsler00]; metals: the bulk speed C0 itself. The stiffened gas
  // of water is fitted to strong shocks and 10 % too stiff at rest.
  struct Row {
    char const* name;
    double speed, tolerance;
  };
  Row const rows[] = {{"air", 340.3, 0.001},       {"helium", 999.0, 0.01},   {"water", 1625.0, 0.002},
                      {"water_mg", 1480.0, 0.001}, {"copper", 3940.0, 0.001}, {"steel", 4569.0, 0.001}};
  auto const fluids = test::read_material_files().fluids;
  EXPECT_EQ(fluids.size(), std::size(rows));
  for (auto const& row : rows) {
    auto const fluid = std::find_if(fluids.begin(), fluids.end(), [&](auto const& f) { return f.name == row.name; });
    ASSERT_NE(fluid, fluids.end()) << row.name;
    EXPECT_NEAR(material::sound_speed(fluid->eos, fluid->density, fluid->pressure), row.speed,
                row.tolerance * row.speed)
        << row.name;
  }
}

TEST(MaterialFiles, SolidsHaveTheElasticityOfTheHandbooks) {
  // Young's modulus and Poisson's ratio of steel, copper and aluminium of this kind, as every handbook gives them, and
  // the longitudinal sound speed. The bulk moduli of shock data and the shear moduli come from different sources, hence
  // the 5 %; Poisson's ratio, which hangs on their difference, is met within 0.03.
  struct Row {
    char const* name;
    double E, nu, speed;
  };
  Row const rows[] = {
      {"RHA", 210e9, 0.28, 5900.0},
      {"4340-steel", 207e9, 0.30, 5950.0},
      {"1006-steel", 207e9, 0.29, 5900.0},
      {"OFHC-copper", 124e9, 0.34, 4700.0},
      {"6061-T6", 69e9, 0.33, 6350.0},
      {"5086-H116", 71e9, 0.33, 6250.0},
      // E and nu as the files say they follow, and with them c^2 = E (1 - nu) / (rho (1 + nu)(1 - 2 nu)).
      {"concrete-48MPa", 34e9, 0.146, 3830.0},
      {"concrete-25MPa", 23.65e9, 0.2, 3370.0},
      {"soil", 100e6, 0.3, 335.0}};
  auto const solids = test::read_material_files().solids;
  EXPECT_EQ(solids.size(), std::size(rows));
  for (auto const& row : rows) {
    auto const solid = std::find_if(solids.begin(), solids.end(), [&](auto const& s) { return s.name == row.name; });
    ASSERT_NE(solid, solids.end()) << row.name;
    double const K = material::bulk_modulus(solid->eos, solid->density, 0.0);
    double const G = material::shear_modulus(solid->strength);
    EXPECT_NEAR(9.0 * K * G / (3.0 * K + G), row.E, 0.05 * row.E) << row.name;
    EXPECT_NEAR((3.0 * K - 2.0 * G) / (6.0 * K + 2.0 * G), row.nu, 0.03) << row.name;
    EXPECT_NEAR(material::sound_speed(*solid, solid->density, 0.0), row.speed, 0.05 * row.speed) << row.name;
  }
}

TEST(MaterialFiles, JohnsonCookFilesHoldConsistentTemperatures) {
  int seen = 0;
  for (auto const& solid : test::read_material_files().solids) {
    auto const* cook = std::get_if<material::JohnsonCook>(&solid.strength);
    if (cook == nullptr) continue;
    ++seen;
    EXPECT_EQ(cook->T_room, solid.temperature) << solid.name;
    EXPECT_GT(cook->T_melt, 900.0) << solid.name;
    EXPECT_TRUE(solid.heats()) << solid.name;
    // Dulong and Petit: 3 R per mole, 24.9 J/K, within 10 % at room temperature for these metals.
    double const molar = solid.density > 8500.0 ? 63.55e-3 : solid.density > 7000.0 ? 55.85e-3 : 26.98e-3;
    EXPECT_NEAR(solid.specific_heat * molar, 24.9, 2.5) << solid.name;
  }
  EXPECT_EQ(seen, 5);
}

TEST(MaterialFiles, DocumentationHoldsTheTableAsComputed) {
  std::ifstream file(BRISANCE_DOCS_DIR "/materials.md");
  std::stringstream text;
  text << file.rdbuf();
  std::string table;
  for (auto const& line : test::chapman_jouguet_table(test::read_material_files().explosives)) table += line + "\n";
  EXPECT_NE(text.str().find(table), std::string::npos) << "docs/materials.md is out of date; the table is now\n"
                                                       << table;
  std::string solids;
  for (auto const& line : test::solid_table(test::read_material_files().solids)) solids += line + "\n";
  EXPECT_NE(text.str().find(solids), std::string::npos) << "docs/materials.md is out of date; the table is now\n"
                                                        << solids;
}

}  // namespace
