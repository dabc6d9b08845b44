// Charges that burn and break out, as decks of them run: no guard, peaks that do not hang on the step, and an afterburn
// that only does something where it has energy. All combinations: scripts/matrix.
#include <gtest/gtest.h>

#include <cmath>

#include "../observe/watched.hpp"
#include "cases.hpp"

namespace brisance::run {
namespace {

constexpr double radius = 0.05;

Case burst(std::string const& explosive, grid::Geometry geometry, int cells_per_radius, double density, double pressure,
           double courant) {
  int const n = 4 * cells_per_radius;
  Case c = air_case(geometry, {n, n, 1}, radius / cells_per_radius, grid::Boundary::outflow);
  c.domain.boundary[0] = c.domain.boundary[2] = grid::Boundary::symmetry;
  c.ambient.state.density = density;
  c.ambient.state.pressure = pressure;
  c.numerics.courant = courant;
  c.output.peak_fields = false;
  shape::Shape const shape = geometry == grid::Geometry::planar2d
                                 ? shape::Shape{shape::Cylinder{{0.0, 0.0, 0.0}, radius, 1.0, {0.0, 0.0, 1.0}}}
                                 : shape::Shape{shape::Sphere{{0.0, 0.0, 0.0}, radius}};
  Charge charge = tnt_charge(shape, geometry);
  charge.explosive = *deck::library().explosive(explosive);
  charge.mass = charge.explosive.density() * shape::volume(shape, geometry);
  c.charges = {charge};
  c.gauges = {{"axis", {0.1, 0.002, 0.0}}, {"near", {0.067, 0.067, 0.0}}, {"far", {0.112, 0.112, 0.0}}};
  return c;
}

std::vector<double> peaks(observe::Watched const& world) {
  std::vector<double> all;
  for (GaugeHistory const& gauge : world.gauges.gas) {
    double most = 0.0;
    for (GaugeRecord const& record : gauge.records) most = std::max(most, record.pressure);
    all.push_back(most - world.setup.ambient.state.pressure);
  }
  return all;
}

TEST(Bursts, TheAirWaitsForTheDetonation) {
  // What the front pushes out of the charge ahead of itself must not burn before the charge does there.
  for (auto const geometry : {grid::Geometry::planar2d, grid::Geometry::axisymmetric2d}) {
    for (int const cells : {4, 7, 12}) {
      double const pressure = 101325.0;
      observe::Watched world(burst("LX-10", geometry, cells, 1.225, pressure, 0.8));
      double const h = world.setup.domain.h;
      double const speed = world.setup.charges[0].explosive.detonation_speed;
      // The front is about to reach the last full cells on the axis.
      advance_to(world, (radius - 1.5 * h) / speed);
      double most = 0.0;
      for (int j = 0; j < world.setup.domain.cells[1]; ++j) {
        for (int i = 0; i < world.setup.domain.cells[0]; ++i) {
          if (norm(world.setup.domain.centre({i, j, 0})) < radius + h) continue;
          most = std::max(most, gas::gather(*world.gas, {{i, j, 0}})[0].pressure);
        }
      }
      // Traces burn at once; they raise the pressure by three times that of the air at most.
      EXPECT_LT(most, 4.0 * pressure) << cells << " cells per radius";
    }
  }
}

TEST(Bursts, NeedNoGuardAndDoNotHangOnTheStep) {
  struct Air {
    double density, pressure;
  };
  // Air at sea level, 20 and 32 km [ISO 2533], as `[ambient] altitude` gives it.
  for (Air const air : {Air{1.225, 101325.0}, Air{0.08803, 5475.0}, Air{0.01356, 868.0}}) {
    for (auto const geometry : {grid::Geometry::planar2d, grid::Geometry::axisymmetric2d}) {
      for (char const* const explosive : {"TNT", "PETN-1.77"}) {
        for (int const cells : {6, 9}) {
          std::array<std::vector<double>, 2> found;
          for (int const s : {0, 1}) {
            observe::Watched world(burst(explosive, geometry, cells, air.density, air.pressure, s == 0 ? 0.8 : 0.2));
            advance_to(world, 30e-6);
            world.update_audit();
            EXPECT_EQ(world.audit.guarded_cells, 0) << explosive << " " << cells;
            EXPECT_EQ(world.audit.guard_energy, 0.0);
            found[s] = peaks(world);
          }
          for (std::size_t g = 0; g < found[0].size(); ++g) {
            EXPECT_NEAR(found[0][g] / found[1][g], 1.0, 0.15)
                << explosive << " " << word_of(geometry) << " " << cells << " gauge " << g;
          }
        }
      }
    }
  }
}

/// 3 kg of an explosive along a radius, with fine cells.
Case fine(char const* explosive, std::optional<material::Afterburn> const& afterburn) {
  Case c = air_case(grid::Geometry::spherical1d, {1200, 1, 1}, 0.5e-3, grid::Boundary::outflow);
  c.domain.boundary[0] = grid::Boundary::symmetry;
  shape::Shape const ball = shape::Sphere{{0.0, 0.0, 0.0}, 0.0762};
  Charge charge = tnt_charge(ball, c.domain.geometry);
  charge.explosive = *deck::library().explosive(explosive);
  charge.mass = charge.explosive.density() * shape::volume(ball, c.domain.geometry);
  c.charges = {charge};
  c.afterburn = afterburn;
  c.output.peak_fields = false;
  c.gauges = {{"gauge", {0.3, 0.0, 0.0}}};
  return c;
}

TEST(Afterburn, WithoutEnergyChangesNoBit) {
  observe::Watched plain(fine("TNT", {}));
  observe::Watched constant(fine("TNT", material::Afterburn{0.0, material::ConstantRateAfterburn{50e-6, 20e-3}}));
  observe::Watched miller(fine("TNT", material::Afterburn{0.0, material::MillerAfterburn{}}));
  for (observe::Watched* world : {&plain, &constant, &miller}) advance_to(*world, 90e-6);
  for (observe::Watched const* world : {&constant, &miller}) {
    EXPECT_EQ(world->clock.step, plain.clock.step);
    auto const& a = plain.gauges.gas[0].records;
    auto const& b = world->gauges.gas[0].records;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t n = 0; n < a.size(); ++n) {
      ASSERT_EQ(a[n].time, b[n].time);
      ASSERT_EQ(a[n].pressure, b[n].pressure);
    }
  }
}

TEST(Afterburn, KeepsItsStepOnFineCells) {
  // Miller's law with its default constants.
  observe::Watched plain(fine("C-4", {}));
  observe::Watched burning(fine("C-4", material::Afterburn{10e6, material::MillerAfterburn{}}));
  double least = 1.0;
  auto const follow = [](observe::Watched& world, double& shortest) {
    world.setup.end.time = 120e-6;
    shortest = 1.0;
    while (!world.finished()) {
      double const dt = advance(world, 120e-6);
      if (world.clock.step > 10 && !world.finished()) shortest = std::min(shortest, dt);
    }
  };
  double least_plain = 1.0;
  follow(plain, least_plain);
  follow(burning, least);
  EXPECT_GT(least, 0.1 * least_plain);
  burning.update_audit();
  EXPECT_EQ(burning.audit.guarded_cells, 0);
  EXPECT_GT(burning.audit.afterburn_energy, 0.0);
}

}  // namespace
}  // namespace brisance::run
