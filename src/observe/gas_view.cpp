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

GasView::GasView(run::System const& system, std::vector<Index3> const& cells) : system_(&system) {
  if (system.bridge == nullptr) return;
  bridge::Region const& region = system.bridge->region();
  number_.assign(static_cast<std::size_t>(region.particles_domain().cell_count()), -1);
  for (Index3 const& cell : cells) {
    if (!in_particles({region.level(), cell})) continue;
    int& number = number_[number_in_particles_grid(region, cell)];
    if (number >= 0) continue;
    number = static_cast<int>(cells_.size());
    cells_.push_back(cell);
  }
  if (cells_.empty()) return;
  averages_ = std::make_unique<bridge::Averages>(region.domain(), *system.particles, region.shift(), cells_);
}

void GasView::update() {
  if (averages_ != nullptr) averages_->compute(*system_->particles, system_->gas_body());
}

bridge::Region const* GasView::region_at(int level) const {
  if (system_->bridge == nullptr) return nullptr;
  bridge::Region const& region = system_->bridge->region();
  return region.level() == level ? &region : nullptr;
}

bool GasView::in_particles(PlacedCell const& cell) const {
  bridge::Region const* const region = region_at(cell.level);
  return region != nullptr && region->layer(cell.index) > region->width();
}

std::optional<gas::Primitive> GasView::at(PlacedCell const& cell) const {
  if (in_particles(cell)) {
    bridge::Region const& region = system_->bridge->region();
    bridge::CellSums const& sums = averages_->sums()[number_[number_in_particles_grid(region, cell.index)]];
    if (sums.volume < least_part * region.metric().cell_volume(cell.index[0])) return std::nullopt;
    return system_->bridge->primitive(sums);
  }
  grid::Cell const at = system_->grid.locate(cell.level, cell.index).value();
  if (system_->gas->obstacles.contain(at)) return std::nullopt;
  return system_->gas->primitive(at);
}

double GasView::solid_at(PlacedCell const& cell) const {
  bridge::Region const* const region = region_at(cell.level);
  if (solids_.empty() || region == nullptr || !region->inside(cell.index)) return 0.0;
  return solids_[number_in_particles_grid(*region, cell.index)];
}

void GasView::update_solids() {
  if (system_->bridge == nullptr) return;
  mpm::Mpm const& particles = *system_->particles;
  grid::Domain const& domain = system_->bridge->region().particles_domain();
  grid::CellRange const all = domain.all_cells();
  int const dims = domain.dimensions();
  solids_.assign(all.count(), 0.0);
  for (int body = 0; body < static_cast<int>(particles.bodies().size()); ++body) {
    if (body == system_->gas_body()) continue;
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
          solids_[all.offset(cell)] += fraction * volume;
        }
      }
    }
  }
  for_each_cell(all, [&](Index3 const& cell) {
    double& solid = solids_[all.offset(cell)];
    solid = std::min(1.0, solid / domain.cell_volume(cell[0]));
  });
}

}  // namespace brisance::observe
