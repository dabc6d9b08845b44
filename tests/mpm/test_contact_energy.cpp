// What contact does to the energy: discs that collide, water that hits metal, discs that roll and slip; and that it
// knows no direction before another.
#include <numbers>

#include "mpm/explosives.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

/// Two elastic discs that meet, `axis` after `axis` renamed: where x stands in the deck, the simulation has axes[0].
struct Collision : Problem {
  Collision(ShapeFunction shape, StressOrder order, double radius, double speed, double offset, double friction,
            Index3 const& axes = {0, 1, 2}, int dimensions = 2, int block_cells = 0) {
    auto const turned = [&](Vec3 const& x) {
      Vec3 y{};
      for (int d = 0; d < 3; ++d) y[axes[d]] = x[d];
      return y;
    };
    int const across = static_cast<int>(2.0 * radius + 14.0);
    int const along = static_cast<int>(4.0 * radius + 18.0);
    Index3 cells{1, 1, 1};
    for (int d = 0; d < dimensions; ++d) cells[axes[d]] = d == 0 ? along : across;
    box(dimensions == 2 ? Geometry::planar2d : Geometry::cartesian3d, 1.0, cells, Boundary::outflow);
    options.shape = shape;
    options.order = order;
    options.block_cells = block_cells;
    add(unit_solid(0.3));
    add(unit_solid(0.3));
    contacts.push_back({0, 1, friction});
    book_work();
    start();
    Vec3 const middle{0.5 * along, 0.5 * across, dimensions == 2 ? 0.0 : 0.5 * across};
    Vec3 const half{radius + 1.0, 0.5 * offset, dimensions == 2 ? 0.0 : 0.3 * offset};
    for (int body = 0; body < 2; ++body) {
      double const side = body == 0 ? -1.0 : 1.0;
      Vec3 const centre = turned(middle + side * half);
      Vec3 const velocity = turned({-side * speed, 0.0, 0.0});
      auto const moving = [=](Vec3 const&) { return velocity; };
      if (dimensions == 2) {
        fill(body, shape::Cylinder{centre, radius, 1.0, {0.0, 0.0, 1.0}}, moving);
      } else {
        fill(body, shape::Sphere{centre, radius}, moving);
      }
    }
  }
};

// Slow and fast, head-on and obliquely: no energy is made or lost, at no time. A plastic impact of the nodes that meet
// would lose 4 %.
TEST(ContactEnergy, DiscsThatCollideKeepIt) {
  for (ShapeFunction const shape : {ShapeFunction::bspline, ShapeFunction::gimp, ShapeFunction::linear}) {
    for (StressOrder const order : {StressOrder::musl, StressOrder::usf, StressOrder::usl}) {
      if (shape == ShapeFunction::linear && order == StressOrder::usl) continue;  // tents tear particles apart
      for (auto const& [speed, offset] : {std::pair{0.05, 5.0}, std::pair{0.01, 0.0}, std::pair{0.01, 4.0}}) {
        Collision discs(shape, order, 8.0, speed, offset, 0.0);
        double const before = discs.energy();
        double worst = 0.0;
        double const span = 2.0 / speed + 60.0;
        for (int part = 0; part < 20; ++part) {
          discs.run(span / 20.0, 0.33);
          worst = std::max(worst, std::abs(discs.accounted() / before - 1.0));
        }
        double const back = -mpm::sums(*discs.mpm, 0).momentum[0] / (mpm::sums(*discs.mpm, 0).mass * speed);
        std::printf("%s, %s, speed %g: drift %.2g %% at most, at the end %.2g %%; back with %.3f\n", word_of(shape),
                    word_of(order), speed, 100.0 * worst, 100.0 * (discs.accounted() / before - 1.0), back);
        EXPECT_LT(worst, 1e-11);
        EXPECT_GT(back, offset == 0.0 ? 0.9 : 0.5) << "discs bounce";
        EXPECT_EQ(discs.mpm->accounts().dissipation.friction, 0.0);
      }
    }
  }
}

