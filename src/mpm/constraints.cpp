/// What contact, walls and constraints do to the velocity of nodes; see `mpm.hpp`.
#include <algorithm>

#include "mpm/contact.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// What the velocity of a fluid that slips along a held body changes by at a node, to stay at the body's surface.
Vec3 follow(double mass_floor, NodeVelocity const& filled, NodeVelocity const& body, NodeVelocity const& fluid) {
  Surface const surface = surface_at(filled);
  if (!(fluid[3] > mass_floor) || !surface.felt) return {0.0, 0.0, 0.0};
  return surface.stopped({body[0] - fluid[0], body[1] - fluid[1], body[2] - fluid[2]});
}

}  // namespace

/// What contact, bodies and fluids, walls and constraints make of the nodes' new velocity.
void Mpm::constrain_motion(int block, double dt, Scratch& scratch) {
  Workspace& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    if (!scratch.of[f].present || !w.rigid[f]) continue;
    Vec3 const& v = *w.rigid[f];
    NodeMotion* nodes = scratch.of[f].motion.data();
    for (int node = 0; node < count; ++node) {
      NodeMotion& r = nodes[node];
      r.velocity = Lanes4{v[0], v[1], v[2], r.velocity[3]};
      r.change = Lanes4{0.0, 0.0, 0.0, r.change[3]};
    }
  }
  Given given = scratch.pressed;
  if (w.touches && options_.order != StressOrder::usf) find_meetings(block, dt, scratch, false);
  meet(block, scratch, given);
  if (w.contact) share_velocity(block, scratch, given);
  stop_at_walls(block, dt, scratch, given);
  constrain_nodes(block, scratch, given);
  settle_pushes(scratch);
  w.impulse[block] = given.impulse;
  w.work[block] = given.work;
  w.dissipation[block] = {};
  w.dissipation[block].constraints = given.drive;
  w.dissipation[block].friction = given.friction;
  note_rubbing(count, scratch);
}

/// Gives nodes that constraints hold their velocity, and books what that takes.
void Mpm::constrain_nodes(int block, Scratch& scratch, Given& given) {
  Workspace& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    scratch.of[f].halts =
        scratch.of[f].present && !w.rigid[f] && w.slips[f] == 0 && !w.constrained_nodes[block].empty();
    if (!scratch.of[f].halts) continue;
    NodeVelocity* halt = scratch.of[f].halt.get(count);
    std::fill(halt, halt + count, NodeVelocity{});
  }
  for (ConstrainedNode const& at : w.constrained_nodes[block]) {
    for (int f = 0; f < w.fields; ++f) {
      if (!scratch.of[f].present || w.rigid[f] || !w.constrains(f, at)) continue;
      NodeMotion& r = scratch.of[f].motion.data()[at.node];
      double const m = r.velocity[3];
      if (!(m > w.mass_floor)) continue;
      NodeVelocity& halt = scratch.of[f].halt.data()[at.node];
      double const own = w.own_mass(block, f, at.node);
      for (int d = 0; d < 3; ++d) {
        if (!at.components[d]) continue;
        double const change = at.velocity[d] - r.velocity[d];
        // What an earlier constraint or a wall has booked.
        double const stopped = scratch.of[f].stops ? scratch.of[f].stop.data()[at.node][d] : 0.0;
        double const work_before =
            halt[d] * (r.velocity[d] - 0.5 * halt[d]) + stopped * (r.velocity[d] - 0.5 * r.change[d]);
        given.impulse[d] += own * change;
        given.work += own * change * at.velocity[d];
        r.change[d] += change;
        r.velocity[d] = at.velocity[d];
        // `change` is the whole one of the step, the one against the start of the step.
        double const drive = (r.change[d] - halt[d]) * at.velocity[d];
        double const middle = at.velocity[d] - 0.5 * r.change[d];
        // Particles that take over the nodes' velocity lose what the nodes do.
        double const rubbed = scratch.of[f].rubs ? scratch.of[f].rub.data()[at.node][d] : 0.0;
        double const lost_by_node = drive - r.change[d] * middle + work_before - rubbed * (at.velocity[d] - middle);
        if (w.affine[f] == 0 || w.shared[f] != 0) {
          given.drive += own * drive;
        } else if (w.heats[f] != 0) {
          r.change[3] += m * lost_by_node;
        } else {
          given.drive += own * lost_by_node;
        }
        halt[d] = r.change[d];
        // What walls rub off while the node moves along is theirs, the constraint does all the rest.
        if (rubbed != 0.0) {
          NodeVelocity& rub = scratch.of[f].rub.data()[at.node];
          rub[d] -= rubbed;
          rub[3] += rubbed * middle;
          if (w.affine[f] == 0) given.friction -= own * rubbed * at.velocity[d];
        }
        if (scratch.of[f].stops) scratch.of[f].stop.data()[at.node][d] = 0.0;
      }
      // What slips along the body stays at its surface.
      for (int g = 0; g < w.fields; ++g) {
        if (!w.slips_along(g, f) || !scratch.of[g].present) continue;
        NodeMotion& fluid = scratch.of[g].motion.data()[at.node];
        double const own_fluid = w.own_mass(block, g, at.node);
        Vec3 const change = follow(w.mass_floor, scratch.of[f].gradient.data()[at.node], r.velocity, fluid.velocity);
        for (int d = 0; d < 3; ++d) {
          fluid.change[d] += change[d];
          fluid.velocity[d] += change[d];
          given.impulse[d] += own_fluid * change[d];
          given.work += own_fluid * change[d] * r.velocity[d];
        }
        fluid.change[3] += 0.5 * fluid.velocity[3] *
                           dot(change, {fluid.change[0], fluid.change[1], fluid.change[2]});  // as in contact
      }
    }
  }
}

