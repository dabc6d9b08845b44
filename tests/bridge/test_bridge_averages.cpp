// Gas particles seen as gas cells: the weighted sums around every cell of the domain against slow and obvious ones,
// over the particles and all their images.
#include <random>

#include "bridge/averages.hpp"
#include "bridge/harness.hpp"

namespace brisance::test {
namespace {

using bridge::Averages;
using bridge::CellSums;
using grid::Boundary;
using grid::Geometry;

/// The quadratic B-spline over three cells [Cui14]; x in cells from its middle.
double spline(double x) {
  double const a = std::abs(x);
  return a < 0.5 ? 0.75 - a * a : a < 1.5 ? 0.5 * (1.5 - a) * (1.5 - a) : 0.0;
}

/// What a particle of gas gives, as the averages count it.
std::array<double, 8> content(mpm::ParticleSet const& set, int q) {
  double const m = set.field(Field::mass)[q];
  double const volume = m / set.field(Field::density)[q];
  double const Y = set.field(Field::mass_fraction)[q];
  return {volume,
          volume * set.field(Field::volume_fraction)[q],
          m * (1.0 - Y),
          m * Y,
          m * set.field(Field::energy)[q],
          m * set.field(Field::velocity_x)[q],
          m * set.field(Field::velocity_y)[q],
          m * set.field(Field::velocity_z)[q]};
}

/// An image of a coordinate, and whether it is a mirror image.
struct Image {
  double x;
  bool mirrored;
};

std::vector<Image> images_of(grid::Domain const& domain, int d, double x) {
  std::vector<Image> all{{x, false}};
  auto const mirror = [&](int side) {
    Boundary const b = domain.boundary[2 * d + side];
    return b == Boundary::symmetry || b == Boundary::wall;
  };
  if (mirror(0)) all.push_back({2.0 * domain.lower[d] - x, true});
  if (mirror(1)) all.push_back({2.0 * domain.upper(d) - x, true});
  if (domain.boundary[2 * d] == Boundary::periodic) {
    double const length = domain.upper(d) - domain.lower[d];
    all.push_back({x - length, false});
    all.push_back({x + length, false});
  }
  return all;
}

void expect_sums(Geometry geometry, std::array<Boundary, 6> const& boundary) {
  grid::Domain domain;
  domain.geometry = geometry;
  domain.h = 0.5;
  domain.lower = {-1.0, 2.0, 0.5};
  int const dims = domain.dimensions();
  for (int d = 0; d < dims; ++d) domain.cells[d] = 6 + d;
  domain.boundary = boundary;
  mpm::Body body;
  body.name = "gas";
  body.solid.density = 1.0;
  body.solid.eos = material::IdealGas{1.4};
  body.solid.mixture = material::Fluids{{material::IdealGas{1.4}, material::IdealGas{1.3}}, 2};
  mpm::Options options;
  options.block_cells = 4;  // blocks of several sizes
  mpm::Mpm particles(domain, {body}, options);
  // Particles anywhere, many of them at the faces; everything else about them is random too.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  mpm::Filling filling;
  for (int n = 0; n < 400; ++n) {
    Vec3 x = domain.centre({0, 0, 0});
    for (int d = 0; d < dims; ++d) {
      double const s = unit(random);
      double const length = domain.upper(d) - domain.lower[d];
      double const near = n % 4 == 0 ? 0.6 * domain.h * s : n % 4 == 1 ? length - 0.6 * domain.h * s : length * s;
      x[d] = domain.lower[d] + near;
    }
    filling.positions.push_back(x);
    filling.volumes.push_back(0.01 + unit(random));
  }
  particles.fill(0, filling);
  for (int b = 0; b < particles.grid().block_count(); ++b) {
    mpm::ParticleSet& set = particles.particles(b, 0);
    for (int q = 0; q < set.size(); ++q) {
      set.field(Field::mass)[q] = 0.5 + unit(random);
      set.field(Field::energy)[q] = unit(random);
      set.field(Field::mass_fraction)[q] = unit(random);
      set.field(Field::volume_fraction)[q] = unit(random);
      for (int d = 0; d < 3; ++d) set.field(Field::velocity_x + d)[q] = unit(random) - 0.3;
    }
  }

  std::vector<Index3> cells;
  Index3 const& n = domain.cells;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) cells.push_back({i, j, k});
    }
  }
  Averages averages(domain, particles, {0, 0, 0}, cells);
  averages.compute(particles, 0);
  ASSERT_EQ(averages.sums().size(), cells.size());

  for (std::size_t c = 0; c < cells.size(); ++c) {
    Vec3 const centre = domain.centre(cells[c]);
    std::array<double, 8> expected{};
    for (int b = 0; b < particles.grid().block_count(); ++b) {
      mpm::ParticleSet const& set = particles.particles(b, 0);
      for (int q = 0; q < set.size(); ++q) {
        std::array<double, 8> const value = content(set, q);
        std::array<std::vector<Image>, 3> image;
        for (int d = 0; d < 3; ++d) {
          image[d] = d < dims ? images_of(domain, d, set.field(Field::position_x + d)[q])
                              : std::vector<Image>{{centre[d], false}};
        }
        for (Image const& x : image[0]) {
          for (Image const& y : image[1]) {
            for (Image const& z : image[2]) {
              double weight = spline((x.x - centre[0]) / domain.h);
              if (dims > 1) weight *= spline((y.x - centre[1]) / domain.h);
              if (dims > 2) weight *= spline((z.x - centre[2]) / domain.h);
              std::array<bool, 3> const turned{x.mirrored, y.mirrored, z.mirrored};
              for (int v = 0; v < 8; ++v) expected[v] += (v >= 5 && turned[v - 5] ? -weight : weight) * value[v];
            }
          }
        }
      }
    }
    CellSums const& s = averages.sums()[c];
    std::array<double, 8> const found{s.volume, s.fluid_volume[1], s.mass[0],     s.mass[1],
                                      s.energy, s.momentum[0],     s.momentum[1], s.momentum[2]};
    for (int v = 0; v < 8; ++v) {
      ASSERT_NEAR(found[v], expected[v], 1e-12 * 400)
          << "value " << v << " of cell " << cells[c][0] << ", " << cells[c][1] << ", " << cells[c][2];
    }
  }
}

