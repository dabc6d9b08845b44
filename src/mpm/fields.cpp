/// What grid fields do to each other and what constraints do to them: the pressure of fluids on the surfaces of bodies,
/// contact, held nodes, and momentum that points of different transfers share; see `mpm.hpp`.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/contact.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// How far apart neighbours along d stand among a patch's nodes.
int stride_of(Patch const& patch, int d) { return d == 0 ? 1 : d == 1 ? patch.n[0] : patch.n[0] * patch.n[1]; }

/// Storage index along d of a patch's node.
int index_along(Patch const& patch, int d, int node) { return node / stride_of(patch, d) % patch.n[d]; }

/// Calls visit(d, side, face) for each of the `Options::ends` within reach of a block's nodes, with the index along d
/// of the nodes on it.
template <class Visit>
void for_ends(Options const& options, Patch const& patch, double h, Visit&& visit) {
  for (int d = 0; d < patch.dimensions; ++d) {
    for (int side = 0; side < 2; ++side) {
      std::optional<double> const& end = options.ends[2 * d + side];
      if (!end) continue;
      int const face = patch.reach + static_cast<int>(std::lround((*end - patch.first[d]) / h));
      if (face >= 0 && face < patch.n[d]) visit(d, side, face);
    }
  }
}

/// A body that goes on behind an end shows no area to it.
void cut_at_ends(Options const& options, Patch const& patch, double h, NodeVelocity* area) {
  for_ends(options, patch, h, [&](int d, int side, int face) {
    double const outwards = side == 0 ? -1.0 : 1.0;
    for (int node = 0; node < patch.count(); ++node) {
      if (std::abs(index_along(patch, d, node) - face) > patch.reach || outwards * area[node][d] <= 0.0) continue;
      area[node][d] = 0.0;
    }
  });
}

/// What the velocity of a fluid that slips along a held body changes by at a node, to stay at the body's surface.
Vec3 follow(double mass_floor, NodeVelocity const& filled, NodeVelocity const& body, NodeVelocity const& fluid) {
  Surface const surface = surface_at(filled);
  if (!(fluid[3] > mass_floor) || !surface.felt) return {0.0, 0.0, 0.0};
  return surface.stopped({body[0] - fluid[0], body[1] - fluid[1], body[2] - fluid[2]});
}

}  // namespace

