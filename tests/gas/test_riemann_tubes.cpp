/// Shock tubes against the exact solution of the Riemann problem.
#include <gtest/gtest.h>

#include <cstdio>

#include "exact/exact_riemann.hpp"
#include "gas/harness.hpp"

namespace brisance::test {
namespace {

constexpr std::array schemes{gas::Scheme::muscl_hancock, gas::Scheme::lax_wendroff};
char const* name(gas::Scheme s) { return s == gas::Scheme::muscl_hancock ? "muscl_hancock" : "lax_wendroff"; }

struct Tube {
  char const* title;
  exact::State left, right;
  double x0, time;
};

/// L1 norm of the density error on the unit interval, and the same relative to the exact solution's own L1 norm.
struct Errors {
  double l1 = 0.0;
  double relative = 0.0;
  double over = 0.0;  ///< largest excess of the density over the exact solution's maximum, relative to the jump
  double under = 0.0;
};

Errors run(Tube const& tube, gas::Scheme scheme, int cells, Problem& problem) {
  problem.box(grid::Geometry::planar1d, cells, 1.0, grid::Boundary::outflow);
  problem.options.scheme = scheme;
  problem.fill([&](Vec3 const& x) {
    exact::State const& s = x[0] < tube.x0 ? tube.left : tube.right;
    return state(s.rho, s.u, s.p);
  });
  problem.run_to(tube.time);
  exact::Riemann const solution(problem.fluids.ambient(), tube.left, problem.fluids.ambient(), tube.right);
  Errors e;
  double norm = 0.0;
  double highest = std::max({tube.left.rho, tube.right.rho, solution.rho_star_l, solution.rho_star_r});
  double lowest = std::min({tube.left.rho, tube.right.rho, solution.rho_star_l, solution.rho_star_r});
  auto const line = problem.line();
  for (int i = 0; i < cells; ++i) {
    double const x = (i + 0.5) / cells;
    double const rho = solution.at((x - tube.x0) / tube.time).s.rho;
    e.l1 += std::abs(line[i].density - rho) / cells;
    norm += rho / cells;
    e.over = std::max(e.over, (line[i].density - highest) / (highest - lowest));
    e.under = std::max(e.under, (lowest - line[i].density) / (highest - lowest));
  }
  e.relative = e.l1 / norm;
  return e;
}

// [Sod78] with the paper's end time, [Cui14] Sec. 5.1. 6.2e-4 is what Athena++ (PLM, HLLC, VL2) reaches at this
// resolution.
TEST(Sod, DefaultSchemeReachesThePublishedError) {
  Problem problem;
  Errors const e =
      run({"Sod", {1.0, 0.0, 1.0}, {0.125, 0.0, 0.1}, 0.5, 0.143}, gas::Scheme::muscl_hancock, 1000, problem);
  std::printf("Sod, 1000 cells, muscl_hancock: L1(rho) %.3e, overshoot %.2e, undershoot %.2e\n", e.l1, e.over, e.under);
  EXPECT_LE(e.l1, 6.2e-4);
  EXPECT_LE(e.over, 0.01);
  EXPECT_LE(e.under, 0.01);
}

// The face form with eta of Eq. (5) is expected at 1.24e-3 (prototype of the method); cell-wise theta as printed
// gave 2.79e-3.
TEST(Sod, LaxWendroffConvergesInItsConservativeForm) {
  Problem fine;
  Problem coarse;
  Tube const tube{"Sod", {1.0, 0.0, 1.0}, {0.125, 0.0, 0.1}, 0.5, 0.143};
  Errors const e = run(tube, gas::Scheme::lax_wendroff, 1000, fine);
  Errors const c = run(tube, gas::Scheme::lax_wendroff, 250, coarse);
  std::printf("Sod, lax_wendroff: L1(rho) 250 cells %.3e, 1000 cells %.3e, order %.2f\n", c.l1, e.l1,
              std::log(c.l1 / e.l1) / std::log(4.0));
  EXPECT_LE(e.l1, 1.4e-3);
  EXPECT_GE(std::log(c.l1 / e.l1) / std::log(4.0), 0.7);  // shocks and contacts bound the order below 1
}

// [Toro09] Table 4.1; positions of the diaphragm and end times as there.
constexpr std::array toro{
    Tube{"Toro 1", {1.0, 0.75, 1.0}, {0.125, 0.0, 0.1}, 0.3, 0.2},
    Tube{"Toro 2", {1.0, -2.0, 0.4}, {1.0, 2.0, 0.4}, 0.5, 0.15},
    Tube{"Toro 3", {1.0, 0.0, 1000.0}, {1.0, 0.0, 0.01}, 0.5, 0.012},
    Tube{"Toro 4", {5.99924, 19.5975, 460.894}, {5.99242, -6.19633, 46.0950}, 0.4, 0.035},
    Tube{"Toro 5", {1.0, -19.59745, 1000.0}, {1.0, -19.59745, 0.01}, 0.8, 0.012},
};

TEST(Toro, AllFiveSurviveWithBothSchemes) {
  for (Tube const& tube : toro) {
    for (gas::Scheme scheme : schemes) {
      Problem problem;
      Errors const e = run(tube, scheme, 400, problem);
      auto const account = problem.gas->account();
      std::printf(
          "%s, 400 cells, %-14s relative L1(rho) %.2f %%, overshoot %.1f %%, guarded cells %ld, fallback faces %ld\n",
          tube.title, name(scheme), 100.0 * e.relative, 100.0 * e.over, account.guarded_cells, account.fallback_faces);
      for (gas::Primitive const& w : problem.line()) {
        ASSERT_TRUE(std::isfinite(w.density) && std::isfinite(w.pressure)) << tube.title << " " << name(scheme);
        ASSERT_GT(w.density, 0.0);
        ASSERT_GT(w.pressure, 0.0);
      }
      if (scheme == gas::Scheme::muscl_hancock) {
        EXPECT_LE(e.relative, 0.03) << tube.title;
        EXPECT_EQ(account.guarded_cells, 0) << tube.title;
      }
    }
  }
}

/// Two materials: left the second fluid (volume fraction 1), right the ambient one.
struct TwoMaterialErrors {
  double density, velocity, pressure;  ///< L1, relative to the exact solution's largest value
};

TwoMaterialErrors run_two(Problem& problem, exact::State const& left, exact::State const& right, double time,
                          int cells) {
  problem.box(grid::Geometry::planar1d, cells, 1.0, grid::Boundary::outflow);
  problem.fluids.count = 2;
  problem.fluids.ambient_pressure = right.p;
  problem.fill([&](Vec3 const& x) {
    Mixed s = state(right.rho, x[0] < 0.5 ? left.u : right.u, x[0] < 0.5 ? left.p : right.p);
    s.volume_fraction = x[0] < 0.5 ? 1.0 : 0.0;
    s.products_density = left.rho;
    return s;
  });
  problem.run_to(time);
  exact::Riemann const solution(problem.fluids.eos[1], left, problem.fluids.ambient(), right);
  TwoMaterialErrors e{};
  double rho_max = 0.0;
  double u_max = 0.0;
  double p_max = 0.0;
  auto const line = problem.line();
  for (int i = 0; i < cells; ++i) {
    exact::State const s = solution.at(((i + 0.5) / cells - 0.5) / time).s;
    rho_max = std::max(rho_max, s.rho);
    u_max = std::max(u_max, std::abs(s.u));
    p_max = std::max(p_max, std::abs(s.p));
    e.density += std::abs(line[i].density - s.rho) / cells;
    e.velocity += std::abs(line[i].velocity[0] - s.u) / cells;
    e.pressure += std::abs(line[i].pressure - s.p) / cells;
  }
  return {e.density / rho_max, e.velocity / u_max, e.pressure / p_max};
}

// TNT products at their initial state against air: the first moments of a free-air burst. Converges to the exact
// solution at first order (shock and contact); the bounds are 1.3 times what 1000 cells measure.
TEST(TwoMaterials, JwlAgainstAir) {
  for (gas::Scheme scheme : schemes) {
    std::array<TwoMaterialErrors, 2> e{};
    for (int level = 0; level < 2; ++level) {
      Problem problem;
      problem.fluids.eos[1] = material::Jwl{};
      problem.options.scheme = scheme;
      problem.options.pressure_floor = 1.0;
      double const p = material::pressure(problem.fluids.eos[1], 1630.0, 6.993e9 / 1630.0);
      e[level] = run_two(problem, {1630.0, 0.0, p}, {1.225, 0.0, 101325.0}, 4e-5, level == 0 ? 500 : 2000);
      std::printf("JWL/air, %-14s %d cells: relative L1 rho %.2e u %.2e p %.2e, guarded %ld\n", name(scheme),
                  level == 0 ? 500 : 2000, e[level].density, e[level].velocity, e[level].pressure,
                  problem.gas->account().guarded_cells);
    }
    EXPECT_LT(e[1].density, 0.5 * e[0].density);
    EXPECT_LT(e[1].velocity, 0.6 * e[0].velocity);
    if (scheme == gas::Scheme::muscl_hancock) {
      EXPECT_LT(e[1].velocity, 0.02);
    }
  }
}

TEST(TwoMaterials, WaterAgainstAir) {
  for (gas::Scheme scheme : schemes) {
    std::array<TwoMaterialErrors, 2> e{};
    for (int level = 0; level < 2; ++level) {
      Problem problem;
      problem.fluids.eos[1] = material::StiffenedGas{4.4, 6e8};
      problem.options.scheme = scheme;
      problem.options.pressure_floor = 1.0;
      e[level] = run_two(problem, {1000.0, 0.0, 1e9}, {50.0, 0.0, 1e5}, 2.4e-4, level == 0 ? 250 : 1000);
      std::printf("water/air, %-14s %d cells: relative L1 rho %.2e u %.2e p %.2e, guarded %ld\n", name(scheme),
                  level == 0 ? 250 : 1000, e[level].density, e[level].velocity, e[level].pressure,
                  problem.gas->account().guarded_cells);
    }
    EXPECT_LT(e[1].density, 0.5 * e[0].density);
    EXPECT_LT(e[1].pressure, 0.5 * e[0].pressure);
    if (scheme == gas::Scheme::muscl_hancock) {
      EXPECT_LT(e[1].velocity, 0.01);
    }
  }
}

}  // namespace
}  // namespace brisance::test