// Three bodies around one node, one of them rigid or not, and a ball between two plates that close in on it: pairs that
// open and close each other's gaps.
TEST(ContactEnergy, IsKeptWhereThreeBodiesMeet) {
  for (ShapeFunction const shape : {ShapeFunction::bspline, ShapeFunction::gimp}) {
    for (bool const rigid : {false, true}) {
      Problem p;
      p.box(Geometry::planar2d, 1.0, {32, 24, 1}, Boundary::outflow);
      p.options.shape = shape;
      p.options.block_cells = 8;
      for (int body = 0; body < 4; ++body) p.add(unit_solid(0.3));
      if (rigid) p.bodies[3].rigid_velocity = Vec3{0.0, -0.03, 0.0};
      for (int a = 0; a < 4; ++a) {
        for (int b = a + 1; b < 4; ++b) p.contacts.push_back({a, b, 0.2});
      }
      p.book_work();
      p.start();
      p.fill_lattice(0, {6.0, 6.0, 0.0}, {18, 8, 1}, 0.5, {0.004, 0.0, 0.0});
      p.fill_lattice(1, {15.1, 6.0, 0.0}, {18, 8, 1}, 0.5, {-0.004, 0.0, 0.0});
      p.fill_lattice(2, {12.3, 10.2, 0.0}, {10, 4, 1}, 0.5, {0.0, -0.02, 0.0});
      p.fill_lattice(3, {8.0, 13.1, 0.0}, {28, 4, 1}, 0.5, {0.0, -0.03, 0.0});
      double const before = p.energy();
      p.run(60.0, 0.1);
      double const moved = rigid ? p.mpm->accounts().outer_work : before;
      double const drift = (p.accounted() - before) / moved;
      std::printf("%s, %s: drift %.2g, friction %.3f, the bodies below have %.3f of the energy\n", word_of(shape),
                  rigid ? "rigid" : "elastic", drift, p.mpm->accounts().dissipation.friction / moved,
                  (mpm::sums(*p.mpm, 0).kinetic_energy + mpm::sums(*p.mpm, 1).kinetic_energy) / moved);
      EXPECT_GT(p.mpm->accounts().dissipation.friction, 0.0);
      EXPECT_LT(std::abs(drift), 1e-11);
    }
  }
}

/// What of a simulation must not depend on how its axes are called.
std::vector<double> picture(Collision const& c, Index3 const& axes) {
  std::vector<double> out{c.kinetic_energy(), c.energy(), c.mpm->accounts().dissipation.constraints,
                          c.mpm->accounts().dissipation.friction};
  for (int body = 0; body < 2; ++body) {
    auto const sums = mpm::sums(*c.mpm, body);
    for (int d = 0; d < 3; ++d) out.push_back(sums.momentum[axes[d]]);
    for (int d = 0; d < 2; ++d) out.push_back(sums.centre[axes[d]]);
  }
  return out;
}

// The same with the axes exchanged, the way in which bodies are cut into particles included.
TEST(ContactEnergy, NoAxisIsPreferred) {
  for (double const friction : {0.0, 0.3}) {
    for (ShapeFunction const shape : all_shapes) {
      std::vector<double> first;
      for (Index3 const& axes : {Index3{0, 1, 2}, Index3{1, 0, 2}}) {
        Collision discs(shape, StressOrder::musl, 6.3, 0.05, 3.1, friction, axes, 2, 16);
        double const scale = discs.energy();
        discs.run(60.0, 0.33);
        std::vector<double> const now = picture(discs, axes);
        if (first.empty()) first = now;
        for (std::size_t n = 0; n < now.size(); ++n) {
          // Sums in another order, over 180 steps.
          EXPECT_NEAR(now[n], first[n], 1e-10 * std::max(scale, std::abs(first[n]))) << word_of(shape) << ", " << n;
        }
      }
      EXPECT_GT(first[4 + 5], 0.0) << "the second disc has turned back";
    }
  }
  std::vector<double> first;
  for (Index3 const& axes : {Index3{0, 1, 2}, Index3{1, 2, 0}, Index3{2, 1, 0}}) {
    Collision balls(ShapeFunction::bspline, StressOrder::musl, 2.6, 0.05, 1.3, 0.3, axes, 3);
    double const scale = balls.energy();
    balls.run(33.0, 0.33);
    std::vector<double> const now = picture(balls, axes);
    if (first.empty()) first = now;
    for (std::size_t n = 0; n < now.size(); ++n) {
      EXPECT_NEAR(now[n], first[n], 1e-10 * std::max(scale, std::abs(first[n]))) << "balls, " << n;
    }
  }
}

