// What a run of material points records: fields at the particles, gauges, energies.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "../run/particles_case.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "observe/particle_fields.hpp"
#include "watched.hpp"

namespace brisance::observe {
namespace {

using namespace run;

std::vector<double> field(Watched const& w, std::string const& name) {
  std::vector<double> out;
  particle_field(w, name, out);
  return out;
}

TEST(ParticleFields, EveryKnownFieldHasItsComponentsForEveryParticle) {
  Watched const w(two_blocks());
  auto const count = static_cast<std::size_t>(mpm::particle_count(*w.regions.front().particles));
  for (auto const* list : {&known_particle_fields(), &standing_particle_fields()}) {
    for (FieldInfo const& info : *list) EXPECT_EQ(field(w, info.name).size(), count * info.components) << info.name;
  }
  std::vector<double> out;
  EXPECT_THROW(particle_field(w, "presure", out), InputError);
}

TEST(ParticleFields, AreInTheSameOrder) {
  Watched w(two_blocks());
  while (w.clock.step < 30) advance(w, 1.0);
  auto const position = field(w, "position");
  auto const body = field(w, "body");
  auto const identity = field(w, "identity");
  auto const displacement = field(w, "displacement");
  Watched const start(two_blocks());
  auto const start_position = field(start, "position");
  auto const start_body = field(start, "body");
  auto const start_identity = field(start, "identity");
  // Whoever has this body and identity started where position less displacement says.
  std::map<std::pair<int, long>, std::size_t> who;
  for (std::size_t q = 0; q < start_body.size(); ++q) who[{int(start_body[q]), long(start_identity[q])}] = q;
  ASSERT_EQ(who.size(), body.size());
  double moved = 0.0;
  for (std::size_t q = 0; q < body.size(); ++q) {
    std::size_t const s = who.at({int(body[q]), long(identity[q])});
    for (int d = 0; d < 2; ++d) {
      moved = std::max(moved, std::abs(displacement[3 * q + d]));
      if (body[q] == 2.0) continue;  // the gas does not know where it came from
      // Round-off of a difference of numbers below 0.1.
      EXPECT_NEAR(position[3 * q + d] - displacement[3 * q + d], start_position[3 * s + d], 1e-16);
    }
  }
  EXPECT_GT(moved, 1e-6);
}

TEST(ParticleFields, StressIsDeviatorLessPressureAndMisesItsInvariant) {
  Watched w(two_blocks());
  while (w.clock.step < 30) advance(w, 1.0);
  auto const stress = field(w, "stress");
  auto const pressure = field(w, "pressure");
  auto const mises = field(w, "mises");
  double largest = 0.0;
  for (std::size_t q = 0; q < pressure.size(); ++q) {
    double const* s = &stress[6 * q];
    double const scale = std::abs(pressure[q]) + mises[q] + 1.0;
    EXPECT_NEAR(-(s[0] + s[1] + s[2]) / 3.0, pressure[q], 1e-12 * scale);
    double const square = 0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)) +
                          3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
    EXPECT_NEAR(std::sqrt(square), mises[q], 1e-6 * scale);  // cancellation under the root: half the digits
    largest = std::max(largest, mises[q]);
  }
  EXPECT_GT(largest, 1e7);
}

TEST(ParticleFields, WhatABodyDoesNotCarryIsZero) {
  Watched const w(two_blocks());
  auto const body = field(w, "body");
  auto const material = field(w, "material");
  auto const temperature = field(w, "temperature");
  auto const pressure = field(w, "pressure");
  for (std::size_t q = 0; q < body.size(); ++q) {
    EXPECT_EQ(temperature[q], body[q] == 0.0 ? 293.0 : 0.0);
    // The second block is of the first one's material.
    EXPECT_EQ(material[q], body[q] == 2.0 ? 2.0 : 0.0);
    if (body[q] == 2.0) {
      EXPECT_NEAR(pressure[q], 1e5, 1e-3);
    }
  }
}

