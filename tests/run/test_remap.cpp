// The remap: what a 1D burst holds is on the grid afterwards, to round-off, wherever the charge lies; what the burst
// has not touched keeps every bit; pressures are those of the profile.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cases.hpp"
#include "core/parallel.hpp"

namespace brisance::run {
namespace {

using grid::Boundary;
using grid::Geometry;
using shape::Cylinder;
using shape::Hemisphere;
using shape::Shape;
using shape::Sphere;

constexpr double radius = 0.05;  // of the charges [m]

Case remapped(Geometry geometry, Index3 const& cells, double h, Shape const& shape, double burst) {
  Case c = air_case(geometry, cells, h, Boundary::outflow);
  if (geometry == Geometry::axisymmetric2d) c.domain.boundary[0] = Boundary::symmetry;
  c.charges = {tnt_charge(shape, geometry)};
  c.start.remap = true;
  c.start.radius = burst;
  c.start.cell = radius / 40.0;  // the remap cares for no resolution of the burst
  return c;
}

/// The sums of the profile and of the grid, the totals of the world against ambient gas with the burst in it, and the
/// cells outside.
void expect_conservation(Case const& c, std::string const& what) {
  SCOPED_TRACE(what);
  World const world(c);
  ASSERT_EQ(world.starts.size(), c.charges.size());
  auto const& report = world.starts[0].remap;
  fmt::print(
      "{:<44} radius {:5.1f} cells, errors before the correction {:.0e}, after it {:.1e}; mixed cells: pressure "
      "{:.1e} averaged, {:.1e} fitted\n",
      what, report.cells_per_radius, report.quadrature_error, report.error(), report.pressure_error_averaged,
      report.pressure_error);
  // Round-off of sums over up to a million cells.
  EXPECT_LT(report.error(), 1e-12);
  EXPECT_GT(report.before.mass[1], 0.0);
  EXPECT_NEAR(world.charges[0].realised_mass / c.charges[0].mass, 1.0, 1e-12);

  // By another way: the whole domain against ambient gas everywhere, and the burst's differences from it.
  detonation::Profile const& profile = *world.setup.start.profiles[0];
  double volume = 0.0;
  for (int i = 0; i < c.domain.cells[0]; ++i) volume += c.domain.cell_volume(i) * c.domain.cells[1] * c.domain.cells[2];
  Totals const totals = world.totals();
  auto const expected = [&](int component) {
    double burst = 0.0;
    for (int j = 0; j < profile.domain.cells[1]; ++j) {
      for (int i = 0; i < profile.domain.cells[0]; ++i) {
        burst += profile.domain.cell_volume(i) *
                 (profile.component(component)[i + profile.domain.cells[0] * j] - profile.ambient[component]);
      }
    }
    return volume * profile.ambient[component] + report.share * burst;
  };
  EXPECT_NEAR(totals.mass[0] / expected(gas::density), 1.0, 1e-12);
  EXPECT_NEAR(totals.mass[1] / expected(gas::second_density), 1.0, 1e-12);
  EXPECT_NEAR(totals.energy / expected(gas::energy), 1.0, 1e-12);

  Vec3 const centre = shape::centre(c.charges[0].shape);
  auto const quiet = world.gas->conserved(ambient_mixture(c.ambient.state));
  long outside = 0;
  for (int b = 0; b < world.grid.block_count(); ++b) {
    grid::Block const& block = world.grid.blocks()[b];
    for (int n = 0; n < block.cell_count(); ++n) {
      Index3 const cell{block.origin[0] + n % block.n[0], block.origin[1] + n / block.n[0] % block.n[1],
                        block.origin[2] + n / (block.n[0] * block.n[1])};
      double near2 = 0.0;
      for (int d = 0; d < c.domain.dimensions(); ++d) {
        double const low = c.domain.lower[d] + cell[d] * c.domain.h - centre[d];
        double const away = std::max({low, -low - c.domain.h, 0.0});
        near2 += away * away;
      }
      if (near2 < report.radius * report.radius) continue;
      ++outside;
      for (int q = 0; q < world.gas->components(); ++q) ASSERT_EQ(world.gas->fields().at(b, q)[n], quiet[q]);
    }
  }
  EXPECT_GT(outside, 10);
}

class Remap : public testing::Test {};

TEST_F(Remap, KeepsMassEnergyAndMomentumFrom1dTo3d) {
  // A centre that no cell edge, centre or station meets.
  Case whole = remapped(Geometry::cartesian3d, {44, 45, 46}, 0.0101, Sphere{{0.2213, 0.2297, 0.2341}, radius}, 0.2);
  expect_conservation(whole, "sphere in 3D");
  Case octant = remapped(Geometry::cartesian3d, {24, 24, 24}, 0.0101, Sphere{{0.0, 0.0, 0.0}, radius}, 0.2);
  for (int d = 0; d < 3; ++d) octant.domain.boundary[2 * d] = Boundary::symmetry;
  expect_conservation(octant, "octant");
  // The other octant: the planes are the high faces.
  Case other = octant;
  other.domain.lower = {-24 * 0.0101, -24 * 0.0101, -24 * 0.0101};
  other.domain.boundary.fill(Boundary::outflow);
  for (int d = 0; d < 3; ++d) other.domain.boundary[2 * d + 1] = Boundary::symmetry;
  other.charges[0].shape = Sphere{{other.domain.upper(0), other.domain.upper(1), other.domain.upper(2)}, radius};
  other.charges[0].initiation = {{shape::centre(other.charges[0].shape), 0.0}};
  expect_conservation(other, "octant below its planes");
  Case ground = remapped(Geometry::cartesian3d, {45, 46, 24}, 0.0101,
                         Hemisphere{{0.2213, 0.2297, 0.0}, radius, {0.0, 0.0, 1.0}}, 0.2);
  ground.domain.boundary[4] = Boundary::wall;
  expect_conservation(ground, "hemisphere on the ground");
}

TEST_F(Remap, KeepsMassEnergyAndMomentumFrom1dTo2d) {
  Case turned = remapped(Geometry::axisymmetric2d, {60, 110, 1}, 0.0041, Sphere{{0.0, 0.2213, 0.0}, radius}, 0.2);
  expect_conservation(turned, "sphere in axisymmetric 2D");
  Case ground = remapped(Geometry::axisymmetric2d, {60, 60, 1}, 0.0041,
                         Hemisphere{{0.0, 0.0, 0.0}, radius, {0.0, 1.0, 0.0}}, 0.2);
  ground.domain.boundary[2] = Boundary::wall;
  expect_conservation(ground, "hemisphere in axisymmetric 2D");
  Case plane = remapped(Geometry::planar2d, {115, 120, 1}, 0.0041,
                        Cylinder{{0.2213, 0.2297, 0.0}, radius, 1.0, {0.0, 0.0, 1.0}}, 0.2);
  expect_conservation(plane, "cylinder in planar 2D");
  Case half = remapped(Geometry::planar2d, {60, 120, 1}, 0.0041,
                       Cylinder{{0.0, 0.2297, 0.0}, radius, 1.0, {0.0, 0.0, 1.0}}, 0.2);
  half.domain.boundary[0] = Boundary::symmetry;
  expect_conservation(half, "half a cylinder in planar 2D");
}

}  // namespace
}  // namespace brisance::run
