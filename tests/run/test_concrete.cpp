// Bodies of concrete: what breaks stays broken, energy is kept, and the program measures the broken zones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "../observe/watched.hpp"
#include "core/parallel.hpp"
#include "observe/particle_fields.hpp"
#include "observe/zones.hpp"

namespace brisance::run {
namespace {

using namespace observe;

using mpm::Field;

material::Material concrete() {
  material::Material solid;
  solid.name = "concrete";
  solid.density = 2440.0;
  solid.eos = material::Compaction{};
  solid.strength = material::Hjc{};
  solid.failure = material::TensileDamage{2.274e5, 4.57e6, 0.881, 0.01, 100e6, 90.0};
  return solid;
}

/// A bar of 0.25 m under a pulse of 24 MPa on its left face that falls within 60 us; the rate law alone.
Case bar() {
  Case c;
  c.domain.geometry = grid::Geometry::planar1d;
  c.domain.h = 2e-3;
  c.domain.lower[0] = -0.02;
  c.domain.cells = {150, 1, 1};
  c.domain.boundary.fill(grid::Boundary::outflow);
  c.end.time = 150e-6;
  Body body;
  body.name = "bar";
  body.solid = concrete();
  body.shape = shape::Box{{0.0, 0.0, 0.0}, {0.25, 0.0, 0.0}};
  c.particles.bodies = {body};
  mpm::SurfacePressure push;
  push.within = shape::Box{{0.0, 0.0, 0.0}, {1e-3, 0.0, 0.0}};
  push.normal = {-1.0, 0.0, 0.0};
  push.thickness = 1e-3;
  push.times = {0.0, 60e-6};
  push.pressures = {24e6, 0.0};
  c.particles.pressures = {push};
  c.particles.options.crack_band = false;
  c.particles.options.linear_viscosity = 0.5;
  return c;
}

std::vector<double> field(observe::Watched const& w, char const* name) {
  std::vector<double> out;
  particle_field(w, name, out);
  return out;
}

TEST(ConcreteBar, BreaksWhereTheReflectedPulseSaysAndStaysBroken) {
  observe::Watched w(bar());
  w.sample_gauges();
  double first = 0.0;
  double last_total = 0.0;
  while (!w.finished()) {
    advance(w, w.setup.end.time);
    auto const D = field(w, "damage");
    auto const mises = field(w, "mises");
    auto const p = field(w, "pressure");
    double total = 0.0;
    for (std::size_t q = 0; q < D.size(); ++q) {
      ASSERT_GE(D[q], 0.0);
      ASSERT_LE(D[q], 1.0);
      total += D[q];
      if (D[q] < 1.0) continue;
      ASSERT_EQ(mises[q], 0.0);
      ASSERT_GE(p[q], 0.0);
    }
    ASSERT_GE(total, last_total - 1e-12 * total);  // no particle's damage falls; the order of the particles may change
    last_total = total;
    if (first > 0.0) continue;
    auto const x = field(w, "position");
    int count = 0;
    for (std::size_t q = 0; q < D.size(); ++q) {
      if (D[q] < 1.0 || x[3 * q] < 0.125) continue;  // the jump of the load may crack the first particle under it
      first += 0.25 - x[3 * q];
      ++count;
    }
    first = count > 0 ? first / count : 0.0;
  }
  w.sample_gauges();
  // Softening meets the stress of the elastic waves, Eq. (58) integrated along them, 59 mm from the free face
  // (docs/validation/concrete.md, where the same is done for three pulses on a finer grid). Asked for: 10 %.
  EXPECT_NEAR(first, 0.0593, 0.1 * 0.0593);
  w.update_audit();
  EXPECT_LT(std::abs(w.energy_balance().drift()), 0.005);

  auto const zones = broken_zones(w);
  ASSERT_EQ(zones.size(), 1U);
  EXPECT_EQ(zones[0].crushed.mass, 0.0);
  EXPECT_GT(zones[0].cracked.mass, 0.0);
  ASSERT_EQ(zones[0].faces.size(), 2U);
  ASSERT_TRUE(zones[0].faces[1].spall_depth.has_value());
  EXPECT_GT(*zones[0].faces[1].spall_depth, 0.02);  // cracks spread towards the face
  EXPECT_LT(*zones[0].faces[1].spall_depth, 0.0593);
}

TEST(ConcreteBar, SameBitsForAnyNumberOfThreads) {
  std::vector<double> bits[2];
  int const before = threads();
  for (int const count : {1, 2}) {
    set_threads(count);
    // Two halves that fly apart: it breaks in the middle at once.
    Case c = bar();
    c.particles.pressures.clear();
    c.particles.options.crack_band = true;
    c.particles.options.block_cells = 50;
    Body right = c.particles.bodies[0];
    c.particles.bodies[0].shape = shape::Box{{0.0, 0.0, 0.0}, {0.125, 0.0, 0.0}};
    c.particles.bodies[0].velocity = {-5.0, 0.0, 0.0};
    right.shape = shape::Box{{0.125, 0.0, 0.0}, {0.25, 0.0, 0.0}};
    right.velocity = {5.0, 0.0, 0.0};
    c.particles.bodies.push_back(right);
    observe::Watched w(c);
    while (w.clock.step < 60) advance(w, 1.0);
    auto const D = field(w, "damage");
    EXPECT_GT(*std::max_element(D.begin(), D.end()), 0.5);
    for (char const* name : {"position", "stress", "damage", "tensile_damage", "energy"}) {
      auto const values = field(w, name);
      bits[count - 1].insert(bits[count - 1].end(), values.begin(), values.end());
    }
  }
  set_threads(before);
  ASSERT_EQ(bits[0].size(), bits[1].size());
  EXPECT_EQ(std::memcmp(bits[0].data(), bits[1].data(), bits[0].size() * sizeof(double)), 0);
}

/// A quarter of a block of 0.4 x 0.4 x 0.1 m in cells of 10 mm, two mirror planes through its axis.
observe::Watched& block_world() {
  static observe::Watched w([] {
    Case c;
    c.domain.geometry = grid::Geometry::cartesian3d;
    c.domain.h = 0.01;
    c.domain.cells = {25, 25, 20};
    c.domain.lower = {0.0, 0.0, -0.05};
    c.domain.boundary.fill(grid::Boundary::outflow);
    c.domain.boundary[0] = grid::Boundary::symmetry;
    c.domain.boundary[2] = grid::Boundary::symmetry;
    c.end.time = 1e-5;
    Body body;
    body.name = "block";
    body.solid = concrete();
    body.shape = shape::Box{{0.0, 0.0, 0.0}, {0.2, 0.2, 0.1}};
    c.particles.bodies = {body};
    return c;
  }());
  return w;
}

TEST(BrokenZones, AreMeasuredFromTheFaces) {
  // Painted on: a crushed cylinder of 100 mm diameter and 40 mm depth below the upper face, a cracked layer 20 to 30 mm
  // above the lower one that reaches no face. Particles have a spacing of 5 mm: the area of a circle of 10 of them in
  // radius is counted to 3 %, layers exactly.
  observe::Watched& w = block_world();
  double volume = 0.0;
  for (int b = 0; b < w.regions.front().particles->grid().block_count(); ++b) {
    mpm::ParticleSet& set = w.regions.front().particles->particles(b, 0);
    for (int q = 0; q < set.size(); ++q) {
      Vec3 const x{set.field(Field::origin_x)[q], set.field(Field::origin_y)[q], set.field(Field::origin_z)[q]};
      bool const crushed = std::hypot(x[0], x[1]) < 0.05 && x[2] > 0.06;
      bool const cracked = x[2] > 0.02 && x[2] < 0.03 && x[0] < 0.15 && x[1] < 0.15;
      set.field(Field::crushing)[q] = crushed ? 1.0 : 0.2;
      set.field(Field::cracking)[q] = cracked ? 1.0 : 0.0;
      set.field(Field::damage)[q] = crushed || cracked ? 1.0 : 0.2;
      volume += crushed ? set.field(Field::mass)[q] / 2440.0 : 0.0;
    }
  }
  auto const zones = broken_zones(w);
  ASSERT_EQ(zones.size(), 1U);
  EXPECT_NEAR(zones[0].crushed.volume, volume, 1e-12 * volume);
  EXPECT_NEAR(zones[0].crushed.volume, 0.25 * 3.14159 * 0.05 * 0.05 * 0.04, 0.06 * volume);
  EXPECT_NEAR(zones[0].cracked.volume, 0.15 * 0.15 * 0.01, 1e-9);
  EXPECT_NEAR(zones[0].damaged.mass, zones[0].crushed.mass + zones[0].cracked.mass, 1e-12);
  ASSERT_EQ(zones[0].faces.size(), 4U);  // not the two mirror planes
  for (FaceZone const& face : zones[0].faces) {
    if (face.face == grid::Face::z_high) {
      EXPECT_NEAR(face.crushed_diameter, 0.1, 0.003);
      EXPECT_NEAR(face.crushed_depth, 0.04, 1e-12);
      ASSERT_TRUE(face.spall_depth.has_value());
      EXPECT_NEAR(*face.spall_depth, 0.0725, 1e-12);
    } else if (face.face == grid::Face::z_low) {
      EXPECT_EQ(face.crushed_diameter, 0.0);
      EXPECT_EQ(face.crushed_depth, 0.0);
      ASSERT_TRUE(face.spall_depth.has_value());
      EXPECT_NEAR(*face.spall_depth, 0.0225, 1e-12);
    } else {
      EXPECT_EQ(face.cracked_diameter, 0.0);
    }
  }
}

}  // namespace
}  // namespace brisance::run
