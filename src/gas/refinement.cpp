#include "gas/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.hpp"
#include "gas/gas.hpp"
#include "gas/prolongation.hpp"
#include "grid/fine_cells.hpp"

namespace brisance::gas {

namespace {

/// Pressure and velocity of a block's cells and of one layer around, as far as blocks of the same level reach.
class Surroundings {
 public:
  Surroundings(Gas const& gas, grid::Block const& block)
      : box_(block.interior().grown(1, block.metric.dimensions())), state_(box_.count()), known_(box_.count(), 0) {
    grid::Grid const& grid = gas.grid();
    for_each_cell(block, [&](grid::Cell const& cell) { take(gas, cell, cell.within()); });
    for (int face = 0; face < 2 * block.metric.dimensions(); ++face) {
      int const other = block.neighbour[face];
      if (other == grid::no_neighbour) continue;
      grid::Block const& beyond = grid.blocks()[other];
      int const d = face / 2;
      for_each_face_cell(beyond, d, 1 - face % 2, [&](grid::Cell const& cell) {
        Index3 within = cell.within();
        within[d] = face % 2 == 0 ? -1 : block.n[d];
        take(gas, cell, within);
      });
    }
  }
  [[nodiscard]] PhaseState const* at(Index3 const& within) const {
    std::size_t const place = box_.offset(within);
    return known_[place] != 0 ? &state_[place] : nullptr;
  }

 private:
  void take(Gas const& gas, grid::Cell const& cell, Index3 const& within) {
    Components u{};
    for (int c = 0; c < gas.fields().components(); ++c) u[c] = gas.fields().at(cell.block, c)[cell.offset];
    std::size_t const place = box_.offset(within);
    state_[place] = phase_state_of(gas.fluids(), u);
    known_[place] = 1;
  }

