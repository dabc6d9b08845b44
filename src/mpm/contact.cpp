/// Contact of bodies that have grid fields of their own, [Bardenhagen01]: where two of them meet in a node, their
/// surfaces touch there and close in on each other, the nodes move as one along the normal, with Coulomb friction
/// across it.
///
/// The nodes do, and strain the points; the points themselves keep their velocities. What they get of the step are
/// forces, and of these contact takes what would accelerate the surfaces against each other: with P the projection of
/// the nodes' velocities on those that close nothing, orthogonal in the metric of the masses, the points are strained
/// with P v and get the changes P f of their velocities. Then the stress works as much as the points lose, since
/// f . P v = P f . v: contact conserves energy, whatever the bodies' speed and the size of the cells. Taking the
/// velocities themselves to P v is a plastic impact of the nodes' masses: it loses 4 % of the energy of two discs of 8
/// cells per radius, and up to 15 % of that of a plate six cells thick.
#include "mpm/contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Calls work(begin, end) for the meetings of each node.
template <class Work>
void for_nodes(std::vector<Meeting> const& meetings, Work&& work) {
  std::size_t begin = 0;
  while (begin < meetings.size()) {
    std::size_t end = begin + 1;
    while (end < meetings.size() && meetings[end].node == meetings[begin].node) ++end;
    work(begin, end);
    begin = end;
  }
}

/// How much the relative velocity of one pair at a node changes along its normal per impulse of another [1/kg].
double answers(Meeting const& m, Meeting const& other) {
  double sum = 0.0;
  for (bool const first : {true, false}) {
    Partner const& one = first ? m.first : m.second;
    for (bool const others_first : {true, false}) {
      if (one.field != (others_first ? other.first : other.second).field) continue;
      double along = 0.0;
      for (int d = 0; d < 3; ++d) along += m.normal[d] * one.yields[d] * other.normal[d];
      sum += first == others_first ? along : -along;
    }
  }
  return sum;
}

/// From the closing velocities of the pairs that meet at a node to the impulses along their normals that stop them all
/// at once, `values` in and out; `matrix` is room for it. By LDL^T: it is symmetric and positive semidefinite, and of
/// pairs that depend on others, which the others stop, the impulse is 0.
void stop(Meeting const* pairs, int count, double* values, std::vector<double>& matrix) {
  constexpr double dependent = 1e-10;
  if (count == 1) {
    values[0] /= pairs[0].yields(pairs[0].normal);
    return;
  }
  matrix.assign(static_cast<std::size_t>(count) * count, 0.0);
  auto const at = [&](int i, int j) -> double& { return matrix[static_cast<std::size_t>(i) * count + j]; };
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j <= i; ++j) at(i, j) = answers(pairs[i], pairs[j]) + (i == j ? pairs[i].slack : 0.0);
  }
  // In the lower half: L below the diagonal, 1/D on it.
  for (int j = 0; j < count; ++j) {
    double const whole = at(j, j);
    for (int k = 0; k < j; ++k) {
      if (at(k, k) != 0.0) at(j, j) -= at(j, k) * at(j, k) / at(k, k);
    }
    at(j, j) = at(j, j) > dependent * whole ? 1.0 / at(j, j) : 0.0;
    for (int i = j + 1; i < count; ++i) {
      double sum = at(i, j);
      for (int k = 0; k < j; ++k) {
        if (at(k, k) != 0.0) sum -= at(i, k) * at(j, k) / at(k, k);
      }
      at(i, j) = sum * at(j, j);
    }
  }
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < i; ++k) values[i] -= at(i, k) * values[k];
  }
  for (int i = count - 1; i >= 0; --i) {
    values[i] *= at(i, i);
    for (int k = i + 1; k < count; ++k) values[i] -= at(i, i) != 0.0 ? at(k, i) * values[k] : 0.0;
  }
}

