/// What the tests of the bridge share: small cases with gas cells and an MPM region.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <vector>

#include "run/world.hpp"

namespace brisance::test {

using mpm::Field;
using mpm::ShapeFunction;
using mpm::Transfer;

inline char const* name_of(ShapeFunction shape) {
  switch (shape) {
    case ShapeFunction::linear: return "linear";
    case ShapeFunction::gimp: return "gimp";
    case ShapeFunction::cpgimp: return "cpgimp";
    case ShapeFunction::bspline: return "bspline";
  }
  return "";
}

inline char const* name_of(Transfer transfer) {
  return transfer == Transfer::flip ? "flip" : transfer == Transfer::apic ? "apic" : "xpic";
}

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
  c.mpm_region.emplace();
  return c;
}

/// The region as cells lower <= i < upper.
inline void set_region(run::Case& c, Index3 const& lower, Index3 const& upper) {
  shape::Box box;
  for (int d = 0; d < 3; ++d) {
    box.lower[d] = c.domain.lower[d] + lower[d] * c.domain.h;
    box.upper[d] = c.domain.lower[d] + upper[d] * c.domain.h;
  }
  c.mpm_region->boxes.push_back(box);
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

/// Largest deviations of the gas points and of the gas cells outside the deep region from a uniform state.
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

inline Deviation deviation_of(run::World const& w, run::FluidState const& uniform) {
  Deviation d;
  auto const& grid = w.grid;
  for (int b = 0; b < grid.block_count(); ++b) {
    grid::Block const& block = grid.blocks()[b];
    for (int k = 0; k < block.n[2]; ++k) {
      for (int j = 0; j < block.n[1]; ++j) {
        for (int i = 0; i < block.n[0]; ++i) {
          if (!w.gas->is_own(b, block.offset(i, j, k))) continue;
          gas::Primitive const s = w.gas->primitive(b, i, j, k);
          d.see(norm(s.velocity - uniform.velocity), std::abs(s.pressure / uniform.pressure - 1.0),
                std::abs(s.density / uniform.density - 1.0));
        }
      }
    }
  }
  for (int b = 0; b < w.points->grid().block_count(); ++b) {
    mpm::PointSet const& set = w.points->points(b, w.gas_body());
    for (int q = 0; q < set.size(); ++q) {
      Vec3 const v{set.field(Field::velocity_x)[q], set.field(Field::velocity_y)[q], set.field(Field::velocity_z)[q]};
      d.see(norm(v - uniform.velocity), std::abs(set.field(Field::pressure)[q] / uniform.pressure - 1.0),
            std::abs(set.field(Field::density)[q] / uniform.density - 1.0));
    }
  }
  return d;
}

}  // namespace brisance::test
