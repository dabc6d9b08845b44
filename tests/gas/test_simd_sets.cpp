/// The passes of a sweep with every set of vector instructions that this processor has, against those without any: the
/// same up to round-off, whatever is in the gas and around it.
#include <gtest/gtest.h>

#include <cstdio>

#include "core/parallel.hpp"
#include "core/simd.hpp"
#include "gas/harness.hpp"

namespace brisance::test {
namespace {

using grid::Geometry;

/// Puts a set into use, and the best one back at the end.
struct UseSet {
  explicit UseSet(SimdSet set) { use_simd_set(set); }
  ~UseSet() { use_simd_set(std::nullopt); }
  UseSet(UseSet const&) = delete;
  UseSet& operator=(UseSet const&) = delete;
};

struct Setting {
  char const* name;
  Geometry geometry;
  int cells;  ///< per direction: no multiple of a vector
  material::Eos ambient;
  bool products = false;
  bool burning = false;
  bool obstacle = false;
  bool frozen = false;
  double step_of_pressure = 3.0;
};

/// All values of the state after some steps, the peak fields and the account.
std::vector<double> outcome(Setting const& s, SimdSet set) {
  UseSet const use(set);
  set_threads(1);
  Problem problem;
  problem.box(s.geometry, s.cells, 1.0, grid::Boundary::wall);
  problem.block_cells = s.cells > 40 ? 0 : s.cells * 2 / 3;
  problem.options.peak_fields = true;
  problem.fluids.eos[0] = s.ambient;
  problem.quiescent = state(1.2, 0.0, 1e5);
  if (std::holds_alternative<material::StiffenedGas>(s.ambient)) problem.quiescent.ambient_density = 1000.0;
  if (std::holds_alternative<material::MieGruneisen>(s.ambient)) problem.quiescent.ambient_density = 7850.0;
  if (s.products) {
    problem.fluids.count = 2;
    problem.fluids.eos[1] = material::Jwl{};
    problem.fluids.ambient_pressure = 1e5;
  }
  problem.fill([&](Vec3 const& x) {
    Mixed cell = problem.quiescent;
    double const wave = std::sin(11.0 * x[0] + 5.0 * x[1] + 3.0 * x[2]);
    cell.ambient_density *= 1.0 + 0.2 * wave;
    // Nowhere the same in two cells: the shock sensor compares velocities, and which of two equal ones is the greater
    // is a matter of rounding.
    cell.velocity = {30.0 * wave, -20.0 * wave * wave, 10.0 * std::cos(7.0 * x[0] + 4.0 * x[1] + 2.0 * x[2])};
    if (norm(x) < 0.4) {
      cell.pressure *= s.step_of_pressure;
      if (s.products) {
        cell.volume_fraction = 0.5 + 0.4999 * std::sin(40.0 * x[0]);
        cell.products_density = 50.0 + 30.0 * wave;
      }
    }
    return cell;
  });
  if (s.obstacle) {
    int const first = s.cells / 2;
    place_obstacle(problem, [&](Index3 const& cell) {
      bool inside = true;
      for (int d = 0; d < problem.domain.dimensions(); ++d) inside = inside && cell[d] >= first && cell[d] < first + 3;
      return inside;
    });
  }
  for (int b = 0; b < problem.grid->block_count() && s.frozen; ++b) {
    std::vector<gas::Role> roles(problem.grid->blocks()[b].cell_count(), gas::Role::own);
    for (std::size_t n = 0; n < roles.size(); n += 5) roles[n] = gas::Role::frozen;
    problem.gas->coupling.set_roles(b, std::move(roles));
  }
  if (s.burning) {
    for (int b = 0; b < problem.grid->block_count(); ++b) {
      std::vector<gas::BurnTime> times(problem.grid->blocks()[b].with_ghosts().count());
      for (std::size_t n = 0; n < times.size(); ++n) {
        double const late = static_cast<double>(n % 50);
        times[n] = {1e-7 * late, 1e-5 * late};
      }
      std::vector<std::uint16_t> charge_of(times.size(), 0);
      problem.gas->burn.set_times(b, std::move(times), std::move(charge_of));
    }
    problem.gas->burn.set_charges({gas::LitCharge{6930.0, 1630.0}});
    problem.gas->burn.set_end(1.0, material::vanishing_fraction);
  }
  problem.gas->start();
  for (int step = 0; step < 6; ++step) {
    problem.gas->advance(0.4 * problem.domain.h / problem.gas->fastest_signal(), step % 2 == 1);
  }
  std::vector<double> values;
  for (int c = 0; c < problem.gas->fields().components(); ++c) {
    if (c == gas::shock) continue;
    problem.for_each_cell(
        [&](int b, int offset, Index3 const&) { values.push_back(problem.gas->fields().at(b, c)[offset]); });
  }
  problem.for_each_cell([&](int b, int offset, Index3 const&) {
    values.push_back(problem.gas->peaks().overpressure(b)[offset]);
    values.push_back(problem.gas->peaks().impulse(b)[offset]);
  });
  gas::Account const account = problem.gas->account();
  values.insert(values.end(), account.outflow.begin(), account.outflow.end());
  values.push_back(static_cast<double>(account.guarded_cells));
  return values;
}

/// The largest difference, of the largest value of the same sort nearby (the sorts lie one after the other).
double worst_difference(std::vector<double> const& a, std::vector<double> const& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0.0;
  for (double const x : b) most = std::max(most, std::abs(x));
  double worst = 0.0;
  for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) {
    if (!std::isfinite(a[n])) return std::numeric_limits<double>::infinity();
    double around = 1e-12 * most;
    for (std::size_t m = n > 20 ? n - 20 : 0; m < std::min(b.size(), n + 20); ++m)
      around = std::max(around, std::abs(b[m]));
    worst = std::max(worst, std::abs(a[n] - b[n]) / around);
  }
  return worst;
}

class EachSet : public testing::TestWithParam<Setting> {};

TEST_P(EachSet, GivesWhatPlainNumbersGive) {
  std::vector<double> const expected = outcome(GetParam(), SimdSet::scalar);
  int compared = 0;
  for (Word<SimdSet> const& word : words(SimdSet{})) {
    if (word.value == SimdSet::scalar || !has_simd_set(word.value)) continue;
    double const worst = worst_difference(outcome(GetParam(), word.value), expected);
    std::printf("%s, %s: largest difference %.1e\n", GetParam().name, word.name, worst);
    EXPECT_LT(worst, 1e-9) << word.name;
    ++compared;
  }
#ifdef BRISANCE_SIMD_SETS
  EXPECT_GE(compared, 1);
#endif
}

material::Eos const air = material::IdealGas{1.4};
INSTANTIATE_TEST_SUITE_P(
    Gases, EachSet,
    testing::Values(Setting{"a tube", Geometry::planar1d, 61, air}, Setting{"a sphere", Geometry::spherical1d, 61, air},
                    Setting{"long rows", Geometry::planar1d, 700, air}, Setting{"a plane", Geometry::planar2d, 27, air},
                    Setting{"wide rows", Geometry::planar2d, 53, air},
                    Setting{"a round tube with an obstacle", Geometry::axisymmetric2d, 27, air, false, false, true},
                    Setting{"a room", Geometry::cartesian3d, 13, air},
                    Setting{"a violent room", Geometry::cartesian3d, 13, air, false, false, false, false, 1e4},
                    Setting{"an obstacle", Geometry::cartesian3d, 13, air, false, false, true},
                    Setting{"frozen cells", Geometry::cartesian3d, 13, air, false, false, false, true},
                    Setting{"products", Geometry::cartesian3d, 13, air, true},
                    Setting{"products beside an obstacle", Geometry::cartesian3d, 13, air, true, false, true},
                    Setting{"violent products", Geometry::axisymmetric2d, 27, air, true, false, false, false, 1e3},
                    Setting{"burning products", Geometry::axisymmetric2d, 27, air, true, true, true},
                    Setting{"water", Geometry::planar2d, 27, material::StiffenedGas{}},
                    Setting{"products in water", Geometry::planar2d, 27, material::StiffenedGas{}, true},
                    Setting{"a liquid metal", Geometry::planar2d, 27, material::MieGruneisen{}, false, false, false,
                            false, 1e4}),
    [](auto const& instance) {
      std::string name = instance.param.name;
      std::replace(name.begin(), name.end(), ' ', '_');
      return name;
    });

TEST(SimdSets, TheBestIsInUseUnlessAnotherIsAskedFor) {
  EXPECT_TRUE(has_simd_set(SimdSet::scalar));
  EXPECT_EQ(simd_set(), best_simd_set());
  {
    UseSet const use(SimdSet::scalar);
    EXPECT_EQ(simd_set(), SimdSet::scalar);
    EXPECT_TRUE(simd_set_is_specified());
  }
  EXPECT_FALSE(simd_set_is_specified());
  EXPECT_EQ(simd_set(), best_simd_set());
}

}  // namespace
}  // namespace brisance::test
