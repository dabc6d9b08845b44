#include "gas/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/archive.hpp"
#include "core/loops.hpp"
#include "core/parallel.hpp"
#include "gas/gas.hpp"
#include "gas/prolongation.hpp"
#include "grid/fine_cells.hpp"

namespace brisance::gas {

namespace {

/// Pressure and velocity of a block's cells and of one layer beyond each face, as far as blocks of the same level
/// reach.
class Surroundings {
 public:
  Surroundings(Gas const& gas, grid::Block const& block)
      : gas_(&gas), box_(block.interior().grown(1, block.metric.dimensions())) {
    for (auto& array : values_) array.assign(box_.count(), 0.0);
    take(block.number, block.interior(), {0, 0, 0});
    for (int face = 0; face < 2 * block.metric.dimensions(); ++face) {
      int const other = block.neighbour[face];
      known_[face] = other != grid::no_neighbour;
      if (!known_[face]) continue;
      grid::Block const& beyond = gas.grid().blocks()[other];
      int const d = face / 2;
      grid::CellRange layer = beyond.interior();
      Index3 move{0, 0, 0};
      if (face % 2 == 0) {
        layer.lower[d] = beyond.n[d] - 1;
        move[d] = -beyond.n[d];
      } else {
        layer.upper[d] = 1;
        move[d] = block.n[d];
      }
      take(other, layer, move);
    }
  }
  [[nodiscard]] grid::CellRange const& box() const { return box_; }
  /// Is there a layer beyond a face?
  [[nodiscard]] bool known(int face) const { return known_[face]; }
  [[nodiscard]] double const* pressure() const { return values_[3].data(); }
  [[nodiscard]] double const* velocity(int d) const { return values_[d].data(); }

 private:
  /// Takes cells of a block, each to the place of its index moved by some cells.
  void take(int block, grid::CellRange const& cells, Index3 const& move) {
    grid::Block const& from = gas_->grid().blocks()[block];
    for_each_row(cells, [&](Index3 const& first) {
      std::size_t const to = box_.offset({first[0] + move[0], first[1] + move[1], first[2] + move[2]});
      take_row(block, from.cell(first).offset, cells.n(0), to);
    });
  }
  void take_row(int block, int at, int count, std::size_t to) {
    material::Fluids const& fluids = gas_->fluids();
    grid::Fields const& fields = gas_->fields();
    bool pure = true;
    for (int k = 1; k < fluids.count && pure; ++k)
      pure = all_equal(fields.at(block, volume_fraction(k)) + at, count, 0.0);
    auto const* const ideal = std::get_if<material::IdealGas>(&fluids.ambient());
    if (!pure || ideal == nullptr) {
      for (int n = 0; n < count; ++n) take_mixture(block, at + n, to + n);
      return;
    }
    std::array<double const*, 5> u{};
    for (int d = 0; d < 3; ++d) u[d] = fields.at(block, momentum_x + d) + at;
    u[3] = fields.at(block, energy) + at;
    u[4] = fields.at(block, partial_density(0)) + at;
    double const factor = ideal->gamma - 1.0;
    BRISANCE_VECTOR_LOOP
    for (int n = 0; n < count; ++n) {
      double const inverse = 1.0 / u[4][n];
      double const square = u[0][n] * u[0][n] + u[1][n] * u[1][n] + u[2][n] * u[2][n];
      values_[0][to + n] = inverse * u[0][n];
      values_[1][to + n] = inverse * u[1][n];
      values_[2][to + n] = inverse * u[2][n];
      values_[3][to + n] = factor * (u[3][n] - 0.5 * inverse * square);
    }
  }
  void take_mixture(int block, int at, std::size_t to) {
    Components u{};
    for (int c = 0; c < gas_->fields().components(); ++c) u[c] = gas_->fields().at(block, c)[at];
    PhaseState const state = phase_state_of(gas_->fluids(), u);
    for (int d = 0; d < 3; ++d) values_[d][to] = state.velocity[d];
    values_[3][to] = state.pressure;
  }

