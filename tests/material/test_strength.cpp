/// Plasticity and failure of material points on single-particle paths against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/vec.hpp"
#include "particle_driver.hpp"

namespace {

using namespace brisance;
using namespace brisance::material;

constexpr double rho_steel = 7850.0;
double const root3 = std::numbers::sqrt3;

JohnsonCook const steel4340{80e9, 792e6, 510e6, 0.26, 0.014, 1.03, 1.0, 298.0, 1793.0};

Material johnson_cook_solid(JohnsonCook const& model) {
  Material solid = elastic_solid(rho_steel, 210e9, 0.3);
  solid.strength = model;
  solid.temperature = model.T_room;
  return solid;
}

/// [Cui14] Eq. (64) with the functions of the standard library.
double flow_stress(JohnsonCook const& j, double ep, double rate, double T) {
  double const hot = std::clamp((T - j.T_room) / (j.T_melt - j.T_room), 0.0, 1.0);
  return (j.A + j.B * std::pow(ep, j.n)) * (1.0 + j.C * std::log(std::max(1.0, rate / j.rate0))) *
         (1.0 - std::pow(hot, j.m));
}

TEST(VonMisesParticle, UniaxialStrainAndReversal) {
  // Perfectly plastic: |s_xx| = 2 Y / 3 from the strain Y / 2G on, the axial stress is -p -+ 2 Y / 3; the equivalent
  // plastic strain is 2/3 of the axial strain beyond. Reversed, the particle is elastic over the strain Y / G and then
  // yields the other way. No error of the step; 1e-12 is round-off.
  double const Y = 4e8;
  Particles particle(von_mises_solid(rho_steel, 210e9, 0.3, Y));
  double const G = shear_modulus(particle.solid.strength);
  double const K = std::get<Linear>(particle.solid.eos).K;
  double strain = 0.0;
  auto const squeeze = [&](double to, int steps) {
    double const ratio = std::exp((to - strain) / steps);
    for (int k = 0; k < steps; ++k) particle.step(stretch_x(ratio));
    strain = to;
  };
  squeeze(-0.9 * Y / (2.0 * G), 10);
  EXPECT_NEAR(particle.deviator[0][0], -0.9 * 2.0 / 3.0 * Y, 1e-12 * Y);
  EXPECT_EQ(particle.plastic_strain[0], 0.0);
  squeeze(-0.02, 33);
  EXPECT_NEAR(particle.deviator[0][0], -2.0 / 3.0 * Y, 1e-12 * Y);
  EXPECT_NEAR(particle.deviator[1][0], 1.0 / 3.0 * Y, 1e-12 * Y);
  EXPECT_NEAR(particle.mises(), Y, 1e-12 * Y);
  double const first = 2.0 / 3.0 * (0.02 - Y / (2.0 * G));
  EXPECT_NEAR(particle.plastic_strain[0], first, 1e-12);
  EXPECT_NEAR(particle.pressure[0], K * (std::exp(0.02) - 1.0), 1e-10 * K);
  squeeze(-0.02 + 0.5 * Y / G, 10);  // elastic, half of the way: no deviator is left
  EXPECT_NEAR(particle.deviator[0][0], 0.0, 1e-12 * Y);
  squeeze(0.0, 37);
  EXPECT_NEAR(particle.deviator[0][0], 2.0 / 3.0 * Y, 1e-12 * Y);
  EXPECT_NEAR(particle.plastic_strain[0], first + 2.0 / 3.0 * (0.02 - Y / G), 1e-12);
  EXPECT_NEAR(particle.pressure[0], 0.0, 1e-12 * K);
  // Back at the start: what is left in e is the plastic work and the elastic energy of the deviator. The yield begins
  // inside of a step, where the backward difference s1 : dep differs from the work by at most Y dep of those two steps.
  double const stored = particle.square() / (4.0 * G * rho_steel);
  EXPECT_NEAR(particle.energy[0], particle.plastic_work[0] + stored, 2.0 * Y / rho_steel * 0.02 / 33.0);
  EXPECT_NEAR(particle.plastic_work[0], Y * particle.plastic_strain[0] / rho_steel, 0.03 * particle.plastic_work[0])
      << "density varies by 2 per cent";
  EXPECT_NEAR(particle.energy[0], particle.work[0], 1e-13 * particle.path[0]);
}

TEST(VonMisesParticle, BilinearShear) {
  // sqrt3 tau = Y + H ep with ep = (sqrt3 G gamma - Y) / (3 G + H), whatever the step.
  double const Y = 3e8;
  double const H = 5e9;
  for (int steps : {1, 7, 100}) {
    Particles particle(von_mises_solid(rho_steel, 210e9, 0.3, Y, H));
    double const G = shear_modulus(particle.solid.strength);
    double const gamma = 0.05;
    for (int k = 0; k < steps; ++k) particle.step(pure_shear_xy(gamma / steps));
    double const ep = (root3 * G * gamma - Y) / (3.0 * G + H);
    EXPECT_NEAR(particle.plastic_strain[0], ep, 1e-13) << steps;
    EXPECT_NEAR(root3 * particle.deviator[3][0], Y + H * ep, 1e-12 * Y) << steps;
  }
}

TEST(VonMisesParticle, PlasticWorkHeats) {
  Material solid = von_mises_solid(rho_steel, 210e9, 0.3, 3e8);
  solid.specific_heat = 477.0;
  Particles particle(solid);
  for (int k = 0; k < 50; ++k) particle.step(pure_shear_xy(1e-3));
  EXPECT_NEAR(particle.plastic_work[0], 3e8 * particle.plastic_strain[0] / rho_steel, 1e-12 * particle.plastic_work[0]);
  EXPECT_NEAR(particle.temperature[0] - 293.0, 0.9 * particle.plastic_work[0] / 477.0, 1e-11);
  EXPECT_GT(particle.temperature[0], 293.4);
}

TEST(JohnsonCookParticle, FlowStressAtThreeRatesAndTwoTemperatures) {
  for (double rate : {1.0, 1e3, 1e5}) {
    for (double T : {298.0, 800.0}) {
      Material solid = johnson_cook_solid(steel4340);
      solid.temperature = T;
      Particles particle(solid);
      double const step = 1e-3;  // of equivalent strain; gamma = sqrt3 times that
      particle.data.dt = step / rate;
      double before = 0.0;
      for (int k = 0; k < 200; ++k) {
        before = particle.plastic_strain[0];
        particle.step(pure_shear_xy(root3 * step));
        // Consistency, with the rate that the step really had.
        double const own = flow_stress(steel4340, particle.plastic_strain[0],
                                       (particle.plastic_strain[0] - before) / particle.data.dt, T);
        if (k > 10) {
          EXPECT_NEAR(particle.mises() / own, 1.0, 1e-10) << rate << ' ' << T << ' ' << k;
        }
      }
      // Against the nominal rate, at ep = 0.2 - sigma/3G. The plastic rate is slower by H / 3G = 0.2 %, H = d sigma /
      // d ep: C times that is 3e-5.
      double sigma = steel4340.A;
      for (int k = 0; k < 20; ++k) sigma = flow_stress(steel4340, 0.2 - sigma / (3.0 * steel4340.G), rate, T);
      EXPECT_NEAR(root3 * particle.deviator[3][0] / sigma, 1.0, 3e-5) << rate << ' ' << T;
      EXPECT_NEAR(particle.plastic_strain[0], 0.2 - particle.mises() / (3.0 * steel4340.G), 1e-12);
    }
  }
}

TEST(JohnsonCookParticle, SlowFlowIsNotWeakened) {
  Particles slow(johnson_cook_solid(steel4340));
  slow.data.dt = 1e3;
  Particles at_reference(johnson_cook_solid(steel4340));
  at_reference.data.dt = 1e-3;
  for (int k = 0; k < 50; ++k) {
    slow.step(pure_shear_xy(root3 * 1e-3));
    at_reference.step(pure_shear_xy(root3 * 1e-3));
  }
  EXPECT_NEAR(slow.mises() / flow_stress(steel4340, slow.plastic_strain[0], 1e-6, 298.0), 1.0, 1e-10);
  EXPECT_NEAR(slow.mises(), at_reference.mises(), 1e-10 * slow.mises());
}

TEST(JohnsonCookParticle, ReversedShearHasNoMemoryOfDirection) {
  Particles particle(johnson_cook_solid(steel4340));
  particle.data.dt = 1e-6;
  for (int k = 0; k < 40; ++k) particle.step(pure_shear_xy(root3 * 1e-3));
  double const forward = particle.mises();
  double const ep = particle.plastic_strain[0];
  // Elastic on the way to the opposite yield, which begins slowly.
  double const slow = flow_stress(steel4340, ep, 0.0, 298.0);
  int const elastic = static_cast<int>((forward + slow) / (3.0 * steel4340.G * 1e-3));
  for (int k = 0; k < elastic; ++k) particle.step(pure_shear_xy(-root3 * 1e-3));
  EXPECT_EQ(particle.plastic_strain[0], ep);
  for (int k = 0; k < 40; ++k) particle.step(pure_shear_xy(-root3 * 1e-3));
  EXPECT_LT(particle.deviator[3][0], 0.0);
  double const before = particle.plastic_strain[0];
  particle.step(pure_shear_xy(-root3 * 1e-3));
  double const rate = (particle.plastic_strain[0] - before) / 1e-6;
  EXPECT_NEAR(particle.mises() / flow_stress(steel4340, particle.plastic_strain[0], rate, 298.0), 1.0, 1e-10);
}

TEST(JohnsonCookParticle, EveryStateIsReturnedToItsYieldStress) {
  // Random constants, strains, temperatures, rates and sizes of step, some far beyond any use: consistency to 1e-10 of
  // the yield stress. The rate is recomputed from the rounded difference of two plastic strains, so the increment
  // enters from a particle that starts at none wherever it is much smaller than the strain.
  std::mt19937 random(5);
  auto const between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  int yielded = 0;
  for (int k = 0; k < 20000; ++k) {
    JohnsonCook j = steel4340;
    j.n = between(0.05, 1.2);
    j.C = k % 7 == 0 ? 0.0 : between(0.0, 0.1);
    j.B = k % 11 == 0 ? 0.0 : j.B;
    j.m = between(0.3, 2.0);
    j.rate0 = k % 5 == 0 ? std::pow(10.0, between(-4.0, 3.0)) : 1.0;
    Material solid = johnson_cook_solid(j);
    solid.temperature = between(200.0, 1700.0);
    Particles particle(solid);
    double const start = k % 3 == 0 ? 0.0 : std::pow(10.0, between(-8.0, 0.5));
    particle.plastic_strain[0] = start;
    particle.data.dt = std::pow(10.0, between(-9.0, 0.0));
    double const stress = flow_stress(j, start, 0.0, solid.temperature);
    particle.deviator[3][0] = stress / root3 * between(0.9, 1.0);
    particle.step(pure_shear_xy(std::pow(10.0, between(-7.0, 0.0))));
    double const x = particle.plastic_strain[0] - start;
    if (x <= 0.0) continue;
    ++yielded;
    double const rounded = 2.3e-16 * (start + x) / x;  // of the increment
    double const own = flow_stress(j, start + x, x / particle.data.dt, solid.temperature);
    EXPECT_NEAR(particle.mises() / own, 1.0, 1e-10 + j.C * rounded) << k;
  }
  EXPECT_GT(yielded, 10000);
}

TEST(JohnsonCookParticle, MoltenParticleFlows) {
  Material solid = johnson_cook_solid(steel4340);
  solid.temperature = 2000.0;
  Particles particle(solid);
  particle.step(pure_shear_xy(0.01));
  EXPECT_NEAR(particle.mises(), 0.0, 1e-10 * steel4340.A);
  EXPECT_NEAR(particle.plastic_strain[0], 0.01 / root3, 1e-12);
}

TEST(JohnsonCookParticle, AdiabaticHeatingFollowsItsDifferentialEquation) {
  // Without rate term, in monotonic shear, with total equivalent strain E as time: q = sigma_y(ep, T) and
  // dq = 3 G (dE - dep) give dep/dE = 3 G / (3 G + d sigma_y/d ep + beta sigma_y/(rho cp) d sigma_y/dT), dT = beta
  // sigma_y/(rho cp) dep; classical Runge-Kutta method, 20000 steps. The particle is of first order: it softens with
  // the temperature at the start of the step.
  JohnsonCook j = steel4340;
  j.C = 0.0;
  double const cp = 477.0;
  double const start = 0.01;
  double const total = 0.5;
  double const heat = 0.9 / (rho_steel * cp);
  auto const stress = [&](double ep, double T) { return flow_stress(j, ep, 0.0, T); };
  auto const slope = [&](double ep, double T) {
    double const hot = (T - j.T_room) / (j.T_melt - j.T_room);
    double const soft = 1.0 - std::pow(hot, j.m);
    double const d_ep = j.B * j.n * std::pow(ep, j.n - 1.0) * soft;
    double const d_T = -(j.A + j.B * std::pow(ep, j.n)) * j.m * std::pow(hot, j.m - 1.0) / (j.T_melt - j.T_room);
    double const dep = 3.0 * j.G / (3.0 * j.G + d_ep + heat * stress(ep, T) * d_T);
    return std::array{dep, heat * stress(ep, T) * dep};
  };
  double ep = start;
  double T = 320.0;
  double const h = total / 20000.0;
  for (int k = 0; k < 20000; ++k) {
    auto const a = slope(ep, T);
    auto const b = slope(ep + 0.5 * h * a[0], T + 0.5 * h * a[1]);
    auto const c = slope(ep + 0.5 * h * b[0], T + 0.5 * h * b[1]);
    auto const d = slope(ep + h * c[0], T + h * c[1]);
    ep += h / 6.0 * (a[0] + 2.0 * b[0] + 2.0 * c[0] + d[0]);
    T += h / 6.0 * (a[1] + 2.0 * b[1] + 2.0 * c[1] + d[1]);
  }
  auto const error = [&](int steps) {
    Material solid = johnson_cook_solid(j);
    solid.specific_heat = cp;
    solid.temperature = 320.0;
    Particles particle(solid);
    particle.plastic_strain[0] = start;
    particle.deviator[3][0] = stress(start, 320.0) / root3;
    for (int k = 0; k < steps; ++k) particle.step(pure_shear_xy(root3 * total / steps));
    EXPECT_NEAR(particle.temperature[0] - 320.0, 0.9 * particle.plastic_work[0] / cp, 1e-9);
    return std::array{particle.temperature[0] - T, particle.mises() / stress(ep, T) - 1.0,
                      particle.plastic_strain[0] - ep};
  };
  auto const coarse = error(250);
  auto const fine = error(500);
  EXPECT_LT(std::abs(fine[0]), 0.1) << "of a rise of " << T - 320.0 << " K";
  EXPECT_LT(std::abs(fine[1]), 5e-4);
  EXPECT_NEAR(coarse[0] / fine[0], 2.0, 0.2);
  EXPECT_NEAR(coarse[1] / fine[1], 2.0, 0.2);
  EXPECT_LT(std::abs(fine[2]), 1e-5);
  EXPECT_GT(T - 320.0, 80.0);
}

JohnsonCookFailure const brittle{0.05, 0.3, -2.12, 0.02, 0.61};

TEST(JohnsonCookFailureParticle, DamageAtConstantTriaxiality) {
  // Perfect von Mises plasticity, isochoric shear under a constant pressure: D = ep / ef exactly, with the scales of
  // rate and temperature that hold without Johnson-Cook strength.
  double const Y = 4e8;
  for (double p : {-1.2e9, -3e8, 0.0, 5e8}) {
    Material solid = von_mises_solid(rho_steel, 210e9, 0.3, Y);
    solid.failure = brittle;
    Particles particle(solid);
    double const K = std::get<Linear>(solid.eos).K;
    particle.density[0] = rho_steel * (1.0 + p / K);
    particle.pressure[0] = p;
    double const triaxiality = std::min(-p / Y, 1.5);
    double const dt = 1e-6;
    particle.data.dt = dt;
    double const gamma = 1e-3;
    particle.step(pure_shear_xy(Y / (root3 * shear_modulus(solid.strength))));  // up to the yield stress
    double damage = 0.0;
    for (int k = 0; k < 20; ++k) {
      particle.step(pure_shear_xy(gamma));
      double const ef = (0.05 + 0.3 * std::exp(-2.12 * triaxiality)) * (1.0 + 0.02 * std::log(gamma / root3 / dt));
      damage = std::min(1.0, damage + gamma / root3 / ef);
      EXPECT_NEAR(particle.damage[0], damage, 1e-9) << p;
    }
    EXPECT_GT(damage, 0.0);
  }
}

TEST(JohnsonCookFailureParticle, ScalesAreThoseOfTheStrength) {
  JohnsonCook j = steel4340;
  j.rate0 = 10.0;
  Material solid = johnson_cook_solid(j);
  solid.failure = brittle;
  solid.temperature = 700.0;
  Particles particle(solid);
  particle.data.dt = 1e-6;
  for (int k = 0; k < 20; ++k) {
    double const before = particle.damage[0];
    double const ep = particle.plastic_strain[0];
    particle.step(pure_shear_xy(2e-3));
    double const x = particle.plastic_strain[0] - ep;
    if (x == 0.0) continue;
    double const hot = (700.0 - j.T_room) / (j.T_melt - j.T_room);
    double const ef = 0.35 * (1.0 + 0.02 * std::log(std::max(1.0, x / 1e-6 / 10.0))) * (1.0 + 0.61 * hot);
    EXPECT_NEAR(particle.damage[0] - before, x / ef, 1e-12);
  }
  EXPECT_GT(particle.damage[0], 0.02);
}

TEST(JohnsonCookFailureParticle, FailedParticleBearsOnlyPressure) {
  Material solid = johnson_cook_solid(steel4340);
  solid.failure = JohnsonCookFailure{0.01, 0.02, -2.12, 0.002, 0.61};
  solid.specific_heat = 477.0;
  Particles particle(solid);
  double before = 0.0;
  int steps = 0;
  for (; steps < 1000 && particle.damage[0] < 1.0; ++steps) {
    Increment d = pure_shear_xy(2e-3);
    d.strain[0] = d.strain[1] = d.strain[2] = 1e-5;
    particle.step(d);
    EXPECT_GE(particle.damage[0], before);
    EXPECT_LE(particle.damage[0], 1.0);
    before = particle.damage[0];
  }
  ASSERT_EQ(particle.damage[0], 1.0);
  EXPECT_LT(steps, 100);
  EXPECT_EQ(particle.mises(), 0.0);
  EXPECT_EQ(particle.pressure[0], 0.0) << "it was in tension";
  double const ep = particle.plastic_strain[0];
  double const T = particle.temperature[0];
  for (int k = 0; k < 10; ++k) particle.step(shear_xy(5e-2));
  EXPECT_EQ(particle.mises(), 0.0);
  EXPECT_EQ(particle.plastic_strain[0], ep);
  EXPECT_EQ(particle.temperature[0], T);
  EXPECT_EQ(particle.damage[0], 1.0);
  for (int k = 0; k < 10; ++k) particle.step(swell(0.998));
  EXPECT_NEAR(particle.pressure[0] / std::get<Linear>(solid.eos).reference(particle.density[0]), 1.0, 1e-12);
  EXPECT_GT(particle.pressure[0], 1e9);
  for (int k = 0; k < 40; ++k) particle.step(swell(1.002));
  EXPECT_EQ(particle.pressure[0], 0.0);
  EXPECT_NEAR(particle.energy[0], particle.work[0], 1e-13 * particle.path[0]);
  // Debris that drifts apart to a hundredth of its density is no faster than the solid.
  double const fastest = sound_speed(solid, solid.density, 0.0);
  for (int k = 0; k < 92; ++k) particle.step(swell(1.05));
  EXPECT_LT(particle.density[0], 0.012 * solid.density);
  EXPECT_LE(particle.sound_speed[0], fastest * (1.0 + 1e-9));
  EXPECT_GT(particle.sound_speed[0], 0.3 * fastest);
}

Material tearing(Spall spall) {
  Material solid = johnson_cook_solid(steel4340);
  solid.minimum_pressure = -2e9;
  solid.spall = spall;
  return solid;
}

TEST(SpallParticle, OpensWhereThePressureReachesTheLimit) {
  for (Spall const spall : {Spall::limit, Spall::pressure}) {
    Particles particle(tearing(spall));
    int steps = 0;
    for (; steps < 100 && particle.pressure[0] > -2e9; ++steps) particle.step(swell(1.0005));
    EXPECT_EQ(particle.pressure[0], -2e9);
    EXPECT_EQ(particle.damage[0], spall == Spall::pressure ? 1.0 : 0.0);
    particle.step(pure_shear_xy(1e-3));
    EXPECT_EQ(particle.pressure[0], spall == Spall::pressure ? 0.0 : -2e9);
    if (spall == Spall::pressure) {
      EXPECT_EQ(particle.mises(), 0.0);
    } else {
      EXPECT_GT(particle.mises(), 1e7);
    }
    // It bears pressure when it closes again, and never tension.
    for (int k = 0; k < 2 * steps; ++k) particle.step(swell(1.0 / 1.0006));
    EXPECT_GT(particle.pressure[0], 1e8);
    if (spall == Spall::pressure) {
      for (int k = 0; k < 400; ++k) {
        particle.step(swell(1.0005));
        EXPECT_GE(particle.pressure[0], 0.0);
      }
    }
    EXPECT_NEAR(particle.energy[0], particle.work[0], 1e-12 * particle.path[0]);
  }
}

TEST(SpallParticle, OpensWhereTheLargestPrincipalStressReachesTheLimit) {
  // Principal stresses in any directions, a little below the limit and a little above it.
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 200; ++n) {
    // Three directions at right angles.
    std::array<Vec3, 3> axis{};
    axis[0] = {normal(random), normal(random), normal(random)};
    axis[0] = (1.0 / norm(axis[0])) * axis[0];
    Vec3 const other{normal(random), normal(random), normal(random)};
    axis[1] = other - dot(other, axis[0]) * axis[0];
    axis[1] = (1.0 / norm(axis[1])) * axis[1];
    axis[2] = {axis[0][1] * axis[1][2] - axis[0][2] * axis[1][1], axis[0][2] * axis[1][0] - axis[0][0] * axis[1][2],
               axis[0][0] * axis[1][1] - axis[0][1] * axis[1][0]};
    bool const above = n % 2 == 0;
    std::array<double, 3> const principal{above ? 2.001e9 : 1.999e9, 1.8e9 + 0.05e9 * (n % 3), 1.7e9};
    std::array<std::array<double, 3>, 3> s{};
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) s[i][j] += principal[a] * axis[a][i] * axis[a][j];
      }
    }
    double const mean = (principal[0] + principal[1] + principal[2]) / 3.0;
    Material const solid = tearing(Spall::principal_stress);
    Particles particle(solid);
    std::array<double, 6> const deviator{s[0][0] - mean, s[1][1] - mean, s[2][2] - mean, s[0][1], s[1][2], s[2][0]};
    for (int c = 0; c < 6; ++c) particle.deviator[c][0] = deviator[c];
    // The density of that mean stress.
    auto const& eos = std::get<Linear>(solid.eos);
    particle.density[0] = eos.rho0 * (1.0 - mean / eos.K);
    particle.pressure[0] = -mean;
    particle.step(Increment{});
    EXPECT_EQ(particle.damage[0], above ? 1.0 : 0.0) << n;
  }
}

