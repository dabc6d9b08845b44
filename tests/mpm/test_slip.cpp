// Fluids that slip along bodies: nothing brakes them along the surface, nothing passes through it, and what one gives
// the other takes.
#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

constexpr double density = 1.4;  // of the gas, whose sound travels at 1 m/s at a pressure of 1 Pa
constexpr double pressure = 1.0;

/// Gas over a body of a thousand times its density, whose face rises with x at a slope; both move at will.
struct Stream : Problem {
  static constexpr int cells = 40;
  double slope = 0.0;
  int gas = 0;
  int body = 0;

  explicit Stream(bool slips, double rise = 0.0) : slope(rise) {
    box(Geometry::planar2d, 1.0 / cells, {cells, cells, 1}, Boundary::symmetry);
    if (slope == 0.0) domain.boundary[0] = domain.boundary[1] = Boundary::periodic;
    options.linear_viscosity = 0.06;
    options.quadratic_viscosity = 1.5;
    material::Material fluid;
    fluid.name = "gas";
    fluid.eos = material::IdealGas{1.4};
    fluid.density = density;
    gas = add(fluid);
    bodies[gas].slips = slips;
    bodies[gas].transfer = Transfer::apic;
    bodies[gas].order = StressOrder::usl;
    body = add(material::elastic_solid(1000.0 * density, 1e5, 0.3));
    start();
    mpm->set_reference_pressure(gas, pressure);
  }

  [[nodiscard]] double above(Vec3 const& x) const { return x[1] - 0.4 - slope * (x[0] - 0.5); }

  /// Fills both, each particle where it belongs, but for a margin around them.
  void fill_both(Vec3 const& velocity, double margin = 0.0) {
    mpm::Filling fluid;
    mpm::Filling solid;
    double const spacing = 0.5 * domain.h;
    for (int j = 0; j < 2 * cells; ++j) {
      for (int i = 0; i < 2 * cells; ++i) {
        Vec3 const x{(i + 0.5) * spacing, (j + 0.5) * spacing, 0.0};
        if (std::min({x[0], x[1], 1.0 - x[0], 1.0 - x[1]}) < margin) continue;
        mpm::Filling& to = above(x) > 0.0 ? fluid : solid;
        to.positions.push_back(x);
        to.volumes.push_back(spacing * spacing);
      }
    }
    fluid.velocity = velocity;
    fluid.specific_energy = pressure / (0.4 * density);
    mpm->fill(gas, fluid);
    mpm->fill(body, solid);
  }

  /// How far particles of the gas have come into the body [cells].
  double deepest() {
    return largest(gas, [&](mpm::ParticleSet const& set, int q) { return -above(position(set, q)) / domain.h; });
  }

  /// Mean of the gas's velocity along the face over that at the start, in the cell next to the face, away from the
  /// ends.
  double next_to_face(Vec3 const& start) {
    double sum = 0.0;
    double mass = 0.0;
    for_each_particle(gas, [&](mpm::ParticleSet const& set, int q) {
      Vec3 const x = position(set, q);
      if (above(x) > domain.h || x[0] < 0.3 || x[0] > 0.7) return;
      sum += set.field(Field::mass)[q] * dot(get(set, q, Field::velocity_x), start);
      mass += set.field(Field::mass)[q];
    });
    return sum / mass / dot(start, start);
  }
};

// Gas that flows along a body at rest keeps its velocity to round-off, and the body stays where it is. Where it sticks,
// it loses it next to the body within the time that it takes to pass ten cells.
TEST(Slip, GasFlowsAlongABody) {
  Vec3 const along{0.5, 0.0, 0.0};
  for (bool const slips : {true, false}) {
    Stream s(slips);
    s.fill_both(along);
    s.run(0.5, 0.2 * s.domain.h);
    double const kept = s.next_to_face(along);
    double const pushed = norm(mpm::sums(*s.mpm, s.body).momentum);
    std::printf("%s: velocity next to the body %.15f of the first, momentum of the body %.2e\n",
                slips ? "slips" : "sticks", kept, pushed);
    if (slips) {
      EXPECT_NEAR(kept, 1.0, 1e-13);
      EXPECT_LT(pushed, 1e-13);
    } else {
      EXPECT_LT(kept, 0.5);
    }
  }
}

