/// Which bodies meet at the nodes: how far their particles reach along the surfaces' normals, and whether they close in
/// on each other there. What contact does with it is in contact.cpp.
#include <algorithm>
#include <limits>

#include "core/parallel.hpp"
#include "mpm/contact.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

Vec3 times(Vec3 const& a, Vec3 const& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }

}  // namespace

void Mpm::map_extents() {
  Workspace& w = *work_;
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
          if (g == f || w.slips[g] != 0 || !scratch.of[g].present) continue;
          NodeVelocity const& gradient = scratch.of[g].gradient.data()[node];
          others += gradient;
          rigid = rigid || w.rigid[g].has_value();
          met = met || gradient[0] != 0.0 || gradient[1] != 0.0 || gradient[2] != 0.0;
        }
        if (!met) continue;
        normals[node] = contact_normal(scratch.of[f].gradient.data()[node], w.rigid[f].has_value(), others, rigid);
        any = true;
      }
      double* extents = w.extent[slot].get(patch.count());
      std::fill(extents, extents + patch.count(), -std::numeric_limits<double>::max());
      if (!any) continue;
      for_sets(block, [&](ParticleSet& set, int body) {
        if (w.field_of[body] != f) return;
        SetView const view{&set, &bodies_[body], &patch, patch.h};
        with_kernels(options_.shape, patch.dimensions,
                     [&](auto kernels) { kernels.map_extent(view, grid_.domain().geometry, normals.data(), extents); });
      });
    }
  });
}

void Mpm::gather_extents(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  Patch const& patch = w.patches[block];
  for (int f = 0; f < w.fields; ++f) {
    if (!scratch.of[f].present || w.slips[f] != 0) continue;
    double* extents = scratch.of[f].extent.get(patch.count());
    std::fill(extents, extents + patch.count(), -std::numeric_limits<double>::max());
    for (Link const& link : patch.links) {
      int const slot = w.slot(link.source, f);
      if (w.present[slot] == 0) continue;
      double const* from = w.extent[slot].data();
      for_each_cell(link.to, [&](Index3 const& node) {
        double& to = extents[patch.index(node)];
        to = std::max(to, from[link.source_index(node)]);
      });
    }
  }
}

/// Which bodies touch at the nodes of a block and close in on each other there; `trial(f, node)` is a field's velocity
/// with the forces of the step.
template <class Trial>
void Mpm::find_meetings(int block, double dt, Scratch& scratch, Trial&& trial) const {
  constexpr int sweeps = 3;
  Workspace& w = *work_;
  std::vector<Meeting>& meetings = w.meetings[block];
  meetings.clear();
  scratch.trial.resize(w.fields);
  for (int node = 0; node < w.patches[block].count(); ++node) {
    auto const there = [&](int f) {
      return scratch.of[f].present && scratch.of[f].sums.data()[node].momentum[3] > w.mass_floor;
    };
    int met = 0;
    for (int f = 0; f < w.fields; ++f) met += w.parts[f] != 0 && there(f) ? 1 : 0;
    if (met < 2) continue;
    for (int f = 0; f < w.fields; ++f) {
      if (w.parts[f] != 0 && there(f)) scratch.trial[f] = trial(f, node);
    }
    std::size_t const first_here = meetings.size();
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      std::size_t const found = meetings.size();
      for (int a = 0; a < w.fields; ++a) {
        if (w.parts[a] == 0 || !there(a)) continue;
        for (int b = a + 1; b < w.fields; ++b) {
          if (w.laws[a * w.fields + b].kind != Law::Kind::contact || !there(b)) continue;
          find_meeting(block, dt, node, a, b, first_here, scratch);
        }
      }
      // What one pair changes may close another gap.
      if (met == 2 || meetings.size() == found) break;
    }
  }
}

