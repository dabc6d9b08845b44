#include "bridge/cell_states.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "core/archive.hpp"
#include "core/parallel.hpp"

namespace brisance::bridge {

namespace {

/// Monotonised central difference, beta = 2 [VanLeer77].
double limited(double below, double above) {
  if (below * above <= 0.0) return 0.0;
  double const least = std::min({2.0 * std::abs(below), 2.0 * std::abs(above), 0.5 * std::abs(below + above)});
  return std::copysign(least, below);
}

/// Sum of the states with weights, member by member, but for what follows from the rest.
Primitive blended(Primitive const& a, Primitive const& b, Primitive const& c, std::array<double, 3> const& w) {
  auto const mix = [&w](double x, double y, double z) { return w[0] * x + w[1] * y + w[2] * z; };
  Primitive s;
  s.density = mix(a.density, b.density, c.density);
  for (int d = 0; d < 3; ++d) s.velocity[d] = mix(a.velocity[d], b.velocity[d], c.velocity[d]);
  s.pressure = mix(a.pressure, b.pressure, c.pressure);
  for (int k = 1; k < most_fluids; ++k) {
    s.mass_fraction.set(k, mix(a.mass_fraction[k], b.mass_fraction[k], c.mass_fraction[k]));
    s.volume_fraction.set(k, mix(a.volume_fraction[k], b.volume_fraction[k], c.volume_fraction[k]));
  }
  return s;
}

constexpr double steep = 0.1;  ///< relative change between two times that is too large for a parabola

}  // namespace

Primitive at_offset(Primitive const& centre, GasSlopes const& slopes, Vec3 const& offset) {
  Primitive s = centre;
  for (int d = 0; d < 3; ++d) {
    s.density += offset[d] * slopes.density[d];
    s.pressure += offset[d] * slopes.pressure[d];
    for (int c = 0; c < 3; ++c) s.velocity[c] += offset[d] * slopes.velocity[d][c];
  }
  return s;
}

void CellStates::follow_blocks(grid::Grid const& grid) {
  places_.clear();
  for (Index3 const& cell : cells_) places_.push_back(grid.locate(level_, cell).value());
}

CellStates::CellStates(grid::Grid const& grid, Region const& region, std::vector<Index3> const& cells)
    : level_(region.level()), dims_(grid.domain().dimensions()) {
  grid::Domain const& domain = region.domain();
  grid::CellRange const all = domain.all_cells();
  std::unordered_map<std::size_t, int> index_of;
  auto const add = [&](Index3 const& cell) {
    auto const [found, fresh] = index_of.try_emplace(all.offset(cell), static_cast<int>(cells_.size()));
    if (fresh) cells_.push_back(cell);
    return found->second;
  };
  for (Index3 const& cell : cells) add(cell);
  neighbours_.reserve(cells.size());
  for (Index3 const& cell : cells) {
    std::array<Neighbour, 6> around{};
    for (int d = 0; d < dims_; ++d) {
      for (int side = 0; side < 2; ++side) {
        Index3 const there = grid::beside(cell, d, side);
        Neighbour neighbour;
        neighbour.mirror = !domain.contains(there) && domain.is_mirror(2 * d + side);
        neighbour.index = add(grid::image_cell(domain, there));
        around[2 * d + side] = neighbour;
      }
    }
    neighbours_.push_back(around);
  }
  follow_blocks(grid);
  before_.resize(places_.size());
  earlier_.resize(places_.size());
  later_.resize(places_.size());
  smooth_.resize(places_.size());
}

void CellStates::read(gas::Gas const& gas) {
  if (levels_ == 0 || gas.time() > times_[2]) {
    before_.swap(earlier_);
    earlier_.swap(later_);
    times_ = {times_[1], times_[2], gas.time()};
    levels_ = std::min(levels_ + 1, 3);
  }
  constexpr int group = 256;
  int const count = static_cast<int>(places_.size());
  signals_.resize((count + group - 1) / group);
  parallel_for((count + group - 1) / group, [&](int g, int) {
    double fastest = 0.0;
    for (int n = g * group; n < std::min(count, (g + 1) * group); ++n) {
      Primitive const& w = later_[n] = gas.primitive(places_[n]);
      fastest = std::max(fastest, norm(w.velocity) + w.sound_speed);
    }
    signals_[g] = fastest;
  });
  find_smooth();
}

void CellStates::find_smooth() {
  smooth_.assign(places_.size(), 0);
  for (std::size_t n = 0; levels_ == 3 && n < places_.size(); ++n) {
    bool const jumps = is_jump(before_[n], earlier_[n], steep) || is_jump(earlier_[n], later_[n], steep);
    smooth_[n] = jumps ? 0 : 1;
  }
}

double CellStates::fastest_signal() const {
  double fastest = 0.0;
  for (double const signal : signals_) fastest = std::max(fastest, signal);
  return fastest;
}

CellStates::TimeWeights CellStates::time_weights(double fraction) const {
  // Lagrange's weights for the three times, in units of the last step.
  double const back = levels_ < 3 ? 1.0 : (times_[1] - times_[0]) / (times_[2] - times_[1]);
  return {{fraction * (fraction - 1.0) / (back * (back + 1.0)), (fraction + back) * (1.0 - fraction) / back,
           fraction * (fraction + back) / (1.0 + back)},
          {0.0, 1.0 - fraction, fraction}};
}

Primitive CellStates::value(int index, TimeWeights const& weights) const {
  return blended(before_[index], earlier_[index], later_[index], weights_of(index, weights));
}

Vec3 CellStates::velocity(int index, TimeWeights const& weights) const {
  auto const& w = weights_of(index, weights);
  Vec3 v{0.0, 0.0, 0.0};
  for (int d = 0; d < 3; ++d) {
    v[d] = w[0] * before_[index].velocity[d] + w[1] * earlier_[index].velocity[d] + w[2] * later_[index].velocity[d];
  }
  return v;
}

void CellStates::at(int n, double fraction, Primitive& state, GasSlopes& slopes) const {
  TimeWeights const weights = time_weights(fraction);
  state = value(n, weights);
  slopes = {};
  for (int d = 0; d < dims_; ++d) {
    std::array<Primitive, 2> next{state, state};
    for (int side = 0; side < 2; ++side) {
      Neighbour const& neighbour = neighbours_[n][2 * d + side];
      next[side] = value(neighbour.index, weights);
      if (neighbour.mirror) next[side].velocity[d] *= -1.0;
    }
    slopes.density[d] = limited(state.density - next[0].density, next[1].density - state.density);
    slopes.pressure[d] = limited(state.pressure - next[0].pressure, next[1].pressure - state.pressure);
    for (int c = 0; c < 3; ++c) {
      slopes.velocity[d][c] = limited(state.velocity[c] - next[0].velocity[c], next[1].velocity[c] - state.velocity[c]);
    }
  }
}

void CellStates::velocity_at(int n, double fraction, Vec3& at_centre, std::array<Vec3, 3>& slopes) const {
  TimeWeights const weights = time_weights(fraction);
  at_centre = velocity(n, weights);
  slopes = {};
  for (int d = 0; d < dims_; ++d) {
    std::array<Vec3, 2> next{};
    for (int side = 0; side < 2; ++side) {
      Neighbour const& neighbour = neighbours_[n][2 * d + side];
      next[side] = velocity(neighbour.index, weights);
      if (neighbour.mirror) next[side][d] *= -1.0;
    }
    for (int c = 0; c < 3; ++c) slopes[d][c] = limited(at_centre[c] - next[0][c], next[1][c] - at_centre[c]);
  }
}

void CellStates::archive(Archive& a) {
  a.same(places_.size(), "the number of cells next to the MPM region");
  a(levels_, times_);
  a.require(levels_ >= 0 && levels_ <= static_cast<int>(times_.size()), "the number of times next to the MPM region");
  for (auto* states : {&earlier_, &later_}) {
    for (Primitive& s : *states) a(s.density, s.velocity, s.pressure, s.mass_fraction, s.volume_fraction);
  }
}

}  // namespace brisance::bridge
