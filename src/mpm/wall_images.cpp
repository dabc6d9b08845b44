/// Fluids that slip along bodies at a wall: they have images behind it, the bodies have none, see walls.cpp.
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

/// Masses of bodies' nodes with the images behind walls, as the fluids that slip along them have theirs.
void Mpm::weigh_images(int block, Scratch& scratch, bool of_state) const {
  Workspace const& w = *work_;
  Patch const& patch = w.patches[block];
  for (int f = 0; f < w.fields; ++f) {
    scratch.of[f].wholes = w.one_sided[f] != 0 && scratch.of[f].present && !w.walls[block].empty();
    if (!scratch.of[f].wholes) continue;
    double* masses = scratch.of[f].whole.get(patch.count());
    for (int node = 0; node < patch.count(); ++node) {
      masses[node] = of_state ? scratch.of[f].sums.data()[node].momentum[3] : scratch.of[f].velocity.data()[node][3];
    }
    for (WallFace const& wall : w.walls[block]) {
      int const stride = patch.stride(wall.direction);
      grid::for_each_node(patch, patch.plane(wall.direction, wall.plane), [&](int node) {
        masses[node] *= 2.0;
        for (int k = 1; k <= patch.reach; ++k) {
          double const both = masses[node + k * stride] + masses[node - k * stride];
          masses[node + k * stride] = masses[node - k * stride] = both;
        }
      });
    }
  }
}

/// What fluids that slip have got from bodies at a wall makes mirror images of their nodes again: each pair shares what
/// both got, by the masses of the bodies that gave it.
void Mpm::mirror_fluids(int block, Scratch& scratch, bool of_state) const {
  Workspace const& w = *work_;
  Patch const& patch = w.patches[block];
  if (!w.slides || w.walls[block].empty()) return;
  for (int g = 0; g < w.fields; ++g) {
    if (w.slips[g] == 0 || !scratch.of[g].present) continue;
    auto const bodies_at = [&](int node) {
      double mass = 0.0;
      for (int f = 0; f < w.fields; ++f) {
        if (!scratch.of[f].wholes || !w.slips_along(g, f)) continue;
        mass += of_state ? scratch.of[f].motion.data()[node].velocity[3] : scratch.of[f].velocity.data()[node][3];
      }
      return mass;
    };
    auto const velocity = [&](int node, int d) -> double {
      return of_state ? scratch.of[g].motion.data()[node].velocity[d] : scratch.of[g].velocity.data()[node][d];
    };
    auto const set = [&](int node, int d, double v) {
      if (!of_state) {
        scratch.of[g].velocity.data()[node][d] = v;
        return;
      }
      NodeMotion& r = scratch.of[g].motion.data()[node];
      r.change[d] += v - r.velocity[d];
      r.velocity[d] = v;
    };
    for (WallFace const& wall : w.walls[block]) {
      int const stride = patch.stride(wall.direction);
      grid::for_each_node(patch, patch.plane(wall.direction, wall.plane), [&](int node) {
        if (bodies_at(node) > w.mass_floor) set(node, wall.direction, 0.0);
        for (int k = 1; k <= patch.reach; ++k) {
          int const a = node + k * stride;
          int const b = node - k * stride;
          double const ma = bodies_at(a);
          double const mb = bodies_at(b);
          if (!(ma + mb > w.mass_floor)) continue;
          double const fraction = ma / (ma + mb);
          for (int d = 0; d < 3; ++d) {
            double const sign = d == wall.direction ? -1.0 : 1.0;
            double const v = fraction * velocity(a, d) + sign * (1.0 - fraction) * velocity(b, d);
            set(a, d, v);
            set(b, d, sign * v);
          }
        }
      });
    }
  }
}

}  // namespace brisance::mpm
