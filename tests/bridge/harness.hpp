/// What the tests of the bridge share: small cases with gas cells and an MPM region.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <vector>

#include "setup/build.hpp"

namespace brisance::test {

using mpm::Field;
using mpm::ShapeFunction;
using mpm::Transfer;

/// Ideal gas in a box of `cells` per direction with edge 1 in x.
inline run::Case coupled_case(grid::Geometry geometry, Index3 const& cells, grid::Boundary boundary) {
  run::Case c;
  c.domain.geometry = geometry;
  c.domain.cells = cells;
  c.domain.h = 1.0 / cells[0];
  c.domain.boundary.fill(boundary);
  c.ambient.fluid.name = "gas";
  c.ambient.fluid.eos = material::IdealGas{1.4};
  c.ambient.state = {1.4, 1.0, {0.0, 0.0, 0.0}};
  c.numerics.density_floor = 1e-12;
  c.numerics.pressure_floor = 1e-12;
  c.output.peak_fields = false;
  c.end.time = 10.0;
  c.mpm_regions.emplace_back();
  return c;
}

/// The region as cells lower <= i < upper.
inline void set_region(run::Case& c, Index3 const& lower, Index3 const& upper) {
  shape::Box box;
  for (int d = 0; d < 3; ++d) {
    box.lower[d] = c.domain.lower[d] + lower[d] * c.domain.h;
    box.upper[d] = c.domain.lower[d] + upper[d] * c.domain.h;
  }
  c.mpm_regions.front().boxes.push_back(box);
}

/// Runs to a time; returns the number of steps.
inline long run_to(run::World& w, double end, std::function<void(run::World&)> const& after = {}) {
  long steps = 0;
  while (w.clock.time < end * (1.0 - 1e-13)) {
    run::advance(w, end);
    if (after) after(w);
    ++steps;
  }
  return steps;
}

/// Calls visit(block, offset, domain index) for all cells.
template <class Visit>
void for_each_cell(run::World const& w, Visit&& visit) {
  for (int b = 0; b < w.grid.block_count(); ++b) {
    grid::Block const& block = w.grid.blocks()[b];
    grid::for_each_cell(block, [&](grid::Cell const& cell) { visit(b, cell.offset, block.index(cell)); });
  }
}

/// Calls visit(primitive state, cell) for the gas cells outside the region, which count.
template <class Visit>
void for_each_own_cell(run::World const& w, Visit&& visit) {
  for_each_cell(w, [&](int, int, Index3 const& cell) {
    grid::Cell const at = w.grid.locate(cell);
    if (w.gas->coupling.is_own(at)) visit(w.gas->primitive(at), cell);
  });
}

/// Calls visit(set, q) for all particles of a body.
template <class Visit>
void for_each_particle(run::World const& w, int body, Visit&& visit) {
  for (int b = 0; b < w.regions.front().particles->grid().block_count(); ++b) {
    mpm::ParticleSet const& set = w.regions.front().particles->particles(b, body);
    for (int q = 0; q < set.size(); ++q) visit(set, q);
  }
}

/// Largest deviations of the gas particles and of the gas cells outside the deep region from a uniform state.
struct Deviation {
  double velocity = 0.0;  ///< [m/s]
  double pressure = 0.0;  ///< relative
  double density = 0.0;   ///< relative
  void see(double v, double p, double rho) {
    velocity = std::max(velocity, v);
    pressure = std::max(pressure, p);
    density = std::max(density, rho);
  }
};

inline Deviation deviation_of(run::World const& w, material::Primitive const& uniform) {
  Deviation d;
  for_each_own_cell(w, [&](gas::Primitive const& s, Index3 const&) {
    d.see(norm(s.velocity - uniform.velocity), std::abs(s.pressure / uniform.pressure - 1.0),
          std::abs(s.density / uniform.density - 1.0));
  });
  for_each_particle(w, w.regions.front().gas_body(), [&](mpm::ParticleSet const& set, int q) {
    Vec3 const v{set.field(Field::velocity_x)[q], set.field(Field::velocity_y)[q], set.field(Field::velocity_z)[q]};
    d.see(norm(v - uniform.velocity), std::abs(set.field(Field::pressure)[q] / uniform.pressure - 1.0),
          std::abs(set.field(Field::density)[q] / uniform.density - 1.0));
  });
  return d;
}

/// Relative errors of the audit of a run: the mass of both fluids and the energy. The masses must be constant to
/// round-off; the sums of some 1e5 steps and 1e4 particles leave 1e-13.
struct Balance {
  double mass = 0.0;
  double energy = 0.0;
};

inline Balance balance_of(run::World& w, run::Totals const& before) {
  w.audit.initial = before;
  w.update_audit();
  auto const error = w.audit.relative_error();
  double mass = 0.0;
  for (int k = 0; k < material::most_fluids; ++k) mass = std::max(mass, before.mass[k] > 0.0 ? error.mass[k] : 0.0);
  return {mass, error.energy};
}

inline constexpr double mass_tolerance = 1e-13;

/// Pressure of all cells along x in a row, k = 0, in the region from the particles [Pa].
inline std::vector<double> pressure_line(run::World const& w, int row = 0) {
  std::vector<Index3> cells;
  for (int i = 0; i < w.grid.domain().cells[0]; ++i) cells.push_back({i, row, 0});
  auto const states = gas::gather(*w.gas, cells);
  std::vector<double> p;
  for (gas::Primitive const& s : states) p.push_back(s.pressure);
  if (!w.coupled()) return p;
  std::vector<Index3> inner;
  for (Index3 const& cell : cells) {
    if (w.regions.front().bridge->region().inside(cell)) inner.push_back(cell);
  }
  auto const sums = w.regions.front().bridge->gas_in(inner);
  for (std::size_t n = 0; n < inner.size(); ++n) p[inner[n][0]] = w.regions.front().bridge->primitive(sums[n]).pressure;
  return p;
}

}  // namespace brisance::test
