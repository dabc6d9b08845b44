// The remap: what a 1D burst holds is on the grid afterwards, to round-off, wherever the charge lies; what the burst
// has not touched keeps every bit; pressures are those of the profile.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "../run/cases.hpp"
#include "core/parallel.hpp"
#include "setup/fluids.hpp"
#include "setup/profile_fit.hpp"
#include "setup/start.hpp"

namespace brisance::setup {
namespace {

using namespace run;

using grid::Boundary;
using grid::Geometry;
using shape::Cylinder;
using shape::Hemisphere;
using shape::Shape;
using shape::Sphere;

constexpr double radius = 0.05;  // of the charges [m]

Case remapped(Geometry geometry, Index3 const& cells, double h, Shape const& shape, double burst) {
  Case c = air_case(geometry, cells, h, Boundary::outflow);
  if (geometry == Geometry::axisymmetric2d) c.domain.boundary[0] = Boundary::symmetry;
  c.charges = {tnt_charge(shape, geometry)};
  c.start.remap = true;
  c.start.radius = burst;
  c.start.cell = radius / 40.0;  // the remap cares for no resolution of the burst
  return c;
}

/// Momentum per volume that the profile has at a place relative to the charge's centre, by its definition: the cell
/// that the place lies in, and which way that cell's radius and axis particle there. Zero beyond the burst.
Vec3 momentum_at(detonation::Profile const& p, Charge const& charge, Geometry geometry, Vec3 x) {
  for (int d = grid::dimensions(geometry); d < 3; ++d) x[d] = 0.0;
  double const h = p.domain.h;
  double const* const radial = p.component(gas::momentum_x);
  if (p.domain.geometry != Geometry::axisymmetric2d) {
    double const r = norm(x);
    int const i = static_cast<int>(r / h);
    if (i >= p.domain.cells[0]) return {0.0, 0.0, 0.0};
    return (radial[i] / r) * x;
  }
  Vec3 const axis = std::get<Cylinder>(charge.shape).axis;
  double height = dot(x, axis);
  Vec3 const across = x - height * axis;
  double turned = 1.0;
  if (p.mirrored && height < p.domain.lower[1]) {
    height = 2.0 * p.domain.lower[1] - height;
    turned = -1.0;
  }
  double const r = norm(across);
  int const i = static_cast<int>(r / h);
  int const j = static_cast<int>(std::floor((height - p.domain.lower[1]) / h));
  if (i >= p.domain.cells[0] || j < 0 || j >= p.domain.cells[1]) return {0.0, 0.0, 0.0};
  std::size_t const n = i + static_cast<std::size_t>(p.domain.cells[0]) * j;
  return (radial[n] / r) * across + (turned * p.component(gas::momentum_y)[n]) * axis;
}

/// The momentum of every cell against the mean of the profile over a lattice of places in it, which knows neither the
/// quadrature nor the sums to which the remap corrects: cell by cell, and the sums of its size and of each component.
void expect_momentum(World const& world, Case const& c) {
  detonation::Profile const& profile = *world.setup.start.profiles[0];
  Vec3 const centre = shape::centre(c.charges[0].shape);
  Geometry const geometry = c.domain.geometry;
  int const dims = c.domain.dimensions();
  int const n = dims == 3 ? 6 : 16;  // places per direction
  double const half = 0.5 * c.domain.h * std::sqrt(static_cast<double>(dims));
  double difference = 0.0;
  double size = 0.0;
  double specified_size = 0.0;
  Vec3 found{0.0, 0.0, 0.0};
  Vec3 asked{0.0, 0.0, 0.0};
  for (int b = 0; b < world.grid.block_count(); ++b) {
    grid::Block const& block = world.grid.blocks()[b];
    for (int at = 0; at < block.cell_count(); ++at) {
      Index3 const cell{block.origin[0] + at % block.n[0], block.origin[1] + at / block.n[0] % block.n[1],
                        block.origin[2] + at / (block.n[0] * block.n[1])};
      Vec3 middle = c.domain.centre(cell) - centre;
      for (int d = dims; d < 3; ++d) middle[d] = 0.0;
      if (norm(middle) - half > profile.reach()) continue;
      Vec3 mean{0.0, 0.0, 0.0};
      double weights = 0.0;
      for (int k = 0; k < (dims == 3 ? n : 1); ++k) {
        for (int j = 0; j < n; ++j) {
          for (int i = 0; i < n; ++i) {
            Vec3 x = middle;
            Index3 const place{i, j, k};
            for (int d = 0; d < dims; ++d) x[d] += ((place[d] + 0.5) / n - 0.5) * c.domain.h;
            double const weight = geometry == Geometry::axisymmetric2d ? x[0] : 1.0;
            mean = mean + weight * momentum_at(profile, c.charges[0], geometry, x);
            weights += weight;
          }
        }
      }
      double const volume = c.domain.cell_volume(cell[0]);
      mean = (volume / weights) * mean;
      Vec3 held{0.0, 0.0, 0.0};
      for (int d = 0; d < dims; ++d) held[d] = volume * world.gas->fields().at(b, gas::momentum_x + d)[at];
      difference += norm(held - mean);
      size += norm(held);
      specified_size += norm(mean);
      found = found + held;
      asked = asked + mean;
    }
  }
  fmt::print("{:<44} momentum: cell by cell {:.1e}, in size {:.1e}, in sum {:.1e} {:.1e} {:.1e}\n", "",
             difference / specified_size, size / specified_size - 1.0, (found[0] - asked[0]) / specified_size,
             (found[1] - asked[1]) / specified_size, (found[2] - asked[2]) / specified_size);
  // What a lattice of places leaves at the jumps of the profile, three times what is measured: where a cell of an
  // axisymmetric one is nearly as large as that of the grid, ten times as much.
  bool const axial = profile.domain.geometry == Geometry::axisymmetric2d;
  EXPECT_LT(difference / specified_size, axial ? 0.04 : 0.004);
  EXPECT_NEAR(size / specified_size, 1.0, axial ? 0.01 : 2e-4);
  for (int d = 0; d < dims; ++d) EXPECT_NEAR((found[d] - asked[d]) / specified_size, 0.0, axial ? 0.01 : 1e-4) << d;
  // Of one dimension: the size is the integral of the profile over shells or rings, here by the trapezoidal rule.
  if (axial) return;
  int const m = profile.domain.geometry == Geometry::spherical1d ? 2 : 1;
  double shells = 0.0;
  for (int i = 0; i < profile.domain.cells[0]; ++i) {
    double const inner = std::pow(i * profile.domain.h, m);
    double const outer = std::pow((i + 1) * profile.domain.h, m);
    shells += std::abs(profile.component(gas::momentum_x)[i]) * 0.5 * (inner + outer) * profile.domain.h;
  }
  double const whole = (m == 2 ? 4.0 : 2.0) * M_PI * shells;
  EXPECT_NEAR(specified_size / (world.starts[0].remap.share * whole), 1.0, 0.01);  // cells hold means
}

/// The sums of the profile and of the grid, the totals of the world against ambient gas with the burst in it, and the
/// cells outside.
void expect_conservation(Case const& c, std::string const& what) {
  SCOPED_TRACE(what);
  World const world = setup::build(c);
  ASSERT_EQ(world.starts.size(), c.charges.size());
  auto const& report = world.starts[0].remap;
  fmt::print(
      "{:<44} radius {:5.1f} cells, errors before the correction {:.0e}, after it {:.1e}; mixed cells: pressure "
      "{:.1e} averaged, {:.1e} fitted\n",
      what, report.cells_per_radius, report.quadrature_error, report.error(), report.pressure_error_averaged,
      report.pressure_error);
  // Round-off of sums over up to a million cells.
  EXPECT_LT(report.error(), 1e-12);
  EXPECT_GT(report.before.mass[1], 0.0);
  EXPECT_NEAR(world.charges[0].realised_mass / c.charges[0].mass, 1.0, 1e-12);

  // By another way: the whole domain against ambient gas everywhere, and the burst's differences from it.
  detonation::Profile const& profile = *world.setup.start.profiles[0];
  double volume = 0.0;
  for (int i = 0; i < c.domain.cells[0]; ++i) volume += c.domain.cell_volume(i) * c.domain.cells[1] * c.domain.cells[2];
  Totals const totals = world.totals();
  auto const expected = [&](int component) {
    double burst = 0.0;
    for (int j = 0; j < profile.domain.cells[1]; ++j) {
      for (int i = 0; i < profile.domain.cells[0]; ++i) {
        burst += profile.domain.cell_volume(i) *
                 (profile.component(component)[i + profile.domain.cells[0] * j] - profile.ambient[component]);
      }
    }
    return volume * profile.ambient[component] + report.share * burst;
  };
  EXPECT_NEAR(totals.mass[0] / expected(gas::partial_density(0)), 1.0, 1e-12);
  EXPECT_NEAR(totals.mass[1] / expected(gas::partial_density(1)), 1.0, 1e-12);
  EXPECT_NEAR(totals.energy / expected(gas::energy), 1.0, 1e-12);

  Vec3 const centre = shape::centre(c.charges[0].shape);
  auto const quiet = gas::conserved_of(world.gas->fluids(), c.ambient.state);
  long outside = 0;
  for (int b = 0; b < world.grid.block_count(); ++b) {
    grid::Block const& block = world.grid.blocks()[b];
    for (int n = 0; n < block.cell_count(); ++n) {
      Index3 const cell{block.origin[0] + n % block.n[0], block.origin[1] + n / block.n[0] % block.n[1],
                        block.origin[2] + n / (block.n[0] * block.n[1])};
      double near2 = 0.0;
      for (int d = 0; d < c.domain.dimensions(); ++d) {
        double const low = c.domain.lower[d] + cell[d] * c.domain.h - centre[d];
        double const away = std::max({low, -low - c.domain.h, 0.0});
        near2 += away * away;
      }
      if (near2 < report.radius * report.radius) continue;
      ++outside;
      for (int q = 0; q < world.gas->fields().components(); ++q) ASSERT_EQ(world.gas->fields().at(b, q)[n], quiet[q]);
    }
  }
  EXPECT_GT(outside, 10);
  expect_momentum(world, c);
}

class Remap : public testing::Test {};

TEST_F(Remap, KeepsMassEnergyAndMomentumFrom1dTo3d) {
  // A centre that no cell edge, centre or station meets.
  Case whole = remapped(Geometry::cartesian3d, {44, 45, 46}, 0.0101, Sphere{{0.2213, 0.2297, 0.2341}, radius}, 0.2);
  expect_conservation(whole, "sphere in 3D");
  Case octant = remapped(Geometry::cartesian3d, {24, 24, 24}, 0.0101, Sphere{{0.0, 0.0, 0.0}, radius}, 0.2);
  for (int d = 0; d < 3; ++d) octant.domain.boundary[2 * d] = Boundary::symmetry;
  expect_conservation(octant, "octant");
  // The other octant: the planes are the high faces.
  Case other = octant;
  other.domain.lower = {-24 * 0.0101, -24 * 0.0101, -24 * 0.0101};
  other.domain.boundary.fill(Boundary::outflow);
  for (int d = 0; d < 3; ++d) other.domain.boundary[2 * d + 1] = Boundary::symmetry;
  other.charges[0].shape = Sphere{{other.domain.upper(0), other.domain.upper(1), other.domain.upper(2)}, radius};
  other.charges[0].initiation = {{shape::centre(other.charges[0].shape), 0.0}};
  expect_conservation(other, "octant below its planes");
  Case ground = remapped(Geometry::cartesian3d, {45, 46, 24}, 0.0101,
                         Hemisphere{{0.2213, 0.2297, 0.0}, radius, {0.0, 0.0, 1.0}}, 0.2);
  ground.domain.boundary[4] = Boundary::wall;
  expect_conservation(ground, "hemisphere on the ground");
}

TEST_F(Remap, KeepsMassEnergyAndMomentumFrom1dTo2d) {
  Case turned = remapped(Geometry::axisymmetric2d, {60, 110, 1}, 0.0041, Sphere{{0.0, 0.2213, 0.0}, radius}, 0.2);
  expect_conservation(turned, "sphere in axisymmetric 2D");
  Case ground = remapped(Geometry::axisymmetric2d, {60, 60, 1}, 0.0041,
                         Hemisphere{{0.0, 0.0, 0.0}, radius, {0.0, 1.0, 0.0}}, 0.2);
  ground.domain.boundary[2] = Boundary::wall;
  expect_conservation(ground, "hemisphere in axisymmetric 2D");
  Case plane = remapped(Geometry::planar2d, {115, 120, 1}, 0.0041,
                        Cylinder{{0.2213, 0.2297, 0.0}, radius, 1.0, {0.0, 0.0, 1.0}}, 0.2);
  expect_conservation(plane, "cylinder in planar 2D");
  Case half = remapped(Geometry::planar2d, {60, 120, 1}, 0.0041,
                       Cylinder{{0.0, 0.2297, 0.0}, radius, 1.0, {0.0, 0.0, 1.0}}, 0.2);
  half.domain.boundary[0] = Boundary::symmetry;
  expect_conservation(half, "half a cylinder in planar 2D");
}

/// An axisymmetric simulation of a cylinder, until its burst has the given radius; `ground` is the height of its
/// middle above a wall, 0: in free air; `halved`: a symmetry plane through the middle leaves the upper half.
detonation::Profile cylinder_burst(double ground, double burst, double mass_factor = 1.0, bool halved = false) {
  double const scale = std::cbrt(mass_factor);
  double const h = 0.0041 * scale;
  Case c = air_case(Geometry::axisymmetric2d, {64, 128, 1}, h, Boundary::outflow);
  c.domain.boundary[0] = Boundary::symmetry;
  c.domain.lower[1] = ground > 0.0 || halved ? 0.0 : -64 * h;
  if (ground > 0.0) c.domain.boundary[2] = Boundary::wall;
  if (halved) c.domain.boundary[2] = Boundary::symmetry;
  c.charges = {
      tnt_charge(Cylinder{{0.0, ground * scale, 0.0}, 0.8 * radius * scale, 2.4 * radius * scale, {0.0, 1.0, 0.0}},
                 Geometry::axisymmetric2d)};
  World world = setup::build(c);
  while (world.gas->burn.burning() || profile_of(world).reach() < burst * scale) advance(world, 1.0);
  return profile_of(world);
}

Case cylinder_case(Vec3 const& centre, Vec3 const& axis, Index3 const& cells, double ground) {
  Case c = remapped(Geometry::cartesian3d, cells, 0.0101, Cylinder{centre, 0.8 * radius, 2.4 * radius, axis}, 0.0);
  c.start.profile = "cylinder.h5";
  detonation::Profile const profile = cylinder_burst(ground, 0.16);
  for (int d = 0; d < 3; ++d) {
    if (ground > 0.0 && axis[d] > 0.5) c.domain.boundary[2 * d] = Boundary::wall;
  }
  c.start.profiles = {fitted_profile(c, 0, profile)};
  return c;
}

TEST_F(Remap, KeepsMassEnergyAndMomentumFromAxisymmetric2dTo3d) {
  Vec3 const z{0.0, 0.0, 1.0};
  expect_conservation(cylinder_case({0.2213, 0.2297, 0.2341}, z, {44, 45, 46}, 0.0), "cylinder along z");
  expect_conservation(cylinder_case({0.2213, 0.2297, 0.2341}, {-1.0, 0.0, 0.0}, {44, 45, 46}, 0.0),
                      "cylinder along -x");
  Case octant = remapped(Geometry::cartesian3d, {24, 24, 24}, 0.0101,
                         Cylinder{{0.0, 0.0, 0.0}, 0.8 * radius, 2.4 * radius, z}, 0.0);
  for (int d = 0; d < 3; ++d) octant.domain.boundary[2 * d] = Boundary::symmetry;
  octant.start.profile = "cylinder.h5";
  octant.start.profiles = {fitted_profile(octant, 0, cylinder_burst(0.0, 0.16))};
  expect_conservation(octant, "octant of a cylinder");
  // A profile of the upper half: its image is the lower one, above the plane, below it, and without a plane.
  detonation::Profile const half = cylinder_burst(0.0, 0.16, 1.0, true);
  EXPECT_TRUE(half.mirrored);
  octant.start.profiles = {fitted_profile(octant, 0, half)};
  expect_conservation(octant, "octant of a halved cylinder");
  Case below = octant;
  below.domain.lower[2] = -24 * 0.0101;
  std::swap(below.domain.boundary[4], below.domain.boundary[5]);
  below.charges[0].shape = Cylinder{{0.0, 0.0, below.domain.upper(2)}, 0.8 * radius, 2.4 * radius, z};
  below.charges[0].initiation = {{shape::centre(below.charges[0].shape), 0.0}};
  below.start.profiles = {fitted_profile(below, 0, half)};
  expect_conservation(below, "octant of a halved cylinder below its plane");
  Case whole = cylinder_case({0.2213, 0.2297, 0.2341}, {0.0, -1.0, 0.0}, {44, 45, 46}, 0.0);
  whole.start.profiles = {fitted_profile(whole, 0, half)};
  expect_conservation(whole, "a halved cylinder, whole");
  // The shock has been reflected by the ground 80 mm below.
  Case const ground = cylinder_case({0.2213, 0.2297, 0.08}, z, {44, 45, 30}, 0.08);
  EXPECT_TRUE(ground.start.profiles[0]->mirrored);
  expect_conservation(ground, "cylinder above the ground");
  Case without = ground;
  without.domain.boundary[4] = Boundary::outflow;
  EXPECT_THROW((void)fitted_profile(without, 0, *ground.start.profiles[0]), InputError);
}

TEST_F(Remap, ScalesProfilesByTheCubeRootOfTheMass) {
  // Twice the lengths, eight times the mass; lengths are even powers of two of each other, so that the states of the
  // large simulation are those of the small one but for the round-off of the cube root.
  detonation::Profile const small = cylinder_burst(0.0, 0.16);
  detonation::Profile const large = cylinder_burst(0.0, 0.16, 8.0);
  detonation::Profile const made = detonation::scaled(small, 8.0 * small.charge.mass);
  EXPECT_NEAR(made.domain.h / large.domain.h, 1.0, 1e-12);
  EXPECT_NEAR(made.time / large.time, 1.0, 1e-9);
  ASSERT_EQ(made.cell_count(), large.cell_count());
  double worst = 0.0;
  for (std::size_t n = 0; n < made.pressure.size(); ++n)
    worst = std::max(worst, std::abs(made.pressure[n] / large.pressure[n] - 1.0));
  // Round-off of some hundred steps, amplified at shocks.
  EXPECT_LT(worst, 1e-6);
}

TEST_F(Remap, RefusesProfilesThatDoNotFit) {
  Case c = remapped(Geometry::cartesian3d, {44, 45, 46}, 0.0101, Sphere{{0.2213, 0.2297, 0.2341}, radius}, 0.15);
  detonation::Profile const good = *calculate_start(c)[0];
  c.start.profile = "p.h5";
  EXPECT_NO_THROW((void)fitted_profile(c, 0, good));
  auto const message = [&](Case const& setup, detonation::Profile const& profile) {
    try {
      (void)fitted_profile(setup, 0, profile);
    } catch (InputError const& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  auto const expect = [&](Case const& setup, detonation::Profile const& profile, char const* words) {
    EXPECT_NE(message(setup, profile).find(words), std::string::npos) << message(setup, profile);
  };
  Case other = c;
  other.charges[0].explosive.name = "PETN";
  expect(other, good, "its explosive is TNT, but that of the deck is PETN");
  other = c;
  other.charges[0].explosive.products.omega = 0.31;
  expect(other, good, "its products jwl.omega is 0.3, but that of the deck is 0.31");
  other = c;
  other.ambient.state.pressure = 9e4;
  expect(other, good, "its ambient pressure is 101325, but that of the deck is 90000");
  other = c;
  other.ambient.fluid.eos = material::StiffenedGas{};
  expect(other, good, "different equations of state");
  detonation::Profile plane = good;
  plane.domain.geometry = Geometry::cylindrical1d;
  expect(c, plane, "it is in cylindrical1d, which cannot be mapped to cartesian3d");
  other = c;
  other.charges[0].shape = Sphere{{0.2213, 0.2297, 0.2341}, 2.0 * radius};
  other.charges[0].mass *= 8.0;
  expect(other, good, "use an earlier profile");
  detonation::Profile late = good;
  late.charge.initiation[0].delay = 1e-6;
  expect(c, late, "its charge was initiated at another point or time");
  other = c;
  other.end.time = 1e-6;
  expect(other, good, "after the end of the simulation");
}

TEST_F(Remap, TwoChargesBurstAtOneTime) {
  Case c = remapped(Geometry::cartesian3d, {60, 40, 40}, 0.0101, Sphere{{0.1513, 0.2, 0.2}, radius}, 0.12);
  c.start.radius.reset();
  Charge second = tnt_charge(Sphere{{0.4513, 0.2, 0.2}, 0.8 * radius}, Geometry::cartesian3d);
  c.charges.push_back(second);
  World const world = setup::build(c);
  ASSERT_EQ(world.starts.size(), 2U);
  EXPECT_EQ(world.starts[0].remap.time, world.starts[1].remap.time);
  EXPECT_GT(world.starts[0].remap.radius, world.starts[1].remap.radius);
  double products = 0.0;
  for (int n = 0; n < 2; ++n) {
    EXPECT_LT(world.starts[n].remap.error(), 1e-12);
    EXPECT_NEAR(world.charges[n].realised_mass / c.charges[n].mass, 1.0, 1e-12);
    products += c.charges[n].mass;
  }
  EXPECT_NEAR(world.totals().mass[1] / products, 1.0, 1e-12);
}

TEST_F(Remap, IsTheSameForAnyNumberOfThreads) {
  Case const c = remapped(Geometry::cartesian3d, {40, 41, 42}, 0.0101, Sphere{{0.2013, 0.2097, 0.2141}, radius}, 0.15);
  std::vector<double> first;
  for (int const count : {1, 2, 3}) {
    set_threads(count);
    World world = setup::build(c);
    for (int step = 0; step < 3; ++step) advance(world, 1.0);
    std::vector<double> all{world.clock.time};
    for (int b = 0; b < world.grid.block_count(); ++b) {
      for (int q = 0; q < world.gas->fields().components(); ++q) {
        double const* values = world.gas->fields().at(b, q);
        all.insert(all.end(), values, values + world.grid.blocks()[b].cell_count());
      }
    }
    if (first.empty()) first = all;
    EXPECT_EQ(all, first) << count;
  }
  set_threads(0);
}

TEST_F(Remap, ParticlesGiveTheProfileOfTheGas) {
  // Means over cells of 5 mm, a tenth of the charge's radius: that is what a remap takes from a profile. Both methods
  // are of first order at the shocks, and on the same cells their shocks lag, those of the particles a little more: 2.1
  // % between the two on 200 cells per radius, 1.7 % on 250. 2 % is what is asked for; cell by cell, on the cells of
  // the default: docs/validation/remap.md.
  Case c = remapped(Geometry::axisymmetric2d, {60, 120, 1}, 0.005, Sphere{{0.0, 0.3, 0.0}, radius}, 0.0);
  c.start.radius.reset();
  c.start.time = 45e-6;
  c.start.cell = radius / 250.0;
  auto const gas = calculate_start(c)[0];
  c.start.method = StartMethod::particles;
  auto const particles = calculate_start(c)[0];
  EXPECT_EQ(particles->time, gas->time);
  // The masses of the particles are those of the shapes.
  EXPECT_NEAR(particles->sum(gas::partial_density(1)) / gas->sum(gas::partial_density(1)), 1.0, 1e-12);
  constexpr double coarse = 5e-3;
  auto const means = [&](detonation::Profile const& p, int component) {
    std::vector<double> sums(60, 0.0);
    int const group = static_cast<int>(std::lround(coarse / p.domain.h));
    for (int i = 0; i < group * static_cast<int>(sums.size()); ++i) {
      bool const inside = i < p.domain.cells[0];
      double const value = component < 0 ? (inside ? p.pressure[i] : p.ambient_pressure)
                                         : (inside ? p.component(component)[i] : p.ambient[component]);
      sums[i / group] += value * p.domain.cell_volume(i);
    }
    return sums;
  };
  double const reach = 1.05 * std::max(gas->reach(), particles->reach());
  for (int const component : {-1, gas::partial_density(0), gas::partial_density(1), gas::momentum_x, gas::energy}) {
    auto const a = means(*gas, component);
    auto const b = means(*particles, component);
    double difference = 0.0;
    double whole = 0.0;
    for (std::size_t n = 0; static_cast<double>(n) * coarse < reach; ++n) {
      difference += std::abs(a[n] - b[n]);
      whole += std::abs(a[n]);
    }
    fmt::print("points against gas, component {:2}: {:.2f} %\n", component, 100.0 * difference / whole);
    EXPECT_LT(difference / whole, 0.02) << component;
  }
}

}  // namespace
}  // namespace brisance::setup
