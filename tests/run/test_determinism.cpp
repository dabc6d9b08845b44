// A 3D burst in a closed box of several blocks: the same bits for any number of threads and with or without sleeping
// blocks, and nothing is lost.
#include <gtest/gtest.h>

#include <cstring>

#include "../observe/watched.hpp"
#include "cases.hpp"
#include "core/parallel.hpp"
#include "observe/gas_fields.hpp"

namespace brisance::run {
namespace {

/// What is released in the 120 steps of the runs: with Miller's law all, at a constant rate a part.
material::Afterburn const miller{1e7, material::MillerAfterburn{6500.0 * 30.0, 100e9, 0.5, 1.0 / 6.0, 1e5}};
material::Afterburn const constant_rate{1e7, material::ConstantRateAfterburn{40e-6, 1e-3}};

Case burst(Scheme scheme, bool sleep, std::optional<material::Afterburn> const& afterburn = {}) {
  Case c = air_case(grid::Geometry::cartesian3d, {40, 24, 24}, 0.02, grid::Boundary::wall);
  c.domain.boundary[2] = grid::Boundary::symmetry;
  c.numerics.scheme = scheme;
  c.numerics.sleep = sleep;
  c.numerics.block_cells = 8;
  c.afterburn = afterburn;
  Charge charge = tnt_charge(shape::Sphere{{0.19, 0.0, 0.21}, 0.053}, c.domain.geometry);
  charge.initiation = {{{0.17, 0.0, 0.21}, 0.0}, {{0.22, 0.01, 0.2}, 3e-6}};
  c.charges = {charge};
  c.obstacles = {{"block", shape::Box{{0.44, 0.0, 0.0}, {0.56, 0.2, 0.3}}}};
  c.gauges = {{"near", {0.3, 0.1, 0.2}}, {"top", {0.5, 0.11, 0.31}}, {"far", {0.77, 0.4, 0.4}}};
  return c;
}

struct Outcome {
  std::vector<double> fields;  ///< all components of all blocks, then the peak fields
  std::vector<double> gauges;
  std::array<double, 3> audit_error{};
  std::vector<double> outflow;
  double afterburn_energy = 0.0;
  double charge = 0.0;  ///< mass of the products [kg]
  long fewest_active = 0;
  long cells = 0;
  long steps = 0;
};

Outcome run_case(Case const& c, int thread_count) {
  set_threads(thread_count);
  observe::Watched world(c);
  Outcome out;
  out.cells = world.setup.domain.cell_count();
  out.fewest_active = out.cells;
  world.sample_gauges();
  while (world.clock.step < 120) {
    advance(world, 1.0);
    world.sample_gauges();
    out.fewest_active = std::min(out.fewest_active, world.active_cells());
  }
  out.steps = world.clock.step;
  for (int b = 0; b < world.grid.block_count(); ++b) {
    int const count = world.grid.blocks()[b].cell_count();
    for (int component = 0; component < world.gas->fields().components(); ++component) {
      double const* values = world.gas->fields().at(b, component);
      out.fields.insert(out.fields.end(), values, values + count);
    }
    std::vector<double> peak;
    for (char const* name : {"peak_overpressure", "impulse"}) {
      block_field(world, b, name, peak);
      out.fields.insert(out.fields.end(), peak.begin(), peak.end());
    }
  }
  for (GaugeHistory const& gauge : world.gauges.gas) {
    for (GaugeRecord const& r : gauge.records) {
      out.gauges.insert(out.gauges.end(), {r.time, r.pressure, r.density, r.velocity[0], r.velocity[1], r.velocity[2]});
    }
  }
  world.update_audit();
  auto const error = world.audit.relative_error();
  out.audit_error = {error.mass[0], error.mass[1], error.energy};
  Totals const& lost = world.audit.outflow;
  out.outflow = {lost.mass[0], lost.mass[1], lost.momentum[0], lost.momentum[1], lost.momentum[2], lost.energy};
  out.afterburn_energy = world.audit.afterburn_energy;
  out.charge = world.audit.initial.mass[1];
  set_threads(0);
  return out;
}

Outcome run_burst(Scheme scheme, bool sleep, int thread_count,
                  std::optional<material::Afterburn> const& afterburn = {}) {
  return run_case(burst(scheme, sleep, afterburn), thread_count);
}

bool same_bits(std::vector<double> const& a, std::vector<double> const& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// Everything that can disturb a wind, in one deck: a charge that is lit late, a region that moves otherwise, an
/// obstacle, a wall, a symmetry plane, an inflow and open faces.
Case in_the_wind(Scheme scheme, bool sleep) {
  Case c = burst(scheme, sleep);
  c.domain.boundary = {grid::Boundary::inflow,  grid::Boundary::outflow,       grid::Boundary::symmetry,
                       grid::Boundary::outflow, grid::Boundary::zero_gradient, grid::Boundary::wall};
  c.ambient.state.velocity = {60.0, 0.0, 0.0};
  c.inflow.fill(c.ambient.state);
  c.charges.front().initiation = {{{0.17, 0.0, 0.21}, 40e-6}};
  c.initial_states = {{shape::Box{{0.7, 0.3, 0.3}, {0.8, 0.4, 0.4}}, c.ambient.state, 0, ""}};
  c.initial_states.front().state.velocity = {0.0, 0.0, 0.0};
  return c;
}

class Burst3d : public testing::TestWithParam<Scheme> {};

TEST_P(Burst3d, GivesTheSameBitsForAnyNumberOfThreadsAndWithSleepOnAndOff) {
  Outcome const reference = run_burst(GetParam(), true, 1);
  EXPECT_LT(reference.fewest_active, reference.cells) << "no block ever slept: the comparison would prove nothing";
  EXPECT_GT(*std::max_element(reference.gauges.begin(), reference.gauges.end()), 1e6) << "the wave met no gauge";
  for (int count : {2, 4}) {
    Outcome const other = run_burst(GetParam(), true, count);
    EXPECT_TRUE(same_bits(reference.gauges, other.gauges)) << count << " threads";
    EXPECT_TRUE(same_bits(reference.fields, other.fields)) << count << " threads";
  }
  Outcome const awake = run_burst(GetParam(), false, 4);
  EXPECT_EQ(awake.fewest_active, awake.cells);
  EXPECT_TRUE(same_bits(reference.gauges, awake.gauges)) << "sleep off";
  EXPECT_TRUE(same_bits(reference.fields, awake.fields)) << "sleep off";
}

TEST_P(Burst3d, GivesTheSameBitsInAWindWithSleepOnAndOff) {
  Outcome const asleep = run_case(in_the_wind(GetParam(), true), 2);
  Outcome const awake = run_case(in_the_wind(GetParam(), false), 2);
  EXPECT_LT(asleep.fewest_active, asleep.cells) << "no block ever slept: the comparison would prove nothing";
  EXPECT_EQ(awake.fewest_active, awake.cells);
  EXPECT_TRUE(same_bits(asleep.gauges, awake.gauges));
  EXPECT_TRUE(same_bits(asleep.fields, awake.fields));
  EXPECT_TRUE(same_bits(asleep.outflow, awake.outflow)) << "what sleeping blocks let through is not booked";
  for (double error : asleep.audit_error) EXPECT_LT(error, 1e-12);
}

TEST_P(Burst3d, LosesNothingInAClosedBox) {
  Outcome const out = run_burst(GetParam(), true, 1);
  EXPECT_GT(out.steps, 100);
  for (double error : out.audit_error) EXPECT_LT(error, 1e-12);
}

class Afterburn3d : public testing::TestWithParam<material::Afterburn> {};

TEST_P(Afterburn3d, GivesTheSameBitsForAnyNumberOfThreadsAndWithSleepOnAndOff) {
  auto const scheme = Scheme::muscl_hancock;
  Outcome const reference = run_burst(scheme, true, 1, GetParam());
  EXPECT_LT(reference.fewest_active, reference.cells) << "no block ever slept: the comparison would prove nothing";
  EXPECT_GT(reference.afterburn_energy, 0.05 * GetParam().energy * reference.charge) << "next to nothing was released";
  for (int count : {2, 4}) {
    Outcome const other = run_burst(scheme, true, count, GetParam());
    EXPECT_TRUE(same_bits(reference.gauges, other.gauges)) << count << " threads";
    EXPECT_TRUE(same_bits(reference.fields, other.fields)) << count << " threads";
    EXPECT_EQ(reference.afterburn_energy, other.afterburn_energy) << count << " threads";
  }
  Outcome const awake = run_burst(scheme, false, 4, GetParam());
  EXPECT_TRUE(same_bits(reference.gauges, awake.gauges)) << "sleep off";
  EXPECT_TRUE(same_bits(reference.fields, awake.fields)) << "sleep off";
  EXPECT_EQ(reference.afterburn_energy, awake.afterburn_energy) << "sleep off";
}

TEST_P(Afterburn3d, IsBookedInAClosedBox) {
  for (Scheme const scheme : {Scheme::muscl_hancock, Scheme::lax_wendroff}) {
    Outcome const out = run_burst(scheme, true, 2, GetParam());
    for (double error : out.audit_error) EXPECT_LT(error, 1e-12);
  }
}

std::string model_name(testing::TestParamInfo<material::Afterburn> const& info) {
  return info.param.carried() ? "Miller" : "ConstantRate";
}

INSTANTIATE_TEST_SUITE_P(Models, Afterburn3d, testing::Values(miller, constant_rate), model_name);

std::string scheme_name(testing::TestParamInfo<Scheme> const& info) {
  return info.param == Scheme::muscl_hancock ? "MusclHancock" : "LaxWendroff";
}

INSTANTIATE_TEST_SUITE_P(Schemes, Burst3d, testing::Values(Scheme::muscl_hancock, Scheme::lax_wendroff), scheme_name);

}  // namespace
}  // namespace brisance::run
