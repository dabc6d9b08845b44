#include "gas/shock_norm.hpp"

#include <algorithm>
#include <cmath>

#include "core/loops.hpp"
#include "gas/gas.hpp"
#include "gas/prolongation.hpp"
#include "gas/refinement.hpp"

namespace brisance::gas {

namespace {

/// A shock crosses a block on a surface: fewer cells than this part of the block's smallest cross-section are a pocket,
/// of which corners and edges in a flow make many.
constexpr int pocket = 8;

int least_cells(grid::Block const& block) {
  std::size_t smallest = block.interior().count();
  for (int d = 0; d < block.metric.dimensions(); ++d) {
    grid::CellRange layer = block.interior();
    layer.upper[d] = 1;
    smallest = std::min(smallest, layer.count());
  }
  return std::max(1, static_cast<int>(smallest) / pocket);
}

/// Velocity and pressure of a single ideal gas.
void take_ideal(std::array<double const*, 5> const& u, double gamma, int count, std::array<double*, 4> const& to) {
  double const factor = gamma - 1.0;
  BRISANCE_VECTOR_LOOP
  for (int n = 0; n < count; ++n) {
    double const inverse = 1.0 / u[4][n];
    double const square = u[0][n] * u[0][n] + u[1][n] * u[1][n] + u[2][n] * u[2][n];
    to[0][n] = inverse * u[0][n];
    to[1][n] = inverse * u[1][n];
    to[2][n] = inverse * u[2][n];
    to[3][n] = factor * (u[3][n] - 0.5 * inverse * square);
  }
}

}  // namespace

void ShockNorm::take_mixture(Gas const& gas, int block, int at, std::array<double*, 4> const& to) {
  Components u{};
  for (int c = 0; c < gas.fields().components(); ++c) u[c] = gas.fields().at(block, c)[at];
  PhaseState const state = phase_state_of(gas.fluids(), u);
  for (int d = 0; d < 3; ++d) *to[d] = state.velocity[d];
  *to[3] = state.pressure;
}

void ShockNorm::take_row(Gas const& gas, int block, int at, int count, std::size_t to) {
  material::Fluids const& fluids = gas.fluids();
  grid::Fields const& fields = gas.fields();
  std::array<double*, 4> place{};
  for (int v = 0; v < 4; ++v) place[v] = values_[v].data() + to;
  long others = 0;  // cells with more than a trace of another fluid
  for (int k = 1; k < fluids.count; ++k)
    others += count_beyond(fields.at(block, volume_fraction(k)) + at, count, vanishing_fraction);
  auto const* const ideal = std::get_if<material::IdealGas>(&fluids.ambient());
  if (ideal != nullptr) {
    std::array<double const*, 5> u{};
    for (int d = 0; d < 3; ++d) u[d] = fields.at(block, momentum_x + d) + at;
    u[3] = fields.at(block, energy) + at;
    u[4] = fields.at(block, partial_density(0)) + at;
    take_ideal(u, ideal->gamma, count, place);
    if (others == 0) return;
  }
  for (int n = 0; n < count; ++n) {
    bool mixed = ideal == nullptr;
    for (int k = 1; k < fluids.count; ++k)
      mixed = mixed || fields.at(block, volume_fraction(k))[at + n] > vanishing_fraction;
    if (mixed) take_mixture(gas, block, at + n, place);
    for (double*& value : place) ++value;
  }
}

void ShockNorm::take(Gas const& gas, int block, grid::CellRange const& cells, Index3 const& move) {
  grid::Block const& from = gas.grid().blocks()[block];
  for_each_row(cells, [&](Index3 const& first) {
    std::size_t const to = box_.offset({first[0] + move[0], first[1] + move[1], first[2] + move[2]});
    take_row(gas, block, from.cell(first).offset, cells.n(0), to);
  });
}

void ShockNorm::take_surroundings(Gas const& gas, grid::Block const& block) {
  box_ = block.interior().grown(1, block.metric.dimensions());
  for (auto& array : values_) array.resize(box_.count());
  take(gas, block.number, block.interior(), {0, 0, 0});
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
    take(gas, other, layer, move);
  }
}

