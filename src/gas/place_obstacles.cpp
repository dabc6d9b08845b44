#include "gas/place_obstacles.hpp"

#include <utility>

namespace brisance::gas {

void place_obstacles(Gas& gas, shape::CutGeometry const& geometry, Primitive const& inside) {
  if (geometry.solid.empty()) return;
  grid::Grid const& grid = gas.grid();
  grid::CellRange const all = grid.domain().all_cells();
  gas.cut.set(
      geometry.cells, 0, [&](Index3 const& cell) { return geometry.solid[all.offset(cell)] != 0; },
      gas.fields().components());
  for (grid::Block const& block : grid.blocks()) {
    grid::CellRange const box = block.with_ghosts();
    std::vector<std::uint8_t> solid(box.count(), 0);
    bool any = gas.cut.in(block.number);
    for_each_cell(box, [&](Index3 const& within) {
      if (geometry.solid[all.offset(grid::image_cell(grid.domain(), block.index(within)))] == 0) return;
      solid[box.offset(within)] = 1;
      any = true;
      if (block.interior().contains(within)) gas.set(block.cell(within), inside);
    });
    if (any) gas.obstacles.set(block.number, std::move(solid));
  }
}

double open_part(Gas const& gas, grid::Cell const& cell) {
  if (gas.obstacles.contain(cell)) return 0.0;
  return gas.cut.volume(cell) / gas.grid().block(cell).volume(cell);
}

}  // namespace brisance::gas
