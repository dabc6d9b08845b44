/// The cells near rigid surfaces: obstacles, walls and planes of symmetry that face a sweep. They change only where an
/// obstacle gives way.
#include <algorithm>
#include <cstdlib>
#include <set>
#include <tuple>
#include <vector>

#include "core/parallel.hpp"
#include "gas/gas.hpp"

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

void Gas::find_near_walls(std::vector<int> const& blocks) {
  grid::Domain const& domain = grid_->domain();
  bool const any_obstacle =
      std::any_of(blocks_.begin(), blocks_.end(), [](BlockData const& data) { return !data.solid.empty(); });
  auto const is_solid = [&](Index3 const& outside) { return is_obstacle(grid::image_cell(domain, outside)); };
  // A face of the domain that reflects; the axis and the centre do not.
  auto const is_rigid_face = [&](int direction, int side) {
    grid::Boundary const boundary = domain.boundary[2 * direction + side];
    bool const axis =
        direction == 0 && side == 0 && grid::radial_exponent(domain.geometry) > 0 && domain.radial_area(0) == 0.0;
    return (boundary == grid::Boundary::wall || boundary == grid::Boundary::symmetry) && !axis;
  };
  parallel_for(static_cast<int>(blocks.size()), [&](int n, int) {
    int const b = blocks[static_cast<std::size_t>(n)];
    grid::Block const& block = grid_->blocks()[b];
    for (int d = 0; d < domain.dimensions(); ++d) {
      auto& of_bundles = blocks_[b].near_walls[d];
      of_bundles.clear();
      int const first = block.origin[d];
      int const beyond = first + block.n[d];
      // Also where no more than a ghost cell is near: both blocks at a face must find the same states there.
      bool const low_face = is_rigid_face(d, 0) && first <= near_wall_cells;
      bool const high_face = is_rigid_face(d, 1) && beyond >= domain.cells[d] - near_wall_cells;
      if (!any_obstacle && !low_face && !high_face) continue;
      Bundles const bundles(block, d, options_.bundle_cells);
      of_bundles.resize(bundles.count());
      // Distances of the block's cells and one ghost cell at each end along a line, in the cells ahead of a surface
      // below and above: places of the line begin at the cell `reach` before the block.
      constexpr int reach = near_wall_cells + 1;
      int const length = block.n[d] + 2 * reach;
      std::vector<char> solid(length);
      std::vector<int> below(length);
      std::vector<int> above(length);
      Index3 lines = block.n;
      lines[d] = 1;
      struct Found {
        int bundle, q, distance;
        bool above;
      };
      std::vector<Found> found;
      for (int k = 0; k < lines[2]; ++k) {
        for (int j = 0; j < lines[1]; ++j) {
          for (int i = 0; i < lines[0]; ++i) {
            Index3 cell{block.origin[0] + i, block.origin[1] + j, block.origin[2] + k};
            for (int l = 0; l < length; ++l) {
              cell[d] = first - reach + l;
              solid[l] = any_obstacle && is_solid(cell) ? 1 : 0;
            }
            // Is the face between places l - 1 and l rigid?
            auto const rigid = [&](int l) {
              int const upper = first - reach + l;
              return solid[l - 1] != solid[l] || (upper == 0 && is_rigid_face(d, 0)) ||
                     (upper == domain.cells[d] && is_rigid_face(d, 1));
            };
            below[0] = far_away;
            for (int l = 1; l < length; ++l) below[l] = rigid(l) ? 0 : std::min(far_away, below[l - 1] + 1);
            above[length - 1] = far_away;
            for (int l = length - 2; l >= 0; --l) above[l] = rigid(l + 1) ? 0 : std::min(far_away, above[l + 1] + 1);
            for (int l = -1; l <= block.n[d]; ++l) {
              int const place = l + reach;
              if (solid[place] != 0) continue;
              Index3 own{i, j, k};
              own[d] = std::clamp(l, 0, block.n[d] - 1);
              int const bundle = bundles.index_of(own);
              BundleLayout const layout = bundles.layout(bundle);
              int const q = layout.place(block.n, own) + (l - own[d]) * layout.stride;
              if (below[place] < far_away) found.push_back({bundle, q, below[place], false});
              if (above[place] < far_away) found.push_back({bundle, q, above[place], true});
            }
          }
        }
      }
      std::sort(found.begin(), found.end(), [](Found const& x, Found const& y) {
        return std::tie(x.bundle, x.above, x.q) < std::tie(y.bundle, y.above, y.q);
      });
      for (Found const& f : found) add_cell(of_bundles[f.bundle], f.q, f.distance, f.above);
      if (found.empty()) of_bundles.clear();
    }
  });
}