/// A body that reaches one of the ends goes on behind it: what it fills there is the mirror image of what it fills
/// before it, so that it has no surface on the end. Of the points of one block: all nodes that one touches behind an
/// end have their image in the block's patch.
void Mpm::continue_behind_ends(int block) {
  Workspace& w = *work_;
  Patch const& patch = w.patches[block];
  for (int f = 0; f < w.fields; ++f) {
    int const slot = w.slot(block, f);
    if (w.slips[f] != 0 || w.present[slot] == 0) continue;
    NodeVelocity* filled = w.gradient[slot].data();
    for_ends(options_, patch, grid_.domain().h, [&](int d, int, int face) {
      Lanes4 sign{1.0, 1.0, 1.0, 1.0};
      sign[d] = -1.0;
      int const stride = stride_of(patch, d);
      int const width = std::min({patch.reach, face, patch.n[d] - 1 - face});
      for (int node = 0; node < patch.count(); ++node) {
        if (index_along(patch, d, node) != face) continue;
        filled[node] += sign * filled[node];
        for (int k = 1; k <= width; ++k) {
          NodeVelocity const before = filled[node - k * stride];
          NodeVelocity const behind = filled[node + k * stride];
          filled[node - k * stride] = before + sign * behind;
          filled[node + k * stride] = behind + sign * before;
        }
      }
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
        if (w.slips[w.field_of[b]] == 0 && !points(there, static_cast<int>(b)).empty()) return true;
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
/// their outermost points, also where the velocity of the nodes is not shared; by the shared velocity alone they would
/// bear what the gas around happens to give to nodes that they hardly weigh on.
void Mpm::share_pressure(int block, double dt, Scratch& scratch) const {
  Workspace const& w = *work_;
  scratch.pressed = {};
  scratch.pushes.clear();
  int const count = w.patches[block].count();
  for (int g = 0; g < w.fields; ++g) {
    if (w.slips[g] == 0 || scratch.present[g] == 0) continue;
    if (!w.gather(w.area, w.area_present, block, g, scratch.area[g], true)) continue;
    NodeVelocity const* pressure = scratch.area[g].data();
    NodeState* fluid = scratch.state[g].data();
    for (int f = 0; f < w.fields; ++f) {
      if (!w.slips_along(g, f) || scratch.present[f] == 0) continue;
      if (!w.gather(w.area, w.area_present, block, f, scratch.area[f])) continue;
      cut_at_ends(options_, w.patches[block], grid_.domain().h, scratch.area[f].data());
      NodeVelocity const* area = scratch.area[f].data();
      NodeVelocity const* filled = scratch.gradient[f].data();
      NodeState* body = scratch.state[f].data();
      double const* images = scratch.wholes[f] != 0 ? scratch.whole[f].data() : nullptr;
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
        double const part = images == nullptr ? 1.0 : body[node].momentum[3] / images[node];
        body[node].force -= Lanes4{part, part, part, 0.0} * push;
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
/// the points keep.
void Mpm::settle_pushes(Scratch& scratch) {
  for (Push const& push : scratch.pushes) {
    NodeState& fluid = scratch.state[push.fluid].data()[push.node];
    NodeState const& body = scratch.state[push.body].data()[push.node];
    double work = 0.0;
    for (int d = 0; d < 3; ++d) {
      double const of_fluid = fluid.momentum[d] - 0.5 * fluid.force[d];
      double const kept =
          push.shared || scratch.meets[push.body] == 0 ? 0.0 : scratch.keep[push.body].data()[push.node][d];
      double const of_body = body.momentum[d] + kept - 0.5 * body.force[d];
      work += push.impulse[d] * (of_fluid - of_body);
    }
    fluid.force[3] -= work;
  }
}

void Mpm::gather_gradients(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  for (int f = 0; f < w.fields; ++f) {
    if (w.slips[f] != 0) continue;
    scratch.present[f] = w.gather(w.gradient, block, f, scratch.gradient[f]) ? 1 : 0;
  }
}

void Mpm::constrain_velocity(int block, double dt, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    if (scratch.present[f] == 0 || !w.rigid[f]) continue;
    NodeVelocity* nodes = scratch.velocity[f].data();
    for (int node = 0; node < count; ++node) {
      for (int d = 0; d < 3; ++d) nodes[node][d] = (*w.rigid[f])[d];
    }
  }
  if (w.contact) {
    struct Access {
      Scratch* s;
      double mass(int f, int node) const { return s->velocity[f].data()[node][3]; }
      double whole(int f, int node) const { return s->wholes[f] != 0 ? s->whole[f].data()[node] : mass(f, node); }
      Vec3 get(int f, int node) const {
        NodeVelocity const& v = s->velocity[f].data()[node];
        return {v[0], v[1], v[2]};
      }
      void set(int f, int node, Vec3 const& v) const {
        for (int d = 0; d < 3; ++d) s->velocity[f].data()[node][d] = v[d];
      }
      void give(int /*fluid*/, int /*body*/, int /*node*/, Vec3 const& /*impulse*/) const {}  // the momentum's counts
      NodeVelocity const& gradient(int f, int node) const { return s->gradient[f].data()[node]; }
    };
    meet_velocity(block, scratch);
    make_compatible({count, w.fields, w.mass_floor, &scratch.present, &w.laws, &w.rigid, &w.slips}, Access{&scratch});
    mirror_fluids(block, scratch, false);
  }
  stop_velocity_at_walls(block, dt, scratch);
  for (Hold const& hold : w.holds[block]) {
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.present[f] == 0 || w.rigid[f] || !w.held(f, hold)) continue;
      NodeVelocity& v = scratch.velocity[f].data()[hold.node];
      for (int d = 0; d < 3; ++d) {
        if (hold.held[d]) v[d] = hold.velocity[d];
      }
      for (int g = 0; g < w.fields; ++g) {
        if (!w.slips_along(g, f) || scratch.present[g] == 0) continue;
        NodeVelocity& fluid = scratch.velocity[g].data()[hold.node];
        Vec3 const change = follow(w.mass_floor, scratch.gradient[f].data()[hold.node], v, fluid);
        for (int d = 0; d < 3; ++d) fluid[d] += change[d];
      }
    }
  }
}

/// Points of APIC take over the velocity of their nodes, all others add its change to their own. Where both share nodes
/// the first give and take momentum there that the others must take and give: they add the difference between the
/// nodes' common velocity and their own one.
void Mpm::share_momentum(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    scratch.exchanges[f] = 0;
    if (w.shared[f] == 0 || scratch.present[f] == 0) continue;
    if (!w.gather_moving(w.momentum, w.momentum_present, block, f, scratch.exchange[f])) continue;
    scratch.exchanges[f] = 1;
    NodeState* nodes = scratch.state[f].data();
    NodeVelocity* exchange = scratch.exchange[f].data();
    for (int node = 0; node < count; ++node) {
      double const own = exchange[node][3];
      // Where the others are alone the difference is round-off.
      bool const both = own > w.mass_floor && nodes[node].momentum[3] - own > 1e-12 * own;
      double const inverse = both ? 1.0 / own : 0.0;
      double const part = both ? 1.0 : 0.0;
      NodeVelocity const common = nodes[node].momentum - nodes[node].force;
      NodeVelocity const alone = inverse * exchange[node];
      exchange[node] = part * common - alone;
      exchange[node][3] = own;
      // What is not in the common motion becomes heat of the first.
      nodes[node].force[3] += 0.5 * own * (alone[0] * alone[0] + alone[1] * alone[1] + alone[2] * alone[2]);
    }
  }
}

/// From here on the nodes have the velocity that points take over: it is not the one with which they move where bodies
/// meet, see contact.cpp. The energy per mass that friction gives goes beside its change of the velocity: the points'
/// own one before knows nothing of it.
void Mpm::release(int count, Scratch& scratch) const {
  for (int f = 0; f < work_->fields; ++f) {
    NodeState* nodes = scratch.state[f].data();
    if (scratch.meets[f] != 0) {
      NodeVelocity const* keep = scratch.keep[f].data();
      for (int node = 0; node < count; ++node) nodes[node].momentum += keep[node];
    }
    if (work_->affine[f] == 0 || scratch.rubs[f] == 0) continue;
    NodeVelocity* rub = scratch.rub[f].data();
    for (int node = 0; node < count; ++node) {
      NodeVelocity& change = rub[node];
      NodeState const& r = nodes[node];
      for (int d = 0; d < 3; ++d) change[3] += change[d] * (r.momentum[d] - 0.5 * r.force[d]);
    }
  }
}

void Mpm::constrain_state(int block, double dt, Scratch& scratch) {
  Workspace& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    if (scratch.present[f] == 0 || !w.rigid[f]) continue;
    Vec3 const& v = *w.rigid[f];
    NodeState* nodes = scratch.state[f].data();
    for (int node = 0; node < count; ++node) {
      NodeState& r = nodes[node];
      r.momentum = Lanes4{v[0], v[1], v[2], r.momentum[3]};
      r.force = Lanes4{0.0, 0.0, 0.0, r.force[3]};
    }
  }
  Given given = scratch.pressed;
  if (w.touches && options_.order != StressOrder::usf) find_meetings(block, dt, scratch, false);
  meet(block, scratch, given);
  if (w.contact) {
    struct Access {
      Scratch* s;
      std::vector<std::optional<Vec3>> const* rigid;
      Workspace const* workspace;
      int block;
      Given* given;
      double mass(int f, int node) const { return s->state[f].data()[node].momentum[3]; }
      double whole(int f, int node) const { return s->wholes[f] != 0 ? s->whole[f].data()[node] : mass(f, node); }
      Vec3 get(int f, int node) const {
        Lanes4 const& v = s->state[f].data()[node].momentum;
        return {v[0], v[1], v[2]};
      }
      void set(int f, int node, Vec3 const& v) const {
        NodeState& r = s->state[f].data()[node];
        for (int d = 0; d < 3; ++d) {
          double const change = v[d] - r.momentum[d];
          r.force[d] += change;
          r.momentum[d] = v[d];
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
          if ((*rigid)[g] && s->present[g] != 0 && mass(static_cast<int>(g), node) > 0.0) return &*(*rigid)[g];
        }
        return nullptr;
      }
      NodeVelocity const& gradient(int f, int node) const { return s->gradient[f].data()[node]; }
    };
    make_compatible({count, w.fields, w.mass_floor, &scratch.present, &w.laws, &w.rigid, &w.slips},
                    Access{&scratch, &w.rigid, &w, block, &given});
    mirror_fluids(block, scratch, true);
  }
  stop_at_walls(block, dt, scratch, given);
  for (int f = 0; f < w.fields; ++f) {
    scratch.halts[f] = scratch.present[f] != 0 && !w.rigid[f] && w.slips[f] == 0 && !w.holds[block].empty() ? 1 : 0;
    if (scratch.halts[f] == 0) continue;
    NodeVelocity* halt = scratch.halt[f].get(count);
    std::fill(halt, halt + count, NodeVelocity{});
  }
  for (Hold const& hold : w.holds[block]) {
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.present[f] == 0 || w.rigid[f] || !w.held(f, hold)) continue;
      NodeState& r = scratch.state[f].data()[hold.node];
      double const m = r.momentum[3];
      if (!(m > w.mass_floor)) continue;
      NodeVelocity& halt = scratch.halt[f].data()[hold.node];
      double const own = w.own_mass(block, f, hold.node);
      for (int d = 0; d < 3; ++d) {
        if (!hold.held[d]) continue;
        double const change = hold.velocity[d] - r.momentum[d];
        // What an earlier constraint or a wall has booked.
        double const stopped = scratch.stops[f] != 0 ? scratch.stop[f].data()[hold.node][d] : 0.0;
        double const work_before =
            halt[d] * (r.momentum[d] - 0.5 * halt[d]) + stopped * (r.momentum[d] - 0.5 * r.force[d]);
        given.impulse[d] += own * change;
        given.work += own * change * hold.velocity[d];
        r.force[d] += change;
        r.momentum[d] = hold.velocity[d];
        // `force` is the whole change of the step, the one against the start of the step.
        double const drive = (r.force[d] - halt[d]) * hold.velocity[d];
        double const middle = hold.velocity[d] - 0.5 * r.force[d];
        // Points that take over the nodes' velocity lose what the nodes do.
        double const rubbed = scratch.rubs[f] != 0 ? scratch.rub[f].data()[hold.node][d] : 0.0;
        double const lost_by_node = drive - r.force[d] * middle + work_before - rubbed * (hold.velocity[d] - middle);
        if (w.affine[f] == 0 || w.shared[f] != 0) {
          given.drive += own * drive;
        } else if (w.heats[f] != 0) {
          r.force[3] += m * lost_by_node;
        } else {
          given.drive += own * lost_by_node;
        }
        halt[d] = r.force[d];
        // What walls rub off while the node moves along is theirs, the constraint does all the rest.
        if (rubbed != 0.0) {
          NodeVelocity& rub = scratch.rub[f].data()[hold.node];
          rub[d] -= rubbed;
          rub[3] += rubbed * middle;
          if (w.affine[f] == 0) given.friction -= own * rubbed * hold.velocity[d];
        }
        if (scratch.stops[f] != 0) scratch.stop[f].data()[hold.node][d] = 0.0;
      }
      // What slips along the body stays at its surface.
      for (int g = 0; g < w.fields; ++g) {
        if (!w.slips_along(g, f) || scratch.present[g] == 0) continue;
        NodeState& fluid = scratch.state[g].data()[hold.node];
        double const mass = fluid.momentum[3];
        double const own_fluid = w.own_mass(block, g, hold.node);
        Vec3 const change = follow(w.mass_floor, scratch.gradient[f].data()[hold.node], r.momentum, fluid.momentum);
        for (int d = 0; d < 3; ++d) {
          fluid.force[d] += change[d];
          fluid.momentum[d] += change[d];
          given.impulse[d] += own_fluid * change[d];
          given.work += own_fluid * change[d] * r.momentum[d];
        }
        fluid.force[3] += 0.5 * mass * dot(change, {fluid.force[0], fluid.force[1], fluid.force[2]});  // as in contact
      }
    }
  }
  settle_pushes(scratch);
  w.impulse[block] = given.impulse;
  w.work[block] = given.work;
  w.dissipation[block] = {};
  w.dissipation[block].held = given.drive;
  w.dissipation[block].friction = given.friction;
  release(count, scratch);
}

}  // namespace brisance::mpm