// What contact takes is counted once, whichever blocks the nodes and particles lie in.
TEST(ContactEnergy, AccountsDoNotDependOnTheBlocks) {
  std::vector<double> first;
  for (int const block_cells : {64, 8, 5}) {
    Collision discs(ShapeFunction::bspline, StressOrder::musl, 6.3, 0.05, 3.1, 0.3, {0, 1, 2}, 2, block_cells);
    double const scale = discs.energy();
    discs.run(60.0, 0.33);
    std::vector<double> const now = picture(discs, {0, 1, 2});
    if (first.empty()) first = now;
    for (std::size_t n = 0; n < now.size(); ++n) {
      EXPECT_NEAR(now[n], first[n], 1e-10 * std::max(scale, std::abs(first[n]))) << block_cells << ", " << n;
    }
  }
  EXPECT_GT(first[3], 1e-3 * first[1]) << "there is friction";
}

// A block of water that hits a plate of copper at 100 m/s.
TEST(ContactEnergy, WaterThatHitsMetalKeepsIt) {
  for (ShapeFunction const shape : {ShapeFunction::bspline, ShapeFunction::gimp}) {
    std::array<double, 2> drift{};
    for (int const parts : {0, 1}) {
      Problem p;
      double const h = 2e-3;
      p.box(Geometry::planar2d, h, {70, 60, 1}, Boundary::outflow);
      p.options.shape = shape;
      p.options.linear_viscosity = 0.06;
      p.options.quadratic_viscosity = 1.5;
      material::Material liquid;
      liquid.name = "water";
      liquid.eos = material::StiffenedGas{4.4, 6e8};
      liquid.density = 1000.0;
      liquid.specific_energy = (101325.0 + 4.4 * 6e8) / (3.4 * 1000.0);
      int const water = p.add(liquid);
      int const plate = p.add(copper());
      if (parts == 1) p.contacts.push_back({water, plate, 0.0});
      p.book_work();
      p.start();
      p.fill(water, shape::Box{{0.02, 0.02, -1.0}, {0.06, 0.1, 1.0}}, [](Vec3 const&) {
        return Vec3{100.0, 0.0, 0.0};
      });
      p.fill(plate, shape::Box{{0.06, 0.01, -1.0}, {0.07, 0.11, 1.0}});
      double const moving = p.kinetic_energy();
      double const before = p.energy();
      while (p.mpm->time() < 1e-4) p.mpm->advance(p.mpm->stable_step());
      drift[parts] = (p.accounted() - before) / moving;
      std::printf("%s, %s: drift %.2g %%, %ld points left\n", word_of(shape), parts == 1 ? "parts" : "glued",
                  100.0 * drift[parts], p.mpm->accounts().losses.particles);
    }
    EXPECT_LT(std::abs(drift[1]), 1e-10);  // two gases of the same energies sum no better
  }
}

/// A disc of 16 cells per radius on ground that is level, under a gravity that is not.
struct Roller : Problem {
  static constexpr double radius = 16.0;
  static constexpr double gravity = 1.3e-4;
  static constexpr double way = 32.0;
  double slope = 0.0;
  double friction = 0.0;

