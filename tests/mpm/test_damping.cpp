// Damping of bodies that settle: the closed forms of free flight, of an oscillator and of a column under its weight,
// and where the energy goes.
#include <numbers>

#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;
using std::numbers::pi;

constexpr std::array all_transfers{Transfer::flip, Transfer::apic, Transfer::xpic};

double kinetic(Problem const& p) { return mpm::sums(*p.mpm, 0).kinetic_energy; }
double whole(Problem const& p) {
  mpm::BodySums const s = mpm::sums(*p.mpm, 0);
  return s.kinetic_energy + s.internal_energy - s.provisional_energy;
}

// Nothing acts but the damping: the velocity falls as exp(-a t), the kinetic energy twice as fast, and what is missing
// is booked.
TEST(Damping, OfFreeFlightIsExponential) {
  constexpr double rate = 2.0;
  for (Transfer const transfer : all_transfers) {
    for (double const end : {0.4, 10.0}) {
      Problem p;
      p.box(Geometry::planar2d, 0.1, {20, 20, 1}, Boundary::periodic);
      p.options.transfer = transfer;
      p.options.block_cells = 4;
      p.options.damping = rate;
      p.options.damping_end = end;
      p.add(unit_solid(0.3));
      p.bodies[0].damped = true;
      p.start();
      p.fill_lattice(0, {0.5, 0.5, 0.0}, {10, 10, 1}, 0.05, {0.3, -0.2, 0.0});
      double const before = kinetic(p);
      p.run(1.0, 0.03);
      double const exact = std::exp(-2.0 * rate * std::min(end, p.mpm->time()));
      EXPECT_NEAR(kinetic(p) / before, exact, 1e-12) << word_of(transfer);
      EXPECT_NEAR(p.mpm->accounts().dissipation.damping / before, 1.0 - exact, 1e-12) << word_of(transfer);
    }
  }
}

TEST(Damping, LeavesOthersAlone) {
  Problem p;
  p.box(Geometry::planar1d, 0.1, {20, 1, 1}, Boundary::periodic);
  p.options.damping = 5.0;
  p.add(unit_solid(0.0));
  p.start();
  p.fill_lattice(0, {0.5, 0.0, 0.0}, {10, 1, 1}, 0.05, {0.3, 0.0, 0.0});
  double const before = kinetic(p);
  p.run(1.0, 0.03);
  EXPECT_NEAR(kinetic(p) / before, 1.0, 1e-13);
  EXPECT_EQ(p.mpm->accounts().dissipation.damping, 0.0);
}

// The lowest mode of a bar of length 1 between a mirror and a free end: u'' + a u' + w^2 u = 0 with w = pi c/2. Its
// energy falls as exp(-a t) in the mean over a period, up to (a/2w)^2.
TEST(Damping, OfAnOscillatorFollowsItsClosedForm) {
  constexpr double rate = 0.1;
  for (Transfer const transfer : all_transfers) {
    for (bool const books : {false, true}) {
      Problem p;
      p.box(Geometry::planar1d, 0.05, {30, 1, 1}, Boundary::symmetry);
      p.options.transfer = transfer;
      p.options.damping = rate;
      p.add(unit_solid(0.0));
      p.bodies[0].damped = true;
      p.bodies[0].books_work = books || transfer == Transfer::apic;
      p.start();
      p.fill(0, shape::Box{{0.0, -1.0, -1.0}, {1.0, 1.0, 1.0}}, [](Vec3 const& x) {
        return Vec3{1e-3 * std::sin(0.5 * pi * x[0]), 0.0, 0.0};
      });
      double const before = whole(p);
      double const period = 4.0;
      p.run(3.0 * period, 0.01);
      double const left = whole(p) / before;
      auto const& lost = p.mpm->accounts().dissipation;
      std::printf("%s%s: energy %.4f, closed form %.4f; damping %.4f, transfer %.1e, balance %.1e\n", word_of(transfer),
                  books ? ", books work" : "", left, std::exp(-rate * 3.0 * period), lost.damping / before,
                  (lost.filtered + lost.apic) / before, left + lost.sum() / before - 1.0);
      // What APIC and XPIC take beside it is counted, and not the damping's.
      EXPECT_NEAR(left + (lost.filtered + lost.apic) / before, std::exp(-rate * 3.0 * period), 0.01);
      EXPECT_NEAR(left + lost.sum() / before, 1.0, 1e-3);
    }
  }
}

// A column under its weight comes to rest with the sag rho g L^2/(2 M), M the modulus of pressure waves.
TEST(Damping, LetsAColumnSettle) {
  constexpr double g = 1e-3;
  Problem p;
  p.box(Geometry::planar1d, 0.05, {30, 1, 1}, Boundary::symmetry);
  p.options.body_force = {-g, 0.0, 0.0};
  p.options.damping = 3.0;  // twice the lowest frequency of the column: nearly aperiodic
  material::Material const solid = unit_solid(0.25);
  p.add(solid);
  p.bodies[0].damped = true;
  p.start();
  p.fill(0, shape::Box{{0.0, -1.0, -1.0}, {1.0, 1.0, 1.0}});
  p.run(20.0, 0.01);
  double const modulus = solid.density * std::pow(pressure_wave_speed(solid), 2);
  double sag = 0.0;
  double fastest = 0.0;
  p.for_each_particle(0, [&](mpm::ParticleSet const& set, int q) {
    sag = std::max(sag, Problem::origin(set, q)[0] - Problem::position(set, q)[0]);
    fastest = std::max(fastest, std::abs(set.field(Field::velocity_x)[q]));
  });
  std::printf("sag %.4e, closed form %.4e; fastest %.1e\n", sag, g / (2.0 * modulus), fastest);
  EXPECT_NEAR(sag / (g / (2.0 * modulus)), 1.0, 0.02);
  EXPECT_LT(fastest, 1e-3 * g / modulus * pressure_wave_speed(solid));
}

TEST(Damping, IsBookedTheSameForAnyNumberOfThreads) {
  auto const taken = [](int threads) {
    Problem p;
    p.box(Geometry::planar2d, 0.1, {20, 20, 1}, Boundary::periodic);
    p.options.block_cells = 4;
    p.options.damping = 1.0;
    p.add(unit_solid(0.3));
    p.bodies[0].damped = true;
    p.start();
    p.fill(0, shape::Box{{0.2, 0.2, -1.0}, {1.7, 1.8, 1.0}}, [](Vec3 const& x) {
      return Vec3{0.1 * std::sin(x[1]), 0.1 * x[0], 0.0};
    });
    set_threads(threads);
    p.run(0.3, 0.03);
    set_threads(1);
    return p.mpm->accounts().dissipation.damping;
  };
  EXPECT_EQ(taken(1), taken(4));
}

}  // namespace
}  // namespace brisance::test
