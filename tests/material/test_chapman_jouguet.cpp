/// The Chapman-Jouguet state against its own definition, and the check against sets known to be inconsistent.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "material/chapman_jouguet.hpp"

namespace {

using namespace brisance;
using material::Jwl;

Jwl const paper_tnt{1630.0, 371.2e9, 3.21e9, 4.15, 0.95, 0.30};

TEST(ChapmanJouguet, TntOfThePaper) {
  // Independent simulation of the same constants, rounded as given.
  auto const state = material::chapman_jouguet(paper_tnt, 6.993e9);
  EXPECT_NEAR(state.speed, 6928.0, 0.5);
  EXPECT_NEAR(state.pressure, 20.98e9, 0.005e9);
  EXPECT_NEAR(state.relative_volume, 0.7318, 5e-5);
  EXPECT_NEAR(state.particle_velocity, 1858.0, 0.5);
  EXPECT_NEAR(state.density, 2227.0, 0.6);
}

TEST(ChapmanJouguet, StateIsSonicAndConserves) {
  double const energy = 6.993e9;
  auto const s = material::chapman_jouguet(paper_tnt, energy);
  double const behind = s.speed - s.particle_velocity;
  EXPECT_NEAR(s.sound_speed / behind, 1.0, 1e-9);
  EXPECT_NEAR(s.density * behind / (1630.0 * s.speed), 1.0, 1e-12);
  EXPECT_NEAR(s.pressure / (1630.0 * s.speed * s.particle_velocity), 1.0, 1e-12);
  EXPECT_NEAR(s.specific_energy + s.pressure / s.density + 0.5 * behind * behind,
              energy / 1630.0 + 0.5 * s.speed * s.speed, 1e-10 * s.speed * s.speed);
}

TEST(ChapmanJouguet, GammaLawHasTheClosedForm) {
  // A = B = 0: an ideal gas of gamma = 1 + w, D^2 = 2 (gamma^2 - 1) e, V = gamma / (gamma + 1), p = rho0 D^2 / (gamma +
  // 1).
  for (double omega : {0.25, 0.4, 2.0}) {
    Jwl const gas{1600.0, 0.0, 0.0, 4.0, 1.0, omega};
    double const gamma = 1.0 + omega;
    double const energy = 5e9;
    auto const s = material::chapman_jouguet(gas, energy);
    double const speed = std::sqrt(2.0 * (gamma * gamma - 1.0) * energy / 1600.0);
    EXPECT_NEAR(s.speed / speed, 1.0, 1e-12);
    EXPECT_NEAR(s.relative_volume, gamma / (gamma + 1.0), 1e-9);
    EXPECT_NEAR(s.pressure / (1600.0 * speed * speed / (gamma + 1.0)), 1.0, 1e-9);
  }
}

TEST(ChapmanJouguet, NoSlowerDetonationReachesTheHugoniot) {
  // The definition: every other point of the Hugoniot needs a faster front.
  double const energy = 6.993e9;
  auto const s = material::chapman_jouguet(paper_tnt, energy);
  for (double v = 0.3; v < 0.999; v += 0.001) {
    // p_H from E = E0 + p (1 - V) / 2 by fixed-particle-free bisection on p, not by the formula of the library.
    double low = 0.0;
    double high = 1e13;
    for (int i = 0; i < 200; ++i) {
      double const p = 0.5 * (low + high);
      double const e = (energy + 0.5 * p * (1.0 - v)) / 1630.0;
      (material::pressure(paper_tnt, 1630.0 / v, e) > p ? low : high) = p;
    }
    EXPECT_GE(std::sqrt(low / (1630.0 * (1.0 - v))), s.speed * (1.0 - 1e-12)) << v;
  }
}

TEST(ChapmanJouguet, CheckRefusesMixedAndMisprintedSets) {
  auto const with = [](Jwl const& products, double energy) {
    material::Explosive explosive;
    explosive.products = products;
    explosive.energy = energy;
    explosive.detonation_speed = 6930.0;
    explosive.cj_pressure = 21e9;
    return material::check(explosive);
  };
  EXPECT_TRUE(with(paper_tnt, 6.993e9).consistent());
  // In circulation: w and E0 of one published TNT set with A and B of another.
  EXPECT_FALSE(with({1630.0, 371.2e9, 3.21e9, 4.15, 0.95, 0.35}, 6.0e9).consistent());
  EXPECT_FALSE(with(paper_tnt, 7.5e9).consistent());
  EXPECT_FALSE(with({1630.0, 317.2e9, 3.21e9, 4.15, 0.95, 0.30}, 6.993e9).consistent());
  auto const exact = with(paper_tnt, 6.993e9);
  EXPECT_NEAR(exact.speed_deviation, exact.state.speed / 6930.0 - 1.0, 1e-15);
}

TEST(ChapmanJouguet, RefusesConstantsWithoutADetonation) {
  EXPECT_THROW((void)material::chapman_jouguet(paper_tnt, std::nan("")), InputError);
  EXPECT_THROW((void)material::chapman_jouguet({1630.0, 0.0, 0.0, 4.0, 1.0, 0.3}, 0.0), InputError);
}

}  // namespace