class Faces : public testing::TestWithParam<Geometry> {};
INSTANTIATE_TEST_SUITE_P(Averages, Faces,
                         testing::Values(Geometry::planar1d, Geometry::planar2d, Geometry::cartesian3d),
                         [](auto const& one) { return std::string(word_of(one.param)); });

TEST_P(Faces, MirrorAndRepeatWhatLiesBeforeThem) {
  int const faces = 2 * grid::dimensions(GetParam());
  // Each face alone a mirror, then all of them, then walls below and open above, and periodic ones.
  for (int mirror = 0; mirror < faces; ++mirror) {
    for (Boundary const kind : {Boundary::wall, Boundary::symmetry}) {
      SCOPED_TRACE(mirror);
      std::array<Boundary, 6> boundary{};
      boundary.fill(Boundary::outflow);
      boundary[mirror] = kind;
      expect_sums(GetParam(), boundary);
    }
  }
  std::array<Boundary, 6> boundary{};
  boundary.fill(Boundary::wall);
  expect_sums(GetParam(), boundary);
  for (int d = 0; d < 3; ++d) boundary[2 * d + 1] = Boundary::outflow;
  expect_sums(GetParam(), boundary);
  boundary.fill(Boundary::periodic);
  expect_sums(GetParam(), boundary);
  boundary[0] = boundary[1] = Boundary::symmetry;
  expect_sums(GetParam(), boundary);
}

}  // namespace
}  // namespace brisance::test
