// The MPM region: layers, roles, faces, proxy cells, and what it refuses.
#include "bridge/harness.hpp"
#include "core/error.hpp"

namespace brisance::test {
namespace {

using bridge::CellBox;
using bridge::Region;
using grid::Boundary;
using grid::Geometry;

grid::Domain domain_of(Geometry geometry, Index3 const& cells, Boundary boundary = Boundary::outflow) {
  grid::Domain d;
  d.geometry = geometry;
  d.cells = cells;
  d.h = 0.1;
  d.boundary.fill(boundary);
  return d;
}

TEST(Region, HasLayersFromItsFacesInwards) {
  Region const region(domain_of(Geometry::planar1d, {60, 1, 1}), {{{10, 0, 0}, {40, 1, 1}}}, 3, 3);
  // Outside 0; the bridge 1 to w; ghosts to w + 4; deep w + 5.
  for (int i = 0; i < 60; ++i) {
    int const distance = std::min(i - 9, 40 - i);
    int const wanted = distance <= 0 ? 0 : std::min(distance, 8);
    EXPECT_EQ(region.layer({i, 0, 0}), wanted) << i;
    gas::Role const role = region.role({i, 0, 0});
    EXPECT_EQ(role, wanted == 0 ? gas::Role::own : wanted <= 5 ? gas::Role::shadow : gas::Role::frozen) << i;
  }
  EXPECT_EQ(region.cells().size(), 30U);
  EXPECT_EQ(region.ghosts().size(), 8U);
  ASSERT_EQ(region.proxy_cells().size(), 6U);
  for (Index3 const& cell : region.proxy_cells()) {
    EXPECT_TRUE((cell[0] >= 7 && cell[0] <= 9) || (cell[0] >= 40 && cell[0] <= 42)) << cell[0];
  }
  ASSERT_EQ(region.faces().size(), 2U);
  EXPECT_EQ(region.faces()[0].inside[0], 10);
  EXPECT_EQ(region.faces()[0].outside()[0], 9);
  EXPECT_EQ(region.faces()[0].inward({2.0, 0.0, 0.0}), 2.0);
  EXPECT_EQ(region.faces()[1].inside[0], 39);
  EXPECT_EQ(region.faces()[1].outside()[0], 40);
  EXPECT_EQ(region.faces()[1].inward({2.0, 0.0, 0.0}), -2.0);
  EXPECT_FALSE(region.faces()[0].open);
  // The particles' grid: the box and the proxy cells.
  EXPECT_EQ(region.particles_domain().cells[0], 36);
  EXPECT_EQ(region.shift()[0], -7);
  EXPECT_DOUBLE_EQ(region.particles_domain().lower[0], 0.7);
}

TEST(Region, GoesAroundEdgesAndInnerCorners) {
  // An L of two boxes: the inner corner at (20, 20) has a layer around it too.
  Region const region(domain_of(Geometry::planar2d, {40, 40, 1}), {{{4, 4, 0}, {34, 20, 1}}, {{4, 4, 0}, {20, 34, 1}}},
                      2, 3);
  auto const in_l = [](int i, int j) {
    return (i >= 4 && i < 34 && j >= 4 && j < 20) || (i >= 4 && i < 20 && j >= 4 && j < 34);
  };
  std::size_t proxies = 0;
  std::size_t faces = 0;
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 40; ++i) {
      // Chebyshev distance to the nearest cell on the other side, by trying them all.
      int distance = 1000;
      for (int b = 0; b < 40; ++b) {
        for (int a = 0; a < 40; ++a) {
          if (in_l(a, b) != in_l(i, j)) distance = std::min(distance, std::max(std::abs(a - i), std::abs(b - j)));
        }
      }
      EXPECT_EQ(region.layer({i, j, 0}), in_l(i, j) ? std::min(distance, 7) : 0) << i << ", " << j;
      if (!in_l(i, j) && distance <= 3) ++proxies;
      if (!in_l(i, j)) continue;
      for (auto const& [a, b] : {std::pair{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}}) faces += in_l(a, b) ? 0 : 1;
    }
  }
  EXPECT_EQ(region.proxy_cells().size(), proxies);
  EXPECT_EQ(region.faces().size(), faces);
  EXPECT_EQ(faces, 120U);  // as many as around the box that holds the L
}

TEST(Region, EndsAtMirrorsAndIsOpenAtOutflow) {
  grid::Domain domain = domain_of(Geometry::planar2d, {30, 30, 1});
  domain.boundary[0] = Boundary::symmetry;
  Region const region(domain, {{{0, 0, 0}, {20, 20, 1}}}, 2, 3);
  int open = 0;
  for (bridge::Face const& face : region.faces()) {
    EXPECT_FALSE(face.direction == 0 && face.side == 0);  // the mirror is no face
    open += face.open ? 1 : 0;
    EXPECT_EQ(face.open, face.direction == 1 && face.side == 0);
  }
  EXPECT_EQ(open, 20);
  EXPECT_EQ(region.layer({0, 10, 0}), 7);  // no bridge at either
  EXPECT_EQ(region.layer({10, 0, 0}), 7);
  EXPECT_EQ(region.clamped({5, -2, 0}), (Index3{5, 0, 0}));
  for (Index3 const& cell : region.proxy_cells()) EXPECT_GE(cell[0], 0);
  EXPECT_EQ(region.particles_domain().boundary[0], Boundary::symmetry);
  EXPECT_EQ(region.particles_domain().boundary[1], Boundary::outflow);
}

