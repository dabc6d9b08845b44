#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "deck/deck.hpp"
#include "deck/library.hpp"
#include "files.hpp"
#include "setup/build.hpp"

namespace brisance {
namespace {

using shape::Box;
using shape::Cylinder;
using shape::Hemisphere;
using shape::Sphere;

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
  for (auto const& entry : std::filesystem::recursive_directory_iterator(test::root() / "cases")) {
    if (entry.path().extension() == ".toml") decks.push_back(entry.path());
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

std::string soil_deck(std::string const& friction, std::string const& more = "") {
  return "[end]\ntime = 1e-3\n[domain]\nsize = [1, 1, 1]\ncell = 0.05\n[points]\nbody_force = [0, 0, -9.81]\n"
         "[[body]]\nmaterial = \"sand\"\nshape = \"box\"\nlower = [0, 0, 0]\nupper = [1, 1, 0.5]\n"
         "[solids.sand]\ndensity = \"1.6 g/cm3\"\nE = \"5 MPa\"\nnu = 0.3\n" +
         more + "strength = {model = \"drucker_prager\", cohesion = 0, friction = " + friction + "}\n";
}

// An angle is degrees, however it is written.
TEST(GoodDecks, AnglesAreDegreesOrHaveAUnit) {
  auto const friction = [](std::string const& text) {
    run::Case const c = read(soil_deck(text));
    return std::get<material::DruckerPrager>(c.particles.bodies.at(0).solid.strength).friction;
  };
  for (auto const* text :
       {"33", "33.0", "\"33\"", "\"33 deg\"", "\"33 degree\"", "\"33 degrees\"", "\"33 °\"", "\"33°\""})
    EXPECT_EQ(friction(text), 33.0) << text;
  EXPECT_NEAR(friction("\"0.5 rad\""), 28.64788975654116, 1e-13);
  auto const radians = deck::read_text(soil_deck("0.576"), "d");
  ASSERT_EQ(radians.warnings.size(), 1U);
  EXPECT_NE(radians.warnings[0].find("strength.friction: 0.576 is 0.576 degrees: a number without a unit is in "
                                     "degrees; did you mean \"0.576 rad\"?"),
            std::string::npos)
      << radians.warnings[0];
  EXPECT_TRUE(deck::read_text(soil_deck("\"0.576 deg\""), "d").warnings.empty());
}

// What was understood, beside what the deck says.
TEST(GoodDecks, EveryNumberOfAMaterialIsTold) {
  auto const result = deck::read_text(soil_deck("\"33 degrees\"", "temperature = \"20 degC\"\n"), "d");
  ASSERT_TRUE(result.case_);
  ASSERT_EQ(result.materials.size(), 1U);
  auto const& sand = result.materials[0];
  EXPECT_EQ(sand.name, "sand");
  EXPECT_FALSE(sand.from_library);
  std::string told;
  for (auto const& n : sand.numbers) {
    told += n.word.empty() ? fmt::format("{} = {:.6g} {}", n.key, n.value, n.unit) : n.key + " = " + n.word;
    told += " <- " + n.said + "\n";
  }
  EXPECT_EQ(told,
            "density = 1600 kg/m3 <- \"1.6 g/cm3\"\n"
            "E = 5e+06 Pa <- \"5 MPa\"\n"
            "nu = 0.3 1 <- 0.3\n"
            "eos = linear <- from E and nu\n"
            "eos.rho0 = 1600 kg/m3 <- density\n"
            "eos.K = 4.16667e+06 Pa <- from E and nu\n"
            "strength = drucker_prager <- \"drucker_prager\"\n"
            "strength.G = 1.92308e+06 Pa <- from E and nu\n"
            "strength.cohesion = 0 Pa <- 0\n"
            "strength.friction = 33 deg <- \"33 degrees\"\n"
            "strength.dilation = 0 deg <- default\n"
            "strength.tension = 0 Pa <- default\n"
            "failure = none <- default\n"
            "specific_heat = 0 J/kg/K <- default\n"
            "temperature = 293.15 K <- \"20 degC\"\n"
            "taylor_quinney = 0.9 1 <- default\n");
  // Of gas and products, of the library and the deck's own.
  auto const all = deck::read_text(test::file_text(test::root() / "tests/deck/good/all_keys.toml"), "d");
  std::string names;
  for (auto const& m : all.materials) {
    names += fmt::format("{}{}{} ", m.name, m.from_library ? ":library" : "", m.used ? "" : ":unused");
    EXPECT_GE(m.numbers.size(), 3U) << m.name;
  }
  EXPECT_EQ(names, "air:library mine ");
  // One that no body is made of.
  auto const spare = deck::read_text(soil_deck("33") + "[solids.spare]\ndensity = 2000\nE = 1e9\nnu = 0.2\n", "d");
  ASSERT_EQ(spare.materials.size(), 2U);
  EXPECT_EQ(spare.materials[1].name, "spare");
  EXPECT_FALSE(spare.materials[1].used);
}

// Fluids that nothing holds together; a box of walls that they fill does.
TEST(GoodDecks, FluidsInEmptySpaceAreWarnedOf) {
  auto const warnings = [](std::string const& box, std::string const& material, std::string const& boundary) {
    auto const result =
        deck::read_text("[domain]\ngeometry = \"planar2d\"\nsize = [1, 1]\ncell = 0.1\n[boundaries]\nall = \"" +
                            boundary + "\"\n[[body]]\nname = \"b\"\nmaterial = " + material + "\nshape = \"box\"\n" +
                            box + "\n[end]\ntime = 1e-3\n",
                        "d");
    for (auto const& e : result.errors) ADD_FAILURE() << deck::format(e);
    std::string out;
    for (auto const& w : result.warnings) out += w;
    return out;
  };
  std::string const part = "lower = [0.2, 0.2]\nupper = [0.4, 0.4]";
  std::string const whole = "lower = [0, 0]\nupper = [1, 1]";
  EXPECT_NE(warnings(part, "\"air\"", "wall").find("will expand freely"), std::string::npos);
  EXPECT_NE(warnings(whole, "\"air\"", "outflow").find("will expand freely"), std::string::npos);
  EXPECT_NE(warnings(part, "\"water\"", "wall").find("write pressure = 0.001"), std::string::npos);
  EXPECT_EQ(warnings(part, "\"water\"\npressure = 0.001", "wall"), "");
  EXPECT_EQ(warnings(whole, "\"air\"", "wall"), "");
  EXPECT_EQ(warnings(part, "\"air\"\npressure = \"2 bar\"", "wall"), "") << "it is meant to burst";
  EXPECT_EQ(warnings(part, "\"air\"\nrigid = true", "wall"), "");
}

// Degrees Celsius without their unit are hardly ever kelvin.
TEST(GoodDecks, ColdTemperaturesAreWarnedOf) {
  auto const warnings = [](std::string const& temperature) {
    auto const result = deck::read_text(
        small_domain + "[ambient]\ntemperature = " + temperature + "\n[[charge]]\nmass = 1\nposition = [1, 1, 1]\n",
        "d");
    EXPECT_TRUE(result.case_) << temperature;
    std::string out;
    for (auto const& w : result.warnings) out += w;
    return out;
  };
  EXPECT_EQ(warnings("15"),
            "d:7:15: warning: ambient.temperature: 15 is 15 K or -258.15 degrees Celsius, colder than any natural air; "
            "a number without a unit is in kelvin; did you mean \"15 degC\"?");
  EXPECT_EQ(warnings("\"-130 degC\""),
            "d:7:15: warning: ambient.temperature: \"-130 degC\" is 143.15 K or -130 degrees Celsius, colder than any "
            "natural "
            "air");
  for (auto const* good : {"150", "288.15", "\"15 degC\"", "\"59 degF\"", "\"-60 degC\""})
    EXPECT_EQ(warnings(good), "") << good;
  auto const solid = deck::read_text(soil_deck("33", "temperature = 20\n"), "d");
  ASSERT_EQ(solid.warnings.size(), 1U);
  EXPECT_NE(solid.warnings[0].find("solids.sand.temperature: 20 is 20 K"), std::string::npos) << solid.warnings[0];
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
  ASSERT_EQ(c.other_fluids.size(), 1U);
  EXPECT_EQ(c.other_fluids[0].name, "TNT");
  EXPECT_EQ(c.numerics.scheme, standard.numerics.scheme);
  EXPECT_EQ(c.numerics.courant, standard.numerics.courant);
  EXPECT_EQ(c.output.fields, standard.output.fields);
  EXPECT_EQ(c.end.time, 1e-3);
  EXPECT_EQ(c.burst, run::Burst::spherical);
  EXPECT_EQ(c.deck_text, text);
}

TEST(GoodDecks, SubsetsReplaceTheWholeDomainUnlessItHasTimes) {
  std::string const head = small_domain + "[[charge]]\nmass = 1\nposition = [1, 1, 1]\n[output]\n";
  std::string const subset = "[[output.subset]]\nname = \"a\"\nplane = {normal = \"x\", at = 2}\n";
  EXPECT_TRUE(read(head).output.whole);
  EXPECT_FALSE(read(head + subset).output.whole);
  EXPECT_EQ(read(head + subset).output.subsets[0].interval, 0.0);
  EXPECT_TRUE(read(head + "field_interval = 0\n" + subset).output.whole);
  EXPECT_TRUE(read(head + "field_times = [5e-4]\n" + subset).output.whole);
}

TEST(GoodDecks, EveryKeyArrives) {
  run::Case const c = read_good("all_keys.toml");
  EXPECT_EQ(c.title, "everything");
  EXPECT_EQ(c.domain.cells, (Index3{80, 40, 40}));
  EXPECT_EQ(c.domain.lower, (Vec3{0.0, -1.0, 0.0}));
  EXPECT_EQ(c.domain.boundary,
            (std::array{grid::Boundary::symmetry, grid::Boundary::inflow, grid::Boundary::wall,
                        grid::Boundary::zero_gradient, grid::Boundary::wall, grid::Boundary::outflow}));
  EXPECT_DOUBLE_EQ(c.inflow[1].velocity[0], -10.0);
  EXPECT_DOUBLE_EQ(c.inflow[1].pressure, 1.1e5);
  EXPECT_DOUBLE_EQ(c.inflow[1].density, c.ambient.state.density);
  EXPECT_NEAR(c.ambient.state.density, 1.225, 1e-12);  // 15 degC at 1 atm is the state of the library

  ASSERT_EQ(c.charges.size(), 3U);
  EXPECT_EQ(c.charges[0].explosive.name, "mine");
  EXPECT_EQ(c.charges[0].explosive.source, "made up for this test from TNT; afterburn: made up");
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

  EXPECT_DOUBLE_EQ(*c.charges[0].explosive.afterburn_energy, 9e6);
  ASSERT_TRUE(c.afterburn);
  EXPECT_DOUBLE_EQ(c.afterburn->energy, 1e7);
  auto const& miller = std::get<material::MillerAfterburn>(c.afterburn->rate);
  EXPECT_NEAR(miller.rate, 6500.0, 1e-9);
  EXPECT_NEAR(miller.reference_pressure, 100e9, 1e-2);
  EXPECT_EQ(miller.m, 0.5);
  EXPECT_EQ(miller.n, 0.1667);
  EXPECT_DOUBLE_EQ(miller.minimum_pressure, 1e5);

  ASSERT_EQ(c.gauges.size(), 12U);
  EXPECT_EQ(c.gauges[0].name, "g1");
  EXPECT_EQ(c.gauges[5].name, "row-5");
  EXPECT_EQ(c.gauges[5].position, (Vec3{3.0, 0.5, 0.0}));
  EXPECT_EQ(c.gauges[11].name, "sheet-6");
  EXPECT_EQ(c.gauges[11].position, (Vec3{2.0, 0.5, 1.5}));
  EXPECT_EQ(c.gauges[7].position, (Vec3{2.0, 0.0, 1.5}));

  ASSERT_EQ(c.obstacles.size(), 2U);
  EXPECT_EQ(c.obstacles[0].name, "block");
  EXPECT_FALSE(c.obstacles[0].release);
  ASSERT_TRUE(c.obstacles[1].release);
  EXPECT_DOUBLE_EQ(c.obstacles[1].release->pressure, 1e4);
  EXPECT_DOUBLE_EQ(c.obstacles[1].release->areal_mass, 10.0);
  ASSERT_EQ(c.initial_states.size(), 2U);
  EXPECT_EQ(c.initial_states[0].fluid, 0);
  EXPECT_DOUBLE_EQ(c.initial_states[0].state.density, 2.0);
  EXPECT_DOUBLE_EQ(c.initial_states[0].state.pressure, 2e5);
  EXPECT_EQ(c.initial_states[1].fluid, 1);
  EXPECT_EQ(c.initial_states[1].fluid_name, "mine");
  EXPECT_DOUBLE_EQ(c.initial_states[1].state.density, 1630.0);

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
  EXPECT_TRUE(c.output.whole);
  ASSERT_EQ(c.output.subsets.size(), 2U);
  EXPECT_EQ(c.output.subsets[0].name, "street");
  EXPECT_EQ(std::get<run::Plane>(c.output.subsets[0].place).normal, 2);
  EXPECT_EQ(std::get<run::Plane>(c.output.subsets[0].place).at, 1.5);
  EXPECT_EQ(c.output.subsets[0].level, -2);
  EXPECT_EQ(c.output.subsets[0].interval, 0.5e-3);
  EXPECT_EQ(c.output.subsets[0].fields, (std::vector<std::string>{"impulse", "mach"}));
  EXPECT_EQ(std::get<shape::Box>(c.output.subsets[1].place).lower, (Vec3{0.0, -0.5, 0.0}));
  EXPECT_EQ(std::get<shape::Box>(c.output.subsets[1].place).upper, (Vec3{1.0, 0.5, 0.25}));
  EXPECT_FALSE(c.output.subsets[1].level);
  EXPECT_EQ(c.output.subsets[1].interval, 1e-3);
  EXPECT_TRUE(c.output.subsets[1].fields.empty());
  EXPECT_EQ(c.end.steps, 500);
  EXPECT_TRUE(c.end.gauges);
  EXPECT_EQ(c.end.kinetic_energy, 0.02);
  EXPECT_EQ(c.end.wall_clock, 10800.0);
  EXPECT_EQ(c.burst, run::Burst::none);
}

TEST(GoodDecks, AltitudeIsTheStandardAtmosphere) {
  run::Case const sea = read(small_domain + "[ambient]\naltitude = 0\n");
  EXPECT_DOUBLE_EQ(sea.ambient.state.pressure, 101325.0);
  EXPECT_DOUBLE_EQ(sea.ambient.state.density, 1.225);
  // ISO 2533 at 3000 m: 70121.2 Pa, 268.659 K, 0.909254 kg/m3. The table's own 1.225 kg/m3 at sea level is rounded.
  run::Case const c = read(small_domain + "[ambient]\naltitude = \"3 km\"\n");
  EXPECT_NEAR(c.ambient.state.pressure, 70121.2, 0.1);
  EXPECT_NEAR(c.ambient.state.density, 0.909254, 1e-5);
}

TEST(GoodDecks, TheAfterburnTakesTheEnergyOfItsExplosive) {
  std::string const charge = small_domain + "[[charge]]\nexplosive = \"TNT\"\nmass = 1\nposition = [1, 1, 1]\n";
  EXPECT_FALSE(read(charge).afterburn);
  // The charge of 53 mm has burnt after 20 us at the latest: the corner of its box and 2.4 cells of 50 mm.
  run::Case const c = read(charge + "[afterburn]\nmodel = \"constant_rate\"\nbegin = \"40 us\"\nend = \"0.5 ms\"\n");
  ASSERT_TRUE(c.afterburn);
  EXPECT_EQ(c.afterburn->energy, *deck::library().explosive("TNT")->afterburn_energy);
  EXPECT_DOUBLE_EQ(std::get<material::ConstantRateAfterburn>(c.afterburn->rate).begin, 4e-5);
  EXPECT_FALSE(c.afterburn->carried());
  // Products in a region burn as those of charges do.
  run::Case const region =
      read(small_domain +
           "[[initial_state]]\nshape = \"sphere\"\nradius = 0.2\nposition = [1, 1, 1]\nfluid = \"TNT\"\n"
           "[afterburn]\nmodel = \"constant_rate\"\nbegin = 0\nend = \"0.5 ms\"\n");
  ASSERT_TRUE(region.afterburn);
}

TEST(GoodDecks, WhatHasNoEffectWarns) {
  auto const warnings = [](std::string const& text) {
    auto const result = deck::read_text(text, "d");
    EXPECT_TRUE(result.case_) << (result.errors.empty() ? "" : deck::format(result.errors.front()));
    std::string all;
    for (auto const& w : result.warnings) all += w + "\n";
    return all;
  };
  std::string const charge = "[[charge]]\nmass = 1\nposition = [1, 1, 1]\n";
  EXPECT_EQ(warnings(small_domain + charge), "");
  EXPECT_EQ(warnings(small_domain + charge + "initiation = [{delay = \"0.9 ms\"}]\n"), "");
  EXPECT_NE(
      warnings(small_domain + charge + "initiation = [{delay = \"2 ms\"}, {delay = \"1 ms\"}]\n")
          .find("charge[1].initiation: never detonates within this simulation: its time 0.001 s is after the end"),
      std::string::npos);
  EXPECT_NE(warnings(small_domain + charge + "[output]\ngauge_interval = 1\n").find("output.gauge_interval: is longer"),
            std::string::npos);
  // Of stairs, a slot of 20 mm in cells of 50 mm between two walls is closed; one of 60 mm is not.
  auto const walls = [&](double slot) {
    return small_domain + charge +
           "[numerics]\nobstacles = \"stairs\"\n[[obstacle]]\nshape = \"box\"\nlower = [0, 0, 0]\nupper = [0.51, 2, "
           "0.2]\n" +
           fmt::format("[[obstacle]]\nshape = \"box\"\nlower = [{}, 0, 0]\nupper = [1.5, 2, 0.2]\n", 0.51 + slot);
  };
  EXPECT_NE(warnings(walls(0.02)).find("obstacle[2].lower: the gap of 0.02 m between it and obstacle[1]"),
            std::string::npos)
      << warnings(walls(0.02));
  EXPECT_EQ(warnings(walls(0.06)), "");
  std::string const plate =
      small_domain +
      "[[body]]\nname = \"plate\"\nmaterial = \"RHA\"\nshape = \"box\"\nlower = [0.5, 0.5, 0.5]\nupper = [1, 1, 0.6]\n"
      "velocity = [0, 0, 1]\n";
  EXPECT_EQ(warnings(plate), "");
  EXPECT_NE(warnings(plate + "[[surface_pressure]]\nnormal = \"+z\"\nhistory = {times = [0, 0.002, 0.003], pressures = "
                             "[0, 0, 1e6]}\n")
                .find("surface_pressure[1].history: never acts within this simulation"),
            std::string::npos);
  EXPECT_NE(
      warnings(plate + "[[constraint]]\nwithin = {shape = \"box\", lower = [1.5, 0.5, 0.5], upper = [1.7, 1, 1]}\n")
          .find("constraint[1].within: contains no node of a body at the start"),
      std::string::npos);
  EXPECT_EQ(
      warnings(plate + "[[constraint]]\nwithin = {shape = \"box\", lower = [0.5, 0.5, 0.5], upper = [0.5001, 1, 1]}\n"),
      "");
}

TEST(GoodDecks, OneDimensionMayDoWithoutBrackets) {
  run::Case const c = read_good("shock_tube.toml");
  EXPECT_EQ(c.domain.cells, (Index3{1000, 1, 1}));
  EXPECT_EQ(c.ambient.fluid.name, "tube");
  EXPECT_DOUBLE_EQ(c.ambient.state.pressure, 0.1);
  EXPECT_TRUE(c.other_fluids.empty());
  ASSERT_EQ(c.initial_states.size(), 1U);
  auto const& box = std::get<Box>(c.initial_states[0].shape);
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

TEST(GoodDecks, EveryKeyOfMaterialPointsArrives) {
  run::Case const c = read_good("all_points.toml");
  run::Particles const& p = c.particles;
  ASSERT_EQ(p.bodies.size(), 5U);
  run::Body const& plate = p.bodies[0];
  EXPECT_EQ(plate.name, "plate");
  EXPECT_EQ(plate.particles_per_direction, 3);
  EXPECT_EQ(plate.velocity, (Vec3{0.0, 0.0, 10.0}));
  EXPECT_FALSE(plate.rigid);
  material::Material const& alu = plate.solid;
  EXPECT_EQ(alu.name, "alu");
  EXPECT_EQ(alu.source, "a book");
  EXPECT_EQ(alu.density, 2700.0);
  EXPECT_EQ(alu.minimum_pressure, -1e9);
  EXPECT_EQ(alu.spall, material::Spall::principal_stress);
  EXPECT_EQ(alu.specific_heat, 900.0);
  EXPECT_EQ(alu.temperature, 300.0);
  EXPECT_EQ(alu.taylor_quinney, 0.8);
  // E = 70 GPa and nu = 0.25: K = E / 1.5, G = E / 2.5.
  EXPECT_DOUBLE_EQ(std::get<material::Linear>(alu.eos).K, 70e9 / 1.5);
  EXPECT_EQ(std::get<material::Linear>(alu.eos).rho0, 2700.0);
  auto const& strength = std::get<material::VonMises>(alu.strength);
  EXPECT_DOUBLE_EQ(strength.G, 70e9 / 2.5);
  EXPECT_EQ(strength.yield, 200e6);
  EXPECT_EQ(strength.hardening, 1e9);
  auto const& failure = std::get<material::JohnsonCookFailure>(alu.failure);
  EXPECT_EQ(failure.D1, 0.1);
  EXPECT_EQ(failure.D5, 0.5);
  // Joined, then cut, then limited.
  auto const inside = [&](double x, double y, double z) { return shape::contains(plate.shape, {x, y, z}); };
  EXPECT_TRUE(inside(0.55, 0.4, 0.05));
  EXPECT_TRUE(inside(0.75, 0.12, 0.14));     // of the ball
  EXPECT_FALSE(inside(0.75, 0.05, 0.0));     // of the hole
  EXPECT_FALSE(inside(0.75, 0.101, -0.16));  // of the ball, below the limit

  EXPECT_EQ(p.bodies[0].lateral_stress, 1.0);
  EXPECT_EQ(p.bodies[0].motion.spin, (Vec3{0.0, 1.0, 0.0}));
  EXPECT_EQ(p.bodies[0].motion.centre, (Vec3{0.75, 0.0, 0.0}));
  EXPECT_TRUE(p.bodies[1].rigid);
  EXPECT_EQ(p.bodies[1].solid.name, "4340-steel");
  EXPECT_EQ(p.bodies[2].solid.name, "air");
  EXPECT_EQ(p.bodies[2].density, 2.45);
  EXPECT_DOUBLE_EQ(p.bodies[2].specific_energy.value(), 2e5 / (0.4 * 2.45));
  ASSERT_EQ(p.bodies[3].initiation.size(), 1U);
  EXPECT_EQ(p.bodies[3].initiation[0].position, (Vec3{1.6, 0.0, 0.0}));
  EXPECT_DOUBLE_EQ(p.bodies[3].initiation[0].delay, 1e-6);
  EXPECT_EQ(p.bodies[3].solid.detonation_speed, 6930.0);
  EXPECT_EQ(p.bodies[4].name, "body-5");
  EXPECT_EQ(p.bodies[4].solid.name, "C-4");
  EXPECT_TRUE(p.bodies[4].initiation.empty());

  ASSERT_EQ(p.constraints.size(), 4U);
  EXPECT_EQ(p.constraints[0].components, (std::array{true, true, true}));
  EXPECT_EQ(p.constraints[0].body, -1);
  EXPECT_EQ(std::get<Box>(p.constraints[0].within).upper[0], 0.55);
  EXPECT_EQ(p.constraints[1].components, (std::array{true, false, false}));
  EXPECT_EQ(p.constraints[1].body, 0);
  EXPECT_EQ(p.constraints[2].components, (std::array{true, true, false}));
  EXPECT_EQ(p.constraints[2].velocity, (Vec3{1.0, 2.0, 0.0}));
  EXPECT_EQ(p.constraints[2].body, 2);
  EXPECT_TRUE(std::holds_alternative<shape::Everywhere>(p.constraints[2].within));
  ASSERT_TRUE(p.constraints[3].history);
  EXPECT_EQ(p.constraints[3].velocity, (Vec3{0.0, 0.0, 1.0}));
  EXPECT_EQ(p.constraints[3].history->times, (std::vector{0.0, 1e-3}));
  EXPECT_EQ(p.constraints[3].history->values, (std::vector{1.0, 0.0}));
  EXPECT_FALSE(p.constraints[3].history->displacement);
  EXPECT_FALSE(p.constraints[3].history->release);

  ASSERT_EQ(p.contacts.size(), 1U);
  EXPECT_EQ(p.contacts[0].first, 1);
  EXPECT_EQ(p.contacts[0].second, 0);
  EXPECT_EQ(p.contacts[0].friction, 0.3);

  // Layers of particles are a third of a cell, 1/60 m thick; 40 mm are two of them, counted from the face at x = 1.
  ASSERT_EQ(p.pressures.size(), 2U);
  EXPECT_EQ(p.pressures[0].body, 0);
  EXPECT_EQ(p.pressures[0].normal, (Vec3{1.0, 0.0, 0.0}));
  EXPECT_NEAR(p.pressures[0].thickness, 2.0 / 60.0, 1e-12);
  EXPECT_EQ(p.pressures[0].times, (std::vector{0.0, 1e-3, 2e-3}));
  EXPECT_EQ(p.pressures[0].pressures, (std::vector{1e6, 0.0, 5.0}));
  // The face, and what rises of the ball above it and below it and looks that way.
  double face = 0.0;
  double ball = 0.0;
  for (shape::Facet const& f : p.pressures[0].surface) {
    EXPECT_GT(f.area[0], 0.0);
    (f.x[0] > 1.0 - 1e-9 ? face : ball) += f.area[0];
  }
  EXPECT_NEAR(face, 0.5 * 0.2, 1e-9);
  // Halves, by symmetry, of the two segments above and below z = 0.1 of a disc of 0.2: the lower is cut at -0.15, and
  // of the upper the hole leaves nothing from where the ball is as narrow as it.
  auto const segment = [](double z) { return 0.04 * std::acos(z / 0.2) - z * std::sqrt(0.04 - z * z); };
  EXPECT_NEAR(ball, 0.5 * (2.0 * segment(0.1) - segment(0.15) - segment(std::sqrt(0.03))), 0.03 * ball);
  EXPECT_NEAR(p.pressures[1].thickness, 1.0 / 60.0, 1e-12);
  EXPECT_EQ(p.pressures[1].times, (std::vector{0.0, 1e-6}));
  EXPECT_EQ(p.pressures[1].pressures, (std::vector{2e6, 2e6}));
  EXPECT_TRUE(shape::contains(p.pressures[1].within, {0.85, 0.25, -0.1 + 0.5 / 60.0}));
  EXPECT_FALSE(shape::contains(p.pressures[1].within, {0.85, 0.25, -0.1 + 1.5 / 60.0}));
  EXPECT_FALSE(shape::contains(p.pressures[1].within, {0.7, 0.25, -0.1 + 0.5 / 60.0}));

  ASSERT_EQ(p.gauges.size(), 2U);
  EXPECT_EQ(p.gauges[0].name, "g1");
  EXPECT_FALSE(p.gauges[0].point);
  EXPECT_EQ(p.gauges[1].name, "corner");
  EXPECT_EQ(p.gauges[1].point, (Vec3{1.0, 0.5, 0.1}));
  EXPECT_TRUE(c.gauges.empty());

  mpm::Options const& o = p.options;
  EXPECT_EQ(o.shape, mpm::ShapeFunction::cpgimp);
  EXPECT_EQ(o.order, mpm::StressOrder::usl);
  EXPECT_EQ(o.transfer, mpm::Transfer::xpic);
  EXPECT_EQ(o.xpic_order, 3);
  EXPECT_TRUE(o.locking_control);
  EXPECT_EQ(o.linear_viscosity, 0.1);
  EXPECT_EQ(o.quadratic_viscosity, 2.0);
  EXPECT_EQ(o.courant, 0.3);
  EXPECT_EQ(o.body_force, (Vec3{0.0, 0.0, -9.81}));
  EXPECT_EQ(o.wall_friction, 0.3);
  EXPECT_EQ(o.block_cells, 16);
  EXPECT_EQ(c.output.particle_fields, (std::vector<std::string>{"stress", "velocity"}));
  EXPECT_EQ(c.burst, run::Burst::none);
}

std::string const ball = "[[body]]\nmaterial = \"RHA\"\nradius = 0.2\nposition = [1, 1, 1]\n";

// The words of the deck and the default values of its manual are those of the method.
TEST(GoodDecks, DefaultsOfMaterialPoints) {
  mpm::Options const standard;
  for (std::string const particles : {"", "[points]\n"}) {
    run::Case const c = read(small_domain + ball + particles);
    mpm::Options const& o = c.particles.options;
    EXPECT_EQ(o.shape, standard.shape);
    EXPECT_EQ(o.order, standard.order);
    EXPECT_EQ(o.transfer, standard.transfer);
    EXPECT_EQ(o.xpic_order, standard.xpic_order);
    EXPECT_EQ(o.linear_viscosity, standard.linear_viscosity);
    EXPECT_EQ(o.courant, standard.courant);
    EXPECT_EQ(o.wall_friction, 0.0);
    EXPECT_EQ(c.particles.bodies.at(0).name, "body-1");
    EXPECT_EQ(c.particles.bodies.at(0).particles_per_direction, 2);
    EXPECT_EQ(c.output.particle_fields, run::Output{}.particle_fields);
  }
}

TEST(GoodDecks, OwnSolidsFromModuli) {
  auto const solid = [](std::string const& text) {
    return read("[solids.own]\ndensity = 1000\n" + text + small_domain +
                "[[body]]\nmaterial = \"own\"\nradius = 0.2\nposition = [1, 1, 1]\n")
        .particles.bodies.at(0)
        .solid;
  };
  auto const plain = solid("E = 3e9\nnu = 0\n");
  EXPECT_DOUBLE_EQ(std::get<material::Linear>(plain.eos).K, 1e9);
  EXPECT_DOUBLE_EQ(std::get<material::Elastic>(plain.strength).G, 1.5e9);
  auto const given =
      solid("eos = {model = \"linear\", K = 5e9, rho0 = 900}\nstrength = {model = \"elastic\", G = 2e9}\n");
  EXPECT_EQ(std::get<material::Linear>(given.eos).K, 5e9);
  EXPECT_EQ(std::get<material::Linear>(given.eos).rho0, 900.0);
  EXPECT_EQ(std::get<material::Elastic>(given.strength).G, 2e9);
  auto const soft = solid("eos = {model = \"mie_gruneisen\", C0 = 1500, S = 2, Gamma = 0.5}\n");
  EXPECT_EQ(std::get<material::MieGruneisen>(soft.eos).rho0, 1000.0);
  EXPECT_FALSE(soft.has_deviator());
  // The rest from E and nu, beside an equation of state of another kind.
  auto const mixed = solid(
      "E = 3e9\nnu = 0\neos = {model = \"mie_gruneisen\", C0 = 1500, S = 2, Gamma = 0.5}\n"
      "strength = {model = \"johnson_cook\", A = 1e6, B = 0, n = 1, C = 0, m = 1, T_melt = 1000}\n");
  EXPECT_DOUBLE_EQ(std::get<material::JohnsonCook>(mixed.strength).G, 1.5e9);
  EXPECT_EQ(std::get<material::JohnsonCook>(mixed.strength).T_room, 293.0);
}

// The particles of the layer hold just its volume, wherever the face lies between the particles: a free body gains the
// momentum pressure * area * time.
TEST(GoodDecks, SurfacePressurePushesWithItsForce) {
  // Layers of particles are 0.05 m thick. On a face of particles; 20, 40 and 60 % above one; and from below, on part of
  // it.
  for (std::string const top : {"0.6", "0.61", "0.62", "0.63"}) {
    for (std::string const normal : {"+z", "-z"}) {
      run::World world = setup::build(
          read("[end]\ntime = 2e-5\n[domain]\nsize = [1, 1, 1]\ncell = 0.1\n[[body]]\nmaterial = \"6061-T6\"\nshape = "
               "\"box\"\n"
               "lower = [0.3, 0.3, 0.3]\nupper = [0.6, 0.6, " +
               top + "]\n[[surface_pressure]]\nnormal = \"" + normal +
               "\"\npressure = 1e6\nwithin = {shape = \"box\", lower = [0.3, 0.3, 0], upper = [0.6, 0.4, 1]}\n"));
      double const push = normal == "+z" ? -1.0 : 1.0;
      while (!world.finished()) run::advance(world, world.setup.end.time);
      Vec3 const momentum = mpm::sums(*world.regions.front().particles, 0).momentum;
      // The force goes with the volume of the loaded particles, which changes by 1 MPa / K = 1.5e-5 of itself.
      EXPECT_NEAR(momentum[2], push * 1e6 * 0.03 * 2e-5, 1.5e-5 * 0.6) << top << normal;
      EXPECT_NEAR(momentum[0], 0.0, 1e-9);
    }
  }
}

TEST(GoodDecks, BodiesTakeSolidsFirst) {
  auto const name = [](std::string const& material, std::string const& more = "") {
    return read(more + small_domain + "[[body]]\nmaterial = \"" + material + "\"\nradius = 0.2\nposition = [1, 1, 1]\n")
        .particles.bodies.at(0)
        .solid;
  };
  EXPECT_TRUE(name("rha").has_deviator());
  EXPECT_TRUE(name("TNT").burns());
  EXPECT_FALSE(name("water").has_deviator());
  // An own material of any kind comes before the library.
  EXPECT_EQ(name("RHA", "[fluids.RHA]\ngamma = 1.4\ndensity = 1\n").density, 1.0);
}

TEST(GoodDecks, StlFilesAreFoundBesideTheDeck) {
  auto const folder = std::filesystem::path(testing::TempDir()) / "brisance_stl_deck";
  std::filesystem::create_directories(folder);
  // A tetrahedron with edges of 1000 mm along the axes.
  std::array<std::array<int, 3>, 4> const faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  std::array<char const*, 4> const corners{"0 0 0", "1000 0 0", "0 1000 0", "0 0 1000"};
  auto const write = [&](std::string const& name, std::size_t count) {
    std::ofstream file(folder / name);
    file << "solid t\n";
    for (std::size_t f = 0; f < count; ++f) {
      file << "facet normal 0 0 0\nouter loop\n";
      for (int const corner : faces[f]) file << "vertex " << corners[static_cast<std::size_t>(corner)] << "\n";
      file << "endloop\nendfacet\n";
    }
    file << "endsolid t\n";
  };
  write("closed.stl", 4);
  write("open.stl", 3);
  auto const deck = [&](std::string const& name) {
    std::string const path = (folder / "deck.toml").string();
    std::ofstream(path) << small_domain
                        << "[[body]]\nmaterial = \"RHA\"\nvelocity = [1, 0, 0]\nshape = \"stl\"\nfile = \"" << name
                        << "\"\nscale = 0.001\nposition = [0.5, 0.5, 0.5]\n";
    return deck::read_file(path);
  };
  auto const good = deck("closed.stl");
  ASSERT_TRUE(good.case_) << deck::format(good.errors.at(0));
  auto const& mesh = std::get<shape::Mesh>(good.case_->particles.bodies.at(0).shape);
  EXPECT_NEAR(mesh.volume(), 1.0 / 6.0, 1e-6);  // single precision of the file
  EXPECT_NEAR(mesh.lower()[2], 0.5, 1e-6);
  auto const bad = deck("open.stl");
  ASSERT_EQ(bad.errors.size(), 1U);
  EXPECT_EQ(bad.errors[0].key, "body[1].file");
  EXPECT_EQ(bad.errors[0].line, 10);
  EXPECT_NE(bad.errors[0].message.find("open.stl"), std::string::npos) << bad.errors[0].message;
  std::filesystem::remove_all(folder);
}

// What a machine can hold is for the program to say, and the same deck reads the same everywhere.
TEST(GoodDecks, SizeUpToTheLimitOfTheIndicesIsRead) {
  run::Case const c = read(
      "[domain]\nsize = [4, 4, 4]\ncell = \"3.125 mm\"\n[[charge]]\nmass = 1\n"
      "position = [1, 1, 1]\n[end]\ntime = \"1 ms\"\n");
  EXPECT_EQ(c.domain.cells, (Index3{1280, 1280, 1280}));
}

TEST(GoodDecks, BodiesBelongToTheRegionsThatNameOrHoldThem) {
  std::string const domain =
      "[domain]\ngeometry = \"planar2d\"\nsize = [1.28, 0.24]\ncell = \"10 mm\"\n[end]\ntime = 1e-3\n";
  auto const body = [](char const* name, char const* low, char const* high) {
    return fmt::format(
        "[[body]]\nname = \"{}\"\nmaterial = \"RHA\"\nshape = \"box\"\nlower = [{}, 0.08]\nupper = [{}, 0.16]\n", name,
        low, high);
  };
  std::string const bodies = body("a", "0.37", "0.38") + body("b", "0.85", "0.88") + body("c", "0.39", "0.40");
  std::string const first = "[[mpm_region]]\nbox = {lower = [0.26, 0], upper = [0.52, 0.24]}\nwidth = 3\n";
  std::string const second = "[[mpm_region]]\nbox = {lower = [0.74, 0], upper = [1, 0.24]}\nwidth = 3\n";
  for (std::string const& regions :
       {first + second, first + "bodies = [\"c\", \"a\"]\n" + second, first + second + "bodies = [\"b\"]\n",
        first + "[[mpm_region]]\nbodies = [\"b\"]\nmargin = 8\nwidth = 3\n"}) {
    run::Case const c = read(domain + bodies + regions);
    ASSERT_EQ(c.mpm_regions.size(), 2U);
    EXPECT_EQ(c.mpm_regions[0].bodies, (std::vector<int>{0, 2})) << regions;
    EXPECT_EQ(c.mpm_regions[1].bodies, std::vector<int>{1}) << regions;
    EXPECT_EQ(c.region_with(2), 0U);
    EXPECT_EQ(c.region_with(1), 1U);
  }
  // One region in a list is what a single table is.
  std::string const box = "box = {lower = [0.26, 0], upper = [1, 0.24]}\n";
  run::Case const list = read(domain + bodies + "[[mpm_region]]\n" + box);
  run::Case const table = read(domain + bodies + "[mpm_region]\n" + box);
  EXPECT_EQ(list.mpm_regions.size(), 1U);
  EXPECT_EQ(list.mpm_regions[0].bodies, table.mpm_regions[0].bodies);
  EXPECT_EQ(list.mpm_regions[0].boxes[0].upper, table.mpm_regions[0].boxes[0].upper);
}

TEST(GoodDecks, EveryKeyOfTheMpmRegionArrives) {
  run::Case const c = read_good("all_region.toml");
  ASSERT_TRUE(c.has_regions());
  run::MpmRegion const& r = c.mpm_regions.front();
  ASSERT_EQ(r.boxes.size(), 2U);
  EXPECT_EQ(r.boxes[0].lower[0], 1.0);
  EXPECT_EQ(r.boxes[0].upper[1], 0.5);
  EXPECT_EQ(r.boxes[1].lower[0], 1.5);
  EXPECT_EQ(r.width, 3);
  EXPECT_EQ(r.transport, bridge::Transport::paper);
  EXPECT_EQ(r.particles_per_direction, 2);
  EXPECT_EQ(r.activation, 250.0);
  EXPECT_FALSE(r.subcycling);
  EXPECT_EQ(r.transfer, mpm::Transfer::xpic);
  EXPECT_EQ(r.order, mpm::StressOrder::musl);
  EXPECT_EQ(r.linear_viscosity, 0.01);
  EXPECT_EQ(r.quadratic_viscosity, 2.0);
  EXPECT_EQ(r.shock_conduction, 0.3);
  EXPECT_EQ(r.courant, 0.7);
  EXPECT_EQ(r.population_interval, 9);
  EXPECT_EQ(r.reference_pressure, 9e4);
  EXPECT_TRUE(c.output.gas_particles);
  EXPECT_EQ(c.charges.size(), 1U);
  EXPECT_EQ(c.obstacles.size(), 1U);
  ASSERT_EQ(c.particles.bodies.size(), 1U);
  EXPECT_EQ(c.gauges.size(), 1U);
  EXPECT_EQ(c.particles.gauges.size(), 1U);
  EXPECT_EQ(c.burst, run::Burst::none);  // bodies reflect
}

TEST(GoodDecks, EveryKeyOfTheRemapArrives) {
  run::Case const c = read_good("all_remap.toml");
  EXPECT_TRUE(c.start.remap);
  EXPECT_EQ(c.start.method, run::StartMethod::particles);
  EXPECT_EQ(c.start.cell, 1e-3);
  EXPECT_EQ(c.start.radius, 0.5);
  EXPECT_FALSE(c.start.time);
  EXPECT_TRUE(c.start.profile.empty());
  EXPECT_TRUE(c.start.profiles.empty());
  EXPECT_TRUE(c.output.profile);
  std::string const rest =
      "[domain]\nsize = [2, 2, 2]\ncell = \"20 mm\"\n[[charge]]\nmass = 1\nposition = [1, 1, 1]\n[end]\ntime = "
      "\"1 ms\"\n";
  run::Case const timed = read("start = \"remap\"\n" + rest + "[remap]\ntime = \"0.1 ms\"\n");
  EXPECT_EQ(timed.start.time, 1e-4);
  EXPECT_EQ(timed.start.method, run::StartMethod::gas);
  EXPECT_EQ(read("start = \"remap\"\n" + rest + "[remap]\nprofile = \"b.h5\"\n").start.profile, "b.h5");
  EXPECT_FALSE(read(rest).start.remap);
}

TEST(GoodDecks, WhereGasAndBodiesMeetThereIsAnMpmRegion) {
  std::string const domain = "[end]\ntime = 1e-3\n[domain]\nsize = [4, 4, 4]\ncell = 0.05\n";
  std::string const body = "[[body]]\nmaterial = \"RHA\"\nradius = 0.2\nposition = [2, 2, 2]\nvelocity = [1, 0, 0]\n";
  EXPECT_FALSE(read(domain + body).has_regions());
  for (std::string const gas :
       {"[mpm_region]\n", "[[charge]]\nmass = 0.1\nposition = [0.15, 0.15, 0.15]\n",
        "[[initial_state]]\nshape = \"sphere\"\nradius = 0.1\npressure = 2e5\n",
        "[[obstacle]]\nradius = 0.05\nposition = [0.1, 0.1, 0.1]\n", "[[gauge]]\npoint = [0, 0, 0]\n"}) {
    run::Case const c = read(domain + "[mpm_region]\nmargin = 9\n" + (gas[1] == 'm' ? "" : gas) + body);
    EXPECT_TRUE(c.has_regions() && c.mpm_regions.front().boxes.empty()) << gas;
    EXPECT_EQ(c.mpm_regions.front().margin, 9);
  }
  // Without the table the box has the usual margin.
  auto const only = deck::read_text(domain + "[[gauge]]\npoint = [0, 0, 0]\n" + body, "d");
  ASSERT_TRUE(only.case_ && only.case_->has_regions());
  ASSERT_EQ(only.warnings.size(), 1U);
  EXPECT_NE(only.warnings[0].find("d:6:3: warning: gauge: gauges in the gas surround the bodies"), std::string::npos)
      << only.warnings[0];
  // Gas particles alone.
  run::Case const gas = read(domain +
                             "[mpm_region]\nbox = {lower = [1, 0, 0], upper = [2, 4, 4]}\n[[charge]]\nmass = 0.1\n"
                             "position = [0.5, 1, 1]\n");
  EXPECT_TRUE(gas.has_regions() && gas.mpm_regions.front().boxes.size() == 1 && !gas.particles.any());
}

TEST(GoodDecks, WarningsNameWhatIsDoubtful) {
  auto const idle = deck::read_text(small_domain, "d");
  ASSERT_EQ(idle.warnings.size(), 1U);
  EXPECT_EQ(idle.warnings[0],
            "d:1:1: warning: charge: nothing will happen: there is no charge, no initial state and no inflow");
  auto const warnings = [](std::string const& text) {
    auto const result = deck::read_text(small_domain + text, "d");
    EXPECT_TRUE(result.case_) << deck::format(result.errors.at(0));
    std::string out;
    for (auto const& warning : result.warnings) out += warning + "\n";
    return out;
  };
  EXPECT_EQ(warnings(ball),
            "d:6:3: warning: body: nothing will happen: no body moves, detonates or is under pressure, and no load or "
            "body force acts\n");
  EXPECT_EQ(warnings("[ambient]\nvelocity = [100, 0, 0]\n[[obstacle]]\nradius = 0.2\nposition = [1, 1, 1]\n"), "");
  EXPECT_EQ(warnings(ball + "velocity = [1, 0, 0]\n"), "");
  EXPECT_EQ(warnings(ball + "[points]\nbody_force = [0, 0, -9.81]\n"), "");
  EXPECT_EQ(warnings(ball + "[[surface_pressure]]\nnormal = \"+z\"\npressure = 1e6\n"), "");
  EXPECT_EQ(warnings(ball + "velocity = [1, 0, 0]\n[points]\nwall_friction = 0.2\n"),
            "d:12:17: warning: points.wall_friction: has no effect: no face of the domain is a wall; write, for "
            "example, z_low = \"wall\" in [boundaries]\n");
  EXPECT_EQ(
      warnings("[boundaries]\nz_low = \"wall\"\n" + ball + "velocity = [1, 0, 0]\n[points]\nwall_friction = 0.2\n"),
      "");
  EXPECT_EQ(warnings("[[body]]\nmaterial = \"TNT\"\nradius = 0.2\nposition = [1, 1, 1]\n"), "");
  EXPECT_EQ(warnings("[[body]]\nmaterial = \"air\"\nradius = 0.2\nposition = [1, 1, 1]\npressure = 1e5\n"), "");
  EXPECT_EQ(
      warnings(ball + "velocity = [1, 0, 0]\n[points]\npic_fraction = 0.1\ntransfer = \"apic\"\nxpic_order = 3\n" +
               "[ambient]\n[numerics]\n[output]\nfields = [\"pressure\"]\n"),
      "d:15:2: warning: ambient: has no effect: this deck contains no gas, and its bodies move in empty space; with "
      "[mpm_region] they are surrounded by the ambient gas\n"
      "d:16:2: warning: numerics: has no effect: this deck contains no gas, and its bodies move in empty space; "
      "with [mpm_region] they are surrounded by the ambient gas\n"
      "d:12:16: warning: points.pic_fraction: has an effect only with transfer = \"flip\"\n"
      "d:14:14: warning: points.xpic_order: has an effect only with transfer = \"xpic\"\n"
      "d:18:10: warning: output.fields: has no effect in a deck with bodies but without gas\n");
  std::string const steel = warnings("[[body]]\nmaterial = \"steel\"\nradius = 0.2\nposition = [1, 1, 1]\n");
  EXPECT_EQ(steel.substr(0, 83),
            "d:7:12: warning: body[1].material: \"steel\" is a fluid without strength; the solids ")
      << steel;
  EXPECT_EQ(warnings("[[charge]]\nmass = 1\nposition = [1, 1, 1]\n[points]\n[output]\npoint_fields = []\n"),
            "d:9:2: warning: points: has no effect in a deck without bodies\n"
            "d:11:16: warning: output.point_fields: has no effect in a deck without bodies\n");
  auto const odd = deck::read_text(
      small_domain +
          "[[charge]]\nexplosive = \"TNT\"\nmass = 5\nposition = [1, 1, 1]\n[explosives.TNT]\nrho0 = 1630\n"
          "A = 371.2e9\nB = 3.21e9\nR1 = 4.15\nR2 = 0.95\nomega = 0.3\nenergy = 6.993e9\n"
          "detonation_speed = 8000\ncj_pressure = 21e9\n",
      "d");
  ASSERT_EQ(odd.warnings.size(), 2U);
  EXPECT_NE(odd.warnings[0].find("the constants give a detonation speed of 69"), std::string::npos) << odd.warnings[0];
  EXPECT_EQ(odd.warnings[1], "d:10:13: warning: explosives.TNT: replaces the library explosive of the same name");
}

TEST(GoodDecks, CheckpointsAreReadInFull) {
  auto const checkpoint = [](std::string const& table) {
    return read("[domain]\nsize = [1, 1, 1]\ncell = 0.1\n[end]\ntime = 1\n" + table).checkpoint;
  };
  auto const standing = checkpoint("");
  EXPECT_EQ(standing.wall_clock, 600.0);
  EXPECT_EQ(standing.keep, 2);
  EXPECT_TRUE(standing.at_end && standing.on_signal);
  auto const c = checkpoint(
      "[checkpoint]\ninterval = \"5 ms\"\nsteps = 300\nwall_clock = \"1 h\"\nkeep = 5\nat_end = false\n"
      "on_signal = false\n");
  EXPECT_DOUBLE_EQ(c.interval, 5e-3);
  EXPECT_EQ(c.steps, 300);
  EXPECT_DOUBLE_EQ(c.wall_clock, 3600.0);
  EXPECT_EQ(c.keep, 5);
  EXPECT_FALSE(c.at_end || c.on_signal);
}

TEST(GoodDecks, LimitsOfTheAuditAreRead) {
  auto const audit = [](std::string const& table) {
    return read("[domain]\nsize = [1, 1, 1]\ncell = 0.1\n[end]\ntime = 1\n" + table).audit;
  };
  EXPECT_EQ(audit("").warn, 0.005);
  EXPECT_EQ(audit("").fail, 0.05);
  auto const both = audit("[audit]\nwarn = 0.02\nfail = 0.2\n");
  EXPECT_EQ(both.warn, 0.02);
  EXPECT_EQ(both.fail, 0.2);
  auto const never = audit("[audit]\nwarn = 0.2\nfail = 0\n");
  EXPECT_EQ(never.warn, 0.2);
  EXPECT_EQ(never.fail, 0.0);
  EXPECT_EQ(audit("[audit]\nwarn = 0\n").warn, 0.0);
}

TEST(Difference, OnlyWhatHasBeenCalculatedCounts) {
  std::string const text =
      "title = \"a\"\n[domain]\nsize = [1, 1]\ncell = 0.1\n[[gauge]]\npoint = [1, 2]\n[output]\nfields = [\"mach\"]\n"
      "[end]\ntime = 1\n";
  auto const changed = [&](std::string const& old, std::string const& fresh) {
    std::string other = text;
    other.replace(other.find(old), old.size(), fresh);
    return deck::difference(text, other).value_or("");
  };
  EXPECT_EQ(changed("\"a\"", "\"b\""), "");
  EXPECT_EQ(changed("time = 1", "time = 2\nsteps = 5"), "");
  EXPECT_EQ(changed("[end]", "[checkpoint]\nsteps = 5\n[end]"), "");
  EXPECT_EQ(changed("[end]", "[audit]\nfail = 0\n[end]"), "");
  EXPECT_EQ(changed("[\"mach\"]", "[\"mach\", \"pressure\"]"), "");
  EXPECT_EQ(changed("[output]\nfields = [\"mach\"]\n", ""), "");
  EXPECT_EQ(changed("[domain]", "# a remark\n\n[domain]"), "");
  EXPECT_EQ(changed("size = [1, 1]\ncell = 0.1", "cell = 0.1\nsize = [1, 1]"), "");
  EXPECT_EQ(changed("cell = 0.1", "cell = 0.2"), "domain.cell");
  EXPECT_EQ(changed("cell = 0.1", "cell = \"0.1 m\""), "domain.cell") << "values count as they are written";
  EXPECT_EQ(changed("[1, 1]", "[1, 2]"), "domain.size");
  EXPECT_EQ(changed("[1, 2]", "[1, 3]"), "gauge");
  EXPECT_EQ(changed("[end]", "[[gauge]]\npoint = [1, 1]\n[end]"), "gauge");
  EXPECT_EQ(changed("[end]", "[numerics]\ncourant = 0.3\n[end]"), "numerics.courant");
  EXPECT_EQ(changed("[output]", "[output]\npeak_fields = false"), "output.peak_fields");
}

}  // namespace
}  // namespace brisance
