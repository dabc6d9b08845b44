// Motions that must change nothing: bodies that fly through the grid, and bodies that turn.
#include <numbers>

#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;
using std::numbers::pi;

class Motion : public testing::TestWithParam<ShapeFunction> {};

INSTANTIATE_TEST_SUITE_P(Shapes, Motion, testing::ValuesIn(all_shapes),
                         [](auto const& one) { return word_of(one.param); });

/// Largest change of velocity over the speed, of stress over the modulus, and of place over the way.
struct Change {
  double velocity = 0.0;
  double stress = 0.0;
  double place = 0.0;
};

Change change_of(Problem& problem, Vec3 const& v, double time, double stress) {
  Change c;
  int const dims = problem.domain.dimensions();
  problem.for_each_particle(0, [&](mpm::ParticleSet const& set, int q) {
    c.velocity = std::max(c.velocity, norm(Problem::get(set, q, Field::velocity_x) - v) / norm(v));
    auto const s = Problem::stress(set, q);
    for (int i = 0; i < 6; ++i) c.stress = std::max(c.stress, std::abs(s[i] - (i < 3 ? stress : 0.0)));
    Vec3 moved = Problem::position(set, q) - Problem::origin(set, q) - time * v;
    for (int d = dims; d < 3; ++d) moved[d] = 0.0;
    c.place = std::max(c.place, norm(moved) / (norm(v) * time));
  });
  return c;
}

// A block that starts off the lattice of the grid and flies through a periodic box, past the seam.
TEST_P(Motion, FreeBlockFliesThroughTheGrid) {
  for (Geometry const geometry : {Geometry::planar1d, Geometry::planar2d, Geometry::cartesian3d}) {
    for (Vec3 const& direction : {Vec3{1.0, 0.0, 0.0}, Vec3{0.8, 0.53, -0.31}}) {
      for (Transfer const transfer : {Transfer::flip, Transfer::apic, Transfer::xpic}) {
        Problem problem;
        problem.box(geometry, 1.0, {8, 8, 8}, Boundary::periodic);
        problem.options.shape = GetParam();
        problem.options.transfer = transfer;
        problem.options.block_cells = 4;
        problem.add(unit_solid(0.3));
        problem.start();
        Vec3 v = 0.2 * direction;
        for (int d = problem.domain.dimensions(); d < 3; ++d) v[d] = 0.0;
        problem.fill_lattice(0, {2.1317, 2.3719, 2.7123}, {6, 6, 6}, 0.5, v);
        double const time = 30.0;  // 6 cells along x
        // Tents do not hold this: a particle that comes to lie on a node leaves the next one next to no mass, but the
        // full gradient, and round-off in the stress throws that node off.
        if (GetParam() == ShapeFunction::linear && geometry != Geometry::planar1d) continue;
        problem.run(time, 0.3);
        Change const c = change_of(problem, v, time, 0.0);
        if (transfer == Transfer::flip && direction[1] != 0.0) {
          std::printf("%s %s: velocity %.1e, stress %.1e E, place %.1e\n", word_of(geometry), word_of(GetParam()),
                      c.velocity, c.stress, c.place);
        }
        // Round-off of 100 steps, in tents divided by the small masses of nodes that the rim just reaches.
        double const slack = GetParam() == ShapeFunction::linear ? 100.0 : 1.0;
        EXPECT_LT(c.velocity, 1e-13 * slack);
        EXPECT_LT(c.stress, 1e-13 * slack);
        EXPECT_LT(c.place, 1e-13 * slack);
      }
    }
  }
}