std::string refusal(grid::Domain const& domain, std::vector<CellBox> const& boxes, int width = 3) {
  try {
    Region const region(domain, boxes, width, 3);
  } catch (InputError const& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Region, RefusesWhatDoesNotFit) {
  grid::Domain const line = domain_of(Geometry::planar1d, {60, 1, 1});
  EXPECT_EQ(refusal(line, {}), "an MPM region needs at least one box");
  EXPECT_EQ(refusal(line, {{{10, 0, 0}, {40, 1, 1}}}, 0), "the bridge must be at least 1 cell wide");
  EXPECT_EQ(refusal(line, {{{10, 0, 0}, {61, 1, 1}}}), "the MPM region is empty or extends beyond the domain in x");
  EXPECT_EQ(refusal(line, {{{10, 0, 0}, {10, 1, 1}}}), "the MPM region is empty or extends beyond the domain in x");
  EXPECT_EQ(refusal(line, {{{3, 0, 0}, {40, 1, 1}}}),
            "the MPM region ends 3 cells from the boundary x_low of the domain; it must touch the boundary or leave at "
            "least 4 cells of gas");
  EXPECT_EQ(refusal(line, {{{10, 0, 0}, {20, 1, 1}}}),
            "the MPM region is too thin: with a bridge 3 cells wide it needs at least 11 cells between two bridges and "
            "6 between a bridge and a boundary");
  EXPECT_EQ(refusal(line, {{{10, 0, 0}, {21, 1, 1}}}), "accepted");
  EXPECT_EQ(refusal(line, {{{55, 0, 0}, {60, 1, 1}}}),
            "the MPM region is too thin: with a bridge 3 cells wide it needs at least 11 cells between two bridges and "
            "6 between a bridge and a boundary");
  EXPECT_EQ(refusal(line, {{{54, 0, 0}, {60, 1, 1}}}), "accepted");
  EXPECT_EQ(refusal(domain_of(Geometry::planar1d, {60, 1, 1}, Boundary::inflow), {{{40, 0, 0}, {60, 1, 1}}}),
            "the MPM region must not touch the inflow boundary x_high; leave at least 4 cells of gas");
  EXPECT_EQ(refusal(domain_of(Geometry::planar1d, {60, 1, 1}, Boundary::periodic), {{{40, 0, 0}, {60, 1, 1}}}),
            "the MPM region touches the periodic boundary x_high but does not span the domain in x");
}

std::string refusal(run::Case const& c) {
  try {
    run::World const w = setup::build(c);
  } catch (InputError const& e) {
    return e.what();
  }
  return "accepted";
}

TEST(RegionOfACase, LiesOnTheGrid) {
  auto c = coupled_case(Geometry::planar1d, {100, 1, 1}, Boundary::outflow);
  set_region(c, {40, 0, 0}, {100, 1, 1});
  c.mpm_regions.front().boxes[0].lower[0] = 0.403;
  EXPECT_EQ(refusal(c),
            "the faces of the MPM region must be cell faces: x = 0.403 m lies inside a cell; the nearest cell faces "
            "are at 0.4 and 0.41 m");
}

TEST(RegionOfACase, KeepsObstaclesAndSolidsAway) {
  auto c = coupled_case(Geometry::planar1d, {100, 1, 1}, Boundary::outflow);
  set_region(c, {40, 0, 0}, {80, 1, 1});
  run::Case with_obstacle = c;
  with_obstacle.obstacles.push_back({"pier", shape::Box{{0.37, -1.0, -1.0}, {0.38, 1.0, 1.0}}});
  EXPECT_EQ(refusal(with_obstacle),
            "an obstacle lies in the MPM region or within 3 cells of it: make it a body, or move one of them");
  with_obstacle.obstacles[0].shape = shape::Box{{0.34, -1.0, -1.0}, {0.36, 1.0, 1.0}};
  EXPECT_EQ(refusal(with_obstacle), "accepted");
  run::Body body;
  body.name = "wall";
  body.solid = material::elastic_solid(100.0, 1e3, 0.3);
  body.shape = shape::Box{{0.46, -1.0, -1.0}, {0.50, 1.0, 1.0}};
  c.particles.bodies = {body};
  EXPECT_EQ(refusal(c),
            "body \"wall\" has reached the bridge at (0.4625, 0.005, 0.005) m; solids must stay 7 cells away from the "
            "faces of the MPM region; enlarge the MPM region there with mpm_region.box or, if the box is placed around "
            "the bodies automatically, with mpm_region.margin");
  c.particles.bodies[0].shape = shape::Box{{0.47, -1.0, -1.0}, {0.50, 1.0, 1.0}};
  EXPECT_EQ(refusal(c), "accepted");
}

}  // namespace
}  // namespace brisance::test