// The same on a slope: the normal comes from the particles of the body, which stand in steps of half a cell and make
// the face rough.
TEST(Slip, GasFlowsAlongASlope) {
  double const slope = 0.5;
  double const length = std::sqrt(1.0 + slope * slope);
  Vec3 const along{0.5 / length, 0.5 * slope / length, 0.0};
  for (bool const slips : {true, false}) {
    Stream s(slips, slope);
    s.fill_both(along);
    s.run(0.25, 0.2 * s.domain.h);  // waves from the ends have not come near
    double const kept = s.next_to_face(along);
    std::printf("%s: velocity next to the slope %.4f of the first\n", slips ? "slips" : "sticks", kept);
    if (slips) {
      // Measured: 0.912. A wave of 7 degrees in the normal would do that.
      EXPECT_NEAR(kept, 1.0, 0.12);
    } else {
      EXPECT_LT(kept, 0.5);
    }
  }
}

// Gas that runs against a body stops there: it does not come in. Along the face neither changes.
TEST(Slip, NothingPassesTheFaceAndNothingIsLostAlongIt) {
  Stream s(true);
  s.fill_both({0.3, -0.5, 0.0});
  Vec3 const before = mpm::sums(*s.mpm, s.gas).momentum;
  s.run(0.4, 0.1 * s.domain.h);
  Vec3 const after = mpm::sums(*s.mpm, s.gas).momentum;
  std::printf(
      "deepest point of the gas %.3f cells within the body; momentum of the gas along the face %.1e, across %.3f\n",
      s.deepest(), after[0] / before[0] - 1.0, after[1] / before[1]);
  EXPECT_LT(s.deepest(), 0.05);
  EXPECT_NEAR(after[0] / before[0], 1.0, 1e-13);
  EXPECT_NEAR(mpm::sums(*s.mpm, s.body).momentum[0] / before[0], 0.0, 1e-13);
  EXPECT_LT(after[1] / before[1], 0.8);
}

// What one gives the other takes, on a rough face too.
TEST(Slip, MomentumIsConserved) {
  Stream s(true, 0.5);
  s.fill_both({0.3, -0.5, 0.0}, 0.2);
  Vec3 const before = s.momentum();
  s.run(0.1, 0.1 * s.domain.h);
  Vec3 const after = s.momentum();
  Vec3 const body = mpm::sums(*s.mpm, s.body).momentum;
  std::printf("momentum of the body %.4g %.4g, change of all %.1e\n", body[0], body[1],
              norm(after - before) / norm(before));
  EXPECT_LT(norm(after - before) / norm(before), 1e-13);
  EXPECT_GT(norm(body) / norm(before), 0.1);
}

// A body that is held stops the gas before it too, though gas that slips is not held itself: it flows along.
TEST(Slip, AHeldBodyHoldsTheGasAcrossItsFaceOnly) {
  Vec3 const towards{0.5, -0.2, 0.0};
  Stream s(true);
  mpm::Constraint hold;
  hold.within = shape::Box{{-1.0, -1.0, -1.0}, {2.0, 0.4, 1.0}};
  s.constraints.push_back(hold);
  s.start();
  s.mpm->set_reference_pressure(s.gas, pressure);
  s.fill_both(towards);
  double const along = mpm::sums(*s.mpm, s.gas).momentum[0];
  s.run(0.3, 0.1 * s.domain.h);
  auto const gas = mpm::sums(*s.mpm, s.gas);
  auto const body = mpm::sums(*s.mpm, s.body);
  std::printf("deepest point of the gas %.3f cells; momentum along %.1e, constraint %.4g %.4g\n", s.deepest(),
              gas.momentum[0] / along - 1.0, s.mpm->accounts().constraint_impulse[0],
              s.mpm->accounts().constraint_impulse[1]);
  EXPECT_LT(s.deepest(), 0.05);
  EXPECT_NEAR(gas.momentum[0] / along, 1.0, 1e-13);
  EXPECT_NEAR(s.mpm->accounts().constraint_impulse[0] / along, 0.0, 1e-13);
  EXPECT_GT(s.mpm->accounts().constraint_impulse[1], 0.0);
  EXPECT_LT(body.largest_displacement, 1e-6);
}

