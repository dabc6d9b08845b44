// A flyer tears a scab off a target of copper.
#include <gtest/gtest.h>

#include "../observe/watched.hpp"
#include "cases.hpp"
#include "deck/deck.hpp"

namespace brisance::run {
namespace {

/// Means of the velocity of the free face over periods of the scab [m/s], after the release from behind has pulled
/// back.
std::vector<double> scab_velocities(std::string const& spall) {
  auto const deck = deck::read_text(
      "[domain]\ngeometry = \"planar1d\"\nsize = 30e-3\ncell = 0.1e-3\n"
      "[solids.cu]\ndensity = 8930\nE = \"124 GPa\"\nnu = 0.34\nminimum_pressure = \"-1.2 GPa\"\nspall = \"" +
          spall +
          "\"\nstrength = {model = \"von_mises\", yield = \"150 MPa\"}\n"
          "eos = {model = \"mie_gruneisen\", C0 = 3940, S = 1.489, Gamma = 2.02}\n"
          "[[body]]\nname = \"flyer\"\nmaterial = \"cu\"\nlower = 5e-3\nupper = 7e-3\nvelocity = [300]\n"
          "[[body]]\nname = \"target\"\nmaterial = \"cu\"\nlower = 7e-3\nupper = 12e-3\n"
          "[[contact]]\nbodies = [\"flyer\", \"target\"]\n[audit]\nfail = 0\n"
          "[[gauge]]\nname = \"face\"\nbody = \"target\"\npoint = 11.95e-3\n[end]\ntime = 8e-6\n",
      "spall.toml");
  for (auto const& error : deck.errors) ADD_FAILURE() << deck::format(error);
  observe::Watched world(Case(deck.case_.value()));
  advance_to(world, 8e-6);
  std::vector<double> means;
  for (double const from : {2.2e-6, 4e-6, 6e-6}) {
    double sum = 0.0;
    long count = 0;
    for (ParticleRecord const& record : world.gauges.particles[0].particles) {
      if (record.time < from || record.time > from + 1.8e-6) continue;
      sum += record.velocity[0];
      ++count;
    }
    means.push_back(sum / static_cast<double>(count));
  }
  return means;
}

TEST(Spall, AScabRingsAboutAConstantVelocity) {
  for (char const* const spall : {"pressure", "principal_stress"}) {
    auto const v = scab_velocities(spall);
    std::printf("%s: %.1f, %.1f, %.1f m/s\n", spall, v[0], v[1], v[2]);
    EXPECT_NEAR(v[1] / v[0], 1.0, 0.05) << spall;
    EXPECT_NEAR(v[2] / v[1], 1.0, 0.02) << spall;
  }
  // A cut-off goes on pulling.
  auto const held = scab_velocities("limit");
  EXPECT_LT(held[1], 0.5 * held[0]);
}

}  // namespace
}  // namespace brisance::run
