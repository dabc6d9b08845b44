#include "gas/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/archive.hpp"
#include "core/parallel.hpp"
#include "gas/gas.hpp"
#include "gas/shock_norm.hpp"
#include "grid/fine_cells.hpp"
#include "grid/pieces.hpp"

namespace brisance::gas {

namespace {

/// Parts of a block and of the blocks around it that cells which ask reach with the buffer: two along each direction in
/// each of three blocks, counted from -2 to 3.
class Reach {
 public:
  void add(grid::CellRange const& parts) {
    for_each_cell(parts, [&](Index3 const& part) { reached_[all.offset(part)] = true; });
  }
  template <class Visit>
  void for_each(Visit&& visit) const {
    for_each_cell(all, [&](Index3 const& part) {
      if (reached_[all.offset(part)]) visit(part);
    });
  }
  static constexpr grid::CellRange all{{-2, -2, -2}, {4, 4, 4}};

 private:
  std::array<bool, 216> reached_{};
};

/// The part of a block, counted on beyond it, that a cell lies in.
int part_with(int cell, int half) {
  int const part = cell >= 0 ? cell / half : -((half - 1 - cell) / half);
  return std::clamp(part, -2, 3);
}

constexpr int beside = 2;  // cells that every shock needs around: it is as thick

Reach reach_of(grid::Block const& block, std::vector<std::uint8_t> const& asks, int buffer) {
  Reach reach;
  int const dims = block.metric.dimensions();
  for_each_cell(block, [&](grid::Cell const& cell) {
    std::uint8_t const how = asks[cell.offset];
    if (how == 0) return;
    grid::CellRange parts{{0, 0, 0}, {1, 1, 1}};
    Index3 const within = cell.within();
    for (int d = 0; d < dims; ++d) {
      auto const cells = [&](int side) { return (how & asks_towards(2 * d + side)) != 0 ? buffer : beside; };
      int const half = block.size[d] / 2;
      parts.lower[d] = part_with(within[d] - cells(0), half);
      parts.upper[d] = part_with(within[d] + cells(1), half) + 1;
    }
    reach.add(parts);
  });
  return reach;
}

/// The cells of a leaf inside the domain.
grid::CellRange cells_of(grid::Leaf const& leaf, grid::Domain const& domain, Index3 const& size) {
  grid::CellRange cells;
  for (int d = 0; d < domain.dimensions(); ++d) {
    cells.lower[d] = leaf.place[d] * size[d];
    cells.upper[d] = cells.lower[d] + size[d];
  }
  return grid::common(cells, domain.all_cells());
}

/// Which cells lie beside others that hold another part of products?
double mark_products_surface(Gas const& gas, grid::Block const& block, std::vector<std::uint8_t>& asks) {
  constexpr double step = 0.05;
  double largest = 0.0;
  double const* const alpha = gas.fields().at(block.number, volume_fraction(products_fluid));
  for_each_cell(block, [&](grid::Cell const& cell) {
    for (int d = 0; d < block.metric.dimensions(); ++d) {
      if (cell.within()[d] + 1 >= block.n[d]) continue;
      grid::Cell const next = block.cell(grid::beside(cell.within(), d, 1));
      double const difference = std::abs(alpha[next.offset] - alpha[cell.offset]);
      if (difference < step) continue;
      asks[cell.offset] = asks[next.offset] = asks_everywhere;
      largest = std::max(largest, difference);
    }
  });
  return largest;
}

}  // namespace

void refine_to(grid::Forest& forest, grid::Domain const& domain, Index3 const& size, int most_level,
               RefinementRules::Bounds const& bounds) {
  auto const least = [&](grid::Leaf const& leaf) {
    grid::CellRange const cells = cells_of(leaf, domain.refined(leaf.level), size);
    return cells.empty() ? 0 : bounds(leaf.level, cells).least;
  };
  for (int level = 0; level < most_level; ++level) {
    std::vector<std::int8_t> marks;
    for (grid::Leaf const& leaf : forest.leaves()) marks.push_back(leaf.level == level && least(leaf) > level ? 1 : 0);
    forest.adapt(marks, most_level);
  }
  std::vector<std::uint8_t> may;
  for (grid::Leaf const& leaf : forest.leaves()) may.push_back(leaf.level > 0 && least(leaf) < leaf.level ? 1 : 0);
  forest.leave_coarse(may);
}

namespace {

/// What cells of a block ask for: a level, how strongly, and where.
struct Asking {
  int level = -1;
  double norm = 0.0;
  Reach reach;
};

/// Shocks in the cells of a block, and the surface of the products.
std::array<Asking, 2> asking_of(Gas const& gas, grid::Block const& block, RefinementRules const& rules,
                                ShockNorm& shocks) {
  std::array<Asking, 2> asking;
  std::vector<std::uint8_t> asks;
  // The way in cells of the finest level that is asked for, of what moves as fast as anything in the block.
  auto const buffer = [&](int level) {
    double const way = rules.buffer * std::min(1.0, gas.fastest_signal(block.number) / gas.fastest_signal());
    return std::max(beside, static_cast<int>(std::ceil(std::ldexp(way, std::min(0, block.level - level)))));
  };
  double const norm = shocks.find(gas, block, rules, asks);
  if (norm >= rules.threshold) {
    asking[0] = {rules.shock_level, norm, reach_of(block, asks, buffer(rules.shock_level))};
  }
  if (rules.products_level < 0 || !gas.fluids().mixed()) return asking;
  asks.assign(asks.size(), 0);
  double const difference = mark_products_surface(gas, block, asks);
  if (difference > 0.0) {
    asking[1] = {rules.products_level, difference, reach_of(block, asks, buffer(rules.products_level))};
  }
  return asking;
}

/// Calls ask(place) for the blocks, of the level that is asked for or the next finer one than the block that asks, that
/// its cells ask for.
template <class Ask>
void for_each_asked(grid::Forest const& forest, grid::Block const& block, Asking const& asking, Ask const& ask) {
  int const dims = forest.dimensions();
  grid::Leaf const own = grid::leaf_at(block);
  bool const finer = asking.level > block.level;
  asking.reach.for_each([&](Index3 const& part) {
    std::optional<grid::Leaf> next = own;
    for (int d = 0; d < dims && next; ++d) {
      int const offset = part[d] < 0 ? -1 : part[d] / 2;
      if (offset != 0) next = forest.across(*next, 2 * d + (offset > 0 ? 1 : 0));
    }
    if (!next) return;
    if (finer) {
      ++next->level;
      for (int d = 0; d < dims; ++d) next->place[d] = 2 * next->place[d] + (part[d] + 2) % 2;
    }
    ask(*next);
  });
}

}  // namespace

LevelBounds Refinement::bounds_of(Gas const& gas, grid::Leaf const& leaf, bool bursting) const {
  LevelBounds bounds;
  grid::CellRange const cells = cells_of(leaf, gas.grid().domain().refined(leaf.level), gas.grid().block_size());
  if (cells.empty()) return bounds;
  auto const take = [&](RefinementRules::Bounds const& of_parts) {
    LevelBounds const found = of_parts(leaf.level, cells);
    bounds.least = std::max(bounds.least, found.least);
    bounds.most = std::min(bounds.most, found.most);
  };
  if (rules_.bounds) take(rules_.bounds);
  if (bursting) take(rules_.while_bursting);
  return bounds;
}

Refinement::Needs Refinement::needs(Gas const& gas, grid::Forest const& forest) const {
  grid::Grid const& grid = gas.grid();
  auto const count = grid.block_count();
  std::vector<std::array<Asking, 2>> asking(grid.blocks().size());
  std::vector<ShockNorm> shocks(threads());
  parallel_for(count, [&](int b, int thread) {
    if (!grid.blocks()[b].covered && gas.awake(b)) asking[b] = asking_of(gas, grid.blocks()[b], rules_, shocks[thread]);
  });
  Needs needs;
  bool const bursting = is_bursting(gas);
  for (grid::Leaf const& leaf : forest.leaves()) {
    LevelBounds const bounds = bounds_of(gas, leaf, bursting);
    needs.of_leaf.push_back({bounds.least, bounds.least, bounds.most, 0.0});
  }
  needs.places.resize(rules_.most_level + 1);
  for (int b = 0; b < count; ++b) {
    for (Asking const& of : asking[b]) {
      if (of.level < grid.blocks()[b].level) continue;
      for_each_asked(forest, grid.blocks()[b], of, [&](grid::Leaf asked) {
        int const holder = forest.holding(asked);
        if (holder >= 0) {
          Need& need = needs.of_leaf[holder];
          need.level = std::max(need.level, std::min(asked.level, need.most));
          need.norm = std::max(need.norm, of.norm);
        }
        while (needs.places[asked.level].insert(grid::morton(asked.place)).second && asked.level > 0) {
          --asked.level;
          for (int d = 0; d < forest.dimensions(); ++d) asked.place[d] /= 2;
        }
      });
    }
  }
  return needs;
}

bool Refinement::is_bursting(Gas const& gas) const {
  return rules_.while_bursting && (gas.burn.bursting() || std::isfinite(gas.burn.next_burst()));
}

namespace {

/// Cells of the blocks of a forest.
double cells_of(grid::Forest const& forest, double cells_per_leaf) {
  double cells = 0.0;
  double const coarse = std::ldexp(cells_per_leaf, -forest.dimensions());
  for (std::size_t n = 0; n < forest.leaves().size(); ++n)
    cells += forest.is_left_coarse(static_cast<int>(n)) ? coarse : cells_per_leaf;
  return cells;
}

}  // namespace

void Refinement::keep_within_limit(grid::Forest const& forest, Needs const& asked, double cells_per_leaf,
                                   double allowed, std::vector<Need>& needs) {
  if (!(rules_.most_cells > 0.0)) return;
  std::vector<grid::Leaf> const& leaves = forest.leaves();
  double const more = cells_per_leaf - std::ldexp(cells_per_leaf, -forest.dimensions());  // of one finer block
  double cells = cells_of(forest, cells_per_leaf);
  auto const finer_blocks = [&](std::size_t n) {
    if (needs[n].least > leaves[n].level) return std::ldexp(1.0, forest.dimensions());
    double blocks = 0.0;
    for_each_cell(grid::fine_cells(leaves[n].place, forest.dimensions()), [&](Index3 const& place) {
      blocks += asked.places[leaves[n].level + 1].contains(grid::morton(place)) ? 1.0 : 0.0;
    });
    return blocks;
  };
  // What a leaf adds that gets what it needs.
  auto const growth = [&](std::size_t n) {
    if (needs[n].level <= forest.level_of_cells(static_cast<int>(n))) return 0.0;
    return forest.is_left_coarse(static_cast<int>(n)) ? more : more * finer_blocks(n);
  };
  std::vector<std::size_t> giving;  // those that may give way
  for (std::size_t n = 0; n < leaves.size(); ++n) {
    cells += growth(n);
    if (needs[n].level > needs[n].least && needs[n].level >= leaves[n].level) giving.push_back(n);
  }
  std::stable_sort(giving.begin(), giving.end(),
                   [&](std::size_t a, std::size_t b) { return needs[a].norm < needs[b].norm; });
  for (std::size_t const n : giving) {
    if (cells <= allowed) return;
    held_back_ = true;
    // Not refined, or else left coarse.
    double const less = growth(n);
    int const level = forest.level_of_cells(static_cast<int>(n));
    cells -= less > 0.0 ? less : more;
    needs[n].level = std::max(needs[n].least, less > 0.0 ? level : level - 1);
  }
}

bool Refinement::adapt(Gas const& gas, grid::Forest& forest) {
  std::vector<grid::Leaf> const& leaves = forest.leaves();
  unneeded_.resize(leaves.size(), 0);
  Needs const asked = needs(gas, forest);
  std::vector<Need> const& wanted = asked.of_leaf;
  Index3 const& size = gas.grid().block_size();
  double const cells_per_leaf = static_cast<double>(size[0]) * size[1] * size[2];
  std::vector<int> unneeded;
  std::vector<grid::Origin> origins;
  grid::Forest changed = forest;
  bool const bursting = is_bursting(gas);
  auto const is_wanted = [&](grid::Leaf const& leaf) {
    LevelBounds const bounds = bounds_of(gas, leaf, bursting);
    bool const by_shocks = asked.places[leaf.level].contains(grid::morton(leaf.place)) && bounds.most >= leaf.level;
    return by_shocks || bounds.least >= leaf.level;
  };
  // Balance may refine more than was asked for: then less is allowed.
  constexpr int most_tries = 6;
  double allowed = rules_.most_cells;
  for (int tries = 0; tries < most_tries; ++tries) {
    std::vector<Need> kept = wanted;
    keep_within_limit(forest, asked, cells_per_leaf, allowed, kept);
    unneeded = unneeded_;
    std::vector<std::int8_t> marks(leaves.size(), 0);
    for (std::size_t n = 0; n < leaves.size(); ++n) {
      bool const needed = kept[n].level >= leaves[n].level;
      unneeded[n] = needed ? 0 : unneeded[n] + 1;
      if (kept[n].level > forest.level_of_cells(static_cast<int>(n))) marks[n] = 1;
      // What gives way to others does so at once.
      bool const gives_way = !needed && wanted[n].level >= leaves[n].level;
      if (!needed && (gives_way || unneeded[n] >= rules_.patience)) marks[n] = -1;
    }
    changed = forest;
    origins = changed.adapt(marks, rules_.most_level, is_wanted);
    double const cells = cells_of(changed, cells_per_leaf);
    if (!(rules_.most_cells > 0.0) || cells <= rules_.most_cells) break;
    allowed *= 0.95 * rules_.most_cells / cells;
  }
  bool const differs = changed.leaves() != leaves || changed.left_coarse() != forest.left_coarse();
  unneeded_.assign(origins.size(), 0);
  for (std::size_t n = 0; n < origins.size(); ++n) {
    if (origins[n].count == 1) unneeded_[n] = unneeded[origins[n].first];
  }
  forest = std::move(changed);
  return differs;
}

void Refinement::archive(Archive& a) { a(unneeded_, held_back_); }

}  // namespace brisance::gas