TEST(ParticleFields, BurnFractionFollowsTheDetonation) {
  Case c = charge_slab();
  Watched w(std::move(c));
  for (double const unburnt : field(w, "burn_fraction")) EXPECT_EQ(unburnt, 0.0);
  double const D = w.setup.particles.bodies[0].solid.detonation_speed;
  double const half = 0.5 * 0.02 / D;
  while (w.clock.time < half) advance(w, half);
  auto const burnt = field(w, "burn_fraction");
  auto const position = field(w, "position");
  double const h = w.setup.domain.h;
  for (std::size_t q = 0; q < burnt.size(); ++q) {
    // The particles have moved by less than a cell; the front is 1.5 cells wide.
    if (position[3 * q] < 0.01 - 3.5 * h) {
      EXPECT_EQ(burnt[q], 1.0);
    }
    if (position[3 * q] > 0.01 + 2.5 * h) {
      EXPECT_EQ(burnt[q], 0.0);
    }
  }
}

TEST(ParticleGauges, RideOnTheirParticle) {
  Watched w(two_blocks());
  w.sample_gauges();
  while (w.clock.step < 40) {
    advance(w, 1.0);
    w.sample_gauges();
  }
  ParticleGaugeHistory const& gauge = w.gauges.particles[0];
  ASSERT_EQ(gauge.particles.size(), 41U);
  EXPECT_NEAR(gauge.particles[0].position[0], 0.0195, 0.26e-3);  // half a particle's distance, on the left block
  EXPECT_EQ(norm(gauge.particles[0].displacement), 0.0);
  auto const& last = gauge.particles.back();
  auto const position = field(w, "position");
  auto const displacement = field(w, "displacement");
  auto const mises = field(w, "mises");
  auto const identity = field(w, "identity");
  auto const body = field(w, "body");
  int found = 0;
  for (std::size_t q = 0; q < body.size(); ++q) {
    if (body[q] != 0.0 || long(identity[q]) != gauge.identity) continue;
    ++found;
    for (int d = 0; d < 3; ++d) {
      EXPECT_EQ(last.position[d], position[3 * q + d]);
      EXPECT_EQ(last.displacement[d], displacement[3 * q + d]);
    }
    EXPECT_EQ(last.mises, mises[q]);
  }
  EXPECT_EQ(found, 1);
  EXPECT_GT(last.displacement[0], 1e-5);
  EXPECT_EQ(last.time, w.clock.time);

  auto const& watched = w.gauges.particles[1].bodies;
  ASSERT_EQ(watched.size(), 41U);
  EXPECT_EQ(watched.back().sums.kinetic_energy, mpm::sums(*w.regions.front().particles, 1).kinetic_energy);
  EXPECT_GT(watched.back().sums.kinetic_energy, watched.front().sums.kinetic_energy);
}

TEST(ParticleGauges, KeepTheirLastRecordWhenTheParticleLeaves) {
  Case c = two_blocks();
  c.particles.bodies[0].velocity = {-2000.0, 0.0, 0.0};
  c.particles.bodies.resize(1);
  c.particles.gauges.resize(1);
  c.domain.boundary[0] = grid::Boundary::outflow;
  Watched w(std::move(c));
  w.sample_gauges();
  while (w.regions.front().particles->accounts().losses.particles < 1600) {  // all 40 x 40
    advance(w, 1.0);
    w.sample_gauges();
    ASSERT_LT(w.clock.time, 2e-4) << "the block does not leave";
  }
  auto const& gauge = w.gauges.particles[0];
  EXPECT_TRUE(gauge.lost);
  ASSERT_GT(gauge.particles.size(), 10U);
  EXPECT_LT(gauge.particles.back().time, w.clock.time);
  EXPECT_LT(gauge.particles.back().position[0], 3e-3);
  EXPECT_EQ(mpm::particle_count(*w.regions.front().particles), 0);
  EXPECT_TRUE(field(w, "stress").empty());
  w.update_audit();
  EXPECT_LT(w.audit.relative_error().mass[0], 1e-12);
  auto const energy = w.energy_balance();
  EXPECT_NEAR(energy.lost / energy.initial, 1.0, 1e-3);
  EXPECT_NEAR(energy.drift(), 0.0, 1e-3);
}