// A medium under uniform pressure that fills its periodic box and moves across it.
TEST_P(Motion, StressedMediumMovesThroughTheGrid) {
  for (Geometry const geometry : {Geometry::planar1d, Geometry::planar2d, Geometry::cartesian3d}) {
    Problem problem;
    int const n = geometry == Geometry::cartesian3d ? 6 : 8;
    problem.box(geometry, 1.0, {n, n, n}, Boundary::periodic);
    problem.options.shape = GetParam();
    problem.options.block_cells = 4;
    problem.add(unit_solid(0.3));
    problem.start();
    Vec3 v{0.16, 0.11, -0.07};
    for (int d = problem.domain.dimensions(); d < 3; ++d) v[d] = 0.0;
    problem.fill(0, shape::Everywhere{}, [&](Vec3 const&) { return v; });
    double const pressure = 1e-3;
    problem.for_each_particle(0, [&](mpm::ParticleSet& set, int q) {
      problem.put_stress(0, set, q, {-pressure, -pressure, -pressure, 0.0, 0.0, 0.0});
    });
    double const time = 25.0;
    problem.run(time, 0.3);
    Change const c = change_of(problem, v, time, -pressure);
    std::printf("%s %s under pressure: velocity %.1e, stress %.1e p, place %.1e\n", word_of(geometry),
                word_of(GetParam()), c.velocity, c.stress / pressure, c.place);
    // The forces of evenly spaced particles cancel but for round-off; those of tents jump when particles reach a node.
    if (GetParam() == ShapeFunction::linear && geometry != Geometry::planar1d) continue;
    EXPECT_LT(c.velocity, 1e-11);
    EXPECT_LT(c.stress / pressure, 1e-11);
    EXPECT_LT(c.place, 1e-11);
  }
}

/// A stress without forces in a disc of radius 1 that leaves its rim free: from the Airy function
/// (1 - r^2)^3 (1 + x + 2 x y), value and slope of which vanish at the rim. xx yy xy.
std::array<double, 3> residual_stress(double x, double y) {
  double const u = 1.0 - x * x - y * y;
  if (u <= 0.0) return {0.0, 0.0, 0.0};
  double const f = 1.0 + x + 2.0 * x * y;
  double const fx = 1.0 + 2.0 * y;
  double const fy = 2.0 * x;
  double const xx = (24.0 * x * x * u - 6.0 * u * u) * f - 12.0 * x * u * u * fx;
  double const yy = (24.0 * y * y * u - 6.0 * u * u) * f - 12.0 * y * u * u * fy;
  double const xy = 24.0 * x * y * u * f - 6.0 * u * u * (x * fy + y * fx) + 2.0 * u * u * u;
  return {yy, xx, -xy};
}

using Tensor = std::array<std::array<double, 3>, 3>;
Tensor tensor(std::array<double, 6> const& s) { return {{{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}}}; }
Vec3 cross(Vec3 const& a, Vec3 const& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Rotation about a unit vector [Rodrigues40].
Tensor rotation(Vec3 const& axis, double angle) {
  Tensor const K{{{0.0, -axis[2], axis[1]}, {axis[2], 0.0, -axis[0]}, {-axis[1], axis[0], 0.0}}};
  Tensor R{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double const unit = i == j ? 1.0 : 0.0;
      R[i][j] = unit + std::sin(angle) * K[i][j] + (1.0 - std::cos(angle)) * (axis[i] * axis[j] - unit);
    }
  }
  return R;
}

/// Root mean square difference of the stress from the one at the start turned by R, over that of the stress.
double off_turned(Problem& problem, std::vector<Tensor> const& before, Tensor const& R) {
  double off = 0.0;
  double whole = 0.0;
  problem.for_each_particle(0, [&](mpm::ParticleSet const& set, int q) {
    Tensor const& a = before[static_cast<std::size_t>(set.field(Field::identity)[q])];
    Tensor const now = tensor(Problem::stress(set, q));
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        double turned = 0.0;
        for (int k = 0; k < 3; ++k) {
          for (int l = 0; l < 3; ++l) turned += R[i][k] * a[k][l] * R[j][l];
        }
        off += (now[i][j] - turned) * (now[i][j] - turned);
        whole += turned * turned;
      }
    }
  });
  return std::sqrt(off / whole);
}

std::vector<Tensor> all_stresses(Problem& problem) {
  std::vector<Tensor> out(static_cast<std::size_t>(mpm::particle_count(*problem.mpm)));
  problem.for_each_particle(0, [&](mpm::ParticleSet const& set, int q) {
    out[static_cast<std::size_t>(set.field(Field::identity)[q])] = tensor(Problem::stress(set, q));
  });
  return out;
}

