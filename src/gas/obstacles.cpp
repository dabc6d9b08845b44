#include "gas/obstacles.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <set>
#include <tuple>
#include <vector>

#include "core/parallel.hpp"
#include "grid/bundle.hpp"

namespace brisance::gas {

namespace {

constexpr int far_away = near_wall_cells;  ///< distance of cells that no surface is near

/// Joins cell q at some distance to the last run, or begins a new one.
void add_cell(std::vector<WallRun>& runs, int q, int distance, bool above) {
  if (!runs.empty()) {
    WallRun& last = runs.back();
    int const end_distance = last.distance + last.change * (last.count - 1);
    int const change = distance - end_distance;
    bool const next = q == last.q + last.count && above == last.above;
    if (next && (last.count == 1 ? std::abs(change) <= 1 : change == last.change)) {
      last.change = change;
      ++last.count;
      return;
    }
  }
  runs.push_back({q, 1, distance, 0, above});
}

}  // namespace

Obstacles::Obstacles(grid::Grid const& grid, int bundle_cells)
    : grid_(&grid), bundle_cells_(bundle_cells), blocks_(grid) {}

bool Obstacles::contain(grid::Cell const& cell) const {
  auto const& solid = blocks_[cell.block].solid;
  return !solid.empty() && solid[grid_->block(cell).with_ghosts().offset(cell.within())] != 0;
}

bool Obstacles::contain(int level, Index3 const& cell) const {
  if (auto const found = grid_->locate(level, cell)) return contain(*found);
  return elsewhere_ && elsewhere_(level, cell);
}

std::vector<WallRun> const* Obstacles::near_walls(int block, int direction, int bundle) const {
  auto const& of_bundles = blocks_[block].near_walls[direction];
  return of_bundles.empty() || of_bundles[bundle].empty() ? nullptr : &of_bundles[bundle];
}

bool Obstacles::any() const {
  return std::any_of(blocks_.begin(), blocks_.end(), [](OfBlock const& data) { return !data.solid.empty(); });
}

void Obstacles::rearrange(grid::Grid const& old, std::vector<grid::Block> const& blocks,
                          std::vector<int> const& before) {
  std::vector<std::uint8_t> stays(old.blocks().size(), 0);
  for (int const b : before) {
    if (b != grid::no_neighbour) stays[b] = 1;
  }
  for (grid::Block const& block : old.blocks()) {
    if (stays[block.number] == 0)
      gone_[{block.level, block.in_domain().lower}] = std::move(blocks_[block.number].near_walls);
  }
  blocks_.rearrange(blocks, before);
}

void Obstacles::find_near_walls() {
  gone_.clear();
  std::vector<int> all(blocks_.size());
  std::iota(all.begin(), all.end(), 0);
  find_near_walls_of(all);
}

void Obstacles::find_near_walls(std::vector<int> const& new_blocks) {
  std::vector<int> unknown;
  for (int const b : new_blocks) {
    grid::Block const& block = grid_->blocks()[b];
    auto const found = gone_.find({block.level, block.in_domain().lower});
    if (found == gone_.end()) {
      unknown.push_back(b);
      continue;
    }
    blocks_[b].near_walls = std::move(found->second);
    gone_.erase(found);
  }
  find_near_walls_of(unknown);
}

void Obstacles::find_near_walls_of(std::vector<int> const& blocks) {
  bool const any_obstacle = any();
  parallel_for(static_cast<int>(blocks.size()), [&](int n, int) {
    grid::Block const& block = grid_->blocks()[blocks[static_cast<std::size_t>(n)]];
    for (int d = 0; d < grid_->domain().dimensions(); ++d) find_near_walls(block, d, any_obstacle);
  });
}

bool Obstacles::reach_obstacle(grid::Block const& block, int d) const {
  if (!blocks_[block.number].solid.empty()) return true;
  for (int face = 2 * d; face < 2 * d + 2; ++face) {
    int other = block.neighbour[face];
    if (block.beyond[face] == grid::Beyond::nothing) return true;
    if (block.beyond[face] == grid::Beyond::coarser) other = grid::coarser_block_beyond(*grid_, block, face);
    if (other == grid::no_neighbour) continue;
    // Behind a thin block there is another one.
    if (!blocks_[other].solid.empty() || grid_->blocks()[other].n[d] <= near_wall_cells) return true;
  }
  return false;
}

char Obstacles::Marks::at(grid::Cell const& line, Index3 const& cell, int d) const {
  if (solid->empty()) return 0;
  Index3 within = line.within();
  within[d] = cell[d] - block->in_domain().lower[d];
  return static_cast<char>((*solid)[block->with_ghosts().offset(within)]);
}

std::array<Obstacles::Marks, 3> Obstacles::marks_along(grid::Block const& block, int d, int reach) const {
  std::array<Marks, 3> marks{Marks{&block, &blocks_[block.number].solid}, Marks{}, Marks{}};
  for (int side = 0; side < 2; ++side) {
    int const other = block.neighbour[2 * d + side];
    if (other == grid::no_neighbour) continue;
    grid::Block const& beyond = grid_->blocks()[other];
    grid::CellRange const own = block.in_domain();
    grid::CellRange const next = beyond.in_domain();
    bool const adjoins = side == 0 ? next.upper[d] == own.lower[d] : next.lower[d] == own.upper[d];
    if (adjoins && beyond.n[d] >= reach) marks[1 + side] = {&beyond, &blocks_[other].solid};
  }
  return marks;
}

void Obstacles::find_near_walls(grid::Block const& block, int d, bool any_obstacle) {
  grid::Domain const& domain = grid_->domain_of(block);
  // A face of the domain that reflects; the axis and the centre do not.
  auto const is_rigid_face = [&](int direction, int side) {
    int const face = 2 * direction + side;
    return domain.is_mirror(face) && !domain.is_axis(face);
  };
  auto& of_bundles = blocks_[block.number].near_walls[d];
  of_bundles.clear();
  grid::CellRange const own_cells = block.in_domain();
  int const first = own_cells.lower[d];
  int const beyond = own_cells.upper[d];
  // Also where no more than a ghost cell is near: both blocks at a face must find the same states there.
  bool const low_face = is_rigid_face(d, 0) && first <= near_wall_cells;
  bool const high_face = is_rigid_face(d, 1) && beyond >= domain.cells[d] - near_wall_cells;
  bool const obstacle_near = any_obstacle && reach_obstacle(block, d);
  if (!obstacle_near && !low_face && !high_face) return;
  grid::Bundles const bundles(block, d, bundle_cells_);
  of_bundles.resize(bundles.count());
  // Distances of the block's cells and one ghost cell at each end along a line, in the cells ahead of a surface
  // below and above: places of the line begin at the cell `reach` before the block.
  constexpr int reach = near_wall_cells + 1;
  int const length = block.n[d] + 2 * reach;
  std::vector<char> solid(length);
  std::vector<int> below(length);
  std::vector<int> above(length);
  struct Found {
    int bundle, q, distance;
    bool above;
  };
  std::vector<Found> found;
  std::array<Marks, 3> const marks = marks_along(block, d, reach);
  for_each_face_cell(block, d, 0, [&](grid::Cell const& line) {
    Index3 cell = block.index(line);
    for (int l = 0; obstacle_near && l < length; ++l) {
      cell[d] = first - reach + l;
      Marks const& of = marks[l < reach ? 1 : l < reach + block.n[d] ? 0 : 2];
      solid[l] = of.block == nullptr ? contain(block.level, grid::image_cell(domain, cell)) : of.at(line, cell, d);
    }
    // Is the face between places l - 1 and l rigid?
    auto const rigid = [&](int l) {
      int const upper = first - reach + l;
      return solid[l - 1] != solid[l] || (upper == 0 && is_rigid_face(d, 0)) ||
             (upper == domain.cells[d] && is_rigid_face(d, 1));
    };
    bool any_rigid = false;
    for (int l = 1; l < length && !any_rigid; ++l) any_rigid = rigid(l);
    if (!any_rigid) return;
    below[0] = far_away;
    for (int l = 1; l < length; ++l) below[l] = rigid(l) ? 0 : std::min(far_away, below[l - 1] + 1);
    above[length - 1] = far_away;
    for (int l = length - 2; l >= 0; --l) above[l] = rigid(l + 1) ? 0 : std::min(far_away, above[l + 1] + 1);
    for (int l = -1; l <= block.n[d]; ++l) {
      int const place = l + reach;
      if (solid[place] != 0) continue;
      Index3 own = line.within();
      own[d] = std::clamp(l, 0, block.n[d] - 1);
      int const bundle = bundles.index_of(block.cell(own));
      BundleLayout const layout = bundles.layout(bundle);
      int const q = layout.place(block, block.cell(own)) + (l - own[d]) * layout.stride;
      if (below[place] < far_away) found.push_back({bundle, q, below[place], false});
      if (above[place] < far_away) found.push_back({bundle, q, above[place], true});
    }
  });
  std::sort(found.begin(), found.end(), [](Found const& x, Found const& y) {
    return std::tie(x.bundle, x.above, x.q) < std::tie(y.bundle, y.above, y.q);
  });
  for (Found const& f : found) add_cell(of_bundles[f.bundle], f.q, f.distance, f.above);
  if (found.empty()) of_bundles.clear();
}

std::vector<int> Obstacles::blocks_near(int level, std::vector<Index3> const& cells, int layers) const {
  grid::Domain const& domain = grid_->domain(level);
  Index3 lower = cells.front();
  Index3 upper = cells.front();
  for (Index3 const& cell : cells) {
    for (int d = 0; d < 3; ++d) {
      lower[d] = std::min(lower[d], cell[d]);
      upper[d] = std::max(upper[d], cell[d]);
    }
  }
  bool const everywhere = std::any_of(domain.boundary.begin(), domain.boundary.end(),
                                      [](grid::Boundary b) { return b == grid::Boundary::periodic; });
  std::vector<int> near;
  for (int const b : grid_->blocks_of(level)) {
    grid::CellRange const reach = grid_->blocks()[b].in_domain().grown(layers, domain.dimensions());
    bool meets = true;
    for (int d = 0; d < domain.dimensions(); ++d) {
      meets = meets && reach.lower[d] <= upper[d] && reach.upper[d] > lower[d];
    }
    if (meets || everywhere) near.push_back(b);
  }
  return near;
}

std::vector<int> Obstacles::open(int level, std::vector<Index3> const& cells) {
  std::vector<int> changed;
  if (cells.empty()) return changed;
  grid::Domain const& domain = grid_->domain(level);
  std::set<Index3> const opened(cells.begin(), cells.end());
  for (int const b : blocks_near(level, cells, grid::ghost_layers)) {
    std::vector<std::uint8_t>& solid = blocks_[b].solid;
    if (solid.empty()) continue;
    grid::Block const& block = grid_->blocks()[b];
    grid::CellRange const box = block.with_ghosts();
    bool sees = false;
    for_each_cell(box, [&](Index3 const& within) {
      std::uint8_t& flag = solid[box.offset(within)];
      if (flag == 0 || !opened.contains(grid::image_cell(domain, block.index(within)))) return;
      flag = 0;
      sees = true;
    });
    if (sees) changed.push_back(b);
  }
  gone_.clear();
  find_near_walls_of(blocks_near(level, cells, near_wall_cells + 1));
  return changed;
}

}  // namespace brisance::gas
