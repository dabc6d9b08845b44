// What is read off the history of a gauge: made-up waves whose values are known, and blasts on coarse cells against
// the same blasts on fine ones.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "../run/cases.hpp"
#include "material/hugoniot.hpp"
#include "observe/blast_wave.hpp"
#include "observe/expected_peak.hpp"
#include "observe/positive_phase.hpp"
#include "output/gauges.hpp"
#include "watched.hpp"

namespace brisance::observe::test {
namespace {

using namespace output;

using grid::Boundary;
using grid::Geometry;

constexpr double cell = 0.01;
constexpr double cell_time = cell / 340.0;  // of a sound wave

Surroundings air() { return {material::IdealGas{1.4}, 1.225, 101325.0, cell, {}}; }

template <class Wave>
BlastWave read(Wave const& wave, double end, double step, Surroundings const& around) {
  std::vector<double> time;
  std::vector<double> overpressure;
  for (int i = 0; i * step <= end; ++i) {
    time.push_back(i * step);
    overpressure.push_back(wave(i * step));
  }
  return analyse_blast(time, overpressure, &around);
}

/// Decay behind a front at `arrival` that is captured over `cells` cells.
double captured(double t, double arrival, double peak, double decay, double cells) {
  double const rise = 0.5 * (1.0 + std::tanh((t - arrival) / (0.5 * cells * cell_time)));
  return peak * rise * std::exp(-std::max(0.0, t - arrival) / decay);
}

TEST(Front, BlastIsReadAndSlowerWavesAreNot) {
  double const decay = 60.0 * cell_time;
  double const end = 400.0 * cell_time;
  double const step = 0.4 * cell_time;
  double const at = 100.0 * cell_time;
  auto const control = read([&](double t) { return captured(t, at, 5e4, decay, 2.0); }, end, step, air());
  ASSERT_TRUE(control.front_overpressure && control.peak_front_overpressure && control.cells_per_half_width);
  EXPECT_NEAR(*control.front_overpressure / 5e4, 1.0, 0.02);
  // The shock of 50 kPa is 1.195 times as fast as sound.
  EXPECT_NEAR(*control.cells_per_half_width / (60.0 * std::log(2.0) * 1.195), 1.0, 0.03);

  auto const no_front = [&](char const* what, auto const& wave) {
    auto const w = read(wave, end, step, air());
    EXPECT_TRUE(w.arrival_time) << what;
    EXPECT_FALSE(w.front_overpressure) << what << ' ' << *w.front_overpressure;
    EXPECT_FALSE(w.peak_front_overpressure) << what << ' ' << *w.peak_front_overpressure;
    return w;
  };
  auto const slow = [&](char const* what, auto const& wave) {
    auto const w = no_front(what, wave);
    EXPECT_FALSE(w.cells_per_half_width) << what;
    EXPECT_FALSE(w.expected_clipping) << what;
  };
  slow("compression over 40 cells, then the decay of the control", [&](double t) {
    return t < at ? 5e4 * std::max(0.0, 1.0 - (at - t) / (40.0 * cell_time)) : 5e4 * std::exp(-(t - at) / decay);
  });
  slow("rise and decay of one pulse", [&](double t) {
    double const s = std::max(0.0, t - at) / decay;
    return 5e4 * s * std::exp(1.0 - s);
  });
  slow("sound pulse", [&](double t) { return 500.0 * std::exp(-std::pow((t - 2.0 * at) / (20.0 * cell_time), 2)); });
  slow("pulse with straight sides", [&](double t) {
    double const s = std::cosh((t - 2.0 * at) / (15.0 * cell_time));
    return 3e4 / (s * s);
  });
  for (double const period : {12.0, 25.0, 60.0, 150.0}) {
    for (double const amplitude : {200.0, 2e4}) {
      no_front("sine", [&](double t) {
        return t < at ? 0.0 : amplitude * std::sin(2.0 * M_PI * (t - at) / (period * cell_time));
      });
    }
  }
  no_front("plateau", [&](double t) { return captured(t, at, 5e4, 1e9, 2.0); });
  no_front("plateau that ripples",
           [&](double t) { return captured(t, at, 5e4, 1e9, 2.0) * (1.0 + 0.004 * std::sin(t / (3.0 * cell_time))); });
  no_front("plateau behind an overshoot",
           [&](double t) { return captured(t, at, 5e4, 1e9, 2.0) + captured(t, at, 4e3, 8.0 * cell_time, 2.0); });
}

TEST(Front, SpikeOfTheFirstCellsAtAWallIsNotThePeak) {
  // A rigid wall's cells start 8 % too high and come down within some cells.
  double const at = 100.0 * cell_time;
  auto const w = read(
      [&](double t) {
        return captured(t, at, 2e5, 60.0 * cell_time, 3.0) +
               captured(t, at + 1.5 * cell_time, 1e5, 0.8 * cell_time, 2.0);
      },
      400.0 * cell_time, 0.3 * cell_time, air());
  EXPECT_GT(w.peak_overpressure, 1.06 * 2e5);
  ASSERT_TRUE(w.peak_front_overpressure);
  // The spike has an impulse of its own, which cannot be told from that of the wave: less than half of it stays.
  EXPECT_NEAR(*w.peak_front_overpressure / 2e5, 1.0, 0.5 * (w.peak_overpressure / 2e5 - 1.0));
  // First samples that are high already are no front, whatever follows.
  auto const started = read([&](double t) { return 2e5 * std::exp(-t / (60.0 * cell_time)); }, 400.0 * cell_time,
                            0.3 * cell_time, air());
  EXPECT_FALSE(started.front_overpressure || started.peak_front_overpressure || started.expected_clipping);
}

TEST(Front, ReflectionThatFollowsCloseHasAFrontOfItsOwn) {
  double const at = 100.0 * cell_time;
  double const decay = 50.0 * cell_time;
  for (double const delay : {6.0, 12.0, 40.0}) {
    double const later = at + delay * cell_time;
    auto const w =
        read([&](double t) { return captured(t, at, 5e4, decay, 2.0) + captured(t, later, 6e4, decay, 2.0); },
             400.0 * cell_time, 0.3 * cell_time, air());
    double const stands = 5e4 * std::exp(-delay * cell_time / decay);
    ASSERT_TRUE(w.peak_front_overpressure) << delay;
    EXPECT_NEAR(*w.peak_front_overpressure / (stands + 6e4), 1.0, 0.02) << delay;
    EXPECT_NEAR(w.front_overpressure.value_or(5e4) / 5e4, 1.0, 0.03) << delay;
    EXPECT_NEAR(*w.arrival_time, at, 0.2 * cell_time);
  }
}

TEST(Record, RoomThatFillsHasMoreImpulseThanThePositivePhase) {
  // A triangle of 1 ms, a dip below zero, and the pressure of a closed room until 40 ms.
  auto const wave = [](double t) {
    if (t < 1e-3) return 0.0;
    if (t < 2e-3) return 2e6 * (2e-3 - t) / 1e-3;
    if (t < 3e-3) return -1e4;
    return 4e5;
  };
  auto const w = read(wave, 40e-3, 1e-6, air());
  EXPECT_NEAR(w.positive_impulse, 1000.0, 2.0);
  EXPECT_NEAR(w.largest_impulse, 1000.0 - 10.0 + 37e-3 * 4e5, 3.0);
  EXPECT_NEAR(w.largest_impulse_time, 40e-3, 1e-9);
  EXPECT_NEAR(w.final_overpressure, 4e5, 1e-6 * 4e5);
  ASSERT_TRUE(w.negative && w.negative->duration);
  EXPECT_NEAR(w.negative->peak, -1e4, 1e-9);
  EXPECT_NEAR(w.negative->impulse, -10.0, 0.02);
  EXPECT_NEAR(*w.negative->duration, 1e-3, 2e-6);
}

TEST(Record, NegativePhaseIsThatOfTheLowestPressureAndMayBeCutOff) {
  auto const wave = [](double t) {
    if (t < 1e-3) return 0.0;
    if (t < 2e-3) return 1e5;
    if (t < 2.5e-3) return -2e3;  // a ripple first
    if (t < 2.6e-3) return 1e3;
    return t < 6e-3 ? -5e3 * std::sin(M_PI * (t - 2.6e-3) / 3.4e-3) : 0.0;
  };
  auto const whole = read(wave, 8e-3, 1e-6, air());
  ASSERT_TRUE(whole.negative && whole.negative->duration);
  EXPECT_NEAR(whole.negative->peak, -5e3, 0.1);
  EXPECT_NEAR(whole.negative->time, 4.3e-3, 2e-6);
  EXPECT_NEAR(whole.negative->impulse, -5e3 * 3.4e-3 * 2.0 / M_PI, 0.02);
  EXPECT_NEAR(*whole.negative->duration, 3.4e-3, 3e-6);
  // The largest impulse stands where the pressure returns to zero first.
  EXPECT_NEAR(whole.largest_impulse, 100.0, 0.2);
  EXPECT_NEAR(whole.largest_impulse_time, 2e-3, 2e-6);
  auto const cut = read(wave, 4.3e-3, 1e-6, air());
  ASSERT_TRUE(cut.negative);
  EXPECT_FALSE(cut.negative->duration);
  EXPECT_NEAR(cut.negative->impulse, -5e3 * 3.4e-3 / M_PI, 0.02);
}

TEST(Record, MeanOfTheEndIsThatOfTheLastTenthInTime) {
  // Samples lie unevenly; the pressure rises by 1000 Pa/s to 1000 Pa.
  std::vector<double> time;
  std::vector<double> overpressure;
  for (int i = 0; i <= 30; ++i) {
    time.push_back(std::pow(i / 30.0, 3));
    overpressure.push_back(1e3 * time.back());
  }
  EXPECT_NEAR(analyse_blast(time, overpressure).final_overpressure, 950.0, 1e-9);
  EXPECT_EQ(analyse_blast({0.0}, {7.0}).final_overpressure, 7.0);
}

TEST(Record, WhatStaysBelowTheThresholdHasNotArrived) {
  double const threshold = arrival_threshold * 101325.0;
  EXPECT_DOUBLE_EQ(threshold, 10.1325);
  for (double const part : {0.01, 0.99}) {
    auto const w = read([&](double t) { return part * threshold * std::sin(1e4 * t); }, 5e-3, 1e-6, air());
    EXPECT_FALSE(w.arrival_time || w.positive_duration || w.negative || w.half_width) << part;
    EXPECT_EQ(w.positive_impulse, 0.0);
  }
  auto const w = read([&](double t) { return t < 1e-3 ? 0.0 : 1.1 * threshold; }, 5e-3, 1e-6, air());
  EXPECT_TRUE(w.arrival_time);
  // What unrest comes before the wave does not arrive in its place, and a rarefaction is one without an arrival.
  auto const late = read([&](double t) { return t < 3e-3 ? 0.9 * threshold : 1.5 * threshold; }, 5e-3, 1e-6, air());
  ASSERT_TRUE(late.arrival_time);
  EXPECT_GT(*late.arrival_time, 2.9e-3);
  auto const low = read([](double t) { return t < 1e-3 ? 0.0 : -500.0; }, 5e-3, 1e-6, air());
  EXPECT_FALSE(low.arrival_time);
  ASSERT_TRUE(low.negative);
  EXPECT_EQ(low.negative->peak, -500.0);
}

TEST(PositivePhase, IsOverWithTheFirstReturnAfterTheArrival) {
  run::GaugeHistory history;
  PositivePhase phase(1e5);
  auto const add = [&](double pressure) {
    history.records.push_back({1e-3 * static_cast<double>(history.records.size()), pressure, 1.2, {}});
    phase.update(history.records);
    EXPECT_EQ(phase.over(), past_positive_phase(history, 1e5));
  };
  for (double const quiet : {1e5, 1e5 + 9.0, 1e5 - 300.0, 1e5}) add(quiet);
  EXPECT_FALSE(phase.arrived());
  for (double const wave : {1.5e5, 1.2e5, 1e5 + 1.0}) add(wave);
  EXPECT_TRUE(phase.arrived());
  EXPECT_FALSE(phase.over());
  add(1e5 - 5.0);
  EXPECT_TRUE(phase.over());
  add(3e5);
  EXPECT_TRUE(phase.over());
}

TEST(Clipping, IsTheLargestValueOfTheCapturedWave) {
  for (IncidentShock const& shock : {IncidentShock{0.05}, IncidentShock{1.0}, IncidentShock{1.0, true}}) {
    double const length = captured_length(shock);
    for (double const cells : {1.0, 5.0, 20.0, 200.0}) {
      double largest = 0.0;
      for (double x = 0.0; x < 40.0 * length; x += 1e-3 * length)
        largest = std::max(largest, (1.0 - std::exp(-x / length)) * std::exp2(-x / cells));
      EXPECT_NEAR(clipping(cells, shock), 1.0 - largest, 1e-6);
      EXPECT_NEAR(cells_for_clipping(clipping(cells, shock), shock) / cells, 1.0, 1e-6);
    }
  }
}

TEST(ExpectedPeak, HalfWidthOfAFriedlanderWave) {
  for (double const b : {0.01, 1.0, 5.0, 60.0}) {
    double const impulse = 2e5 * 3e-3 * (1.0 / b - (1.0 - std::exp(-b)) / (b * b));
    double const s = friedlander_half_width(2e5, impulse, 3e-3) / 3e-3;
    EXPECT_NEAR((1.0 - s) * std::exp(-b * s), 0.5, 1e-6) << b;
  }
}

TEST(ExpectedPeak, DecayBehindAStrongSphericalShockIsThatOfSedov) {
  // The strong particle explosion, gamma = 1.4: R = a t^(2/5), p2 ~ R^-3. Its self-similar profile begins at the front
  // with d ln p / d ln r = (2 gamma^2 + 7 gamma - 3) / (gamma^2 - 1) = 10.72 / 0.96 in three dimensions, so that at a
  // place d ln p / d ln t = -6/5 - 2/5 * 11.167 = -5.667.
  material::Primitive const gas{1.225, 101325.0, {0.0, 0.0, 0.0}};
  auto const peak = [](double r) { return 1e11 / (r * r * r); };
  double const radius = 0.7;
  double const speed = material::shocked(material::IdealGas{1.4}, gas.density, gas.pressure, peak(radius)).speed;
  double const age = 0.4 * radius / speed;
  EXPECT_NEAR(decay_time(material::IdealGas{1.4}, gas, peak, radius) * 5.667 / age, 1.0, 2e-3);  // differences over 2 %
}

/// 1 kg of TNT and one gauge.
run::Case tnt_case(Geometry geometry, Index3 const& cells, double h, Vec3 const& charge, Vec3 const& gauge) {
  run::Case c = run::air_case(geometry, cells, h, Boundary::outflow);
  double const radius = std::cbrt(3.0 / (4.0 * M_PI * 1630.0));
  c.charges = {run::tnt_charge(shape::Sphere{charge, radius}, Geometry::cartesian3d)};
  c.gauges.push_back({"g", gauge});
  return c;
}

TEST(ExpectedPeak, WallsObstaclesAndMirrorsReflectTheGroundUnderTheChargeDoesNot) {
  auto const case_of = [](Vec3 const& gauge) {
    return tnt_case(Geometry::cartesian3d, {100, 100, 100}, 0.05, {2.5, 2.5, 2.0}, gauge);
  };
  auto const reflected = [](run::Case const& c) {
    auto const peak = expected_peak(c, c.gauges.front().position);
    EXPECT_TRUE(peak);
    return peak && peak->reflected;
  };
  auto ground = case_of({2.5, 2.5, 0.0});
  EXPECT_FALSE(reflected(ground));  // outflow
  ground.domain.boundary[4] = Boundary::wall;
  EXPECT_TRUE(reflected(ground));
  ground.domain.boundary[4] = Boundary::symmetry;
  EXPECT_TRUE(reflected(ground));
  ground.gauges.front().position = {2.5, 2.5, 0.4};  // 8 cells above it
  EXPECT_FALSE(reflected(ground));
  ground.gauges.front().position = {2.5, 4.9, 0.0};  // grazing
  EXPECT_FALSE(reflected(ground));

  auto house = case_of({3.98, 2.5, 2.0});
  house.obstacles.push_back({"house", shape::Box{{4.0, 2.0, 0.0}, {4.6, 3.0, 3.0}}});
  EXPECT_TRUE(reflected(house));
  house.gauges.front().position = {4.62, 2.5, 2.0};  // behind it
  EXPECT_FALSE(expected_peak(house, house.gauges.front().position));

  auto on_ground = tnt_case(Geometry::cartesian3d, {100, 100, 100}, 0.05, {2.5, 2.5, 0.03}, {4.0, 2.5, 0.0});
  on_ground.domain.boundary[4] = Boundary::wall;
  EXPECT_FALSE(reflected(on_ground));

  auto planar = tnt_case(Geometry::planar2d, {100, 100, 1}, 0.05, {2.5, 2.5, 0.0}, {4.0, 2.5, 0.0});
  EXPECT_FALSE(expected_peak(planar, planar.gauges.front().position));
  auto water = case_of({2.5, 2.5, 0.0});
  water.ambient.fluid.eos = material::StiffenedGas{};
  EXPECT_FALSE(expected_peak(water, water.gauges.front().position));
}

TEST(ExpectedPeak, OfSeveralChargesTheStrongestAtTheGaugeCounts) {
  auto c = tnt_case(Geometry::cartesian3d, {100, 100, 100}, 0.05, {2.5, 2.5, 2.5}, {4.5, 2.5, 2.5});
  auto const alone = expected_peak(c, c.gauges.front().position);
  auto far = c.charges.front();
  far.mass = 0.01;
  far.shape = shape::Sphere{{0.5, 2.5, 2.5}, 0.01};
  c.charges.insert(c.charges.begin(), far);
  EXPECT_EQ(expected_peak(c, c.gauges.front().position)->half_width, alone->half_width);
}

/// The wave at the distance `z` from 1 kg of TNT, in the open or on a wall there, on cells of z / n.
GaugeSummary blast(double z, int n, bool wall, double end, std::optional<ExpectedPeak>* expected = nullptr) {
  int const cells = wall ? n : n * 3 / 2;
  run::Case c = tnt_case(Geometry::spherical1d, {cells, 1, 1}, z / n, {0.0, 0.0, 0.0}, {z, 0.0, 0.0});
  c.domain.boundary[0] = Boundary::symmetry;
  if (wall) c.domain.boundary[1] = Boundary::wall;
  if (expected != nullptr) *expected = expected_peak(c, c.gauges.front().position);
  Watched world(std::move(c));
  run::advance_to(world, end);
  return summarise(world.setup, world.gauges.gas).front();
}

/// Overpressure on a wall behind the reflection of a shock, gamma = 1.4.
double reflected(double p) {
  constexpr double p0 = 101325.0;
  return 2.0 * p * (7.0 * p0 + 4.0 * p) / (7.0 * p0 + p);
}

struct Distance {
  double z;
  std::vector<int> cells;
  double end;
};

TEST(ClippedBlast, CheckAndSummaryTellWhatTheCellsCutOff) {
  // Incident waves from 950 to 30 kPa with 8 to 35 cells in the half width; the coarsest has 4 cells per charge radius.
  for (auto const& [z, numbers, end] :
       {Distance{1.0, {100, 200}, 0.9e-3}, Distance{2.0, {160, 300}, 2.6e-3}, Distance{5.0, {400}, 11e-3}}) {
    // The peak of the finest record is clipped itself, by 2 to 4 %; what the decay tells is not (next test).
    auto const fine = blast(z, z < 4.0 ? 1200 : 1000, false, end).wave;
    ASSERT_TRUE(fine.front_overpressure);
    EXPECT_GT(*fine.front_overpressure, fine.peak_overpressure);
    EXPECT_LT(*fine.front_overpressure, 1.05 * fine.peak_overpressure);
    for (int const n : numbers) {
      std::optional<ExpectedPeak> before;
      auto const w = blast(z, n, false, end, &before).wave;
      double const clipped = 1.0 - w.peak_overpressure / *fine.front_overpressure;
      ASSERT_TRUE(before && w.expected_clipping && w.front_overpressure) << z << ' ' << n;
      fmt::print(
          "Z = {}, {} cells: clipped by {:.1f} %, before the run {:.1f} %, after it {:.1f} %; at the front {:+.1f} %\n",
          z, n, 100.0 * clipped, 100.0 * before->clipping, 100.0 * *w.expected_clipping,
          100.0 * (*w.front_overpressure / *fine.front_overpressure - 1.0));
      EXPECT_GT(clipped, 0.04) << "the cells must clip the peak for this to mean anything";
      EXPECT_FALSE(w.reflected || before->reflected);
      // The law was read off runs like these with a scatter of a tenth; the decay time of the curves, which burn more
      // of the products, is off by a tenth, too.
      EXPECT_NEAR(*w.expected_clipping, clipped, 0.2 * clipped) << z << ' ' << n;
      EXPECT_NEAR(before->clipping, clipped, 0.25 * clipped) << z << ' ' << n;
      // With 5 cells per charge radius (Z = 1, 100 cells) the burst itself is some per cent off.
      EXPECT_NEAR(*w.front_overpressure / *fine.front_overpressure, 1.0, 0.04) << z << ' ' << n;
      EXPECT_EQ(*w.front_overpressure, *w.peak_front_overpressure);
    }
  }
}

/// Does the scheme leave too high a pressure for some steps where a strong shock (Mach 3) is reflected? What the cells
/// clip at a wall cannot be told then.
bool overshoots_at_walls() {
  run::Case c = run::air_case(Geometry::planar1d, {100, 1, 1}, 0.01, Boundary::outflow);
  c.domain.boundary[1] = Boundary::wall;
  auto const& air = c.ambient.state;
  double const behind = air.pressure * 31.0 / 3.0;
  auto const shock = material::shocked(c.ambient.fluid.eos, air.density, air.pressure, behind);
  c.initial_states.push_back(
      {shape::Box{{-1.0, -1.0, -1.0}, {0.5, 1.0, 1.0}}, {shock.density, behind, {shock.jump, 0.0, 0.0}}, false, ""});
  c.gauges.push_back({"g", {1.0, 0.0, 0.0}});
  Watched world(std::move(c));
  run::advance_to(world, 1e-3);
  return summarise(world.setup, world.gauges.gas).front().wave.peak_overpressure > 1.03 * reflected(behind - 101325.0);
}

TEST(ClippedBlast, OnAWallToo) {
  bool const strong_too = !overshoots_at_walls();
  // The reference is the reflection of the incident shock by Rankine-Hugoniot, which holds for its first moment.
  for (auto const& [z, numbers, end] :
       {Distance{1.0, {100, 200}, 0.9e-3}, Distance{2.0, {160}, 2.9e-3}, Distance{5.0, {400}, 11.5e-3}}) {
    double const incident = *blast(z, 1000, false, end).wave.front_overpressure;
    for (int const n : numbers) {
      std::optional<ExpectedPeak> before;
      auto const w = blast(z, n, true, end, &before).wave;
      double const clipped = 1.0 - w.peak_overpressure / reflected(incident);
      ASSERT_TRUE(before && w.expected_clipping && w.peak_front_overpressure) << z << ' ' << n;
      double const front = *w.peak_front_overpressure / reflected(incident) - 1.0;
      fmt::print(
          "Z = {}, {} cells: clipped by {:.1f} %, before the run {:.1f} %, after it {:.1f} %; at the front {:+.1f} %\n",
          z, n, 100.0 * clipped, 100.0 * before->clipping, 100.0 * *w.expected_clipping, 100.0 * front);
      EXPECT_TRUE(w.reflected && before->reflected);
      EXPECT_GT(clipped, 0.04) << "the cells must clip the peak for this to mean anything";
      EXPECT_LT(std::abs(front), 0.65 * clipped) << z << ' ' << n;
      if (z < 4.0 && !strong_too) continue;
      // At the wall both shocks are captured together, and the half width of the curves is less sure than in the open.
      EXPECT_LT(std::abs(front), 0.55 * clipped) << z << ' ' << n;
      EXPECT_NEAR(*w.expected_clipping, clipped, 0.03 + 0.2 * clipped) << z << ' ' << n;
      EXPECT_NEAR(before->clipping, clipped, 0.03 + 0.25 * clipped) << z << ' ' << n;
    }
  }
}

TEST(ClippedBlast, OnWallAndObstacleOfTwoDimensionsAsOnFineCellsOfOne) {
  // A sphere of hot air between ground and roof.
  auto const hot = [](Geometry geometry, Index3 const& cells, double h, Vec3 const& centre) {
    run::Case c = run::air_case(geometry, cells, h, Boundary::outflow);
    c.domain.boundary[0] = Boundary::symmetry;
    c.initial_states.push_back({shape::Sphere{centre, 0.1}, {1.225, 1e7, {0.0, 0.0, 0.0}}, false, ""});
    return c;
  };
  auto one = hot(Geometry::spherical1d, {2000, 1, 1}, 2.5e-4, {0.0, 0.0, 0.0});
  one.gauges = {{"free", {0.3, 0.0, 0.0}}, {"roof", {0.34, 0.0, 0.0}}};
  Watched fine(std::move(one));
  run::advance_to(fine, 0.35e-3);
  auto const reference = summarise(fine.setup, fine.gauges.gas);

  auto two = hot(Geometry::axisymmetric2d, {160, 360, 1}, 2.5e-3, {0.0, 0.5, 0.0});
  two.domain.boundary[2] = Boundary::wall;
  two.obstacles.push_back({"roof", shape::Box{{0.0, 0.84, 0.0}, {0.2, 0.9, 0.0}}});
  two.gauges = {{"free", {0.3, 0.5, 0.0}}, {"roof", {0.0, 0.84, 0.0}}, {"under the roof", {0.0, 0.83, 0.0}}};
  Watched coarse(std::move(two));
  run::advance_to(coarse, 0.35e-3);
  auto const got = summarise(coarse.setup, coarse.gauges.gas);

  auto const compare = [](BlastWave const& w, double right) {
    ASSERT_TRUE(w.peak_front_overpressure && w.expected_clipping);
    double const clipped = 1.0 - w.peak_overpressure / right;
    double const front = *w.peak_front_overpressure / right - 1.0;
    fmt::print("clipped by {:.1f} %, expected {:.1f} %, at the front {:+.1f} %\n", 100.0 * clipped,
               100.0 * *w.expected_clipping, 100.0 * front);
    EXPECT_GT(clipped, 0.08);
    EXPECT_LT(std::abs(front), 0.4 * clipped);
    if (!w.reflected || !overshoots_at_walls()) {
      EXPECT_NEAR(*w.expected_clipping, clipped, 0.03 + 0.2 * clipped);
    }
  };
  compare(got[0].wave, *reference[0].wave.front_overpressure);
  compare(got[1].wave, reflected(*reference[1].wave.front_overpressure));
  EXPECT_FALSE(got[0].wave.reflected);
  EXPECT_TRUE(got[1].wave.reflected);
  // Four cells from the roof two shocks pass, one after the other.
  auto const& under = got[2].wave;
  ASSERT_TRUE(under.peak_front_overpressure);
  EXPECT_TRUE(under.reflected);
  EXPECT_GT(*under.peak_front_overpressure, 1.05 * under.peak_overpressure);
  EXPECT_LT(*under.peak_front_overpressure, *got[1].wave.peak_front_overpressure);
}

}  // namespace
}  // namespace brisance::observe::test
