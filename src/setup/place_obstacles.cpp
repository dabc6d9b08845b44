#include "setup/place_obstacles.hpp"

#include <algorithm>
#include <numeric>

#include "gas/place_obstacles.hpp"
#include "shape/cut_cells.hpp"

namespace brisance::setup {

bool has_cut_cells(Case const& setup) {
  if (setup.numerics.scheme != gas::Scheme::muscl_hancock) return false;
  switch (setup.numerics.obstacles) {
    case ObstacleCells::cut: return true;
    case ObstacleCells::stairs: return false;
    case ObstacleCells::automatic: break;
  }
  return std::none_of(setup.obstacles.begin(), setup.obstacles.end(),
                      [](Obstacle const& obstacle) { return obstacle.release.has_value(); });
}

void place_obstacles(Case const& setup, SolidCells const& solid, gas::Gas& gas) {
  if (!solid.any()) return;
  shape::CutGeometry geometry;
  if (has_cut_cells(setup))
    geometry = shape::cut_cells(solid.shapes(), setup.domain);
  else
    geometry.solid = solid.all();
  gas::place_obstacles(gas, geometry, setup.ambient.state);
}

void place_obstacles(Case const& setup, LevelObstacles const& obstacles, gas::Gas& gas) {
  std::vector<int> all(gas.grid().blocks().size());
  std::iota(all.begin(), all.end(), 0);
  obstacles.furnish(gas, all);
  for (grid::Block const& block : gas.grid().blocks()) {
    if (gas.obstacles.solid(block.number).empty()) continue;
    for_each_cell(block, [&](grid::Cell const& cell) {
      if (gas.obstacles.contain(cell)) gas.set(cell, setup.ambient.state);
    });
  }
}

double open_part(Case const& setup, SolidCells const& solid, Index3 const& cell) {
  if (!solid.any()) return 1.0;
  if (!has_cut_cells(setup)) return solid(cell) ? 0.0 : 1.0;
  double const open = 1.0 - shape::sum_of(shape::shares_of_cell(solid.shapes(), solid.domain(), cell));
  return open < shape::least_open ? 0.0 : open;
}

}  // namespace brisance::setup
