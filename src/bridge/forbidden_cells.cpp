#include "bridge/forbidden_cells.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/parallel.hpp"

namespace brisance::bridge {

using mpm::Field;

ForbiddenCells::ForbiddenCells(mpm::Mpm const& particles, int gas_body, Faces const& faces)
    : particles_(&particles), gas_body_(gas_body), faces_(&faces), region_(&faces.region()) {
  for (int b = 0; b < particles.grid().block_count(); ++b) {
    grid::Block const& block = particles.grid().blocks()[b];
    if (any_cell(block.in_domain(), [&](Index3 const& cell) { return contains(region_->from_particles(cell)); })) {
      blocks_.push_back(b);
    }
  }
}

bool ForbiddenCells::contains(Index3 const& cell) const {
  if (region_->clamped(cell) != cell) return false;  // beyond an open boundary: it leaves
  return region_->layer(cell) <= region_->width() + 2;
}

std::string ForbiddenCells::intruder() const {
  std::vector<std::string> trouble(blocks_.size());
  parallel_for(static_cast<int>(blocks_.size()), [&](int n, int) {
    for (int body = 0; body < static_cast<int>(particles_->bodies().size()); ++body) {
      if (body == gas_body_) continue;
      mpm::ParticleSet const& set = particles_->particles(blocks_[n], body);
      for (int q = 0; q < set.size(); ++q) {
        Vec3 const x{set.field(Field::position_x)[q], set.field(Field::position_y)[q], set.field(Field::position_z)[q]};
        if (!contains(faces_->cell_at(x))) continue;
        trouble[n] = fmt::format(
            "body \"{}\" has reached the bridge at ({:.6g}, {:.6g}, {:.6g}) m; solids must stay {} cells away from the "
            "faces of the MPM region; enlarge the MPM region there with mpm_region.box or, if the box is placed around "
            "the bodies automatically, with mpm_region.margin",
            particles_->bodies()[body].name, x[0], x[1], x[2], region_->width() + 2);
        return;
      }
    }
  });
  auto const first =
      std::find_if(trouble.begin(), trouble.end(), [](std::string const& text) { return !text.empty(); });
  return first == trouble.end() ? std::string{} : *first;
}

}  // namespace brisance::bridge
