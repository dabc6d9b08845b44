// Bodies that start under their weight: the stress at the start against closed forms, and that they stay at rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "material/compressed.hpp"
#include "run/world.hpp"
#include "setup/build.hpp"
#include "setup/initial_stress.hpp"

namespace brisance::setup {
namespace {

using grid::Boundary;
using grid::Geometry;
using mpm::Field;

constexpr double g = 9.81;
constexpr double depth = 2.0;

/// Direction of gravity: the last one that is resolved.
int vertical_of(Geometry geometry) { return grid::dimensions(geometry) - 1; }

material::Material soil() {
  material::Material solid = material::elastic_solid(1800.0, 50e6, 0.3);
  solid.name = "soil";
  solid.strength = material::DruckerPrager{material::shear_modulus_of(50e6, 0.3)};
  return solid;
}

/// A layer of a material, 2 m deep, between walls and on one.
Case layer(Geometry geometry, material::Material const& solid) {
  Case c;
  c.domain.geometry = geometry;
  c.domain.h = 0.1;
  c.domain.cells = {6, 6, 6};
  for (int d = grid::dimensions(geometry); d < 3; ++d) c.domain.cells[d] = 1;
  int const up = vertical_of(geometry);
  c.domain.cells[up] = 24;
  c.domain.boundary.fill(Boundary::symmetry);
  c.domain.boundary[2 * up + 1] = Boundary::outflow;
  c.end.time = 1.0;
  c.particles.options.body_force[up] = -g;
  Body body;
  body.name = "layer";
  body.solid = solid;
  shape::Box box{{-10.0, -10.0, -10.0}, {10.0, 10.0, 10.0}};
  for (int d = 0; d < grid::dimensions(geometry); ++d) {
    box.lower[d] = 0.0;
    box.upper[d] = d == up ? depth : 0.6;
  }
  body.shape = box;
  body.lateral_stress = material::lateral_coefficient(solid);
  c.particles.bodies = {body};
  return c;
}

template <class Visit>
void for_points(run::World& world, int body, Visit visit) {
  for (int b = 0; b < world.regions.front().particles->grid().block_count(); ++b) {
    mpm::ParticleSet const& set = world.regions.front().particles->particles(b, body);
    for (int q = 0; q < set.size(); ++q) visit(set, q);
  }
}

/// Largest speed of a case in its first `time` [s].
double fastest(Case const& c, double time) {
  run::World world = build(c);
  double most = 0.0;
  while (world.clock.time < time) {
    run::advance(world, time);
    for_points(world, 0, [&](mpm::ParticleSet const& set, int q) {
      for (int d = 0; d < 3; ++d) most = std::max(most, std::abs(set.field(Field::velocity_x + d)[q]));
    });
  }
  return most;
}

class InitialStress : public testing::TestWithParam<Geometry> {};
INSTANTIATE_TEST_SUITE_P(Geometries, InitialStress,
                         testing::Values(Geometry::planar1d, Geometry::planar2d, Geometry::axisymmetric2d,
                                         Geometry::cartesian3d),
                         [](auto const& one) { return std::string(word_of(one.param)); });

// dS/dz = g rho0 (1 + b S) below the surface, b S the compression under the mean stress: S = (exp(g rho0 b z) - 1)/b.
TEST_P(InitialStress, IsThatOfTheWeightAbove) {
  set_threads(1);
  Geometry const geometry = GetParam();
  int const up = vertical_of(geometry);
  Case const c = layer(geometry, soil());
  double const K0 = *c.particles.bodies[0].lateral_stress;
  EXPECT_NEAR(K0, 0.3 / 0.7, 1e-12);
  double const b = (1.0 + 2.0 * K0) / 3.0 / material::bulk_modulus_of(50e6, 0.3);
  run::World world = build(c);
  for_points(world, 0, [&](mpm::ParticleSet const& set, int q) {
    double const z = depth - set.field(Field::position_x + up)[q];
    double const S = std::expm1(g * 1800.0 * b * z) / b;
    double const p = set.field(Field::pressure)[q];
    for (int d = 0; d < 3; ++d) {
      double const stress = p - set.field(Field::deviator_xx + d)[q];
      EXPECT_NEAR(stress / S, d == up ? 1.0 : K0, 1e-7);
      EXPECT_EQ(set.field(Field::deviator_xy + d)[q], 0.0);
    }
    EXPECT_EQ(
        p, material::pressure(c.particles.bodies[0].solid, set.field(Field::density)[q], set.field(Field::energy)[q]));
  });
}

// The elastic energy of uniaxial compression, S^2/(2 M) per volume with the modulus M = K + 4 G/3: in all
// g^2 rho^2 L^3/(6 M) for a column of unit cross-section, up to the compression itself, 0.03 %.
TEST(InitialStress, HasTheEnergyOfItsCompression) {
  set_threads(1);
  Case const c = layer(Geometry::planar1d, soil());
  run::World const world = build(c);
  double const M = material::bulk_modulus_of(50e6, 0.3) + 4.0 / 3.0 * material::shear_modulus_of(50e6, 0.3);
  double const exact = std::pow(g * 1800.0, 2) * std::pow(depth, 3) / (6.0 * M);
  EXPECT_NEAR(world.totals().energy / exact, 1.0, 2e-3);  // points in the middle of 5 cm: (0.05/2)^2 of the integral
  EXPECT_EQ(world.audit.initial.energy, world.totals().energy);
}

// Without it the layer falls and rings; with it, it trembles as the points of its surface are no integral.
TEST_P(InitialStress, KeepsALayerAtRest) {
  set_threads(1);
  Geometry const geometry = GetParam();
  double const c_p = material::sound_speed(soil(), 1800.0, 0.0);
  double const time = geometry == Geometry::cartesian3d ? depth / c_p : 4.0 * depth / c_p;
  Case const with = layer(geometry, soil());
  Case without = with;
  without.particles.bodies[0].lateral_stress.reset();
  double const still = fastest(with, time);
  double const falling = fastest(without, time);
  std::printf("%s: fastest %.2e m/s with, %.2e m/s without initial stress\n", word_of(geometry), still, falling);
  EXPECT_GT(falling, 0.5 * g * depth / c_p);
  EXPECT_LT(still, 0.02 * falling);
}

TEST(InitialStress, OfWaterIsHydrostatic) {
  set_threads(1);
  material::Fluid fluid;
  fluid.name = "water";
  fluid.density = 1000.0;
  fluid.pressure = 101325.0;
  fluid.eos = material::StiffenedGas{4.4, 6e8};
  Case const c = layer(Geometry::planar2d, material::of(fluid));
  EXPECT_EQ(*c.particles.bodies[0].lateral_stress, 1.0);
  run::World world = build(c);
  for_points(world, 0, [&](mpm::ParticleSet const& set, int q) {
    double const z = depth - set.field(Field::position_y)[q];
    EXPECT_NEAR((set.field(Field::pressure)[q] - 101325.0) / (1000.0 * g * z), 1.0, 1e-5);
  });
}

// A slab of 0.2 m on the layer: its weight is on everything below, and it bears only its own.
TEST(InitialStress, CountsWhatStandsAbove) {
  set_threads(1);
  Case c = layer(Geometry::planar2d, soil());
  Body slab;
  slab.name = "slab";
  slab.solid = material::elastic_solid(2400.0, 30e9, 0.2);
  slab.shape = shape::Box{{0.0, depth, -1.0}, {0.3, depth + 0.2, 1.0}};
  slab.particles_per_direction = 3;
  c.particles.bodies.push_back(slab);
  run::World world = build(c);
  double const K = material::bulk_modulus_of(50e6, 0.3);
  double const weight = 2400.0 * g * 0.2;
  for_points(world, 0, [&](mpm::ParticleSet const& set, int q) {
    double const z = depth - set.field(Field::position_y)[q];
    double const b = (1.0 + 2.0 * *c.particles.bodies[0].lateral_stress) / 3.0 / K;
    double const load = set.field(Field::position_x)[q] < 0.3 ? weight : 0.0;
    double const S = (std::exp(g * 1800.0 * b * z) * (1.0 + b * load) - 1.0) / b;
    EXPECT_NEAR((set.field(Field::pressure)[q] - set.field(Field::deviator_yy)[q]) / S, 1.0, 1e-7);
  });
  for_points(world, 1,
             [&](mpm::ParticleSet const& set, int q) { EXPECT_NEAR(set.field(Field::pressure)[q], 0.0, 1e-3); });
}

// Nor does what hangs above a gap, or a rigid body that carries itself, weigh on the layer.
TEST(InitialStress, DoesNotCountWhatDoesNotStandOnIt) {
  set_threads(1);
  Case c = layer(Geometry::planar2d, soil());
  run::World alone = build(c);
  Body other;
  other.name = "other";
  other.solid = material::elastic_solid(2400.0, 30e9, 0.2);
  other.shape = shape::Box{{0.0, depth + 0.1, -1.0}, {0.3, depth + 0.3, 1.0}};
  c.particles.bodies.push_back(other);
  run::World above = build(c);
  c.particles.bodies[1].shape = shape::Box{{0.0, depth, -1.0}, {0.3, depth + 0.2, 1.0}};
  c.particles.bodies[1].rigid = true;
  run::World rigid = build(c);
  auto const pressures = [](run::World& world) {
    std::vector<double> all;
    for_points(world, 0, [&](mpm::ParticleSet const& set, int q) { all.push_back(set.field(Field::pressure)[q]); });
    return all;
  };
  EXPECT_EQ(pressures(alone), pressures(above));
  EXPECT_EQ(pressures(alone), pressures(rigid));
}

TEST(InitialStress, MustBeBorne) {
  material::Material solid = soil();
  auto& strength = std::get<material::DruckerPrager>(solid.strength);
  strength.cohesion = 0.0;
  strength.friction = 20.0;
  strength.tension = 0.0;
  strength.dilation = 0.0;
  Case c = layer(Geometry::planar2d, solid);
  c.particles.bodies[0].lateral_stress = 0.1;
  EXPECT_THROW(build(c), InputError);
  c.particles.bodies[0].lateral_stress = 0.8;
  EXPECT_NO_THROW(build(c));
  c.particles.options.body_force = {1.0, -g, 0.0};
  EXPECT_THROW(build(c), InputError);
}

TEST(Compressed, HasThePressureThatWasAskedFor) {
  material::Material metal = material::elastic_solid(8930.0, 117e9, 0.35);
  metal.eos = material::MieGruneisen{};
  metal.density = std::get<material::MieGruneisen>(metal.eos).rho0;
  for (double const pressure : {1e3, 1e6, 1e9}) {
    auto const state = material::compressed_to(metal, pressure);
    EXPECT_NEAR(material::pressure(metal, state.density, state.specific_energy) / pressure, 1.0,
                1e-6 + 1e-3 / pressure);
    EXPECT_GT(state.density, metal.density);
  }
  auto const start = material::compressed_to(metal, 0.0);
  EXPECT_EQ(start.density, metal.density);
  EXPECT_EQ(start.specific_energy, metal.specific_energy);
}

}  // namespace
}  // namespace brisance::setup
