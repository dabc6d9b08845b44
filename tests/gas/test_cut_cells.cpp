/// Cut cells: uniform gas around bodies of any shape, conservation, and shocks on inclined walls against exact theory.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>

#include "core/parallel.hpp"
#include "gas/harness.hpp"
#include "gas/place_obstacles.hpp"

namespace brisance::test {
namespace {

constexpr double g = 1.4;
constexpr double p0 = 101325.0;
constexpr double rho0 = 1.225;
constexpr double degree = std::numbers::pi / 180.0;

using shape::Shape;

void place(Problem& problem, std::vector<Shape> const& bodies) {
  gas::place_obstacles(*problem.gas, shape::cut_cells(bodies, problem.domain), problem.quiescent);
  problem.gas->start();
}

/// All that lies below a line through a point that rises by an angle.
Shape ground(double x, double y, double angle) {
  return shape::HalfSpace{{x, y, 0.0}, {std::sin(angle), -std::cos(angle), 0.0}};
}

/// A box turned around its middle.
Shape turned_box(Vec3 const& middle, Vec3 const& half, Vec3 const& axis, double angle) {
  return shape::moved(shape::Box{middle - half, middle + half},
                      shape::turn_around((1.0 / norm(axis)) * axis, angle, middle));
}

std::vector<Shape> bodies(grid::Geometry geometry) {
  switch (geometry) {
    case grid::Geometry::axisymmetric2d:
      return {shape::Sphere{{0.0, 0.4, 0.0}, 0.21}, shape::Box{{0.63, 0.37, 0.0}, {0.81, 0.52, 0.0}},
              turned_box({0.5, 0.8, 0.0}, {0.1, 0.02, 1.0}, {0.0, 0.0, 1.0}, 20.0 * degree)};
    case grid::Geometry::planar2d:
      return {shape::Cylinder{{0.3, 0.4, 0.0}, 0.17, 1.0, {0.0, 0.0, 1.0}},
              turned_box({0.7, 0.6, 0.0}, {0.15, 0.07, 1.0}, {0.0, 0.0, 1.0}, 33.0 * degree), ground(0.0, 0.1, 0.1)};
    default:
      return {shape::Sphere{{0.31, 0.42, 0.33}, 0.17},
              turned_box({0.7, 0.6, 0.6}, {0.15, 0.1, 0.2}, {1.0, 2.0, 3.0}, 33.0 * degree)};
  }
}

int cells_across(grid::Geometry geometry) { return geometry == grid::Geometry::cartesian3d ? 24 : 48; }

constexpr std::array geometries{grid::Geometry::planar2d, grid::Geometry::axisymmetric2d, grid::Geometry::cartesian3d};

Problem room(grid::Geometry geometry) {
  Problem problem;
  problem.box(geometry, cells_across(geometry), 1.0, grid::Boundary::wall);
  if (geometry == grid::Geometry::axisymmetric2d) problem.domain.boundary[0] = grid::Boundary::symmetry;
  problem.quiescent = state(rho0, 0.0, p0);
  return problem;
}

double open_total(Problem const& problem, int component) {
  long double sum = 0.0;
  for (grid::Block const& block : problem.grid->blocks()) {
    grid::for_each_cell(block, [&](grid::Cell const& cell) {
      if (problem.gas->obstacles.contain(cell)) return;
      sum += problem.gas->fields().at(cell.block, component)[cell.offset] * problem.gas->cut.volume(cell);
    });
  }
  return static_cast<double>(sum);
}

TEST(CutCells, LeaveGasAtRest) {
  for (grid::Geometry const geometry : geometries) {
    Problem problem = room(geometry);
    // Not the quiescent gas, which would not be swept.
    problem.fill([](Vec3 const&) { return state(2.0, 0.0, 3.0 * p0); });
    place(problem, bodies(geometry));
    ASSERT_GT(problem.gas->cut.cells().size(), 50U);
    ASSERT_GT(problem.gas->cut.mergers().size(), 10U);
    for (int step = 0; step < 200; ++step)
      problem.gas->advance(0.8 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
    double fastest = 0.0;
    double pressure = 0.0;
    problem.for_each_cell([&](int, int, Index3 const& cell) {
      if (problem.gas->obstacles.contain(0, cell)) return;
      auto const w = problem.at(cell);
      fastest = std::max(fastest, norm(w.velocity) / w.sound_speed);
      pressure = std::max(pressure, std::abs(w.pressure / (3.0 * p0) - 1.0));
    });
    std::printf("%s: Mach number %.1e, pressure %.1e, %zu cut cells\n", std::string(word_of(geometry)).c_str(), fastest,
                pressure, problem.gas->cut.cells().size());
    // Round-off of 200 steps.
    EXPECT_LT(fastest, 1e-12);
    EXPECT_LT(pressure, 1e-12);
  }
}

TEST(CutCells, OfAClosedBodyFeelNoForceInUniformPressure) {
  for (grid::Geometry const geometry : geometries) {
    Problem problem = room(geometry);
    problem.fill([](Vec3 const&) { return state(rho0, 0.0, p0); });
    place(problem, {bodies(geometry)[geometry == grid::Geometry::axisymmetric2d ? 2 : 1]});
    Vec3 sum{0.0, 0.0, 0.0};
    double all = 0.0;
    for (gas::CutCell const& cut : problem.gas->cut.cells()) {
      sum = sum + cut.wall;
      all += norm(cut.wall);
    }
    int const first = geometry == grid::Geometry::axisymmetric2d ? 1 : 0;
    for (int d = first; d < problem.domain.dimensions(); ++d) EXPECT_NEAR(sum[d], 0.0, 1e-13 * all) << d;
    // What is left of the room is what the body does not fill.
    Shape const body = bodies(geometry)[geometry == grid::Geometry::axisymmetric2d ? 2 : 1];
    double volume = 0.0;
    double whole = 0.0;
    for (grid::Block const& block : problem.grid->blocks()) {
      grid::for_each_cell(block, [&](grid::Cell const& cell) {
        whole += block.volume(cell);
        if (!problem.gas->obstacles.contain(cell)) volume += problem.gas->cut.volume(cell);
      });
    }
    double const filled = shape::volume(body, geometry);
    EXPECT_NEAR(whole - volume, filled, 0.01 * filled);
  }
}

TEST(CutCells, LeaveAStreamAlongAWallUniform) {
  for (double const angle : {10.0, 30.0, 45.0}) {
    for (double const mach : {0.5, 3.0}) {
      Problem problem;
      problem.box(grid::Geometry::planar2d, 60, 1.0, grid::Boundary::zero_gradient);
      double const u = mach * std::sqrt(g * p0 / rho0);
      Mixed wind = state(rho0, 0.0, p0);
      wind.velocity = {u * std::cos(angle * degree), u * std::sin(angle * degree), 0.0};
      problem.quiescent = state(rho0, 0.0, p0);
      problem.fill([&](Vec3 const&) { return wind; });
      place(problem, {ground(0.02, 0.1, angle * degree)});
      for (int step = 0; step < 200; ++step)
        problem.gas->advance(0.8 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
      double velocity = 0.0;
      double pressure = 0.0;
      problem.for_each_cell([&](int, int, Index3 const& cell) {
        if (problem.gas->obstacles.contain(0, cell)) return;
        auto const w = problem.at(cell);
        velocity = std::max(velocity, norm(w.velocity - wind.velocity) / u);
        pressure = std::max(pressure, std::abs(w.pressure / p0 - 1.0));
      });
      std::printf("wall at %.0f degrees, Mach %.1f: velocity %.1e, pressure %.1e\n", angle, mach, velocity, pressure);
      // Asked: 1 %. A state that is uniform stays so to round-off.
      EXPECT_LT(velocity, 1e-9);
      EXPECT_LT(pressure, 1e-9);
    }
  }
}

TEST(CutCells, KeepMassAndEnergyOfTwoFluids) {
  for (grid::Geometry const geometry : geometries) {
    Problem problem = room(geometry);
    problem.fluids.count = 2;
    problem.fluids.eos[1] = material::IdealGas{1.3};
    problem.fill([&](Vec3 const& x) {
      Mixed s = state(rho0, 0.0, p0);
      Vec3 const centre{geometry == grid::Geometry::axisymmetric2d ? 0.0 : 0.6, 0.75,
                        geometry == grid::Geometry::cartesian3d ? 0.25 : 0.0};
      Vec3 r = x - centre;
      for (int d = problem.domain.dimensions(); d < 3; ++d) r[d] = 0.0;
      if (norm(r) < 0.12) {
        s.products_density = 100.0;
        s.volume_fraction = 1.0;
        s.pressure = 3000.0 * p0;
      }
      return s;
    });
    place(problem, bodies(geometry));
    std::array<double, 3> before{};
    constexpr std::array kept{gas::partial_density(0), gas::partial_density(1), gas::energy};
    for (int n = 0; n < 3; ++n) before[n] = open_total(problem, kept[n]);
    int const steps = geometry == grid::Geometry::cartesian3d ? 150 : 400;
    for (int step = 0; step < steps; ++step)
      problem.gas->advance(std::min(1.0, 0.1 * (step + 1)) * 0.8 * problem.domain.h / problem.gas->fastest_signal(),
                           step % 2 == 1);
    for (int n = 0; n < 3; ++n) {
      double const now = open_total(problem, kept[n]);
      std::printf("%s: component %d changes by %.1e\n", std::string(word_of(geometry)).c_str(), kept[n],
                  now / before[n] - 1.0);
      EXPECT_NEAR(now / before[n], 1.0, 1e-12);
    }
    EXPECT_EQ(problem.gas->account().guarded_cells, 0);
    std::printf("   faces or cells limited: %ld\n", problem.gas->account().fallback_faces);
  }
}

/// Flow of a stream through an oblique shock and its regular reflection from a plane: two-shock theory [Neumann43].
struct Oblique {
  double p, rho, mach, turn;

  /// Behind a shock that makes an angle with a stream.
  static Oblique behind(Oblique const& before, double wave) {
    double const n = before.mach * std::sin(wave);
    Oblique b{};
    b.p = before.p * (1.0 + 2.0 * g / (g + 1.0) * (n * n - 1.0));
    b.rho = before.rho * (g + 1.0) * n * n / ((g - 1.0) * n * n + 2.0);
    b.turn = std::atan(2.0 / std::tan(wave) * (n * n - 1.0) /
                       (before.mach * before.mach * (g + std::cos(2.0 * wave)) + 2.0));
    double const normal = std::sqrt((1.0 + 0.5 * (g - 1.0) * n * n) / (g * n * n - 0.5 * (g - 1.0)));
    b.mach = normal / std::sin(wave - b.turn);
    return b;
  }
  /// The weaker shock that turns the stream by an angle.
  [[nodiscard]] double wave_that_turns(double angle) const {
    double low = std::asin(1.0 / mach);
    double high = low;
    while (behind(*this, high).turn < angle && high < 1.57) high += 1e-4;
    EXPECT_LT(high, 1.57) << "there is no regular reflection";
    for (int n = 0; n < 60; ++n) {
      double const middle = 0.5 * (low + high);
      (behind(*this, middle).turn < angle ? low : high) = middle;
    }
    return high;
  }
  [[nodiscard]] double speed() const { return mach * std::sqrt(g * p / rho); }
};

/// Along and above a wall.
struct AtWall {
  double along, above;
};

/// Least, largest and mean of values.
struct Spread {
  double least = 1e300;
  double most = 0.0;
  double sum = 0.0;
  int count = 0;

  void add(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
    sum += value;
    ++count;
  }
  [[nodiscard]] double mean() const { return sum / count; }
};

/// The steady reflection of a shock of 29 degrees in a stream of Mach 2.9 [Yee85] from a wall that is turned
/// against the grid: the pressure along the wall behind the foot.
struct Steady {
  Spread found;
  double expected = 0.0;
};

Steady steady_reflection(double wall_angle, double height, int cells) {
  Oblique const free{p0, rho0, 2.9, 0.0};
  Oblique const second = Oblique::behind(free, 29.0 * degree);
  double const reflected_wave = second.wave_that_turns(second.turn);
  Oblique const third = Oblique::behind(second, reflected_wave);
  double const c = std::cos(wall_angle);
  double const s = std::sin(wall_angle);
  Vec3 const origin{0.05, height, 0.0};
  auto const seen = [&](Vec3 const& x) {
    return AtWall{c * (x[0] - origin[0]) + s * (x[1] - origin[1]), -s * (x[0] - origin[0]) + c * (x[1] - origin[1])};
  };
  constexpr double foot = 0.55;
  auto const exact = [&](Vec3 const& x) {
    AtWall const at = seen(x);
    double const incident = std::tan(29.0 * degree) * (foot - at.along);
    double const reflected = std::tan(reflected_wave - second.turn) * (at.along - foot);
    double angle = 0.0;
    Oblique const* flow = &free;
    if (at.above > incident) {
      flow = at.above > reflected || at.along < foot ? &second : &third;
      angle = flow == &second ? -second.turn : 0.0;
    }
    Mixed w = state(flow->rho, 0.0, flow->p);
    double const along = flow->speed() * std::cos(angle);
    double const above = flow->speed() * std::sin(angle);
    w.velocity = {c * along - s * above, s * along + c * above, 0.0};
    return w;
  };
  Problem problem;
  problem.domain.geometry = grid::Geometry::planar2d;
  problem.domain.h = 1.0 / cells;
  problem.domain.cells = {cells * 6 / 5, cells * 6 / 5, 1};
  problem.domain.boundary.fill(grid::Boundary::zero_gradient);
  problem.quiescent = state(rho0, 0.0, p0);
  problem.fill(exact);
  place(problem, {ground(origin[0], origin[1], wall_angle)});
  std::vector<Index3> rim;  // where the stream comes from
  problem.for_each_cell([&](int, int, Index3 const& cell) {
    bool const at_rim = cell[0] < 3 || cell[1] < 3 || cell[1] >= problem.domain.cells[1] - 3;
    if (at_rim && !problem.gas->obstacles.contain(0, cell)) rim.push_back(cell);
  });
  double const end = 3.0 / free.speed();
  for (int step = 0; problem.gas->time() < end; ++step) {
    problem.gas->advance(0.8 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
    for (Index3 const& cell : rim) problem.gas->set(problem.grid->locate(cell), exact(problem.domain.centre(cell)));
  }
  Steady steady{{}, third.p};
  for (gas::CutCell const& cut : problem.gas->cut.cells()) {
    AtWall const at = seen(problem.domain.centre(cut.cell));
    if (at.along < foot + 0.12 || at.along > foot + 0.5) continue;
    steady.found.add(problem.at(cut.cell).pressure);
  }
  return steady;
}

TEST(CutCells, ReflectASteadyObliqueShockAsTheoryHasIt) {
  // Through the corners of cells, past them, and close to the faces of cells.
  struct Wall {
    double angle, height;
  };
  for (auto const [angle, height] : {Wall{0.0, 0.083}, Wall{0.0, 0.0801}, Wall{10.0, 0.083}, Wall{30.0, 0.083},
                                     Wall{45.0, 0.08}, Wall{45.0, 0.083}}) {
    auto const [r, expected] = steady_reflection(angle * degree, height, 100);
    std::printf("wall at %2.0f degrees: p3/p1 %.4f (theory %.4f), ripple %.2f %%\n", angle, r.mean() / p0,
                expected / p0, 100.0 * (r.most - r.least) / expected);
    EXPECT_NEAR(expected / p0, 4.1076, 0.0005);
    EXPECT_NEAR(r.mean() / expected, 1.0, 0.01);
    EXPECT_LT(r.most - r.least, 0.02 * expected);
  }
}

/// A plane shock meets a wedge that rises from the floor: largest and mean pressure along its face behind the foot
/// over that of two-shock theory.
Spread wedge(double mach, double angle, int cells) {
  double const c0 = std::sqrt(g * p0 / rho0);
  double const slope = 90.0 * degree - angle;  // between the front and the face
  Oblique const free{p0, rho0, mach / std::sin(slope), 0.0};
  Oblique const second = Oblique::behind(free, slope);
  Oblique const third = Oblique::behind(second, second.wave_that_turns(second.turn));
  Problem problem;
  problem.domain.geometry = grid::Geometry::planar2d;
  problem.domain.h = 1.0 / cells;
  problem.domain.cells = {cells, cells, 1};
  problem.domain.boundary.fill(grid::Boundary::wall);
  problem.domain.boundary[0] = grid::Boundary::inflow;
  problem.quiescent = state(rho0, 0.0, p0);
  Mixed behind = state(second.rho, mach * c0 * (1.0 - rho0 / second.rho), second.p);
  problem.inflow.fill(behind);
  constexpr double start = 0.2;
  constexpr double corner = 0.31;
  problem.fill([&](Vec3 const& x) { return x[0] < start ? behind : problem.quiescent; });
  place(problem, {ground(corner, 0.0, angle)});
  // Until the foot is high on the face.
  double const along_x = 0.4 * std::cos(angle) / 1.0;
  problem.run_to((corner + along_x - start) / (mach * c0));
  Spread found;
  for (gas::CutCell const& cut : problem.gas->cut.cells()) {
    Vec3 const x = problem.domain.centre(cut.cell);
    double const behind_foot = (corner + along_x - x[0]) / std::cos(angle);
    // Behind the width of the shock, and where the corner is not yet felt.
    if (behind_foot < 10.0 * problem.domain.h || behind_foot > 0.14) continue;
    found.add((problem.at(cut.cell).pressure - p0) / (third.p - p0));
  }
  return found;
}

TEST(CutCells, ReflectAShockFromAWedgeAsTheoryHasIt) {
  for (int const cells : {100, 200}) {
    Spread const r = wedge(1.5, 60.0 * degree, cells);
    std::printf("Mach 1.5, 60 degrees, %d cells: overpressure over that of theory %.4f (%.4f to %.4f)\n", cells,
                r.mean(), r.least, r.most);
    EXPECT_NEAR(r.mean(), 1.0, 0.01);
    EXPECT_NEAR(r.least, 1.0, 0.02);
    EXPECT_NEAR(r.most, 1.0, 0.02);
  }
}

/// A burst of products between bodies: all components and peaks of all cells in the end, and the account.
std::vector<double> burst_between_bodies(grid::Geometry geometry, bool sleep, bool chains, int threads) {
  set_threads(threads);
  Problem problem = room(geometry);
  problem.block_cells = 8;
  problem.options.sleep = sleep;
  problem.options.chains = chains;
  problem.options.bundle_cells = 48;
  problem.options.part_cells = 64;
  problem.options.peak_fields = true;
  problem.fluids.count = 2;
  problem.fluids.eos[1] = material::IdealGas{1.3};
  problem.fill([&](Vec3 const& x) {
    Mixed s = state(rho0, 0.0, p0);
    if (x[0] < 0.2 && x[1] > 0.8) {
      s.products_density = 50.0;
      s.volume_fraction = 1.0;
      s.pressure = 300.0 * p0;
    }
    return s;
  });
  place(problem, bodies(geometry));
  for (int step = 0; step < 40; ++step)
    problem.gas->advance(0.5 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
  std::vector<double> values;
  problem.for_each_cell([&](int b, int offset, Index3 const&) {
    for (int c = 0; c < problem.gas->fields().components(); ++c)
      values.push_back(problem.gas->fields().at(b, c)[offset]);
    values.push_back(problem.gas->peaks().overpressure(b)[offset]);
    values.push_back(problem.gas->peaks().impulse(b)[offset]);
  });
  values.push_back(static_cast<double>(problem.gas->account().fallback_faces));
  set_threads(1);
  return values;
}

TEST(CutCells, GiveTheSameBitsOnAnyThreadsAsleepOrAwake) {
  for (grid::Geometry const geometry : geometries) {
    std::vector<double> const one = burst_between_bodies(geometry, false, false, 1);
    for (bool const sleep : {false, true}) {
      for (bool const chains : {false, true}) {
        for (int const threads : {1, 2}) {
          std::vector<double> const other = burst_between_bodies(geometry, sleep, chains, threads);
          ASSERT_EQ(one.size(), other.size());
          EXPECT_EQ(std::memcmp(one.data(), other.data(), one.size() * sizeof(double)), 0)
              << word_of(geometry) << " sleep " << sleep << " chains " << chains << " threads " << threads;
        }
      }
    }
  }
}

TEST(CutCells, HoldGasBehindWallsThinnerThanACell) {
  for (double const angle : {0.0, 12.0, 45.0, 80.0, 90.0}) {
    for (double const thickness : {0.02, 0.3, 0.9}) {  // cells
      Problem problem = room(grid::Geometry::planar2d);
      double const h = problem.domain.h;
      Vec3 const middle{0.507, 0.493, 0.0};
      Vec3 const normal{-std::sin(angle * degree), std::cos(angle * degree), 0.0};
      auto const above = [&](Vec3 const& x) { return dot(x - middle, normal) > 0.0; };
      problem.fill([&](Vec3 const& x) { return state(rho0, 0.0, above(x) ? 20.0 * p0 : p0); });
      place(problem, {turned_box(middle, {2.0, 0.5 * thickness * h, 1.0}, {0.0, 0.0, 1.0}, angle * degree)});
      // Cells that the wall parts keep their larger piece, on either side of it.
      problem.for_each_cell([&](int, int, Index3 const& cell) {
        Vec3 const x = problem.domain.centre(cell);
        if (std::abs(dot(x - middle, normal)) > 2.0 * h) return;
        problem.gas->set(problem.grid->locate(cell), state(rho0, 0.0, p0));
      });
      std::vector<double> before;
      problem.for_each_cell([&](int b, int offset, Index3 const&) {
        before.push_back(problem.gas->fields().at(b, gas::partial_density(0))[offset]);
      });
      for (int step = 0; step < 300; ++step)
        problem.gas->advance(0.8 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
      double changed = 0.0;
      std::size_t n = 0;
      problem.for_each_cell([&](int b, int offset, Index3 const& cell) {
        double const now = problem.gas->fields().at(b, gas::partial_density(0))[offset];
        double const was = before[n++];
        if (dot(problem.domain.centre(cell) - middle, normal) > -1.5 * h) return;
        changed = std::max(changed, std::abs(now / was - 1.0));
      });
      EXPECT_LT(changed, 1e-10) << "wall of " << thickness << " cells at " << angle << " degrees";
    }
  }
}

}  // namespace
}  // namespace brisance::test