// Every node is held at the velocity of a rigid rotation, a steady field on the grid: nothing but the particles' motion
// and the spin is left. A block with an arbitrary stress, in the plane and about an oblique axis.
TEST_P(Motion, StressTurnsWithAGivenRotation) {
  for (Geometry const geometry : {Geometry::planar2d, Geometry::cartesian3d}) {
    for (StressOrder const order : all_orders) {
      bool const solid = geometry == Geometry::cartesian3d;
      Problem problem;
      int const n = solid ? 7 : 12;
      problem.box(geometry, 1.0, {n, n, n}, Boundary::outflow, {-0.5 * n, -0.5 * n, solid ? -0.5 * n : -0.5});
      problem.options.shape = GetParam();
      problem.options.order = order;
      problem.options.block_cells = 6;
      Vec3 const axis = solid ? Vec3{0.48, 0.6, 0.64} : Vec3{0.0, 0.0, 1.0};
      double const spin = 1e-3;
      for (int k = 0; k <= (solid ? n : 0); ++k) {
        for (int j = 0; j <= n; ++j) {
          for (int i = 0; i <= n; ++i) {
            Vec3 const x{i - 0.5 * n, j - 0.5 * n, solid ? k - 0.5 * n : 0.0};
            shape::Box const around{x - Vec3{0.1, 0.1, 0.1}, x + Vec3{0.1, 0.1, 0.1}};
            problem.constraints.push_back({around, {true, true, true}, spin * cross(axis, x), -1});
          }
        }
      }
      problem.add(unit_solid(0.3));
      problem.start();
      auto const velocity = [&](Vec3 const& x) { return spin * cross(axis, {x[0], x[1], solid ? x[2] : 0.0}); };
      problem.fill(
          0, solid ? shape::Box{{-1.0, -2.0, -1.5}, {1.0, 1.0, 1.5}} : shape::Box{{-2.0, -3.0, -1.0}, {3.0, 1.0, 1.0}},
          velocity);
      problem.for_each_particle(0, [&](mpm::ParticleSet& set, int q) {
        Vec3 const x = Problem::position(set, q);
        problem.put_stress(0, set, q,
                           {0.01 * x[0], -0.02 + 0.01 * x[1], 0.013, 0.02, solid ? 0.01 : 0.0, solid ? -0.015 : 0.0});
      });
      auto const before = all_stresses(problem);
      double const start = mpm::sums(*problem.mpm, 0).internal_energy;
      double const per_step = 0.5 * pi / 100.0;
      double const dt = per_step / spin;
      for (double const turns : {0.25, 1.0}) {
        problem.run(turns * 2.0 * pi / spin - problem.mpm->time(), dt * (1.0 + 1e-9));
        double const off = off_turned(problem, before, rotation(axis, 2.0 * pi * turns));
        double const energy = std::abs(mpm::sums(*problem.mpm, 0).internal_energy - start) /
                              (0.02 * 0.02 * mpm::sums(*problem.mpm, 0).mass);
        if (order == StressOrder::musl) {
          std::printf("%s %s: %.2f turns, stress off by %.1e, energy by %.1e\n", word_of(geometry), word_of(GetParam()),
                      turns, off, energy);
        }
        // The spin of a step turns the stress by 2 atan(a/2) = a - a^3/12; a stress that is off by an angle is off by
        // at most twice that.
        EXPECT_LT(off, 2.0 * 2.0 * pi * turns * per_step * per_step / 12.0 + 1e-12);
        EXPECT_LT(energy, 1e-12);
      }
    }
  }
}

/// What turning did to a free body.
struct Turned {
  double stress = 0.0;  ///< root mean square over that of the stress
  double energy = 0.0;  ///< largest change over the energy of motion
};

