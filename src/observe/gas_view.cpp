#include "observe/gas_view.hpp"

#include <algorithm>
#include <cmath>

#include "run/system.hpp"

namespace brisance::observe {

namespace {

constexpr double least_part = 0.1;  // of a cell: with less gas than that it counts as solid

/// Number of a cell (domain index), which lies in the region, in the grid of the particles.
std::size_t number_in_particles_grid(bridge::Region const& region, Index3 const& cell) {
  return region.particles_domain().all_cells().offset(region.to_particles(cell));
}

}  // namespace

GasView::GasView(run::System const& system, std::vector<PlacedCell> const& cells) : system_(&system) {
  if (!system.coupled()) return;
  for (run::Region const& of_system : system.regions) {
    bridge::Region const& region = of_system.bridge->region();
    std::vector<int> numbers(static_cast<std::size_t>(region.particles_domain().cell_count()), -1);
    regions_.push_back({&region, std::move(numbers), nullptr, {}});
  }
  std::vector<std::vector<Index3>> prepared(regions_.size());
  for (PlacedCell const& cell : cells) {
    auto const r = region_around(cell, true);
    if (!r) continue;
    int& number = regions_[*r].number[number_in_particles_grid(*regions_[*r].region, cell.index)];
    if (number >= 0) continue;
    number = static_cast<int>(prepared[*r].size());
    prepared[*r].push_back(cell.index);
  }
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    if (prepared[r].empty()) continue;
    bridge::Region const& region = *regions_[r].region;
    regions_[r].averages =
        std::make_unique<bridge::Averages>(region.domain(), *system.regions[r].particles, region.shift(), prepared[r]);
  }
}

void GasView::update() {
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    run::Region const& of_system = system_->regions[r];
    if (regions_[r].averages != nullptr) regions_[r].averages->compute(*of_system.particles, of_system.gas_body());
  }
}

std::optional<std::size_t> GasView::region_around(PlacedCell const& cell, bool beyond_bridge) const {
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    bridge::Region const& region = *regions_[r].region;
    if (region.level() == cell.level && region.layer(cell.index) > (beyond_bridge ? region.width() : 0)) return r;
  }
  return std::nullopt;
}

bool GasView::in_particles(PlacedCell const& cell) const { return region_around(cell, true).has_value(); }

std::optional<gas::Primitive> GasView::at(PlacedCell const& cell) const {
  if (auto const r = region_around(cell, true)) {
    OfRegion const& of = regions_[*r];
    bridge::CellSums const& sums = of.averages->sums()[of.number[number_in_particles_grid(*of.region, cell.index)]];
    if (sums.volume < least_part * of.region->metric().cell_volume(cell.index[0])) return std::nullopt;
    return system_->regions[*r].bridge->primitive(sums);
  }
  grid::Cell const at = system_->grid.locate(cell.level, cell.index).value();
  if (system_->gas->obstacles.contain(at)) return std::nullopt;
  return system_->gas->primitive(at);
}

double GasView::solid_at(PlacedCell const& cell) const {
  auto const r = region_around(cell, false);
  if (!r || regions_[*r].solids.empty()) return 0.0;
  return regions_[*r].solids[number_in_particles_grid(*regions_[*r].region, cell.index)];
}

void GasView::update_solids() {
  for (std::size_t r = 0; r < regions_.size(); ++r) update_solids(r);
}

void GasView::update_solids(std::size_t number) {
  mpm::Mpm const& particles = *system_->regions[number].particles;
  grid::Domain const& domain = regions_[number].region->particles_domain();
  std::vector<double>& solids = regions_[number].solids;
  grid::CellRange const all = domain.all_cells();
  int const dims = domain.dimensions();
  solids.assign(all.count(), 0.0);
  for (int body = 0; body < static_cast<int>(particles.bodies().size()); ++body) {
    if (body == system_->regions[number].gas_body()) continue;
    double const half = 0.5 / particles.bodies()[body].particles_per_direction;  // of the box of a particle [cells]
    for (int block = 0; block < particles.grid().block_count(); ++block) {
      mpm::ParticleSet const& set = particles.particles(block, body);
      for (int q = 0; q < set.size(); ++q) {
        double const volume = set.field(mpm::Field::mass)[q] / set.field(mpm::Field::density)[q];
        // The two cells that the box reaches in each direction; behind a mirror its image comes back.
        std::array<Index3, 2> cells{};
        std::array<std::array<double, 3>, 2> parts{{{1.0, 1.0, 1.0}, {0.0, 0.0, 0.0}}};
        for (int d = 0; d < dims; ++d) {
          double const x = domain.in_cells(d, set.field(mpm::Field::position_x + d)[q]);
          double const face = std::floor(x + half);
          double const above = std::clamp((x + half - face) / (2.0 * half), 0.0, 1.0);
          for (int side = 0; side < 2; ++side) {
            int const cell = static_cast<int>(face) - 1 + side;
            cells[side][d] = std::clamp(cell, 0, domain.cells[d] - 1);
            parts[side][d] = side == 0 ? 1.0 - above : above;
          }
        }
        for (int corner = 0; corner < 1 << dims; ++corner) {
          double fraction = 1.0;
          Index3 cell{0, 0, 0};
          for (int d = dims - 1; d >= 0; --d) {
            int const side = corner >> d & 1;
            fraction *= parts[side][d];
            cell[d] = cells[side][d];
          }
          solids[all.offset(cell)] += fraction * volume;
        }
      }
    }
  }
  for_each_cell(all, [&](Index3 const& cell) {
    double& solid = solids[all.offset(cell)];
    solid = std::min(1.0, solid / domain.cell_volume(cell[0]));
  });
}

}  // namespace brisance::observe
