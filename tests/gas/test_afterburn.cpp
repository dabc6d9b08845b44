// Afterburn of the products: lambda and the energy in a closed box against closed forms and an ODE, lambda carried
// along with the products, and what a run without afterburn keeps.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "harness.hpp"

namespace brisance::test {
namespace {

using material::Afterburn;
using material::ConstantRateAfterburn;
using material::MillerAfterburn;

constexpr double Q = 1e7;          // J/kg
constexpr double density = 20.0;   // of the products in the box [kg/m3]
constexpr double pressure0 = 4e7;  // [Pa]
constexpr double round_off = 1e-12;

Mixed products(double rho, double p) {
  Mixed s;
  s.products_density = rho;
  s.volume_fraction = 1.0;
  s.pressure = p;
  return s;
}

/// A closed box full of products at rest.
Problem closed_box(std::optional<Afterburn> const& afterburn, grid::Geometry geometry = grid::Geometry::cartesian3d) {
  Problem p;
  p.fluids.eos[1] = material::Jwl{};
  p.fluids.count = 2;
  p.options.afterburn = afterburn;
  p.box(geometry, 6, 0.06, grid::Boundary::wall);
  p.fill([](Vec3 const&) { return products(density, pressure0); });
  return p;
}

/// Pressure of the box: p = f(rho) + omega rho e, and e grows by Q lambda.
double pressure_at(double lambda) { return pressure0 + material::Jwl{}.omega * density * Q * lambda; }

TEST(Afterburn, AtAConstantRateTheBoxFollowsItsClosedForm) {
  // A box with mirrors at its ends is closed in every geometry, along a radius too.
  for (auto const geometry :
       {grid::Geometry::cartesian3d, grid::Geometry::axisymmetric2d, grid::Geometry::spherical1d}) {
    ConstantRateAfterburn const rate{2e-6, 12e-6};
    Problem p = closed_box(Afterburn{Q, rate}, geometry);
    double const energy = p.total(gas::energy);
    double const mass = p.total(gas::partial_density(1));
    for (double const t : {1e-6, 3e-6, 8e-6, 12e-6, 15e-6}) {
      p.run_to(t);
      double const lambda = std::clamp((t - 2e-6) / 10e-6, 0.0, 1.0);
      EXPECT_NEAR(gas::afterburn_progress(*p.gas, p.grid->locate(Index3{0, 0, 0})), lambda, round_off) << t;
      EXPECT_NEAR(p.at({0, 0, 0}).pressure / pressure_at(lambda), 1.0, round_off) << t;
      double const released = p.gas->account().afterburn_energy;
      EXPECT_NEAR(released, Q * mass * lambda, round_off * Q * mass) << t;
      EXPECT_NEAR((p.total(gas::energy) - energy - released) / energy, 0.0, round_off) << t;
    }
    EXPECT_EQ(p.gas->fields().components(), gas::components_of(2)) << "a constant rate needs no component of its own";
  }
}

TEST(Afterburn, MillersLawWithoutPressureFollowsItsClosedForm) {
  // n = 0: (1 - lambda)^(1 - m) = 1 - (1 - m) a t, burnt out at t = 1 / ((1 - m) a) = 10 us. Exact for any step.
  MillerAfterburn miller{2e5, 1e5, 0.5, 0.0, 0.0};
  Problem p = closed_box(Afterburn{Q, miller});
  double const energy = p.total(gas::energy);
  double const mass = p.total(gas::partial_density(1));
  for (double const t : {0.5e-6, 4e-6, 9.9e-6, 12e-6}) {
    p.run_to(t);
    double const lambda = 1.0 - std::pow(std::max(0.0, 1.0 - 0.5 * 2e5 * t), 2.0);
    EXPECT_NEAR(gas::afterburn_progress(*p.gas, p.grid->locate(Index3{0, 0, 0})), lambda, round_off) << t;
    EXPECT_NEAR(p.at({0, 0, 0}).pressure / pressure_at(lambda), 1.0, round_off) << t;
    EXPECT_NEAR(p.gas->account().afterburn_energy, Q * mass * lambda, round_off * Q * mass) << t;
    EXPECT_NEAR((p.total(gas::energy) - energy - p.gas->account().afterburn_energy) / energy, 0.0, round_off) << t;
    EXPECT_NEAR(p.total(gas::progress), mass * lambda, round_off * mass) << t;
  }
}

/// lambda at a time by the classical Runge-Kutta method with steps that are far finer than the gas's.
double reference_lambda(MillerAfterburn const& law, double t) {
  auto const rate = [&](double lambda) {
    double const p = pressure_at(lambda);
    if (p <= law.minimum_pressure) return 0.0;
    return law.rate * std::pow(1.0 - lambda, law.m) * std::pow(p / law.reference_pressure, law.n);
  };
  constexpr int steps = 20000;
  double const h = t / steps;
  double lambda = 0.0;
  for (int n = 0; n < steps; ++n) {
    double const k1 = rate(lambda);
    double const k2 = rate(lambda + 0.5 * h * k1);
    double const k3 = rate(lambda + 0.5 * h * k2);
    double const k4 = rate(lambda + h * k3);
    lambda += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return lambda;
}

TEST(Afterburn, MillersLawFollowsItsOdeAtFirstOrder) {
  // The pressure of a step is that of its start: first order in the step. lambda reaches 0.7 here.
  MillerAfterburn const miller{1.5e5, pressure0, 0.5, 0.5, 1e5};
  double const t = 5e-6;
  double const exact = reference_lambda(miller, t);
  EXPECT_NEAR(exact, 0.7, 0.1);
  std::vector<double> errors;
  for (double const courant : {0.02, 0.01, 0.005}) {
    Problem p = closed_box(Afterburn{Q, miller});
    p.courant = courant;
    p.run_to(t);
    errors.push_back(std::abs(gas::afterburn_progress(*p.gas, p.grid->locate(Index3{0, 0, 0})) - exact));
    // Energy and lambda belong together whatever the error of the rate is.
    double const mass = p.total(gas::partial_density(1));
    EXPECT_NEAR(p.gas->account().afterburn_energy, Q * p.total(gas::progress), round_off * Q * mass);
  }
  EXPECT_LT(errors[0], 0.005);
  // Order 1 to 10 %: the last step of a run is cut, and the first ten grow from a tenth.
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 1.0, 0.1);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 1.0, 0.1);
}

TEST(Afterburn, NothingBurnsBelowTheMinimumPressure) {
  Problem p = closed_box(Afterburn{Q, MillerAfterburn{1e6, 1e5, 0.5, 0.2, 1.01 * pressure0}});
  p.run_to(5e-6);
  EXPECT_EQ(p.gas->account().afterburn_energy, 0.0);
  EXPECT_EQ(gas::afterburn_progress(*p.gas, p.grid->locate(Index3{0, 0, 0})), 0.0);
}

TEST(Afterburn, UnburntExplosiveWaits) {
  for (material::AfterburnRate const& rate : {material::AfterburnRate{ConstantRateAfterburn{0.0, 1e-5}},
                                              material::AfterburnRate{MillerAfterburn{1e6, 1e5, 0.5, 0.2, 0.0}}}) {
    Problem p = closed_box(Afterburn{Q, rate});
    // Lit at 1 us at D = 6930 m/s; the cell of 10 mm takes 2.2 us to burn.
    std::size_t const cells = p.grid->blocks()[0].with_ghosts().count();
    gas::BurnTime const burn{1e-6, 1e-6 + 1.5 * p.domain.h / 6930.0};
    p.gas->burn.set_times(0, std::vector<gas::BurnTime>(cells, burn), {});
    p.gas->burn.set_end(burn.end, 0.0);
    p.gas->start();
    p.run_to(3e-6);
    EXPECT_EQ(p.gas->account().afterburn_energy, 0.0);
    p.run_to(4e-6);
    EXPECT_GT(p.gas->account().afterburn_energy, 0.0);
  }
}

/// A slug of products in air, both at one pressure and velocity, in a periodic tube; lambda is set by `lambda(x)`.
template <class Lambda>
Problem slug(int n, double alpha_inside, Lambda&& lambda, gas::Scheme scheme = gas::Scheme::muscl_hancock) {
  Problem p;
  p.fluids.eos[1] = material::Jwl{};
  p.fluids.count = 2;
  p.options.scheme = scheme;
  // A rate that does nothing in the time of the test.
  p.options.afterburn = Afterburn{0.0, MillerAfterburn{1e-6, 1e13, 0.5, 1.0, 1e12}};
  p.box(grid::Geometry::planar1d, n, 1.0, grid::Boundary::periodic);
  p.fill([&](Vec3 const& x) {
    Mixed s = products(3.0, 1e5);
    s.ambient_density = 1.0;
    s.velocity = {500.0, 0.0, 0.0};
    s.volume_fraction = x[0] > 0.25 && x[0] < 0.75 ? alpha_inside : alpha_inside < 1.0 ? 0.0 : 1.0;
    return s;
  });
  p.for_each_cell([&](int b, int at, Index3 const& cell) {
    p.gas->fields().at(b, gas::progress)[at] =
        p.gas->fields().at(b, gas::partial_density(1))[at] * lambda(p.domain.centre(cell)[0]);
  });
  p.gas->start();
  return p;
}

TEST(Afterburn, LambdaMovesWithTheProducts) {
  // A smooth lambda in uniform products comes back after one period; second order in h, less at the clipped extrema.
  constexpr double pi = 3.14159265358979323846;
  auto const wave = [](double x) { return 0.5 + 0.4 * std::sin(2.0 * pi * x); };
  std::vector<double> errors;
  for (int const n : {50, 100, 200}) {
    Problem p = slug(n, 1.0, wave);
    double const before = p.total(gas::progress);
    p.run_to(2e-3);
    EXPECT_NEAR(p.total(gas::progress) / before, 1.0, round_off);
    double error = 0.0;
    p.for_each_cell([&](int, int, Index3 const& cell) {
      error += std::abs(gas::afterburn_progress(*p.gas, p.grid->locate(cell)) - wave(p.domain.centre(cell)[0])) / n;
    });
    errors.push_back(error);
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.6);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 1.6);
}

