// Charges on the grid: the mass that was asked for is there, whatever the grid.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "../run/cases.hpp"

namespace brisance::setup {
namespace {

using namespace run;

using grid::Boundary;
using grid::Geometry;
using shape::Box;
using shape::Cylinder;
using shape::Hemisphere;
using shape::Shape;
using shape::Sphere;

/// Builds the world and compares the asked mass with the report and with the sum over the grid.
void expect_exact_mass(Case const& c, double images, std::string const& what) {
  SCOPED_TRACE(what);
  World const world = setup::build(c);
  ASSERT_EQ(world.charges.size(), 1U);
  double const asked = c.charges[0].mass;
  EXPECT_GT(asked, 0.0);
  EXPECT_NEAR(world.charges[0].realised_mass / asked, 1.0, 1e-12);
  EXPECT_NEAR(world.totals().mass[1] * images / asked, 1.0, 1e-12);
  EXPECT_NEAR(world.charges[0].realised_energy / (asked * c.charges[0].explosive.specific_energy()), 1.0, 1e-12);
}

// Sizes that no cell edge, centre or sample point meets.
constexpr double h = 0.0173;
constexpr double radius = 0.0811;

TEST(ChargeMass, IsExactIn3dForEveryShapeAndNumberOfSymmetryPlanes) {
  for (int planes = 0; planes <= 3; ++planes) {
    Case c = air_case(Geometry::cartesian3d, {16, 17, 18}, h, Boundary::outflow);
    Vec3 middle{0.1312, 0.1409, 0.1507};
    for (int d = 0; d < planes; ++d) {
      c.domain.boundary[2 * d] = Boundary::symmetry;
      middle[d] = 0.0;
    }
    double const images = 1 << planes;
    std::string const label = fmt::format("{} planes, ", planes);
    Vec3 const half{0.0511, 0.0623, 0.0717};
    for (auto const& [name, shape] : {std::pair<std::string, Shape>{"sphere", Sphere{middle, radius}},
                                      {"box", Box{middle - half, middle + half}},
                                      {"cylinder along x", Cylinder{middle, 0.0631, 0.1127, {1.0, 0.0, 0.0}}},
                                      {"cylinder along z", Cylinder{middle, 0.0631, 0.1127, {0.0, 0.0, 1.0}}}}) {
      c.charges = {tnt_charge(shape, c.domain.geometry)};
      expect_exact_mass(c, images, label + name);
    }
    // The flat face of a hemisphere lies on no mirror: the planes cut it at right angles.
    if (planes < 3) {
      c.charges = {tnt_charge(Hemisphere{{middle[0], middle[1], 0.0}, radius, {0.0, 0.0, 1.0}}, c.domain.geometry)};
      expect_exact_mass(c, images, label + "hemisphere");
    }
  }
}

TEST(ChargeMass, IsExactInTwoAndOneDimensions) {
  Case plane = air_case(Geometry::planar2d, {23, 24, 1}, h, Boundary::outflow);
  for (Shape const& shape : {Shape{Cylinder{{0.1712, 0.2009, 0.0}, radius, 1.0, {0.0, 0.0, 1.0}}},
                             Shape{Box{{0.0712, 0.1109, 0.0}, {0.2817, 0.1912, 1.0}}}}) {
    plane.charges = {tnt_charge(shape, plane.domain.geometry)};
    expect_exact_mass(plane, 1.0, "planar2d");
  }
  plane.domain.boundary[0] = Boundary::symmetry;
  plane.charges = {tnt_charge(Cylinder{{0.0, 0.2009, 0.0}, radius, 1.0, {0.0, 0.0, 1.0}}, plane.domain.geometry)};
  expect_exact_mass(plane, 2.0, "planar2d, mirrored");

  Case turned = air_case(Geometry::axisymmetric2d, {23, 24, 1}, h, Boundary::outflow);
  turned.domain.boundary[0] = Boundary::symmetry;
  for (Shape const& shape :
       {Shape{Sphere{{0.0, 0.2009, 0.0}, radius}}, Shape{Hemisphere{{0.0, 0.0, 0.0}, radius, {0.0, 1.0, 0.0}}},
        Shape{Cylinder{{0.0, 0.2009, 0.0}, radius, 0.1127, {0.0, 1.0, 0.0}}},
        Shape{Box{{0.0712, 0.1109, 0.0}, {0.2817, 0.1912, 1.0}}}}) {
    turned.charges = {tnt_charge(shape, turned.domain.geometry)};
    expect_exact_mass(turned, 1.0, fmt::format("axisymmetric2d, shape {}", shape.index()));
  }
  turned.domain.boundary[2] = Boundary::symmetry;
  turned.charges = {tnt_charge(Sphere{{0.0, 0.0, 0.0}, radius}, turned.domain.geometry)};
  expect_exact_mass(turned, 2.0, "axisymmetric2d, mirrored");

  Case line = air_case(Geometry::planar1d, {53, 1, 1}, h, Boundary::outflow);
  line.charges = {tnt_charge(Box{{0.3013, 0.0, 0.0}, {0.4007, 1.0, 1.0}}, line.domain.geometry)};
  expect_exact_mass(line, 1.0, "planar1d");

  Case tube = air_case(Geometry::cylindrical1d, {53, 1, 1}, h, Boundary::outflow);
  tube.domain.boundary[0] = Boundary::symmetry;
  tube.charges = {tnt_charge(Cylinder{{0.0, 0.0, 0.0}, radius, 1.0, {0.0, 0.0, 1.0}}, tube.domain.geometry)};
  expect_exact_mass(tube, 1.0, "cylindrical1d");

  Case ball = air_case(Geometry::spherical1d, {53, 1, 1}, h, Boundary::outflow);
  ball.domain.boundary[0] = Boundary::symmetry;
  ball.charges = {tnt_charge(Sphere{{0.0, 0.0, 0.0}, radius}, ball.domain.geometry)};
  expect_exact_mass(ball, 1.0, "spherical1d");
}

TEST(ChargeMass, IsExactForAChargeSmallerThanACell) {
  Case c = air_case(Geometry::cartesian3d, {8, 8, 8}, 0.1, Boundary::outflow);
  c.charges = {tnt_charge(Sphere{{0.4321, 0.4567, 0.4444}, 0.0007}, c.domain.geometry)};
  expect_exact_mass(c, 1.0, "0.7 mm in cells of 100 mm");
}

TEST(ChargeBurst, ChargesThatAreLitTogetherButForRoundingTakeNoStepOfThatLength) {
  Case c = air_case(Geometry::planar2d, {80, 40, 1}, 0.005, Boundary::wall);
  for (double const x : {0.15, 0.25}) {
    c.charges.push_back(tnt_charge(Box{{x, 0.0, 0.0}, {x + 0.05, 0.05, 1.0}}, c.domain.geometry));
  }
  World world = setup::build(c);
  EXPECT_NO_THROW(advance_to(world, 2e-6));
  EXPECT_LT(world.clock.step, 100);
}

TEST(ChargePlacement, OffCentreCutsAndOverhangsAreRefused) {
  auto const message = [](Vec3 const& middle, Boundary low) {
    Case c = air_case(Geometry::cartesian3d, {16, 16, 16}, h, Boundary::outflow);
    c.domain.boundary[0] = low;
    c.charges = {tnt_charge(Sphere{middle, radius}, c.domain.geometry)};
    try {
      World const world = setup::build(c);
    } catch (InputError const& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message({0.0, 0.14, 0.14}, Boundary::symmetry), "accepted");
  EXPECT_EQ(message({0.14, 0.14, 0.14}, Boundary::symmetry), "accepted");
  EXPECT_NE(message({0.03, 0.14, 0.14}, Boundary::symmetry).find("would overlap its own mirror image"),
            std::string::npos);
  EXPECT_NE(message({-0.03, 0.14, 0.14}, Boundary::symmetry).find("would overlap its own mirror image"),
            std::string::npos);
  for (Boundary low : {Boundary::wall, Boundary::outflow, Boundary::periodic}) {
    EXPECT_NE(message({0.0, 0.14, 0.14}, low).find("extends beyond the low boundary of the domain (x = 0 m)"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace brisance::setup