/// A free disc (2D) or short cylinder (3D) with residual stress that turns about an axis through its centre: in 2D in
/// the equilibrium of a spinning disc, in 3D over its edge.
Turned turn(ShapeFunction shape, Transfer transfer, Geometry geometry, double radius_cells, double turns) {
  bool const solid = geometry == Geometry::cartesian3d;
  Problem problem;
  double const h = 1.0 / radius_cells;
  int const cells = static_cast<int>(std::ceil(2.0 * (solid ? 1.12 : 1.0) / h)) + 4;
  Vec3 const lower{-0.5 * cells * h, -0.5 * cells * h, solid ? -0.5 * cells * h : -0.5 * h};
  problem.box(geometry, h, {cells, cells, cells}, Boundary::outflow, lower);
  problem.options.shape = shape;
  problem.options.transfer = transfer;
  double const nu = 0.3;
  problem.add(unit_solid(nu));
  problem.start();
  double const rim = 0.02;        // speed of the rim, of the speed of sound in a bar
  double const amplitude = 2e-3;  // the stresses are a few times that
  Vec3 const axis = solid ? Vec3{0.6, 0.0, 0.8} : Vec3{0.0, 0.0, 1.0};
  problem.fill(0, shape::Cylinder{{0.0, 0.0, 0.0}, 1.0, 1.0, {0.0, 0.0, 1.0}}, [&](Vec3 const& x) {
    return rim * cross(axis, {x[0], x[1], solid ? x[2] : 0.0});
  });
  problem.for_each_particle(0, [&](mpm::ParticleSet& set, int q) {
    Vec3 const x = Problem::position(set, q);
    auto const s = residual_stress(x[0], x[1]);
    std::array<double, 6> full{amplitude * s[0], amplitude * s[1], 0.0, amplitude * s[2], 0.0, 0.0};
    if (!solid) {
      // Spinning disc in plane strain [Timoshenko70].
      double const r2 = x[0] * x[0] + x[1] * x[1];
      double const f = rim * rim / (8.0 * (1.0 - nu));
      double const radial = f * (3.0 - 2.0 * nu) * (1.0 - r2);
      double const hoop = f * ((3.0 - 2.0 * nu) - (1.0 + 2.0 * nu) * r2);
      full[0] += (radial * x[0] * x[0] + hoop * x[1] * x[1]) / r2;
      full[1] += (radial * x[1] * x[1] + hoop * x[0] * x[0]) / r2;
      full[2] += nu * (radial + hoop);
      full[3] += (radial - hoop) * x[0] * x[1] / r2;
    }
    problem.put_stress(0, set, q, full);
  });
  auto const before = all_stresses(problem);
  double const start = problem.energy();
  double const motion = problem.kinetic_energy();
  double const time = turns * 2.0 * pi / rim;
  double const dt = Problem::even_step(time, 0.5 * h / pressure_wave_speed(problem.bodies[0].solid));
  long const steps = std::lround(time / dt);
  Turned out;
  for (long n = 1; n <= steps; ++n) {
    problem.mpm->advance(dt);
    if (n % 50 == 0 || n == steps) out.energy = std::max(out.energy, std::abs(problem.energy() - start) / motion);
  }
  out.stress = off_turned(problem, before, rotation(axis, turns * 2.0 * pi));
  return out;
}

// Free bodies at a coarse resolution. The nodes beyond the rim know only the particles inside, so the outer particles
// see too little spin and some strain; FLIP keeps the vibrations that this drives, APIC damps them and pays with
// energy.
TEST(FreeRotation, DiscTurnsItsStress) {
  for (ShapeFunction const shape : {ShapeFunction::gimp, ShapeFunction::bspline}) {
    for (Transfer const transfer : {Transfer::flip, Transfer::apic}) {
      for (double const turns : {0.25, 1.0}) {
        if (turns == 1.0 && (shape != ShapeFunction::gimp || transfer != Transfer::apic)) continue;  // to save time
        Turned const t = turn(shape, transfer, Geometry::planar2d, 8.0, turns);
        std::printf("disc, %s %s, %.2f turns: stress off by %.1f %%, energy by %.2e\n", word_of(shape),
                    word_of(transfer), turns, 100.0 * t.stress, t.energy);
        // A stress that stayed where it was would be off by 200 % after a quarter.
        if (transfer == Transfer::flip) {
          EXPECT_LT(t.energy, 0.01);
        } else {
          EXPECT_LT(t.stress, turns < 0.5 ? 0.06 : 0.2);
          EXPECT_LT(t.energy, 0.08);
        }
      }
    }
  }
}

TEST(FreeRotation, CylinderTurnsOverItsEdge) {
  for (ShapeFunction const shape : {ShapeFunction::gimp, ShapeFunction::bspline}) {
    Turned const t = turn(shape, Transfer::flip, Geometry::cartesian3d, 4.0, 0.1);
    std::printf("cylinder, %s flip, 0.1 turns: stress off by %.1f %%, energy by %.2e\n", word_of(shape),
                100.0 * t.stress, t.energy);
    EXPECT_LT(t.energy, 0.01);
  }
}

}  // namespace
}  // namespace brisance::test
