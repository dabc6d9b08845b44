/// Material points that mix two fluids, against the closure of gas cells, pure fluids and integrated isentropes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "particle_driver.hpp"

namespace {

using namespace brisance;
using namespace brisance::material;

constexpr double p_air = 101325.0;
constexpr double rho_air = 1.225;

Fluids air_and(Eos const& second, Eos const& ambient = IdealGas{1.4}) { return {{ambient, second}, 2, p_air}; }

/// State of a particle: the fluids' own densities [kg/m3], the volume fraction of the second, the pressure [Pa].
struct Blend {
  double first = rho_air;
  double second = 0.0;
  double alpha = 0.0;
  double pressure = p_air;
};

/// Particles that mix, each in its own state.
Particles particles_of(Fluids const& fluids, std::vector<Blend> const& states) {
  Particles particles(gas_of(fluids, rho_air, p_air), static_cast<int>(states.size()));
  for (std::size_t i = 0; i < states.size(); ++i) {
    Blend const& s = states[i];
    double const first = (1.0 - s.alpha) * s.first;
    double const second = s.alpha * s.second;
    double const rho = first + second;
    particles.mass_fraction.push_back(second / rho);
    particles.volume_fraction.push_back(s.alpha);
    particles.density[i] = rho;
    particles.pressure[i] = s.pressure;
    particles.energy[i] = mixture(fluids, {first, second}, Fractions::of(1, s.alpha)).rho_e(s.pressure) / rho;
  }
  return particles;
}

/// The closure of particle i as a gas cell would have it.
Mixture cell_of(Particles const& particles, int i) {
  double const second = particles.mass_fraction[i] * particles.density[i];
  return mixture(*particles.solid.mixture, {particles.density[i] - second, second},
                 Fractions::of(1, particles.volume_fraction[i]));
}

/// Pairs of fluids with a state in which they mix; the volume fraction is still free.
std::vector<std::pair<Fluids, Blend>> pairs() {
  return {{air_and(Jwl{}), {rho_air, 1200.0, 0.0, 5e9}},
          {air_and(Jwl{}), {rho_air, 1.0, 0.0, p_air}},
          {air_and(StiffenedGas{}), {rho_air, 1000.0, 0.0, p_air}},
          {air_and(Jwl{}, MieGruneisen{}), {8000.0, 1200.0, 0.0, 5e9}},
          {air_and(IdealGas{1.4}, Jwl{}), {900.0, 10.0, 0.0, 1e9}},
          {air_and(Jwl{}, StiffenedGas{}), {1010.0, 900.0, 0.0, 1e9}}};
}

constexpr std::array fractions{0.0, 1e-13, 1e-3, 0.3, 0.7, 0.999, 1.0};

Increment random_swell(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> amount(-size, size);
  Increment d;
  d.volumetric = amount(random);
  return d;
}

TEST(MixedParticle, PressureOfProductsInAirByHand) {
  // rho e = (1 - alpha) p/(gamma - 1) + alpha (p - f)/omega with the products' f at their own density.
  Jwl const jwl{};
  double const alpha = 0.3;
  Particles particle = particles_of(air_and(jwl), {{2.0, 500.0, alpha, 1e8}});
  double const squeeze = 0.98;
  particle.step(swell(squeeze));
  double const V = jwl.rho0 / (500.0 / squeeze);
  double const f = jwl.A * (1.0 - jwl.omega / (jwl.R1 * V)) * std::exp(-jwl.R1 * V) +
                   jwl.B * (1.0 - jwl.omega / (jwl.R2 * V)) * std::exp(-jwl.R2 * V);
  double const rho = (0.7 * 2.0 + alpha * 500.0) / squeeze;
  EXPECT_NEAR(particle.density[0] / rho, 1.0, 1e-15);
  double const p = (rho * particle.energy[0] + alpha / jwl.omega * f) / ((1.0 - alpha) / 0.4 + alpha / jwl.omega);
  EXPECT_NEAR(particle.pressure[0] / p, 1.0, 1e-13);
  EXPECT_GT(p, 1.01e8);
}

TEST(MixedParticle, PressureAndSoundSpeedAreThoseOfACell) {
  // 1e-13: round-off of a dozen operations, of the terms that make up the pressure and the stiffness.
  for (auto const& [fluids, blend] : pairs()) {
    std::vector<Blend> states;
    for (double const alpha : fractions) {
      states.push_back(blend);
      states.back().alpha = alpha;
    }
    Particles particles = particles_of(fluids, states);
    std::mt19937 random(17);
    for (int k = 0; k < 50; ++k) particles.step(random_swell(random, 5e-3));
    for (int i = 0; i < particles.n; ++i) {
      double const rho = particles.density[i];
      double const rho_e = rho * particles.energy[i];
      double const p = particles.pressure[i];
      Mixture const m = cell_of(particles, i);
      double const terms = (std::abs(rho_e) + std::abs(m.B)) / m.xi;
      EXPECT_NEAR(p, m.pressure(rho_e), 1e-13 * terms) << i;
      EXPECT_GT(p, 0.0) << "no tension here";
      double const stiff = (std::abs(p) + std::abs(m.H)) / m.xi + std::abs(p) + terms;
      EXPECT_NEAR(rho * particles.sound_speed[i] * particles.sound_speed[i], m.bulk_modulus(p), 1e-13 * stiff) << i;
      double const Y = particles.mass_fraction[i];
      double const alpha = particles.volume_fraction[i];
      EXPECT_NEAR(pressure(particles.solid, rho, particles.energy[i], Y, alpha), p, 1e-13 * terms) << i;
      EXPECT_NEAR(sound_speed(particles.solid, rho, p, Y, alpha) / particles.sound_speed[i], 1.0,
                  1e-13 * stiff / m.bulk_modulus(p))
          << i;
    }
  }
}

/// Specific energy on the isentrope of a mixture: de = -p dV by the classical Runge-Kutta method, equal steps in ln V.
double isentrope(Particles const& start, double ratio) {
  Fluids const& fluids = *start.solid.mixture;
  double const Y = start.mass_fraction[0];
  double const alpha = start.volume_fraction[0];
  auto const slope = [&](double log_V, double e) {
    double const V = std::exp(log_V);
    return -V * mixture(fluids, {(1.0 - Y) / V, Y / V}, Fractions::of(1, alpha)).pressure(e / V);
  };
  int const steps = 4000;
  double const h = std::log(ratio) / steps;
  double e = start.energy[0];
  double x = -std::log(start.density[0]);
  for (int k = 0; k < steps; ++k) {
    double const k1 = slope(x, e);
    double const k2 = slope(x + 0.5 * h, e + 0.5 * h * k1);
    double const k3 = slope(x + 0.5 * h, e + 0.5 * h * k2);
    double const k4 = slope(x + h, e + h * k3);
    e += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    x += h;
  }
  return e;
}

TEST(MixedParticle, IsentropeOfProductsInAir) {
  for (double const alpha : {0.01, 0.3, 0.9}) {
    for (double const ratio : {0.5, 0.8, 2.0, 8.0}) {
      Particles const start = particles_of(air_and(Jwl{}), {{20.0, 1000.0, alpha, 3e9}});
      double const e = isentrope(start, ratio);
      double const rho = start.density[0] / ratio;
      double const Y = start.mass_fraction[0];
      double const p =
          mixture(*start.solid.mixture, {(1.0 - Y) * rho, Y * rho}, Fractions::of(1, alpha)).pressure(rho * e);
      auto const error = [&](int steps) {
        Particles particle = start;
        for (int k = 0; k < steps; ++k) particle.step(swell(std::pow(ratio, 1.0 / steps)));
        return particle.pressure[0] / p - 1.0;
      };
      // The step errs to second order; the reference, of fourth order in 4000 steps, by round-off only.
      EXPECT_NEAR(std::log2(error(200) / error(400)), 2.0, 0.02) << alpha << ' ' << ratio;
      EXPECT_LT(std::abs(error(800)), 1e-4) << alpha << ' ' << ratio;
    }
  }
}

TEST(MixedParticle, ChangeOfEnergyIsTheWork) {
  // With viscosity and cut-off; 1e-14 per step of what is added: round-off.
  for (auto const& [fluids, blend] : pairs()) {
    for (double const alpha : fractions) {
      Blend state = blend;
      state.alpha = alpha;
      Particles particle = particles_of(fluids, {state});
      particle.data = {1e-7, 1e-3};
      double const start = particle.energy[0];
      std::mt19937 random(11);
      double largest = std::abs(start);
      for (int k = 0; k < 400; ++k) {
        particle.step(random_swell(random, 4e-3));
        largest = std::max(largest, std::abs(particle.energy[0]));
      }
      EXPECT_NEAR(particle.energy[0] - start, particle.work[0], 1e-14 * (particle.path[0] + 400.0 * largest));
      EXPECT_GT(particle.path[0], 0.0);
    }
  }
}

TEST(MixedParticle, TensionIsCutOff) {
  Particles particle = particles_of(air_and(StiffenedGas{}), {{rho_air, 1000.0, 0.999999, p_air}});
  for (int k = 0; k < 10; ++k) particle.step(swell(1.01));
  EXPECT_EQ(particle.pressure[0], 0.0) << "water would pull";
  EXPECT_LT(cell_of(particle, 0).pressure(particle.density[0] * particle.energy[0]), -1e6);
}

/// Two runs of the same points agree bit for bit.
void expect_same(Particles const& a, int i, Particles const& b, int j) {
  ASSERT_EQ(a.density[i], b.density[j]) << i;
  ASSERT_EQ(a.energy[i], b.energy[j]) << i;
  ASSERT_EQ(a.pressure[i], b.pressure[j]) << i;
  ASSERT_EQ(a.viscosity[i], b.viscosity[j]) << i;
  ASSERT_EQ(a.sound_speed[i], b.sound_speed[j]) << i;
}

TEST(MixedParticle, AmbientFluidAloneIsThePlainFluid) {
  // Bit for bit: among its like, with no composition at all, with no second fluid, and beside a particle that mixes.
  for (auto const& [fluids, blend] : pairs()) {
    Material const plain = of(Fluid{"ambient", "", fluids.ambient(), blend.first, blend.pressure});
    Fluids single = fluids;
    single.count = 1;
    Blend mixed = blend;
    mixed.alpha = 0.4;
    Particles reference(plain, 9);
    Particles alone = particles_of(fluids, std::vector<Blend>(9, blend));
    Particles bare(gas_of(fluids, blend.first, blend.pressure), 9);
    Particles one(gas_of(single, blend.first, blend.pressure), 9);
    std::vector<Blend> states(9, blend);
    states[4] = mixed;
    states[7].alpha = 0.5 * vanishing_fraction;  // without mass
    Particles among = particles_of(fluids, states);
    among.mass_fraction[7] = 0.0;
    for (int i = 0; i < 9; ++i) {
      if (i == 4) continue;
      among.density[i] = reference.density[i];
      among.energy[i] = reference.energy[i];
      among.pressure[i] = reference.pressure[i];
    }
    for (int i = 0; i < 9; ++i) {
      alone.energy[i] = reference.energy[i];
      alone.pressure[i] = reference.pressure[i];
    }
    EXPECT_EQ(start_pressure(bare.solid), start_pressure(plain));
    EXPECT_EQ(sound_speed(bare.solid, blend.first, blend.pressure), sound_speed(plain, blend.first, blend.pressure));
    std::mt19937 random(5);
    for (int k = 0; k < 50; ++k) {
      std::vector<Increment> increments;
      for (int i = 0; i < 9; ++i) increments.push_back(random_swell(random, 5e-3));
      for (Particles* particles : {&reference, &alone, &bare, &one, &among}) {
        particles->data = {1e-7, 1e-3};
        particles->step(increments);
      }
    }
    for (int i = 0; i < 9; ++i) {
      expect_same(alone, i, reference, i);
      expect_same(bare, i, reference, i);
      expect_same(one, i, reference, i);
      if (i != 4) expect_same(among, i, reference, i);
    }
    EXPECT_NE(among.pressure[4], reference.pressure[4]);
  }
}

TEST(MixedParticle, SecondFluidAloneIsThePlainFluid) {
  // 1/(1/G) rounds once more than G: 1e-13 per step at most.
  for (auto const& [fluids, blend] : pairs()) {
    Blend state = blend;
    state.alpha = 1.0;
    Particles particle = particles_of(fluids, {state});
    Particles plain(of(Fluid{"second", "", fluids.eos[1], blend.second, blend.pressure}));
    EXPECT_EQ(particle.mass_fraction[0], 1.0);
    for (Particles* particles : {&particle, &plain}) {
      particles->data = {1e-7, 1e-3};
      std::mt19937 random(5);
      for (int k = 0; k < 50; ++k) particles->step(random_swell(random, 5e-3));
    }
    double const scale =
        (plain.density[0] * plain.energy[0] + std::abs(cell_of(particle, 0).B)) / cell_of(particle, 0).xi;
    EXPECT_EQ(particle.density[0], plain.density[0]);
    EXPECT_NEAR(particle.energy[0] / plain.energy[0], 1.0, 50.0 * 1e-13);
    EXPECT_NEAR(particle.pressure[0], plain.pressure[0], 50.0 * 1e-13 * scale);
    EXPECT_NEAR(particle.sound_speed[0] / plain.sound_speed[0], 1.0, 50.0 * 1e-13);
  }
}

TEST(MixedParticle, ManyParticlesAreTreatedAsOne) {
  // 37 particles fill no whole number of vectors, 300 no whole number of chunks. Bit for bit, whoever the neighbours
  // are.
  for (auto const& [fluids, blend] : pairs()) {
    for (int const n : {37, 300}) {
      std::vector<Blend> states(n, blend);
      for (int i = 0; i < n; ++i) states[i].alpha = i < 150 ? fractions[i % fractions.size()] : 0.0;
      Particles many = particles_of(fluids, states);
      many.data = {1e-7, 1e-3};
      std::vector<Particles> single;
      for (auto const& state : states) {
        single.push_back(particles_of(fluids, {state}));
        single.back().data = many.data;
      }
      std::mt19937 random(3);
      for (int k = 0; k < 20; ++k) {
        std::vector<Increment> increments;
        for (int i = 0; i < n; ++i) increments.push_back(random_swell(random, i % 3 == 0 ? 1e-5 : 4e-3));
        many.step(increments);
        for (int i = 0; i < n; ++i) single[i].step(increments[i]);
      }
      for (int i = 0; i < n; ++i) expect_same(many, i, single[i], 0);
    }
  }
}

TEST(MixedParticle, AbsurdStepsStayFinite) {
  for (auto const& [fluids, blend] : pairs()) {
    for (double const volumetric : {-5.0, -1.0, -0.89, 3.0, 1e3}) {
      Blend state = blend;
      state.alpha = 0.4;
      Particles particle = particles_of(fluids, {state});
      particle.data = {1e-7, 1e-3};
      Increment d;
      d.volumetric = volumetric;
      for (int k = 0; k < 3; ++k) particle.step(d);
      EXPECT_TRUE(std::isfinite(particle.pressure[0]) && std::isfinite(particle.energy[0]));
      EXPECT_TRUE(std::isfinite(particle.sound_speed[0]));
      EXPECT_GT(particle.density[0], 0.0);
      d.volumetric = std::nan("");
      particle.step(d);
      EXPECT_TRUE(std::isnan(particle.density[0]) && std::isnan(particle.energy[0]))
          << "what is not a number is not hidden";
    }
  }
}

TEST(MixedSolid, StartsAsTheAmbientFluid) {
  Material const gas = gas_of(air_and(Jwl{}), rho_air, p_air);
  EXPECT_TRUE(gas.mixes());
  EXPECT_FALSE(gas.burns());
  EXPECT_FALSE(gas.has_deviator());
  EXPECT_EQ(gas.minimum_pressure, 0.0);
  EXPECT_NEAR(start_pressure(gas), p_air, 1e-9);
  EXPECT_NEAR(gas.specific_energy, p_air / (0.4 * rho_air), 1e-9);
  EXPECT_FALSE(of(Fluid{}).mixes());
}

}  // namespace