/// Particles of APIC take over a velocity: the energy per mass that friction gives goes beside its change of that of
/// the nodes, the particles' own one before knows nothing of it.
void Mpm::note_rubbing(int count, Scratch& scratch) const {
  for (int f = 0; f < work_->fields; ++f) {
    FieldScratch& s = scratch.of[f];
    if (work_->affine[f] == 0 || !s.rubs) continue;
    NodeVelocity* rub = s.rub.data();
    NodeVelocity const* keep = s.meets ? s.keep.data() : nullptr;
    for (int node = 0; node < count; ++node) {
      NodeVelocity& change = rub[node];
      NodeMotion const& r = s.motion.data()[node];
      NodeVelocity const v = keep == nullptr ? r.velocity : r.velocity + keep[node];
      for (int d = 0; d < 3; ++d) change[3] += change[d] * (v[d] - 0.5 * r.change[d]);
    }
  }
}

void Mpm::constrain_velocity(int block, double dt, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    if (!scratch.of[f].present || !w.rigid[f]) continue;
    NodeVelocity* nodes = scratch.of[f].velocity.data();
    for (int node = 0; node < count; ++node) {
      for (int d = 0; d < 3; ++d) nodes[node][d] = (*w.rigid[f])[d];
    }
  }
  if (w.contact) {
    struct Access {
      Scratch* s;
      bool present(int f) const { return s->of[f].present; }
      double mass(int f, int node) const { return s->of[f].velocity.data()[node][3]; }
      double whole(int f, int node) const { return s->of[f].wholes ? s->of[f].whole.data()[node] : mass(f, node); }
      Vec3 get(int f, int node) const {
        NodeVelocity const& v = s->of[f].velocity.data()[node];
        return {v[0], v[1], v[2]};
      }
      void set(int f, int node, Vec3 const& v) const {
        for (int d = 0; d < 3; ++d) s->of[f].velocity.data()[node][d] = v[d];
      }
      void give(int /*fluid*/, int /*body*/, int /*node*/, Vec3 const& /*impulse*/) const {}  // the momentum's counts
      NodeVelocity const& gradient(int f, int node) const { return s->of[f].gradient.data()[node]; }
    };
    meet_velocity(block, scratch);
    make_compatible({count, w.fields, w.mass_floor, &w.laws, &w.rigid, &w.slips}, Access{&scratch});
    mirror_fluids(block, scratch, false);
  }
  stop_velocity_at_walls(block, dt, scratch);
  for (ConstrainedNode const& at : w.constrained_nodes[block]) {
    for (int f = 0; f < w.fields; ++f) {
      if (!scratch.of[f].present || w.rigid[f] || !w.constrains(f, at)) continue;
      NodeVelocity& v = scratch.of[f].velocity.data()[at.node];
      for (int d = 0; d < 3; ++d) {
        if (at.components[d]) v[d] = at.velocity[d];
      }
      for (int g = 0; g < w.fields; ++g) {
        if (!w.slips_along(g, f) || !scratch.of[g].present) continue;
        NodeVelocity& fluid = scratch.of[g].velocity.data()[at.node];
        Vec3 const change = follow(w.mass_floor, scratch.of[f].gradient.data()[at.node], v, fluid);
        for (int d = 0; d < 3; ++d) fluid[d] += change[d];
      }
    }
  }
}

}  // namespace brisance::mpm
