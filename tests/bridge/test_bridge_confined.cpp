// Waves that come back: gas in closed tubes and rooms, where what one passage leaves behind would add up.
#include "bridge/harness.hpp"

namespace brisance::test {
namespace {

/// Air in a closed tube of 1 m, a quarter of it under pressure.
run::Case tube(double pressure) {
  auto c = coupled_case(grid::Geometry::planar1d, {200, 1, 1}, grid::Boundary::wall);
  c.ambient.state = {1.225, 101325.0, {0.0, 0.0, 0.0}};
  run::InitialState filled;
  filled.shape = shape::Box{{-1.0, -1.0, -1.0}, {0.25, 1.0, 1.0}};
  filled.state = {1.225, pressure, {0.0, 0.0, 0.0}};
  c.initial_states = {filled};
  c.numerics.density_floor = 1e-6;
  c.numerics.pressure_floor = 1.0;
  c.end.time = 1.0;
  return c;
}

/// Mean pressure of all that is gas, from its internal energy [Pa].
double mean_pressure(run::World const& w) {
  run::Totals const t = w.totals();
  return 0.4 * (t.energy - t.kinetic_energy) / 1.0;
}

/// Most that an account holds, in particles of the gas beside it.
double fullest_account(run::World const& w) {
  bridge::Bridge const& bridge = *w.regions.front().bridge;
  double most = 0.0;
  std::size_t const lanes = bridge.accounts().size() / bridge.region().faces().size();
  for (std::size_t n = 0; n < bridge.accounts().size(); ++n) {
    bridge::Face const& face = bridge.region().faces()[n / lanes];
    double const density = gas::gather(*w.gas, {face.outside()})[0].density;
    double const particle = density * w.grid.domain().h / w.setup.mpm_regions.front().gas_particles(1);
    most = std::max(most, std::abs(bridge.accounts()[n].total()) / particle);
  }
  return most;
}

struct Placing {
  char const* name;
  int lower;
  int upper;
};

class Confined : public testing::TestWithParam<Placing> {};

INSTANTIATE_TEST_SUITE_P(Tubes, Confined,
                         testing::Values(Placing{"InTheMiddle", 80, 120}, Placing{"OffTheCentre", 20, 70},
                                         Placing{"AtAWall", 140, 200}),
                         [](auto const& one) { return one.param.name; });

// 40 ms are 13 to 40 passages of the tube. Wanted: energy within 1 %, mean pressure within 2 % of the gas alone, no
// account beyond two particles; measured 0.04 and 0.06 %. Without feedback the energy is off by 7 % at 5 bar and runs
// away at 20, with the volumes of the particles left alone by 7 and 160 %.
TEST_P(Confined, TubeKeepsItsEnergy) {
  for (double const bar : {2.0, 5.0, 20.0, 50.0}) {
    auto c = tube(1e5 * bar);
    auto gas_alone = c;
    gas_alone.mpm_regions.clear();
    run::World alone = setup::build(gas_alone);
    run_to(alone, 0.04);
    set_region(c, {GetParam().lower, 0, 0}, {GetParam().upper, 1, 1});
    run::World w = setup::build(c);
    run::Totals const before = w.totals();
    double fullest = 0.0;
    run_to(w, 0.04, [&](run::World& now) { fullest = std::max(fullest, fullest_account(now)); });
    Balance const b = balance_of(w, before);
    double const pressure = mean_pressure(w) / mean_pressure(alone);
    std::printf(
        "%s, %g bar: mean pressure %.4f of gas alone; energy %+.1e, mass %.1e; the fullest account held %.2f points, "
        "in "
        "the end all hold %+.1e of the gas; surplus %.1e kg\n",
        GetParam().name, bar, pressure, w.audit.current.energy / before.energy - 1.0, b.mass, fullest,
        w.regions.front().bridge->ledger().total() / before.mass[0], w.regions.front().bridge->surplus());
    EXPECT_NEAR(pressure, 1.0, 0.005);
    EXPECT_LT(b.energy, 0.002);
    EXPECT_LE(b.mass, mass_tolerance);
    EXPECT_LT(fullest, 2.0);
  }
}

/// A square room of 1 m with a ball of hot gas that is off every axis.
run::Case room(grid::Boundary boundary) {
  auto c = coupled_case(grid::Geometry::planar2d, {50, 50, 1}, boundary);
  c.ambient.state = {1.225, 101325.0, {0.0, 0.0, 0.0}};
  run::InitialState ball;
  ball.shape = shape::Sphere{{0.27, 0.41, 0.0}, 0.1};
  ball.state = {5.0, 5e6, {0.0, 0.0, 0.0}};
  c.initial_states = {ball};
  c.numerics.density_floor = 1e-6;
  c.numerics.pressure_floor = 1.0;
  c.end.time = 1.0;
  c.mpm_regions.front().activation = -1.0;
  return c;
}

// Edges, corners and periodic faces: whatever gas and particles give each other stands in some account. The region as a
// box, as an L, and as a band right across the periodic direction.
TEST(Confined, MomentumIsKeptToRoundOff) {
  using Boxes = std::vector<std::array<Index3, 2>>;
  for (Boxes const& boxes :
       {Boxes{{{{16, 15, 0}, {36, 37, 1}}}}, Boxes{{{{14, 14, 0}, {46, 30, 1}}}, {{{14, 30, 0}, {30, 46, 1}}}},
        Boxes{{{{14, 0, 0}, {40, 50, 1}}}}}) {
    auto c = room(grid::Boundary::periodic);
    for (auto const& box : boxes) set_region(c, box[0], box[1]);
    run::World w = setup::build(c);
    double largest = 0.0;
    Vec3 before = w.totals().momentum;
    run_to(w, 0.002, [&](run::World& now) { largest = std::max(largest, norm(now.totals().momentum - before)); });
    double const scale = std::sqrt(2.0 * w.totals().energy * w.totals().mass[0]);
    std::printf("%zu boxes: momentum changes by %.1e of what there is; %ld points injected\n", boxes.size(),
                largest / scale, w.regions.front().bridge->traffic().injected);
    EXPECT_LT(largest / scale, 1e-13);
    EXPECT_GT(w.regions.front().bridge->traffic().injected, 1000);
  }
}

// A closed room in the plane: 10 ms are some ten passages, at all angles.
TEST(Confined, RoomKeepsItsEnergy) {
  auto c = room(grid::Boundary::wall);
  auto gas_alone = c;
  gas_alone.mpm_regions.clear();
  run::World alone = setup::build(gas_alone);
  run_to(alone, 0.01);
  set_region(c, {20, 16, 0}, {38, 36, 1});
  run::World w = setup::build(c);
  run::Totals const before = w.totals();
  run_to(w, 0.01);
  Balance const b = balance_of(w, before);
  double const pressure = mean_pressure(w) / mean_pressure(alone);
  std::printf("room: mean pressure %.4f of gas alone; energy %+.1e, mass %.1e; surplus %.1e of the gas\n", pressure,
              w.audit.current.energy / before.energy - 1.0, b.mass,
              w.regions.front().bridge->surplus() / before.mass[0]);
  EXPECT_NEAR(pressure, 1.0, 0.01);
  EXPECT_LT(b.energy, 0.003);
  EXPECT_LE(b.mass, mass_tolerance);
}

}  // namespace
}  // namespace brisance::test
