/// Blocks that come and go many times: nothing is lost, and no memory is left behind. BRISANCE_CHANGES sets how often.
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdlib>
#include <tuple>

#include "gas/level_problem.hpp"

namespace brisance::test {
namespace {

class LevelChanges : public OnLevels, public testing::WithParamInterface<std::tuple<Geometry, gas::Scheme>> {};

int changes_in(int dims) {
  if (char const* const wanted = std::getenv("BRISANCE_CHANGES")) return std::atoi(wanted);
  return dims > 2 ? 40 : 400;
}

long memory_in_use() {
  struct mallinfo2 const info = mallinfo2();
  return static_cast<long>(info.uordblks + info.hblkhd);
}

/// Mass of each fluid, energy, and momentum where nothing gives any.
struct Content {
  std::vector<double> values;

  explicit Content(LevelProblem const& problem) {
    std::vector<int> components{gas::partial_density(0), gas::partial_density(1), gas::energy, gas::momentum_y};
    if (problem.domain.geometry != Geometry::axisymmetric2d) components.push_back(gas::momentum_x);
    if (problem.domain.dimensions() > 2) components.push_back(gas::momentum_z);
    for (int const c : components) values.push_back(problem.total(c));
  }
};

TEST_P(LevelChanges, LoseNothingAndLeaveNoMemoryBehind) {
  auto const [geometry, scheme] = GetParam();
  bool const radial = geometry == Geometry::axisymmetric2d;
  int const dims = grid::dimensions(geometry);
  LevelProblem problem = periodic_problem(geometry, scheme, 1, dims > 2 ? 16 : 32);
  problem.options.peak_fields = true;
  problem.fluids.count = 2;
  problem.fluids.eos[1] = material::IdealGas{1.25};
  problem.fill([&](Vec3 const& x) {
    Mixed s = bubble(x, {radial ? 0.0 : 0.3, 0.5, dims > 2 ? 0.5 : 0.0}, 0.2, dims);
    if (s.volume_fraction > 0.5) s.pressure = 2e6;
    s.velocity = radial ? Vec3{0.0, 300.0, 0.0} : Vec3{300.0, 200.0, dims > 2 ? 100.0 : 0.0};
    return s;
  });
  Content const before(problem);
  std::minstd_rand random(13);
  int const changes = changes_in(dims);
  // Memory is compared with all blocks merged, after half of the changes and at the end.
  auto const merged = [&] {
    for (int level = 0; level < 3; ++level) {
      problem.forest->adapt(std::vector<std::int8_t>(problem.forest->leaves().size(), -1), 2);
      problem.gas->regrid(*problem.grid, *problem.forest);
    }
    return memory_in_use();
  };
  long first = 0;
  std::size_t left_coarse = 0;
  for (int n = 0; n < changes; ++n) {
    problem.regrid(random, 2);
    left_coarse += problem.leaves_left_coarse();
    problem.step(0.5);
    if (n == changes / 2) first = merged();
  }
  EXPECT_GT(left_coarse, 0U);
  EXPECT_LT(merged(), first + (1L << 16));
  EXPECT_EQ(problem.gas->account().guarded_cells, 0);
  Content const after(problem);
  for (std::size_t n = 0; n < before.values.size(); ++n)
    EXPECT_NEAR(after.values[n] / before.values[n], 1.0, 1e-12) << n;
}

INSTANTIATE_TEST_SUITE_P(Geometries, LevelChanges,
                         testing::Combine(testing::Values(Geometry::planar2d, Geometry::axisymmetric2d,
                                                          Geometry::cartesian3d),
                                          testing::Values(gas::Scheme::muscl_hancock, gas::Scheme::lax_wendroff)));

}  // namespace
}  // namespace brisance::test
