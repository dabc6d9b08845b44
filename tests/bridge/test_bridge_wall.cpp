// A wall of steel in the MPM region, hit by a plane shock: the reflected pressure and the impulse on the wall.
#include "bridge/harness.hpp"

namespace brisance::test {
namespace {

constexpr double gamma = 1.4;
constexpr material::Primitive ambient{1.225, 101325.0, {0.0, 0.0, 0.0}};

/// State behind a shock of a Mach number into the ambient air, [Anderson03] Eqs. (3.53)-(3.57), and the pressure behind
/// its reflection at a rigid wall, from the shock that brings the air behind to rest.
struct Shock {
  material::Primitive behind;
  double speed = 0.0;      ///< [m/s]
  double reflected = 0.0;  ///< pressure [Pa]
  double back = 0.0;       ///< speed of the reflected shock [m/s]
};

Shock shock_of(double mach) {
  Shock s;
  double const c = std::sqrt(gamma * ambient.pressure / ambient.density);
  double const m2 = mach * mach;
  s.speed = mach * c;
  s.behind.pressure = ambient.pressure * (1.0 + 2.0 * gamma / (gamma + 1.0) * (m2 - 1.0));
  s.behind.density = ambient.density * (gamma + 1.0) * m2 / ((gamma - 1.0) * m2 + 2.0);
  s.behind.velocity = {s.speed * (1.0 - ambient.density / s.behind.density), 0.0, 0.0};
  // [Courant48] Eq. (70.02): p3/p2 = ((3 gamma - 1) p2 - (gamma - 1) p1) / ((gamma - 1) p2 + (gamma + 1) p1).
  double const p2 = s.behind.pressure;
  double const p1 = ambient.pressure;
  s.reflected = p2 * ((3.0 * gamma - 1.0) * p2 - (gamma - 1.0) * p1) / ((gamma - 1.0) * p2 + (gamma + 1.0) * p1);
  double const ratio = s.reflected / p2;
  double const density =
      s.behind.density * ((gamma + 1.0) * ratio + gamma - 1.0) / ((gamma - 1.0) * ratio + gamma + 1.0);
  s.back = s.behind.velocity[0] * s.behind.density / (density - s.behind.density);
  return s;
}

struct Hit {
  double pressure = 0.0;       ///< mean of the particles before the wall / exact
  double impulse = 0.0;        ///< momentum of the wall / impulse of the computed pressure on it
  double exact_impulse = 0.0;  ///< momentum of the wall / exact impulse
  double whole_impulse = 0.0;  ///< the same, since the shock's arrival
  double mass = 0.0;
};

/// The shock starts 60 cells before the wall, outside the region, whose face lies 30 cells before the wall. The wall is
/// free: after the simulation, when the waves in the steel have not come back from far inside the block, its momentum
/// is the impulse; it is so heavy that it hardly moves.
Hit hit(double mach, grid::Geometry geometry, double courant_end = 1.0) {
  Shock const s = shock_of(mach);
  bool const plane = geometry == grid::Geometry::planar2d;
  int const n = 240;
  int const rows = plane ? 4 : 1;
  int const wall = 120;
  int const face = wall - 40;
  auto c = coupled_case(geometry, {n, rows, 1}, grid::Boundary::outflow);
  if (plane) c.domain.boundary[2] = c.domain.boundary[3] = grid::Boundary::symmetry;
  set_region(c, {face, 0, 0}, {n, rows, 1});
  c.ambient.state = ambient;
  c.numerics.density_floor = 1e-6;
  c.numerics.pressure_floor = 1.0;
  run::InitialState driven;
  driven.shape = shape::Box{{-1.0, -1.0, -1.0}, {(wall - 60.0) / n, 1.0, 1.0}};
  driven.state = s.behind;
  c.initial_states = {driven};
  run::Body body;
  body.name = "steel";
  body.solid = material::elastic_solid(7850.0, 210e9, 0.3);
  body.shape = shape::Box{{wall * c.domain.h, -1.0, -1.0}, {(n - 20) * c.domain.h, 1.0, 1.0}};
  c.particles.bodies = {body};
  run::World w = setup::build(c);
  run::Totals const before = w.totals();
  double const arrival = 60.0 * c.domain.h / s.speed;
  double const end = arrival + courant_end * 20.0 * c.domain.h / s.back;  // the shock is 20 cells before the wall
  auto const pressure_before_wall = [&](double nearest, double farthest) {
    double sum = 0.0;
    double volume = 0.0;
    for_each_particle(w, w.regions.front().gas_body(), [&](mpm::ParticleSet const& set, int q) {
      double const cells = wall - set.field(Field::position_x)[q] / c.domain.h;
      if (cells < nearest || cells > farthest) return;
      double const v = set.field(Field::mass)[q] / set.field(Field::density)[q];
      sum += v * set.field(Field::pressure)[q];
      volume += v;
    });
    return sum / volume;
  };
  auto const wall_momentum = [&] { return mpm::sums(*w.regions.front().particles, 0).momentum[0]; };
  // From when the reflected shock is 12 cells before the wall; before that the shock's width matters.
  double const formed = arrival + 12.0 * c.domain.h / s.back;
  run_to(w, formed);
  double const momentum_before = wall_momentum();
  double const height = plane ? rows * c.domain.h : 1.0;
  double impulse = 0.0;  // of the computed pressure on the wall, less the ambient one, which stays on its back
  run_to(w, end, [&](run::World& now) {
    impulse += now.clock.dt * height * (pressure_before_wall(2.0, 8.0) - ambient.pressure);
  });
  double const exact = (s.reflected - ambient.pressure) * (end - formed) * height;
  Hit h;
  h.pressure = pressure_before_wall(2.0, 8.0) / s.reflected;
  h.impulse = (wall_momentum() - momentum_before) / impulse;
  h.exact_impulse = (wall_momentum() - momentum_before) / exact;
  h.whole_impulse = wall_momentum() / ((s.reflected - ambient.pressure) * (end - arrival) * height);
  h.mass = balance_of(w, before).mass;
  std::printf(
      "Mach %4.1f, %s: reflected pressure %.4f of exact (%.4g MPa); momentum of the wall %.4f of the gas impulse, "
      "%.4f of the exact one, since the arrival %.4f; mass %.1e; steps of the gas "
      "%ld, of the points %ld\n",
      mach, word_of(geometry), h.pressure, 1e-6 * s.reflected, h.impulse, h.exact_impulse, h.whole_impulse, h.mass,
      w.clock.gas_steps, w.clock.particle_steps);
  return h;
}

// Required: the reflected pressure within 2 % of that before a rigid wall (steel gives way with 0.1 m/s at most here),
// the momentum of the wall within 1 % of the impulse of the gas.
TEST(SteelWall, ReflectsAPlaneShock) {
  for (double const mach : {1.5, 3.0, 10.0}) {
    for (auto const geometry : {grid::Geometry::planar1d, grid::Geometry::planar2d}) {
      Hit const h = hit(mach, geometry);
      EXPECT_NEAR(h.pressure, 1.0, 0.02);
      EXPECT_NEAR(h.impulse, 1.0, 0.01);
      EXPECT_NEAR(h.exact_impulse, 1.0, 0.02);  // as the pressure; measured 1.3 % at Mach 10
      // Gas sticks to the nodes that it shares with the wall: the wall stands half a cell of 20 before its place, and
      // the shock arrives as much earlier.
      EXPECT_NEAR(h.whole_impulse, 1.0, 0.035);
      EXPECT_LE(h.mass, mass_tolerance);
    }
  }
}

/// A ball of hot gas bursts above a plate that is held, or above a wall of the domain in the place of its face.
struct Burst {
  /// To the side, which is closed, so that the edge of the plate is no part of the question.
  static constexpr int cells = 64;
  static constexpr int below = 16;      // where there is a plate
  static constexpr int particles = 10;  // cells of particles above the face
  static constexpr double end = 0.15;   // nothing has come to the open top
  double impulse = 0.0;                 ///< of the wall on the gas, or of what keeps the plate at rest [N s]
  double along = 0.0;                   ///< radial velocity of the particles within two cells of the face [m/s]
  double largest = 0.0;  ///< cross-section of the particles beside the axis, within six cells of the face [cells]

