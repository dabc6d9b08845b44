#include "bridge/shared_gas.hpp"

#include <algorithm>

namespace brisance::bridge {

namespace {

/// Cells whose averages the bridge needs: the ghost cells and their neighbours, then the cells of the region at open
/// boundaries and those that stand for proxy cells there.
std::vector<Index3> averaged_cells(Region const& region, std::map<Index3, int>& number) {
  std::vector<Index3> cells;
  auto const add = [&](Index3 const& cell) {
    auto const [found, fresh] = number.try_emplace(cell, static_cast<int>(cells.size()));
    if (fresh) cells.push_back(cell);
  };
  for (Index3 const& cell : region.ghosts()) add(cell);
  for (Index3 const& cell : region.ghosts()) {
    for (int d = 0; d < region.domain().dimensions(); ++d) {
      for (int const side : {0, 1}) {
        Index3 const there = grid::beside(cell, d, side);
        if (region.inside(there)) add(there);
      }
    }
  }
  for (Face const& face : region.faces()) {
    if (face.open) add(face.inside);
  }
  for (Index3 const& cell : region.proxy_cells()) {
    Index3 const inner = region.clamped(cell);
    if (inner != cell && region.inside(inner)) add(inner);
  }
  return cells;
}

/// Gas cells that act as particles: of the proxy cells those of the domain, and for those beyond an open boundary but
/// not next to the region the gas cell that stands for them.
std::vector<Index3> state_cells(Region const& region, std::map<Index3, int>& number) {
  std::vector<Index3> cells;
  auto const add = [&](Index3 const& cell) {
    auto const [found, fresh] = number.try_emplace(cell, static_cast<int>(cells.size()));
    if (fresh) cells.push_back(cell);
  };
  for (Index3 const& cell : region.proxy_cells()) {
    Index3 const inner = region.clamped(cell);
    if (!region.inside(inner)) add(inner);
  }
  // The printed transport takes the mean of both sides of a face.
  for (Face const& face : region.faces()) {
    if (!face.open) add(face.inside);
  }
  return cells;
}

}  // namespace

SharedGas::SharedGas(gas::Gas const& gas, mpm::Mpm const& particles, int gas_body, Faces const& faces)
    : gas_(&gas),
      particles_(&particles),
      gas_body_(gas_body),
      faces_(&faces),
      averages_(faces.region().domain(), particles, faces.region().shift(), averaged_cells(faces.region(), averaged_)),
      states_(gas.grid(), faces.region(), state_cells(faces.region(), read_)) {
  for (Face const& face : faces.region().faces()) {
    Beside beside;
    if (face.open) {
      beside.average = averaged_.at(face.inside);
    } else {
      beside.outside = read_.at(face.outside());
      beside.inside = read_.at(face.inside);
    }
    beside_.push_back(beside);
    if (!face.open) continue;
    solid_[face.inside] = 0.0;
    int const block = particles.grid().block_of(faces.region().to_particles(face.inside));
    if (std::find(open_blocks_.begin(), open_blocks_.end(), block) == open_blocks_.end()) open_blocks_.push_back(block);
  }
}

void SharedGas::average() {
  averages_.compute(*particles_, gas_body_);
  find_solids();
}

void SharedGas::find_solids() {
  using mpm::Field;
  for (auto& [cell, volume] : solid_) volume = 0.0;
  for (int const block : open_blocks_) {
    for (int body = 0; body < static_cast<int>(particles_->bodies().size()); ++body) {
      material::Material const& solid = particles_->bodies()[body].solid;
      if (!solid.has_deviator()) continue;
      mpm::ParticleSet const& set = particles_->particles(block, body);
      for (int q = 0; q < set.size(); ++q) {
        auto const found = solid_.find(faces_->cell_at(
            {set.field(Field::position_x)[q], set.field(Field::position_y)[q], set.field(Field::position_z)[q]}));
        if (found == solid_.end()) continue;
        found->second += set.field(Field::mass)[q] / std::max(set.field(Field::density)[q], solid.density);
      }
    }
  }
}

bool SharedGas::solid_at(int face) const {
  auto const found = solid_.find((*faces_)[face].inside);
  if (found == solid_.end()) return false;
  return found->second > 0.5 * faces_->region().metric().cell_volume(found->first[0]);
}

GasSlopes SharedGas::slopes_outside(int face) const {
  Primitive centre;
  GasSlopes slopes;
  states_.at(beside_[face].outside, 1.0, centre, slopes);
  return slopes;
}

Primitive SharedGas::donor(int face, int lane, GasSlopes& slopes) const {
  slopes = {};
  Face const& f = (*faces_)[face];
  if (f.open) return bridge::primitive(fluids(), sums_at(face));
  Primitive centre;
  states_.at(beside_[face].outside, 1.0, centre, slopes);
  Index3 const sub = faces_->sub_cell(face, lane);
  Vec3 offset{0.0, 0.0, 0.0};
  for (int d = 0; d < faces_->region().domain().dimensions(); ++d) {
    offset[d] = d == f.direction ? (f.side == 0 ? 0.5 : -0.5) : (sub[d] + 0.5) / faces_->parts() - 0.5;
  }
  return at_offset(centre, slopes, offset);
}

}  // namespace brisance::bridge
