/// Drucker-Prager on paths of a single particle against closed forms, [Cui14] Eqs. (59)-(63).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "stress_paths.hpp"

namespace {

using namespace brisance;
using namespace brisance::material;

constexpr double E = 100e6;
constexpr double nu = 0.3;
constexpr double cohesion = 0.11e6;

Material soil(double friction, double dilation, double tension) {
  Material solid = elastic_solid(1200.0, E, nu);
  DruckerPrager model;
  model.G = shear_modulus_of(E, nu);
  model.cohesion = cohesion;
  model.friction = friction;
  model.dilation = dilation;
  model.tension = tension;
  solid.strength = model;
  return solid;
}

DruckerPrager const& model_of(Particles const& p) { return std::get<DruckerPrager>(p.solid.strength); }
double tau(Particles const& p) { return p.mises() / std::numbers::sqrt3; }

/// Brings a point to a pressure [Pa] without shear.
void press(Particles& particle, double pressure) {
  double const K = bulk_modulus_of(E, nu);
  particle.step(swell(1.0 / (1.0 + pressure / K)));
}

TEST(Soil, TriaxialCompressionIsThatOfMohrAndCoulomb) {
  // The cone touches the pyramid at triaxial compression: sigma_1 = sigma_3 N + 2 c sqrt(N), N = (1 + sin) / (1 - sin).
  // The return is closed in form: 1e-8 covers the bisection of the lateral stress.
  for (double const friction : {20.0, 35.0}) {
    for (double const dilation : {0.0, 10.0}) {
      for (double const confinement : {0.0, 0.2e6, 1e6}) {
        Particles particle(soil(friction, dilation, 1e9));
        press(particle, confinement);
        for (int k = 0; k < 200; ++k) step_with_lateral_stress(particle, -2e-4, -confinement);
        double const s = std::sin(friction * std::numbers::pi / 180.0);
        double const N = (1.0 + s) / (1.0 - s);
        double const exact = confinement * N + 2.0 * cohesion * std::sqrt(N);
        EXPECT_NEAR(-axial_stress(particle) / exact, 1.0, 1e-8) << friction << ' ' << dilation << ' ' << confinement;
      }
    }
  }
}

TEST(Soil, TriaxialExtension) {
  // On the cone with sigma_1 = sigma_2 the compressions: tau = (s3' - s1') / sqrt3, s_m = (2 s1' + s3') / 3.
  double const friction = 20.0;
  double const confinement = 1e6;
  Particles particle(soil(friction, 0.0, 1e9));
  press(particle, confinement);
  for (int k = 0; k < 60; ++k) step_with_lateral_stress(particle, 2e-3, -confinement);
  double const q = DruckerPrager::slope(friction);
  double const k = model_of(particle).k();
  // tau + q s_m = k with tau = (x + P) / sqrt3, s_m = (x - 2 P) / 3, x the axial stress, P the confinement.
  double const r3 = std::numbers::sqrt3;
  double const x = (k - confinement / r3 + 2.0 / 3.0 * q * confinement) / (1.0 / r3 + q / 3.0);
  EXPECT_NEAR(axial_stress(particle) / x, 1.0, 1e-8);
  EXPECT_GT(x, -confinement);
}

TEST(Soil, DilationIsTheRatioOfTheFlow) {
  // On the cone d eps_v^p / d gamma^p = q_psi, with gamma^p = 2 (d e^p) in sqrt(J2) measure: the plastic volume strain
  // is q_psi sqrt3 d ep. At constant confinement the elastic volume strain stays.
  for (double const dilation : {0.0, 5.0, 20.0}) {
    Particles particle(soil(20.0, dilation, 1e9));
    press(particle, 1e6);
    for (int k = 0; k < 60; ++k) step_with_lateral_stress(particle, -2e-3, -1e6);
    Particles const before = particle;
    for (int k = 0; k < 10; ++k) step_with_lateral_stress(particle, -1e-4, -1e6);
    double const swelled = std::log(before.density[0] / particle.density[0]);
    double const sheared = particle.plastic_strain[0] - before.plastic_strain[0];
    // dp = K d(rho/rho0): the volume strain that gives back a change of the pressure is larger by rho0 / rho. The
    // density changes by 1e-3 over the ten steps.
    EXPECT_NEAR(swelled * particle.density[0] / 1200.0, DruckerPrager::slope(dilation) * std::numbers::sqrt3 * sheared,
                1e-3 * sheared)
        << dilation;
  }
}

TEST(Soil, UniaxialTensionEndsOnTheConeOrTheTensionPlane) {
  // Wide cut-off: the cone, x / sqrt3 + q x / 3 = k. Narrow: the mean stress stays at s_t, and stretched on, the shear
  // ends at that of the corner at most.
  Particles wide(soil(20.0, 0.0, 1e9));
  double const q = DruckerPrager::slope(20.0);
  double const k = model_of(wide).k();
  double most = 0.0;
  for (int n = 0; n < 4000; ++n) {
    step_with_lateral_stress(wide, 1e-6, 0.0);
    most = std::max(most, axial_stress(wide));
  }
  EXPECT_NEAR(most / (k / (1.0 / std::numbers::sqrt3 + q / 3.0)), 1.0, 1e-8);

  double const s_t = 0.02e6;
  Particles narrow(soil(20.0, 0.0, s_t));
  for (int n = 0; n < 20; ++n) narrow.step(stretch_x(1.0 + 1e-4));
  EXPECT_NEAR(narrow.pressure[0], -s_t, 1e-8 * s_t);
  EXPECT_LE(tau(narrow), (k - q * s_t) * (1.0 + 1e-8));
}

TEST(Soil, TensileStrengthIsNotBeyondTheApex) {
  Particles particle(soil(20.0, 0.0, 1e9));
  double const apex = model_of(particle).k() / DruckerPrager::slope(20.0);
  EXPECT_NEAR(apex, cohesion / std::tan(20.0 * std::numbers::pi / 180.0), 1e-8 * apex);
  for (int n = 0; n < 100; ++n) particle.step(swell(1.001));
  EXPECT_NEAR(particle.pressure[0], -apex, 1e-8 * apex);
  EXPECT_NEAR(particle.mises(), 0.0, 1e-8 * apex);
}

TEST(Soil, ReturnsFromAnywhereAreTheClosestTheFlowAllows) {
  // A million of trial states in all regions, against the three closed forms, told apart by where they end: the cone
  // (flow along (G, K q_psi)), the plane, the corner. Round-off: 1e-8 of the cohesion.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int seen[4] = {};
  for (int n = 0; n < 1000000; ++n) {
    DruckerPrager model;
    model.G = shear_modulus_of(E, nu);
    model.cohesion = cohesion;
    model.friction = 5.0 + 40.0 * uniform(random);
    model.dilation = model.friction * uniform(random);
    double const K = bulk_modulus_of(E, nu);
    double const q = DruckerPrager::slope(model.friction);
    double const q_flow = DruckerPrager::slope(model.dilation);
    double const k = model.k();
    model.tension = 1.2 * k / q * uniform(random);
    double const s_t = std::min(model.tension, k / q);
    double const trial = 4.0 * cohesion * uniform(random);
    double const mean = cohesion * (8.0 * uniform(random) - 4.0);
    auto const end = model.cone(K).returned(trial, mean);
    double const tolerance = 1e-8 * cohesion;
    ASSERT_LE(end.tau + q * end.mean, k + tolerance);
    ASSERT_LE(end.mean, s_t + tolerance);
    ASSERT_GE(end.tau, -tolerance);
    double const excess = trial + q * mean - k;
    double const corner = k - q * s_t;
    double const h = trial - corner - (std::sqrt(1.0 + q * q) - q) * (mean - s_t);  // Eq. (59)
    if (excess <= 0.0 && mean <= s_t) {
      ++seen[0];
      ASSERT_EQ(end.tau, trial);
      ASSERT_EQ(end.mean, mean);
    } else if (mean > s_t && h <= 0.0) {
      ++seen[1];
      ASSERT_NEAR(end.mean, s_t, tolerance);
      ASSERT_NEAR(end.tau, std::min(trial, corner), tolerance);
    } else {
      double const multiplier = excess / (model.G + K * q * q_flow);
      if (mean - K * q_flow * multiplier <= s_t) {
        ++seen[2];
        ASSERT_NEAR(end.tau, trial - model.G * multiplier, tolerance);
        ASSERT_NEAR(end.tau + q * end.mean, k, tolerance);
      } else {
        ++seen[3];
        ASSERT_NEAR(end.tau, corner, tolerance);
        ASSERT_NEAR(end.mean, s_t, tolerance);
      }
    }
  }
  for (int const count : seen) EXPECT_GT(count, 1000);
}

TEST(Soil, WithoutYieldItIsLinearElasticAndReversible) {
  Particles particle(soil(20.0, 0.0, 1e9));
  Particles elastic(elastic_solid(1200.0, E, nu));
  for (int n = 0; n < 50; ++n) {
    double const sign = n < 25 ? -1.0 : 1.0;
    Increment d = swell(1.0 + sign * 1e-5);
    d.strain[3] = sign * 1e-6;
    particle.step(d);
    elastic.step(d);
    EXPECT_NEAR(particle.pressure[0], elastic.pressure[0], 1e-12 * E);
    EXPECT_NEAR(particle.deviator[3][0], elastic.deviator[3][0], 1e-12 * E);
    // The density, known to 1e-16, changes by 1e-5 a step: 1e-9 of the energy covers its round-off.
    EXPECT_NEAR(particle.energy[0], elastic.energy[0], 1e-9 * elastic.path[0]);
  }
}

TEST(Soil, EnergyIsTheWorkOfTheStresses) {
  Particles particles(soil(25.0, 10.0, 0.01e6), 32);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int step = 0; step < 200; ++step) {
    std::vector<Increment> increments(32);
    for (auto& d : increments) {
      for (double& e : d.strain) e = 2e-3 * normal(random);
      for (double& w : d.spin) w = 2e-3 * normal(random);
    }
    particles.step(increments);
  }
  for (int k = 0; k < 32; ++k) {
    EXPECT_NEAR(particles.energy[k], particles.work[k], 1e-12 * particles.path[k]);
    EXPECT_GT(particles.plastic_strain[k], 0.0);
  }
  // What is thrown up and drifts apart is no faster than the ground.
  double const fastest = sound_speed(particles.solid, particles.solid.density, 0.0);
  for (int step = 0; step < 92; ++step) particles.step(std::vector<Increment>(32, swell(1.05)));
  for (int k = 0; k < 32; ++k) {
    EXPECT_LT(particles.density[k], 0.02 * particles.solid.density);
    EXPECT_LE(particles.sound_speed[k], fastest * (1.0 + 1e-9));
  }
}

}  // namespace
