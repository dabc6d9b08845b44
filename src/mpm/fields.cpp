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
        scratch.pushes.push_back({g, f, node, {dt * push[0], dt * push[1], dt * push[2]}});
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

/// What the pressure at the surface of a body takes from the one it should give to the other, and does not, as their
/// velocities differ: where the fluid does not feel the body yet, or before the forces of the step made them alike. The
/// fluid has it as heat; it may be negative.
void Mpm::settle_pushes(Scratch& scratch) {
  for (Push const& push : scratch.pushes) {
    NodeState& fluid = scratch.state[push.fluid].data()[push.node];
    NodeState const& body = scratch.state[push.body].data()[push.node];
    double work = 0.0;
    for (int d = 0; d < 3; ++d) {
      double const of_fluid = fluid.momentum[d] - 0.5 * fluid.force[d];
      double const of_body = body.momentum[d] - 0.5 * body.force[d];
      work += push.impulse[d] * (of_fluid - of_body);
    }
    fluid.force[3] -= work;
  }
}

void Mpm::map_extents() {
  Workspace& w = *work_;
  double const h = grid_.domain().h;
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Patch const& patch = w.patches[block];
    Scratch& scratch = w.scratch[thread];
    gather_gradients(block, scratch);
    for (int f = 0; f < w.fields; ++f) {
      int const slot = w.slot(block, f);
      if (w.present[slot] == 0 || w.slips[f] != 0) continue;
      std::vector<Vec3>& normals = scratch.normals;
      normals.assign(patch.count(), Vec3{0.0, 0.0, 0.0});
      bool any = false;
      for (int node = 0; node < patch.count(); ++node) {
        NodeVelocity others{};
        bool met = false;
        bool rigid = false;
        for (int g = 0; g < w.fields; ++g) {
          if (g == f || w.slips[g] != 0 || scratch.present[g] == 0) continue;
          NodeVelocity const& gradient = scratch.gradient[g].data()[node];
          others += gradient;
          rigid = rigid || w.rigid[g].has_value();
          met = met || gradient[0] != 0.0 || gradient[1] != 0.0 || gradient[2] != 0.0;
        }
        if (!met) continue;
        normals[node] = contact_normal(scratch.gradient[f].data()[node], w.rigid[f].has_value(), others, rigid);
        any = true;
      }
      double* extents = w.extent[slot].get(patch.count());
      std::fill(extents, extents + patch.count(), -std::numeric_limits<double>::max());
      if (!any) continue;
      for_sets(block, [&](PointSet& set, int body) {
        if (w.field_of[body] != f) return;
        SetView const view{&set, &bodies_[body], &patch, h};
        with_kernels(options_.shape, patch.dimensions,
                     [&](auto kernels) { kernels.map_extent(view, grid_.domain().geometry, normals.data(), extents); });
      });
    }
  });
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
      void push(int f, int node, Vec3 const& v, Vec3 const& /*by*/) const { set(f, node, v); }
      void part(int /*f*/, int /*node*/, Parting const& /*change*/) const {}  // see `settle_contacts`
      void meet(Meeting const& /*meeting*/) const {}
      void heat(int /*f*/, int /*node*/, double /*energy*/) const {}  // that of the momentum is what counts
      Vec3 changed(int /*f*/, int /*node*/) const { return {0.0, 0.0, 0.0}; }
      NodeVelocity const& gradient(int f, int node) const { return s->gradient[f].data()[node]; }
      double extent(int /*f*/, int /*node*/) const { return 0.0; }
    };
    make_compatible({count, w.fields, w.mass_floor, &scratch.present, &w.laws, &w.rigid, &w.slips, false},
                    Access{&scratch});
    for (Meeting const& m : w.meetings[block]) {
      NodeVelocity& a = scratch.velocity[m.first].data()[m.node];
      NodeVelocity& b = scratch.velocity[m.second].data()[m.node];
      if (!(a[3] > w.mass_floor) || !(b[3] > w.mass_floor)) continue;
      double closing = 0.0;
      for (int d = 0; d < 3; ++d) closing += (a[d] - b[d]) * m.normal[d];
      bool const rigid = w.rigid[m.first] || w.rigid[m.second];
      double const sa = rigid ? m.first_share : b[3] / (a[3] + b[3]);
      double const sb = rigid ? m.second_share : 1.0 - sa;
      for (int d = 0; d < 3; ++d) {
        a[d] -= sa * closing * m.normal[d];
        b[d] += sb * closing * m.normal[d];
      }
    }
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

