/// One sweep of the optimised kernels against a slow and obvious one, cell by cell from the textbook formulas, for
/// random states.
#include <gtest/gtest.h>

#include <random>

#include "gas/harness.hpp"

namespace brisance::test {
namespace {

constexpr double g = 1.4;
constexpr int n = 96;

struct Cell {
  double rho, u, v, p;
};
using Flux = std::array<double, 4>;  // mass, momentum, transverse momentum, energy

double energy_of(Cell const& w) { return w.p / (g - 1.0) + 0.5 * w.rho * (w.u * w.u + w.v * w.v); }
Flux conserved_of(Cell const& w) { return {w.rho, w.rho * w.u, w.rho * w.v, energy_of(w)}; }
Flux physical_flux(Cell const& w) {
  return {w.rho * w.u, w.rho * w.u * w.u + w.p, w.rho * w.u * w.v, w.u * (energy_of(w) + w.p)};
}

/// HLLC after [Toro09] Sec. 10.4: star states, then the flux of the region that holds the face.
Flux textbook_hllc(Cell const& l, Cell const& r) {
  double const cl = std::sqrt(g * l.p / l.rho);
  double const cr = std::sqrt(g * r.p / r.rho);
  double const sl = std::min(l.u - cl, r.u - cr);
  double const sr = std::max(l.u + cl, r.u + cr);
  if (sl >= 0.0) return physical_flux(l);
  if (sr <= 0.0) return physical_flux(r);
  double const star =
      (r.p - l.p + l.rho * l.u * (sl - l.u) - r.rho * r.u * (sr - r.u)) / (l.rho * (sl - l.u) - r.rho * (sr - r.u));
  Cell const& k = star >= 0.0 ? l : r;
  double const s = star >= 0.0 ? sl : sr;
  double const rho = k.rho * (s - k.u) / (s - star);
  double const e = rho * (energy_of(k) / k.rho + (star - k.u) * (star + k.p / (k.rho * (s - k.u))));
  Flux const u_star{rho, rho * star, rho * k.v, e};
  Flux const u = conserved_of(k);
  Flux flux = physical_flux(k);
  for (int c = 0; c < 4; ++c) flux[c] += s * (u_star[c] - u[c]);
  return flux;
}

double slope_of(double a, double b, bool contact) {
  if (a * b <= 0.0) return 0.0;
  double const sign = a > 0.0 ? 1.0 : -1.0;
  a = std::abs(a);
  b = std::abs(b);
  if (contact) return sign * std::max(std::min(2.0 * a, b), std::min(a, 2.0 * b));
  return sign * std::min(0.5 * (a + b), 1.5 * std::min(a, b));
}

std::vector<Flux> reference_step(std::vector<Cell> const& w, double lambda) {
  std::vector<Cell> low(n);
  std::vector<Cell> high(n);
  for (int i = 0; i < n; ++i) {
    Cell const& m = w[(i + n - 1) % n];
    Cell const& o = w[i];
    Cell const& q = w[(i + 1) % n];
    bool const contact = std::abs(q.rho - m.rho) > 0.1 * std::min(m.rho, q.rho) &&
                         std::max({m.p, o.p, q.p}) - std::min({m.p, o.p, q.p}) < 0.05 * std::min({m.p, o.p, q.p});
    Cell const d{slope_of(o.rho - m.rho, q.rho - o.rho, contact), slope_of(o.u - m.u, q.u - o.u, false),
                 slope_of(o.v - m.v, q.v - o.v, false), slope_of(o.p - m.p, q.p - o.p, false)};
    Cell const half{o.rho - 0.5 * lambda * (o.u * d.rho + o.rho * d.u), o.u - 0.5 * lambda * (o.u * d.u + d.p / o.rho),
                    o.v - 0.5 * lambda * o.u * d.v, o.p - 0.5 * lambda * (o.u * d.p + g * o.p * d.u)};
    low[i] = {half.rho - 0.5 * d.rho, half.u - 0.5 * d.u, half.v - 0.5 * d.v, half.p - 0.5 * d.p};
    high[i] = {half.rho + 0.5 * d.rho, half.u + 0.5 * d.u, half.v + 0.5 * d.v, half.p + 0.5 * d.p};
    if (std::min(low[i].rho, high[i].rho) <= 0.0 || std::min(low[i].p, high[i].p) <= 0.0) low[i] = high[i] = o;
  }
  std::vector<Flux> u(n);
  for (int i = 0; i < n; ++i) {
    Flux const left = textbook_hllc(high[(i + n - 1) % n], low[i]);
    Flux const right = textbook_hllc(high[i], low[(i + 1) % n]);
    u[i] = conserved_of(w[i]);
    for (int c = 0; c < 4; ++c) u[i][c] -= lambda * (right[c] - left[c]);
  }
  return u;
}

TEST(ReferenceSweep, MusclHancockAgreesForRandomStates) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 50; ++trial) {
    // Smooth stretches, jumps, contacts and supersonic flow, all in one line.
    std::vector<Cell> w(n);
    for (int i = 0; i < n; ++i) {
      double const x = i / static_cast<double>(n);
      w[i] = {1.0 + 0.4 * std::sin(12.0 * x), 0.5 * std::cos(9.0 * x), std::sin(20.0 * x),
              1.0 + 0.3 * std::sin(30.0 * x)};
      if (i > 30 && i < 60) w[i].rho *= 1.0 + 5.0 * unit(random);
      if (i > 50 && i < 80) w[i].p *= 1.0 + 10.0 * unit(random);
      if (i > 70) w[i].u += 4.0 * (unit(random) - 0.3);
    }
    Problem problem;
    problem.box(grid::Geometry::planar1d, n, 1.0, grid::Boundary::periodic);
    problem.block_cells = 40;
    problem.fill([&](Vec3 const& x) {
      Cell const& c = w[static_cast<int>(x[0] * n)];
      Mixed s = state(c.rho, c.u, c.p);
      s.velocity[1] = c.v;
      return s;
    });
    double const dt = 0.4 * problem.domain.h / problem.gas->fastest_signal();
    std::vector<Flux> const expected = reference_step(w, dt / problem.domain.h);
    problem.gas->advance(dt, false);
    problem.for_each_cell([&](int b, int offset, Index3 const& cell) {
      constexpr std::array components{gas::partial_density(0), gas::momentum_x, gas::momentum_y, gas::energy};
      for (int c = 0; c < 4; ++c) {
        double const value = expected[cell[0]][c];
        EXPECT_NEAR(problem.gas->fields().at(b, components[c])[offset], value, 1e-12 * (1.0 + std::abs(value)));
      }
    });
  }
}

}  // namespace
}  // namespace brisance::test
