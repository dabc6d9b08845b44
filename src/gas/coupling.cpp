#include "gas/coupling.hpp"

#include <algorithm>
#include <utility>

#include "core/archive.hpp"

namespace brisance::gas {

namespace {

void archive(Archive& a, FaceFlux& flux) {
  a(flux.carried.mass, flux.carried.momentum, flux.carried.energy, flux.impulse, flux.work, flux.carried.volume);
}

}  // namespace

Coupling::Coupling(grid::Grid const& grid, int bundle_cells)
    : grid_(&grid), bundle_cells_(bundle_cells), blocks_(grid) {}

void Coupling::set_roles(int block, std::vector<Role> roles) {
  OfBlock& data = blocks_[block];
  data.all_frozen = std::all_of(roles.begin(), roles.end(), [](Role r) { return r == Role::frozen; });
  bool const all_own = std::all_of(roles.begin(), roles.end(), [](Role r) { return r == Role::own; });
  data.roles = all_own ? std::vector<Role>{} : std::move(roles);
}

int Coupling::watch(grid::Cell const& cell, int direction) {
  WatchedFace const face{cell, static_cast<int>(watched_.size())};
  grid::Bundles const bundles(grid_->block(face.cell), direction, bundle_cells_);
  auto& faces = blocks_[face.cell.block].watched[direction];
  faces.resize(bundles.count());
  faces[bundles.index_of(face.cell)].push_back(face);
  watched_.emplace_back();
  return face.number;
}

void Coupling::clear_watched() { std::fill(watched_.begin(), watched_.end(), FaceFlux{}); }

std::vector<Coupling::WatchedFace> const& Coupling::faces(int block, int direction, int bundle) const {
  static std::vector<WatchedFace> const none;
  auto const& of_bundles = blocks_[block].watched[direction];
  return of_bundles.empty() ? none : of_bundles[bundle];
}

void Coupling::rearrange(std::vector<grid::Block> const& blocks, std::vector<int> const& before) {
  blocks_.rearrange(blocks, before);
  for (grid::Block const& block : blocks) {
    for (auto& of_bundles : blocks_[block.number].watched) {
      for (auto& faces : of_bundles) {
        for (WatchedFace& face : faces) face.cell.block = block.number;
      }
    }
  }
}

void Coupling::archive(Archive& a) {
  a.same(watched_.size(), "the number of faces between gas and particles");
  for (FaceFlux& flux : watched_) gas::archive(a, flux);
}

}  // namespace brisance::gas