  grid::CellRange box_;
  std::vector<PhaseState> state_;
  std::vector<std::uint8_t> known_;
};

/// Blocks around a block that cells which ask reach with the buffer: bits by the offset in {-1, 0, 1}^3.
struct Reach {
  std::array<bool, 27> around{};
  [[nodiscard]] static int number(Index3 const& offset) {
    return offset[0] + 1 + 3 * (offset[1] + 1) + 9 * (offset[2] + 1);
  }
};

Reach reach_of(grid::Block const& block, std::vector<std::uint8_t> const& asks, int buffer) {
  Reach reach;
  int const dims = block.metric.dimensions();
  for_each_cell(block, [&](grid::Cell const& cell) {
    if (asks[cell.offset] == 0) return;
    Index3 least{0, 0, 0};
    Index3 most{0, 0, 0};
    Index3 const within = cell.within();
    for (int d = 0; d < dims; ++d) {
      if (within[d] < buffer) least[d] = -1;
      if (within[d] >= block.n[d] - buffer) most[d] = 1;
    }
    for_each_cell(grid::CellRange{least, {most[0] + 1, most[1] + 1, most[2] + 1}},
                  [&](Index3 const& offset) { reach.around[Reach::number(offset)] = true; });
  });
  return reach;
}

}  // namespace

double shock_norm(Gas const& gas, grid::Block const& block, RefinementRules const& rules,
                  std::vector<std::uint8_t>& asks) {
  asks.assign(block.cell_count(), 0);
  int const dims = block.metric.dimensions();
  Surroundings const around(gas, block);
  double largest = 0.0;
  for_each_cell(block, [&](grid::Cell const& cell) {
    PhaseState const& own = *around.at(cell.within());
    double above = 0.0;
    double below = 0.0;
    double divergence = 0.0;
    for (int d = 0; d < dims; ++d) {
      PhaseState const* const low = around.at(grid::beside(cell.within(), d, 0));
      PhaseState const* const high = around.at(grid::beside(cell.within(), d, 1));
      if (low == nullptr || high == nullptr) continue;
      double const second = high->pressure - 2.0 * own.pressure + low->pressure;
      double const first = std::abs(high->pressure - own.pressure) + std::abs(own.pressure - low->pressure) +
                           rules.filter * std::abs(high->pressure + 2.0 * own.pressure + low->pressure);
      above += second * second;
      below += first * first;
      divergence += high->velocity[d] - low->velocity[d];
    }
    if (!(divergence < 0.0) || !(below > 0.0)) return;
    double const norm = std::sqrt(above / below);
    largest = std::max(largest, norm);
    if (norm >= rules.threshold) asks[cell.offset] = 1;
  });
  return largest;
}

bool Refinement::adapt(Gas const& gas, grid::Forest& forest) {
  grid::Grid const& grid = gas.grid();
  std::vector<grid::Leaf> const& leaves = forest.leaves();
  auto const count = static_cast<int>(leaves.size());
  unneeded_.resize(leaves.size(), 0);
  auto const block_of = [&](int n) {
    Index3 cell = leaves[n].place;
    for (int d = 0; d < 3; ++d) cell[d] *= grid.block_size()[d];
    return grid.domain(leaves[n].level).contains(cell) ? grid.block_of(leaves[n].level, cell) : grid::no_neighbour;
  };
  std::vector<Reach> reaches(leaves.size());
  parallel_for(count, [&](int n, int) {
    int const b = block_of(n);
    if (b == grid::no_neighbour || !gas.awake(b)) return;
    std::vector<std::uint8_t> asks;
    if (shock_norm(gas, grid.blocks()[b], rules_, asks) >= rules_.threshold)
      reaches[n] = reach_of(grid.blocks()[b], asks, rules_.buffer);
  });
  // The level that each leaf should have.
  std::vector<int> wanted(leaves.size(), 0);
  for (int n = 0; n < count; ++n) {
    int const b = block_of(n);
    if (b == grid::no_neighbour) continue;
    if (rules_.least_level) {
      grid::Block const& block = grid.blocks()[b];
      Vec3 const lower = block.metric.low_corner(block.in_domain().lower);
      Vec3 const upper = block.metric.low_corner(block.in_domain().upper);
      wanted[n] = std::max(wanted[n], std::min(rules_.least_level(lower, upper), rules_.most_level));
    }
    for (int at = 0; at < 27; ++at) {
      if (!reaches[n].around[at]) continue;
      grid::Leaf beside = leaves[n];
      std::optional<grid::Leaf> next = beside;
      std::array<int, 3> const offset{at % 3 - 1, at / 3 % 3 - 1, at / 9 - 1};
      for (int d = 0; d < 3 && next; ++d) {
        if (offset[d] != 0) next = forest.across(*next, 2 * d + (offset[d] > 0 ? 1 : 0));
      }
      if (!next) continue;
      int const level = std::min(leaves[n].level + 1, rules_.most_level);
      int const holder = forest.holding(*next);
      if (holder >= 0) {
        wanted[holder] = std::max(wanted[holder], level);
        continue;
      }
      // There are finer ones: those stay.
      for_each_cell(grid::fine_cells(next->place, grid.domain().dimensions()), [&](Index3 const& place) {
        int const finer = forest.find({next->level + 1, place});
        if (finer >= 0) wanted[finer] = std::max(wanted[finer], level);
      });
    }
  }
  std::vector<std::int8_t> marks(leaves.size(), 0);
  for (int n = 0; n < count; ++n) {
    bool const needed = wanted[n] >= leaves[n].level;
    unneeded_[n] = needed ? 0 : unneeded_[n] + 1;
    if (wanted[n] > leaves[n].level) marks[n] = 1;
    if (!needed && unneeded_[n] >= rules_.patience) marks[n] = -1;
  }
  std::vector<int> const before = unneeded_;
  std::vector<grid::Origin> const origins = forest.adapt(marks, rules_.most_level);
  bool const changed = origins.size() != before.size() ||
                       std::any_of(origins.begin(), origins.end(), [](grid::Origin const& o) { return o.count != 1; });
  unneeded_.assign(origins.size(), 0);
  for (std::size_t n = 0; n < origins.size(); ++n) {
    if (origins[n].count == 1) unneeded_[n] = before[origins[n].first];
  }
  return changed;
}

}  // namespace brisance::gas
