#include "bridge/ghosts.hpp"

#include <algorithm>

#include "core/parallel.hpp"

namespace brisance::bridge {

namespace {

constexpr int group = 64;  // cells that a thread takes at a time

/// From a mean over particles with the weight of a quadratic B-spline (second moment h^2/4) to one over the cell
/// (h^2/12): f - (1/4 - 1/12)/2 h^2 f''. Not across jumps, where there is no f''.
constexpr double sharpening = 1.0 / 12.0;
constexpr double steep = 0.2;  ///< relative difference of pressure or density that counts as a jump

}  // namespace

Ghosts::Ghosts(gas::Gas& gas, Region const& region, SharedGas const& shared)
    : gas_(&gas), region_(&region), shared_(&shared) {
  for (Index3 const& cell : region.ghosts()) {
    std::array<int, 6> neighbours{-1, -1, -1, -1, -1, -1};
    for (int d = 0; d < region.domain().dimensions(); ++d) {
      for (int side = 0; side < 2; ++side) {
        neighbours[2 * d + side] = shared.average_of(grid::beside(cell, d, side));
      }
    }
    neighbours_.push_back(neighbours);
  }
  follow_blocks();
}

void Ghosts::follow_blocks() {
  blocks_.clear();
  for (Index3 const& cell : region_->ghosts()) blocks_.push_back(region_->locate(gas_->grid(), cell).block);
  std::sort(blocks_.begin(), blocks_.end());
  blocks_.erase(std::unique(blocks_.begin(), blocks_.end()), blocks_.end());
}

/// The velocity of particles stands half a step of theirs behind their stress (Eqs. (22)-(25) are a leapfrog): the
/// ghost cells take it forward with the gradient of the pressure. Without that, gas and particles would see each
/// other's waves out of step by half a step, and reflect them.
void Ghosts::fill_cell(int n, double last_step) {
  auto const& sums = shared_->sums();
  material::Fluids const& fluids = gas_->fluids();
  Index3 const& cell = region_->ghosts()[n];
  grid::Metric const& cells = region_->metric();
  double const enough = 0.1 * cells.cell_volume(cell[0]);
  // Next to solids a ghost cell of the ghost cells may hold hardly any gas: it keeps what it has.
  if (sums[n].volume < enough) return;
  Primitive const own = primitive(fluids, sums[n]);
  Primitive s = own;
  for (int d = 0; d < cells.dimensions(); ++d) {
    int const low = neighbours_[n][2 * d];
    int const high = neighbours_[n][2 * d + 1];
    if (low < 0 || high < 0 || sums[low].volume < enough || sums[high].volume < enough) continue;
    Primitive const below = primitive(fluids, sums[low]);
    Primitive const above = primitive(fluids, sums[high]);
    if (is_jump(own, below, steep) || is_jump(own, above, steep)) continue;
    auto const bend = [](double a, double b, double c) { return a - 2.0 * b + c; };
    s.density -= sharpening * bend(below.density, own.density, above.density);
    s.pressure -= sharpening * bend(below.pressure, own.pressure, above.pressure);
    for (int c = 0; c < 3; ++c) {
      s.velocity[c] -= sharpening * bend(below.velocity[c], own.velocity[c], above.velocity[c]);
    }
    s.velocity[d] -= 0.5 * last_step * (above.pressure - below.pressure) / (2.0 * cells.h * own.density);
  }
  Amounts per_volume;
  per_volume.mass[0] = s.density;
  for (int k = 1; k < most_fluids; ++k) {
    per_volume.mass[k] = s.density * s.mass_fraction[k];
    per_volume.mass[0] -= per_volume.mass[k];
  }
  per_volume.momentum = s.density * s.velocity;
  per_volume.energy = s.density * (specific_energy(fluids, s) + 0.5 * dot(s.velocity, s.velocity));
  gas_->set(region_->locate(gas_->grid(), cell), per_volume, s.volume_fraction);
}

void Ghosts::fill(double last_step) {
  int const count = static_cast<int>(region_->ghosts().size());
  parallel_for((count + group - 1) / group, [&](int g, int) {
    for (int n = g * group; n < std::min(count, (g + 1) * group); ++n) fill_cell(n, last_step);
  });
  for (int const block : blocks_) gas_->wake(block);
}

}  // namespace brisance::bridge
