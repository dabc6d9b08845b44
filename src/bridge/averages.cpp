#include "bridge/averages.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/lanes.hpp"
#include "core/parallel.hpp"

namespace brisance::bridge {

using mpm::Field;

namespace {

/// Where the weight of a cell falls in one direction: its own index, and those of its images that particles near a
/// mirror or a periodic face can reach.
struct Image {
  int index;
  bool flip;
};

void add_four(double* to, Lanes4 const& four) { *reinterpret_cast<LooseLanes4*>(to) += four; }

std::vector<Image> images(grid::Domain const& particles, int d, int i) {
  std::vector<Image> result{{i, false}};
  int const n = particles.cells[d];
  if (i == 0 && particles.is_mirror(2 * d)) result.push_back({-1, true});
  if (i == n - 1 && particles.is_mirror(2 * d + 1)) result.push_back({n, true});
  if (particles.boundary[2 * d] == grid::Boundary::periodic) {
    if (i == 0) result.push_back({n, false});
    if (i == n - 1) result.push_back({-1, false});
  }
  return result;
}

}  // namespace

Averages::Averages(grid::Domain const& domain, mpm::Mpm const& particles, Index3 const& shift,
                   std::vector<Index3> const& cells)
    : domain_(particles.grid().domain()), dims_(domain.dimensions()), sums_(cells.size()) {
  grid::Grid const& grid = particles.grid();
  std::map<int, int> slot_of;
  // Blocks whose padded box holds the cell or an image of it: those of the cells around.
  auto const part_of = [&](int block) -> int {
    auto const [found, fresh] = slot_of.try_emplace(block, static_cast<int>(parts_.size()));
    if (fresh) {
      BlockPart part;
      part.block = block;
      part.box = grid.blocks()[block].in_domain().grown(1, dims_);
      part.wanted.assign(part.box.count(), 0);
      parts_.push_back(std::move(part));
    }
    return found->second;
  };
  for (Index3 const& cell : cells) {
    first_.push_back(sources_.size());
    std::array<std::vector<Image>, 3> choice;
    for (int d = 0; d < 3; ++d) {
      choice[d] = d < dims_ ? images(domain_, d, cell[d] + shift[d]) : std::vector<Image>{{0, false}};
    }
    std::vector<int> seen;
    for (Image const& z : choice[2]) {
      for (Image const& y : choice[1]) {
        for (Image const& x : choice[0]) {
          Index3 const image{x.index, y.index, z.index};
          auto const flip = static_cast<std::uint8_t>((x.flip ? 1 : 0) | (y.flip ? 2 : 0) | (z.flip ? 4 : 0));
          // All blocks that hold cells next to the image.
          grid::CellRange const near = grid::around(image, 1, dims_);
          std::vector<int> blocks;
          for_each_cell(near, [&](Index3 const& there) {
            if (domain_.contains(there)) blocks.push_back(grid.block_of(there));
          });
          std::sort(blocks.begin(), blocks.end());
          blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
          for (int const block : blocks) {
            int const slot = part_of(block);
            BlockPart& part = parts_[slot];
            sources_.push_back({slot, static_cast<int>(part.box.offset(image)), flip});
            for_each_cell(near, [&](Index3 const& there) {
              if (part.box.contains(there)) part.wanted[part.box.offset(there)] = 1;
            });
          }
        }
      }
    }
  }
  first_.push_back(sources_.size());
  for (BlockPart& part : parts_) part.values.assign(part.wanted.size() * values, 0.0);
}

void Averages::add_particles(mpm::Mpm const& particles, int body, BlockPart& part) const {
  std::fill(part.values.begin(), part.values.end(), 0.0);
  mpm::ParticleSet const& set = particles.particles(part.block, body);
  grid::Block const& block = particles.grid().blocks()[part.block];
  grid::CellRange const cells = block.in_domain();
  double const inverse_h = 1.0 / block.h();
  Index3 span{1, 1, 1};
  for (int d = 0; d < dims_; ++d) span[d] = 3;
  double const* const mass = set.field(Field::mass);
  double const* const density = set.field(Field::density);
  double const* const energy = set.field(Field::energy);
  double const* const mass_fraction = set.field(Field::mass_fraction);
  double const* const volume_fraction = set.field(Field::volume_fraction);
  std::array<double const*, 3> position{};
  std::array<double const*, 3> velocity{};
  for (int d = 0; d < 3; ++d) {
    position[d] = set.field(Field::position_x + d);
    velocity[d] = set.field(Field::velocity_x + d);
  }
  for (int q = 0; q < set.size(); ++q) {
    std::array<std::array<double, 3>, 3> w{{{1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}};
    Index3 own = cells.lower;
    Index3 low = cells.lower;
    for (int d = 0; d < dims_; ++d) {
      double const u = (position[d][q] - domain_.lower[d]) * inverse_h - static_cast<double>(cells.lower[d]);
      int const i = std::clamp(static_cast<int>(u), 0, block.n[d] - 1);
      double const t = u - i - 0.5;
      w[d] = {0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)};
      own[d] = cells.lower[d] + i;
      low[d] = own[d] - 1;
    }
    if (part.wanted[part.box.offset(own)] == 0) continue;
    double const m = mass[q];
    double const volume = m / density[q];
    double const other = mass_fraction == nullptr ? 0.0 : m * mass_fraction[q];
    static_assert(most_fluids == 2, "points hold one fluid beside the ambient one");
    static_assert(values == 8);
    Lanes4 const first{volume, volume_fraction == nullptr ? 0.0 : volume * volume_fraction[q], m - other, other};
    Lanes4 const second = m * Lanes4{energy[q], velocity[0][q], velocity[1][q], velocity[2][q]};
    for (int k = 0; k < span[2]; ++k) {
      for (int j = 0; j < span[1]; ++j) {
        double const wyz = w[1][j] * w[2][k];
        double* row = part.values.data() + values * part.box.offset({low[0], low[1] + j, low[2] + k});
        for (int i = 0; i < span[0]; ++i, row += values) {
          double const weight = w[0][i] * wyz;
          add_four(row, weight * first);
          add_four(row + 4, weight * second);
        }
      }
    }
  }
}

void Averages::compute(mpm::Mpm const& particles, int body) {
  parallel_for(static_cast<int>(parts_.size()), [&](int n, int) { add_particles(particles, body, parts_[n]); });
  constexpr int group = 256;
  int const count = static_cast<int>(sums_.size());
  parallel_for((count + group - 1) / group, [&](int g, int) {
    for (int n = g * group; n < std::min(count, (g + 1) * group); ++n) {
      std::array<double, values> sum{};
      for (std::size_t s = first_[n]; s < first_[n + 1]; ++s) {
        Source const& source = sources_[s];
        double const* value = parts_[source.slot].values.data() + static_cast<std::size_t>(values) * source.offset;
        for (int v = 0; v < values; ++v) {
          bool const turned = v >= first_momentum && ((source.flip >> (v - first_momentum)) & 1) != 0;
          sum[v] += turned ? -value[v] : value[v];
        }
      }
      CellSums& s = sums_[n];
      s.volume = sum[0];
      for (int k = 1; k < most_fluids; ++k) s.fluid_volume[k] = sum[k];
      for (int k = 0; k < most_fluids; ++k) s.mass[k] = sum[first_mass + k];
      s.energy = sum[first_momentum - 1];
      for (int d = 0; d < 3; ++d) s.momentum[d] = sum[first_momentum + d];
    }
  });
}

}  // namespace brisance::bridge
