/// Fluids that slip along bodies: the pressure on their surfaces, and the velocity that they share.
#include <algorithm>
#include <cmath>
#include <optional>

#include "mpm/contact.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Calls visit(d, side, face) for each of the `Options::ends` within reach of a block's nodes, with the index along d
/// of the nodes on it.
template <class Visit>
void for_ends(Options const& options, Patch const& patch, Visit&& visit) {
  for (int d = 0; d < patch.dimensions; ++d) {
    for (int side = 0; side < 2; ++side) {
      std::optional<double> const& end = options.ends[2 * d + side];
      if (!end) continue;
      int const face = patch.reach + static_cast<int>(std::lround((*end - patch.first[d]) / patch.h));
      if (face >= 0 && face < patch.n[d]) visit(d, side, face);
    }
  }
}

/// A body that goes on behind an end shows no area to it.
void cut_at_ends(Options const& options, Patch const& patch, NodeVelocity* area) {
  for_ends(options, patch, [&](int d, int side, int face) {
    double const outwards = side == 0 ? -1.0 : 1.0;
    for (int node = 0; node < patch.count(); ++node) {
      if (std::abs(patch.along(d, node) - face) > patch.reach || outwards * area[node][d] <= 0.0) continue;
      area[node][d] = 0.0;
    }
  });
}

}  // namespace

/// A body that reaches one of the ends goes on behind it: what it fills there is the mirror image of what it fills
/// before it, so that it has no surface on the end. Of the particles of one block: all nodes that one touches behind an
/// end have their image in the block's patch.
void Mpm::continue_behind_ends(int block) {
  Workspace& w = *work_;
  Patch const& patch = w.patches[block];
  for (int f = 0; f < w.fields; ++f) {
    int const slot = w.slot(block, f);
    if (w.slips[f] != 0 || w.present[slot] == 0) continue;
    NodeVelocity* filled = w.gradient[slot].data();
    for_ends(options_, patch, [&](int d, int, int face) {
      Lanes4 sign{1.0, 1.0, 1.0, 1.0};
      sign[d] = -1.0;
      int const stride = patch.stride(d);
      int const width = std::min({patch.reach, face, patch.n[d] - 1 - face});
      grid::for_each_node(patch, patch.plane(d, face), [&](int node) {
        filled[node] += sign * filled[node];
        for (int k = 1; k <= width; ++k) {
          NodeVelocity const before = filled[node - k * stride];
          NodeVelocity const behind = filled[node + k * stride];
          filled[node - k * stride] = before + sign * behind;
          filled[node + k * stride] = behind + sign * before;
        }
      });
    });
  }
}

/// Where a set adds what `share_pressure` needs of it: a body its area, a fluid its pressure, the latter only where
/// there are bodies around; null elsewhere.
Lanes4* Mpm::area_nodes(int block, int body) {
  Workspace& w = *work_;
  int const f = w.field_of[body];
  if (w.slips[f] != 0) {
    auto const has_bodies = [&](int there) {
      if (there == grid::no_neighbour) return false;
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        if (w.slips[w.field_of[b]] == 0 && !particles(there, static_cast<int>(b)).empty()) return true;
      }
      return false;
    };
    if (std::none_of(w.around[block].begin(), w.around[block].end(), has_bodies)) return nullptr;
  }
  int const slot = w.slot(block, f);
  int const count = w.patches[block].count();
  Lanes4* nodes = w.area[slot].get(count);
  if (w.area_present[slot] == 0) std::fill(nodes, nodes + count, NodeVelocity{});
  w.area_present[slot] = 1;
  return nodes;
}

/// The pressure of a fluid that slips along bodies acts on the area that these show to the nodes, and they push back as
/// much. Then gas at rest under an even pressure stays at rest, and the bodies bear that pressure and no other up to
/// their outermost particles, also where the velocity of the nodes is not shared; by the shared velocity alone they
/// would bear what the gas around happens to give to nodes that they hardly weigh on.
void Mpm::share_pressure(int block, double dt, Scratch& scratch) const {
  Workspace const& w = *work_;
  scratch.pressed = {};
  scratch.pushes.clear();
  int const count = w.patches[block].count();
  for (int g = 0; g < w.fields; ++g) {
    if (w.slips[g] == 0 || !scratch.of[g].present) continue;
    if (!w.gather(w.area, w.area_present, block, g, scratch.of[g].area, true)) continue;
    NodeVelocity const* pressure = scratch.of[g].area.data();
    NodeSums* fluid = scratch.of[g].sums.data();
    for (int f = 0; f < w.fields; ++f) {
      if (!w.slips_along(g, f) || !scratch.of[f].present) continue;
      if (!w.gather(w.area, w.area_present, block, f, scratch.of[f].area)) continue;
      cut_at_ends(options_, w.patches[block], scratch.of[f].area.data());
      NodeVelocity const* area = scratch.of[f].area.data();
      NodeVelocity const* filled = scratch.of[f].gradient.data();
      NodeSums* body = scratch.of[f].sums.data();
      double const* images = scratch.of[f].wholes ? scratch.of[f].whole.data() : nullptr;
      for (int node = 0; node < count; ++node) {
        if (!(fluid[node].momentum[3] > w.mass_floor && body[node].momentum[3] > w.mass_floor)) continue;
        Surface const surface = surface_at(filled[node]);
        Lanes4 push = area[node];
        if (surface.felt) {
          // Deep in the body next to no gas is there to bear what does not point along the normal, in which they move
          // as one.
          Vec3 const& n = surface.normal;
          double const across = push[0] * n[0] + push[1] * n[1] + push[2] * n[2];
          push = Lanes4{across * n[0], across * n[1], across * n[2], 0.0};
        }
        double const p = pressure[node][0] / pressure[node][1];
        push *= Lanes4{p, p, p, 0.0};
        fluid[node].force += push;
        // The body has no images behind walls, the fluid has.
        double const fraction = images == nullptr ? 1.0 : body[node].momentum[3] / images[node];
        body[node].force -= Lanes4{fraction, fraction, fraction, 0.0} * push;
        scratch.pushes.push_back({g, f, node, {dt * push[0], dt * push[1], dt * push[2]}, true});
        if (!w.rigid[f]) continue;
        for (int d = 0; d < 3; ++d) {
          double const impulse = dt * push[d] * w.own_mass(block, g, node) / fluid[node].momentum[3];
          scratch.pressed.impulse[d] += impulse;
          scratch.pressed.work += impulse * (*w.rigid[f])[d];
        }
      }
    }
  }
}

