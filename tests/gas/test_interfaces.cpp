/// A material interface carried by a uniform flow: pressure and velocity must stay uniform [Abgrall96].
#include <gtest/gtest.h>

#include <cstdio>

#include "gas/harness.hpp"

namespace brisance::test {
namespace {

struct Deviation {
  double pressure = 0.0;
  double velocity = 0.0;
};

Deviation advect(Problem& problem, double p, double rho0, double rho1, double u, gas::Scheme scheme,
                 grid::Geometry geometry) {
  int const cells = geometry == grid::Geometry::planar1d ? 200 : 24;
  problem.box(geometry, cells, 1.0, grid::Boundary::periodic);
  problem.fluids.count = 2;
  problem.fluids.ambient_pressure = p;
  problem.options.scheme = scheme;
  problem.options.pressure_floor = 1e-6 * p;
  int const dims = problem.domain.dimensions();
  problem.fill([&](Vec3 const& x) {
    Mixed s = state(rho0, u, p);
    for (int d = 1; d < dims; ++d) s.velocity[d] = 0.5 * d * u;
    s.products_density = rho1;
    Vec3 centre{0.5, dims > 1 ? 0.5 : x[1], dims > 2 ? 0.5 : x[2]};
    s.volume_fraction = norm(x - centre) < 0.25 ? 1.0 : 0.0;
    return s;
  });
  double const mass = problem.total(gas::partial_density(1));
  problem.run_to(1.0 / u);
  Deviation worst;
  problem.for_each_cell([&](int, int, Index3 const& cell) {
    gas::Primitive const w = problem.at(cell);
    worst.pressure = std::max(worst.pressure, std::abs(w.pressure / p - 1.0));
    for (int d = 0; d < dims; ++d) {
      worst.velocity = std::max(worst.velocity, std::abs(w.velocity[d] - (d == 0 ? u : 0.5 * d * u)) / u);
    }
  });
  EXPECT_NEAR(problem.total(gas::partial_density(1)) / mass, 1.0, 1e-12);
  EXPECT_EQ(problem.gas->account().guarded_cells, 0);
  return worst;
}

void expect_uniform(char const* fluids, Deviation const& d, long steps) {
  std::printf("%s: pressure %.1e, velocity %.1e after %ld steps\n", fluids, d.pressure, d.velocity, steps);
  EXPECT_LE(d.pressure, 1e-9);
  EXPECT_LE(d.velocity, 1e-9);
}

class Interface : public testing::TestWithParam<std::tuple<gas::Scheme, grid::Geometry>> {};

TEST_P(Interface, IdealInIdealStaysUniform) {
  Problem problem;
  problem.fluids.eos[1] = material::IdealGas{1.667};
  auto const [scheme, geometry] = GetParam();
  Deviation const d = advect(problem, 1e5, 1.2, 0.16, 100.0, scheme, geometry);
  expect_uniform("ideal/ideal", d, problem.steps);
}

// Products expanded to a fifth of their initial density at 5 MPa: both exponentials of the JWL matter.
TEST_P(Interface, JwlInAirStaysUniform) {
  Problem problem;
  problem.fluids.eos[1] = material::Jwl{};
  auto const [scheme, geometry] = GetParam();
  Deviation const d = advect(problem, 5e6, 50.0, 326.0, 1000.0, scheme, geometry);
  expect_uniform("JWL/air", d, problem.steps);
}

TEST_P(Interface, WaterInAirStaysUniform) {
  Problem problem;
  problem.fluids.eos[1] = material::StiffenedGas{4.4, 6e8};
  auto const [scheme, geometry] = GetParam();
  Deviation const d = advect(problem, 1e7, 50.0, 1000.0, 500.0, scheme, geometry);
  expect_uniform("water/air", d, problem.steps);
}

INSTANTIATE_TEST_SUITE_P(Schemes, Interface,
                         testing::Combine(testing::Values(gas::Scheme::muscl_hancock, gas::Scheme::lax_wendroff),
                                          testing::Values(grid::Geometry::planar1d, grid::Geometry::cartesian3d)));

}  // namespace
}  // namespace brisance::test
