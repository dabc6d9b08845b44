// What the audit says of a run: by audits that are made up, and by runs that add energy to themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "../observe/watched.hpp"
#include "cases.hpp"
#include "core/parallel.hpp"
#include "particles_case.hpp"

namespace brisance::run {
namespace {

using Kind = AuditFinding::Kind;

AuditFinding finding(observe::Watched const& world, Kind kind) {
  for (AuditFinding const& f : world.audit_findings()) {
    if (f.kind == kind) return f;
  }
  ADD_FAILURE() << "it has not been looked at";
  return {};
}

/// The one reason why a world does not balance; empty: it does.
std::string reason(observe::Watched const& world) {
  Verdict const verdict = world.verdict();
  EXPECT_EQ(verdict.balanced, verdict.reasons.empty());
  EXPECT_LE(verdict.reasons.size(), 1U);
  return verdict.balanced ? "" : verdict.reasons.front();
}

/// A block of water at rest in empty space. Its energy counts from 0 K and from the pressure
/// that would tear it apart: megajoules that do no work.
Case pool() {
  Case c;
  c.domain.geometry = grid::Geometry::planar2d;
  c.domain.h = 0.05;
  c.domain.cells = {24, 24, 1};
  c.domain.boundary.fill(grid::Boundary::outflow);
  c.end.time = 1.0;
  Body water;
  water.name = "pool";
  water.solid = material::of(*deck::library().fluid("water"));
  water.shape = shape::Box{{0.1, 0.1, 0.0}, {1.1, 0.6, 0.0}};
  c.particles.bodies = {water};
  return c;
}

TEST(Verdict, GuardsAreAnErrorOfTheChargesEnergy) {
  for (int const planes : {0, 1, 3}) {
    Case c = air_case(grid::Geometry::cartesian3d, {20, 20, 20}, 0.02, grid::Boundary::outflow);
    Vec3 centre{0.2, 0.2, 0.2};
    for (int d = 0; d < planes; ++d) {
      c.domain.boundary[2 * d] = grid::Boundary::symmetry;
      centre[d] = 0.0;
    }
    c.charges = {tnt_charge(shape::Sphere{centre, 0.05}, c.domain.geometry)};
    observe::Watched w(c);
    w.update_audit();
    EXPECT_EQ(reason(w), "");
    double const energy = w.charges[0].realised_energy / std::pow(2.0, planes);
    EXPECT_NEAR(finding(w, Kind::guard_energy).scale / energy, 1.0, 1e-12) << "only what lies in the domain counts";
    for (double const sign : {1.0, -1.0}) {
      w.audit.guard_energy = sign * 0.99e-4 * energy;
      w.audit.current.energy = w.audit.initial.energy + w.audit.guard_energy;  // the books close
      EXPECT_EQ(reason(w), "");
      w.audit.guard_energy = sign * 1.01e-4 * energy;
      w.audit.current.energy = w.audit.initial.energy + w.audit.guard_energy;
      EXPECT_NE(reason(w).find("guards added"), std::string::npos) << reason(w);
      EXPECT_NE(reason(w).find("0.0101 % of the energy of the charges"), std::string::npos) << reason(w);
      EXPECT_FALSE(finding(w, Kind::guard_energy).stops());
      w.audit.guard_energy = sign * 1.01e-2 * energy;
      EXPECT_TRUE(finding(w, Kind::guard_energy).stops());
    }
    w.setup.audit.fail = 0.0;
    EXPECT_FALSE(finding(w, Kind::guard_energy).stops());
    EXPECT_TRUE(finding(w, Kind::guard_energy).tells()) << "they are told whatever the deck says";
  }
}

TEST(Verdict, WithoutChargesGuardsCompareWithTheEnergyAboveTheAmbientState) {
  Case c = air_case(grid::Geometry::planar1d, {200, 1, 1}, 0.01, grid::Boundary::wall);
  material::Primitive const ambient = c.ambient.state;
  c.initial_states = {{shape::Box{{0.0, 0.0, 0.0}, {0.5, 0.0, 0.0}}, {3.0, 5.0 * ambient.pressure, {}}, false, ""}};
  observe::Watched w(c);
  w.update_audit();
  double const above = 4.0 * ambient.pressure / 0.4 * 0.5;
  EXPECT_NEAR(finding(w, Kind::guard_energy).scale / above, 1.0, 1e-3) << "0.4 is that of the library's air";
  w.audit.guard_energy = 2e-4 * above;
  w.audit.current.energy = w.audit.initial.energy + w.audit.guard_energy;
  EXPECT_NE(reason(w).find("of the reference energy"), std::string::npos) << reason(w);
  // A region below the ambient state works as well as one above.
  c.initial_states[0].state.pressure = 0.5 * ambient.pressure;
  EXPECT_NEAR(finding(observe::Watched(c), Kind::guard_energy).scale / (0.5 * ambient.pressure / 0.4 * 0.5), 1.0, 1e-3);
  // Nothing is at work in air at rest: round-off is none, all else is.
  c.initial_states.clear();
  observe::Watched still(c);
  still.update_audit();
  EXPECT_EQ(reason(still), "");
  still.audit.guard_energy = 1e-10 * still.audit.initial.energy;
  EXPECT_EQ(reason(still), "");
  still.audit.guard_energy = 1e-8 * still.audit.initial.energy;
  still.audit.current.energy = still.audit.initial.energy + still.audit.guard_energy;
  EXPECT_NE(reason(still).find("guards"), std::string::npos) << reason(still);
}

TEST(Verdict, ExplosiveMayNotBeHitBeforeItIsLit) {
  // Two charges with a gap of air; what the second one's delay is when the first one's products or blast arrive.
  auto const compression = [](double gap, double delay, double until, bool at_the_side = false) {
    grid::Geometry const geometry = grid::Geometry::planar1d;
    Case c = air_case(geometry, {150, 1, 1}, 0.002, grid::Boundary::outflow);
    for (double const x : {0.05, 0.11 + gap}) c.charges.push_back(tnt_charge(shape::Box{{x}, {x + 0.06}}, geometry));
    c.charges.back().initiation.front().delay = delay;
    if (at_the_side) c.charges.back().initiation.front().position[0] = 0.11 + gap;
    observe::Watched w(c);
    while (w.clock.time < until) {
      advance(w, until);
      w.follow_audit();
    }
    w.update_audit();
    AuditFinding const found = finding(w, Kind::unlit);
    EXPECT_EQ(found.tells(), found.amount > 0.05);
    EXPECT_FALSE(found.stops());
    EXPECT_EQ(found.tells(), reason(w).find("before it was initiated") != std::string::npos) << reason(w);
    return found.amount;
  };
  EXPECT_GT(compression(0.0, 20e-6, 20e-6), 0.5) << "by the detonation of its neighbour";
  EXPECT_GT(compression(0.01, 20e-6, 20e-6), 0.5) << "by the products of its neighbour";
  EXPECT_GT(compression(0.05, 40e-6, 40e-6), 0.05) << "by the blast of its neighbour";
  constexpr double none = 1e-6;
  EXPECT_LT(compression(0.05, 2e-6, 60e-6), none) << "it is burnt when the blast arrives";
  EXPECT_LT(compression(0.0, 0.0, 60e-6), none) << "both are lit at once";
  double const arrival = 0.03 / deck::library().explosive("TNT")->detonation_speed;
  EXPECT_LT(compression(0.0, arrival, 60e-6, true), none) << "the detonation of its neighbour lights it";
}

TEST(Verdict, MassThatGuardsAddCountsToo) {
  Case c = air_case(grid::Geometry::spherical1d, {100, 1, 1}, 0.01, grid::Boundary::outflow);
  c.charges = {tnt_charge(shape::Sphere{{}, 0.05}, c.domain.geometry)};
  observe::Watched w(c);
  w.update_audit();
  w.audit.guard_mass = 2e-4 * w.audit.initial.mass[1];
  w.audit.current.mass[0] = w.audit.initial.mass[0] + w.audit.guard_mass;
  EXPECT_NE(reason(w).find("0.02 % of the mass of the charges"), std::string::npos) << reason(w);
}

TEST(Verdict, FluidsMustBalanceToRoundOff) {
  Case c = air_case(grid::Geometry::spherical1d, {100, 1, 1}, 0.01, grid::Boundary::outflow);
  c.charges = {tnt_charge(shape::Sphere{{}, 0.05}, c.domain.geometry)};
  observe::Watched w(c);
  w.update_audit();
  Totals const right = w.audit.current;
  w.audit.current.mass[0] *= 1.0 + 1e-12;
  EXPECT_EQ(reason(w), "");
  w.audit.current.mass[0] = right.mass[0] * (1.0 + 1e-9);
  EXPECT_NE(reason(w).find("the mass of air has a relative error of 1e-09"), std::string::npos) << reason(w);
  w.audit.current = right;
  w.audit.current.mass[1] *= 1.0 - 1e-6;
  EXPECT_NE(reason(w).find("the mass of the second fluid"), std::string::npos) << reason(w);
  w.audit.current = right;
  w.audit.current.energy *= 1.0 + 1e-9;
  EXPECT_NE(reason(w).find("the energy has a relative error"), std::string::npos) << reason(w);
  w.audit.current.energy = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(w.verdict().balanced) << "what is no number does not balance";
}

TEST(Verdict, APoolAtRestBalancesAndOneThatGainsEnergyDoesNot) {
  observe::Watched w(pool());
  w.update_audit();
  ASSERT_GT(w.audit.initial.energy, 1e8) << "the internal energy of water is large";
  EXPECT_EQ(reason(w), "");
  w.audit.current.energy += 1e-10 * w.audit.initial.energy;  // round-off
  EXPECT_EQ(reason(w), "");
  // 2e-8 of all energy.
  w.audit.current.energy = w.audit.initial.energy + 26.0;
  w.audit.current.kinetic_energy = 26.0;
  EXPECT_NE(reason(w).find("drifted by +26 J, +100 % of the reference energy"), std::string::npos) << reason(w);
  EXPECT_TRUE(finding(w, Kind::drift).stops());
}

TEST(Verdict, TheDriftComparesWithTheLargestEnergyAtWorkSoFar) {
  observe::Watched w(pool());
  w.update_audit();
  // It moved with 10 kJ and has come to rest but for an error of 0.4 %, then of 0.6 %.
  w.audit.memory.scale = 1e4;
  w.audit.current.energy -= 40.0;
  EXPECT_EQ(reason(w), "");
  w.audit.current.energy -= 20.0;
  EXPECT_NE(reason(w).find("-0.6 %"), std::string::npos) << reason(w);
  EXPECT_FALSE(finding(w, Kind::drift).stops());
  // What has come and gone counts.
  w.audit.current.energy = w.audit.initial.energy;
  EXPECT_EQ(reason(w), "");
  w.audit.memory.drift = 70.0;
  EXPECT_NE(reason(w).find("+0.7 %"), std::string::npos) << reason(w);
  w.audit.memory.drift = -510.0;
  EXPECT_TRUE(finding(w, Kind::drift).stops());
}

TEST(Verdict, TheDeckSaysHowFarTheEnergyMayDrift) {
  observe::Watched w(pool());
  w.update_audit();
  w.audit.memory.scale = 1e4;
  w.audit.memory.drift = 700.0;
  EXPECT_TRUE(finding(w, Kind::drift).stops());
  w.setup.audit = {0.08, 0.1};
  EXPECT_EQ(reason(w), "");
  EXPECT_FALSE(finding(w, Kind::drift).stops());
  w.setup.audit = {0.005, 0.0};
  EXPECT_NE(reason(w), "");
  EXPECT_FALSE(finding(w, Kind::drift).stops());
  w.setup.audit = {0.0, 0.0};
  EXPECT_EQ(reason(w), "");
  EXPECT_FALSE(w.verdict().drift_judged) << "not said is not balanced";
}

// What burns is at work from the start, an explosive's energy as that of a gas in empty space; that of a solid is not.
TEST(Verdict, KnowsWhatIsAtWork) {
  observe::Watched const slab(charge_slab());
  EXPECT_NEAR(slab.energy_balance().scale / (4.29e6 * 1630.0 * 0.02), 1.0, 1e-9);
  observe::Watched const blocks(two_blocks());
  double const kinetic = 0.5 * 8930.0 * 4e-4 * 1e4;
  double const gas = 1e5 / 0.4 * 1e-4;
  EXPECT_NEAR(blocks.energy_balance().scale, kinetic + gas, 1e-6 * kinetic);
  observe::Watched const w(pool());
  EXPECT_LT(w.energy_balance().scale, 1e-12 * w.energy_balance().all);
}

// With gas around, bodies and gas alike count from the ambient state.
TEST(Verdict, KnowsWhatIsAtWorkInARegion) {
  Case c = air_case(grid::Geometry::planar2d, {48, 48, 1}, 0.01, grid::Boundary::outflow);
  Body plate;
  plate.name = "plate";
  plate.solid = material::elastic_solid(2700.0, 70e9, 0.3);
  plate.shape = shape::Box{{0.22, 0.2, 0.0}, {0.26, 0.28, 0.0}};
  c.particles.bodies = {plate};
  c.mpm_regions.emplace_back();
  c.mpm_regions.front().boxes = {shape::Box{{0.1, 0.1, 0.0}, {0.38, 0.38, 0.0}}};
  observe::Watched const still(c);
  EXPECT_LT(still.energy_balance().scale, 1e-12 * still.energy_balance().all);
  EXPECT_FALSE(still.for_comparison());
  c.initial_states = {{shape::Box{{0.0, 0.0, 0.0}, {0.05, 0.48, 0.0}}, {2.0, 3e5, {}}, false, ""}};
  double const above = (3e5 - c.ambient.state.pressure) / 0.4 * 0.05 * 0.48;
  EXPECT_NEAR(observe::Watched(c).energy_balance().scale / above, 1.0, 1e-3);
  c.mpm_regions.front().transport = bridge::Transport::paper;
  EXPECT_TRUE(observe::Watched(c).for_comparison());
  c.mpm_regions.front().transport = bridge::Transport::ledger;
  c.numerics.scheme = Scheme::lax_wendroff;
  EXPECT_TRUE(observe::Watched(c).for_comparison());
}

// The ledger holds half a particle of each lane; gas that gathers there belongs to neither side.
TEST(Verdict, GasInTheLedgerIsAnError) {
  Case c = air_case(grid::Geometry::planar1d, {200, 1, 1}, 0.005, grid::Boundary::wall);
  c.mpm_regions.emplace_back();
  c.mpm_regions.front().boxes = {shape::Box{{0.4, 0.0, 0.0}, {0.6, 0.0, 0.0}}};
  c.initial_states = {{shape::Box{{0.0, 0.0, 0.0}, {0.25, 0.0, 0.0}}, {2.0, 1.5e5, {}}, false, ""}};
  c.end.time = 2e-3;
  observe::Watched w(c);
  while (!w.finished()) {
    advance(w, c.end.time);
    w.follow_audit();
  }
  EXPECT_EQ(w.audit.memory.surplus, 0.0) << "one passage of a weak wave";
  EXPECT_GT(w.regions.front().bridge->ledger().total(), 0.0);
  double const gas = w.audit.memory.gas;
  EXPECT_NEAR(gas, 0.2 * 1.225, 0.1);
  w.audit.memory.surplus = 0.009 * gas;
  EXPECT_FALSE(finding(w, Kind::ledger).tells());
  w.audit.memory.surplus = 0.011 * gas;
  EXPECT_NE(reason(w).find("the ledger contains"), std::string::npos) << reason(w);
  w.audit.memory.surplus = 0.06 * gas;
  EXPECT_TRUE(finding(w, Kind::ledger).stops());
}

// Blocks that meet lose less the finer their cells are. The loss is known and no drift, but it is told when it is
// large.
// Velocities stand half a step before positions: in the first steps of a fall or a load that is a large part of all
// there is, whenever it begins.
TEST(FollowAudit, FirstMomentsOfALoadAreNoDrift) {
  Case rest = two_blocks();
  rest.particles.bodies.resize(2);
  rest.particles.gauges.clear();
  for (Body& body : rest.particles.bodies) body.velocity = {0.0, 0.0, 0.0};
  Case fall = rest;
  fall.particles.options.body_force = {0.0, -1e7, 0.0};
  fall.end.time = 10e-6;
  Case push = rest;
  push.particles.pressures = {{}};
  mpm::SurfacePressure& load = push.particles.pressures.front();
  load.body = 1;
  load.within = shape::Box{{0.042, 0.0, 0.0}, {0.043, 0.03, 0.0}};
  load.normal = {1.0, 0.0, 0.0};
  load.thickness = 1e-3;
  load.times = {2.03e-6, 30e-6};
  load.pressures = {0.0, 1e8};
  set_threads(1);
  for (Case const& c : {fall, push}) {
    for (double const end_time : {c.end.time, 1e3}) {  // looks by the time are rare, or none
      observe::Watched w(c);
      w.setup.end.time = end_time;
      while (w.clock.time < c.end.time) {
        advance(w, c.end.time);
        ASSERT_NO_THROW(w.follow_audit()) << w.clock.step;
      }
      w.update_audit();
      EXPECT_GT(w.energy_balance().scale, 0.0);
      EXPECT_EQ(reason(w), "");
    }
  }
}

TEST(FollowAudit, StopsWhereTheEnergyRunsAway) {
  set_threads(1);
  Case c = two_blocks();
  observe::Watched w(c);
  auto const heat = [&](double part) {
    mpm::ParticleSet& set = w.regions.front().particles->particles(
        w.regions.front().particles->grid().block_of(w.regions.front().particles->grid().cell_at({0.03, 0.012, 0.0})),
        1);
    ASSERT_GT(set.size(), 0);
    set.field(mpm::Field::energy)[0] += part * w.audit.memory.scale / set.field(mpm::Field::mass)[0];
  };
  while (w.clock.step < 30) {
    advance(w, c.end.time);
    w.follow_audit();
  }
  EXPECT_EQ(reason(w), "");
  heat(0.04);
  advance(w, c.end.time);
  EXPECT_NO_THROW(w.follow_audit());
  heat(0.05);
  advance(w, c.end.time);
  try {
    w.follow_audit();
    FAIL() << "it went on";
  } catch (NumericalError const& stopped) {
    std::string const said = stopped.what();
    EXPECT_NE(said.find("the energy has drifted by +"), std::string::npos) << said;
    EXPECT_NE(said.find("`fail = 0` in [audit]"), std::string::npos) << said;
  }
  w.setup.audit.fail = 0.0;
  EXPECT_NO_THROW(w.follow_audit());
  EXPECT_FALSE(w.verdict().balanced);
}

// What the audit remembers does not depend on threads, nor on what is written and when.
TEST(FollowAudit, RemembersTheSameWhateverIsWritten) {
  Case c = air_case(grid::Geometry::planar2d, {40, 16, 1}, 0.01, grid::Boundary::wall);
  c.mpm_regions.emplace_back();
  c.mpm_regions.front().boxes = {shape::Box{{0.16, 0.0, 0.0}, {0.4, 0.16, 0.0}}};
  c.particles.options.block_cells = 8;
  c.initial_states = {{shape::Box{{0.0, 0.0, 0.0}, {0.1, 0.08, 0.0}}, {12.0, 4e6, {0.0, 0.0, 0.0}}, false, ""}};
  c.end.time = 0.1;  // the looks by the time are far apart, those by steps are not
  std::vector<double> first;
  for (int const count : {1, 2}) {
    set_threads(count);
    observe::Watched w(c);
    while (w.clock.step < 66) {
      advance(w, c.end.time);
      w.follow_audit();
      if (count == 1) continue;
      w.update_audit();
      w.sample_gauges();
    }
    AuditMemory const& m = w.audit.memory;
    std::vector<double> const all{m.scale, m.all, m.drift, m.content, m.surplus, m.gas};
    if (first.empty()) first = all;
    EXPECT_EQ(all, first) << count << " threads";
    EXPECT_NE(m.drift, 0.0);
    EXPECT_GT(m.gas, 0.0);
  }
  set_threads(1);
}

}  // namespace
}  // namespace brisance::run
