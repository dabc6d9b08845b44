// How shapes share cells: exact where faces lie along the grid, and later shapes take space from earlier ones.
#include <gtest/gtest.h>

#include <numbers>

#include "shape/placement.hpp"
#include "shape/shares.hpp"

namespace brisance::shape {
namespace {

using grid::Domain;
using grid::Geometry;

Domain domain_of(Geometry g, double h, Index3 const& cells, Vec3 const& lower = {0.0, 0.0, 0.0}) {
  Domain domain;
  domain.geometry = g;
  domain.h = h;
  domain.cells = cells;
  domain.lower = lower;
  return domain;
}

/// Volume that each shape gets.
std::vector<double> volumes(std::vector<Shape> const& shapes, Domain const& domain, long* cut = nullptr) {
  std::vector<double> sums(shapes.size(), 0.0);
  for_each_share(shapes, domain, domain.all_cells(), [&](CellRange const& r, std::vector<Share> const& shares) {
    EXPECT_LE(sum_of(shares), 1.0 + 1e-12);
    for (Share const& s : shares) sums[static_cast<std::size_t>(s.shape)] += s.fraction * volume_of(r, domain);
    if (cut != nullptr && (shares.size() != 1 || shares.front().fraction != 1.0)) ++*cut;
    return true;
  });
  return sums;
}

TEST(Shares, BoxesAlongTheGridCutNoCell) {
  // Sizes that are no binary fractions, far from the origin: round-off is where it hurts.
  Domain const domain = domain_of(Geometry::cartesian3d, 0.1, {30, 20, 25}, {100.3, -7.7, 0.9});
  long cut = 0;
  auto const sums = volumes({Box{{100.3, -7.7, 0.9}, {103.3, -5.7, 3.4}},
                             Box{{100.3 + 0.7, -7.7 + 0.3, 0.9}, {100.3 + 1.9, -7.7 + 1.1, 0.9 + 2.5}}},
                            domain, &cut);
  EXPECT_EQ(cut, 0);
  EXPECT_NEAR(sums[0], 3.0 * 2.0 * 2.5 - 1.2 * 0.8 * 2.5, 1e-10);
  EXPECT_NEAR(sums[1], 1.2 * 0.8 * 2.5, 1e-10);
}

TEST(Shares, BoxesThatCutCellsAreExactInEveryGeometry) {
  for (Geometry const g : {Geometry::cartesian3d, Geometry::planar2d, Geometry::axisymmetric2d, Geometry::planar1d,
                           Geometry::cylindrical1d, Geometry::spherical1d}) {
    SCOPED_TRACE(word_of(g));
    int const dims = grid::dimensions(g);
    Domain const domain = domain_of(g, 0.1, {10, dims > 1 ? 9 : 1, dims > 2 ? 8 : 1});
    Box const box{{0.133, 0.257, 0.311}, {0.677, 0.519, 0.587}};
    EXPECT_NEAR(volumes({box}, domain)[0] / volume_inside(box, domain), 1.0, 1e-12);
  }
}

TEST(Shares, LaterShapesTakeSpaceFromEarlierOnesAndLeaveNoGaps) {
  Domain const domain = domain_of(Geometry::planar2d, 0.1, {10, 10, 1});
  // Two halves that meet within a cell: a quarter and three quarters, nothing of a third.
  std::vector<Shape> const halves{Box{{0.0, 0.0, -0.5}, {0.525, 1.0, 0.5}}, Box{{0.525, 0.0, -0.5}, {1.0, 1.0, 0.5}}};
  auto const shares = shares_of_cell(halves, domain, {5, 3, 0});
  ASSERT_EQ(shares.size(), 2U);
  EXPECT_NEAR(shares[0].fraction, 0.25, 1e-12);
  EXPECT_NEAR(shares[1].fraction, 0.75, 1e-12);
  EXPECT_EQ(sum_of(shares), 1.0);
  // A disc within a larger one.
  double const r = 0.237;
  double const R = 0.411;
  auto const sums = volumes(
      {Cylinder{{0.51, 0.47, 0.0}, R, 1.0, {0.0, 0.0, 1.0}}, Cylinder{{0.53, 0.49, 0.0}, r, 1.0, {0.0, 0.0, 1.0}}},
      domain);
  EXPECT_NEAR(sums[1] / (std::numbers::pi * r * r), 1.0, 1e-3);
  EXPECT_NEAR(sums[0] / (std::numbers::pi * (R * R - r * r)), 1.0, 1e-3);
  // The reverse order leaves nothing of the smaller one.
  auto const reversed = volumes(
      {Cylinder{{0.53, 0.49, 0.0}, r, 1.0, {0.0, 0.0, 1.0}}, Cylinder{{0.51, 0.47, 0.0}, R, 1.0, {0.0, 0.0, 1.0}}},
      domain);
  EXPECT_EQ(reversed[0], 0.0);
}

TEST(Shares, BallsOfThreeCellsAreWithinAThousandthOfTheirVolume) {
  double const R = 0.3;
  for (double const off : {0.0, 0.031, 0.05}) {
    Domain const space = domain_of(Geometry::cartesian3d, 0.1, {10, 10, 10});
    double const ball = 4.0 / 3.0 * std::numbers::pi * R * R * R;
    EXPECT_NEAR(volumes({Sphere{{0.5 + off, 0.5, 0.5 - off}, R}}, space)[0] / ball, 1.0, 1e-3);
    Domain const turned = domain_of(Geometry::axisymmetric2d, 0.1, {10, 10, 1});
    EXPECT_NEAR(volumes({Sphere{{0.0, 0.5 + off, 0.0}, R}}, turned)[0] / ball, 1.0, 1e-3);
    Domain const plane = domain_of(Geometry::planar2d, 0.1, {10, 10, 1});
    EXPECT_NEAR(
        volumes({Cylinder{{0.5 + off, 0.5, 0.0}, R, 1.0, {0.0, 0.0, 1.0}}}, plane)[0] / (std::numbers::pi * R * R), 1.0,
        1e-3);
  }
}

}  // namespace
}  // namespace brisance::shape
