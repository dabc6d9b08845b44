/// Open parts of cut cells and of their faces against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "meshes.hpp"
#include "shape/cut_cells.hpp"

namespace brisance::shape {
namespace {

grid::Domain square(grid::Geometry geometry, int n) {
  grid::Domain domain;
  domain.geometry = geometry;
  domain.h = 1.0 / n;
  for (int d = 0; d < domain.dimensions(); ++d) domain.cells[d] = n;
  return domain;
}

/// Area of the walls and volume of the gas.
struct Sums {
  double wall = 0.0;
  double volume = 0.0;
  Vec3 closed{0.0, 0.0, 0.0};
};

Sums sums_of(CutGeometry const& geometry, grid::Domain const& domain) {
  Sums sums;
  for (std::uint8_t const solid : geometry.solid) sums.volume += solid != 0 ? 0.0 : domain.cell_volume(0);
  for (CutCell const& cut : geometry.cells) {
    Vec3 wall{0.0, 0.0, 0.0};
    for (int d = 0; d < domain.dimensions(); ++d)
      wall[d] = (cut.open_faces[2 * d + 1] - cut.open_faces[2 * d]) * domain.face_area(d, 0);
    sums.wall += norm(wall);
    sums.closed = sums.closed + wall;
    sums.volume -= (1.0 - cut.open) * domain.cell_volume(0);
  }
  return sums;
}

TEST(CutCellGeometry, IsEmptyWhereFacesLieBetweenCells) {
  grid::Domain const domain = square(grid::Geometry::cartesian3d, 10);
  Vec3 const low{0.2, 0.3, 0.0};
  Vec3 const high{0.5, 0.7, 0.4};
  CutGeometry const box = cut_cells({Box{low, high}}, domain);
  CutGeometry const mesh = cut_cells({Mesh(test::cube(low, high), "box")}, domain);
  EXPECT_TRUE(box.cells.empty());
  EXPECT_TRUE(mesh.cells.empty());
  EXPECT_EQ(std::count(box.solid.begin(), box.solid.end(), 1), 3 * 4 * 4);
  EXPECT_EQ(box.solid, mesh.solid);
}

TEST(CutCellGeometry, OfABoxIsExactAndThatOfItsTrianglesTheSame) {
  grid::Domain const domain = square(grid::Geometry::cartesian3d, 10);
  // One side lies between cells, the others do not.
  Vec3 const low{0.2, 0.33, 0.08};
  Vec3 const high{0.56, 0.71, 0.44};
  CutGeometry const box = cut_cells({Box{low, high}}, domain);
  CutGeometry const mesh = cut_cells({Mesh(test::cube(low, high), "box")}, domain);
  ASSERT_EQ(box.cells.size(), mesh.cells.size());
  Sums const sums = sums_of(box, domain);
  EXPECT_NEAR(sums.volume, 1.0 - 0.36 * 0.38 * 0.36, 1e-12);
  for (std::size_t n = 0; n < box.cells.size(); ++n) {
    EXPECT_EQ(box.cells[n].cell, mesh.cells[n].cell);
    EXPECT_NEAR(box.cells[n].open, mesh.cells[n].open, 1e-12);
    for (int face = 0; face < 6; ++face) {
      // Lines run 1e-7 cells inside the edges of faces.
      EXPECT_NEAR(box.cells[n].open_faces[face], mesh.cells[n].open_faces[face], 1e-6) << n << " " << face;
    }
  }
  auto const at = [&](Index3 const& cell) {
    auto const found =
        std::find_if(box.cells.begin(), box.cells.end(), [&](CutCell const& c) { return c.cell == cell; });
    EXPECT_NE(found, box.cells.end());
    return *found;
  };
  // The top right edge of the box: 6 of 10 by 1 of 10 is filled.
  CutCell const edge = at({5, 7, 2});
  EXPECT_NEAR(edge.open, 0.94, 1e-9);
  EXPECT_NEAR(edge.open_faces[0], 0.9, 1e-6);
  EXPECT_NEAR(edge.open_faces[1], 1.0, 1e-6);
  EXPECT_NEAR(edge.open_faces[2], 0.4, 1e-6);
  EXPECT_NEAR(edge.open_faces[4], 0.94, 1e-6);
  // Beside the side that lies between cells a cell is cut by half an edge: its face is open above the box.
  CutCell const beside = at({1, 7, 2});
  EXPECT_NEAR(beside.open, 1.0, 1e-12);
  EXPECT_NEAR(beside.open_faces[1], 0.9, 1e-6);
}

TEST(CutCellGeometry, OfRoundBodiesHasTheirAreas) {
  constexpr double r = 0.31;
  grid::Domain const plane = square(grid::Geometry::planar2d, 40);
  Sums const disc = sums_of(cut_cells({Cylinder{{0.503, 0.496, 0.0}, r, 1.0, {0.0, 0.0, 1.0}}}, plane), plane);
  // Chords of a cell are shorter than arcs by (h/r)^2/24; areas are sampled by 64 lines to a cell.
  EXPECT_NEAR(disc.wall, 2.0 * std::numbers::pi * r, 2e-3 * r);
  EXPECT_NEAR(disc.volume, 1.0 - std::numbers::pi * r * r, 1e-4);
  EXPECT_LT(norm(disc.closed), 1e-12);
  grid::Domain const space = square(grid::Geometry::cartesian3d, 24);
  Sums const ball = sums_of(cut_cells({Sphere{{0.503, 0.496, 0.51}, r}}, space), space);
  // Flat pieces half a cell wide.
  EXPECT_NEAR(ball.wall, 4.0 * std::numbers::pi * r * r, 0.04 * r * r);
  EXPECT_NEAR(ball.volume, 1.0 - 4.0 / 3.0 * std::numbers::pi * r * r * r, 1e-4);
  EXPECT_LT(norm(ball.closed), 1e-12);
}

TEST(CutCellGeometry, OfAPlaneIsExactAtAnyAngle) {
  for (double const angle : {0.05, 0.4, 0.9, 1.5}) {
    for (grid::Geometry const geometry : {grid::Geometry::planar2d, grid::Geometry::cartesian3d}) {
      grid::Domain const domain = square(geometry, 12);
      bool const space = domain.dimensions() == 3;
      Vec3 normal{std::sin(angle), -std::cos(angle), space ? 0.3 : 0.0};
      normal = (1.0 / norm(normal)) * normal;
      CutGeometry const geometry_of_plane = cut_cells({HalfSpace{{0.513, 0.487, 0.502}, normal}}, domain);
      int whole = 0;
      for (CutCell const& cut : geometry_of_plane.cells) {
        Vec3 wall{0.0, 0.0, 0.0};
        for (int d = 0; d < domain.dimensions(); ++d) wall[d] = cut.open_faces[2 * d + 1] - cut.open_faces[2 * d];
        if (norm(wall) < 0.1) continue;
        // The wall faces away from the half-space; openings below 1e-4 are closed.
        Vec3 const turned = (1.0 / norm(wall)) * wall;
        EXPECT_LT(norm(turned + normal), 4e-3)
            << "cell " << cut.cell[0] << " " << cut.cell[1] << " " << cut.cell[2] << ", " << angle;
        ++whole;
      }
      EXPECT_GT(whole, 8);
    }
  }
}

}  // namespace
}  // namespace brisance::shape
