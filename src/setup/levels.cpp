#include "setup/levels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.hpp"
#include "grid/partition.hpp"
#include "setup/place_obstacles.hpp"
#include "setup/place_region.hpp"
#include "setup/solid_cells.hpp"
#include "shape/cut_cells.hpp"

namespace brisance::setup {

namespace {

using gas::LevelBounds;

/// Layers that cells of a level must keep from a surface that does not fit them: those that their sweeps see.
constexpr int fit_margin = 3;
/// Layers around a block that are looked at with it: what a cut cell is depends on its neighbours.
constexpr int cut_margin = 3;

bool is_part(double fraction) { return fraction > 1e-9 && fraction < 1.0 - 1e-9; }

/// Cells of a level around a place.
grid::CellRange cells_around(grid::Domain const& domain, Vec3 const& x) {
  grid::CellRange cells;
  for (int d = 0; d < domain.dimensions(); ++d) {
    cells.lower[d] = static_cast<int>(std::floor(domain.in_cells(d, x[d]))) - level_margin;
    cells.upper[d] = cells.lower[d] + 2 * level_margin + 1;
  }
  return cells;
}

/// Does a shape reach into cells, or past them within so many layers?
bool reaches_into(shape::Shape const& shape, grid::Domain const& domain, grid::CellRange const& cells, int layers) {
  grid::CellRange const box = grid::common(grid::common(cells.grown(layers, domain.dimensions()), domain.all_cells()),
                                           shape::cells_around(shape, domain));
  if (box.empty()) return false;
  bool found = false;
  shape::for_each_share({shape}, domain, box, [&](grid::CellRange const&, std::vector<shape::Share> const& shares) {
    found = !shares.empty();
    return !found;
  });
  // A shape between the samples counts by its centre.
  Vec3 const centre = shape::centre(shape);
  Index3 at{0, 0, 0};
  for (int d = 0; d < domain.dimensions(); ++d) at[d] = static_cast<int>(std::floor(domain.in_cells(d, centre[d])));
  return found || box.contains(at);
}

}  // namespace

LevelObstacles::LevelObstacles(Case const& setup)
    : domain_(setup.domain),
      block_size_(grid::refinable_partition_of(setup.domain, setup.numerics.block_cells).size),
      level_(setup.adaptive.obstacles),
      finest_(setup.adaptive.finest),
      cut_(has_cut_cells(setup)) {
  for (Obstacle const& obstacle : setup.obstacles) shapes_.push_back(obstacle.shape);
}

bool LevelObstacles::fit(int level, grid::CellRange const& cells) const {
  if (shapes_.empty()) return true;
  auto const known = fits_.try_emplace({level, cells.lower}, true);
  bool& fits = known.first->second;
  if (!known.second) return fits;
  grid::Domain const domain = domain_.refined(level);
  grid::CellRange const around = grid::common(cells.grown(fit_margin, domain.dimensions()), domain.all_cells());
  shape::for_each_share(shapes_, domain, around, [&](grid::CellRange const&, std::vector<shape::Share> const& shares) {
    fits = !is_part(shape::sum_of(shares));
    return fits;
  });
  return fits;
}

LevelObstacles::OfBlock LevelObstacles::find(int level, grid::CellRange const& cells) const {
  OfBlock of;
  grid::Domain const domain = domain_.refined(level);
  grid::CellRange const box = cells.grown(grid::ghost_layers, domain.dimensions());
  // Beyond the domain lie images, maybe of cells at its other end: those are looked at one by one.
  grid::CellRange const near =
      grid::common(cells.grown(grid::ghost_layers + cut_margin, domain.dimensions()), domain.all_cells());
  bool const cut = cut_ && level == level_;
  shape::CutGeometry geometry;
  if (cut) geometry = shape::cut_cells(shapes_, domain, near);
  auto const by_half = [&](Index3 const& cell) {
    return SolidCells::solid(shape::sum_of(shape::shares_of_cell(shapes_, domain, cell)));
  };
  std::vector<std::uint8_t> solid(near.count(), 0);
  if (cut) {
    solid = std::move(geometry.solid);
    for (shape::CutCell const& cell : geometry.cells) {
      if (cells.contains(cell.cell)) of.cut.push_back(cell);
    }
  } else {
    shape::for_each_share(shapes_, domain, near,
                          [&](grid::CellRange const& r, std::vector<shape::Share> const& shares) {
                            if (!SolidCells::solid(shape::sum_of(shares))) return true;
                            for_each_cell(r, [&](Index3 const& cell) { solid[near.offset(cell)] = 1; });
                            return true;
                          });
  }
  bool any = !of.cut.empty();
  of.solid.assign(box.count(), 0);
  for_each_cell(box, [&](Index3 const& index) {
    Index3 const cell = grid::image_cell(domain, index);
    bool const here = near.contains(cell) ? solid[near.offset(cell)] != 0 : by_half(cell);
    if (!here) return;
    of.solid[box.offset(index)] = 1;
    any = true;
  });
  if (!any) of.solid.clear();
  return of;
}

LevelObstacles::OfBlock const& LevelObstacles::of(int level, grid::CellRange const& cells) const {
  std::lock_guard const lock(mutex_);
  auto const [found, fresh] = known_.try_emplace({level, cells.lower});
  if (fresh) found->second = find(level, cells);
  return found->second;
}

bool LevelObstacles::solid(int level, Index3 const& cell) const {
  grid::CellRange const all = domain_.refined(level).all_cells();
  if (shapes_.empty() || !all.contains(cell)) return false;
  grid::CellRange block{cell, cell};
  for (int d = 0; d < domain_.dimensions(); ++d) {
    block.lower[d] = cell[d] / block_size_[d] * block_size_[d];
    block.upper[d] = block.lower[d] + block_size_[d];
  }
  for (int d = domain_.dimensions(); d < 3; ++d) ++block.upper[d];
  block = grid::common(block, all);
  std::vector<std::uint8_t> const& marks = of(level, block).solid;
  return !marks.empty() && marks[block.grown(grid::ghost_layers, domain_.dimensions()).offset(cell)] != 0;
}

void LevelObstacles::furnish(gas::Gas& gas, std::vector<int> const& new_blocks) const {
  if (shapes_.empty()) return;
  grid::Grid const& grid = gas.grid();
  for (int const b : new_blocks) {
    grid::Block const& block = grid.blocks()[b];
    if (block.level > level_ && !fit(block.level, block.in_domain())) {
      Vec3 const x = block.metric.low_corner(block.in_domain().lower);
      throw InputError(
          fmt::format("the surface of an obstacle near ({:.6g}, {:.6g}, {:.6g}) m lies in cells of {:.6g} m, which are "
                      "finer than those that obstacles have, of {:.6g} m: make adaptive.obstacles as fine, or move the "
                      "refinement away from the obstacle",
                      x[0], x[1], x[2], block.h(), grid.domain(level_).smallest_cell()));
    }
    OfBlock const& found = of(block.level, block.in_domain());
    if (!found.solid.empty()) gas.obstacles.set(b, found.solid);
  }
  if (!cut_ || level_ >= grid.levels()) return;
  std::vector<shape::CutCell> cells;
  for (int const b : grid.blocks_of(level_)) {
    if (grid.blocks()[b].covered) continue;
    OfBlock const& found = of(level_, grid.blocks()[b].in_domain());
    cells.insert(cells.end(), found.cut.begin(), found.cut.end());
  }
  gas.cut.set(
      cells, level_, [&](Index3 const& cell) { return gas.obstacles.contain(level_, cell); },
      gas.fields().components());
}

namespace {

/// What the parts of a domain ask for.
class PartsOfDomain {
 public:
  PartsOfDomain(Case const& setup, std::shared_ptr<LevelObstacles const> obstacles)
      : domain_(setup.domain),
        parts_(setup.adaptive.parts),
        gauge_level_(setup.adaptive.gauges.value_or(0)),
        obstacles_(std::move(obstacles)),
        obstacle_level_(setup.adaptive.obstacles) {
    if (setup.adaptive.gauges) {
      for (Gauge const& gauge : setup.gauges) gauges_.push_back(gauge.position);
    }
    for (Obstacle const& obstacle : setup.obstacles) {
      if (obstacle.release) panels_.push_back(obstacle.shape);
    }
    for (std::size_t number = 0; number < setup.mpm_regions.size(); ++number) find_region(setup, number);
  }