  Roller(ShapeFunction shape, double degrees, double mu, bool rigid)
      : slope(degrees * std::numbers::pi / 180.0), friction(mu) {
    box(Geometry::planar2d, 1.0, {84, 42, 1}, Boundary::outflow);
    options.shape = shape;
    options.linear_viscosity = 0.06;
    options.quadratic_viscosity = 1.5;
    options.body_force = {gravity * std::sin(slope), -gravity * std::cos(slope), 0.0};
    int const ground = add(unit_solid(0.3));
    int const disc = add(unit_solid(0.3));
    if (rigid) bodies[ground].rigid_velocity = Vec3{0.0, 0.0, 0.0};
    contacts.push_back({ground, disc, mu});
    if (!rigid)
      constraints.push_back({shape::Box{{-1.0, -1.0, -1.0}, {85.0, 1.0, 1.0}}, {true, true, true}, {}, ground});
    book_work();
    start();
    fill(ground, shape::Box{{0.0, 0.0, -1.0}, {84.0, 4.0, 1.0}});
    fill(disc, shape::Cylinder{{20.0, 20.0, 0.0}, radius, 1.0, {0.0, 0.0, 1.0}});
  }
  [[nodiscard]] bool rolls() const { return std::tan(slope) <= 3.0 * friction; }
  [[nodiscard]] double acceleration() const {
    return rolls() ? 2.0 / 3.0 * gravity * std::sin(slope) : gravity * (std::sin(slope) - friction * std::cos(slope));
  }
  /// How fast the lowest point of the disc slides.
  double sliding() {
    auto const sums = mpm::sums(*mpm, 1);
    Vec3 const v = (1.0 / sums.mass) * sums.momentum;
    double spin = 0.0;
    double inertia = 0.0;
    for_each_particle(1, [&](mpm::ParticleSet const& set, int q) {
      Vec3 const r = position(set, q) - sums.centre;
      Vec3 const u = get(set, q, Field::velocity_x) - v;
      spin += set.field(Field::mass)[q] * (r[0] * u[1] - r[1] * u[0]);
      inertia += set.field(Field::mass)[q] * (r[0] * r[0] + r[1] * r[1]);
    });
    return v[0] + spin / inertia * radius;
  }
};

// A disc rolls down with 2/3 g sin(slope) where tan(slope) < 3 mu, and slides with g (sin - mu cos) where it is
// steeper. The heat of the friction is its force times the way that the surfaces slide.
TEST(ContactEnergy, DiscRollsAndSlipsDownASlope) {
  struct Way {
    ShapeFunction shape;
    double degrees;
    bool rigid;
  };
  for (auto const& [shape, degrees, rigid] :
       {Way{ShapeFunction::bspline, 45.0, true}, Way{ShapeFunction::bspline, 45.0, false},
        Way{ShapeFunction::gimp, 45.0, true}, Way{ShapeFunction::bspline, 60.0, true},
        Way{ShapeFunction::bspline, 60.0, false}}) {
    Roller roller(shape, degrees, 0.495, rigid);
    double const from = mpm::sums(*roller.mpm, 1).centre[0];
    double const mass = mpm::sums(*roller.mpm, 1).mass;
    double const time = std::sqrt(2.0 * Roller::way / roller.acceleration());
    double rubbed = 0.0;
    double speed = 0.0;
    for (int part = 0; part < 100; ++part) {
      double const slid = roller.sliding();
      roller.run(time / 100.0, 0.35);
      // What gravity gives along the slope and the disc has not got is the impulse of the friction.
      double const faster = mpm::sums(*roller.mpm, 1).momentum[0] / mass - speed;
      speed += faster;
      double const impulse = mass * (Roller::gravity * std::sin(roller.slope) * time / 100.0 - faster);
      rubbed += 0.5 * (slid + roller.sliding()) * impulse;
    }
    double const way = (mpm::sums(*roller.mpm, 1).centre[0] - from) / Roller::way;
    double const work = roller.mpm->accounts().outer_work;
    double const drift = roller.accounted() / work;
    double const heat = roller.mpm->accounts().dissipation.friction;
    std::printf(
        "%s, %s ground, %s: %.4f of the way; drift %.2e of the work, friction took %.3f of it (its impulse times "
        "the slip %.3f)\n",
        word_of(shape), rigid ? "rigid" : "elastic", roller.rolls() ? "rolls" : "slips", way, drift, heat / work,
        rubbed / work);
    EXPECT_NEAR(way, 1.0, 0.03);
    // Gravity works over a step at the new velocity, the balance at the mean of both.
    EXPECT_LT(std::abs(drift), 0.001);
    EXPECT_GT(heat, 0.0);
    // Where it rolls too some: the surfaces shear within a cell of each other.
    if (roller.rolls()) {
      EXPECT_LT(heat / work, 0.04);
    } else {
      // The disc's lowest point slides a little faster than the nodes around it.
      EXPECT_NEAR(heat / rubbed, 1.0, 0.06);
    }
  }
}

