// Shocks, contacts and rarefactions through the bridge against the exact solution [Toro09].
#include "bridge/tubes.hpp"

namespace brisance::test {
namespace {

void print(std::string const& name, TubeResult const& r) {
  std::printf(
      "%-48s cells %.4f %.4f %.4f, /alone %.2f %.2f %.2f; points %.4f %.4f %.4f, /alone %.2f %.2f %.2f; peak %.2f %% "
      "at %.1f (alone %.2f %%); mass %+.1e, energy %+.3f %%; injected %ld, absorbed %ld\n",
      name.c_str(), r.cells[0], r.cells[1], r.cells[2], r.cells[0] / r.alone[0], r.cells[1] / r.alone[1],
      r.cells[2] / r.alone[2], r.particles[0], r.particles[1], r.particles[2], r.particles[0] / r.particles_alone[0],
      r.particles[1] / r.particles_alone[1], r.particles[2] / r.particles_alone[2], 100 * r.peak, r.peak_at,
      100 * r.peak_alone, r.mass_drift, 100 * r.energy_drift, r.injected, r.absorbed);
}

class Tubes : public testing::TestWithParam<TubeSetting> {};

INSTANTIATE_TEST_SUITE_P(All, Tubes, testing::ValuesIn(all_tubes()), [](auto const& one) {
  std::string name;
  for (char const ch : name_of(one.param)) {
    if (std::isalnum(static_cast<unsigned char>(ch)) != 0) name += ch;
  }
  return name;
});

// Required: errors of the gas side at most 1.5 times those of the gas scheme alone, no peak above 2 % at the bridge,
// the energy within 0.1 %, and all of the mass.
TEST_P(Tubes, KeepTheExactSolution) {
  TubeSetting const s = GetParam();
  TubeResult const r = run_tube(s.tube, tube_case(s.tube, s.where));
  print(name_of(s), r);
  for (int k = 0; k < 3; ++k) EXPECT_LT(r.cells[k], 1.5 * r.alone[k]) << k;
  EXPECT_LT(r.peak, 0.02);
  EXPECT_LE(std::abs(r.mass_drift), mass_tolerance);
  EXPECT_LT(std::abs(r.energy_drift), 1e-3);
}

// Products of TNT at 50 MPa against air: the shock and the contact cross the bridge into the region; the contact
// crosses it out of the region; the rarefaction does.
TEST(TwoFluidTube, KeepsTheExactSolution) {
  for (Where const where : {Where{240, true}, Where{215, false}, Where{185, false}}) {
    TubeResult const r = run_tube(products_and_air, two_fluid_case(where));
    print(std::string("products into air, region ") + (where.right ? "right of " : "left of ") +
              std::to_string(where.face),
          r);
    for (int k = 0; k < 3; ++k) EXPECT_LT(r.cells[k], 1.5 * r.alone[k]) << k;
    EXPECT_LE(std::abs(r.mass_drift), mass_tolerance);
    EXPECT_LT(std::abs(r.energy_drift), 1e-3);
  }
}

// The transport as printed counts twice what flows out of the region (docs/theory): the mass must grow by percents, or
// the comparison compares nothing. Into the region the interpolated flux is not what the scheme used.
TEST(PrintedTransport, CountsTwiceWhatFlowsOut) {
  for (Where const where : {Where{200, false}, Where{200, true}}) {
    run::Case c = tube_case(sod, where);
    TubeResult const ledger = run_tube(sod, c);
    c.mpm_regions.front().transport = bridge::Transport::paper;
    TubeResult const printed = run_tube(sod, c);
    print(where.right ? "Sod, as printed, into the region" : "Sod, as printed, out of the region", printed);
    print("   with the ledger", ledger);
    EXPECT_LE(std::abs(ledger.mass_drift), mass_tolerance);
    EXPECT_GT(std::abs(printed.mass_drift), where.right ? 1e-5 : 0.01);
    if (!where.right) {
      EXPECT_GT(printed.cells[2], 2.0 * ledger.cells[2]);
    }
  }
}

}  // namespace
}  // namespace brisance::test
