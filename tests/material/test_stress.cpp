/// Material points on single-particle paths against closed forms: kinematics, equations of state, viscosity, energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "particle_driver.hpp"

namespace {

using namespace brisance;
using namespace brisance::material;

constexpr double rho_steel = 7850.0;
Material steel() { return elastic_solid(rho_steel, 210e9, 0.3); }
double G_of(Material const& solid) { return shear_modulus(solid.strength); }
double K_of(Material const& solid) { return std::get<Linear>(solid.eos).K; }

Material air() {
  Material solid;
  solid.density = 1.225;
  solid.eos = IdealGas{1.4};
  solid.specific_energy = 101325.0 / (0.4 * 1.225);
  solid.minimum_pressure = 0.0;
  return solid;
}

Material armour() {
  Material solid;
  solid.density = rho_steel;
  solid.eos = MieGruneisen{};
  solid.strength = JohnsonCook{82e9, 950e6, 560e6, 0.26, 0.014, 1.0, 1.0, 293.0, 1793.0};
  solid.specific_heat = 477.0;
  return solid;
}

Explosive tnt() {
  Explosive explosive;
  explosive.products = Jwl{};
  explosive.energy = 6.993e9;
  explosive.detonation_speed = 6930.0;
  return explosive;
}

/// Errors of `error_with(n)` steps, 2n steps: the observed order.
double order(std::function<double(int)> const& error_with, int n) {
  return std::log2(std::abs(error_with(n)) / std::abs(error_with(2 * n)));
}

TEST(ElasticParticle, UniaxialStrainAndBack) {
  // Logarithmic strain adds up: s_xx = 4/3 G ln(l), p = K (1/l - 1), both without error of the step; 1e-12 is round-off
  // of 200 steps.
  Particles particle(steel());
  double const G = G_of(particle.solid);
  double const K = K_of(particle.solid);
  for (double length : {0.97, 1.02}) {
    Particles there(steel());
    for (int k = 0; k < 100; ++k) there.step(stretch_x(std::pow(length, 0.01)));
    double const s = 4.0 / 3.0 * G * std::log(length);
    double const p = K * (1.0 / length - 1.0);
    EXPECT_NEAR(there.density[0], rho_steel / length, 1e-12 * rho_steel);
    EXPECT_NEAR(there.deviator[0][0], s, 1e-12 * std::abs(s));
    EXPECT_NEAR(there.deviator[1][0], -0.5 * s, 1e-12 * std::abs(s));
    EXPECT_NEAR(there.deviator[2][0], -0.5 * s, 1e-12 * std::abs(s));
    EXPECT_EQ(there.deviator[3][0], 0.0);
    EXPECT_NEAR(there.pressure[0], p, 1e-10 * std::abs(p));  // rho/rho0 - 1 loses two digits
    // At the start the longitudinal modulus is K + 4/3 G; K grows with density.
    EXPECT_NEAR(there.sound_speed[0], std::sqrt((K / length + 4.0 / 3.0 * G) * length / rho_steel), 1e-9 * 6000.0);
    for (int k = 0; k < 100; ++k) there.step(stretch_x(std::pow(length, -0.01)));
    EXPECT_NEAR(there.deviator[0][0], 0.0, 1e-12 * std::abs(s));
    EXPECT_NEAR(there.pressure[0], 0.0, 1e-10 * std::abs(p));
    EXPECT_NEAR(there.energy[0], 0.0, 1e-12 * there.path[0]);
  }
}

TEST(ElasticParticle, SoundSpeedAtTheStart) {
  Material const solid = steel();
  double const M = 210e9 * (1.0 - 0.3) / ((1.0 + 0.3) * (1.0 - 2.0 * 0.3));  // modulus of uniaxial strain
  EXPECT_NEAR(sound_speed(solid, rho_steel, 0.0), std::sqrt(M / rho_steel), 1e-9);
  Particles particle(solid);
  particle.step(Increment{});
  EXPECT_NEAR(particle.sound_speed[0], std::sqrt(M / rho_steel), 1e-9);
}

TEST(ElasticParticle, SimpleShearIsTheJaumannSolution) {
  // Jaumann rate in simple shear: s_xy = G sin(gamma), s_xx = -s_yy = G (1 - cos(gamma)) [Dienes79].
  double const gamma = 2.0;
  double const G = G_of(steel());
  auto const error = [&](int steps, int component) {
    Particles particle(steel());
    for (int k = 0; k < steps; ++k) particle.step(shear_xy(gamma / steps));
    double const exact[] = {1.0 - std::cos(gamma), std::cos(gamma) - 1.0, 0.0, std::sin(gamma)};
    return particle.deviator[component][0] / G - exact[component];
  };
  for (int component : {0, 1, 3}) {
    // The error is -gamma (gamma/n)^2 / 12 times cosines: 7e-5 at 100 steps.
    EXPECT_LT(std::abs(error(100, component)), 1e-4) << component;
    EXPECT_NEAR(order([&](int n) { return error(n, component); }, 100), 2.0, 0.05) << component;
  }
  EXPECT_NEAR(error(100, 2), 0.0, 1e-14);
}

TEST(ElasticParticle, RigidRotationCarriesTheStressAlong) {
  // The midpoint rotation turns by 2 atan(w/2): with w = 2 tan(angle/2) the turn is exact.
  Particles particle(steel());
  double const start[] = {3e8, -1e8, -2e8, 4e7, -6e7, 9e7};
  for (int c = 0; c < 6; ++c) particle.deviator[c][0] = start[c];
  double const before = particle.square();
  auto const turn = [&](std::array<double, 3> const& axis, double angle, int steps) {
    Increment d;
    for (int c = 0; c < 3; ++c) d.spin[c] = axis[c] * 2.0 * std::tan(0.5 * angle / steps);
    for (int k = 0; k < steps; ++k) particle.step(d);
  };
  double const round_off = 1e-13 * 3e8;
  // A quarter turn about z takes x to y and y to -x, and the stress with it.
  turn({0.0, 0.0, 1.0}, 0.5 * std::numbers::pi, 9);
  double const quarter[] = {start[1], start[0], start[2], -start[3], start[5], -start[4]};
  for (int c = 0; c < 6; ++c) EXPECT_NEAR(particle.deviator[c][0], quarter[c], round_off) << c;
  EXPECT_NEAR(particle.square(), before, 1e-13 * before);
  turn({0.0, 0.0, 1.0}, 1.5 * std::numbers::pi, 27);
  for (int c = 0; c < 6; ++c) EXPECT_NEAR(particle.deviator[c][0], start[c], round_off) << c;
  // About x: y to z, z to -y. About y: z to x, x to -z.
  turn({1.0, 0.0, 0.0}, 0.5 * std::numbers::pi, 9);
  double const about_x[] = {start[0], start[2], start[1], -start[5], -start[4], start[3]};
  for (int c = 0; c < 6; ++c) EXPECT_NEAR(particle.deviator[c][0], about_x[c], round_off) << c;
  turn({1.0, 0.0, 0.0}, 1.5 * std::numbers::pi, 27);
  turn({0.0, 1.0, 0.0}, 0.5 * std::numbers::pi, 9);
  double const about_y[] = {start[2], start[1], start[0], start[4], -start[3], -start[5]};
  for (int c = 0; c < 6; ++c) EXPECT_NEAR(particle.deviator[c][0], about_y[c], round_off) << c;
  turn({0.0, 1.0, 0.0}, 1.5 * std::numbers::pi, 27);
  // Full turns about a skew axis.
  turn({2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0}, 2.0 * std::numbers::pi, 36);
  for (int c = 0; c < 6; ++c) EXPECT_NEAR(particle.deviator[c][0], start[c], round_off) << c;
  EXPECT_NEAR(particle.energy[0], 0.0, 1e-16);
  EXPECT_EQ(particle.density[0], rho_steel);
}

TEST(ElasticParticle, SpinOfTheStepTurnsToSecondOrder) {
  auto const error = [](int steps) {
    Particles particle(steel());
    particle.deviator[0][0] = 2e8;
    particle.deviator[1][0] = -2e8;
    Increment d;
    d.spin[2] = 0.25 * std::numbers::pi / steps;  // an eighth of a turn: all of the stress is shear
    for (int k = 0; k < steps; ++k) particle.step(d);
    return particle.deviator[0][0] / 2e8;
  };
  EXPECT_NEAR(order(error, 10), 2.0, 0.02);
}

TEST(ElasticParticle, ShearStoresItsElasticEnergyExactly) {
  // Isochoric strain with any spin: e = s:s / (4 G rho) to round-off, however large the steps.
  Particles particle(steel());
  std::mt19937 random(7);
  std::uniform_real_distribution<double> amount(-1e-2, 1e-2);
  for (int k = 0; k < 200; ++k) {
    Increment d;
    for (auto& x : d.strain) x = amount(random);
    d.strain[2] = -d.strain[0] - d.strain[1];
    d.volumetric = 0.0;
    for (auto& x : d.spin) x = 30.0 * amount(random);
    particle.step(d);
    EXPECT_NEAR(particle.energy[0], particle.square() / (4.0 * G_of(particle.solid) * rho_steel),
                1e-13 * particle.path[0]);
  }
}

TEST(ElasticParticle, HydrostaticPathHasNoDeviator) {
  Particles particle(steel());
  for (int k = 0; k < 50; ++k) particle.step(swell(0.999));
  double const ratio = std::pow(0.999, 50);
  double const K = K_of(particle.solid);
  EXPECT_NEAR(particle.pressure[0], K * (1.0 / ratio - 1.0), 1e-11 * K);
  EXPECT_LT(particle.mises(), 1e-12 * K);
  // With x = V/V0 and p = K (1/x - 1): e = K/rho0 (x - 1 - ln x). The trapezoidal rule in steps h over theta = 0.05
  // errs by p'' h^2 theta / 12, p'' = 2 K, on K theta^2 / 2: h^2 / (3 theta) = 6.7e-6.
  EXPECT_NEAR(particle.energy[0] / (K / rho_steel * (ratio - 1.0 - std::log(ratio))), 1.0, 8e-6);
}

TEST(GasParticle, IdealGasIsentrope) {
  // p = p0 (rho/rho0)^gamma, second order in the step, down to a tenth of the volume and up to ten times of it.
  for (double target : {0.1, 10.0}) {
    auto const error = [&](int steps) {
      Particles particle(air());
      for (int k = 0; k < steps; ++k) particle.step(swell(std::pow(target, 1.0 / steps)));
      return particle.pressure[0] / (101325.0 * std::pow(1.0 / target, 1.4)) - 1.0;
    };
    EXPECT_NEAR(order(error, 100), 2.0, 0.02) << target;
    EXPECT_LT(std::abs(error(200)), 1e-3) << target;
  }
  Particles particle(air());
  particle.step(Increment{});
  EXPECT_NEAR(particle.sound_speed[0], std::sqrt(1.4 * 101325.0 / 1.225), 1e-9);
}

TEST(GasParticle, JwlIsentrope) {
  // p_S = A exp(-R1 V) + B exp(-R2 V) + C V^-(1+w) with C from the energy at the start [Lee68]. From the
  // Chapman-Jouguet volume to sixteen times that of the explosive.
  Jwl const j{};
  double const V0 = 0.73;
  double const V1 = 16.0;
  double const rho_e = 9e9;  // per initial volume
  double const C =
      j.omega * std::pow(V0, j.omega) * (rho_e - j.A / j.R1 * std::exp(-j.R1 * V0) - j.B / j.R2 * std::exp(-j.R2 * V0));
  auto const isentrope = [&](double V) {
    return j.A * std::exp(-j.R1 * V) + j.B * std::exp(-j.R2 * V) + C * std::pow(V, -1.0 - j.omega);
  };
  auto const error = [&](int steps) {
    Material solid;
    solid.density = j.rho0 / V0;
    solid.eos = j;
    solid.specific_energy = rho_e / j.rho0;
    Particles particle(solid);
    EXPECT_NEAR(particle.pressure[0] / isentrope(V0), 1.0, 1e-12);
    for (int k = 0; k < steps; ++k) particle.step(swell(std::pow(V1 / V0, 1.0 / steps)));
    return particle.pressure[0] / isentrope(V1) - 1.0;
  };
  EXPECT_NEAR(order(error, 200), 2.0, 0.02);
  EXPECT_LT(std::abs(error(800)), 1e-4);
}

/// Mie-Grueneisen steel without strength, compressed to V1 = ratio V0.
Material liquid_steel() {
  Material solid = armour();
  solid.strength = NoStrength{};
  return solid;
}

TEST(MieGruneisenParticle, IsentropeIsSecondOrder) {
  // Reference: de = -p dV by the classical Runge-Kutta method in 4000 steps.
  MieGruneisen const m{};
  double const ratio = 0.85;
  double e = 0.0;
  double V = 1.0 / rho_steel;
  double const h = (ratio - 1.0) * V / 4000.0;
  auto const slope = [&](double v, double energy) { return -pressure(m, 1.0 / v, energy); };
  for (int k = 0; k < 4000; ++k) {
    double const k1 = slope(V, e);
    double const k2 = slope(V + 0.5 * h, e + 0.5 * h * k1);
    double const k3 = slope(V + 0.5 * h, e + 0.5 * h * k2);
    double const k4 = slope(V + h, e + h * k3);
    e += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    V += h;
  }
  auto const error = [&](int steps) {
    Particles particle(liquid_steel());
    for (int k = 0; k < steps; ++k) particle.step(swell(std::pow(ratio, 1.0 / steps)));
    return particle.energy[0] / e - 1.0;
  };
  EXPECT_NEAR(order(error, 50), 2.0, 0.02);
  EXPECT_LT(std::abs(error(100)), 1e-4);
}

TEST(MieGruneisenParticle, SteadyShockEndsOnTheHugoniot) {
  // In a steady shock p + q runs along the Rayleigh line, p + q = p1 (V0 - V)/(V0 - V1). Every step takes the time at
  // which the viscosity closes that balance at the middle of the step; the work is then the area below a straight line,
  // without error of the step, and e1 = p1 (V0 - V1)/2.
  MieGruneisen const m{};
  for (double ratio : {0.98, 0.9, 0.8}) {
    double const V0 = 1.0 / rho_steel;
    double const V1 = ratio * V0;
    // p1 = f + G rho1 e1 with e1 = p1 (V0 - V1)/2.
    double const p1 = m.reference(1.0 / V1) / (1.0 - 0.5 * m.Gamma / V1 * (V0 - V1));
    double const speed = V0 * std::sqrt(p1 / (V0 - V1));
    EXPECT_NEAR(speed / (m.C0 + m.S * p1 / (rho_steel * speed)), 1.0, 0.02) << "Us = C0 + S up, up to the cubic's rest";
    Particles particle(liquid_steel());
    int const steps = 200;
    double largest_q = 0.0;
    for (int k = 0; k < steps; ++k) {
      double const start = V0 + (V1 - V0) * k / steps;
      double const end = V0 + (V1 - V0) * (k + 1) / steps;
      double const wanted = p1 * (V0 - 0.5 * (start + end)) / (V0 - V1);
      auto const tried = [&](double dt) {
        Particles trial = particle;
        trial.data.dt = dt;
        trial.data.length = 1e-3;
        trial.step(swell(end / start));
        return trial;
      };
      double shortest = 1e-16;
      double longest = 1e3;
      for (int halving = 0; halving < 80; ++halving) {
        double const dt = std::sqrt(shortest * longest);
        Particles const trial = tried(dt);
        double const acting = 0.5 * (particle.pressure[0] + trial.pressure[0]) + trial.viscosity[0];
        (acting > wanted ? shortest : longest) = dt;
      }
      particle = tried(std::sqrt(shortest * longest));
      largest_q = std::max(largest_q, particle.viscosity[0]);
    }
    EXPECT_GT(largest_q, 0.01 * p1) << "the shock is viscous";
    // The last step is midway between wanted and reached: its q is the step's share, 1/steps of p1.
    EXPECT_LT(particle.viscosity[0], 0.01 * p1);
    EXPECT_NEAR(particle.pressure[0] / p1, 1.0, 1e-9) << ratio;
    EXPECT_NEAR(particle.energy[0] / (0.5 * p1 * (V0 - V1)), 1.0, 1e-9) << ratio;
  }
}

TEST(ViscosityOfAParticle, FormulaInCompressionOnly) {
  Particles particle(liquid_steel());
  particle.data = {1e-7, 2e-3};
  double const rate = 1e-3 / 1e-7;
  particle.step(swell(1.0 - 1e-3));
  double const rho = rho_steel / (1.0 - 1e-3);
  // Sound speed of the new density and the energy before the step, here 0.
  double const c = sound_speed(MieGruneisen{}, rho, pressure(MieGruneisen{}, rho, 0.0));
  double const q = rho * 2e-3 * (0.06 * c * rate + 1.5 * 2e-3 * rate * rate);
  EXPECT_NEAR(particle.viscosity[0] / q, 1.0, 1e-12);
  particle.step(swell(1.0 + 1e-3));
  EXPECT_EQ(particle.viscosity[0], 0.0);
  particle.data.linear_viscosity = 0.0;
  particle.step(swell(1.0 - 1e-3));
  EXPECT_NEAR(particle.viscosity[0] / (particle.density[0] * 1.5 * 4e-6 * rate * rate), 1.0, 1e-12);
}

TEST(BurningParticle, PressureIsTheBurntPart) {
  Material const solid = of(tnt());
  EXPECT_TRUE(solid.burns());
  EXPECT_EQ(start_pressure(solid), 0.0);
  Particles particle(solid);
  Increment still;
  still.burn = 0.0;
  particle.step(still);
  EXPECT_EQ(particle.pressure[0], 0.0);
  EXPECT_EQ(particle.energy[0], solid.specific_energy);
  EXPECT_EQ(particle.sound_speed[0], 6930.0) << "the front runs through the unburnt";
  Increment burning;
  burning.volumetric = -0.01;
  burning.burn = 0.4;
  particle.step(burning);
  EXPECT_NEAR(particle.pressure[0] / (0.4 * pressure(Jwl{}, particle.density[0], particle.energy[0])), 1.0, 1e-12);
  burning.burn = 1.0;
  particle.step(burning);
  EXPECT_NEAR(particle.pressure[0] / pressure(Jwl{}, particle.density[0], particle.energy[0]), 1.0, 1e-12);
  Increment thin;
  thin.volumetric = 0.8;
  for (int k = 0; k < 10; ++k) particle.step(thin);
  EXPECT_NEAR(particle.sound_speed[0], sound_speed(Jwl{}, particle.density[0], particle.pressure[0]), 1e-9);
  EXPECT_LT(particle.sound_speed[0], 1500.0);
  EXPECT_NEAR(particle.energy[0] - solid.specific_energy, particle.work[0], 1e-14 * solid.specific_energy);
  EXPECT_LT(particle.work[0], 0.0);
}

TEST(ParticleTension, PressureIsNotBelowTheCutOffAndTheWorkIsCounted) {
  Material solid = liquid_steel();
  solid.minimum_pressure = -2e9;
  Particles particle(solid);
  double lowest = 0.0;
  double const ratio = 1.001;
  for (int k = 0; k < 100; ++k) {
    particle.step(swell(ratio));
    lowest = std::min(lowest, particle.pressure[0]);
  }
  EXPECT_EQ(lowest, -2e9);
  EXPECT_EQ(particle.pressure[0], -2e9);
  double const V = 1.0 / particle.density[0];
  double const e = particle.energy[0];
  for (int k = 0; k < 10; ++k) particle.step(swell(ratio));
  // The cut tension pulls: its work heats, p dV at constant p is exact.
  EXPECT_NEAR((particle.energy[0] - e) / (2e9 * (1.0 / particle.density[0] - V)), 1.0, 1e-10);
  EXPECT_NEAR(particle.energy[0], particle.work[0], 1e-13 * particle.path[0]);
  // Back to the density of the start: a closed cycle creates no energy.
  for (int k = 0; k < 110; ++k) particle.step(swell(1.0 / ratio));
  EXPECT_NEAR(particle.density[0], rho_steel, 1e-10 * rho_steel);
  EXPECT_GE(particle.energy[0], -1e-13 * particle.path[0]);
  EXPECT_NEAR(particle.energy[0], particle.work[0], 1e-13 * particle.path[0]);
}

std::vector<Material> zoo() {
  Material plastic = von_mises_solid(rho_steel, 210e9, 0.3, 4e8, 2e9);
  plastic.specific_heat = 477.0;
  Material failing = armour();
  failing.failure = JohnsonCookFailure{0.01, 0.05, -2.12, 0.002, 0.61};
  failing.minimum_pressure = -3e9;
  Material water;
  water.density = 1000.0;
  water.eos = StiffenedGas{4.4, 6e8};
  water.specific_energy = internal_energy(StiffenedGas{4.4, 6e8}, 1000.0, 101325.0);
  water.minimum_pressure = 0.0;
  return {steel(), plastic, armour(), failing, air(), water, of(tnt())};
}

Increment random_increment(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> amount(-size, size);
  Increment d;
  for (auto& x : d.strain) x = amount(random);
  for (auto& x : d.spin) x = amount(random);
  d.burn = 0.5 + amount(random);
  return d;
}

TEST(ParticleEnergy, ChangeIsTheSumOfTheWorks) {
  // Every model, rotation, viscosity, yielding, failure and cut-off included: the works (s0 + s1)/2 : de and
  // -((p0 + p1)/2 + q) dV, summed outside, are the change of e. 1e-14 per step of what is added: round-off.
  for (auto const& solid : zoo()) {
    Particles particle(solid);
    particle.data = {1e-7, 1e-3};
    std::mt19937 random(11);
    double largest = solid.specific_energy;
    for (int k = 0; k < 400; ++k) {
      particle.step(random_increment(random, 4e-3));
      largest = std::max(largest, std::abs(particle.energy[0]));
    }
    EXPECT_NEAR(particle.energy[0] - solid.specific_energy, particle.work[0],
                1e-14 * (particle.path[0] + 400.0 * largest));
    EXPECT_GT(particle.path[0], 0.0);
  }
}

TEST(ParticleChunks, ManyParticlesAreTreatedAsOne) {
  // 37 particles fill no whole number of vectors, 300 no whole number of chunks; the results agree bit for bit.
  for (auto const& solid : zoo()) {
    for (int n : {37, 300}) {
      Particles many(solid, n);
      std::vector<Particles> single(n, Particles(solid));
      many.data = {1e-7, 1e-3};
      std::mt19937 random(3);
      for (int k = 0; k < 20; ++k) {
        std::vector<Increment> increments;
        increments.reserve(n);
        for (int i = 0; i < n; ++i) increments.push_back(random_increment(random, i % 3 == 0 ? 1e-5 : 4e-3));
        many.step(increments);
        for (int i = 0; i < n; ++i) {
          single[i].data = many.data;
          single[i].step(increments[i]);
        }
      }
      for (int i = 0; i < n; ++i) {
        for (int c = 0; c < 6; ++c) ASSERT_EQ(many.deviator[c][i], single[i].deviator[c][0]) << i;
        ASSERT_EQ(many.pressure[i], single[i].pressure[0]) << i;
        ASSERT_EQ(many.viscosity[i], single[i].viscosity[0]) << i;
        ASSERT_EQ(many.density[i], single[i].density[0]) << i;
        ASSERT_EQ(many.energy[i], single[i].energy[0]) << i;
        ASSERT_EQ(many.plastic_strain[i], single[i].plastic_strain[0]) << i;
        ASSERT_EQ(many.plastic_work[i], single[i].plastic_work[0]) << i;
        ASSERT_EQ(many.temperature[i], single[i].temperature[0]) << i;
        ASSERT_EQ(many.damage[i], single[i].damage[0]) << i;
        ASSERT_EQ(many.sound_speed[i], single[i].sound_speed[0]) << i;
      }
    }
  }
}

TEST(ParticleGuards, AbsurdStepsStayFinite) {
  for (auto const& solid : zoo()) {
    for (double volumetric : {-5.0, -1.0, -0.89, 3.0}) {
      Particles particle(solid);
      particle.data = {1e-7, 1e-3};
      Increment d;
      d.strain = {volumetric, 0.0, 0.0, 2.0, -1.0, 0.5};
      d.spin = {3.0, -50.0, 7.0};
      for (int k = 0; k < 3; ++k) particle.step(d);
      EXPECT_TRUE(std::isfinite(particle.pressure[0]) && std::isfinite(particle.energy[0]) &&
                  std::isfinite(particle.mises()));
      EXPECT_TRUE(std::isfinite(particle.sound_speed[0]) && std::isfinite(particle.temperature[0]));
      EXPECT_GT(particle.density[0], 0.0);
      d.volumetric = std::nan("");
      particle.step(d);
      EXPECT_TRUE(std::isnan(particle.density[0]) && std::isnan(particle.energy[0]))
          << "what is not a number is not hidden";
    }
  }
}

TEST(ParticleGuards, CrushingAlwaysHeats) {
  // Beyond G (1 - 1/(1 + d eps_v)) / 2 = 1 the implicit energy would turn negative.
  for (auto const& solid : {air(), of(tnt())}) {
    for (double volumetric : {-0.5, -0.8, -0.89}) {
      Particles particle(solid);
      Increment d;
      d.volumetric = volumetric;
      particle.step(d);
      EXPECT_GT(particle.energy[0], solid.specific_energy) << volumetric;
      EXPECT_GT(particle.pressure[0], start_pressure(solid)) << volumetric;
    }
  }
}

TEST(SolidFields, FollowFromTheModels) {
  EXPECT_FALSE(air().has_deviator());
  EXPECT_TRUE(steel().has_deviator());
  EXPECT_FALSE(steel().plastic());
  Material solid = von_mises_solid(rho_steel, 210e9, 0.3, 4e8);
  EXPECT_TRUE(solid.plastic());
  EXPECT_FALSE(solid.heats());
  solid.specific_heat = 477.0;
  EXPECT_TRUE(solid.heats());
  EXPECT_FALSE(solid.damages());
  solid.failure = JohnsonCookFailure{};
  EXPECT_TRUE(solid.damages());
  solid.strength = Elastic{};
  EXPECT_FALSE(solid.damages()) << "damage grows with plastic strain only";
  EXPECT_FALSE(solid.heats());
  EXPECT_FALSE(solid.burns());
  Fluid fluid{"air", "", IdealGas{1.4}, 1.225, 101325.0};
  EXPECT_NEAR(start_pressure(of(fluid)), 101325.0, 1e-8);
}

}  // namespace
