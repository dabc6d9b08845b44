/// Small cases of material points.
#pragma once

#include "../observe/watched.hpp"
#include "material/material.hpp"

namespace brisance::run {

using namespace observe;

/// Planar: an elastic-plastic block at 100 m/s that is about to meet an elastic one of the same name, and a gas
/// beside them. A gauge rides on the left block, another watches the right one.
inline Case two_blocks() {
  Case c;
  c.title = "two blocks";
  c.domain.geometry = grid::Geometry::planar2d;
  c.domain.h = 1e-3;
  c.domain.cells = {64, 48, 1};
  c.domain.boundary.fill(grid::Boundary::outflow);
  c.end.time = 20e-6;
  Body left;
  left.name = "left";
  left.solid = material::von_mises_solid(8930.0, 117e9, 0.35, 400e6);
  left.solid.name = "copper";
  left.solid.source = "a test";
  left.solid.specific_heat = 383.0;
  left.shape = shape::Box{{0.002, 0.002, 0.0}, {0.022, 0.022, 0.0}};
  left.velocity = {100.0, 0.0, 0.0};
  Body right = left;
  right.name = "right, \"the\" other";
  right.solid = material::elastic_solid(8930.0, 117e9, 0.35);
  right.solid.name = "copper";
  right.shape = shape::Box{{0.0225, 0.002, 0.0}, {0.0425, 0.022, 0.0}};
  right.velocity = {0.0, 0.0, 0.0};
  Body gas;
  gas.name = "gas";
  gas.solid.name = "air";
  gas.solid.density = 1.0;
  gas.solid.eos = material::IdealGas{1.4};
  gas.solid.specific_energy = 1e5 / 0.4;
  gas.shape = shape::Box{{0.02, 0.03, 0.0}, {0.03, 0.04, 0.0}};
  c.particles.bodies = {left, right, gas};
  c.particles.gauges = {{"tip", 0, Vec3{0.0195, 0.012, 0.0}}, {"target", 1, {}}};
  c.output.particle_fields = {"velocity", "stress", "mises", "identity", "plastic_strain"};
  return c;
}

/// A slab of explosive, 20 mm, lit at its left end.
inline Case charge_slab() {
  Case c;
  c.domain.geometry = grid::Geometry::planar1d;
  c.domain.h = 0.25e-3;
  c.domain.cells = {100, 1, 1};
  c.domain.boundary.fill(grid::Boundary::wall);
  c.end.time = 1e-5;
  Body slab;
  slab.name = "slab";
  slab.solid.name = "TNT";
  slab.solid.density = 1630.0;
  slab.solid.eos = material::Jwl{};
  slab.solid.specific_energy = 4.29e6;
  slab.solid.detonation_speed = 6930.0;
  slab.solid.minimum_pressure = 0.0;
  slab.shape = shape::Box{{0.0, 0.0, 0.0}, {0.02, 0.0, 0.0}};
  slab.initiation = {{{0.0, 0.0, 0.0}, 0.0}};
  c.particles.bodies = {slab};
  return c;
}

}  // namespace brisance::run