// Bodies that are pressed on held nodes, at rest and in motion, by others and by a rigid body in motion: nodes are held
// where the surfaces meet. What is held has no energy of its own to give, the other loses none by that.
TEST(ContactEnergy, IsKeptWhereConstraintsHoldTheNodesThatMeet) {
  for (Transfer const transfer : {Transfer::flip, Transfer::apic}) {
    for (ShapeFunction const shape : {ShapeFunction::bspline, ShapeFunction::gimp}) {
      for (auto const& [rigid, v] : {std::pair{false, 0.0}, std::pair{false, 0.004}, std::pair{true, 0.004}}) {
        Problem p;
        p.box(Geometry::planar2d, 1.0, {20, 20, 1}, Boundary::outflow);
        p.options.block_cells = 8;
        p.options.shape = shape;
        p.options.transfer = transfer;
        p.constraints.push_back(
            {shape::Box{{-1.0, -1.0, -1.0}, {21.0, 3.0, 1.0}}, {true, true, false}, {v, v, 0.0}, 0});
        p.add(unit_solid(0.3));
        p.add(unit_solid(0.3));
        if (rigid) p.bodies[1].rigid_velocity = Vec3{0.01, -0.02, 0.0};
        p.contacts.push_back({0, 1, 0.3});
        p.book_work();
        p.start();
        Vec3 const held{v, v, 0.0};
        p.fill_lattice(0, {2.0, 1.5, 0.0}, {28, rigid ? 12 : 4, 1}, 0.5, held);
        p.fill_lattice(1, {4.0, rigid ? 7.6 : 3.6, 0.0}, {20, 12, 1}, 0.5, {0.01, -0.02, 0.0});
        double const before = p.energy();
        p.run(60.0, 0.1);
        mpm::Dissipation const& d = p.mpm->accounts().dissipation;
        double const moved = rigid ? p.mpm->accounts().outer_work : before;
        double const drift = (p.accounted() - before) / moved;
        std::printf("%s, %s, %s, held at %g: drift %.2g %%, held %.2f %%, apic %.2f %%, friction %.2f %%, work %.3g\n",
                    word_of(shape), word_of(transfer), rigid ? "rigid" : "elastic", v, 100.0 * drift,
                    100.0 * d.constraints / moved, 100.0 * d.apic / moved, 100.0 * d.friction / moved,
                    p.mpm->accounts().outer_work);
        EXPECT_GT(moved, 0.0);
        // What is heavier than round-off of masses has a velocity: nodes that a crushed body hardly reaches count for
        // little with APIC, but not for nothing.
        EXPECT_LT(std::abs(drift), rigid && transfer == Transfer::apic ? 1e-4 : 1e-11);
      }
    }
  }
}