void Mpm::gather_extents(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  Patch const& patch = w.patches[block];
  for (int f = 0; f < w.fields; ++f) {
    if (scratch.present[f] == 0 || w.slips[f] != 0) continue;
    double* extents = scratch.extent[f].get(patch.count());
    std::fill(extents, extents + patch.count(), -std::numeric_limits<double>::max());
    for (Link const& link : patch.links) {
      int const slot = w.slot(link.source, f);
      if (w.present[slot] == 0) continue;
      double const* from = w.extent[slot].data();
      for (int k = link.lower[2]; k <= link.upper[2]; ++k) {
        for (int j = link.lower[1]; j <= link.upper[1]; ++j) {
          for (int i = link.lower[0]; i <= link.upper[0]; ++i) {
            double& to = extents[patch.index(i, j, k)];
            to = std::max(to, from[link.source_index(i, j, k)]);
          }
        }
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

/// Work that rigid bodies in motion do by contact: the points do not have it to lose.
Dissipation Mpm::pushed_by_rigid(int block, Scratch const& scratch) const {
  Workspace const& w = *work_;
  Dissipation work;
  if (!w.pushes || w.meetings[block].empty()) return work;
  for (int f = 0; f < w.fields; ++f) {
    if (scratch.meets[f] == 0) continue;
    NodeVelocity const* meet = scratch.meet[f].data();
    NodeVelocity const* rub = scratch.rub[f].data();
    for (int node = 0; node < w.patches[block].count(); ++node) {
      // One rigid body per node, as where contact gives its work. Between two that are not rigid the sum cancels.
      for (int g = 0; g < w.fields; ++g) {
        if (!w.rigid[g] || scratch.present[g] == 0 || !(scratch.state[g].data()[node].momentum[3] > 0.0)) continue;
        Vec3 const& v = *w.rigid[g];
        double const mass = w.own_mass(block, f, node);
        work.contact += mass * (meet[node][0] * v[0] + meet[node][1] * v[1] + meet[node][2] * v[2]);
        work.friction += mass * (rub[node][0] * v[0] + rub[node][1] * v[1] + rub[node][2] * v[2]);
        break;
      }
    }
  }
  return work;
}

/// The energy per mass that contact and the friction of walls give the nodes of a field goes beside the change of
/// velocity: points of APIC take over the nodes' velocity, and their own one before knows nothing of it.
void Mpm::note_contact_work(int count, Scratch& scratch) const {
  for (int f = 0; f < work_->fields; ++f) {
    if (work_->affine[f] == 0) continue;
    auto const note = [&](NodeVelocity* changes) {
      NodeState const* nodes = scratch.state[f].data();
      for (int node = 0; node < count; ++node) {
        NodeVelocity& change = changes[node];
        NodeState const& r = nodes[node];
        for (int d = 0; d < 3; ++d) change[3] += change[d] * (r.momentum[d] - 0.5 * r.force[d]);
      }
    };
    if (scratch.meets[f] != 0) note(scratch.meet[f].data());
    if (scratch.rubs[f] != 0) note(scratch.rub[f].data());
  }
}

/// Contact makes the nodes' velocities compatible, but it is the points that get the change, and of what they map back
/// the nodes see a smoothed picture: the surfaces still close in on each other there, or part although they have
/// pushed. The impulses of the step, between the fields whose points map back, are settled once more by that picture,
/// and the points get the difference. Contact does the work J . (v_0 + v_1)/2 on the points, with v_0 and v_1 the
/// relative velocities that they map to the nodes before and after: without this surfaces that part are pushed on, and
/// the work is positive. Every pass brings the impulses closer to those at which J . v_1 vanishes.
void Mpm::settle_contacts() {
  return;
  // One pass leaves a loss, most of the time; where contact has made energy all the same, oblique surfaces for one,
  // more passes take it back. With sixteen what is made stays below 0.3 % of the energy of two discs, with eight it is
  // 0.5 %, with one 2 %.
  constexpr int most = 16;
  int const passes = dissipation_.contact < 0.0 ? most : 1;
  for (int pass = 0; pass < passes; ++pass) settle_contacts(pass + 1 < passes || options_.order != StressOrder::usf);
}

void Mpm::settle_contacts(bool map_again) {
  Workspace& w = *work_;
  PhaseTimer const timer(timings_["contact"]);
  double const h = grid_.domain().h;
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    if (w.meetings[block].empty()) return;
    int const count = w.patches[block].count();
    Scratch& scratch = w.scratch[thread];
    gather_velocity(block, scratch);
    clear_contacts(scratch, count);
    for (Meeting& meeting : w.meetings[block]) {
      int const a = meeting.first;
      int const b = meeting.second;
      if (w.settles[a] == 0 || w.settles[b] == 0) continue;
      NodeVelocity const& va = scratch.velocity[a].data()[meeting.node];
      NodeVelocity const& vb = scratch.velocity[b].data()[meeting.node];
      // What was changed before at this node counts.
      auto const velocity = [&](int f, NodeVelocity const& v) {
        if (w.rigid[f]) return *w.rigid[f];
        NodeVelocity const& meet = scratch.meet[f].data()[meeting.node];
        NodeVelocity const& rub = scratch.rub[f].data()[meeting.node];
        return Vec3{v[0] + meet[0] + rub[0], v[1] + meet[1] + rub[1], v[2] + meet[2] + rub[2]};
      };
      double const share_a = meeting.first_share;
      double const share_b = meeting.second_share;
      double const mass = w.rigid[a] ? vb[3] * share_b : va[3] * share_a;
      Parting const parting = settle(meeting, velocity(a, va) - velocity(b, vb), mass);
      for (int d = 0; d < 3; ++d) {
        scratch.meet[a].data()[meeting.node][d] -= share_a * parting.across[d];
        scratch.meet[b].data()[meeting.node][d] += share_b * parting.across[d];
        scratch.rub[a].data()[meeting.node][d] -= share_a * parting.along[d];
        scratch.rub[b].data()[meeting.node][d] += share_b * parting.along[d];
      }
      if (!w.rigid[a] && !w.rigid[b]) continue;
      Vec3 const& pusher = w.rigid[a] ? *w.rigid[a] : *w.rigid[b];
      // By the mass of the block's own points, as `Workspace::own_mass`, where they are now.
      int const slot = w.slot(block, w.rigid[a] ? b : a);
      double const own = w.present[slot] != 0 ? w.velocity[slot].data()[meeting.node][3] : 0.0;
      double const given = w.rigid[a] ? own * share_b : -own * share_a;
      Vec3 const change = parting.across + parting.along;
      w.impulse[block] = w.impulse[block] + given * change;
      w.work[block] += given * dot(change, pusher);
      w.dissipation[block].contact += given * dot(parting.across, pusher);
      w.dissipation[block].friction += given * dot(parting.along, pusher);
    }
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
      int const f = w.field_of[body];
      PointSet& set = points(block, body);
      if (set.empty() || scratch.meets[f] == 0 || w.settles[f] == 0 || w.rigid[f]) continue;
      SetView const view{&set, &bodies_[body], &w.patches[block], h};
      with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) {
        NodeVelocity const* pull = books_work(body) ? nullptr : w.pull[w.slot(block, f)].data();
        w.dissipation[block] += kernels.push(view, scratch.meet[f].data(), scratch.rub[f].data(), pull);
      });
    }
  });
  if (!map_again) return;
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    int const block = active_[n];
    if (w.meetings[block].empty()) return;
    clear_velocity(block);
    for_sets(block, [&](PointSet& set, int body) {
      SetView const view{&set, &bodies_[body], &w.patches[block], h};
      with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) {
        kernels.map_velocity(view, Field::velocity_x, w.velocity[w.slot(block, w.field_of[body])].data());
      });
    });
  });
}

