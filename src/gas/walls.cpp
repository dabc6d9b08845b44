/// The cells near rigid surfaces: obstacles, walls and planes of symmetry that face a sweep. Known from the start.
#include <algorithm>
#include <cstdlib>
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

void Gas::find_near_walls() {
  grid::Domain const& domain = grid_->domain();
  bool const any_obstacle =
      std::any_of(blocks_.begin(), blocks_.end(), [](BlockData const& data) { return !data.solid.empty(); });
  auto const is_solid = [&](Index3 const& outside) {
    Index3 const cell = grid::image_cell(domain, outside);
    int const b = grid_->block_of(cell);
    Index3 const& o = grid_->blocks()[b].origin;
    return is_obstacle(b, cell[0] - o[0], cell[1] - o[1], cell[2] - o[2]);
  };
  // A face of the domain that reflects; the axis and the centre do not.
  auto const is_rigid_face = [&](int direction, int side) {
    grid::Boundary const boundary = domain.boundary[2 * direction + side];
    bool const axis =
        direction == 0 && side == 0 && grid::radial_exponent(domain.geometry) > 0 && domain.radial_area(0) == 0.0;
    return (boundary == grid::Boundary::wall || boundary == grid::Boundary::symmetry) && !axis;
  };
  parallel_for(grid_->block_count(), [&](int b, int) {
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

}  // namespace brisance::gas
