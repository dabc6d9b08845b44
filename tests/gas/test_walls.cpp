// Shocks that are reflected from rigid surfaces: the largest pressure that is recorded there against the exact plateau,
// in every geometry, at walls of the domain and at obstacles, for strong and weak shocks and any step.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "gas/harness.hpp"

namespace brisance::test {
namespace {

constexpr double g = 1.4;
constexpr double p0 = 101325.0;
constexpr double rho0 = 1.225;

struct Shock {
  double p, rho, u, speed, reflected;

  explicit Shock(double mach) {
    double const c = std::sqrt(g * p0 / rho0);
    p = p0 * (1.0 + 2.0 * g / (g + 1.0) * (mach * mach - 1.0));
    rho = rho0 * (g + 1.0) * mach * mach / ((g - 1.0) * mach * mach + 2.0);
    speed = mach * c;
    u = speed * (1.0 - rho0 / rho);
    reflected = p * ((3.0 * g - 1.0) * p - (g - 1.0) * p0) / ((g - 1.0) * p + (g + 1.0) * p0);
  }
};

/// Overshoot of the recorded overpressure over the plateau, and how far the last record is from it.
struct Reading {
  double over = 0.0;
  double last = 0.0;
};

enum class Surface { wall, symmetry, obstacle };

/// A plane shock runs along `direction`, towards its high end or its low one, from the middle to a rigid surface.
Reading reflect(double mach, double courant, grid::Geometry geometry, int direction, bool towards_high, Surface surface,
                int block_cells) {
  constexpr int n = 100;
  constexpr int obstacle = 10;  // cells
  Shock const shock(mach);
  Problem problem;
  problem.courant = courant;
  problem.block_cells = block_cells;
  problem.domain.geometry = geometry;
  problem.domain.h = 1.0 / n;
  for (int d = 0; d < problem.domain.dimensions(); ++d) problem.domain.cells[d] = d == direction ? n : 4;
  problem.domain.boundary.fill(grid::Boundary::periodic);
  if (geometry == grid::Geometry::axisymmetric2d) {
    problem.domain.boundary[0] = problem.domain.boundary[1] = grid::Boundary::symmetry;
  }
  int const end = 2 * direction + (towards_high ? 1 : 0);
  problem.domain.boundary[end] = surface == Surface::wall ? grid::Boundary::wall : grid::Boundary::symmetry;
  problem.domain.boundary[end ^ 1] = grid::Boundary::inflow;
  double const sign = towards_high ? 1.0 : -1.0;
  Mixed behind = state(shock.rho, 0.0, shock.p);
  behind.velocity[direction] = sign * shock.u;
  problem.inflow.fill(behind);
  problem.quiescent = state(rho0, 0.0, p0);
  problem.fill([&](Vec3 const& x) {
    double const s = towards_high ? x[direction] : 1.0 - x[direction];
    return s < 0.5 ? behind : problem.quiescent;
  });
  int const thick = surface == Surface::obstacle ? obstacle : 0;
  if (thick > 0) {
    place_obstacle(problem, [&](Index3 const& cell) {
      int const s = towards_high ? cell[direction] : n - 1 - cell[direction];
      return s >= n - thick;
    });
    problem.gas->start();
  }
  Index3 cell{1, 1, 1};
  for (int d = problem.domain.dimensions(); d < 3; ++d) cell[d] = 0;
  cell[direction] = towards_high ? n - 1 - thick : thick;
  double const way = 0.5 - thick / static_cast<double>(n);
  double const arrival = way / shock.speed;
  // Until the reflected shock is half of the way back.
  double const back = (shock.reflected - shock.p) / (shock.rho * shock.u) - shock.u;
  double const last_time = arrival + 0.5 * way / back;
  Reading reading;
  while (problem.gas->time() < last_time) {
    double const ramp = std::min(1.0, 0.1 * static_cast<double>(problem.steps + 1));
    problem.gas->advance(ramp * courant * problem.domain.h / problem.gas->fastest_signal(), problem.steps % 2 == 1);
    ++problem.steps;
    double const over = (problem.at(cell).pressure - p0) / (shock.reflected - p0) - 1.0;
    reading.over = std::max(reading.over, over);
    reading.last = over;
  }
  return reading;
}

// 2 % is what may be asked of a recorded peak; 7 to 22 % came out with full slopes at the wall. The plateau itself is
// reached within 0.1 %, but at Mach 1.5, where the wave that left the start is still under way.
constexpr double most_over = 0.02;
constexpr double plateau = 0.01;

TEST(ReflectedShock, LeavesNoSpikeAtAWall) {
  for (double const mach : {1.5, 3.0, 10.0, 30.0}) {
    for (double const courant : {0.2, 0.4, 0.8}) {
      Reading const r = reflect(mach, courant, grid::Geometry::planar1d, 0, true, Surface::wall, 0);
      std::printf("Mach %4.1f, Courant %.1f: peak %+.2f %%, plateau %+.3f %%\n", mach, courant, 100.0 * r.over,
                  100.0 * r.last);
      EXPECT_LT(r.over, most_over) << mach << " " << courant;
      EXPECT_NEAR(r.last, 0.0, plateau) << mach << " " << courant;
    }
  }
}

TEST(ReflectedShock, LeavesNoneInAnyDimensionOrDirection) {
  using grid::Geometry;
  struct Way {
    Geometry geometry;
    int direction;
  };
  for (Way const way : {Way{Geometry::planar1d, 0}, Way{Geometry::planar2d, 0}, Way{Geometry::planar2d, 1},
                        Way{Geometry::axisymmetric2d, 1}, Way{Geometry::cartesian3d, 0}, Way{Geometry::cartesian3d, 1},
                        Way{Geometry::cartesian3d, 2}}) {
    for (bool const high : {true, false}) {
      for (Surface const surface : {Surface::symmetry, Surface::obstacle}) {
        Reading const r = reflect(3.0, 0.8, way.geometry, way.direction, high, surface, 0);
        EXPECT_LT(r.over, most_over) << word_of(way.geometry) << " along " << way.direction << " high " << high
                                     << " surface " << static_cast<int>(surface);
        EXPECT_NEAR(r.last, 0.0, plateau);
      }
    }
  }
}

TEST(ReflectedShock, LeavesNoneAtObstaclesWhateverTheShockAndTheStep) {
  for (double const mach : {1.5, 10.0, 30.0}) {
    for (double const courant : {0.2, 0.8}) {
      Reading const r = reflect(mach, courant, grid::Geometry::planar2d, 0, true, Surface::obstacle, 0);
      EXPECT_LT(r.over, most_over) << mach << " " << courant;
    }
  }
}

/// Pressure behind an oblique shock of angle `wave` in a stream of Mach number `mach` over that before it, and how far
/// it turns the stream.
double oblique_ratio(double mach, double wave) {
  double const normal = mach * std::sin(wave);
  return 1.0 + 2.0 * g / (g + 1.0) * (normal * normal - 1.0);
}
double turned(double mach, double wave) {
  double const normal = mach * std::sin(wave);
  return std::atan(2.0 / std::tan(wave) * (normal * normal - 1.0) / (mach * mach * (g + std::cos(2.0 * wave)) + 2.0));
}

/// Pressure at the foot of a shock whose front makes an angle with a rigid plane: two-shock theory of regular
/// reflection [Neumann43], the weaker of its solutions.
double behind_the_foot(double mach, double angle) {
  double const before = mach / std::sin(angle);  // of the stream that the foot meets
  double const theta = turned(before, angle);
  double const normal = mach;
  double const normal_behind =
      std::sqrt((1.0 + 0.5 * (g - 1.0) * normal * normal) / (g * normal * normal - 0.5 * (g - 1.0)));
  double const behind = normal_behind / std::sin(angle - theta);
  double low = std::asin(1.0 / behind);
  double high = low;
  while (turned(behind, high) < theta && high < 1.57) high += 1e-4;
  EXPECT_LT(high, 1.57) << "there is no regular reflection";
  for (int n = 0; n < 60; ++n) {
    double const middle = 0.5 * (low + high);
    (turned(behind, middle) < theta ? low : high) = middle;
  }
  return p0 * oblique_ratio(before, angle) * oblique_ratio(behind, high);
}

/// Largest excess of the overpressure that cells at the wall record, while the foot of the shock runs along it, over
/// that of theory, and the excess behind it.
Reading foot(double mach, double angle, double courant, int cells) {
  Shock const shock(mach);
  Problem problem;
  problem.courant = courant;
  problem.domain.geometry = grid::Geometry::planar2d;
  problem.domain.h = 1.0 / cells;
  problem.domain.cells = {3 * cells, cells, 1};
  problem.domain.boundary.fill(grid::Boundary::zero_gradient);
  problem.domain.boundary[2] = grid::Boundary::wall;
  Mixed behind = state(shock.rho, 0.0, shock.p);
  behind.velocity = {shock.u * std::sin(angle), -shock.u * std::cos(angle), 0.0};
  problem.quiescent = state(rho0, 0.0, p0);
  constexpr double start = 0.2;
  problem.fill([&](Vec3 const& x) {
    return (x[0] - start) * std::sin(angle) - x[1] * std::cos(angle) < 0.0 ? behind : problem.quiescent;
  });
  double const expected = behind_the_foot(mach, angle) - p0;
  double const speed = shock.speed / std::sin(angle);
  Reading reading;
  while (problem.gas->time() < 1.2 / speed) {
    double const ramp = std::min(1.0, 0.1 * static_cast<double>(problem.steps + 1));
    problem.gas->advance(ramp * courant * problem.domain.h / problem.gas->fastest_signal(), problem.steps % 2 == 1);
    ++problem.steps;
    for (int i = 0; i < problem.domain.cells[0]; ++i) {
      double const x = (i + 0.5) * problem.domain.h;
      if (x < 0.8 || x > 1.3) continue;
      double const over = (problem.at({i, 0, 0}).pressure - p0) / expected - 1.0;
      reading.over = std::max(reading.over, over);
      if (i == cells) reading.last = over;
    }
  }
  return reading;
}

TEST(ReflectedShock, LeavesNoSpikeAtTheFootOfAnObliqueOne) {
  for (double const mach : {1.5, 3.0, 10.0}) {
    for (double const degrees : {15.0, 30.0}) {
      for (double const courant : {0.2, 0.8}) {
        Reading const r = foot(mach, degrees * std::acos(-1.0) / 180.0, courant, 64);
        std::printf("Mach %4.1f, %2.0f degrees, Courant %.1f: peak %+.2f %%, behind %+.3f %%\n", mach, degrees, courant,
                    100.0 * r.over, 100.0 * r.last);
        EXPECT_LT(r.over, most_over) << mach << " " << courant;
      }
    }
  }
}

// Blocks so small that the surface lies in another one than half of the cells near it. A block's size decides which
// cells a vector holds and with that the last digits, no more.
TEST(ReflectedShock, DoesNotDependOnTheBlocks) {
  constexpr double round_off = 1e-10;
  for (Surface const surface : {Surface::wall, Surface::obstacle}) {
    Reading const whole = reflect(3.0, 0.8, grid::Geometry::planar2d, 0, true, surface, 200);
    Reading const cut = reflect(3.0, 0.8, grid::Geometry::planar2d, 0, true, surface, 4);
    EXPECT_NEAR(whole.over, cut.over, round_off);
    EXPECT_NEAR(whole.last, cut.last, round_off);
  }
}

}  // namespace
}  // namespace brisance::test
