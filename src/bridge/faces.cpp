#include "bridge/faces.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/error.hpp"

namespace brisance::bridge {

namespace {

grid::Metric refined(grid::Metric cells, int parts) {
  cells.h /= parts;
  return cells;
}

std::size_t key_of(grid::Domain const& domain, Index3 const& cell) { return domain.all_cells().offset(cell); }

}  // namespace

Faces::Faces(Region const& region, int parts)
    : region_(&region), parts_(parts), sub_cells_(refined(region.metric(), parts)) {
  for (int d = 1; d < region.domain().dimensions(); ++d) lanes_ *= parts;
  for (int f = 0; f < count(); ++f) {
    Face const& face = region.faces()[f];
    auto [found, fresh] = faces_of_.try_emplace(key_of(region.domain(), face.inside));
    if (fresh) found->second.fill(-1);
    found->second[2 * face.direction + face.side] = f;
  }
  find_neighbours();
}

int Faces::find(Index3 const& inside, int direction, int side) const {
  auto const found = faces_of_.find(key_of(region_->domain(), inside));
  return found == faces_of_.end() ? -1 : found->second[2 * direction + side];
}

std::array<int, 3> Faces::before(Index3 const& cell) const {
  int const dims = region_->domain().dimensions();
  // The nearest cell of the region, with as few directions to go as can be.
  int best = 1000;
  Index3 inside = cell;
  for_each_cell(grid::around(cell, 3, dims), [&](Index3 const& there) {
    int distance = 0;
    for (int d = 0; d < dims; ++d) distance += (there[d] - cell[d]) * (there[d] - cell[d]);
    if (distance >= best || !region_->inside(there)) return;
    best = distance;
    inside = there;
  });
  std::array<int, 3> faces{-1, -1, -1};
  for (int d = 0; d < dims; ++d) {
    if (inside[d] != cell[d]) faces[d] = find(inside, d, inside[d] > cell[d] ? 0 : 1);
  }
  return faces;
}

int Faces::crossed(Vec3 const& x, Vec3 const& move) const {
  int const dims = region_->domain().dimensions();
  Index3 const to = cell_at(x);
  Index3 cell = cell_at(x - move);
  for (int d = 0; d < dims; ++d) {
    if (std::abs(cell[d] - to[d]) > 1) cell[d] = to[d];  // came around a periodic direction
  }
  if (!region_->inside(cell)) {
    // By round-off it did not start inside: the nearest cell of the region next to where it is.
    int nearest = 4;
    for_each_cell(grid::around(to, 1, dims), [&](Index3 const& there) {
      int distance = 0;
      for (int d = 0; d < dims; ++d) distance += std::abs(there[d] - to[d]);
      if (distance >= nearest || !region_->inside(there)) return;
      nearest = distance;
      cell = there;
    });
    if (nearest == 4) throw NumericalError("a gas particle left the MPM region by more than one cell in one step");
  }
  for (int d = 0; d < dims; ++d) {
    while (cell[d] != to[d]) {
      int const side = to[d] > cell[d] ? 1 : 0;
      Index3 const next = grid::beside(cell, d, side);
      if (!region_->inside(next)) return find(cell, d, side);
      cell = next;
    }
  }
  return -1;
}

Index3 Faces::cell_at(Vec3 const& x) const {
  // By the grid of the particles, as they are sorted into it.
  grid::Metric const& own = region_->particles_domain();
  Index3 cell{0, 0, 0};
  for (int d = 0; d < own.dimensions(); ++d) {
    cell[d] = static_cast<int>(std::floor(own.in_cells(d, x[d]))) - region_->shift()[d];
  }
  return cell;
}

int Faces::lane_of(int face, Vec3 const& x) const {
  Face const& f = region_->faces()[face];
  grid::Metric const& cells = region_->metric();
  int lane = 0;
  int stride = 1;
  for (int d = 0; d < cells.dimensions(); ++d) {
    if (d == f.direction) continue;
    double const u = cells.in_cells(d, x[d]) - f.inside[d];
    lane += stride * std::clamp(static_cast<int>(std::floor(u * parts_)), 0, parts_ - 1);
    stride *= parts_;
  }
  return lane;
}

Index3 Faces::sub_cell(int face, int lane) const {
  Face const& f = region_->faces()[face];
  Index3 sub{0, 0, 0};
  for (int d = 0; d < region_->domain().dimensions(); ++d) {
    if (d == f.direction) {
      sub[d] = f.side == 0 ? 0 : parts_ - 1;
    } else {
      sub[d] = lane % parts_;
      lane /= parts_;
    }
  }
  return sub;
}

int Faces::lane_at(int face, Index3 const& sub) const {
  int lane = 0;
  int stride = 1;
  for (int d = 0; d < region_->domain().dimensions(); ++d) {
    if (d == region_->faces()[face].direction) continue;
    lane += stride * sub[d];
    stride *= parts_;
  }
  return lane;
}

double Faces::lane_area(int face, int lane) const {
  Face const& f = region_->faces()[face];
  Index3 const sub = sub_cell(face, lane);
  int i = f.inside[0] * parts_ + sub[0];
  if (f.direction == 0 && f.side == 1) ++i;
  return sub_cells_.face_area(f.direction, i);
}

double Faces::standard_volume(Index3 const& cell, Index3 const& sub) const {
  // Beyond an open boundary at a negative radius there is nothing.
  return std::abs(sub_cells_.cell_volume(cell[0] * parts_ + sub[0]));
}

void Faces::find_neighbours() {
  auto const& faces = region_->faces();
  int const dims = region_->domain().dimensions();
  neighbours_.assign(lane_count(), {-1, -1, -1, -1});
  for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
    Face const& face = faces[f];
    if (face.open) continue;
    for (int lane = 0; lane < lanes_; ++lane) {
      Index3 const sub = sub_cell(f, lane);
      auto& neighbours = neighbours_[static_cast<std::size_t>(f) * lanes_ + lane];
      int n = 0;
      for (int d = 0; d < dims; ++d) {
        if (d == face.direction) continue;
        for (int side = 0; side < 2; ++side, ++n) {
          int other = f;
          Index3 there = grid::beside(sub, d, side);
          if (there[d] < 0 || there[d] >= parts_) {
            // The next face of the same direction, or the one around the edge.
            Index3 const next = grid::beside(face.inside, d, side);
            there[d] = side == 0 ? parts_ - 1 : 0;
            other = region_->inside(next) ? find(next, face.direction, face.side) : -1;
            if (other < 0) {
              other = find(face.inside, d, side);
              there = sub;
            }
          }
          if (other < 0 || faces[other].open) continue;
          neighbours[n] = other * lanes_ + lane_at(other, there);
        }
      }
    }
  }
}

}  // namespace brisance::bridge