// A body lies on a wall that rubs, and another one hits it, or a rigid body presses it on the wall: it has no energy
// but what waves, wall and friction have. Where it is thinner than the nodes reach, contact and wall stop the same
// nodes one after the other, and the account is not exact.
TEST(ContactEnergy, IsKeptBetweenAWallAndABody) {
  for (int const cells : {4, 2}) {
    for (ShapeFunction const shape : {ShapeFunction::bspline, ShapeFunction::gimp}) {
      for (StressOrder const order : {StressOrder::musl, StressOrder::usf}) {
        for (bool const rigid : {false, true}) {
          Problem p;
          p.box(Geometry::planar2d, 1.0, {16, 16, 1}, Boundary::outflow);
          p.domain.boundary[2] = Boundary::wall;
          p.options.shape = shape;
          p.options.order = order;
          p.options.wall_friction = 0.2;
          p.add(unit_solid(0.3));
          p.add(unit_solid(0.3));
          Vec3 const coming{0.005, -0.02, 0.0};
          if (rigid) p.bodies[1].rigid_velocity = coming;
          p.contacts.push_back({0, 1, 0.2});
          p.book_work();
          p.start();
          p.fill_lattice(0, {3.0, 0.0, 0.0}, {20, 2 * cells, 1}, 0.5, {0.0, 0.0, 0.0});
          p.fill_lattice(1, {4.0, cells + 0.2, 0.0}, {14, 12, 1}, 0.5, coming);
          double const before = p.energy();
          p.run(rigid ? 20.0 : 60.0, 0.08);
          mpm::Dissipation const& d = p.mpm->accounts().dissipation;
          double const moved = rigid ? p.mpm->accounts().outer_work : before;
          double const drift = (p.accounted() - before) / moved;
          std::printf("%d cells, %s, %s, %s: drift %.2g %%, held %.2f %%, friction %.2f %%\n", cells, word_of(shape),
                      word_of(order), rigid ? "pressed" : "hit", 100.0 * drift, 100.0 * d.constraints / moved,
                      100.0 * d.friction / moved);
          EXPECT_GT(moved, 0.0);
          // Where the stress is updated first, what walls stop is guessed beforehand: 3e-7 was measured, else 1e-15.
          double const thick = order == StressOrder::usf ? 1e-6 : 1e-11;
          double const thin = rigid ? 0.06 : 0.005;  // 4.6 % and 0.3 % were measured
          EXPECT_LT(std::abs(drift), cells == 4 ? thick : thin);
        }
      }
    }
  }
}

// A rigid piston stands on a wall and pushes a body along it: fields of bodies have no images behind the wall, and what
// the piston gives them counts whole at the nodes on it and behind it.
TEST(ContactEnergy, PistonOnAWallGivesWhatTheBodyGets) {
  for (ShapeFunction const shape : {ShapeFunction::bspline, ShapeFunction::gimp, ShapeFunction::linear}) {
    for (Boundary const ground : {Boundary::wall, Boundary::symmetry}) {
      Problem p;
      p.box(Geometry::planar2d, 1.0, {20, 8, 1}, Boundary::outflow);
      p.domain.boundary[2] = ground;
      p.options.shape = shape;
      int const piston = p.add(unit_solid(0.3));
      int const body = p.add(unit_solid(0.3));
      double const v = 0.02;
      p.bodies[piston].rigid_velocity = Vec3{v, 0.0, 0.0};
      p.contacts.push_back({piston, body, 0.2});
      p.book_work();
      p.start();
      p.fill_lattice(piston, {2.0, 0.0, 0.0}, {4, 6, 1}, 0.5, {v, 0.0, 0.0});
      p.fill_lattice(body, {4.1, 0.0, 0.0}, {10, 6, 1}, 0.5, {0.0, 0.0, 0.0});
      double const before = p.energy();
      p.run(60.0, 0.1);
      double const got = mpm::sums(*p.mpm, body).momentum[0];
      double const work = p.mpm->accounts().outer_work;
      double const drift = (p.accounted() - before) / work;
      std::printf("%s: momentum wrong by %.1e; drift %.2g %% of the work\n", word_of(shape),
                  p.mpm->accounts().constraint_impulse[0] / got - 1.0, 100.0 * drift);
      EXPECT_GT(got, 15.0 * v);  // 15 m2 of body
      EXPECT_NEAR(p.mpm->accounts().constraint_impulse[0] / got, 1.0, 1e-9);
      EXPECT_NEAR(work / (got * v), 1.0, 1e-9);
      EXPECT_LT(std::abs(drift), 1e-11);
    }
  }
}

}  // namespace
}  // namespace brisance::test