TEST(BodyHistories, AreSampledAboutAThousandTimesAndAtBothEnds) {
  Watched w(charge_slab());
  w.setup.end.time = 1e-6;
  w.sample_gauges();
  while (!w.finished()) {
    advance(w, w.clock.time + 2e-10);  // five thousand steps
    w.sample_gauges();
  }
  ASSERT_EQ(w.gauges.bodies.size(), 1U);
  for (auto const& history : w.gauges.bodies) {
    EXPECT_GT(history.size(), 950U);
    EXPECT_LT(history.size(), 1005U);
    EXPECT_EQ(history.front().time, 0.0);
    EXPECT_EQ(history.back().time, w.clock.time);
  }
}

/// What outer forces do in 100 steps.
EnergyBalance after_steps(Case const& c) {
  Watched w{Case(c)};
  while (w.clock.step < 100) advance(w, 1.0);
  w.update_audit();
  return w.energy_balance();
}

TEST(EnergyBalance, CountsTheWorkOfOuterForces) {
  Case c = two_blocks();
  for (Body& body : c.particles.bodies) body.velocity = {0.0, 0.0, 0.0};
  EXPECT_EQ(after_steps(c).work, 0.0);
  // A body force that dwarfs what the blocks do to each other: all its work is kinetic energy, to the half step by
  // which velocity and position differ (1/100 of the time, of which the work depends quadratically).
  c.particles.options.body_force = {0.0, -1e7, 0.0};
  EnergyBalance const falling = after_steps(c);
  EXPECT_GT(falling.work, 0.0);
  EXPECT_NEAR(falling.current + falling.lost - falling.initial, falling.work, 0.02 * falling.work);
  c.particles.options.body_force = {0.0, 0.0, 0.0};
  c.particles.constraints = {{shape::Box{{0, 0, 0}, {1e-3, 1, 1}}, {true, false, false}, {0.0, 0.0, 0.0}, -1}};
  EXPECT_EQ(after_steps(c).work, 0.0) << "what holds still does no work";
}

TEST(EnergyBalance, DriftOfAnElasticImpactIsSmall) {
  Watched w(two_blocks());
  w.sample_gauges();
  while (w.clock.step < 100) {
    advance(w, 1.0);
    w.sample_gauges();
  }
  w.update_audit();
  auto const energy = w.energy_balance();
  EXPECT_GE(energy.scale, energy.initial);
  // The impact is dissipated by the grid that the blocks share; the method's other losses are far smaller.
  EXPECT_LT(std::abs(energy.drift()), 0.05);
  EXPECT_NE(energy.drift(), 0.0);
}

TEST(ParticleFields, HaveTheSameBitsForAnyNumberOfThreads) {
  std::vector<std::vector<double>> reference;
  for (int const count : {1, 2, 4}) {
    set_threads(count);
    Watched w(two_blocks());
    w.sample_gauges();
    while (w.clock.step < 40) {
      advance(w, 1.0);
      w.sample_gauges();
    }
    std::vector<std::vector<double>> all;
    for (FieldInfo const& info : known_particle_fields()) all.push_back(field(w, info.name));
    for (FieldInfo const& info : standing_particle_fields()) all.push_back(field(w, info.name));
    all.emplace_back();
    for (ParticleRecord const& r : w.gauges.particles[0].particles) {
      all.back().insert(all.back().end(), {r.time, r.position[0], r.velocity[0], r.velocity[1], r.pressure, r.mises});
    }
    all.emplace_back();
    for (auto const& history : w.gauges.bodies) {
      for (BodyRecord const& r : history) {
        all.back().insert(all.back().end(), {r.time, r.sums.kinetic_energy, r.sums.internal_energy, r.sums.centre[0]});
      }
    }
    if (reference.empty()) reference = all;
    ASSERT_EQ(all.size(), reference.size());
    for (std::size_t n = 0; n < all.size(); ++n) {
      ASSERT_EQ(all[n].size(), reference[n].size());
      EXPECT_EQ(std::memcmp(all[n].data(), reference[n].data(), all[n].size() * sizeof(double)), 0)
          << count << " threads, list " << n;
    }
  }
  set_threads(0);
}

}  // namespace
}  // namespace brisance::observe