/// Difference over a cell, monotonised central with the default limiter of 1.5 [VanLeer77].
double slope_of(double back, double forth) {
  if (back * forth <= 0.0) return 0.0;
  double const least = std::min(std::abs(back), std::abs(forth));
  return std::copysign(std::min(0.5 * std::abs(back + forth), 1.5 * least), back);
}

/// A periodic line of cells along `direction`, a few cells wide in the others.
void line_of_cells(Problem& p, grid::Geometry geometry, int direction, int n) {
  p.domain.geometry = geometry;
  p.domain.h = 1.0 / n;
  for (int d = 0; d < p.domain.dimensions(); ++d) p.domain.cells[d] = d == direction ? n : 4;
  p.domain.boundary.fill(grid::Boundary::periodic);
}

struct Line {
  grid::Geometry geometry;
  int direction;
};
constexpr std::array lines{Line{grid::Geometry::planar1d, 0}, Line{grid::Geometry::planar2d, 1},
                           Line{grid::Geometry::cartesian3d, 0}, Line{grid::Geometry::cartesian3d, 1},
                           Line{grid::Geometry::cartesian3d, 2}};

TEST(Afterburn, LambdaComesFromWhereTheProductsComeFrom) {
  // One sweep along each direction through random states that flow both ways, with gaps without products: the flux of
  // the progress is the mass flux, as the gas itself tells it, times lambda upwind, linear in the cell that the mass
  // leaves and half a step of that cell's velocity ahead.
  constexpr int n = 60;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  struct Cell {
    double rho, u, p, lambda;
    bool products;
  };
  for (Line const& line : lines) {
    for (int trial = 0; trial < 10; ++trial) {
      std::vector<Cell> w(n);
      for (int i = 0; i < n; ++i) {
        bool const products = i % 20 > 2 || trial == 0;
        w[i] = {3.0 + unit(random), 300.0 * std::sin(0.4 * i + trial) + 100.0 * (unit(random) - 0.5),
                1e5 * (1.0 + 0.2 * unit(random)), unit(random), products};
      }
      Problem p;
      p.fluids.eos[1] = material::IdealGas{1.3};
      p.fluids.count = 2;
      p.options.carbuncle_cure = false;
      p.options.afterburn = Afterburn{0.0, MillerAfterburn{1e-6, 1e13, 0.5, 1.0, 1e12}};
      line_of_cells(p, line.geometry, line.direction, n);
      p.fill([&](Vec3 const& x) {
        Cell const& c = w[static_cast<int>(x[line.direction] * n)];
        Mixed s = products(c.rho, c.p);
        s.ambient_density = c.rho;
        s.velocity[line.direction] = c.u;
        s.volume_fraction = c.products ? 1.0 : 0.0;
        return s;
      });
      p.for_each_cell([&](int b, int at, Index3 const& cell) {
        p.gas->fields().at(b, gas::progress)[at] =
            p.gas->fields().at(b, gas::partial_density(1))[at] * w[cell[line.direction]].lambda;
      });
      std::vector<int> faces;  // at the high side of each cell but the last
      for (int i = 0; i + 1 < n; ++i) {
        Index3 cell{0, 0, 0};
        cell[line.direction] = i;
        faces.push_back(p.gas->coupling.watch(p.gas->grid().locate(cell), line.direction));
      }
      p.gas->start();
      double const dt = 0.4 * p.domain.h / p.gas->fastest_signal();
      p.gas->advance(dt, false);
      auto const mass = [&](int face) { return p.gas->coupling.watched()[faces[face]].carried.mass[1]; };
      auto const lambda_at = [&](int face) {
        Cell const& left = w[face];
        Cell const& right = w[face + 1];
        bool const from_left = left.products && (mass(face) >= 0.0 || !right.products);
        double const between = right.lambda - left.lambda;
        double const courant = dt / p.domain.h;
        if (from_left) {
          bool const known = w[face - 1].products && right.products;
          double const slope = known ? slope_of(left.lambda - w[face - 1].lambda, between) : 0.0;
          return left.lambda + 0.5 * slope * (1.0 - courant * std::max(left.u, 0.0));
        }
        bool const known = left.products && w[face + 2].products;
        double const slope = known ? slope_of(between, w[face + 2].lambda - right.lambda) : 0.0;
        return right.lambda - 0.5 * slope * (1.0 - courant * std::max(-right.u, 0.0));
      };
      double largest = 0.0;
      for (int i = 2; i + 3 < n; ++i) {
        Index3 index{0, 0, 0};
        index[line.direction] = i;
        grid::Cell const cell = p.grid->locate(index);
        double const before = w[i].products ? w[i].rho * w[i].lambda : 0.0;
        double const expected = before - (mass(i) * lambda_at(i) - mass(i - 1) * lambda_at(i - 1)) / p.domain.h;
        largest = std::max(largest, std::abs(mass(i)) / p.domain.h);
        ASSERT_NEAR(p.gas->fields().at(cell.block, gas::progress)[cell.offset], expected, 1e-12)
            << "cell " << i << ", trial " << trial;
      }
      EXPECT_GT(largest, 0.1);
    }
  }
}