  LevelBounds operator()(int level, grid::CellRange const& cells) const {
    LevelBounds bounds;
    grid::Domain const fine = domain_.refined(level);
    auto const at_least = [&](int wanted) { bounds.least = std::max(bounds.least, wanted); };
    for (Refine const& part : parts_) {
      if (bounds.least < part.level && reaches_into(part.shape, fine, cells, 0)) at_least(part.level);
    }
    for (Vec3 const& x : gauges_) {
      if (!grid::common(cells_around(fine, x), cells).empty()) at_least(gauge_level_);
    }
    for (shape::Shape const& panel : panels_) {
      if (reaches_into(panel, fine, cells, level_margin)) keep(obstacle_level_, bounds);
    }
    if (obstacles_ != nullptr && obstacles_->any()) {
      if (!obstacles_->fit(level, cells)) {
        keep(obstacle_level_, bounds);
      } else if (level > 0 && bounds.least < level && !obstacles_->fit(level - 1, coarser_block(level, cells))) {
        at_least(level);
      }
    }
    // Last: nothing may change the cells of a region.
    return levels_of_regions(level, cells).value_or(bounds);
  }

  /// A region that touches the block of a leaf and has other cells.
  [[nodiscard]] std::optional<std::size_t> region_of_other_level(int level, grid::CellRange const& cells) const {
    for (RegionBox const& region : regions_) {
      if (region.level != level && touches(region, level, cells)) return region.number;
    }
    return std::nullopt;
  }

