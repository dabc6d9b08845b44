// Velocities at the start that vary with the place: what they are at the points and in the cells, and a disc that
// turns.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "run/world.hpp"
#include "setup/build.hpp"
#include "setup/velocity_field.hpp"

namespace brisance::setup {
namespace {

using grid::Boundary;
using grid::Geometry;
using mpm::Field;

/// A disc of steel, 0.1 m in radius, in empty space.
Case disc(mpm::Transfer transfer) {
  Case c;
  c.domain.geometry = Geometry::planar2d;
  c.domain.h = 0.01;
  c.domain.cells = {40, 40, 1};
  c.domain.boundary.fill(Boundary::outflow);
  c.end.time = 1.0;
  c.particles.options.transfer = transfer;
  Body body;
  body.name = "disc";
  body.solid = material::elastic_solid(7850.0, 210e9, 0.3);
  body.shape = shape::Cylinder{{0.2, 0.2, 0.0}, 0.1, 2.0, {0.0, 0.0, 1.0}};
  c.particles.bodies = {body};
  return c;
}

template <class Visit>
void for_points(run::World& world, Visit visit) {
  for (int b = 0; b < world.regions.front().particles->grid().block_count(); ++b) {
    mpm::ParticleSet const& set = world.regions.front().particles->particles(b, 0);
    for (int q = 0; q < set.size(); ++q) visit(set, q);
  }
}

std::vector<double> velocities(run::World& world) {
  std::vector<double> all;
  for_points(world, [&](mpm::ParticleSet const& set, int q) {
    for (int d = 0; d < 3; ++d) all.push_back(set.field(Field::velocity_x + d)[q]);
  });
  return all;
}

/// About the centre of the disc; of APIC with that of the velocity gradients, whose second moment is h^2/4.
double angular_momentum(run::World& world) {
  double sum = 0.0;
  double const h = world.regions.front().particles->grid().smallest_cell();
  for_points(world, [&](mpm::ParticleSet const& set, int q) {
    double l = (set.field(Field::position_x)[q] - 0.2) * set.field(Field::velocity_y)[q] -
               (set.field(Field::position_y)[q] - 0.2) * set.field(Field::velocity_x)[q];
    if (double const* yx = set.field(Field::affine_yx)) l += 0.25 * h * h * (yx[q] - set.field(Field::affine_xy)[q]);
    sum += set.field(Field::mass)[q] * l;
  });
  return sum;
}

TEST(InitialVelocity, OfConstantExpressionsIsTheConstantOne) {
  Case constant = disc(mpm::Transfer::flip);
  constant.particles.bodies[0].velocity = {12.5, -3.0, 0.0};
  Case expressions = disc(mpm::Transfer::flip);
  expressions.particles.bodies[0].motion.expressions = {"25/2", "-3"};
  run::World a = build(constant);
  run::World b = build(expressions);
  EXPECT_EQ(velocities(a), velocities(b));
  EXPECT_EQ(velocities(a).size(), 3U * static_cast<std::size_t>(a.particle_count()));
  EXPECT_EQ(a.totals().momentum, b.totals().momentum);
}

TEST(InitialVelocity, OfASpinIsThatOfARigidBody) {
  Case spun = disc(mpm::Transfer::apic);
  spun.particles.bodies[0].motion.spin = {0.0, 0.0, 50.0};
  spun.particles.bodies[0].motion.centre = {0.2, 0.2, 0.0};
  Case expressions = disc(mpm::Transfer::apic);
  expressions.particles.bodies[0].motion.expressions = {"-50*(y - 0.2)", "50*(x - 0.2)"};
  run::World a = build(spun);
  run::World b = build(expressions);
  std::vector<double> const u = velocities(a);
  std::vector<double> const v = velocities(b);
  ASSERT_EQ(u.size(), v.size());
  for (std::size_t n = 0; n < u.size(); ++n) ASSERT_NEAR(u[n], v[n], 1e-13);
  for_points(a, [](mpm::ParticleSet const& set, int q) {
    EXPECT_NEAR(set.field(Field::affine_xy)[q], -50.0, 1e-9);
    EXPECT_NEAR(set.field(Field::affine_yx)[q], 50.0, 1e-9);
    EXPECT_NEAR(set.field(Field::affine_xx)[q], 0.0, 1e-9);
  });
  // Disc of unit thickness: L = rho pi R^4/2 omega. A point has no moment of its own, which a square of 5 mm has: 8e-4;
  // those at the rim stand in for arcs.
  Case points = disc(mpm::Transfer::flip);
  points.particles.bodies[0].motion = spun.particles.bodies[0].motion;
  run::World c = build(points);
  double const exact = 7850.0 * std::numbers::pi * std::pow(0.1, 4) / 2.0 * 50.0;
  EXPECT_NEAR(angular_momentum(c) / exact, 1.0, 2e-3);
}

// No force from outside: the angular momentum stays. APIC conserves it to round-off, its gradients at the start
// included; FLIP does not where nodes at the rim bear little mass, 0.5 % in this time with ten cells per radius.
TEST(InitialVelocity, OfATurningDiscKeepsItsAngularMomentum) {
  for (mpm::Transfer const transfer : {mpm::Transfer::flip, mpm::Transfer::apic}) {
    Case c = disc(transfer);
    c.particles.options.linear_viscosity = 0.0;
    c.particles.options.quadratic_viscosity = 0.0;
    c.particles.bodies[0].motion.spin = {0.0, 0.0, 500.0};
    c.particles.bodies[0].motion.centre = {0.2, 0.2, 0.0};
    run::World world = build(c);
    double const before = angular_momentum(world);
    double const energy = world.totals().kinetic_energy;
    for (int n = 0; n < 400; ++n) run::advance(world, c.end.time);
    double const turned = 500.0 * world.clock.time;
    std::printf("%s: after %.3f rad angular momentum %+.2e, kinetic energy %+.2e\n", word_of(transfer), turned,
                angular_momentum(world) / before - 1.0, world.totals().kinetic_energy / energy - 1.0);
    EXPECT_GT(turned, 0.05);
    EXPECT_NEAR(angular_momentum(world) / before, 1.0, transfer == mpm::Transfer::apic ? 1e-12 : 1e-2);
  }
}

/// Air in a box of 16 x 12 cells; an initial state fills a part of it.
Case tank(Geometry geometry) {
  Case c;
  c.domain.geometry = geometry;
  c.domain.h = 0.25;
  c.domain.cells = {16, 12, 1};
  c.domain.boundary.fill(Boundary::outflow);
  if (geometry == Geometry::axisymmetric2d) c.domain.boundary[0] = Boundary::symmetry;
  c.ambient.fluid.density = 1.25;
  c.ambient.fluid.pressure = 1e5;
  c.ambient.fluid.eos = material::IdealGas{1.4};
  c.ambient.state = {1.25, 1e5, {0.0, 0.0, 0.0}};
  c.end.time = 1.0;
  InitialState state;
  state.shape = shape::Box{{0.0, 0.5, -1.0}, {2.0, 2.5, 1.0}};
  state.state = {2.0, 3e5, {0.0, 0.0, 0.0}};
  state.motion.expressions = {"10*x", "-4*y + x*y"};
  c.initial_states = {state};
  return c;
}

TEST(InitialVelocity, OfGasIsThatOfTheCentresOfItsCells) {
  for (Geometry const geometry : {Geometry::planar2d, Geometry::axisymmetric2d}) {
    Case const c = tank(geometry);
    run::World const world = build(c);
    double momentum = 0.0;
    double kinetic = 0.0;
    for (int j = 0; j < 12; ++j) {
      for (int i = 0; i < 16; ++i) {
        Vec3 const x = c.domain.centre({i, j, 0});
        bool const inside = x[0] < 2.0 && x[1] > 0.5 && x[1] < 2.5;
        auto const s = world.gas->primitive(world.grid.locate(Index3{i, j, 0}));
        EXPECT_NEAR(s.velocity[0], inside ? 10.0 * x[0] : 0.0, 1e-12);
        EXPECT_NEAR(s.velocity[1], inside ? -4.0 * x[1] + x[0] * x[1] : 0.0, 1e-12);
        EXPECT_NEAR(s.pressure, inside ? 3e5 : 1e5, 1e-6);
        momentum += 2.0 * c.domain.cell_volume(i) * (inside ? s.velocity[1] : 0.0);
        kinetic += c.domain.cell_volume(i) * (inside ? dot(s.velocity, s.velocity) : 0.0);
      }
    }
    EXPECT_NEAR(world.totals().momentum[1], momentum, 1e-12 * std::abs(momentum));
    ASSERT_EQ(world.initial_states.size(), 1U);
    double const volume = world.initial_states[0].volume;
    EXPECT_NEAR(world.initial_states[0].energy / (volume * 3e5 / 0.4 + kinetic), 1.0, 1e-12);
  }
}

TEST(InitialVelocity, IsTheSameForAnyNumberOfThreads) {
  auto const momenta = [](int threads) {
    set_threads(threads);
    Case c = tank(Geometry::planar2d);
    c.numerics.block_cells = 4;
    run::World world = build(c);
    for (int n = 0; n < 5; ++n) run::advance(world, 1.0);
    set_threads(1);
    return world.totals().momentum;
  };
  EXPECT_EQ(momenta(1), momenta(4));
}

TEST(InitialVelocity, MustBeFinite) {
  Case c = disc(mpm::Transfer::flip);
  c.particles.bodies[0].motion.expressions = {"1/(x - x)", "0"};
  EXPECT_THROW(build(c), InputError);
}

}  // namespace
}  // namespace brisance::setup
