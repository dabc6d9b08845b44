/// Every equation of state against the thermodynamics that its three functions must fulfil.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/math.hpp"
#include "material/eos/eos.hpp"
#include "material/hugoniot.hpp"

namespace {

using namespace brisance;
using namespace brisance::material;

struct Sample {
  char const* name;
  Eos eos;
  std::vector<double> densities;
  double pressure;
};

std::vector<Sample> samples() {
  return {
      {"ideal gas", IdealGas{1.4}, {0.1, 1.225, 50.0}, 1e5},
      {"JWL", Jwl{}, {0.5, 20.0, 400.0, 1630.0, 2227.0}, 2e10},
      {"JWL, ideal from V = 8 on", Jwl{.ideal_beyond = 8.0}, {150.0, 203.0, 210.0, 270.0, 350.0, 405.0, 600.0}, 1e8},
      {"stiffened gas", StiffenedGas{4.4, 6e8}, {900.0, 1000.0, 1500.0}, 1e8},
      {"Mie-Grueneisen", MieGruneisen{}, {7000.0, 7849.0, 7851.0, 9000.0, 11000.0}, 1e10}};
}

TEST(Eos, PressureAndEnergyAreInverse) {
  for (auto const& s : samples()) {
    for (double rho : s.densities) {
      double const e = internal_energy(s.eos, rho, s.pressure);
      EXPECT_NEAR(pressure(s.eos, rho, e), s.pressure, 1e-12 * (s.pressure + bulk_modulus(s.eos, rho, s.pressure)))
          << s.name;
    }
  }
}

TEST(Eos, BulkModulusIsTheSlopeOfTheIsentrope) {
  // rho c^2 = rho dp/drho along de = p drho / rho^2. Central difference with 1e-5: truncation and round-off below 1e-7.
  for (auto const& s : samples()) {
    for (double rho : s.densities) {
      double const e = internal_energy(s.eos, rho, s.pressure);
      double const d = 1e-5;
      // Second-order energy change: the pressure half-way, so that the difference stays second order.
      auto const along = [&](double change) {
        double const half = e + s.pressure * 0.5 * change / rho;
        double const middle = pressure(s.eos, rho * (1.0 + 0.5 * change), half);
        return pressure(s.eos, rho * (1.0 + change), e + middle * change / (rho * (1.0 + change)));
      };
      double const slope = (along(d) - along(-d)) / (2.0 * d);
      double const k = bulk_modulus(s.eos, rho, s.pressure);
      EXPECT_NEAR(slope / k, 1.0, 1e-6) << s.name << " at " << rho;
      EXPECT_NEAR(sound_speed(s.eos, rho, s.pressure), std::sqrt(k / rho), 1e-12 * std::sqrt(k / rho)) << s.name;
    }
  }
}

TEST(Eos, JwlIsTheFormulaOfThePaper) {
  // [Cui14] Eq. (54) written out.
  Jwl const j{};
  for (double v : {0.6, 1.0, 3.0, 40.0}) {
    double const energy = 4e9;
    double const expected = j.A * (1.0 - j.omega / (j.R1 * v)) * std::exp(-j.R1 * v) +
                            j.B * (1.0 - j.omega / (j.R2 * v)) * std::exp(-j.R2 * v) + j.omega * energy / v;
    EXPECT_NEAR(pressure(j, j.rho0 / v, energy / j.rho0) / expected, 1.0, 1e-12) << v;
  }
}

TEST(Eos, JwlThatBecomesIdealIsTheJwlBeforeAndAnIdealGasBeyond) {
  Jwl const full{};
  Jwl const cut{.ideal_beyond = 8.0};
  for (double v : {0.5, 1.0, 3.0, 4.0}) {
    EXPECT_EQ(cut.reference(full.rho0 / v), full.reference(full.rho0 / v));
    EXPECT_EQ(cut.rho_d_reference(full.rho0 / v), full.rho_d_reference(full.rho0 / v));
  }
  for (double v : {8.0 + 1e-12, 10.0, 1e6}) {
    EXPECT_EQ(cut.reference(full.rho0 / v), 0.0);
    EXPECT_EQ(cut.rho_d_reference(full.rho0 / v), 0.0);
    EXPECT_LT(full.rho0 / v, cut.negligible_below());
  }
  // Half of it is left in the middle of the way.
  EXPECT_NEAR(cut.reference(full.rho0 / 6.0) / full.reference(full.rho0 / 6.0), 0.5, 1e-12);
}

TEST(Eos, MieGruneisenReturnsItsHugoniot) {
  // A shock from rest at zero pressure obeys Us = C0 + S up; the cubic of [Cui14] Eq. (66) drops mu^4 and above, that
  // is, relative to the pressure, terms 4 (S-1)^3 + 3 (S-1)^2 times mu^3.
  MieGruneisen const m{};
  for (double mu : {0.01, 0.05, 0.1}) {
    double const exact = m.rho0 * m.C0 * m.C0 * mu * (1.0 + mu) / std::pow(1.0 - (m.S - 1.0) * mu, 2);
    double const energy = 0.5 * exact * (1.0 / m.rho0 - 1.0 / (m.rho0 * (1.0 + mu)));
    double const s = m.S - 1.0;
    EXPECT_NEAR(pressure(m, m.rho0 * (1.0 + mu), energy) / exact, 1.0,
                1.5 * (4.0 * s * s * s + 3.0 * s * s) * mu * mu * mu);
  }
}

TEST(Eos, ReferenceIsSmoothAcrossTheStressFreeDensity) {
  MieGruneisen const m{};
  double const d = 1e-9;
  EXPECT_NEAR(m.rho_d_reference(m.rho0 * (1.0 + d)) / m.rho_d_reference(m.rho0 * (1.0 - d)), 1.0, 1e-6);
  EXPECT_NEAR(m.rho_d_reference(m.rho0) / (m.rho0 * m.C0 * m.C0), 1.0, 1e-12);
}

TEST(Eos, ExponentialIsExactToRoundOff) {
  for (double x = 0.0; x >= -700.0; x -= 0.37) EXPECT_NEAR(exp_nonpositive(x) / std::exp(x), 1.0, 1e-15) << x;
  EXPECT_EQ(exp_nonpositive(-1e6), exp_nonpositive(-700.0));
}

TEST(Hugoniot, MassMomentumAndEnergyBalanceAcrossTheShock) {
  for (auto const& s : samples()) {
    double const rho = s.densities[1];
    // From a shock that is almost sound to one that doubles the bulk modulus.
    for (double const part : {1e-4, 0.05, 1.0}) {
      double const behind = s.pressure + part * bulk_modulus(s.eos, rho, s.pressure);
      auto const shock = shocked(s.eos, rho, s.pressure, behind);
      double const flux = rho * shock.speed;
      EXPECT_NEAR(shock.density * (shock.speed - shock.jump) / flux, 1.0, 1e-9) << s.name;
      EXPECT_NEAR(flux * shock.jump / (behind - s.pressure), 1.0, 1e-9) << s.name;
      double const gained = internal_energy(s.eos, shock.density, behind) - internal_energy(s.eos, rho, s.pressure);
      double const work = behind * shock.jump / flux - 0.5 * shock.jump * shock.jump;
      EXPECT_NEAR(gained / work, 1.0, 1e-6) << s.name << ' ' << part;
      EXPECT_GE(shock.speed, sound_speed(s.eos, rho, s.pressure)) << s.name;
    }
  }
}

TEST(Hugoniot, IdealGasHasItsClosedForms) {
  IdealGas const air{1.4};
  for (double const mach : {1.0001, 1.5, 3.0, 10.0}) {
    double const p0 = 101325.0;
    double const behind = p0 * (1.0 + 7.0 / 6.0 * (mach * mach - 1.0));
    auto const shock = shocked(air, 1.225, p0, behind);
    EXPECT_NEAR(shock.speed / sound_speed(air, 1.225, p0), mach, 1e-7 * mach);
    EXPECT_NEAR(shock.density / 1.225, 6.0 * mach * mach / (mach * mach + 5.0), 1e-7);
    double const p = behind - p0;
    double const wall = 2.0 * p * (7.0 * p0 + 4.0 * p) / (7.0 * p0 + p);
    EXPECT_NEAR((incident_of_reflected(air, 1.225, p0, p0 + wall).pressure - p0) / p, 1.0, 1e-6) << mach;
  }
  EXPECT_EQ(shocked(air, 1.225, 101325.0, 101325.0).jump, 0.0);
}

}  // namespace
