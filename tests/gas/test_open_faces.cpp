/// Outflow boundaries: a blast leaves as if the domain went on, in every geometry, along the normal and at 45 degrees;
/// a wind enters and leaves and settles around an obstacle.
#include <gtest/gtest.h>

#include <cstdio>

#include "gas/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

constexpr double ambient_pressure = 101325.0;

struct Record {
  double peak = 0.0;
  double positive = 0.0;  ///< impulse until the pressure first comes back to the ambient one after the peak [Pa s]
  double negative = 0.0;  ///< most that it falls by afterwards [Pa s]
};

struct Blast {
  Geometry geometry = Geometry::spherical1d;
  int cells = 100;
  double h = 0.02;
  double ball = 0.3;  ///< radius [m]
  double pressure_ratio = 60.0;
  double end = 8e-3;
  gas::Scheme scheme = gas::Scheme::muscl_hancock;
  Boundary boundary = Boundary::outflow;
  int block_cells = 0;
};

std::unique_ptr<Problem> burst(Blast const& b) {
  auto problem = std::make_unique<Problem>();
  problem->box(b.geometry, b.cells, b.cells * b.h, b.boundary);
  for (int d = 0; d < problem->domain.dimensions(); ++d) problem->domain.boundary[2 * d] = Boundary::symmetry;
  problem->options.scheme = b.scheme;
  problem->options.density_floor = 1e-6;
  problem->options.pressure_floor = 1.0;
  problem->block_cells = b.block_cells;
  problem->courant = 0.7;
  problem->quiescent = state(1.225, 0.0, ambient_pressure);
  problem->options.wave_sources = {gas::WaveSource{}};
  int const dims = problem->domain.dimensions();
  problem->fill([&](Vec3 const& x) {
    double r = 0.0;
    for (int d = 0; d < dims; ++d) r += x[d] * x[d];
    Mixed s = problem->quiescent;
    if (r < b.ball * b.ball) s.pressure *= b.pressure_ratio;
    return s;
  });
  return problem;
}

std::vector<Record> records(Blast const& b, std::vector<Index3> const& gauges) {
  auto const problem = burst(b);
  std::vector<std::vector<std::pair<double, double>>> histories(gauges.size());
  while (problem->gas->time() < b.end) {
    double const before = problem->gas->time();
    double const ramp = std::min(1.0, 0.1 * static_cast<double>(problem->steps + 1));
    double const dt = ramp * problem->courant * b.h / problem->gas->fastest_signal();
    problem->gas->advance(dt, problem->steps % 2 == 1);
    ++problem->steps;
    auto const states = gas::gather(*problem->gas, gauges);
    for (std::size_t g = 0; g < gauges.size(); ++g)
      histories[g].emplace_back(problem->gas->time() - before, states[g].pressure - ambient_pressure);
  }
  std::vector<Record> all;
  for (auto const& history : histories) {
    Record r;
    bool behind = false;
    double falling = 0.0;
    for (auto const& [dt, p] : history) {
      r.peak = std::max(r.peak, p);
      behind = behind || (r.peak > 3e3 && p < 0.0);
      if (!behind)
        r.positive += dt * p;
      else
        falling += dt * p;
      r.negative = std::min(r.negative, falling);
    }
    all.push_back(r);
  }
  return all;
}

struct Comparison {
  char const* name;
  Blast near;
  int far_cells;
  std::vector<Index3> gauges;
  /// What a boundary that repeats its cells is off by at least: without that the test would prove nothing.
  double zero_gradient_error;
};

class Outflow : public testing::TestWithParam<Comparison> {};

