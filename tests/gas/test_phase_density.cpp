// The second fluid's own density, partial density over volume fraction, while products are squeezed or stretched:
// homologous flow, u = -k x / (1 - k t), multiplies every density by (1 - k t)^-n, n the number of directions that
// shrink, and leaves an even pressure even. Both fluids have the same gamma, so that this is exact for the mixture.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "gas/harness.hpp"

namespace brisance::test {
namespace {

constexpr double pressure = 0.1;
constexpr double products_density = 1.3;
constexpr double air_density = 1.0;

/// Where the flow goes: along `direction`, at rest at the low (`side` 0) or high end of it.
struct Way {
  grid::Geometry geometry;
  int direction, side;
  [[nodiscard]] int shrinking() const { return 1 + grid::radial_exponent(geometry); }
};
constexpr std::array ways{
    Way{grid::Geometry::planar1d, 0, 0},      Way{grid::Geometry::planar1d, 0, 1},
    Way{grid::Geometry::cylindrical1d, 0, 0}, Way{grid::Geometry::spherical1d, 0, 0},
    Way{grid::Geometry::planar2d, 1, 0},      Way{grid::Geometry::cartesian3d, 0, 1},
    Way{grid::Geometry::cartesian3d, 1, 1},   Way{grid::Geometry::cartesian3d, 2, 0},
    Way{grid::Geometry::cartesian3d, 2, 1},
};

/// Largest relative deviation of the products' own density from the exact one, wherever they fill more than a
/// thousandth and no signal from the open end has come. They fill everything, or a layer with air on both sides.
double deviation(Way const& way, bool layer, double rate, bool afterburn) {
  constexpr int n = 40;
  constexpr double end = 1.0;
  Problem p;
  p.domain.geometry = way.geometry;
  p.domain.h = 1.0 / n;
  for (int d = 0; d < p.domain.dimensions(); ++d) p.domain.cells[d] = d == way.direction ? n : 4;
  p.domain.boundary.fill(grid::Boundary::periodic);
  p.domain.boundary[2 * way.direction + way.side] = grid::Boundary::symmetry;
  p.domain.boundary[2 * way.direction + 1 - way.side] = grid::Boundary::outflow;
  p.fluids.count = 2;
  p.fluids.eos[1] = material::IdealGas{1.4};
  p.options.sleep = false;
  // Releases nothing before its start, but the density of products that burn on is bounded at the faces of cells.
  if (afterburn) p.options.afterburn = material::Afterburn{1.0, material::ConstantRateAfterburn{2.0, 3.0}};
  auto const away = [&](Vec3 const& x) { return way.side == 0 ? x[way.direction] : 1.0 - x[way.direction]; };
  p.fill([&](Vec3 const& x) {
    Mixed s = state(air_density, 0.0, pressure);
    s.products_density = products_density;
    s.velocity[way.direction] = (way.side == 0 ? -rate : rate) * away(x);
    s.volume_fraction = !layer || (away(x) > 0.15 && away(x) < 0.45) ? 1.0 : 0.0;
    return s;
  });
  p.run_to(end);
  double const exact = products_density / std::pow(1.0 - rate * end, way.shrinking());
  double worst = 0.0;
  int mixed = 0;
  p.for_each_cell([&](int b, int at, Index3 const& cell) {
    double const x = away(p.domain.centre(cell));
    if (!layer && (x < 0.1 || x > 0.5)) return;  // signals run 0.374 m and less; at a centre the volumes are coarse
    if (x > 0.55) return;
    double const alpha = p.gas->fields().at(b, gas::volume_fraction(1))[at];
    if (alpha < 1e-3) return;
    mixed += alpha < 0.999 ? 1 : 0;
    worst = std::max(worst, std::abs(p.gas->fields().at(b, gas::partial_density(1))[at] / alpha / exact - 1.0));
  });
  EXPECT_EQ(mixed > 0, layer);
  EXPECT_EQ(p.gas->account().guarded_cells, 0);
  return worst;
}

class PhaseDensity : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(SqueezedAndStretched, PhaseDensity, testing::Values(0.1, -0.1));

TEST_P(PhaseDensity, FollowsTheVolume) {
  for (Way const& way : ways) {
    for (bool const afterburn : {false, true}) {
      double const d = deviation(way, false, GetParam(), afterburn);
      std::printf("%s, direction %d, side %d%s: %.1e\n", word_of(way.geometry), way.direction, way.side,
                  afterburn ? ", afterburn" : "", d);
      // Second order: at most 1.3e-4 is measured. An error of the first order, k dt / 2 = 2e-3 of every flux, leaves
      // 5e-4 and more.
      EXPECT_LT(d, 1e-4 * way.shrinking());
    }
  }
}

TEST_P(PhaseDensity, FollowsTheVolumeAtTheEdgeOfTheProducts) {
  for (Way const& way : ways) {
    double const d = deviation(way, true, GetParam(), true);
    std::printf("%s, direction %d, side %d: %.1e\n", word_of(way.geometry), way.direction, way.side, d);
    // The volume fraction is not squeezed within a step, which is of the first order in the mixed cells. Per direction
    // that shrinks 0.85 % is measured in squeezed cells and 0.6 % in stretched ones; bounds of the wrong sign make it
    // 1.2 % and more in both.
    EXPECT_LT(d, 0.01 * way.shrinking());
  }
}

}  // namespace
}  // namespace brisance::test