 private:
  /// Shocks ask for no more than a level that something has.
  static void keep(int level, LevelBounds& bounds) {
    bounds.least = std::max(bounds.least, level);
    bounds.most = std::min(bounds.most, bounds.least);
  }
  /// The cells of the block that a block would be merged into.
  [[nodiscard]] grid::CellRange coarser_block(int level, grid::CellRange const& cells) const {
    grid::CellRange coarser = cells;
    for (int d = 0; d < domain_.dimensions(); ++d) {
      int const n = cells.n(d);
      coarser.lower[d] = cells.lower[d] / (2 * n) * n;
      coarser.upper[d] = coarser.lower[d] + n;
    }
    return grid::common(coarser, domain_.refined(level - 1).all_cells());
  }
  /// A box of a region with the cells beside it.
  struct RegionBox {
    std::size_t number = 0;  ///< of the region
    int level = 0;
    grid::CellRange cells;
  };
  [[nodiscard]] bool touches(RegionBox const& region, int level, grid::CellRange const& cells) const {
    double const scale = std::ldexp(1.0, level - region.level);
    grid::CellRange here = region.cells;  // in cells of this level
    for (int d = 0; d < domain_.dimensions(); ++d) {
      here.lower[d] = static_cast<int>(std::floor(region.cells.lower[d] * scale));
      here.upper[d] = static_cast<int>(std::ceil(region.cells.upper[d] * scale));
    }
    return !grid::common(here, cells).empty();
  }
  void find_region(Case const& setup, std::size_t number) {
    bridge::Region const of_case = region_of(setup, number);
    // Boxes may lie far apart.
    for (grid::CellRange box : of_case.boxes()) {
      int const layers = level_margin + proxy_reach(setup);
      regions_.push_back({number, of_case.level(), box.grown(layers, domain_.dimensions())});
    }
  }
  /// A block that touches several regions is still coarser than any of them, and is refined.
  [[nodiscard]] std::optional<LevelBounds> levels_of_regions(int level, grid::CellRange const& cells) const {
    std::optional<LevelBounds> bounds;
    for (RegionBox const& region : regions_) {
      if (!touches(region, level, cells)) continue;
      if (!bounds) bounds = {region.level, region.level};
      bounds->least = std::min(bounds->least, region.level);
      bounds->most = std::max(bounds->most, region.level);
    }
    return bounds;
  }