/// No contact has changed anything at the nodes yet.
void Mpm::clear_contacts(Scratch& scratch, int count) const {
  for (int f = 0; f < work_->fields; ++f) {
    scratch.meets[f] = scratch.rubs[f] = work_->touches && work_->parts[f] != 0 && scratch.present[f] != 0 ? 1 : 0;
    if (scratch.meets[f] == 0) continue;
    for (NodeArray<NodeVelocity>* part : {&scratch.meet[f], &scratch.rub[f]}) {
      NodeVelocity* nodes = part->get(count);
      std::fill(nodes, nodes + count, NodeVelocity{});
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
  clear_contacts(scratch, count);
  w.meetings[block].clear();
  if (w.contact) {
    struct Access {
      Scratch* s;
      std::vector<Meeting>* meetings;
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
        NodeState const& r = s->state[f].data()[node];
        push(f, node, v, {v[0] - r.momentum[0], v[1] - r.momentum[1], v[2] - r.momentum[2]});
      }
      void push(int f, int node, Vec3 const& v, Vec3 const& by) const {
        NodeState& r = s->state[f].data()[node];
        for (int d = 0; d < 3; ++d) {
          double const change = by[d];
          r.force[d] += change;
          r.momentum[d] = v[d];
          if (!workspace->pushes) continue;
          // Between two bodies that are not rigid these cancel.
          double const impulse = workspace->own_mass(block, f, node) * change;
          given->impulse[d] += impulse;
          if (Vec3 const* pusher = rigid_at(node)) given->work += impulse * (*pusher)[d];
        }
      }
      void part(int f, int node, Parting const& change) const {
        if ((*rigid)[f]) return;
        for (int d = 0; d < 3; ++d) {
          s->meet[f].data()[node][d] += change.across[d];
          s->rub[f].data()[node][d] += change.along[d];
        }
      }
      void meet(Meeting const& meeting) const { meetings->push_back(meeting); }
      Vec3 changed(int f, int node) const {
        Lanes4 const& v = s->state[f].data()[node].force;
        return {v[0], v[1], v[2]};
      }
      void heat(int f, int node, double energy) const { s->state[f].data()[node].force[3] += energy; }
      /// Velocity of the rigid body that reaches the node, or null.
      Vec3 const* rigid_at(int node) const {
        for (std::size_t g = 0; g < rigid->size(); ++g) {
          if ((*rigid)[g] && s->present[g] != 0 && mass(static_cast<int>(g), node) > 0.0) return &*(*rigid)[g];
        }
        return nullptr;
      }
      NodeVelocity const& gradient(int f, int node) const { return s->gradient[f].data()[node]; }
      double extent(int f, int node) const { return s->extent[f].data()[node]; }
    };
    constexpr double touch = 1e-6;  // cells: bodies that are placed side by side touch, whatever the round-off
    // Cells. A node that a rigid body reaches with its outermost points only feels it as it feels any body: by its
    // mass. Held there altogether, a disc that rolls cannot turn within a cell of the ground and loses 4 % of its way.
    // Every surface has nodes that are nearer.
    constexpr double near = 0.75;
    make_compatible({count, w.fields, w.mass_floor, &scratch.present, &w.laws, &w.rigid, &w.slips, true,
                     touch * grid_.domain().h, near * grid_.domain().h},
                    Access{&scratch, &w.meetings[block], &w.rigid, &w, block, &given});
    mirror_fluids(block, scratch, true);
    if (w.meetings[block].empty()) {
      std::fill(scratch.meets.begin(), scratch.meets.end(), 0);
      std::fill(scratch.rubs.begin(), scratch.rubs.end(), 0);
    }
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.meets[f] == 0) continue;
      NodeVelocity* pull = w.pull[w.slot(block, f)].get(count);
      NodeState const* nodes = scratch.state[f].data();
      NodeVelocity const* meet = scratch.meet[f].data();
      NodeVelocity const* rub = scratch.rub[f].data();
      for (int node = 0; node < count; ++node) pull[node] = nodes[node].force - meet[node] - rub[node];
    }
  }
  w.dissipation[block] = pushed_by_rigid(block, scratch);
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
        // What contact gives while the node moves along is its own.
        ContactChange const taken =
            take_contact(scratch, f, hold.node, d, contact_at(scratch, f, hold.node, d), middle);
        // Points that take over the nodes' velocity lose what the nodes do.
        double const lost_by_node =
            drive - r.force[d] * middle + work_before - taken.sum() * (hold.velocity[d] - middle);
        if (w.affine[f] == 0 || w.shared[f] != 0) {
          given.drive += own * drive;
        } else if (w.heats[f] != 0) {
          r.force[3] += m * lost_by_node;
        } else {
          given.drive += own * lost_by_node;
        }
        halt[d] = r.force[d];
        // The constraint does all the rest.
        if (w.affine[f] == 0) given.take(taken, own * hold.velocity[d]);
        if (scratch.meets[f] != 0) w.pull[w.slot(block, f)].data()[hold.node][d] = 0.0;
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
  w.dissipation[block].held = given.drive;
  w.dissipation[block].contact += given.contact;
  w.dissipation[block].friction += given.friction;
  note_contact_work(count, scratch);
}

}  // namespace brisance::mpm
