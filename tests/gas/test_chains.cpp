/// Sweeps through chains of blocks: they must do what they do where ghost cells are copied between blocks.
#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "gas/layout.hpp"
#include "harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

struct Setting {
  gas::Scheme scheme;
  Boundary boundary;
  int fluids;
  int block_cells;
  int bundle_cells;
};

/// Gas bursts in a corner of quiescent air, beside an obstacle; the far side stays at rest. Returns what cells hold,
/// component by component, and the peak pressures.
std::vector<double> after_burst(Setting const& setting, bool chains) {
  Index3 const cells{40, 24, 20};
  auto const [scheme, boundary, fluids, block_cells, bundle_cells] = setting;
  Problem problem;
  problem.box(Geometry::cartesian3d, 1, 1.0, boundary);
  problem.domain.cells = cells;
  problem.domain.h = 0.025;
  problem.domain.boundary[0] = problem.domain.boundary[2] = problem.domain.boundary[4] = Boundary::symmetry;
  if (boundary == Boundary::periodic) problem.domain.boundary.fill(boundary);
  problem.block_cells = block_cells;
  problem.options.scheme = scheme;
  problem.options.bundle_cells = bundle_cells;
  problem.options.chains = chains;
  problem.options.peak_fields = true;
  problem.fluids.count = fluids;
  problem.fluids.eos[1] = material::Jwl{1630.0, 371.2e9, 3.21e9, 4.15, 0.95, 0.30};  // TNT [Dobratz85]
  Mixed burst = problem.quiescent;
  burst.pressure = 3e7;
  if (fluids > 1) {
    burst.products_density = 300.0;
    burst.volume_fraction = 1.0;
  }
  problem.fill([&](Vec3 const& x) { return norm(x - Vec3{0.36, 0.2, 0.15}) < 0.11 ? burst : problem.quiescent; });
  place_obstacle(problem,
                 [](Index3 const& c) { return c[0] >= 20 && c[0] < 24 && c[1] >= 2 && c[1] < 6 && c[2] < 10; });
  problem.gas->start();
  for (int step = 0; step < 14; ++step)
    problem.gas->advance(0.4 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
  std::vector<double> values;
  for (int c = 0; c <= problem.gas->fields().components(); ++c) {
    for (int k = 0; k < cells[2]; ++k) {
      for (int j = 0; j < cells[1]; ++j) {
        for (int i = 0; i < cells[0]; ++i) {
          grid::Cell const cell = problem.grid->locate(Index3{i, j, k});
          values.push_back(c < problem.gas->fields().components()
                               ? problem.gas->fields().at(cell.block, c)[cell.offset]
                               : problem.gas->peaks().overpressure(cell.block)[cell.offset]);
        }
      }
    }
  }
  return values;
}

class Chains : public testing::TestWithParam<std::tuple<gas::Scheme, Boundary, int>> {};

TEST_P(Chains, GiveTheBitsOfCopiedGhostCells) {
  auto const [scheme, boundary, fluids] = GetParam();
  for (int const block_cells : {24, 16, 8}) {
    for (int const bundle_cells : {60, 320}) {
      Setting const setting{scheme, boundary, fluids, block_cells, bundle_cells};
      EXPECT_EQ(after_burst(setting, true), after_burst(setting, false))
          << "blocks of " << block_cells << ", bundles of " << bundle_cells;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, Chains,
                         testing::Combine(testing::Values(gas::Scheme::muscl_hancock, gas::Scheme::lax_wendroff),
                                          testing::Values(Boundary::wall, Boundary::outflow, Boundary::periodic),
                                          testing::Values(1, 2)));

}  // namespace
}  // namespace brisance::test