Vec3 times(Vec3 const& a, Vec3 const& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }

}  // namespace

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
      for_sets(block, [&](PointSet& set, int body) {
        if (w.field_of[body] != f) return;
        SetView const view{&set, &bodies_[body], &patch, h};
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

/// Which bodies touch at the nodes of a block and close in on each other there; `trial(f, node)` is a field's velocity
/// with the forces of the step.
template <class Trial>
void Mpm::find_meetings(int block, double dt, Scratch& scratch, Trial&& trial) const {
  // Cells: bodies that are placed side by side touch, whatever the round-off.
  constexpr double touch = 1e-6;
  // Cells. A node that a rigid body reaches with its outermost points only feels it as it feels any body: by its mass.
  // Held there altogether, a disc that rolls cannot turn within a cell of the ground and loses 4 % of its way. Every
  // surface has nodes that are nearer.
  constexpr double near = 0.75;
  constexpr int sweeps = 3;
  Workspace& w = *work_;
  Patch const& patch = w.patches[block];
  double const h = grid_.domain().h;
  std::vector<Meeting>& meetings = w.meetings[block];
  meetings.clear();
  auto const mass = [&](int f, int node) { return scratch.of[f].sums.data()[node].momentum[3]; };
  for (int node = 0; node < patch.count(); ++node) {
    int met = 0;
    for (int f = 0; f < w.fields; ++f) {
      met += w.parts[f] != 0 && scratch.of[f].present && mass(f, node) > w.mass_floor ? 1 : 0;
    }
    if (met < 2) continue;
    std::size_t const first_here = meetings.size();
    scratch.trial.resize(w.fields);
    for (int f = 0; f < w.fields; ++f) {
      if (w.parts[f] != 0 && scratch.of[f].present && mass(f, node) > w.mass_floor) scratch.trial[f] = trial(f, node);
    }
    std::size_t found = 0;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      for (int a = 0; a < w.fields; ++a) {
        if (w.parts[a] == 0 || !scratch.of[a].present || !(mass(a, node) > w.mass_floor)) continue;
        for (int b = a + 1; b < w.fields; ++b) {
          Law const& law = w.laws[a * w.fields + b];
          if (law.kind != Law::Kind::contact || !scratch.of[b].present || !(mass(b, node) > w.mass_floor)) continue;
          auto const same = [&](Meeting const& m) { return m.first.field == a && m.second.field == b; };
          if (std::any_of(meetings.begin() + static_cast<std::ptrdiff_t>(first_here), meetings.end(), same)) continue;
          double const reach_a = scratch.of[a].extent.data()[node];
          double const reach_b = scratch.of[b].extent.data()[node];
          if (!(reach_a + reach_b >= -touch * h)) continue;
          Meeting meeting;
          meeting.node = node;
          meeting.friction = law.friction;
          meeting.normal = contact_normal(scratch.of[a].gradient.data()[node], w.rigid[a].has_value(),
                                          scratch.of[b].gradient.data()[node], w.rigid[b].has_value());
          if (meeting.normal == Vec3{0.0, 0.0, 0.0}) continue;
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
          if (w.rigid[a] && reach_a < -near * h) meeting.slack = 1.0 / mass(a, node);
          if (w.rigid[b] && reach_b < -near * h) meeting.slack = 1.0 / mass(b, node);
          for (Partner const* one : {&meeting.first, &meeting.second}) {
            for (int d = 0; d < 3; ++d) {
              if (one->yields[d] == 0.0) scratch.trial[one->field][d] = one->prescribed[d];
            }
          }
          double const closing = dot(scratch.trial[a] - scratch.trial[b], meeting.normal);
          double const yields = meeting.yields(meeting.normal);
          if (!(closing > 0.0) || !(yields > 0.0)) continue;
          Vec3 const impulse = (closing / yields) * meeting.normal;
          scratch.trial[a] = scratch.trial[a] - times(meeting.first.yields, impulse);
          scratch.trial[b] = scratch.trial[b] + times(meeting.second.yields, impulse);
          meetings.push_back(meeting);
        }
      }
      // What one pair changes may close another gap.
      if (met == 2 || meetings.size() - first_here == found) break;
      found = meetings.size() - first_here;
    }
  }
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
      if (node / patch.stride(d) % patch.n[d] != wall.plane) continue;
      double const gap = scratch.of[field].gap.data()[n * static_cast<std::size_t>(patch.count()) + node];
      if (gap == std::numeric_limits<double>::max()) continue;
      double const into = -std::max(0.0, gap) / dt;
      if (wall.inwards * scratch.trial[field][d] > into) continue;
      one.yields[d] = 0.0;
      one.prescribed[d] = wall.inwards * into;
    }
  }
  if (w.has_hold[block].empty() || w.has_hold[block][node] == 0) return one;
  for (Hold const& hold : w.holds[block]) {
    if (hold.node != node || !w.held(field, hold)) continue;
    for (int d = 0; d < 3; ++d) {
      if (!hold.held[d]) continue;
      one.yields[d] = 0.0;
      one.prescribed[d] = hold.velocity[d];
    }
  }
  return one;
}