  Gas const* gas_;
  grid::CellRange box_;
  std::array<std::vector<double>, 4> values_;  ///< velocity, pressure
  std::array<bool, 6> known_{};
};

/// Blocks around a block that cells which ask reach with the buffer: bits by the offset in {-1, 0, 1}^3.
struct Reach {
  std::array<bool, 27> around{};
  [[nodiscard]] static int number(Index3 const& offset) {
    return offset[0] + 1 + 3 * (offset[1] + 1) + 9 * (offset[2] + 1);
  }
};

/// How a cell asks: that it does, and towards which faces what asks moves.
constexpr std::uint8_t asking_bit = 1;
constexpr std::uint8_t towards(int face) { return static_cast<std::uint8_t>(2U << static_cast<unsigned>(face)); }
constexpr std::uint8_t everywhere = 0x7f;

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
      auto const cells = [&](int side) { return (how & towards(2 * d + side)) != 0 ? buffer : beside; };
      if (within[d] < cells(0)) least[d] = -1;
      if (within[d] >= block.n[d] - cells(1)) most[d] = 1;
    }
    for_each_cell(grid::CellRange{least, {most[0] + 1, most[1] + 1, most[2] + 1}},
                  [&](Index3 const& offset) { reach.around[Reach::number(offset)] = true; });
  });
  return reach;
}

}  // namespace

namespace {

/// Sums over the directions that the norm is made of, cell by cell.
struct NormSums {
  std::vector<double> above, below, divergence;
  std::array<std::vector<double>, 3> rise;  ///< of the pressure along a direction, over two cells [Pa]
  explicit NormSums(int cells) : above(cells, 0.0), below(cells, 0.0), divergence(cells, 0.0) {
    for (auto& along : rise) along.assign(cells, 0.0);
  }

  void add(Surroundings const& around, grid::Block const& block, int d, double filter) {
    grid::CellRange cells = block.interior();
    if (!around.known(2 * d)) ++cells.lower[d];
    if (!around.known(2 * d + 1)) --cells.upper[d];
    std::ptrdiff_t const step = around.box().stride(d);
    for_each_row(cells, [&](Index3 const& first) {
      std::size_t const from = around.box().offset(first);
      double const* const p = around.pressure() + from;
      double const* const u = around.velocity(d) + from;
      int const to = block.cell(first).offset;
      double* const a = above.data() + to;
      double* const b = below.data() + to;
      double* const div = divergence.data() + to;
      double* const along = rise[d].data() + to;
      BRISANCE_VECTOR_LOOP
      for (int i = 0; i < cells.n(0); ++i) {
        double const second = p[i + step] - 2.0 * p[i] + p[i - step];
        double const difference = std::abs(p[i + step] - p[i]) + std::abs(p[i] - p[i - step]) +
                                  filter * std::abs(p[i + step] + 2.0 * p[i] + p[i - step]);
        a[i] += second * second;
        b[i] += difference * difference;
        div[i] += u[i + step] - u[i - step];
        along[i] = p[i + step] - p[i - step];
      }
    });
  }

  /// A shock moves to where the pressure is lower.
  [[nodiscard]] std::uint8_t way_of(int cell) const {
    double largest = 0.0;
    for (auto const& along : rise) largest = std::max(largest, std::abs(along[cell]));
    constexpr double a_good_part = 0.25;
    std::uint8_t how = asking_bit;
    for (int d = 0; d < 3; ++d) {
      double const here = rise[d][cell];
      if (std::abs(here) >= a_good_part * largest) how |= towards(2 * d + (here < 0.0 ? 1 : 0));
    }
    return how;
  }
};

}  // namespace

double shock_norm(Gas const& gas, grid::Block const& block, RefinementRules const& rules,
                  std::vector<std::uint8_t>& asks) {
  int const cells = block.cell_count();
  asks.assign(cells, 0);
  Surroundings const around(gas, block);
  NormSums sums(cells);
  for (int d = 0; d < block.metric.dimensions(); ++d) sums.add(around, block, d, rules.filter);
  double largest = 0.0;  // squared
  double const threshold = rules.threshold * rules.threshold;
  for (int n = 0; n < cells; ++n) {
    // Gas at rest with a jump of the pressure is about to make a shock.
    if (sums.divergence[n] > 0.0 || !(sums.below[n] > 0.0)) continue;
    double const square = sums.above[n] / sums.below[n];
    largest = std::max(largest, square);
    if (square >= threshold) asks[n] = sums.way_of(n);
  }
  return std::sqrt(largest);
}

namespace {

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
      asks[cell.offset] = asks[next.offset] = everywhere;
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
std::array<Asking, 2> asking_of(Gas const& gas, grid::Block const& block, RefinementRules const& rules) {
  std::array<Asking, 2> asking;
  std::vector<std::uint8_t> asks;
  double const norm = shock_norm(gas, block, rules, asks);
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
  parallel_for(count, [&](int n, int) {
    int const b = block_of(grid, leaves[n]);
    if (b != grid::no_neighbour && gas.awake(b)) asking[n] = asking_of(gas, grid.blocks()[b], rules_);
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