TEST_P(Outflow, LeavesTheNegativePhaseAsInALargeDomain) {
  Comparison const c = GetParam();
  Blast far = c.near;
  far.cells = c.far_cells;
  Blast plain = c.near;
  plain.boundary = Boundary::zero_gradient;
  auto const right = records(far, c.gauges);
  auto const found = records(c.near, c.gauges);
  auto const crude = records(plain, c.gauges);
  for (std::size_t g = 0; g < c.gauges.size(); ++g) {
    std::printf(
        "%s, gauge %zu: peak %.0f Pa (%+.2f %%), impulses %+.2f (%+.2f %%) and %+.2f Pa s (%+.2f %%; with "
        "zero_gradient %+.1f %%)\n",
        c.name, g, right[g].peak, 100.0 * (found[g].peak / right[g].peak - 1.0), right[g].positive,
        100.0 * (found[g].positive / right[g].positive - 1.0), right[g].negative,
        100.0 * (found[g].negative / right[g].negative - 1.0), 100.0 * (crude[g].negative / right[g].negative - 1.0));
    EXPECT_NEAR(found[g].peak / right[g].peak, 1.0, 0.005);
    EXPECT_NEAR(found[g].positive / right[g].positive, 1.0, 0.01);
    EXPECT_NEAR(found[g].negative / right[g].negative, 1.0, 0.05);
    EXPECT_GT(std::abs(crude[g].negative / right[g].negative - 1.0), c.zero_gradient_error);
  }
}

Blast blast(Geometry geometry, int cells, double h, double end, gas::Scheme scheme = gas::Scheme::muscl_hancock) {
  Blast b;
  b.geometry = geometry;
  b.cells = cells;
  b.h = h;
  b.end = end;
  b.scheme = scheme;
  if (geometry == Geometry::cylindrical1d || geometry == Geometry::planar2d) b.ball = 0.2;
  return b;
}

constexpr auto lax_wendroff = gas::Scheme::lax_wendroff;

INSTANTIATE_TEST_SUITE_P(
    Blasts, Outflow,
    testing::Values(
        Comparison{"sphere", blast(Geometry::spherical1d, 125, 0.02, 12e-3), 400, {{99, 0, 0}}, 0.3},
        Comparison{"sphere, Lax-Wendroff",
                   blast(Geometry::spherical1d, 125, 0.02, 12e-3, lax_wendroff),
                   400,
                   {{99, 0, 0}},
                   0.3},
        Comparison{"sphere, nearer", blast(Geometry::spherical1d, 75, 0.02, 12e-3), 400, {{59, 0, 0}}, 0.3},
        Comparison{"cylinder", blast(Geometry::cylindrical1d, 125, 0.02, 12e-3), 400, {{99, 0, 0}}, 0.3},
        Comparison{"cylinder, Lax-Wendroff",
                   blast(Geometry::cylindrical1d, 125, 0.02, 12e-3, lax_wendroff),
                   400,
                   {{99, 0, 0}},
                   0.3},
        Comparison{"axisymmetric",
                   blast(Geometry::axisymmetric2d, 25, 0.1, 12e-3),
                   62,
                   {{19, 0, 0}, {0, 19, 0}, {19, 19, 0}, {14, 14, 0}},
                   0.1},
        Comparison{"plane", blast(Geometry::planar2d, 25, 0.1, 20e-3), 70, {{19, 0, 0}, {19, 19, 0}, {14, 14, 0}}, 0.2},
        Comparison{"plane, Lax-Wendroff",
                   blast(Geometry::planar2d, 25, 0.1, 20e-3, lax_wendroff),
                   70,
                   {{19, 0, 0}, {19, 19, 0}},
                   0.2},
        Comparison{
            "3D", blast(Geometry::cartesian3d, 20, 0.125, 12e-3), 38, {{15, 0, 0}, {15, 15, 0}, {15, 15, 15}}, 0.1}),
    [](auto const& value) { return "Case" + std::to_string(value.index); });

// A plane blast wave leaves without an echo.
TEST(OutflowPlane, LetsAShockOut) {
  Blast b = blast(Geometry::planar1d, 150, 0.02, 12e-3);
  b.pressure_ratio = 8.0;
  Blast far = b;
  far.cells = 450;
  Record const found = records(b, {{120, 0, 0}}).front();
  Record const right = records(far, {{120, 0, 0}}).front();
  std::printf("plane: peak %.0f and %.0f Pa, impulse %.2f and %.2f Pa s\n", found.peak, right.peak, found.positive,
              right.positive);
  EXPECT_NEAR(found.peak / right.peak, 1.0, 1e-3);
  EXPECT_NEAR(found.positive / right.positive, 1.0, 0.02);
}