TEST(Afterburn, LambdaMovesAlikeInAllDirections) {
  // A step of lambda in uniform products that flow to either side, at three Courant numbers: it arrives where the flow
  // carries it, within the cells over which it is smeared, it stays a step, and everywhere it is the mirror image of
  // that along x to round-off.
  constexpr int n = 60;
  for (double const courant : {0.2, 0.5, 0.8}) {
    std::vector<double> along_x;
    for (Line const& line : lines) {
      for (double const sign : {1.0, -1.0}) {
        Problem p;
        p.courant = courant;
        p.fluids.eos[1] = material::Jwl{};
        p.fluids.count = 2;
        p.options.afterburn = Afterburn{0.0, MillerAfterburn{1e-6, 1e13, 0.5, 1.0, 1e12}};
        line_of_cells(p, line.geometry, line.direction, n);
        p.fill([&](Vec3 const&) {
          Mixed s = products(3.0, 1e5);
          s.velocity[line.direction] = sign * 500.0;
          return s;
        });
        p.for_each_cell([&](int b, int at, Index3 const& cell) {
          int const i = sign > 0.0 ? cell[line.direction] : n - 1 - cell[line.direction];
          p.gas->fields().at(b, gas::progress)[at] = i < 30 ? 3.0 : 0.0;
        });
        p.gas->start();
        p.run_to(0.25 / 500.0);
        std::vector<double> lambda(n);
        p.for_each_cell([&](int, int, Index3 const& cell) {
          int const i = sign > 0.0 ? cell[line.direction] : n - 1 - cell[line.direction];
          lambda[i] = gas::afterburn_progress(*p.gas, p.grid->locate(cell));
        });
        if (along_x.empty()) along_x = lambda;
        double error = 0.0;
        double variation = 0.0;
        for (int i = 0; i < n; ++i) {
          EXPECT_NEAR(lambda[i], along_x[i], 1e-11);
          EXPECT_GE(lambda[i], -1e-13);
          EXPECT_LE(lambda[i], 1.0 + 1e-13);
          error += std::abs(lambda[i] - (i >= 15 && i < 45 ? 1.0 : 0.0));
          variation += std::abs(lambda[i] - lambda[(i + 1) % n]);
        }
        EXPECT_NEAR(variation, 2.0, 1e-9);
        EXPECT_LT(error, 6.0) << courant;  // cells, of two steps
      }
    }
  }
}