  [[nodiscard]] static run::Case above(int rows_below) {
    auto c = coupled_case(grid::Geometry::axisymmetric2d, {cells, 2 * cells + rows_below, 1}, grid::Boundary::outflow);
    c.domain.boundary[0] = c.domain.boundary[1] = grid::Boundary::symmetry;
    return c;
  }
  void run(run::World& w, int gas, double face) {
    run_to(w, end);
    double mass = 0.0;
    for_each_particle(w, gas, [&](mpm::ParticleSet const& set, int q) {
      double const r = set.field(Field::position_x)[q];
      double const y = (set.field(Field::position_y)[q] - face) * cells;
      if (r * cells < 1.0 && y > 0.0 && y < 6.0) {
        double const volume = set.field(Field::mass)[q] / set.field(Field::density)[q];
        largest = std::max(largest, volume / (2.0 * std::numbers::pi * std::max(r, 0.125 / cells)) * cells * cells);
      }
      if (y < 0.0 || y > 2.0 || r < 0.3 || r > 0.6) return;
      along += set.field(Field::mass)[q] * set.field(Field::velocity_x)[q];
      mass += set.field(Field::mass)[q];
    });
    if (mass > 0.0) along /= mass;
  }
  static void light(run::Case& c, double face) {
    run::InitialState ball;
    ball.shape = shape::Sphere{{0.0, face + 0.35, 0.0}, 0.1};
    ball.state = {14.0, 400.0, {0.0, 0.0, 0.0}};
    c.initial_states = {ball};
  }
  /// The wall, before it gas cells or particles.
  [[nodiscard]] static Burst on_wall(bool by_particles) {
    auto c = above(0);
    c.domain.boundary[2] = grid::Boundary::wall;
    c.mpm_regions.clear();
    if (by_particles) {
      c.mpm_regions.emplace_back();
      set_region(c, {0, 0, 0}, {cells, particles, 1});
    }
    light(c, 0.0);
    run::World w = setup::build(c);
    Burst burst;
    if (by_particles) {
      burst.run(w, 0, 0.0);
    } else {
      run_to(w, end);
    }
    burst.impulse = w.totals().momentum[1];
    return burst;
  }
  /// The plate, whose face lies a part of a cell above a node.
  [[nodiscard]] static Burst on_plate(bool slip, double part, bool rigid = false) {
    auto c = above(below);
    double const face = (below + part) * c.domain.h;
    set_region(c, {0, 0, 0}, {cells, below + particles, 1});
    c.mpm_regions.front().slip = slip;
    run::Body plate;
    plate.name = "plate";
    plate.solid = material::elastic_solid(1400.0, 1.4e5, 0.3);
    plate.shape = shape::Box{{-1.0, face - 6.0 * c.domain.h, -1.0}, {2.0, face, 1.0}};
    c.particles.bodies = {plate};
    if (rigid) {
      c.particles.bodies[0].rigid = true;
    } else {
      mpm::Constraint hold;
      hold.within = plate.shape;
      c.particles.constraints = {hold};
    }
    light(c, face);
    run::World w = setup::build(c);
    Burst burst;
    burst.run(w, 1, face);
    burst.impulse = w.regions.front().particles->accounts().constraint_impulse[1];
    return burst;
  }
};

// A burst close to a plate that is held does there what it does before a wall of the domain, along which the particles
// slip as well, wherever within a cell the face of the plate lies. Gas that sticks stands still beside it. The burst is
// small, 6 cells in radius; measured: the impulse up to 10 % higher, in the plate of example 5.4 of [Cui14] up to 5 %.
TEST(HeldPlate, FeelsTheBurstAsAWallDoes) {
  Burst const wall = Burst::on_wall(true);
  std::printf("impulse on a wall: points %.4f of gas cells\n", wall.impulse / Burst::on_wall(false).impulse);
  for (double const part : {0.0, 0.25, 0.5, 0.75}) {
    Burst const plate = Burst::on_plate(true, part);
    std::printf("face %.2f of a cell above a node: impulse on the plate %.4f of that on a wall, speed along it %.3f\n",
                part, plate.impulse / wall.impulse, plate.along / wall.along);
    EXPECT_NEAR(plate.impulse / wall.impulse, 1.0, 0.12);
    EXPECT_NEAR(plate.along / wall.along, 1.0, 0.12);
    // Particles of a ninth of a cell, which are split when they fill twice that: the two drift apart by little.
    std::printf("  the largest point beside the axis fills %.2f of a cell\n", plate.largest);
    EXPECT_GT(plate.largest, 0.1);
    EXPECT_LT(plate.largest, 0.35);
  }
  Burst const rigid = Burst::on_plate(true, 0.0, true);
  std::printf("rigid plate: impulse %.4f, speed along it %.3f\n", rigid.impulse / wall.impulse,
              rigid.along / wall.along);
  EXPECT_NEAR(rigid.impulse / wall.impulse, 1.0, 0.12);
  EXPECT_NEAR(rigid.along / wall.along, 1.0, 0.12);
  Burst const stuck = Burst::on_plate(false, 0.0);
  std::printf("where gas sticks: impulse %.4f, speed along it %.3f\n", stuck.impulse / wall.impulse,
              stuck.along / wall.along);
  EXPECT_LT(stuck.along / wall.along, 0.5);
}

}  // namespace
}  // namespace brisance::test