std::vector<int> Gas::blocks_near(std::vector<Index3> const& cells, int layers) const {
  grid::Domain const& domain = grid_->domain();
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
  for (int b = 0; b < grid_->block_count(); ++b) {
    grid::Block const& block = grid_->blocks()[b];
    bool meets = true;
    for (int d = 0; d < domain.dimensions(); ++d) {
      meets = meets && block.origin[d] - layers <= upper[d] && block.origin[d] + block.n[d] + layers > lower[d];
    }
    if (meets || everywhere) near.push_back(b);
  }
  return near;
}

void Gas::open_obstacles(std::vector<Index3> const& cells) {
  if (cells.empty()) return;
  grid::Domain const& domain = grid_->domain();
  std::set<Index3> const opened(cells.begin(), cells.end());
  for (int const b : blocks_near(cells, grid::ghost_layers)) {
    std::vector<std::uint8_t>& solid = blocks_[b].solid;
    if (solid.empty()) continue;
    grid::Block const& block = grid_->blocks()[b];
    PaddedBox const box(block, domain.dimensions());
    for (int k = -box.pad[2]; k < block.n[2] + box.pad[2]; ++k) {
      for (int j = -box.pad[1]; j < block.n[1] + box.pad[1]; ++j) {
        for (int i = -box.pad[0]; i < block.n[0] + box.pad[0]; ++i) {
          std::uint8_t& flag = solid[static_cast<std::size_t>(box.offset(i, j, k))];
          if (flag == 0) continue;
          Index3 const cell{block.origin[0] + i, block.origin[1] + j, block.origin[2] + k};
          if (!opened.contains(grid::image_cell(domain, cell))) continue;
          flag = 0;
          awake_[b] = 1;
        }
      }
    }
  }
  find_near_walls(blocks_near(cells, near_wall_cells + 1));
}

void Gas::fill_opened(Index3 const& cell, Index3 const& from) {
  int const b = grid_->block_of(cell);
  int const source = grid_->block_of(from);
  auto const within = [this](int block, Index3 const& c) {
    Index3 const& o = grid_->blocks()[block].origin;
    return Index3{c[0] - o[0], c[1] - o[1], c[2] - o[2]};
  };
  Index3 const donor = within(source, from);
  if (burn_fraction(source, donor[0], donor[1], donor[2]) < 1.0) return;
  Index3 const own = within(b, cell);
  int const at = grid_->blocks()[b].offset(own[0], own[1], own[2]);
  int const there = grid_->blocks()[source].offset(donor[0], donor[1], donor[2]);
  Components u{};
  for (int c = 0; c < components(); ++c) u[c] = fields_.at(source, c)[there];
  double square = 0.0;
  for (int d = 0; d < 3; ++d) {
    square += u[momentum_x + d] * u[momentum_x + d];
    u[momentum_x + d] = 0.0;
  }
  u[energy] -= 0.5 * square / (u[density] + u[second_density]);
  u[shock] = 0.0;
  double const volume = grid_->domain().cell_volume(cell[0]);
  for (int c = 0; c < components(); ++c) {
    double& value = fields_.at(b, c)[at];
    blocks_[b].account.opened[c] += volume * (u[c] - value);
    value = u[c];
  }
}

}  // namespace brisance::gas