TEST(Outflow, GivesTheSameBitsForAnyBlocks) {
  std::vector<double> reference;
  for (int block_cells : {40, 20, 8}) {
    Blast b = blast(Geometry::axisymmetric2d, 40, 0.05, 6e-3);
    b.block_cells = block_cells;
    auto const problem = burst(b);
    while (problem->gas->time() < b.end)
      problem->gas->advance(0.5 * b.h / problem->gas->fastest_signal(), ++problem->steps % 2 == 0);
    std::vector<double> values;
    for (int j = 0; j < b.cells; ++j) {
      for (int i = 0; i < b.cells; ++i) values.push_back(problem->at({i, j, 0}).pressure);
    }
    if (reference.empty()) reference = values;
    EXPECT_EQ(values, reference) << block_cells << " cells per block";
  }
}

TEST(Outflow, RepeatsItsCellsWhereTheGasLeavesFasterThanSound) {
  std::vector<double> reference;
  for (Boundary boundary : {Boundary::zero_gradient, Boundary::outflow}) {
    Problem problem;
    problem.box(Geometry::planar1d, 80, 1.0, boundary);
    problem.domain.boundary[0] = Boundary::inflow;
    problem.quiescent = state(1.225, 700.0, ambient_pressure);
    problem.inflow.fill(problem.quiescent);
    problem.fill([&](Vec3 const& x) {
      Mixed s = problem.quiescent;
      if (std::abs(x[0] - 0.5) < 0.1) s.pressure *= 1.3;
      return s;
    });
    problem.run_to(2e-3);
    std::vector<double> values;
    for (gas::Primitive const& w : problem.line()) values.push_back(w.pressure);
    if (reference.empty()) reference = values;
    EXPECT_EQ(values, reference);
  }
}

// Products of a charge of 1 kg pass a face at eight of its radii, the gas leaves faster than sound, and then ambient
// gas comes back against next to nothing: nothing breaks, all is booked, and no products come in.
TEST(Outflow, LetsProductsOutAndAmbientGasIn) {
  for (gas::Scheme scheme : {gas::Scheme::muscl_hancock, gas::Scheme::lax_wendroff}) {
    Problem problem;
    problem.box(Geometry::spherical1d, 100, 0.5, Boundary::outflow);
    problem.domain.boundary[0] = Boundary::symmetry;
    problem.options.scheme = scheme;
    problem.options.density_floor = 1e-6;
    problem.options.pressure_floor = 1.0;
    problem.courant = 0.4;
    problem.fluids.count = 2;
    problem.fluids.eos[1] = material::Jwl{};
    problem.fluids.ambient_pressure = ambient_pressure;
    problem.quiescent = state(1.225, 0.0, ambient_pressure);
    problem.fill([&](Vec3 const& x) {
      Mixed s = problem.quiescent;
      if (x[0] > 0.0528) return s;
      s.volume_fraction = 1.0;
      s.products_density = 1630.0;
      s.pressure = 8e9;
      return s;
    });
    double const air = problem.total(gas::partial_density(0));
    double const products = problem.total(gas::partial_density(1));
    double const energy = problem.total(gas::energy);
    double lowest = air;
    double left = products;
    double most_back = 0.0;
    double fastest = 0.0;
    while (problem.gas->time() < 12e-3) {
      problem.run_to(problem.gas->time() + 1e-4);
      lowest = std::min(lowest, problem.total(gas::partial_density(0)));
      most_back = std::max(most_back, problem.total(gas::partial_density(1)) - left);
      left = std::min(left, problem.total(gas::partial_density(1)));
      gas::Primitive const last = problem.line().back();
      fastest = std::max(fastest, last.velocity[0] / last.sound_speed);
    }
    gas::Account const a = problem.gas->account();
    double const last = problem.line().back().pressure / ambient_pressure;
    std::printf(
        "products left %.1f %%; air: least %.2f %%, in the end %.1f %% of that at the start; pressure at the "
        "face %.3f of the ambient one; largest Mach number there %.1f\n",
        100.0 * left / products, 100.0 * lowest / air, 100.0 * problem.total(gas::partial_density(0)) / air, last,
        fastest);
    EXPECT_GT(fastest, 1.0) << "the gas never left faster than sound";
    EXPECT_LT(left, 0.5 * products);
    // The faces of Lax-Wendroff take half their state from behind.
    EXPECT_LE(most_back, (scheme == gas::Scheme::lax_wendroff ? 1e-10 : 1e-12) * products);
    EXPECT_GT(problem.total(gas::partial_density(0)), 0.1 * air) << "no ambient gas came in";
    EXPECT_LT(lowest, 0.05 * air);
    EXPECT_NEAR((problem.total(gas::partial_density(0)) + a.outflow[gas::partial_density(0)]) / air,
                1.0 + a.guard_mass / air, 1e-11);
    EXPECT_NEAR((problem.total(gas::partial_density(1)) + a.outflow[gas::partial_density(1)]) / products, 1.0, 1e-11);
    EXPECT_NEAR((problem.total(gas::energy) + a.outflow[gas::energy]) / energy, 1.0 + a.guard_energy / energy, 1e-11);
    EXPECT_NEAR(last, 1.0, 0.1);
  }
}

