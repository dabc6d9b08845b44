// A slab of TNT lit over one face: the detonation runs through it as a plane wave. cases/tnt_slab_1d is the same as a
// deck.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "../observe/watched.hpp"
#include "cases.hpp"
#include "core/parallel.hpp"
#include "material/chapman_jouguet.hpp"

namespace brisance::run {
namespace {

constexpr double thickness = 0.2;  // m

/// The slab on a mirror plane, air behind it, closed by a wall. Initiation points light the slab's whole depth as plane
/// waves.
Case slab(int cells_per_slab, std::vector<InitiationPoint> initiation) {
  Case c =
      air_case(grid::Geometry::planar1d, {2 * cells_per_slab, 1, 1}, thickness / cells_per_slab, grid::Boundary::wall);
  c.domain.boundary[0] = grid::Boundary::symmetry;
  Charge charge = tnt_charge(shape::Box{{0.0, 0.0, 0.0}, {thickness, 1.0, 1.0}}, c.domain.geometry);
  for (InitiationPoint& particle : initiation) {
    // In 1D the wave is plane: only the distance along x counts.
    particle.position[1] = shape::centre(charge.shape)[1];
    particle.position[2] = shape::centre(charge.shape)[2];
  }
  charge.initiation = std::move(initiation);
  c.charges = {charge};
  for (int n = 1; n < 8; ++n) c.gauges.push_back({fmt::format("g{}", n), {n * thickness / 8.0, 0.0, 0.0}});
  return c;
}

class TntSlab : public testing::Test {
 protected:
  // Too few cells to be worth a second thread.
  TntSlab() { set_threads(1); }
  ~TntSlab() override { set_threads(0); }
};

double peak(GaugeHistory const& gauge) {
  return std::max_element(gauge.records.begin(), gauge.records.end(),
                          [](auto const& a, auto const& b) { return a.pressure < b.pressure; })
      ->pressure;
}

/// Time at which the pressure first passes half of the gauge's peak, linear between the records.
double arrival(GaugeHistory const& gauge) {
  double const half = 0.5 * peak(gauge);
  for (std::size_t n = 1; n < gauge.records.size(); ++n) {
    GaugeRecord const& a = gauge.records[n - 1];
    GaugeRecord const& b = gauge.records[n];
    if (b.pressure >= half) return a.time + (b.time - a.time) * (half - a.pressure) / (b.pressure - a.pressure);
  }
  return -1.0;
}

TEST_F(TntSlab, RunsAtTheDetonationSpeedWithItsChapmanJouguetPressure) {
  observe::Watched world(slab(2000, {{{0.0, 0.0, 0.0}, 0.0}}));
  material::Explosive const& tnt = world.setup.charges[0].explosive;
  double const cj = material::chapman_jouguet(tnt.products, tnt.energy).pressure;
  EXPECT_NEAR(cj, 20.98e9, 0.01e9);
  // The front is still inside the slab at the end and nothing has left.
  advance_to(world, 0.95 * thickness / tnt.detonation_speed);

  GaugeHistory const& first = world.gauges.gas[1];
  for (std::size_t n = 1; n < world.gauges.gas.size(); ++n) {
    GaugeHistory const& gauge = world.gauges.gas[n];
    double const exact = gauge.gauge.position[0] / tnt.detonation_speed;
    EXPECT_NEAR(arrival(gauge) / exact, 1.0, 0.005) << gauge.gauge.name;
    EXPECT_NEAR(peak(gauge) / cj, 1.0, 0.05) << gauge.gauge.name;
    if (n > 1) {
      double const speed = (gauge.gauge.position[0] - first.gauge.position[0]) / (arrival(gauge) - arrival(first));
      EXPECT_NEAR(speed / tnt.detonation_speed, 1.0, 0.001) << gauge.gauge.name;
    }
  }
  world.update_audit();
  auto const error = world.audit.relative_error();
  for (double const of_mass : error.mass) EXPECT_LT(of_mass, 1e-10);
  EXPECT_LT(error.energy, 1e-10);
  EXPECT_EQ(world.audit.guarded_cells, 0);
  EXPECT_GT(world.clock.step, 1000);
}

TEST_F(TntSlab, PeakApproachesTheChapmanJouguetPressureWithTheCellSize) {
  double last = 1.0;
  for (int cells : {100, 400, 1600}) {
    observe::Watched world(slab(cells, {{{0.0, 0.0, 0.0}, 0.0}}));
    material::Explosive const& tnt = world.setup.charges[0].explosive;
    advance_to(world, 0.95 * thickness / tnt.detonation_speed);
    double const deviation =
        std::abs(peak(world.gauges.gas[4]) / material::chapman_jouguet(tnt.products, tnt.energy).pressure - 1.0);
    EXPECT_LT(deviation, last) << cells;
    last = deviation;
  }
}

TEST_F(TntSlab, TwoInitiationPointsWithADelayLightWhatIsNearestInTime) {
  // The second particle fires 5 us later: the waves meet where x / D = delay + (L - x) / D, x = 0.1 m + 2.5 us D.
  double const delay = 5e-6;
  observe::Watched world(slab(400, {{{0.0, 0.0, 0.0}, 0.0}, {{thickness, 0.0, 0.0}, delay}}));
  double const D = world.setup.charges[0].explosive.detonation_speed;
  double const meeting = 0.5 * (thickness + delay * D);
  double const h = world.setup.domain.h;
  ASSERT_NEAR(meeting, 0.117325, 1e-9);
  auto const lit = [&](double x) { return x < meeting ? x / D : delay + (thickness - x) / D; };
  // The burn fraction (t - t_L) D / (1.5 h) of cells that are burning tells their lighting time.
  int seen_left = 0;
  int seen_right = 0;
  int unlit = 0;
  while (world.clock.time < 1.0 * meeting / D + 2.0 * h / D) {
    advance(world, 1.0);
    for (int i = 0; i < 400; ++i) {
      double const x = (i + 0.5) * h;
      double const F = gas::burn_fraction(*world.gas, world.grid.locate(Index3{i, 0, 0}));
      double const expected = std::clamp((world.clock.time - lit(x)) * D / (1.5 * h), 0.0, 1.0);
      EXPECT_NEAR(F, expected, 1e-6) << "x = " << x << ", t = " << world.clock.time;
      if (expected > 0.0 && expected < 1.0) ++(x < meeting ? seen_left : seen_right);
      if (expected == 0.0) ++unlit;
    }
    if (HasFailure()) break;
  }
  EXPECT_GT(seen_left, 200);
  EXPECT_GT(seen_right, 100);
  EXPECT_GT(unlit, 1000);
}

}  // namespace
}  // namespace brisance::run