/// No contact has changed anything at the nodes yet.
void Mpm::clear_contacts(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  bool const any = w.touches && !w.meetings[block].empty();
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    bool const here = any && w.parts[f] != 0 && !w.rigid[f] && scratch.of[f].present;
    scratch.of[f].meets = scratch.of[f].rubs = here;
    if (!here) continue;
    for (NodeArray<NodeVelocity>* part : {&scratch.of[f].meet, &scratch.of[f].rub, &scratch.of[f].keep}) {
      NodeVelocity* nodes = part->get(count);
      std::fill(nodes, nodes + count, NodeVelocity{});
    }
  }
}

/// Points that stretched since their bodies met weigh on other nodes.
void Mpm::weigh_meetings(int block, Scratch const& scratch) const {
  Workspace& w = *work_;
  std::vector<Meeting>& meetings = w.meetings[block];
  auto const mass = [&](Partner const& one, int node) { return scratch.of[one.field].sums.data()[node].momentum[3]; };
  std::erase_if(meetings, [&](Meeting const& m) {
    return !(mass(m.first, m.node) > w.mass_floor && mass(m.second, m.node) > w.mass_floor);
  });
  for (Meeting& m : meetings) {
    for (Partner* one : {&m.first, &m.second}) {
      double const now = mass(*one, m.node);
      double const change = one->mass / now;
      for (double& yields : one->yields) yields *= change;
      if (w.rigid[one->field]) m.slack *= change;
      one->mass = now;
    }
  }
}

/// The new velocities of the nodes where bodies meet, and their changes by the forces of the step.
void Mpm::meet(int block, Scratch& scratch, Given& given) const {
  Workspace const& w = *work_;
  std::vector<Meeting> const& meetings = w.meetings[block];
  if (options_.order == StressOrder::usf && options_.shape == ShapeFunction::cpgimp) weigh_meetings(block, scratch);
  clear_contacts(block, scratch);
  for_nodes(meetings, [&](std::size_t begin, std::size_t end) {
    int const node = meetings[begin].node;
    int const count = static_cast<int>(end - begin);
    // What holds and walls will prescribe.
    auto const velocity = [&](Partner const& one) {
      NodeVelocity const& v = scratch.of[one.field].motion.data()[node].velocity;
      Vec3 now{};
      for (int d = 0; d < 3; ++d) now[d] = one.yields[d] == 0.0 ? one.prescribed[d] : v[d];
      return now;
    };
    auto const changed = [&](Partner const& one) {
      NodeVelocity const& c = scratch.of[one.field].motion.data()[node].change;
      Vec3 now{};
      for (int d = 0; d < 3; ++d) now[d] = one.yields[d] == 0.0 ? 0.0 : c[d];
      return now;
    };
    auto const push = [&](Partner const& one, Vec3 const& moved, Vec3 const& impulse, bool rubs) {
      if (w.rigid[one.field]) return;
      FieldScratch& s = scratch.of[one.field];
      NodeMotion& r = s.motion.data()[node];
      NodeVelocity& part = (rubs ? s.rub : s.meet).data()[node];
      NodeVelocity& keep = s.keep.data()[node];
      for (int d = 0; d < 3; ++d) {
        // Where the velocity is prescribed the impulse passes on to who does that.
        bool const free = one.yields[d] != 0.0;
        double const change = impulse[d] / one.mass;
        r.velocity[d] += free ? moved[d] / one.mass : change;
        r.change[d] += change;
        if (!free) continue;
        part[d] += change;
        keep[d] += change - moved[d] / one.mass;
      }
    };
    // Impulses along the normals: those that stop what closes, and those of the forces.
    std::vector<double>& stopping = scratch.stopping;
    std::vector<double>& pushing = scratch.pushing;
    stopping.resize(count);
    pushing.resize(count);
    for (int n = 0; n < count; ++n) {
      Meeting const& m = meetings[begin + n];
      stopping[n] = dot(velocity(m.first) - velocity(m.second), m.normal);
      pushing[n] = dot(changed(m.first) - changed(m.second), m.normal);
    }
    stop(&meetings[begin], count, stopping.data(), scratch.matrix);
    stop(&meetings[begin], count, pushing.data(), scratch.matrix);
    for (int n = 0; n < count; ++n) {
      Meeting const& m = meetings[begin + n];
      push(m.first, -stopping[n] * m.normal, -pushing[n] * m.normal, false);
      push(m.second, stopping[n] * m.normal, pushing[n] * m.normal, false);
    }
    for (int n = 0; n < count; ++n) {
      Meeting const& m = meetings[begin + n];
      double const impulse = pushing[n];
      Vec3 rubbed{0.0, 0.0, 0.0};
      if (m.friction > 0.0 && impulse > 0.0) {
        Vec3 slip = velocity(m.first) - velocity(m.second);
        slip = slip - dot(slip, m.normal) * m.normal;
        double const speed = norm(slip);
        Vec3 const along = speed > 0.0 ? (1.0 / speed) * slip : Vec3{0.0, 0.0, 0.0};
        double const yields = m.yields(along);
        if (yields > 0.0) rubbed = std::min(m.friction * impulse, speed / yields) * along;
        push(m.first, -1.0 * rubbed, -1.0 * rubbed, true);
        push(m.second, rubbed, rubbed, true);
      }
      book(block, m, impulse, rubbed, given);
    }
  });
}