/// Adds a meeting of two fields at a node, if they do and are not among those from `first_here` on, and takes their
/// closing velocity off the trial velocities.
void Mpm::find_meeting(int block, double dt, int node, int a, int b, std::size_t first_here, Scratch& scratch) const {
  // Cells: bodies that are placed side by side touch, whatever the round-off.
  constexpr double touch = 1e-6;
  // Cells. A node that a rigid body reaches with its outermost particles only feels it as it feels any body: by its
  // mass. Held there altogether, a disc that rolls cannot turn within a cell of the ground and loses 4 % of its way.
  // Every surface has nodes that are nearer.
  constexpr double near = 0.75;
  Workspace& w = *work_;
  double const h = w.patches[block].h;
  std::vector<Meeting>& meetings = w.meetings[block];
  auto const same = [&](Meeting const& m) { return m.first.field == a && m.second.field == b; };
  if (std::any_of(meetings.begin() + static_cast<std::ptrdiff_t>(first_here), meetings.end(), same)) return;
  double const reach_a = scratch.of[a].extent.data()[node];
  double const reach_b = scratch.of[b].extent.data()[node];
  if (!(reach_a + reach_b >= -touch * h)) return;
  Meeting meeting;
  meeting.node = node;
  meeting.friction = w.laws[a * w.fields + b].friction;
  meeting.normal = contact_normal(scratch.of[a].gradient.data()[node], w.rigid[a].has_value(),
                                  scratch.of[b].gradient.data()[node], w.rigid[b].has_value());
  if (meeting.normal == Vec3{0.0, 0.0, 0.0}) return;
  // As in the other pairs at the node, if there are any: what is prescribed hangs on the velocity.
  auto const known = [&](int field) {
    for (std::size_t n = first_here; n < meetings.size(); ++n) {
      for (Partner const* one : {&meetings[n].first, &meetings[n].second}) {
        if (one->field == field) return *one;
      }
    }
    return partner(block, field, node, dt, scratch);
  };
  meeting.first = known(a);
  meeting.second = known(b);
  auto const mass = [&](int f) { return scratch.of[f].sums.data()[node].momentum[3]; };
  if (w.rigid[a] && reach_a < -near * h) meeting.slack = 1.0 / mass(a);
  if (w.rigid[b] && reach_b < -near * h) meeting.slack = 1.0 / mass(b);
  for (Partner const* one : {&meeting.first, &meeting.second}) {
    for (int d = 0; d < 3; ++d) {
      if (one->yields[d] == 0.0) scratch.trial[one->field][d] = one->prescribed[d];
    }
  }
  double const closing = dot(scratch.trial[a] - scratch.trial[b], meeting.normal);
  double const yields = meeting.yields(meeting.normal);
  if (!(closing > 0.0) || !(yields > 0.0)) return;
  Vec3 const impulse = (closing / yields) * meeting.normal;
  scratch.trial[a] = scratch.trial[a] - times(meeting.first.yields, impulse);
  scratch.trial[b] = scratch.trial[b] + times(meeting.second.yields, impulse);
  meetings.push_back(meeting);
}

/// A body at a node: what yields to contact there, and what something prescribes.
Partner Mpm::partner(int block, int field, int node, double dt, Scratch const& scratch) const {
  Workspace const& w = *work_;
  Partner one;
  one.field = field;
  one.mass = scratch.of[field].sums.data()[node].momentum[3];
  if (w.rigid[field]) {
    one.prescribed = *w.rigid[field];
    return one;
  }
  one.yields.fill(1.0 / one.mass);
  if (w.one_sided[field] != 0) {
    Patch const& patch = w.patches[block];
    for (std::size_t n = 0; n < w.walls[block].size(); ++n) {
      WallFace const& wall = w.walls[block][n];
      int const d = wall.direction;
      if (patch.along(d, node) != wall.plane) continue;
      double const gap = scratch.of[field].gap.data()[n * static_cast<std::size_t>(patch.count()) + node];
      if (gap == no_gap) continue;
      double const into = -std::max(0.0, gap) / dt;
      if (wall.inwards * scratch.trial[field][d] > into) continue;
      one.yields[d] = 0.0;
      one.prescribed[d] = wall.inwards * into;
    }
  }
  if (w.is_constrained[block].empty() || w.is_constrained[block][node] == 0) return one;
  for (ConstrainedNode const& constrained : w.constrained_nodes[block]) {
    if (constrained.node != node || !w.constrains(field, constrained)) continue;
    for (int d = 0; d < 3; ++d) {
      if (!constrained.components[d]) continue;
      one.yields[d] = 0.0;
      one.prescribed[d] = constrained.velocity[d];
    }
  }
  return one;
}

void Mpm::find_meetings(int block, double dt, Scratch& scratch, bool from_sums) const {
  find_meetings(block, dt, scratch, [&](int f, int node) {
    if (!from_sums) {
      NodeVelocity const& v = scratch.of[f].motion.data()[node].velocity;
      return Vec3{v[0], v[1], v[2]};
    }
    NodeSums const& r = scratch.of[f].sums.data()[node];
    double const scale = 1.0 / r.momentum[3];
    Vec3 v{};
    for (int d = 0; d < 3; ++d) v[d] = scale * r.momentum[d] + dt * scale * r.force[d];
    return v;
  });
}

}  // namespace brisance::mpm
