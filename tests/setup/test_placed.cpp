// What regions, obstacles and charges put onto the grid: their volume, mass, momentum and energy, whatever the grid.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "../run/cases.hpp"
#include "core/parallel.hpp"
#include "setup/fluids.hpp"
#include "setup/solid_cells.hpp"
#include "shape/placement.hpp"

namespace brisance::setup {
namespace {

using namespace run;

using grid::Boundary;
using grid::Geometry;
using shape::Box;
using shape::Cylinder;
using shape::Shape;
using shape::Sphere;

constexpr double pi = std::numbers::pi;
constexpr Vec3 along_z{0.0, 0.0, 1.0};

InitialState region_of(Shape const& shape, double density, double pressure, Vec3 const& velocity = {0.0, 0.0, 0.0}) {
  InitialState region;
  region.shape = shape;
  region.state = {density, pressure, velocity};
  return region;
}

/// Energy per volume of air.
double energy_of(material::Primitive const& s) {
  return s.pressure / 0.4 + 0.5 * s.density * dot(s.velocity, s.velocity);
}

/// The air that a case holds without its regions, and its volume.
struct Quiet {
  double volume = 0.0;
  double mass = 0.0;
  double energy = 0.0;
};

Quiet quiet(Case c) {
  c.initial_states.clear();
  World const world = setup::build(c);
  double volume = 0.0;
  for (int i = 0; i < c.domain.cells[0]; ++i) volume += c.domain.cell_volume(i) * c.domain.cells[1] * c.domain.cells[2];
  Totals const t = world.totals();
  return {volume, t.mass[0], t.energy};
}

struct Placing {
  std::string name;
  Geometry geometry;
  Index3 cells;
  Shape shape;
  double volume;
};

constexpr double h = 0.0173;

std::vector<Placing> placings() {
  double const R = 3.1 * h;
  double const ball = 4.0 / 3.0 * pi * R * R * R;
  return {
      {"disc", Geometry::planar2d, {23, 24, 1}, Cylinder{{0.1712, 0.2009, 0.0}, R, 1.0, along_z}, pi * R * R},
      {"half a disc", Geometry::planar2d, {23, 24, 1}, Cylinder{{0.0, 0.2009, 0.0}, R, 1.0, along_z}, pi * R * R / 2},
      {"quarter of a disc",
       Geometry::planar2d,
       {23, 24, 1},
       Cylinder{{0.0, 0.0, 0.0}, R, 1.0, along_z},
       pi * R * R / 4},
      {"disc of half a cell",
       Geometry::planar2d,
       {23, 24, 1},
       Cylinder{{0.1712, 0.2009, 0.0}, h / 4, 1.0, along_z},
       pi * h * h / 16},
      {"ball", Geometry::cartesian3d, {14, 13, 12}, Sphere{{0.1143, 0.1117, 0.1038}, R}, ball},
      {"eighth of a ball", Geometry::cartesian3d, {10, 10, 10}, Sphere{{0.0, 0.0, 0.0}, R}, ball / 8},
      {"oblique cylinder",
       Geometry::cartesian3d,
       {14, 13, 12},
       Cylinder{{0.1143, 0.1117, 0.1038}, 0.04, 0.05, {0.6, 0.0, 0.8}},
       pi * 0.04 * 0.04 * 0.05},
      {"ball around the axis", Geometry::axisymmetric2d, {12, 24, 1}, Sphere{{0.0, 0.2009, 0.0}, R}, ball},
      {"ring",
       Geometry::axisymmetric2d,
       {12, 24, 1},
       Box{{0.0712, 0.1109, -0.5}, {0.1317, 0.1912, 0.5}},
       pi * (0.1317 * 0.1317 - 0.0712 * 0.0712) * 0.0803},
      {"slab", Geometry::planar1d, {53, 1, 1}, Box{{0.3013, -0.5, -0.5}, {0.4007, 0.5, 0.5}}, 0.0994},
      {"rod", Geometry::cylindrical1d, {53, 1, 1}, Cylinder{{0.0, 0.0, 0.0}, R, 1.0, along_z}, pi * R * R},
      {"shell",
       Geometry::spherical1d,
       {53, 1, 1},
       Box{{0.0712, -0.5, -0.5}, {0.1317, 0.5, 0.5}},
       4.0 / 3.0 * pi * (0.1317 * 0.1317 * 0.1317 - 0.0712 * 0.0712 * 0.0712)}};
}

TEST(PlacedRegions, HoldTheirVolumeTimesTheirState) {
  for (Placing const& p : placings()) {
    SCOPED_TRACE(p.name);
    Case c = air_case(p.geometry, p.cells, h, Boundary::symmetry);
    bool const radial = grid::radial_exponent(p.geometry) > 0;
    Vec3 const wind = radial ? Vec3{0.0, 0.0, 0.0} : Vec3{120.0, 0.0, 0.0};
    Quiet const before = quiet(c);
    c.initial_states = {region_of(p.shape, 5.0, 3e6, wind)};
    World const world = setup::build(c);
    double const mass = before.mass + p.volume * (5.0 - c.ambient.state.density);
    double const energy =
        before.energy + p.volume * (energy_of(c.initial_states[0].state) - energy_of(c.ambient.state));
    // The oblique cylinder has no closed form on the grid: its volume is integrated to 1e-5.
    double const tolerance = p.name == "oblique cylinder" ? 2e-5 : 1e-11;
    EXPECT_NEAR(world.totals().mass[0], mass, tolerance * p.volume * 5.0 + 1e-13 * mass);
    EXPECT_NEAR(world.totals().energy, energy, tolerance * p.volume * 7.5e6 + 1e-13 * energy);
    if (!radial) {
      EXPECT_NEAR(world.totals().momentum[0] / (p.volume * 5.0 * 120.0), 1.0, 10.0 * tolerance);
    }
    ASSERT_EQ(world.initial_states.size(), 1U);
    EXPECT_NEAR(world.initial_states[0].specified_volume / p.volume, 1.0, tolerance);
    EXPECT_NEAR(world.initial_states[0].volume / p.volume, 1.0, tolerance);
    EXPECT_NEAR(world.initial_states[0].energy / (p.volume * energy_of(c.initial_states[0].state)), 1.0, tolerance);
  }
}

TEST(PlacedRegions, FilledCellsAreThoseOfTheStateToTheBit) {
  Case c = air_case(Geometry::planar2d, {20, 10, 1}, 0.1, Boundary::wall);
  c.initial_states = {region_of(Box{{-1.0, -1.0, -0.5}, {0.7, 3.0, 0.5}}, 0.3, 7e5, {11.0, -3.0, 0.0}),
                      region_of(Box{{0.3, 0.2, -0.5}, {1.2, 0.9, 0.5}}, 2.7, 1.1e5)};
  World const world = setup::build(c);
  for (int j = 0; j < 10; ++j) {
    for (int i = 0; i < 20; ++i) {
      bool const second = i >= 3 && i < 12 && j >= 2 && j < 9;
      material::Primitive const& s = second  ? c.initial_states[1].state
                                     : i < 7 ? c.initial_states[0].state
                                             : c.ambient.state;
      auto const u = gas::conserved_of(world.gas->fluids(), s);
      grid::Cell const cell = world.grid.locate(Index3{i, j, 0});
      for (int k = 0; k < world.gas->fields().components(); ++k) {
        EXPECT_EQ(world.gas->fields().at(cell.block, k)[cell.offset], u[k]);
      }
    }
  }
}

TEST(PlacedRegions, LaterOnesOverwriteEarlierOnesByVolume) {
  Case c = air_case(Geometry::planar2d, {23, 24, 1}, h, Boundary::symmetry);
  Quiet const before = quiet(c);
  double const R = 6.3 * h;
  double const r = 3.2 * h;
  Vec3 const middle{0.1712, 0.2009, 0.0};
  c.initial_states = {region_of(Cylinder{middle, R, 1.0, along_z}, 2.0, 1e6),
                      region_of(Cylinder{middle, r, 1.0, along_z}, 4.0, 5e6)};
  World const world = setup::build(c);
  double const air = c.ambient.state.density;
  double const mass = before.mass + pi * (R * R - r * r) * (2.0 - air) + pi * r * r * (4.0 - air);
  EXPECT_NEAR(world.totals().mass[0], mass, 1e-11 * pi * R * R);
  EXPECT_NEAR(world.initial_states[0].volume / (pi * (R * R - r * r)), 1.0, 1e-11);
  EXPECT_NEAR(world.initial_states[0].specified_volume / (pi * R * R), 1.0, 1e-11);

  // Halves that meet within a cell leave nothing of the ambient there.
  Case halves = air_case(Geometry::planar1d, {10, 1, 1}, 0.1, Boundary::wall);
  halves.initial_states = {region_of(Box{{0.0, -0.5, -0.5}, {0.525, 0.5, 0.5}}, 1.0, 1e5),
                           region_of(Box{{0.525, -0.5, -0.5}, {1.0, 0.5, 0.5}}, 3.0, 1e5)};
  World const two = setup::build(halves);
  EXPECT_NEAR(two.totals().mass[0], 0.525 + 3.0 * 0.475, 1e-14);
  EXPECT_NEAR(two.gas->primitive(two.grid.locate(Index3{5, 0, 0})).density, 0.25 + 0.75 * 3.0, 1e-14);
  EXPECT_NEAR(two.gas->primitive(two.grid.locate(Index3{5, 0, 0})).pressure, 1e5, 1e-9);
}

TEST(PlacedRegions, OfTheSecondFluidHoldItsMass) {
  Case c = air_case(Geometry::cartesian3d, {14, 13, 12}, h, Boundary::outflow);
  c.other_fluids = {*deck::library().fluid("helium")};
  double const R = 3.1 * h;
  InitialState region = region_of(Sphere{{0.1143, 0.1117, 0.1038}, R}, c.other_fluids[0].density, 101325.0);
  region.fluid = 1;
  c.initial_states = {region};
  World const world = setup::build(c);
  double const volume = 4.0 / 3.0 * pi * R * R * R;
  EXPECT_NEAR(world.totals().mass[1] / (volume * c.other_fluids[0].density), 1.0, 1e-11);
  double const all = h * h * h * static_cast<double>(c.domain.cell_count());
  EXPECT_NEAR(world.totals().mass[0] / ((all - volume) * c.ambient.state.density), 1.0, 1e-12);
  // One pressure everywhere: a mixed cell is at rest with its neighbours.
  for (int i = 0; i < 14; ++i)
    EXPECT_NEAR(world.gas->primitive(world.grid.locate(Index3{i, 6, 6})).pressure / 101325.0, 1.0, 1e-12);
}

TEST(PlacedRegions, GiveWayToChargesAndObstacles) {
  Case c = air_case(Geometry::planar2d, {20, 20, 1}, 0.05, Boundary::wall);
  c.initial_states = {region_of(Box{{-1.0, -1.0, -0.5}, {2.0, 2.0, 0.5}}, 3.0, 4e5)};
  Cylinder const disc{{0.51, 0.47, 0.0}, 0.16, 1.0, along_z};
  c.charges = {tnt_charge(disc, c.domain.geometry)};
  World const world = setup::build(c);
  double const area = pi * 0.16 * 0.16;
  EXPECT_NEAR(world.totals().mass[1] / (area * c.charges[0].explosive.density()), 1.0, 1e-12);
  EXPECT_NEAR(world.totals().mass[0] / ((1.0 - area) * 3.0), 1.0, 1e-12);
  EXPECT_NEAR(world.totals().energy / ((1.0 - area) * 4e5 / 0.4 + area * c.charges[0].explosive.energy), 1.0, 1e-12);
  EXPECT_NEAR(world.initial_states[0].volume / (1.0 - area), 1.0, 1e-12);

  c.charges.clear();
  c.obstacles = {{"block", Box{{0.5, 0.0, -0.5}, {1.0, 1.0, 0.5}}}};
  World const blocked = setup::build(c);
  EXPECT_NEAR(blocked.initial_states[0].volume, 0.5, 1e-12);
  EXPECT_NEAR(blocked.initial_states[0].specified_volume, 1.0, 1e-12);
}

TEST(PlacedRegions, SedovOfThreeCellsPerRadiusRunsAtItsRadius) {
  // A quarter of a disc whose energy is 250 J/m: the exact blast wave is at 0.22451 m after 50 ms.
  Case c = air_case(Geometry::planar2d, {140, 140, 1}, 0.002, Boundary::outflow);
  c.domain.boundary[0] = c.domain.boundary[2] = Boundary::symmetry;
  c.ambient.state = {1000.0, 0.01, {0.0, 0.0, 0.0}};
  c.initial_states = {region_of(Cylinder{{0.0, 0.0, 0.0}, 0.006, 1.0, along_z}, 1000.0, 3536776.5131532303)};
  World world = setup::build(c);
  set_threads(1);  // a small grid: it takes a quarter of a second
  advance_to(world, 0.05);
  set_threads(0);
  // Along the axis and the diagonal, where the density falls through the middle of its step from 1000 to 6000.
  auto const density = [&](int i, int j) { return world.gas->primitive(world.grid.locate(Index3{i, j, 0})).density; };
  auto const front = [&](int step_y) {
    for (int i = 138; i > 0; --i) {
      double const a = density(i, step_y * i);
      double const b = density(i + 1, step_y * (i + 1));
      if (a > 3500.0) return (i + 0.5 + (a - 3500.0) / (a - b)) * 0.002 * (step_y == 1 ? std::sqrt(2.0) : 1.0);
    }
    return 0.0;
  };
  // A cell is 0.9 %, and a captured shock is two wide. The 13 % of energy that cells counted by their centres hold too
  // much move it by 3.1 %.
  EXPECT_NEAR(front(0) / 0.22451, 1.0, 0.01);
  EXPECT_NEAR(front(1) / 0.22451, 1.0, 0.01);
}

// --- obstacles

TEST(PlacedObstacles, AreSolidFromHalfACellOn) {
  Case c = air_case(Geometry::planar1d, {20, 1, 1}, 0.1, Boundary::outflow);
  c.numerics.obstacles = run::ObstacleCells::stairs;
  for (auto const& [upper, cells] : {std::pair{1.04, 5}, {1.049, 5}, {1.05, 6}, {1.06, 6}}) {
    c.obstacles = {{"wall", Box{{0.5, -0.5, -0.5}, {upper, 0.5, 0.5}}}};
    World const world = setup::build(c);
    ASSERT_EQ(world.obstacles.size(), 1U);
    EXPECT_EQ(world.obstacles[0].cells, cells) << upper;
    EXPECT_NEAR(world.obstacles[0].specified_volume, upper - 0.5, 1e-12);
    EXPECT_NEAR(world.obstacles[0].volume, 0.1 * cells, 1e-12);
    EXPECT_FALSE(world.gas->obstacles.contain(0, Index3{4, 0, 0}));
    EXPECT_TRUE(world.gas->obstacles.contain(0, Index3{5, 0, 0}));
    EXPECT_EQ(world.gas->obstacles.contain(0, Index3{10, 0, 0}), cells == 6);
  }
  // Two that fill it together.
  c.obstacles = {{"a", Box{{0.5, -0.5, -0.5}, {1.03, 0.5, 0.5}}}, {"b", Box{{1.07, -0.5, -0.5}, {1.5, 0.5, 0.5}}}};
  EXPECT_TRUE(build(c).gas->obstacles.contain(0, Index3{10, 0, 0}));
}

TEST(PlacedObstacles, TakeNothingOfAChargeBesideThem) {
  Case c = air_case(Geometry::planar2d, {20, 20, 1}, 0.05, Boundary::outflow);
  c.charges = {tnt_charge(Cylinder{{0.41, 0.52, 0.0}, 0.11, 1.0, along_z}, c.domain.geometry)};
  c.obstacles = {{"wall", Box{{0.52, 0.0, -0.5}, {0.8, 1.0, 0.5}}}};  // 0.6 of the cell that the charge ends in
  for (auto const cells : {run::ObstacleCells::cut, run::ObstacleCells::stairs}) {
    c.numerics.obstacles = cells;
    World const world = setup::build(c);
    bool const stairs = cells == run::ObstacleCells::stairs;
    EXPECT_EQ(world.gas->obstacles.contain(0, Index3{10, 10, 0}), stairs);
    double const products = world.gas->primitive(world.grid.locate(Index3{10, 10, 0})).mass_fraction[1];
    EXPECT_EQ(products > 0.0, !stairs);
    EXPECT_NEAR(world.totals().mass[1] / c.charges[0].mass, 1.0, 1e-12);
    EXPECT_NEAR(world.charges[0].realised_mass / c.charges[0].mass, 1.0, 1e-12);
  }
  // Where all others are full, or there are none, it does not fit.
  c.charges = {tnt_charge(Box{{0.3, 0.3, -0.5}, {0.52, 0.5, 0.5}}, c.domain.geometry)};
  EXPECT_THROW((void)build(c), InputError);
  c.charges = {tnt_charge(Box{{0.50, 0.3, -0.5}, {0.52, 0.35, 0.5}}, c.domain.geometry)};
  EXPECT_THROW((void)build(c), InputError);
}

/// Do the gas cells connect the two ends of the domain along x, by faces?
bool connected(grid::Domain const& domain, std::vector<std::uint8_t> solid) {
  auto const at = [&](Index3 const& i) {
    return static_cast<std::size_t>(i[0] + domain.cells[0] * (i[1] + domain.cells[1] * i[2]));
  };
  std::vector<Index3> open;
  for (int k = 0; k < domain.cells[2]; ++k) {
    for (int j = 0; j < domain.cells[1]; ++j) open.push_back({0, j, k});
  }
  while (!open.empty()) {
    Index3 const i = open.back();
    open.pop_back();
    if (solid[at(i)] != 0) continue;
    solid[at(i)] = 1;
    if (i[0] == domain.cells[0] - 1) return true;
    for (int f = 0; f < 6; ++f) {
      Index3 j = i;
      j[f / 2] += f % 2 == 0 ? -1 : 1;
      if (j[f / 2] >= 0 && j[f / 2] < domain.cells[f / 2]) open.push_back(j);
    }
  }
  return false;
}

TEST(PlacedObstacles, WallsThatGasWouldPassAreFoundAtEveryAngle) {
  Case c = air_case(Geometry::cartesian3d, {9, 9, 9}, 0.1, Boundary::outflow);
  std::mt19937 random(16);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int passed = 0;
  int closed = 0;
  for (int n = 0; n < 60; ++n) {
    double const z = 2.0 * uniform(random) - 1.0;
    double const angle = 2.0 * pi * uniform(random);
    double const across = std::sqrt(1.0 - z * z);
    Vec3 const axis{across * std::cos(angle), across * std::sin(angle), z};
    // From a tenth of a cell to two cells.
    double const thickness = 0.1 * (0.1 + 1.9 * uniform(random));
    Vec3 const middle{0.4 + 0.1 * uniform(random), 0.4 + 0.1 * uniform(random), 0.4 + 0.1 * uniform(random)};
    c.obstacles = {{"plate", Cylinder{middle, 5.0, thickness, axis}}};
    SolidCells const solid(c.domain, c.obstacles);
    // The plate parts the ends along x where they lie on its two sides.
    auto const side = [&](double x, double y, double w) { return dot(Vec3{x, y, w} - middle, axis); };
    bool parts = true;
    double const low = side(0.0, 0.0, 0.0);
    for (int corner = 0; corner < 4; ++corner) {
      double const y = 0.9 * (corner & 1);
      double const w = 0.9 * (corner >> 1);
      parts = parts && side(0.0, y, w) * low > 0.0 && side(0.9, y, w) * low < 0.0;
    }
    bool const refused = solid.vanishes(0) || solid.leak().has_value();
    if (parts && connected(c.domain, solid.all())) {
      ++passed;
      EXPECT_TRUE(refused) << "thickness " << thickness / 0.1 << " cells, axis " << axis[0] << " " << axis[1] << " "
                           << z;
    }
    // A wall of a cell's thickness is closed at every angle, and none that is closed with room to spare is refused.
    if (thickness >= 0.1) {
      EXPECT_FALSE(parts && connected(c.domain, solid.all())) << thickness / 0.1;
      EXPECT_FALSE(refused) << "thickness " << thickness / 0.1 << " cells, axis " << axis[0] << " " << axis[1] << " "
                            << z;
      ++closed;
    }
  }
  EXPECT_GE(closed, 15);
  EXPECT_GE(passed, 3);
}

TEST(PlacedObstacles, GapsBetweenTouchingOnesAreFound) {
  auto const leaks = [](std::vector<Obstacle> const& obstacles) {
    grid::Domain domain;
    domain.geometry = Geometry::planar2d;
    domain.h = 0.1;
    domain.cells = {10, 10, 1};
    return SolidCells(domain, obstacles).leak().has_value();
  };
  auto const block = [](double x0, double y0, double x1, double y1) {
    return Obstacle{"block", Box{{x0, y0, -0.5}, {x1, y1, 0.5}}};
  };
  // Along the grid: closed, also where two meet at a corner only, as no face of cells passes there.
  EXPECT_FALSE(leaks({block(0.0, 0.3, 1.0, 0.4)}));
  EXPECT_FALSE(leaks({block(0.0, 0.3, 0.5, 0.4), block(0.5, 0.4, 1.0, 0.5)}));
  // A thin wall between two thick blocks that fills no cell by half, beside which the blocks make cells solid.
  EXPECT_TRUE(leaks({block(0.0, 0.0, 0.4, 1.0), block(0.3, 0.33, 0.7, 0.37), block(0.6, 0.0, 1.0, 1.0)}));
  // Thick ones that cut cells anywhere, apart and touching, have no gaps of their own.
  EXPECT_FALSE(leaks({block(0.13, 0.22, 0.44, 0.71), block(0.44, 0.17, 0.83, 0.52)}));
  EXPECT_FALSE(leaks({block(0.13, 0.22, 0.44, 0.71), block(0.68, 0.17, 0.93, 0.52)}));
  EXPECT_FALSE(leaks({{"disc", Cylinder{{0.43, 0.52, 0.0}, 0.31, 1.0, along_z}}, block(0.0, 0.0, 1.0, 0.23)}));
}

}  // namespace
}  // namespace brisance::setup