void ShockNorm::square_row(grid::Block const& block, Index3 const& first, int count, double filter) {
  for (auto* const array : {&above_, &below_, &divergence_}) array->assign(count, 0.0);
  square_.resize(count);
  for (int d = 0; d < block.metric.dimensions(); ++d) {
    // Cells beside a face that nothing is known beyond have no differences across it.
    auto const unknown = [&](int side, int cell) {
      return !known_[2 * d + side] && cell == (side == 0 ? 0 : block.n[d] - 1);
    };
    if (d > 0 && (unknown(0, first[d]) || unknown(1, first[d]))) continue;
    int const begin = d == 0 && !known_[0] ? 1 : 0;
    int const end = d == 0 && !known_[1] ? count - 1 : count;
    std::ptrdiff_t const step = box_.stride(d);
    std::size_t const from = box_.offset(first);
    double const* const p = values_[3].data() + from;
    double const* const u = values_[d].data() + from;
    double* const above = above_.data();
    double* const below = below_.data();
    double* const divergence = divergence_.data();
    BRISANCE_VECTOR_LOOP
    for (int i = begin; i < end; ++i) {
      double const second = p[i + step] - 2.0 * p[i] + p[i - step];
      double const difference = std::abs(p[i + step] - p[i]) + std::abs(p[i] - p[i - step]) +
                                filter * std::abs(p[i + step] + 2.0 * p[i] + p[i - step]);
      above[i] += second * second;
      below[i] += difference * difference;
      divergence[i] += u[i + step] - u[i - step];
    }
  }
  double* const square = square_.data();
  double const* const above = above_.data();
  double const* const below = below_.data();
  double const* const divergence = divergence_.data();
  // Gas at rest with a jump of the pressure is about to make a shock.
  BRISANCE_VECTOR_LOOP
  for (int i = 0; i < count; ++i) {
    bool const counts = divergence[i] <= 0.0 && below[i] > 0.0;
    square[i] = counts ? above[i] / below[i] : 0.0;
  }
}

/// A shock moves to where the pressure is lower.
std::uint8_t ShockNorm::way_of(grid::Block const& block, Index3 const& cell) const {
  constexpr double a_good_part = 0.25;
  double const* const p = values_[3].data() + box_.offset(cell);
  Vec3 rise{0.0, 0.0, 0.0};  // over two cells
  double largest = 0.0;
  int const dims = block.metric.dimensions();
  for (int d = 0; d < dims; ++d) {
    bool const low = cell[d] > 0 || known_[2 * d];
    bool const high = cell[d] + 1 < block.n[d] || known_[2 * d + 1];
    std::ptrdiff_t const step = box_.stride(d);
    if (low && high) rise[d] = p[step] - p[-step];
    largest = std::max(largest, std::abs(rise[d]));
  }
  std::uint8_t how = asking_bit;
  for (int d = 0; d < dims; ++d) {
    if (std::abs(rise[d]) >= a_good_part * largest) how |= asks_towards(2 * d + (rise[d] < 0.0 ? 1 : 0));
  }
  return how;
}

double ShockNorm::find(Gas const& gas, grid::Block const& block, RefinementRules const& rules,
                       std::vector<std::uint8_t>& asks) {
  asks.assign(block.cell_count(), 0);
  take_surroundings(gas, block);
  double largest = 0.0;  // squared
  int asking = 0;
  double const threshold = rules.threshold * rules.threshold;
  grid::CellRange const cells = block.interior();
  for_each_row(cells, [&](Index3 const& first) {
    square_row(block, first, cells.n(0), rules.filter);
    double const most = *std::max_element(square_.begin(), square_.end());
    largest = std::max(largest, most);
    if (most < threshold) return;
    int const to = block.cell(first).offset;
    for (int i = 0; i < cells.n(0); ++i) {
      if (square_[i] < threshold) continue;
      asks[to + i] = way_of(block, {first[0] + i, first[1], first[2]});
      ++asking;
    }
  });
  if (asking == 0 || asking >= least_cells(block)) return std::sqrt(largest);
  asks.assign(block.cell_count(), 0);
  return 0.0;
}

}  // namespace brisance::gas
