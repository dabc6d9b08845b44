/// Levels: gas that crosses from cells of one size to cells of another must not see where they meet.
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>
#include <numeric>
#include <random>
#include <tuple>

#include "core/parallel.hpp"
#include "gas/level_problem.hpp"
#include "gas/refinement.hpp"
#include "gas/shock_norm.hpp"

namespace brisance::test {
namespace {

class Levels : public OnLevels, public testing::WithParamInterface<std::tuple<Geometry, gas::Scheme>> {};

TEST_P(Levels, LeaveAUniformStreamUniform) {
  auto const [geometry, scheme] = GetParam();
  bool const radial = geometry == Geometry::axisymmetric2d;
  LevelProblem problem = periodic_problem(geometry, scheme, 2);
  Mixed stream = state(1.2, 0.0, 1e5);
  // Around an axis only a stream along it is uniform.
  stream.velocity = radial ? Vec3{0.0, 130.0, 0.0} : Vec3{130.0, 70.0, problem.domain.dimensions() > 2 ? 40.0 : 0.0};
  problem.fill([&](Vec3 const&) { return stream; });
  ASSERT_EQ(problem.grid->levels(), 3);
  ASSERT_GT(problem.leaves_left_coarse(), 0);
  for (int step = 0; step < 20; ++step)
    problem.gas->advance(0.8 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
  problem.for_each_leaf_cell([&](grid::Block const&, grid::Cell const& cell) {
    gas::Primitive const s = problem.gas->primitive(cell);
    ASSERT_NEAR(s.pressure, stream.pressure, 1e-12 * 1e5);
    ASSERT_NEAR(s.density, 1.2, 1e-12);
    ASSERT_NEAR(norm(s.velocity - stream.velocity), 0.0, 1e-12 * 500.0);
  });
}

TEST_P(Levels, KeepPressureAndVelocityUniformAcrossAnInterface) {
  auto const [geometry, scheme] = GetParam();
  bool const radial = geometry == Geometry::axisymmetric2d;
  LevelProblem problem = periodic_problem(geometry, scheme, 2);
  problem.fluids.count = 2;
  problem.fluids.eos[1] = material::IdealGas{1.25};
  int const dims = problem.domain.dimensions();
  Vec3 const velocity = radial ? Vec3{0.0, 300.0, 0.0} : Vec3{300.0, 200.0, dims > 2 ? 100.0 : 0.0};
  Vec3 const place{radial ? 0.0 : 0.3, 0.5, dims > 2 ? 0.5 : 0.0};
  problem.fill([&](Vec3 const& x) {
    Mixed s = bubble(x, place, 0.2, dims);
    s.velocity = velocity;
    return s;
  });
  // A few blocks' lengths: the interface crosses the ends of levels.
  for (int step = 0; step < 24; ++step)
    problem.gas->advance(0.5 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
  double pressure = 0.0;
  double speed = 0.0;
  problem.for_each_leaf_cell([&](grid::Block const&, grid::Cell const& cell) {
    gas::Primitive const s = problem.gas->primitive(cell);
    pressure = std::max(pressure, std::abs(s.pressure / 1e6 - 1.0));
    speed = std::max(speed, norm(s.velocity - velocity) / norm(velocity));
  });
  EXPECT_LT(pressure, 1e-9);
  EXPECT_LT(speed, 1e-9);
}

TEST_P(Levels, LoseNothing) {
  auto const [geometry, scheme] = GetParam();
  LevelProblem problem = problem_with(geometry, Boundary::wall, 2);
  problem.options.scheme = scheme;
  problem.fluids.count = 2;
  problem.fluids.eos[1] = material::IdealGas{1.25};
  int const dims = problem.domain.dimensions();
  Vec3 const place{0.37, 0.45, dims > 2 ? 0.55 : 0.0};
  problem.fill([&](Vec3 const& x) {
    Mixed s = bubble(x, place, 0.12, dims);
    if (s.volume_fraction > 0.5) s.pressure = 2e7;
    return s;
  });
  std::array<double, 3> const before{problem.total(gas::partial_density(0)), problem.total(gas::partial_density(1)),
                                     problem.total(gas::energy)};
  for (int step = 0; step < 40; ++step)
    problem.gas->advance(0.5 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
  gas::Account const account = problem.gas->account();
  EXPECT_EQ(account.guarded_cells, 0);
  std::array<int, 3> const components{gas::partial_density(0), gas::partial_density(1), gas::energy};
  for (int n = 0; n < 3; ++n) EXPECT_NEAR(problem.total(components[n]) / before[n], 1.0, 1e-12) << n;
}

TEST_P(Levels, LoseNothingWhileBlocksComeAndGo) {
  auto const [geometry, scheme] = GetParam();
  int const dims = grid::dimensions(geometry);
  LevelProblem problem = problem_with(geometry, Boundary::wall, 1, dims > 2 ? 16 : 32);
  problem.options.scheme = scheme;
  problem.options.peak_fields = true;
  problem.fluids.count = 2;
  problem.fluids.eos[1] = material::IdealGas{1.25};
  Vec3 const place{0.37, 0.45, dims > 2 ? 0.55 : 0.0};
  problem.fill([&](Vec3 const& x) {
    Mixed s = bubble(x, place, 0.12, dims);
    if (s.volume_fraction > 0.5) s.pressure = 5e6;
    return s;
  });
  std::array<int, 3> const components{gas::partial_density(0), gas::partial_density(1), gas::energy};
  std::array<double, 3> before{};
  for (int n = 0; n < 3; ++n) before[n] = problem.total(components[n]);
  std::minstd_rand random(7);
  int const changes = dims > 2 ? 12 : 60;
  for (int n = 0; n < changes; ++n) {
    problem.regrid(random, 2);
    problem.step(0.5);
  }
  EXPECT_EQ(problem.gas->account().guarded_cells, 0);
  for (int n = 0; n < 3; ++n) EXPECT_NEAR(problem.total(components[n]) / before[n], 1.0, 1e-12) << n;
}

TEST_P(Levels, LoseNothingBesideAnObstacleWhileBlocksComeAndGo) {
  auto const [geometry, scheme] = GetParam();
  int const dims = grid::dimensions(geometry);
  LevelProblem problem = problem_with(geometry, Boundary::wall, 2, dims > 2 ? 32 : 64);
  problem.options.scheme = scheme;
  // Off the ends of blocks by a cell and more.
  int const last = problem.domain.cells[0];
  grid::CellRange const obstacle{{17, 13, dims > 2 ? 9 : 0}, {last / 2 + 5, 23, dims > 2 ? 18 : 1}};
  Vec3 const place{0.37, 0.2, dims > 2 ? 0.25 : 0.0};
  problem.fill([&](Vec3 const& x) {
    Vec3 way = x - place;
    for (int d = dims; d < 3; ++d) way[d] = 0.0;
    return norm(way) < 0.1 ? state(3.0, 0.0, 2e6) : state(1.2, 0.0, 1e5);
  });
  std::vector<int> all(problem.grid->blocks().size());
  std::iota(all.begin(), all.end(), 0);
  problem.gas->obstacles.set_elsewhere(
      [&](int level, Index3 const& cell) { return problem.lies_in(obstacle, level, cell); });
  problem.place_obstacle(*problem.gas, all, obstacle);
  problem.gas->start();
  std::array<int, 2> const components{gas::partial_density(0), gas::energy};
  std::array<double, 2> before{};
  for (int n = 0; n < 2; ++n) before[n] = problem.total(components[n]);
  std::minstd_rand random(11);
  for (int n = 0; n < (dims > 2 ? 8 : 60); ++n) {
    auto const at = [&] { return static_cast<double>(random() % 1000) / 1000.0; };
    Vec3 const middle{at(), at(), dims > 2 ? at() : 0.0};
    problem.regrid_around(middle, 0.4, 2, [&](std::vector<int> const& blocks) {
      problem.place_obstacle(*problem.gas, blocks, obstacle);
    });
    problem.step(0.5);
    if (n % 4 != 3) continue;
    auto const kept = problem.near_walls();
    problem.gas->obstacles.find_near_walls();
    ASSERT_TRUE(problem.near_walls() == kept) << "after change " << n;
  }
  EXPECT_EQ(problem.gas->account().guarded_cells, 0);
  for (int n = 0; n < 2; ++n) EXPECT_NEAR(problem.total(components[n]) / before[n], 1.0, 1e-12) << n;
}

TEST_P(Levels, KeepAnInterfaceUniformWhileBlocksComeAndGo) {
  auto const [geometry, scheme] = GetParam();
  bool const radial = geometry == Geometry::axisymmetric2d;
  int const dims = grid::dimensions(geometry);
  LevelProblem problem = periodic_problem(geometry, scheme, 1, dims > 2 ? 16 : 32);
  problem.fluids.count = 2;
  problem.fluids.eos[1] = material::IdealGas{1.25};
  Vec3 const velocity = radial ? Vec3{0.0, 300.0, 0.0} : Vec3{300.0, 200.0, dims > 2 ? 100.0 : 0.0};
  problem.fill([&](Vec3 const& x) {
    Mixed s = bubble(x, {radial ? 0.0 : 0.3, 0.5, dims > 2 ? 0.5 : 0.0}, 0.2, dims);
    s.velocity = velocity;
    return s;
  });
  double const momentum = problem.total(gas::momentum_y);
  std::minstd_rand random(11);
  for (int n = 0; n < 12; ++n) {
    problem.regrid(random, 2);
    problem.step(0.5);
  }
  double miss = 0.0;
  problem.for_each_leaf_cell([&](grid::Block const&, grid::Cell const& cell) {
    gas::Primitive const s = problem.gas->primitive(cell);
    miss = std::max({miss, std::abs(s.pressure / 1e6 - 1.0), norm(s.velocity - velocity) / norm(velocity)});
  });
  EXPECT_LT(miss, 1e-9);
  EXPECT_NEAR(problem.total(gas::momentum_y) / momentum, 1.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Geometries, Levels,
                         testing::Combine(testing::Values(Geometry::planar2d, Geometry::axisymmetric2d,
                                                          Geometry::cartesian3d),
                                          testing::Values(gas::Scheme::muscl_hancock, gas::Scheme::lax_wendroff)));

using LevelWaves = OnLevels;
using LevelSleep = OnLevels;
using Regrid = OnLevels;
using Refinement = OnLevels;

/// A plane pulse of sound that runs along x through a tube, from coarse cells into fine ones or back. Returns the
/// largest pressure left behind it, in parts of its own.
double reflected(bool into_fine) {
  LevelProblem problem;
  problem.domain.geometry = Geometry::planar2d;
  problem.domain.h = 1.0 / 80.0;
  problem.domain.cells = {240, 8, 1};
  problem.domain.boundary.fill(Boundary::outflow);
  problem.domain.boundary[2] = problem.domain.boundary[3] = Boundary::symmetry;
  problem.block_cells = 8;
  problem.refined = [=](Leaf const& leaf, Vec3 const& centre) {
    return leaf.level == 0 && (centre[0] > 1.5) == into_fine;
  };
  constexpr double amplitude = 1e-4;
  constexpr double width = 0.25;  // 20 coarse cells, 40 fine ones
  double const c = std::sqrt(1.4);
  problem.quiescent = state(1.0, 0.0, 1.0);
  problem.fill([&](Vec3 const& x) {
    double const s = (x[0] - 1.0) / width;
    double const wave = std::abs(s) < 0.5 ? amplitude * std::pow(std::cos(std::numbers::pi * s), 2) : 0.0;
    return state(1.0 + wave / 1.4, wave / c, 1.0 + wave);
  });
  double const end = 1.0 / c;  // the middle of the pulse is at 2
  while (problem.gas->time() < end) {
    double const dt = std::min(0.8 * problem.domain.h / problem.gas->fastest_signal(), end - problem.gas->time());
    problem.gas->advance(dt, problem.steps++ % 2 == 1);
  }
  double most = 0.0;
  problem.for_each_leaf_cell([&](grid::Block const& block, grid::Cell const& cell) {
    if (block.centre(cell)[0] < 1.45) most = std::max(most, std::abs(problem.gas->primitive(cell).pressure - 1.0));
  });
  return most / amplitude;
}

TEST_F(LevelWaves, HardlyReflectSound) {
  double const into = reflected(true);
  double const out = reflected(false);
  std::printf("reflected: %.3f %% into fine cells, %.3f %% out of them\n", 100.0 * into, 100.0 * out);
  EXPECT_LT(into, 0.005);
  EXPECT_LT(out, 0.005);
}

/// L1 error of the density of a smooth wave that crosses a periodic box with a finer middle, over all cells and over
/// those that lie `away` from the ends of levels.
struct WaveError {
  double all = 0.0;
  double away = 0.0;
};
WaveError wave_error(bool acoustic, Geometry geometry, int n) {
  LevelProblem problem = problem_with(geometry, Boundary::periodic, 1, n);
  problem.block_cells = n / 4;
  int const dims = problem.domain.dimensions();
  problem.refined = [=](Leaf const& leaf, Vec3 const& centre) {
    bool inside = leaf.level == 0;
    for (int d = 0; d < dims; ++d) inside = inside && centre[d] > 0.25 && centre[d] < 0.75;
    return inside;
  };
  constexpr double amplitude = 1e-7;
  double const k = 2.0 * std::numbers::pi;
  // In 2D not along a diagonal, where sweeps in both directions change the same; in 3D that takes too many cells.
  Vec3 const way = dims > 2 ? Vec3{1.0, 1.0, 1.0} : Vec3{1.0, 2.0, 0.0};
  double const size = norm(way);
  double const c = std::sqrt(1.4);
  auto const exact = [&](Vec3 const& x, double t) {
    double const wave = amplitude * std::sin(k * (dot(way, x) - size * (acoustic ? c : 1.0) * t));
    Mixed s = state(1.0 + wave, 0.0, acoustic ? 1.0 + 1.4 * wave : 1.0);
    for (int d = 0; d < dims; ++d) s.velocity[d] = (acoustic ? c * wave : 1.0) * way[d] / size;
    return s;
  };
  problem.fill([&](Vec3 const& x) { return exact(x, 0.0); });
  double const period = 1.0 / (size * (acoustic ? c : 1.0));
  while (problem.gas->time() < period * (1.0 - 1e-13)) {
    double const dt = std::min(0.4 * problem.domain.h / problem.gas->fastest_signal(), period - problem.gas->time());
    problem.gas->advance(dt, problem.steps++ % 2 == 1);
  }
  WaveError error;
  double away_volume = 0.0;
  problem.for_each_leaf_cell([&](grid::Block const& block, grid::Cell const& cell) {
    Vec3 const x = block.centre(cell);
    double const rho = problem.gas->fields().at(block.number, gas::partial_density(0))[cell.offset];
    double const miss = std::abs(rho - exact(x, period).ambient_density) / amplitude * block.volume(cell);
    error.all += miss;
    double nearest = 1.0;
    for (int d = 0; d < dims; ++d) nearest = std::min(nearest, std::min(std::abs(x[d] - 0.25), std::abs(x[d] - 0.75)));
    if (nearest < 0.0625) return;
    error.away += miss;
    away_volume += block.volume(cell);
  });
  error.away /= away_volume;
  return error;
}

class LevelOrder : public OnLevels, public testing::WithParamInterface<std::tuple<bool, Geometry>> {};

TEST_P(LevelOrder, IsHardlyLower) {
  auto const [acoustic, geometry] = GetParam();
  int const coarse = geometry == Geometry::planar2d ? 64 : 32;
  WaveError const a = wave_error(acoustic, geometry, coarse);
  WaveError const b = wave_error(acoustic, geometry, 2 * coarse);
  double const all = std::log2(a.all / b.all);
  double const away = std::log2(a.away / b.away);
  std::printf("%s wave, %dD: order %.2f, away from the ends of levels %.2f (error %.2e at %d cells)\n",
              acoustic ? "acoustic" : "entropy", grid::dimensions(geometry), all, away, a.all, coarse);
  EXPECT_GE(all, 1.5);
  EXPECT_GE(away, 1.9);
}

INSTANTIATE_TEST_SUITE_P(Waves, LevelOrder,
                         testing::Combine(testing::Bool(), testing::Values(Geometry::planar2d, Geometry::cartesian3d)));

/// A burst in a corner of quiescent gas with a finer middle; all leaves' values.
std::vector<double> after_burst(bool sleep) {
  LevelProblem problem = problem_with(Geometry::cartesian3d, Boundary::outflow, 2);
  problem.options.sleep = sleep;
  problem.quiescent = state(1.2, 0.0, 1e5);
  problem.fill([&](Vec3 const& x) {
    return norm(x - Vec3{0.2, 0.2, 0.2}) < 0.1 ? state(5.0, 0.0, 2e6) : problem.quiescent;
  });
  for (int step = 0; step < 12; ++step)
    problem.gas->advance(0.5 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
  std::vector<double> values;
  int asleep = 0;
  for (grid::Block const& block : problem.grid->blocks()) asleep += problem.gas->awake(block.number) ? 0 : 1;
  EXPECT_EQ(asleep > 0, sleep);
  problem.for_each_leaf_cell([&](grid::Block const& block, grid::Cell const& cell) {
    for (int c = 0; c < problem.gas->fields().components(); ++c)
      values.push_back(problem.gas->fields().at(block.number, c)[cell.offset]);
  });
  return values;
}

TEST_F(LevelSleep, ChangesNoBit) { EXPECT_EQ(after_burst(true), after_burst(false)); }

TEST_F(Regrid, OfTheSameLeavesChangesNoBit) {
  auto const run = [](bool regrid) {
    LevelProblem problem = problem_with(Geometry::planar2d, Boundary::outflow, 2);
    problem.options.peak_fields = true;
    problem.quiescent = state(1.2, 0.0, 1e5);
    problem.fill([&](Vec3 const& x) {
      return norm(x - Vec3{0.3, 0.3, 0.0}) < 0.1 ? state(5.0, 0.0, 2e6) : problem.quiescent;
    });
    for (int n = 0; n < 60; ++n) {
      if (regrid) problem.gas->regrid(*problem.grid, *problem.forest);
      problem.step(0.5);
    }
    std::vector<double> values{problem.gas->account().outflow[gas::energy]};
    problem.for_each_leaf_cell([&](grid::Block const& block, grid::Cell const& cell) {
      values.push_back(problem.gas->fields().at(block.number, gas::energy)[cell.offset]);
      values.push_back(problem.gas->peaks().impulse(block.number)[cell.offset]);
    });
    EXPECT_NE(values.front(), 0.0);
    return values;
  };
  EXPECT_EQ(run(true), run(false));
}

TEST_F(Regrid, GivesBackWhatItHasRefined) {
  LevelProblem problem = problem_with(Geometry::cartesian3d, Boundary::wall, 0, 16);
  problem.options.peak_fields = true;
  problem.quiescent = state(1.2, 0.0, 1e5);
  problem.fill([&](Vec3 const& x) {
    return norm(x - Vec3{0.3, 0.3, 0.4}) < 0.2 ? state(5.0, 0.0, 2e6) : problem.quiescent;
  });
  for (int n = 0; n < 5; ++n) problem.step(0.5);
  auto const values = [&] {
    std::vector<double> found;
    problem.for_each_leaf_cell([&](grid::Block const& block, grid::Cell const& cell) {
      for (int c = 0; c < problem.gas->fields().components(); ++c)
        found.push_back(problem.gas->fields().at(block.number, c)[cell.offset]);
      found.push_back(problem.gas->peaks().overpressure(block.number)[cell.offset]);
    });
    return found;
  };
  std::vector<double> const before = values();
  problem.forest->adapt(std::vector<std::int8_t>(problem.forest->leaves().size(), 1), 1);
  problem.gas->regrid(*problem.grid, *problem.forest);
  ASSERT_EQ(problem.grid->block_count(), 64);
  problem.forest->adapt(std::vector<std::int8_t>(problem.forest->leaves().size(), -1), 1);
  problem.gas->regrid(*problem.grid, *problem.forest);
  std::vector<double> const after = values();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t n = 0; n < after.size(); ++n) ASSERT_NEAR(after[n], before[n], 1e-13 * (1.0 + std::abs(before[n])));
}

TEST_F(Regrid, KeepsThePeaksOfCellsThatFinerOnesHaveCovered) {
  LevelProblem problem = problem_with(Geometry::planar2d, Boundary::wall, 1, 64);
  problem.options.peak_fields = true;
  problem.fill([&](Vec3 const& x) {
    return norm(x - Vec3{0.5, 0.5, 0.0}) < 0.1 ? state(5.0, 0.0, 2e6) : state(1.2, 0.0, 1e5);
  });
  ASSERT_GT(problem.leaves_left_coarse(), 0);
  for (int n = 0; n < 12; ++n) problem.step(0.5);
  grid::CellRange const all = problem.domain.all_cells();
  auto const peaks = [&] {
    std::vector<double> means(all.count(), 0.0);
    problem.for_each_leaf_cell([&](grid::Block const& block, grid::Cell const& cell) {
      Index3 index = block.index(cell);
      for (int d = 0; d < 2; ++d) index[d] >>= block.level;
      means[all.offset(index)] +=
          std::ldexp(problem.gas->peaks().overpressure(block.number)[cell.offset], -2 * block.level);
    });
    return means;
  };
  std::vector<double> const before = peaks();
  problem.forest->adapt(std::vector<std::int8_t>(problem.forest->leaves().size(), -1), 1);
  problem.gas->regrid(*problem.grid, *problem.forest);
  ASSERT_EQ(problem.grid->levels(), 1);
  std::vector<double> const after = peaks();
  for (std::size_t n = 0; n < after.size(); ++n) ASSERT_NEAR(after[n], before[n], 1e-12 * (1.0 + before[n])) << n;
}

/// A burst in the middle of a square, on cells of 1/n or on those and half of them where shocks are; pressures on a
/// grid of places, and how many cells there were at the end.
struct Burst {
  std::vector<double> pressures;
  long cells = 0;
};
Burst burst(int n, int most_level) {
  LevelProblem problem;
  problem.box(Geometry::planar2d, n, 1.0, Boundary::outflow);
  problem.block_cells = 8;
  problem.refined = [](Leaf const&, Vec3 const&) { return false; };
  problem.quiescent = state(1.2, 0.0, 1e5);
  gas::RefinementRules rules;
  rules.most_level = most_level;
  rules.shock_level = most_level;
  rules.filter = 0.02;  // weak waves too
  gas::Refinement refinement(rules);
  auto const initial = [&](Vec3 const& x) {
    return norm(x - Vec3{0.5, 0.5, 0.0}) < 0.15 ? state(6.0, 0.0, 2e6) : problem.quiescent;
  };
  problem.fill(initial);
  // The shock of the start asks for its cells before it has moved.
  if (most_level > 0) {
    std::vector<std::int8_t> marks;
    for (Leaf const& leaf : problem.forest->leaves()) {
      Vec3 const middle{(leaf.place[0] + 0.5) * 8.0 / n, (leaf.place[1] + 0.5) * 8.0 / n, 0.0};
      marks.push_back(norm(middle - Vec3{0.5, 0.5, 0.0}) < 0.25 ? 1 : 0);
    }
    problem.forest->adapt(marks, 1);
    problem.gas->regrid(*problem.grid, *problem.forest);
    for (grid::Block const& block : problem.grid->blocks()) {
      grid::for_each_cell(block, [&](grid::Cell const& cell) { problem.gas->set(cell, initial(block.centre(cell))); });
    }
    problem.gas->start();
  }
  double const end = 3e-4;
  while (problem.gas->time() < end * (1.0 - 1e-13)) {
    if (most_level > 0 && problem.steps % 2 == 0 && refinement.adapt(*problem.gas, *problem.forest))
      problem.gas->regrid(*problem.grid, *problem.forest);
    double const dt = std::min(0.8 * problem.domain.h / problem.gas->fastest_signal(), end - problem.gas->time());
    problem.gas->advance(dt, problem.steps++ % 2 == 1);
  }
  Burst result;
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 40; ++i) {
      Vec3 const x{(i + 0.5) / 40.0, (j + 0.5) / 40.0, 0.0};
      result.pressures.push_back(problem.gas->primitive(problem.grid->locate(x)).pressure);
    }
  }
  problem.for_each_leaf_cell([&](grid::Block const&, grid::Cell const&) { ++result.cells; });
  return result;
}

TEST_F(Refinement, GivesWhatFineCellsEverywhereGive) {
  Burst const coarse = burst(160, 0);
  Burst const fine = burst(320, 0);
  Burst const adapted = burst(160, 1);
  auto const miss = [&](Burst const& other) {
    double sum = 0.0;
    for (std::size_t n = 0; n < fine.pressures.size(); ++n)
      sum += std::abs(other.pressures[n] - fine.pressures[n]) / static_cast<double>(fine.pressures.size());
    return sum;
  };
  std::printf("mean difference of the pressure from fine cells: coarse %.4g, adapted %.4g Pa; %ld of %ld cells\n",
              miss(coarse), miss(adapted), adapted.cells, fine.cells);
  // Blocks that nobody needs are left coarse at once: fewer cells, of which those behind the shock are a little farther
  // from fine ones than where they stay.
  EXPECT_LT(miss(adapted), 0.33 * miss(coarse));
  EXPECT_LT(adapted.cells, fine.cells * 45 / 100);
}

TEST_F(Refinement, IsNotAskedForByAPocket) {
  for (double const width : {0.03, 0.5}) {  // of the corner with a higher pressure: a cell, or a quarter of the box
    Problem problem;
    problem.box(Geometry::planar2d, 32, 1.0, Boundary::wall);
    problem.block_cells = 32;
    problem.fill([&](Vec3 const& x) { return state(1.2, 0.0, x[0] < width && x[1] < width ? 3e5 : 1e5); });
    std::vector<std::uint8_t> asks;
    double const norm = gas::ShockNorm().find(*problem.gas, problem.grid->blocks()[0], {}, asks);
    auto const asking = std::count_if(asks.begin(), asks.end(), [](std::uint8_t a) { return a != 0; });
    EXPECT_EQ(asking > 0, width == 0.5);
    EXPECT_EQ(norm > 0.0, width == 0.5);
  }
}

TEST_F(Refinement, GivesTheSameBitsOnAnyNumberOfThreads) {
  int const before = threads();
  set_threads(1);
  Burst const alone = burst(80, 1);
  for (int const count : {2, 4}) {
    set_threads(count);
    Burst const shared = burst(80, 1);
    EXPECT_EQ(shared.pressures, alone.pressures) << count << " threads";
    EXPECT_EQ(shared.cells, alone.cells);
  }
  set_threads(before);
}

}  // namespace
}  // namespace brisance::test