TEST(JohnsonCookFailureParticle, DamageIsMonotoneAndBoundedOnAnyPath) {
  Material solid = johnson_cook_solid(steel4340);
  solid.failure = JohnsonCookFailure{-0.77, 1.45, -0.47, 0.0, 1.6};  // D1 + D2 exp(1.5 D3) is negative
  solid.specific_heat = 477.0;
  solid.minimum_pressure = -2e9;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> amount(-5e-3, 5e-3);
  int failed = 0;
  for (int path = 0; path < 50; ++path) {
    Particles particle(solid);
    particle.data = {1e-7, 1e-3};
    double before = 0.0;
    for (int k = 0; k < 300; ++k) {
      Increment d;
      for (auto& x : d.strain) x = amount(random);
      for (auto& x : d.spin) x = amount(random);
      particle.step(d);
      ASSERT_GE(particle.damage[0], before);
      ASSERT_LE(particle.damage[0], 1.0);
      ASSERT_GE(particle.pressure[0], before < 1.0 && particle.damage[0] < 1.0 ? -2e9 : 0.0);
      before = particle.damage[0];
    }
    failed += before == 1.0 ? 1 : 0;
  }
  EXPECT_GT(failed, 0);
}

template <class Model>
void expect_defaults_in_range() {
  Model const model{};
  for (auto const& p : Model::parameters()) {
    EXPECT_GE(model.*p.member, p.minimum) << p.key;
    EXPECT_LE(model.*p.member, p.maximum) << p.key;
    if (!std::isnan(p.default_value)) {
      EXPECT_EQ(model.*p.member, p.default_value) << p.key;
    }
  }
}

TEST(ModelParameters, DefaultsAreInRange) {
  expect_defaults_in_range<Linear>();
  expect_defaults_in_range<NoStrength>();
  expect_defaults_in_range<Elastic>();
  expect_defaults_in_range<VonMises>();
  expect_defaults_in_range<JohnsonCook>();
  expect_defaults_in_range<NoFailure>();
  expect_defaults_in_range<JohnsonCookFailure>();
}

}  // namespace
