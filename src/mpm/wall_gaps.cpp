/// How far the surfaces of bodies are from the walls around the domain, see walls.cpp.
#include <algorithm>
#include <cmath>

#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Half the size of a particle across a wall [m]: of a cube of its volume, or its own.
double half_size(SetView const& v, grid::Geometry geometry, int d, int q) {
  if (double const* own = v.set->field(Field::half_x + d)) return own[q];
  double part = 0.0;
  with_kernels(ShapeFunction::linear, v.patch->dimensions,
               [&](auto kernels) { part = kernels.cells_filled(v, geometry, q); });
  return 0.5 * v.h * std::pow(part, 1.0 / v.patch->dimensions);
}

}  // namespace

/// The nodes on a wall that a particle touches learn how far its surface is from it.
void Mpm::map_gaps(int block) {
  Workspace& w = *work_;
  std::vector<WallFace> const& walls = w.walls[block];
  if (walls.empty()) return;
  Patch const& patch = w.patches[block];
  double const h = patch.h;
  int const count = patch.count();
  for (int f = 0; f < w.fields; ++f) w.gap_present[w.slot(block, f)] = 0;
  for_sets(block, [&](ParticleSet& set, int body) {
    int const f = w.field_of[body];
    if (w.one_sided[f] == 0) return;
    int const slot = w.slot(block, f);
    int const all = count * static_cast<int>(walls.size());
    double* gaps = w.gap[slot].get(all);
    if (w.gap_present[slot] == 0) std::fill(gaps, gaps + all, no_gap);
    w.gap_present[slot] = 1;
    SetView const view{&set, &bodies_[body], &patch, h};
    for (std::size_t n = 0; n < walls.size(); ++n) {
      WallFace const& wall = walls[n];
      int const d = wall.direction;
      double const plane = patch.first[d] + (wall.plane - patch.reach) * h;
      double const* x = set.field(Field::position_x + d);
      for (int q = 0; q < set.size(); ++q) {
        double const distance = wall.inwards * (x[q] - plane);
        if (distance >= 2.0 * h) continue;
        double const gap = distance - half_size(view, grid_.domain().geometry, d, q);
        // Nodes along the wall that it touches.
        grid::CellRange touched = patch.plane(d, wall.plane);
        for (int e = 0; e < patch.dimensions; ++e) {
          if (e == d) continue;
          double reach = width_of(options_.shape);
          if (options_.shape == ShapeFunction::gimp) reach += 0.5 / bodies_[body].particles_per_direction;
          if (options_.shape == ShapeFunction::cpgimp) reach += set.field(Field::half_x + e)[q] / h;
          double const u = (set.field(Field::position_x + e)[q] - patch.first[e]) / h + patch.reach;
          touched.lower[e] = std::max(0, static_cast<int>(std::floor(u - reach)) + 1);
          touched.upper[e] = std::min(patch.n[e], static_cast<int>(std::ceil(u + reach)));
        }
        grid::for_each_node(patch, touched, [&](int node) {
          double& to = gaps[static_cast<int>(n) * count + node];
          to = std::min(to, gap);
        });
      }
    }
  });
}

/// The least of what the blocks along the walls know.
void Mpm::gather_gaps(int block, int field, Scratch& scratch) const {
  Workspace const& w = *work_;
  Patch const& patch = w.patches[block];
  std::vector<WallFace> const& walls = w.walls[block];
  int const count = patch.count();
  int const all = count * static_cast<int>(walls.size());
  double* gaps = scratch.of[field].gap.get(all);
  std::fill(gaps, gaps + all, no_gap);
  for (std::size_t n = 0; n < walls.size(); ++n) {
    int const d = walls[n].direction;
    for (Link const& link : patch.links) {
      int const slot = w.slot(link.source, field);
      if (link.wall || w.walls[link.source].empty() || w.gap_present[slot] == 0) continue;
      auto const& others = w.walls[link.source];
      auto const same = std::find_if(others.begin(), others.end(),
                                     [&](WallFace const& other) { return other.number == walls[n].number; });
      if (same == others.end()) continue;
      double const* from = w.gap[slot].data() + (same - others.begin()) * link.nodes.count();
      double* to = gaps + static_cast<int>(n) * count;
      grid::CellRange on_wall = link.to;
      if (on_wall.lower[d] > walls[n].plane || on_wall.upper[d] <= walls[n].plane) continue;
      on_wall.lower[d] = walls[n].plane;
      on_wall.upper[d] = walls[n].plane + 1;
      for_each_cell(on_wall, [&](Index3 const& node) {
        double& gap = to[patch.index(node)];
        gap = std::min(gap, from[link.source_index(node)]);
      });
    }
  }
}

void Mpm::gather_gaps(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  if (w.walls[block].empty()) return;
  for (int f = 0; f < w.fields; ++f) {
    if (w.one_sided[f] != 0 && scratch.of[f].present) gather_gaps(block, f, scratch);
  }
}

}  // namespace brisance::mpm
