// The same answer, bit for bit, on 1, 2 and 4 threads: gas, particles and ledger, with a shock, a body, injection,
// absorption and control of the population.
#include <cstring>

#include "bridge/harness.hpp"
#include "core/parallel.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

std::vector<double> everything(Geometry geometry, int threads, bool sleep = true) {
  set_threads(threads);
  int const dims = grid::dimensions(geometry);
  int const n = dims == 3 ? 26 : 40;
  auto c = coupled_case(geometry, {n, n, dims == 3 ? n : 1}, Boundary::outflow);
  c.domain.boundary[2] = Boundary::symmetry;
  c.mpm_regions.front().width = 1;
  c.mpm_regions.front().activation = -1.0;
  c.mpm_regions.front().population_interval = 2;
  c.numerics.block_cells = 8;
  c.numerics.sleep = sleep;
  c.particles.options.block_cells = 5;
  set_region(c, {5, 0, dims == 3 ? 5 : 0}, {n - 6, n - 6, dims == 3 ? n - 6 : 1});
  c.ambient.state.velocity = {0.3, 0.1, dims == 3 ? -0.2 : 0.0};
  run::InitialState hot;  // lies on both sides of the face
  double const h = c.domain.h;
  hot.shape = shape::Box{{3 * h, 2 * h, dims == 3 ? 6 * h : -1.0}, {8 * h, 12 * h, dims == 3 ? 12 * h : 1.0}};
  hot.state = {5.0, 20.0, {0.0, 0.0, 0.0}};
  c.initial_states = {hot};
  run::Body body;
  body.name = "block";
  body.solid = material::elastic_solid(50.0, 1e3, 0.3);
  double const low = 0.5 * n * h - 2 * h;
  body.shape =
      shape::Box{{low, low, dims == 3 ? low : -1.0}, {low + 4 * h, low + 4 * h, dims == 3 ? low + 4 * h : 1.0}};
  c.particles.bodies = {body};
  run::World w = setup::build(c);
  long const at_start = mpm::sums(*w.regions.front().particles, w.regions.front().gas_body()).particles;
  for (int step = 0; step < 24; ++step) run::advance(w, 10.0);
  EXPECT_GT(w.regions.front().bridge->traffic().injected, 0);
  EXPECT_GT(w.regions.front().bridge->traffic().absorbed, 0);
  // Population control acted: the count changed by other than injection and absorption.
  long const now = mpm::sums(*w.regions.front().particles, w.regions.front().gas_body()).particles;
  EXPECT_NE(now - at_start,
            w.regions.front().bridge->traffic().injected - w.regions.front().bridge->traffic().absorbed);
  std::vector<double> all{w.clock.time, static_cast<double>(now),
                          static_cast<double>(w.regions.front().bridge->traffic().injected)};
  for_each_cell(w, [&](int block, int offset, Index3 const&) {
    for (int k = 0; k < w.gas->fields().components(); ++k) all.push_back(w.gas->fields().at(block, k)[offset]);
  });
  for (int b = 0; b < 2; ++b) {
    for_each_particle(w, b, [&](mpm::ParticleSet const& set, int q) {
      for (int f = 0; f < mpm::field_count; ++f) {
        if (double const* values = set.field(static_cast<Field>(f))) all.push_back(values[q]);
      }
    });
  }
  for (bridge::Amounts const& account : w.regions.front().bridge->accounts()) {
    all.insert(all.end(),
               {account.mass[0], account.momentum[0], account.momentum[1], account.momentum[2], account.energy});
  }
  run::Totals const totals = w.totals();
  all.insert(all.end(), {totals.mass[0], totals.energy});
  set_threads(1);
  return all;
}

// A wind through the region, along a mirror plane.
TEST(CoupledRun, IsTheSameWithSleepOnAndOff) {
  for (auto const geometry : {Geometry::planar2d, Geometry::axisymmetric2d}) {
    auto const asleep = everything(geometry, 2);
    auto const awake = everything(geometry, 2, false);
    ASSERT_EQ(asleep.size(), awake.size()) << word_of(geometry);
    EXPECT_EQ(std::memcmp(asleep.data(), awake.data(), asleep.size() * sizeof(double)), 0) << word_of(geometry);
  }
}

TEST(CoupledRun, IsTheSameOnAnyNumberOfThreads) {
  for (auto const geometry : {Geometry::planar2d, Geometry::axisymmetric2d, Geometry::cartesian3d}) {
    auto const one = everything(geometry, 1);
    for (int const threads : {2, 4}) {
      auto const many = everything(geometry, threads);
      ASSERT_EQ(one.size(), many.size()) << word_of(geometry);
      EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof(double)), 0)
          << word_of(geometry) << ", " << threads << " threads";
    }
    std::printf("%s: %zu numbers the same on 1, 2 and 4 threads\n", word_of(geometry), one.size());
  }
}

}  // namespace
}  // namespace brisance::test
