#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.hpp"
#include "observe/gauge_columns.hpp"
#include "output/file.hpp"
#include "output/gauges.hpp"
#include "scratch.hpp"

namespace brisance::output::test {
namespace {

using namespace observe;

/// The Friedlander wave p = P (1 - s/T) exp(-b s/T), s = t - t_a, for s >= 0.
struct Friedlander {
  double arrival = 2e-3;
  double peak = 1.5e5;
  double duration = 3e-3;
  double decay = 1.7;

  [[nodiscard]] double at(double t) const {
    double const s = (t - arrival) / duration;
    return s < 0.0 ? 0.0 : peak * (1.0 - s) * std::exp(-decay * s);
  }
  /// Closed form of the integral over the positive phase.
  [[nodiscard]] double impulse() const {
    return peak * duration * (1.0 / decay - (1.0 - std::exp(-decay)) / (decay * decay));
  }
};

struct History {
  std::vector<double> time;
  std::vector<double> overpressure;
};

template <class Wave>
History sampled(Wave const& wave, double end, double step) {
  History h;
  for (int i = 0; i * step <= end; ++i) {
    h.time.push_back(i * step);
    h.overpressure.push_back(wave(i * step));
  }
  return h;
}

TEST(BlastWave, FriedlanderGivesItsClosedFormValues) {
  Friedlander const f;
  double const step = 1e-6;
  auto const h = sampled([&](double t) { return f.at(t); }, 8e-3, step);
  auto const w = analyse_blast(h.time, h.overpressure);
  EXPECT_NEAR(w.peak_overpressure, f.peak, 2.7 * step / f.duration * f.peak);  // one step's decay
  EXPECT_NEAR(w.peak_time, f.arrival, step);
  ASSERT_TRUE(w.arrival_time);
  EXPECT_NEAR(*w.arrival_time, f.arrival, step);
  ASSERT_TRUE(w.positive_duration);
  EXPECT_NEAR(*w.positive_duration, f.duration, step);
  EXPECT_NEAR(w.positive_impulse, f.impulse(), f.peak * step);  // the jump is known to one step
}

TEST(BlastWave, SmearedShockArrivesAtItsMiddleWhateverItsWidth) {
  Friedlander const f;
  for (double const width : {2e-5, 1e-4}) {
    // A ramp of the given width, centred at the arrival, in front of the decay.
    auto const h = sampled(
        [&](double t) {
          if (t < f.arrival - 0.5 * width) return 0.0;
          if (t < f.arrival + 0.5 * width) return f.peak * ((t - f.arrival) / width + 0.5);
          return f.at(t - 0.5 * width);
        },
        8e-3, 1e-6);
    auto const w = analyse_blast(h.time, h.overpressure);
    ASSERT_TRUE(w.arrival_time);
    EXPECT_NEAR(*w.arrival_time, f.arrival, 1.5e-6) << "width " << width;
  }
}

/// What cells of the width `cell` (as a time) make of a wave: a shock captured over some three of them, and means.
History captured(Friedlander const& f, double cell, double end, double step) {
  return sampled(
      [&](double t) {
        // Mean of the wave over a bell of the half width of 1.5 cells (three boxes, one after the other).
        constexpr int places = 12;
        double sum = 0.0;
        for (int i = 0; i < places; ++i)
          for (int j = 0; j < places; ++j)
            for (int k = 0; k < places; ++k) sum += f.at(t + cell * ((i + j + k + 1.5) / places - 1.5));
        return sum / (places * places * places);
      },
      end, step);
}

TEST(BlastWave, FrontIsFoundThroughTheCellsThatClippedIt) {
  Friedlander const f{2e-4, 7e6, 1e-3, 15.0};  // falls by 4 % within 2.7 us
  for (double const cell : {1e-6, 3e-6, 6e-6}) {
    auto const h = captured(f, cell, 4e-4, 0.3 * cell);
    auto const w = analyse_blast(h.time, h.overpressure);
    double const clipped = w.peak_overpressure / f.peak - 1.0;
    EXPECT_LT(clipped, -f.decay * cell / f.duration) << "the cells must clip the peak for this to mean anything";
    ASSERT_TRUE(w.front_overpressure) << cell;
    EXPECT_LT(std::abs(*w.front_overpressure / f.peak - 1.0), 0.25 * std::abs(clipped)) << cell << ' ' << clipped;
    EXPECT_GE(*w.front_overpressure, w.peak_overpressure);
  }
  // A weak decay: nothing to gain, nothing lost.
  Friedlander const weak{2e-4, 3e4, 4e-3, 0.5};
  auto const h = captured(weak, 2e-6, 1e-3, 1e-6);
  auto const w = analyse_blast(h.time, h.overpressure);
  ASSERT_TRUE(w.front_overpressure);
  EXPECT_NEAR(*w.front_overpressure / weak.peak, 1.0, 1e-3);
}

TEST(BlastWave, FrontIsAbsentWhereNoDecayTellsIt) {
  auto const absent = [](auto const& wave) {
    auto const h = sampled(wave, 4e-3, 1e-6);
    auto const w = analyse_blast(h.time, h.overpressure);
    EXPECT_TRUE(w.arrival_time);
    EXPECT_FALSE(w.front_overpressure) << *w.front_overpressure / w.peak_overpressure;
  };
  // A smooth hump, a plateau, a rise, and a second shock that comes before the decay is read.
  absent([](double t) { return 1e5 * std::exp(-std::pow((t - 2e-3) / 3e-4, 2)); });
  absent([](double t) { return 1e5 * std::clamp((t - 1e-3) / 1e-5, 0.0, 1.0); });
  absent([](double t) { return t < 1e-3 ? 0.0 : 1e5 * std::min((t - 1e-3) / 2e-5, 1.0 + 0.05 * (t - 1e-3) / 2e-5); });
  absent([](double t) {
    double const ramp = std::clamp((t - 1e-3) / 2e-5, 0.0, 1.0);
    return 1e5 * ramp * std::exp(-std::max(0.0, t - 1.02e-3) / 1e-4) + (t > 1.04e-3 ? 3e4 : 0.0);
  });
  // A record that ends at the peak.
  auto const h = sampled([](double t) { return t < 1e-3 ? 0.0 : 1e5; }, 1e-3, 1e-6);
  EXPECT_FALSE(analyse_blast(h.time, h.overpressure).front_overpressure);
}

TEST(BlastWave, StrongerReflectionDoesNotMoveTheArrival) {
  Friedlander const incident{2e-3, 1e5, 3e-3, 1.5};
  // Very soon after the first shock, without a dip to speak of, and much later.
  for (double const delay : {3e-5, 1e-3}) {
    Friedlander const reflected{2e-3 + delay, 9e5, 2e-3, 2.5};
    auto const h = sampled([&](double t) { return incident.at(t) + reflected.at(t); }, 8e-3, 1e-6);
    auto const w = analyse_blast(h.time, h.overpressure);
    ASSERT_TRUE(w.arrival_time);
    EXPECT_NEAR(*w.arrival_time, 2e-3, 1e-6) << "delay " << delay;
    EXPECT_NEAR(w.peak_time, 2e-3 + delay, 1.1e-6);
    EXPECT_GT(w.peak_overpressure, 9e5);
  }
}

TEST(BlastWave, PlateauBetweenTwoShocksEndsTheFirstFront) {
  auto const h = sampled([](double t) { return t < 1e-3 ? 0.0 : (t < 1.2e-3 ? 1e5 : 8e5); }, 3e-3, 1e-5);
  auto const w = analyse_blast(h.time, h.overpressure);
  ASSERT_TRUE(w.arrival_time);
  EXPECT_NEAR(*w.arrival_time, 1e-3, 1e-5);
}

TEST(BlastWave, RecordThatEndsInThePositivePhaseHasNoDuration) {
  Friedlander const f;
  auto const h = sampled([&](double t) { return f.at(t); }, f.arrival + 0.5 * f.duration, 1e-6);
  auto const w = analyse_blast(h.time, h.overpressure);
  EXPECT_TRUE(w.arrival_time);
  EXPECT_FALSE(w.positive_duration);
  EXPECT_GT(w.positive_impulse, 0.5 * f.impulse());
  EXPECT_LT(w.positive_impulse, f.impulse());
}

TEST(BlastWave, NothingArrives) {
  for (auto const& p : {std::vector{0.0, 0.0, 0.0}, std::vector{0.0, -1.0, -2.0}, std::vector<double>{}}) {
    auto const w = analyse_blast({0.0, 1.0, 2.0}, p);
    EXPECT_FALSE(w.arrival_time);
    EXPECT_FALSE(w.positive_duration);
    EXPECT_EQ(w.positive_impulse, 0.0);
  }
}

TEST(BlastWave, RecordThatStartsBehindTheShock) {
  auto const w = analyse_blast({1.0, 2.0, 3.0}, {4.0, 2.0, -2.0});
  EXPECT_EQ(w.arrival_time, 1.0);
  EXPECT_EQ(w.positive_duration, 1.5);
  EXPECT_EQ(w.positive_impulse, 3.0 + 0.5);
}

TEST(Gauges, RunningImpulseIsTheTrapezoidSum) {
  EXPECT_EQ(running_impulse({0.0, 1.0, 3.0}, {0.0, 2.0, 4.0}), (std::vector{0.0, 1.0, 7.0}));
}

TEST(Gauges, NamesBecomeSafeFileNames) {
  EXPECT_EQ(sanitised("wall 3/b"), "wall_3_b");
  EXPECT_EQ(sanitised("../../etc"), "_.._.._etc");
  EXPECT_EQ(sanitised(""), "_");
  EXPECT_EQ(sanitised("P-1.5_m"), "P-1.5_m");
}

GaugeHistory history(std::string const& name, Vec3 const& position) { return {{name, position}, {}, {}}; }

/// A record of which the sampled columns are 0.
void add(GaugeHistory& gauge, GaugeRecord const& record) {
  gauge.records.push_back(record);
  gauge.sampled.resize(gauge.records.size() * sampled_columns(gas_columns()), 0.0);
}

TEST(Gauges, CsvGrowsDuringTheRunAndHoldsDerivedQuantities) {
  ScratchFolder folder;
  std::vector gauges{history("a b", {}), history("a/b", {})};
  GaugeFiles files(folder.path(), gauges, 1e5);
  EXPECT_EQ(files.names(), (std::vector<std::string>{"gauges/a_b.csv", "gauges/a_b_2.csv"}));
  add(gauges[0], {0.0, 1e5, 1.25, {0.0, 0.0, 0.0}});
  add(gauges[0], {1e-3, 3e5, 2.0, {3.0, 0.0, 4.0}});
  files.append(gauges);
  add(gauges[0], {2e-3, 1e5, 2.0, {0.0, 0.0, 0.0}});
  files.append(gauges);
  files.append(gauges);
  // The columns that are there always come first, so that new ones leave them where they are.
  std::istringstream csv(read_file(folder.path() / "gauges/a_b.csv"));
  for (std::string const expected :
       {"time [s],pressure [Pa],overpressure [Pa],density [kg/m3],velocity_x [m/s],velocity_y [m/s],velocity_z [m/s],"
        "dynamic_pressure [Pa],impulse [Pa s]",
        "0,100000,0,1.25,0,0,0,0,0", "0.001,300000,200000,2,3,0,4,25,100", "0.002,100000,0,2,0,0,0,0,200"}) {
    std::string line;
    ASSERT_TRUE(std::getline(csv, line));
    EXPECT_TRUE((line + ",").starts_with(expected + ",")) << line;
  }
  EXPECT_EQ(csv.peek(), std::istringstream::traits_type::eof());
}

/// Lets the process have only `files` files open at a time.
class OpenFileLimit {
 public:
  explicit OpenFileLimit(rlim_t files) {
    getrlimit(RLIMIT_NOFILE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = files;
    setrlimit(RLIMIT_NOFILE, &limit);
  }
  ~OpenFileLimit() { setrlimit(RLIMIT_NOFILE, &before_); }
  OpenFileLimit(OpenFileLimit const&) = delete;
  OpenFileLimit& operator=(OpenFileLimit const&) = delete;

 private:
  rlimit before_{};
};

TEST(Gauges, MoreThanTheSystemLetsOpenAtATime) {
  ScratchFolder folder;
  std::vector<GaugeHistory> gauges;
  for (int i = 0; i < 2000; ++i) gauges.push_back(history(std::to_string(i), {}));
  OpenFileLimit const limit(64);
  GaugeFiles files(folder.path(), gauges, 1e5);
  for (double const time : {0.0, 1.0}) {
    for (auto& gauge : gauges) add(gauge, {time, 1e5, 1.25, {0.0, 0.0, 0.0}});
    files.append(gauges);
  }
  for (auto const& name : files.names()) {
    auto const text = read_file(folder.path() / name);
    ASSERT_EQ(std::ranges::count(text, '\n'), 3) << name;
  }
}

/// One charge of TNT at (1, 0, 0) and gauges whose histories are exactly the Kingery-Bulmash values.
run::Case tnt_case(double mass, run::Burst burst) {
  run::Case setup;
  setup.ambient.fluid.eos = material::IdealGas{1.4};
  setup.ambient.state = {1.225, 101325.0, {0.0, 0.0, 0.0}};
  run::Charge charge;
  charge.explosive.name = "TNT";
  charge.explosive.tnt_equivalent_pressure = charge.explosive.tnt_equivalent_impulse = 1.0;
  charge.shape = shape::Sphere{{1.0, 0.0, 0.0}, 0.1};
  charge.mass = mass;
  setup.charges.push_back(charge);
  setup.burst = burst;
  return setup;
}

TEST(Summary, DistanceScaledDistanceAndRatioBesideKingeryBulmash) {
  auto const setup = tnt_case(8.0, run::Burst::hemispherical);
  auto g = history("g", {1.0, 4.0, 3.0});  // 5 m from the charge, Z = 2.5
  auto const expected = empirical::kingery_bulmash(8.0, 5.0, empirical::Burst::hemispherical);
  Friedlander const f{*expected.arrival, 2.0 * *expected.incident_overpressure, 0.5 * *expected.duration, 1.5};
  auto const h = captured(f, 2e-6, 2e-2, 1e-6);
  for (std::size_t i = 0; i < h.time.size(); ++i)
    g.records.push_back({h.time[i], 101325.0 + h.overpressure[i], 1.2, {0.0, 0.0, 0.0}});

  auto const summaries = summarise(setup, {g});
  ASSERT_EQ(summaries.size(), 1U);
  EXPECT_DOUBLE_EQ(*summaries[0].distance, 5.0);
  EXPECT_DOUBLE_EQ(*summaries[0].scaled_distance, 2.5);

  ScratchFolder folder;
  write_summary(folder.path(), setup, summaries, {"gauges/g.csv"});
  auto const json = nlohmann::json::parse(read_file(folder.path() / "summary.json"));
  auto const& entry = json["gauges"][0];
  EXPECT_EQ(entry["name"], "g");
  EXPECT_NEAR(entry["ratio"]["peak_overpressure"].get<double>(), 2.0, 1e-2);  // clipped
  EXPECT_NEAR(entry["ratio"]["front_overpressure"].get<double>(), 2.0, 2e-3);
  EXPECT_NEAR(entry["ratio"]["arrival_time"].get<double>(), 1.0, 1e-3);
  EXPECT_NEAR(entry["ratio"]["positive_duration"].get<double>(), 0.5, 1e-3);
  EXPECT_GT(json["kingery_bulmash_curve"].size(), 40U);

  std::istringstream csv(read_file(folder.path() / "summary.csv"));
  std::string header;
  std::string row;
  std::getline(csv, header);
  std::getline(csv, row);
  EXPECT_EQ(std::ranges::count(header, ','), std::ranges::count(row, ','));
  EXPECT_TRUE(row.starts_with("g,1,4,3,5,2.5,")) << row;
}

TEST(Summary, HoldsTheWholeRecordAndNullsWhereNothingArrived) {
  auto const setup = tnt_case(8.0, run::Burst::none);
  auto room = history("room", {1.0, 4.0, 3.0});
  auto quiet = history("quiet", {1.0, 5.0, 3.0});
  for (int i = 0; i <= 1000; ++i) {
    double const t = i * 1e-5;
    double const p = t < 1e-3 ? 0.0 : t < 2e-3 ? 1e5 : t < 3e-3 ? -2e4 : 5e4;
    room.records.push_back({t, 101325.0 + p, 1.2, {0.0, 0.0, 0.0}});
    quiet.records.push_back({t, 101325.0 + 3.0 * std::sin(1e3 * t), 1.2, {0.0, 0.0, 0.0}});
  }
  ScratchFolder folder;
  write_summary(folder.path(), setup, summarise(setup, {room, quiet}), {});
  auto const json = nlohmann::json::parse(read_file(folder.path() / "summary.json"));
  EXPECT_NEAR(json["arrival_threshold"].get<double>(), 10.1325, 1e-9);
  auto const& r = json["gauges"][0];
  EXPECT_NEAR(r["positive_impulse"].get<double>(), 100.0, 1.0);
  EXPECT_NEAR(r["largest_impulse"].get<double>(), 100.0 - 20.0 + 350.0, 2.0);
  EXPECT_NEAR(r["time_of_largest_impulse"].get<double>(), 1e-2, 1e-9);
  EXPECT_NEAR(r["final_overpressure"].get<double>(), 5e4, 1e-3);
  EXPECT_NEAR(r["negative_phase"]["peak"].get<double>(), -2e4, 1e-6);
  EXPECT_NEAR(r["negative_phase"]["impulse"].get<double>(), -20.0, 0.2);
  EXPECT_NEAR(r["negative_phase"]["duration"].get<double>(), 1e-3, 2e-5);
  EXPECT_EQ(r["negative_phase"]["complete"], true);
  auto const& q = json["gauges"][1];
  for (char const* key : {"arrival_time", "positive_duration", "negative_phase", "cells_per_half_width",
                          "expected_clipping", "peak_front_overpressure", "front_overpressure", "reflected"})
    EXPECT_TRUE(q[key].is_null()) << key;

  std::istringstream csv(read_file(folder.path() / "summary.csv"));
  std::string header;
  std::string row;
  std::getline(csv, header);
  EXPECT_NE(
      header.find(",largest_impulse [Pa s],time_of_largest_impulse [s],final_overpressure [Pa],negative_peak [Pa]"),
      std::string::npos);
  while (std::getline(csv, row)) EXPECT_EQ(std::ranges::count(header, ','), std::ranges::count(row, ','));
}

TEST(Summary, KingeryBulmashIsAbsentWhereItDoesNotApply) {
  EXPECT_FALSE(empirical_blast(tnt_case(8.0, run::Burst::none), 5.0).incident_overpressure);
  auto two = tnt_case(8.0, run::Burst::spherical);
  two.charges.push_back(two.charges.front());
  EXPECT_FALSE(empirical_blast(two, 5.0).incident_overpressure);
  auto water = tnt_case(8.0, run::Burst::spherical);
  water.ambient.fluid.eos = material::StiffenedGas{};
  EXPECT_FALSE(empirical_blast(water, 5.0).incident_overpressure);
  EXPECT_TRUE(empirical_blast(tnt_case(8.0, run::Burst::spherical), 5.0).incident_overpressure);
}

TEST(Summary, TntEquivalentsAndIgnitionDelayEnter) {
  auto setup = tnt_case(8.0, run::Burst::spherical);
  auto& explosive = setup.charges.front().explosive;
  explosive.tnt_equivalent_pressure = 1.3;
  explosive.tnt_equivalent_impulse = 1.1;
  setup.charges.front().initiation = {{{0.0, 0.0, 0.0}, 5e-4}, {{0.0, 0.0, 0.0}, 2e-4}};
  auto const got = empirical_blast(setup, 5.0);
  double const sound_speed = std::sqrt(1.4 * 101325.0 / 1.225);
  empirical::Atmosphere const air{101325.0, sound_speed};
  auto const p = empirical::kingery_bulmash(10.4, 5.0, empirical::Burst::spherical, air);
  auto const i = empirical::kingery_bulmash(8.8, 5.0, empirical::Burst::spherical, air);
  EXPECT_DOUBLE_EQ(*got.incident_overpressure, *p.incident_overpressure);
  EXPECT_DOUBLE_EQ(*got.incident_impulse, *i.incident_impulse);
  EXPECT_DOUBLE_EQ(*got.arrival, *i.arrival + 2e-4);
}

TEST(Summary, AtAnotherAmbientTheCurvesAreScaledAfterSachs) {
  // Air at 3000 m: pressures as p/p0, lengths as (p0/p)^(1/3), times as lengths over speeds of sound.
  auto setup = tnt_case(8.0, run::Burst::spherical);
  auto const sea = empirical_blast(setup, 5.0);
  setup.ambient.state.pressure = 70121.2;
  setup.ambient.state.density = 0.909254;
  double const p = 70121.2 / 101325.0;
  double const c = std::sqrt(p / (0.909254 / 1.225));
  double const length = std::cbrt(1.0 / p);
  auto const up = empirical_blast(setup, 5.0 * length);
  // The curves hold for a speed of sound of 340.294 m/s, gamma = 1.4 makes it 340.297 m/s.
  EXPECT_NEAR(*up.incident_overpressure / (*sea.incident_overpressure * p), 1.0, 1e-12);
  EXPECT_NEAR(*up.reflected_overpressure / (*sea.reflected_overpressure * p), 1.0, 1e-12);
  EXPECT_NEAR(*up.arrival / (*sea.arrival * length / c), 1.0, 1e-12);
  EXPECT_NEAR(*up.duration / (*sea.duration * length / c), 1.0, 1e-12);
  EXPECT_NEAR(*up.incident_impulse / (*sea.incident_impulse * p * length / c), 1.0, 1e-12);
  EXPECT_NEAR(up.scaled_distance / sea.scaled_distance, 1.0, 1e-12);
}

TEST(Summary, WhatAnUnknownTntEquivalentDecidesIsLeftOut) {
  auto setup = tnt_case(8.0, run::Burst::spherical);
  auto& explosive = setup.charges.front().explosive;
  auto const known = empirical_blast(setup, 5.0);
  ScratchFolder folder;
  auto const written = [&] {
    write_summary(folder.path(), setup, summarise(setup, {history("g", {6.0, 0.0, 0.0})}), {});
    return nlohmann::json::parse(read_file(folder.path() / "summary.json"));
  };

  explosive.tnt_equivalent_impulse.reset();
  auto const pressures = empirical_blast(setup, 5.0);
  EXPECT_EQ(pressures.incident_overpressure, known.incident_overpressure);
  EXPECT_EQ(pressures.shock_speed, known.shock_speed);
  for (auto const& absent :
       {pressures.incident_impulse, pressures.reflected_impulse, pressures.arrival, pressures.duration}) {
    EXPECT_FALSE(absent);
  }
  auto json = written();
  EXPECT_TRUE(json["gauges"][0]["scaled_distance"].is_number());
  EXPECT_TRUE(json["kingery_bulmash_curve"][0]["arrival_time"].is_null());

  explosive.tnt_equivalent_impulse = 1.0;
  explosive.tnt_equivalent_pressure.reset();
  auto const impulses = empirical_blast(setup, 5.0);
  EXPECT_EQ(impulses.incident_impulse, known.incident_impulse);
  EXPECT_EQ(impulses.arrival, known.arrival);
  for (auto const& absent : {impulses.incident_overpressure, impulses.reflected_overpressure, impulses.dynamic_pressure,
                             impulses.shock_speed}) {
    EXPECT_FALSE(absent);
  }
  json = written();
  EXPECT_TRUE(json["gauges"][0]["distance"].is_number());
  EXPECT_TRUE(json["gauges"][0]["scaled_distance"].is_null());
  EXPECT_FALSE(json.contains("kingery_bulmash_curve"));
}

TEST(Summary, NearestOfSeveralChargesGivesTheDistance) {
  auto setup = tnt_case(8.0, run::Burst::none);
  setup.charges.push_back(setup.charges.front());
  setup.charges.back().shape = shape::Sphere{{10.0, 0.0, 0.0}, 0.1};
  setup.charges.back().mass = 27.0;
  auto const summaries = summarise(setup, {history("g", {7.0, 0.0, 0.0})});
  EXPECT_DOUBLE_EQ(*summaries[0].distance, 3.0);
  EXPECT_DOUBLE_EQ(*summaries[0].scaled_distance, 1.0);
}

TEST(Summary, WithoutChargeAndWithSpecialNames) {
  run::Case setup;
  ScratchFolder folder;
  write_summary(folder.path(), setup, summarise(setup, {history("a,\"b\"", {})}), {});
  auto const json = nlohmann::json::parse(read_file(folder.path() / "summary.json"));
  EXPECT_TRUE(json["gauges"][0]["distance"].is_null());
  EXPECT_EQ(json["gauges"][0]["name"], "a,\"b\"");
  EXPECT_NE(read_file(folder.path() / "summary.csv").find("\"a,\"\"b\"\"\","), std::string::npos);
}

}  // namespace
}  // namespace brisance::output::test
