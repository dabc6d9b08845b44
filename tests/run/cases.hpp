/// Small cases for the tests of `run`.
#pragma once

#include <algorithm>

#include "../observe/watched.hpp"
#include "core/error.hpp"
#include "deck/library.hpp"

namespace brisance::run {

using namespace setup;
using namespace observe;

/// Air at rest in a domain whose low corner is the origin; every face has the same boundary.
inline Case air_case(grid::Geometry geometry, Index3 const& cells, double h, grid::Boundary boundary) {
  Case c;
  c.domain.geometry = geometry;
  c.domain.cells = cells;
  c.domain.h = h;
  c.domain.boundary.fill(boundary);
  c.ambient.fluid = *deck::library().fluid("air");
  c.ambient.state = {c.ambient.fluid.density, c.ambient.fluid.pressure, {0.0, 0.0, 0.0}};
  c.end.time = 1.0;
  return c;
}

/// A charge of the default TNT with the mass that its shape has in the geometry, lit at its centre at time 0.
inline Charge tnt_charge(shape::Shape const& shape, grid::Geometry geometry) {
  Charge charge;
  charge.explosive = *deck::library().explosive("TNT");
  charge.shape = shape;
  charge.mass = charge.explosive.density() * shape::volume(shape, geometry);
  charge.initiation = {{shape::centre(shape), 0.0}};
  return charge;
}

inline void advance_to(World& world, double time) {
  world.setup.end.time = time;
  while (!world.finished()) advance(world, time);
}

/// The same, with the gauges sampled on the way.
inline void advance_to(observe::Watched& world, double time) {
  world.setup.end.time = time;
  world.sample_gauges();
  while (!world.finished()) {
    advance(world, time);
    world.sample_gauges();
  }
}

}  // namespace brisance::run