/// What rigid bodies give by contact, and what friction takes where the points of a body do not lose it: a rigid body,
/// and held nodes. By the mass of the block's own points, as all that happens to nodes.
void Mpm::book(int block, Meeting const& m, double impulse, Vec3 const& rubbed, Given& given) const {
  Workspace const& w = *work_;
  Vec3 const pushed = impulse * m.normal;
  for (bool const is_first : {true, false}) {
    Partner const& one = is_first ? m.first : m.second;
    Partner const& other = is_first ? m.second : m.first;
    if (w.rigid[one.field]) continue;
    double const sign = is_first ? -1.0 : 1.0;
    double const own = sign * w.own_mass(block, one.field, m.node) / one.mass;
    for (int d = 0; d < 3; ++d) {
      if (one.yields[d] == 0.0) given.friction -= own * rubbed[d] * one.prescribed[d];
    }
    if (!w.rigid[other.field]) continue;
    Vec3 const& pusher = *w.rigid[other.field];
    given.impulse = given.impulse + own * (pushed + rubbed);
    given.work += own * dot(pushed + rubbed, pusher);
    given.friction += own * dot(rubbed, pusher);
  }
}

/// The same for velocities that strain the points.
void Mpm::meet_velocity(int block, Scratch& scratch) const {
  std::vector<Meeting> const& meetings = work_->meetings[block];
  for_nodes(meetings, [&](std::size_t begin, std::size_t end) {
    int const node = meetings[begin].node;
    int const count = static_cast<int>(end - begin);
    std::vector<double>& stopping = scratch.stopping;
    stopping.assign(count, 0.0);
    for (int n = 0; n < count; ++n) {
      Meeting const& m = meetings[begin + n];
      NodeVelocity const& a = scratch.of[m.first.field].velocity.data()[node];
      NodeVelocity const& b = scratch.of[m.second.field].velocity.data()[node];
      for (int d = 0; d < 3; ++d) {
        double const va = m.first.yields[d] == 0.0 ? m.first.prescribed[d] : a[d];
        double const vb = m.second.yields[d] == 0.0 ? m.second.prescribed[d] : b[d];
        stopping[n] += (va - vb) * m.normal[d];
      }
    }
    stop(&meetings[begin], count, stopping.data(), scratch.matrix);
    for (int n = 0; n < count; ++n) {
      Meeting const& m = meetings[begin + n];
      NodeVelocity& a = scratch.of[m.first.field].velocity.data()[node];
      NodeVelocity& b = scratch.of[m.second.field].velocity.data()[node];
      for (int d = 0; d < 3; ++d) {
        a[d] -= stopping[n] * m.first.yields[d] * m.normal[d];
        b[d] += stopping[n] * m.second.yields[d] * m.normal[d];
      }
    }
  });
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