/// What a fluid and the body that it slips along take from the one they should give to the other, and do not, as their
/// velocities differ: at the mean of those before and after the step, once all has acted on the node. The fluid has it
/// as heat; it may be negative. What contact shares among bodies works at the nodes' velocity, the rest at that which
/// the particles keep.
void Mpm::settle_pushes(Scratch& scratch) {
  for (Push const& push : scratch.pushes) {
    NodeMotion& fluid = scratch.of[push.fluid].motion.data()[push.node];
    NodeMotion const& body = scratch.of[push.body].motion.data()[push.node];
    double work = 0.0;
    for (int d = 0; d < 3; ++d) {
      double const of_fluid = fluid.velocity[d] - 0.5 * fluid.change[d];
      double const kept =
          push.shared || !scratch.of[push.body].meets ? 0.0 : scratch.of[push.body].keep.data()[push.node][d];
      double const of_body = body.velocity[d] + kept - 0.5 * body.change[d];
      work += push.impulse[d] * (of_fluid - of_body);
    }
    fluid.change[3] -= work;
  }
}

void Mpm::gather_gradients(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  for (int f = 0; f < w.fields; ++f) {
    if (w.slips[f] != 0) continue;
    scratch.of[f].present = w.gather(w.gradient, block, f, scratch.of[f].gradient);
  }
}

/// Fields that are glued, and fluids and the bodies that they slip along: see `make_compatible`.
void Mpm::share_velocity(int block, Scratch& scratch, Given& given) {
  Workspace& w = *work_;
  int const count = w.patches[block].count();
  struct Access {
    Scratch* s;
    std::vector<std::optional<Vec3>> const* rigid;
    Workspace const* workspace;
    int block;
    Given* given;
    bool present(int f) const { return s->of[f].present; }
    double mass(int f, int node) const { return s->of[f].motion.data()[node].velocity[3]; }
    double whole(int f, int node) const { return s->of[f].wholes ? s->of[f].whole.data()[node] : mass(f, node); }
    Vec3 get(int f, int node) const {
      Lanes4 const& v = s->of[f].motion.data()[node].velocity;
      return {v[0], v[1], v[2]};
    }
    void set(int f, int node, Vec3 const& v) const {
      NodeMotion& r = s->of[f].motion.data()[node];
      for (int d = 0; d < 3; ++d) {
        double const change = v[d] - r.velocity[d];
        r.change[d] += change;
        r.velocity[d] = v[d];
        if (!workspace->pushes) continue;
        // Between two bodies that are not rigid these cancel.
        double const impulse = workspace->own_mass(block, f, node) * change;
        given->impulse[d] += impulse;
        if (Vec3 const* pusher = rigid_at(node)) given->work += impulse * (*pusher)[d];
      }
    }
    void give(int fluid, int body, int node, Vec3 const& impulse) const {
      s->pushes.push_back({fluid, body, node, impulse, false});
    }
    /// Velocity of the rigid body that reaches the node, or null.
    Vec3 const* rigid_at(int node) const {
      for (std::size_t g = 0; g < rigid->size(); ++g) {
        if ((*rigid)[g] && s->of[g].present && mass(static_cast<int>(g), node) > 0.0) return &*(*rigid)[g];
      }
      return nullptr;
    }
    NodeVelocity const& gradient(int f, int node) const { return s->of[f].gradient.data()[node]; }
  };
  make_compatible({count, w.fields, w.mass_floor, &w.laws, &w.rigid, &w.slips},
                  Access{&scratch, &w.rigid, &w, block, &given});
  mirror_fluids(block, scratch, true);
}

}  // namespace brisance::mpm