// Mach 0.294 round a square in a domain of ten of its widths: the pressure before it comes to the isentropic stagnation
// pressure and stays there.
TEST(Outflow, LetsAWindSettleRoundAnObstacle) {
  auto const settle = [](Boundary boundary) {
    Problem problem;
    problem.box(Geometry::planar2d, 60, 6.0, boundary);
    problem.quiescent = state(1.225, 100.0, ambient_pressure);
    problem.block_cells = 20;
    problem.options.wave_sources = {gas::WaveSource{{3.0, 3.0, 0.05}, {}}};
    problem.fill([&](Vec3 const&) { return problem.quiescent; });
    for (int b = 0; b < problem.grid->block_count(); ++b) {
      grid::Block const& block = problem.grid->blocks()[b];
      grid::CellRange const box = block.with_ghosts();
      std::vector<std::uint8_t> solid(box.count(), 0);
      for_each_cell(box, [&](Index3 const& within) {
        auto const [x, y, z] = block.index(within);
        solid[box.offset(within)] = x >= 27 && x < 33 && y >= 27 && y < 33 ? 1 : 0;
      });
      problem.gas->obstacles.set(b, std::move(solid));
    }
    problem.gas->start();
    std::vector<double> means;
    for (double until : {0.2, 0.4}) {
      problem.run_to(until - 0.05);
      double sum = 0.0;
      int count = 0;
      while (problem.gas->time() < until) {
        problem.run_to(problem.gas->time() + 1e-3);
        // Between the two cells in the middle of the front.
        sum += 0.5 * (problem.at({26, 29, 0}).pressure + problem.at({26, 30, 0}).pressure) - ambient_pressure;
        ++count;
      }
      means.push_back(sum / count);
    }
    return means;
  };
  double const mach = 100.0 / std::sqrt(1.4 * ambient_pressure / 1.225);
  double const exact = ambient_pressure * (std::pow(1.0 + 0.2 * mach * mach, 3.5) - 1.0);
  auto const found = settle(Boundary::outflow);
  auto const crude = settle(Boundary::zero_gradient);
  std::printf("stagnation pressure %.0f and %.0f Pa, exact %.0f Pa; with zero_gradient %.0f and %.0f Pa\n", found[0],
              found[1], exact, crude[0], crude[1]);
  // The wake sheds vortices of some per cent.
  EXPECT_NEAR(found[1] / found[0], 1.0, 0.04);
  // The middle of the cell lies half a cell, a twelfth of the width, before the front.
  EXPECT_NEAR(found[1] / exact, 1.0, 0.05);
  EXPECT_GT(std::abs(crude[1] / exact - 1.0), 0.1);
}

}  // namespace
}  // namespace brisance::test
