#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "deck/deck.hpp"
#include "deck/library.hpp"
#include "files.hpp"

namespace brisance {
namespace {

using detonation::Box;
using detonation::Cylinder;
using detonation::Hemisphere;
using detonation::Sphere;

run::Case read(std::string const& text) {
  auto const result = deck::read_text(text, "deck");
  std::string errors;
  for (auto const& error : result.errors) errors += deck::format(error) + "\n";
  if (!result.case_) throw std::runtime_error(errors);
  return *result.case_;
}

run::Case read_good(std::string const& name) { return read(test::file_text(test::root() / "tests/deck/good" / name)); }

std::string const small_domain = "[end]\ntime = 1e-3\n[domain]\nsize = [2, 2, 2]\ncell = 0.05\n";

std::vector<std::filesystem::path> example_decks() {
  std::vector<std::filesystem::path> decks;
  for (auto const& entry : std::filesystem::directory_iterator(test::root() / "cases")) {
    if (std::filesystem::exists(entry.path() / "deck.toml")) decks.push_back(entry.path() / "deck.toml");
  }
  std::sort(decks.begin(), decks.end());
  return decks;
}

TEST(GoodDecks, ExamplesAreReadWithoutWarnings) {
  auto const decks = example_decks();
  EXPECT_GE(decks.size(), 4U);
  for (auto const& path : decks) {
    auto const result = deck::read_file(path.string());
    EXPECT_TRUE(result.case_.has_value())
        << path << ": " << (result.errors.empty() ? "" : deck::format(result.errors.front()));
    EXPECT_TRUE(result.warnings.empty()) << path << ": " << (result.warnings.empty() ? "" : result.warnings.front());
  }
}

TEST(GoodDecks, TheDemonstrationIsSmallAndItsMassExact) {
  auto const result = deck::read_file((test::root() / "cases/hemisphere_3d/deck.toml").string());
  ASSERT_TRUE(result.case_);
  run::Case const& c = *result.case_;
  EXPECT_LE(c.domain.cell_count(), 1200000);
  ASSERT_EQ(c.charges.size(), 1U);
  auto const& body = std::get<Hemisphere>(c.charges[0].shape);
  EXPECT_DOUBLE_EQ(c.charges[0].mass, 10.0);
  EXPECT_NEAR(2.0 / 3.0 * std::numbers::pi * std::pow(body.radius, 3) * 1630.0, 10.0, 1e-12);
  EXPECT_EQ(c.burst, run::Burst::hemispherical);
  ASSERT_EQ(c.gauges.size(), 4U);
  EXPECT_EQ(c.gauges[3].name, "g1-4");
  EXPECT_EQ(c.gauges[3].position, (Vec3{4.0, 0.0, 0.0}));
  EXPECT_EQ(c.domain.boundary[0], grid::Boundary::symmetry);
  EXPECT_EQ(c.domain.boundary[1], grid::Boundary::outflow);
  EXPECT_EQ(c.domain.boundary[4], grid::Boundary::wall);
}

TEST(GoodDecks, DefaultsOfTheShortestDeck) {
  std::string const text = test::file_text(test::root() / "tests/deck/good/shortest.toml");
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 15);
  run::Case const c = read(text);
  run::Case const standard;
  EXPECT_EQ(c.domain.geometry, grid::Geometry::cartesian3d);
  EXPECT_EQ(c.domain.cells, (Index3{80, 80, 80}));
  for (auto const b : c.domain.boundary) EXPECT_EQ(b, grid::Boundary::outflow);
  EXPECT_EQ(c.ambient.fluid.name, "air");
  EXPECT_DOUBLE_EQ(c.ambient.state.density, 1.225);
  EXPECT_DOUBLE_EQ(c.ambient.state.pressure, 101325.0);
  ASSERT_EQ(c.charges.size(), 1U);
  EXPECT_EQ(c.charges[0].explosive.name, "TNT");
  EXPECT_EQ(c.charges[0].detonation, run::Detonation::programmed);
  ASSERT_EQ(c.charges[0].initiation.size(), 1U);
  EXPECT_EQ(c.charges[0].initiation[0].position, (Vec3{1.0, 1.0, 1.0}));
  EXPECT_EQ(c.charges[0].initiation[0].delay, 0.0);
  ASSERT_TRUE(c.second_fluid);
  EXPECT_EQ(c.second_fluid->name, "TNT");
  EXPECT_EQ(c.numerics.scheme, standard.numerics.scheme);
  EXPECT_EQ(c.numerics.courant, standard.numerics.courant);
  EXPECT_EQ(c.output.fields, standard.output.fields);
  EXPECT_EQ(c.end.time, 1e-3);
  EXPECT_EQ(c.burst, run::Burst::spherical);
  EXPECT_EQ(c.deck_text, text);
}

TEST(GoodDecks, EveryKeyArrives) {
  run::Case const c = read_good("all_keys.toml");
  EXPECT_EQ(c.title, "everything");
  EXPECT_EQ(c.domain.cells, (Index3{80, 40, 40}));
  EXPECT_EQ(c.domain.lower, (Vec3{0.0, -1.0, 0.0}));
  EXPECT_EQ(c.domain.boundary, (std::array{grid::Boundary::symmetry, grid::Boundary::inflow, grid::Boundary::wall,
                                           grid::Boundary::outflow, grid::Boundary::wall, grid::Boundary::outflow}));
  EXPECT_DOUBLE_EQ(c.inflow[1].velocity[0], -10.0);
  EXPECT_DOUBLE_EQ(c.inflow[1].pressure, 1.1e5);
  EXPECT_DOUBLE_EQ(c.inflow[1].density, c.ambient.state.density);
  EXPECT_NEAR(c.ambient.state.density, 1.225, 1e-12);  // 15 degC at 1 atm is the state of the library

  ASSERT_EQ(c.charges.size(), 3U);
  EXPECT_EQ(c.charges[0].explosive.name, "mine");
  EXPECT_EQ(c.charges[0].explosive.source, "made up for this test from TNT");
  EXPECT_EQ(c.charges[0].explosive.tnt_equivalent_pressure, 1.1);
  EXPECT_EQ(c.charges[0].explosive.tnt_equivalent_impulse, 1.05);
  EXPECT_DOUBLE_EQ(c.charges[0].explosive.products.A, 371.2e9);
  EXPECT_DOUBLE_EQ(c.charges[0].explosive.energy, 6.993e9);
  ASSERT_EQ(c.charges[0].initiation.size(), 2U);
  EXPECT_DOUBLE_EQ(c.charges[0].initiation[0].position[2], 0.05);
  EXPECT_DOUBLE_EQ(c.charges[0].initiation[1].position[2], 0.0);
  EXPECT_DOUBLE_EQ(c.charges[0].initiation[1].delay, 2e-6);
  auto const& cylinder = std::get<Cylinder>(c.charges[1].shape);
  EXPECT_EQ(cylinder.axis, (Vec3{1.0, 0.0, 0.0}));
  EXPECT_DOUBLE_EQ(cylinder.length, 4.0 * cylinder.radius);
  EXPECT_NEAR(std::numbers::pi * cylinder.radius * cylinder.radius * cylinder.length * 1630.0, 10.0, 1e-12);
  EXPECT_EQ(c.charges[1].detonation, run::Detonation::instantaneous);
  EXPECT_NEAR(c.charges[2].mass, 0.027 * 1630.0, 1e-12);

  ASSERT_EQ(c.gauges.size(), 12U);
  EXPECT_EQ(c.gauges[0].name, "g1");
  EXPECT_EQ(c.gauges[5].name, "row-5");
  EXPECT_EQ(c.gauges[5].position, (Vec3{3.0, 0.5, 0.0}));
  EXPECT_EQ(c.gauges[11].name, "sheet-6");
  EXPECT_EQ(c.gauges[11].position, (Vec3{2.0, 0.5, 1.5}));
  EXPECT_EQ(c.gauges[7].position, (Vec3{2.0, 0.0, 1.5}));

  ASSERT_EQ(c.obstacles.size(), 1U);
  EXPECT_EQ(c.obstacles[0].name, "block");
  ASSERT_EQ(c.regions.size(), 2U);
  EXPECT_FALSE(c.regions[0].second_fluid);
  EXPECT_DOUBLE_EQ(c.regions[0].state.density, 2.0);
  EXPECT_DOUBLE_EQ(c.regions[0].state.pressure, 2e5);
  EXPECT_TRUE(c.regions[1].second_fluid);
  EXPECT_EQ(c.regions[1].fluid_name, "mine");
  EXPECT_DOUBLE_EQ(c.regions[1].state.density, 1630.0);

  EXPECT_EQ(c.numerics.scheme, run::Scheme::lax_wendroff);
  EXPECT_EQ(c.numerics.courant, 0.6);
  EXPECT_EQ(c.numerics.block_cells, 16);
  EXPECT_FALSE(c.numerics.sleep);
  EXPECT_DOUBLE_EQ(c.numerics.pressure_floor, 1e-3);
  EXPECT_EQ(c.numerics.viscosity, 0.5);
  EXPECT_DOUBLE_EQ(c.output.field_interval, 1e-3);
  EXPECT_EQ(c.output.field_times, (std::vector{0.5e-3, 2.5e-3}));
  EXPECT_DOUBLE_EQ(c.output.gauge_interval, 5e-6);
  EXPECT_FALSE(c.output.peak_fields);
  EXPECT_FALSE(c.output.single_precision);
  EXPECT_EQ(c.output.fields, (std::vector<std::string>{"pressure", "velocity"}));
  EXPECT_EQ(c.end.steps, 500);
  EXPECT_EQ(c.burst, run::Burst::none);
}

TEST(GoodDecks, OneDimensionMayDoWithoutBrackets) {
  run::Case const c = read_good("shock_tube.toml");
  EXPECT_EQ(c.domain.cells, (Index3{1000, 1, 1}));
  EXPECT_EQ(c.ambient.fluid.name, "tube");
  EXPECT_DOUBLE_EQ(c.ambient.state.pressure, 0.1);
  EXPECT_FALSE(c.second_fluid);
  ASSERT_EQ(c.regions.size(), 1U);
  auto const& box = std::get<Box>(c.regions[0].shape);
  EXPECT_DOUBLE_EQ(box.lower[0], 0.0);
  EXPECT_DOUBLE_EQ(box.upper[0], 0.5);
  EXPECT_TRUE(c.charges.empty());
  EXPECT_EQ(c.burst, run::Burst::none);
}

TEST(GoodDecks, MassAndSizeInEveryGeometry) {
  auto const charge = [](std::string const& geometry, std::string const& size, std::string const& more) {
    return read("[end]\ntime = 1\n[domain]\ngeometry = \"" + geometry + "\"\nsize = " + size +
                "\ncell = 0.05\n[[charge]]\n" + more)
        .charges.at(0);
  };
  double const pi = std::numbers::pi;
  double const rho = 1630.0;
  // Whole bodies, per metre in planar2d and cylindrical1d, per square metre in planar1d.
  EXPECT_NEAR(std::get<Sphere>(charge("spherical1d", "4", "mass = 10").shape).radius,
              std::cbrt(10.0 / rho / (4.0 / 3.0 * pi)), 1e-14);
  EXPECT_NEAR(std::get<Cylinder>(charge("cylindrical1d", "4", "mass = \"10 kg/m\"").shape).radius,
              std::sqrt(10.0 / rho / pi), 1e-14);
  auto const slab = std::get<Box>(charge("planar1d", "4", "mass = \"10 kg/m2\"\nposition = 2").shape);
  EXPECT_NEAR(slab.upper[0] - slab.lower[0], 10.0 / rho, 1e-14);
  EXPECT_NEAR(std::get<Cylinder>(charge("planar2d", "[4, 4]", "mass = \"10 kg\"\nposition = [2, 2]").shape).radius,
              std::sqrt(10.0 / rho / pi), 1e-14);
  EXPECT_NEAR(std::get<Sphere>(charge("axisymmetric2d", "[4, 4]", "mass = 10\nposition = [0, 2]").shape).radius,
              std::cbrt(10.0 / rho / (4.0 / 3.0 * pi)), 1e-14);
  auto const cylinder =
      charge("axisymmetric2d", "[4, 4]", "mass = 10\nshape = \"cylinder\"\nlength = 0.2\nposition = [0, 2, 0]");
  EXPECT_NEAR(std::get<Cylinder>(cylinder.shape).radius, std::sqrt(10.0 / rho / (0.2 * pi)), 1e-14);
  EXPECT_EQ(std::get<Cylinder>(cylinder.shape).axis, (Vec3{0.0, 1.0, 0.0}));
  EXPECT_NEAR(charge("axisymmetric2d", "[4, 4]", "shape = \"box\"\nlower = [1, 1]\nupper = [1.1, 1.2]").mass,
              rho * pi * (1.21 - 1.0) * 0.2, 1e-10);
  // Mass and size together, where they agree.
  EXPECT_DOUBLE_EQ(charge("spherical1d", "4", "mass = 10\nradius = 0.11356").mass, 10.0);
}

TEST(GoodDecks, BoundariesAtTheAxisAreSymmetric) {
  auto const c = read(
      "[end]\ntime = 1\n[domain]\ngeometry = \"axisymmetric2d\"\nsize = [4, 4]\ncell = 0.05\n[boundaries]\nall = "
      "\"wall\"\n");
  EXPECT_EQ(c.domain.boundary[0], grid::Boundary::symmetry);
  EXPECT_EQ(c.domain.boundary[1], grid::Boundary::wall);
  auto const ring = read(
      "[end]\ntime = 1\n[domain]\ngeometry = \"cylindrical1d\"\nlower = 1\nupper = 4\ncell = 0.05\n[boundaries]\nall = "
      "\"wall\"\n");
  EXPECT_EQ(ring.domain.boundary[0], grid::Boundary::wall);
}

TEST(GoodDecks, TheBurstIsRecognised) {
  auto const burst = [](std::string const& more) { return read(small_domain + more).burst; };
  std::string const sphere = "[[charge]]\nmass = 1\nposition = [1, 1, 1]\n";
  std::string const half = "[[charge]]\nmass = 1\nshape = \"hemisphere\"\nposition = [1, 1, 0]\n";
  EXPECT_EQ(burst(sphere), run::Burst::spherical);
  EXPECT_EQ(burst(half + "[boundaries]\nz_low = \"wall\"\n"), run::Burst::hemispherical);
  EXPECT_EQ(burst(sphere + "[boundaries]\nz_low = \"wall\"\n"), run::Burst::none);      // a height of burst
  EXPECT_EQ(burst(sphere + "[boundaries]\nx_low = \"symmetry\"\n"), run::Burst::none);  // two charges, in truth
  EXPECT_EQ(burst(half), run::Burst::none);                                             // no ground
  EXPECT_EQ(burst(sphere + "[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\nposition = [0.2, 1, 1]\n"),
            run::Burst::none);
  EXPECT_EQ(burst(sphere + "[ambient]\nfluid = \"helium\"\n"), run::Burst::none);
  EXPECT_EQ(burst(sphere + "[compare]\nburst = \"hemispherical\"\n"), run::Burst::hemispherical);
}

TEST(GoodDecks, OwnFluidAndLibraryNamesAnyCase) {
  auto const c =
      read(small_domain +
           "[[charge]]\nexplosive = \"COMPOSITION-C4\"\nmass = 1\nposition = [1, 1, 1]\n[ambient]\nfluid = \"argon\"\n"
           "temperature = \"576.3 K\"\n[fluids.argon]\ngamma = 1.667\ndensity = 1.69\n");
  EXPECT_EQ(c.charges[0].explosive.name, "C-4");
  EXPECT_EQ(c.ambient.fluid.name, "argon");
  EXPECT_NEAR(c.ambient.state.density, 0.845, 1e-12);  // twice the temperature of the table
  EXPECT_DOUBLE_EQ(std::get<material::IdealGas>(c.ambient.fluid.eos).gamma, 1.667);
}

// What a machine can hold is for the program to say, and the same deck reads the same everywhere.
TEST(GoodDecks, SizeUpToTheLimitOfTheIndicesIsRead) {
  run::Case const c = read(
      "[domain]\nsize = [4, 4, 4]\ncell = \"3.125 mm\"\n[[charge]]\nmass = 1\n"
      "position = [1, 1, 1]\n[end]\ntime = \"1 ms\"\n");
  EXPECT_EQ(c.domain.cells, (Index3{1280, 1280, 1280}));
}

TEST(GoodDecks, WarningsNameWhatIsDoubtful) {
  auto const idle = deck::read_text(small_domain, "d");
  ASSERT_EQ(idle.warnings.size(), 1U);
  EXPECT_EQ(idle.warnings[0],
            "d:1:1: warning: charge: nothing will happen: there is no charge, no region and no inflow");
  auto const odd = deck::read_text(
      small_domain +
          "[[charge]]\nexplosive = \"TNT\"\nmass = 5\nposition = [1, 1, 1]\n[explosives.TNT]\nrho0 = 1630\n"
          "A = 371.2e9\nB = 3.21e9\nR1 = 4.15\nR2 = 0.95\nomega = 0.3\nenergy = 6.993e9\n"
          "detonation_speed = 8000\ncj_pressure = 21e9\n",
      "d");
  ASSERT_EQ(odd.warnings.size(), 2U);
  EXPECT_NE(odd.warnings[0].find("the constants give a detonation speed of 69"), std::string::npos) << odd.warnings[0];
  EXPECT_EQ(odd.warnings[1],
            "d:10:13: warning: explosives.TNT: replaces the explosive of the same name in the library");
}

}  // namespace
}  // namespace brisance