TEST(Afterburn, AUniformLambdaStaysUniformAtTheEdgeOfTheProducts) {
  for (auto const scheme : {gas::Scheme::muscl_hancock, gas::Scheme::lax_wendroff}) {
    Problem p = slug(
        100, 0.999, [](double) { return 0.3; }, scheme);
    double const before = p.total(gas::progress);
    p.run_to(2e-3);
    EXPECT_NEAR(p.total(gas::progress) / before, 1.0, round_off);
    int cells = 0;
    p.for_each_cell([&](int b, int at, Index3 const& cell) {
      // Round-off of the 300 steps, 1e-13 kg/m3, is 1e-9 of a partial density of 1e-4.
      if (p.gas->fields().at(b, gas::partial_density(1))[at] < 1e-4) return;
      EXPECT_NEAR(gas::afterburn_progress(*p.gas, p.grid->locate(cell)), 0.3, 1e-9);
      ++cells;
    });
    EXPECT_GT(cells, 50);
  }
}

TEST(Afterburn, WithoutItAGasHasNoMoreComponentsThanBefore) {
  EXPECT_EQ(closed_box({}).gas->fields().components(), gas::components_of(2));
  EXPECT_EQ(closed_box(Afterburn{Q, MillerAfterburn{}}).gas->fields().components(), gas::most_components);
  Problem air;
  air.options.afterburn = Afterburn{Q, MillerAfterburn{}};
  air.box(grid::Geometry::planar1d, 8, 1.0, grid::Boundary::wall);
  air.fill([](Vec3 const&) { return state(1.2, 0.0, 1e5); });
  EXPECT_EQ(air.gas->fields().components(), gas::components_of(1));
}

}  // namespace
}  // namespace brisance::test