/// A block on the floor of a room full of gas; all faces are walls, which the block may leave and the gas may not.
struct Room : Problem {
  int gas = 0;
  int block = 0;

  /// `reference`: pressure that the gas pushes without.
  explicit Room(double reference, double speed, double lift = 0.0) {
    constexpr int cells = 20;
    box(Geometry::planar2d, 1.0 / cells, {cells, cells, 1}, Boundary::wall);
    options.linear_viscosity = 0.06;
    options.quadratic_viscosity = 1.5;
    options.block_cells = 8;
    material::Material fluid;
    fluid.name = "gas";
    fluid.eos = material::IdealGas{1.4};
    fluid.density = density;
    gas = add(fluid);
    bodies[gas].slips = true;
    bodies[gas].transfer = Transfer::apic;
    bodies[gas].order = StressOrder::usl;
    block = add(material::elastic_solid(1000.0 * density, 1e4, 0.3));
    start();
    mpm->set_reference_pressure(gas, reference);
    mpm->set_reference_pressure(block, reference - pressure);
    mpm::Filling fluid_particles;
    mpm::Filling solid_particles;
    double const spacing = 0.5 * domain.h;
    for (int j = 0; j < 2 * cells; ++j) {
      for (int i = 0; i < 2 * cells; ++i) {
        Vec3 const x{(i + 0.5) * spacing, (j + 0.5) * spacing, 0.0};
        bool const inside = std::abs(x[0] - 0.5) < 0.2 && x[1] > lift && x[1] < 0.3 + lift;
        mpm::Filling& to = inside ? solid_particles : fluid_particles;
        to.positions.push_back(x);
        to.volumes.push_back(spacing * spacing);
      }
    }
    fluid_particles.specific_energy = pressure / (0.4 * density);
    solid_particles.velocity = {0.0, speed, 0.0};
    mpm->fill(gas, fluid_particles);
    mpm->fill(block, solid_particles);
  }
};

TEST(Slip, AtAWallGasAndBodyUnderAnEvenPressureStayAtRest) {
  for (double const reference : {0.0, 0.5 * pressure, pressure}) {
    for (double const lift : {0.0, 0.1}) {
      Room room(reference, 0.0, lift);
      for (int n = 0; n < 200; ++n) room.mpm->advance(room.mpm->stable_step());
      double worst = 0.0;
      for (int const body : {room.gas, room.block}) {
        double const fastest = room.largest(
            body, [](mpm::ParticleSet const& set, int q) { return norm(Problem::get(set, q, Field::velocity_x)); });
        std::printf("reference %.1f lift %.1f, %s: %.3g m/s\n", reference, lift, body == room.gas ? "gas" : "block",
                    fastest);
        worst = std::max(worst, fastest);
      }
      EXPECT_LT(worst, 1e-9);
    }
  }
}

TEST(Slip, AtAWallABodyLeavesThroughTheGas) {
  Room room(pressure, 0.05);
  double const before = mpm::sums(*room.mpm, room.block).momentum[1];
  while (room.mpm->time() < 2.0) room.mpm->advance(room.mpm->stable_step());
  double const after = mpm::sums(*room.mpm, room.block).momentum[1];
  std::printf("momentum kept: %.4f\n", after / before);
  EXPECT_NEAR(after / before, 1.0, 0.05);
  double least = 1.0;
  room.for_each_particle(room.block, [&](mpm::ParticleSet const& set, int q) {
    least = std::min(least, set.field(Field::position_y)[q]);
  });
  EXPECT_NEAR(least, 0.0125 + 0.1, 0.01);
}

}  // namespace
}  // namespace brisance::test