  grid::Domain domain_;
  std::vector<Refine> parts_;
  std::vector<Vec3> gauges_;
  int gauge_level_;
  std::vector<shape::Shape> panels_;
  std::shared_ptr<LevelObstacles const> obstacles_;
  int obstacle_level_;
  std::vector<RegionBox> regions_;
};

}  // namespace

gas::RefinementRules::Bounds level_bounds(Case const& setup, std::shared_ptr<LevelObstacles const> const& obstacles) {
  return PartsOfDomain(setup, obstacles);
}

std::optional<std::pair<std::size_t, std::size_t>> regions_without_own_blocks(Case const& setup) {
  auto const& regions = setup.mpm_regions;
  auto const other = [&](std::size_t number) {
    auto const found =
        std::ranges::find_if(regions, [&](MpmRegion const& r) { return r.level != regions[number].level; });
    return static_cast<std::size_t>(found - regions.begin());
  };
  if (!setup.adaptive.any() || regions.empty() || other(0) == regions.size()) return std::nullopt;
  Case alone = setup;  // nothing but the regions asks for cells
  alone.adaptive.parts.clear();
  alone.adaptive.gauges.reset();
  alone.obstacles.clear();
  PartsOfDomain const bounds(alone, nullptr);
  grid::Partition const partition = grid::refinable_partition_of(setup.domain, setup.numerics.block_cells);
  int const dims = setup.domain.dimensions();
  grid::Forest forest(partition.parts, dims, grid::periodic_directions(setup.domain));
  gas::refine_to(forest, setup.domain, partition.size, refinement_rules(alone, nullptr).most_level, bounds);
  for (grid::Leaf const& leaf : forest.leaves()) {
    grid::CellRange cells;
    for (int d = 0; d < dims; ++d) {
      cells.lower[d] = leaf.place[d] * partition.size[d];
      cells.upper[d] = cells.lower[d] + partition.size[d];
    }
    cells = grid::common(cells, setup.domain_of(leaf.level).all_cells());
    auto const found = bounds.region_of_other_level(leaf.level, cells);
    if (found) return std::pair{std::min(*found, other(*found)), std::max(*found, other(*found))};
  }
  return std::nullopt;
}

gas::RefinementRules::Bounds charge_bounds(Case const& setup) {
  if (setup.charges.empty() || setup.start.remap || setup.adaptive.charges == 0) return {};
  std::vector<shape::Shape> shapes;
  for (Charge const& charge : setup.charges) shapes.push_back(charge.shape);
  return [shapes, domain = setup.domain, wanted = setup.adaptive.charges](int level, grid::CellRange const& cells) {
    LevelBounds bounds;
    for (shape::Shape const& shape : shapes) {
      if (reaches_into(shape, domain.refined(level), cells, level_margin)) bounds.least = wanted;
    }
    return bounds;
  };
}

int steps_between_changes(Case const& setup) {
  // So many that a shock makes some eight of the finest cells between two.
  constexpr int cells = 8;
  return std::max(1, cells >> setup.adaptive.shocks);
}

gas::RefinementRules refinement_rules(Case const& setup, std::shared_ptr<LevelObstacles const> const& obstacles) {
  Adaptive const& adaptive = setup.adaptive;
  gas::RefinementRules rules;
  rules.most_level = adaptive.finest;
  for (MpmRegion const& region : setup.mpm_regions) rules.most_level = std::max(rules.most_level, region.level);
  rules.shock_level = adaptive.shocks;
  rules.products_level = adaptive.products.value_or(-1);
  rules.threshold = adaptive.threshold;
  Index3 const size = grid::refinable_partition_of(setup.domain, setup.numerics.block_cells).size;
  int least = size[0];
  for (int d = 1; d < setup.domain.dimensions(); ++d) least = std::min(least, size[d]);
  // No shock outruns the sound behind it: it makes less than a step's Courant number of cells in each.
  rules.buffer = std::min(least, 3 * (steps_between_changes(setup) << adaptive.shocks) / 4);
  rules.bounds = level_bounds(setup, obstacles);
  rules.while_bursting = charge_bounds(setup);
  rules.most_cells = adaptive.most_cells;
  return rules;
}

grid::Forest start_forest(Case const& setup, std::shared_ptr<LevelObstacles const> const& obstacles) {
  grid::Partition const partition = grid::refinable_partition_of(setup.domain, setup.numerics.block_cells);
  int const dims = setup.domain.dimensions();
  grid::Forest forest(partition.parts, dims, grid::periodic_directions(setup.domain));
  gas::RefinementRules const rules = refinement_rules(setup, obstacles);
  auto const bounds = [&rules](int level, grid::CellRange const& cells) {
    gas::LevelBounds all = rules.bounds(level, cells);
    if (rules.while_bursting) all.least = std::max(all.least, rules.while_bursting(level, cells).least);
    return all;
  };
  gas::refine_to(forest, setup.domain, partition.size, rules.most_level, bounds);
  double cells = static_cast<double>(forest.leaves().size());
  for (int d = 0; d < dims; ++d) cells *= partition.size[d];
  if (setup.adaptive.most_cells > 0.0 && cells > setup.adaptive.most_cells) {
    throw InputError(
        fmt::format("the start needs {:.4g} cells, more than adaptive.cells = {:.4g}: allow more, or refine smaller "
                    "parts of the domain",
                    cells, setup.adaptive.most_cells));
  }
  return forest;
}

}  // namespace brisance::setup
