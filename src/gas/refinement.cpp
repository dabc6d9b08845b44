#include "gas/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/archive.hpp"
#include "core/parallel.hpp"
#include "gas/gas.hpp"
#include "gas/shock_norm.hpp"
#include "grid/fine_cells.hpp"

namespace brisance::gas {

namespace {

/// Blocks around a block that cells which ask reach with the buffer: bits by the offset in {-1, 0, 1}^3.
struct Reach {
  std::array<bool, 27> around{};
  [[nodiscard]] static int number(Index3 const& offset) {
    return offset[0] + 1 + 3 * (offset[1] + 1) + 9 * (offset[2] + 1);
  }
};

Reach reach_of(grid::Block const& block, std::vector<std::uint8_t> const& asks, int buffer) {
  constexpr int beside = 2;  // cells that every shock needs around: it is as thick
  Reach reach;
  int const dims = block.metric.dimensions();
  for_each_cell(block, [&](grid::Cell const& cell) {
    std::uint8_t const how = asks[cell.offset];
    if (how == 0) return;
    Index3 least{0, 0, 0};
    Index3 most{0, 0, 0};
    Index3 const within = cell.within();
    for (int d = 0; d < dims; ++d) {
      auto const cells = [&](int side) { return (how & asks_towards(2 * d + side)) != 0 ? buffer : beside; };
      if (within[d] < cells(0)) least[d] = -1;
      if (within[d] >= block.n[d] - cells(1)) most[d] = 1;
    }
    for_each_cell(grid::CellRange{least, {most[0] + 1, most[1] + 1, most[2] + 1}},
                  [&](Index3 const& offset) { reach.around[Reach::number(offset)] = true; });
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
  for (int level = 0; level < most_level; ++level) {
    grid::Domain const fine = domain.refined(level);
    std::vector<std::int8_t> marks;
    for (grid::Leaf const& leaf : forest.leaves()) {
      grid::CellRange const cells =
          leaf.level == level ? cells_of(leaf, fine, size) : grid::CellRange{{0, 0, 0}, {0, 0, 0}};
      marks.push_back(!cells.empty() && bounds(level, cells).least > level ? 1 : 0);
    }
    forest.adapt(marks, most_level);
  }
}

namespace {

/// The block of a leaf; `no_neighbour`: it lies outside the domain.
int block_of(grid::Grid const& grid, grid::Leaf const& leaf) {
  grid::Domain const& domain = grid.domain(leaf.level);
  grid::CellRange const cells = cells_of(leaf, domain, grid.block_size());
  return cells.empty() ? grid::no_neighbour : grid.block_of(leaf.level, cells.lower);
}

/// What cells of a leaf ask for: a level, how strongly, and in which blocks around.
struct Asking {
  int level = 0;
  double norm = 0.0;
  Reach reach;
};

/// Shocks in the block of a leaf, and the surface of the products.
std::array<Asking, 2> asking_of(Gas const& gas, grid::Block const& block, RefinementRules const& rules,
                                ShockNorm& shocks) {
  std::array<Asking, 2> asking;
  std::vector<std::uint8_t> asks;
  double const norm = shocks.find(gas, block, rules, asks);
  if (norm >= rules.threshold) asking[0] = {rules.shock_level, norm, reach_of(block, asks, rules.buffer)};
  if (rules.products_level < 0 || !gas.fluids().mixed()) return asking;
  asks.assign(asks.size(), 0);
  double const difference = mark_products_surface(gas, block, asks);
  if (difference > 0.0) asking[1] = {rules.products_level, difference, reach_of(block, asks, rules.buffer)};
  return asking;
}

/// Calls ask(number of a leaf, level) for the leaves around one that its cells ask for.
template <class Ask>
void for_each_asked(grid::Forest const& forest, grid::Leaf const& leaf, Asking const& asking, Ask const& ask) {
  int const level = std::min(leaf.level + 1, asking.level);
  for (int at = 0; at < 27; ++at) {
    if (!asking.reach.around[at]) continue;
    std::optional<grid::Leaf> next = leaf;
    std::array<int, 3> const offset{at % 3 - 1, at / 3 % 3 - 1, at / 9 - 1};
    for (int d = 0; d < 3 && next; ++d) {
      if (offset[d] != 0) next = forest.across(*next, 2 * d + (offset[d] > 0 ? 1 : 0));
    }
    if (!next) continue;
    if (int const holder = forest.holding(*next); holder >= 0) {
      ask(holder, level);
      continue;
    }
    // There are finer ones: those stay.
    for_each_cell(grid::fine_cells(next->place, forest.dimensions()), [&](Index3 const& place) {
      int const finer = forest.find({next->level + 1, place});
      if (finer >= 0) ask(finer, level);
    });
  }
}

}  // namespace

std::vector<Refinement::Need> Refinement::needs(Gas const& gas, grid::Forest const& forest) const {
  grid::Grid const& grid = gas.grid();
  std::vector<grid::Leaf> const& leaves = forest.leaves();
  auto const count = static_cast<int>(leaves.size());
  std::vector<std::array<Asking, 2>> asking(leaves.size());
  std::vector<ShockNorm> shocks(threads());
  parallel_for(count, [&](int n, int thread) {
    int const b = block_of(grid, leaves[n]);
    if (b != grid::no_neighbour && gas.awake(b)) asking[n] = asking_of(gas, grid.blocks()[b], rules_, shocks[thread]);
  });
  bool const bursting = rules_.while_bursting && (gas.burn.bursting() || std::isfinite(gas.burn.next_burst()));
  std::vector<Need> needs(leaves.size());
  for (int n = 0; n < count; ++n) {
    grid::CellRange const cells = cells_of(leaves[n], grid.domain(leaves[n].level), grid.block_size());
    if (cells.empty()) continue;
    auto const take = [&](RefinementRules::Bounds const& bounds) {
      LevelBounds const found = bounds(leaves[n].level, cells);
      needs[n].least = std::max(needs[n].least, found.least);
      needs[n].most = std::min(needs[n].most, found.most);
    };
    if (rules_.bounds) take(rules_.bounds);
    if (bursting) take(rules_.while_bursting);
    needs[n].level = needs[n].least;
  }
  for (int n = 0; n < count; ++n) {
    for (Asking const& of : asking[n]) {
      for_each_asked(forest, leaves[n], of, [&](int asked, int level) {
        needs[asked].level = std::max(needs[asked].level, std::min(level, needs[asked].most));
        needs[asked].norm = std::max(needs[asked].norm, of.norm);
      });
    }
  }
  return needs;
}

void Refinement::keep_within_limit(grid::Forest const& forest, double cells_per_leaf, double allowed,
                                   std::vector<Need>& needs) {
  if (!(rules_.most_cells > 0.0)) return;
  std::vector<grid::Leaf> const& leaves = forest.leaves();
  double const more = cells_per_leaf * ((1 << forest.dimensions()) - 1);
  double cells = cells_per_leaf * static_cast<double>(leaves.size());
  std::vector<std::size_t> giving;  // those that may give way
  for (std::size_t n = 0; n < leaves.size(); ++n) {
    if (needs[n].level > leaves[n].level) cells += more;
    if (needs[n].level > needs[n].least && needs[n].level >= leaves[n].level) giving.push_back(n);
  }
  std::stable_sort(giving.begin(), giving.end(),
                   [&](std::size_t a, std::size_t b) { return needs[a].norm < needs[b].norm; });
  for (std::size_t const n : giving) {
    if (cells <= allowed) return;
    held_back_ = true;
    // Not refined, or else merged, where its family goes with it.
    bool const refined = needs[n].level > leaves[n].level;
    cells -= refined ? more : more / (1 << forest.dimensions());
    needs[n].level = std::max(needs[n].least, refined ? leaves[n].level : leaves[n].level - 1);
  }
}

bool Refinement::adapt(Gas const& gas, grid::Forest& forest) {
  std::vector<grid::Leaf> const& leaves = forest.leaves();
  unneeded_.resize(leaves.size(), 0);
  std::vector<Need> const wanted = needs(gas, forest);
  Index3 const& size = gas.grid().block_size();
  double const cells_per_leaf = static_cast<double>(size[0]) * size[1] * size[2];
  std::vector<int> unneeded;
  std::vector<grid::Origin> origins;
  grid::Forest changed = forest;
  // Balance may refine more than was asked for, and families stay where one of them is needed: then less is allowed.
  constexpr int most_tries = 6;
  double allowed = rules_.most_cells;
  for (int tries = 0; tries < most_tries; ++tries) {
    std::vector<Need> kept = wanted;
    keep_within_limit(forest, cells_per_leaf, allowed, kept);
    unneeded = unneeded_;
    std::vector<std::int8_t> marks(leaves.size(), 0);
    for (std::size_t n = 0; n < leaves.size(); ++n) {
      bool const needed = kept[n].level >= leaves[n].level;
      unneeded[n] = needed ? 0 : unneeded[n] + 1;
      if (kept[n].level > leaves[n].level) marks[n] = 1;
      // What gives way to others does so at once.
      bool const gives_way = !needed && wanted[n].level >= leaves[n].level;
      if (!needed && (gives_way || unneeded[n] >= rules_.patience)) marks[n] = -1;
    }
    changed = forest;
    origins = changed.adapt(marks, rules_.most_level);
    double const cells = cells_per_leaf * static_cast<double>(changed.leaves().size());
    if (!(rules_.most_cells > 0.0) || cells <= rules_.most_cells) break;
    allowed *= 0.95 * rules_.most_cells / cells;
  }
  bool const differs = origins.size() != leaves.size() ||
                       std::any_of(origins.begin(), origins.end(), [](grid::Origin const& o) { return o.count != 1; });
  unneeded_.assign(origins.size(), 0);
  for (std::size_t n = 0; n < origins.size(); ++n) {
    if (origins[n].count == 1) unneeded_[n] = unneeded[origins[n].first];
  }
  forest = std::move(changed);
  return differs;
}

void Refinement::archive(Archive& a) { a(unneeded_, held_back_); }

}  // namespace brisance::gas
