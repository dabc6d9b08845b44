/// Contact of bodies that have grid fields of their own, [Bardenhagen01]: where two of them meet in a node, their
/// surfaces touch there and close in on each other, the nodes move as one along the normal, with Coulomb friction
/// across it.
///
/// The nodes do, and strain the particles; the particles themselves keep their velocities. What they get of the step
/// are forces, and of these contact takes what would accelerate the surfaces against each other: with P the projection
/// of the nodes' velocities on those that close nothing, orthogonal in the metric of the masses, the particles are
/// strained with P v and get the changes P f of their velocities. Then the stress works as much as the particles lose,
/// since f . P v = P f . v: contact conserves energy, whatever the bodies' speed and the size of the cells. Taking the
/// velocities themselves to P v is a plastic impact of the nodes' masses: it loses 4 % of the energy of two discs of 8
/// cells per radius, and up to 15 % of that of a plate six cells thick.
#include "mpm/contact.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/mpm.hpp"
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

/// The fields that meet at one node: their new velocities, and what contact changes of them.
class MeetingNode {
 public:
  MeetingNode(Scratch& scratch, GridFields const& fields, int node)
      : scratch_(&scratch), fields_(&fields), node_(node) {}

  /// The velocity, with what holds and walls will prescribe.
  [[nodiscard]] Vec3 velocity(Partner const& one) const {
    NodeVelocity const& v = scratch_->of[one.field].motion.data()[node_].velocity;
    Vec3 now{};
    for (int d = 0; d < 3; ++d) now[d] = one.yields[d] == 0.0 ? one.prescribed[d] : v[d];
    return now;
  }
  /// Its change by the forces of the step.
  [[nodiscard]] Vec3 change(Partner const& one) const {
    NodeVelocity const& c = scratch_->of[one.field].motion.data()[node_].change;
    Vec3 now{};
    for (int d = 0; d < 3; ++d) now[d] = one.yields[d] == 0.0 ? 0.0 : c[d];
    return now;
  }
  /// `moved` changes the velocity with which the node moves, `impulse` that which the particles keep.
  void push(Partner const& one, Vec3 const& moved, Vec3 const& impulse, bool rubs) const {
    if (fields_->rigid[one.field]) return;
    FieldScratch& s = scratch_->of[one.field];
    NodeMotion& r = s.motion.data()[node_];
    NodeVelocity& part = (rubs ? s.rub : s.meet).data()[node_];
    NodeVelocity& keep = s.keep.data()[node_];
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
  }
  /// Friction of a pair that the forces press together with an impulse; returns its own.
  [[nodiscard]] Vec3 rub(Meeting const& m, double impulse) const {
    Vec3 rubbed{0.0, 0.0, 0.0};
    if (!(m.friction > 0.0 && impulse > 0.0)) return rubbed;
    Vec3 slip = velocity(m.first) - velocity(m.second);
    slip = slip - dot(slip, m.normal) * m.normal;
    double const speed = norm(slip);
    Vec3 const along = speed > 0.0 ? (1.0 / speed) * slip : Vec3{0.0, 0.0, 0.0};
    double const yields = m.yields(along);
    if (yields > 0.0) rubbed = std::min(m.friction * impulse, speed / yields) * along;
    push(m.first, -1.0 * rubbed, -1.0 * rubbed, true);
    push(m.second, rubbed, rubbed, true);
    return rubbed;
  }

 private:
  Scratch* scratch_;
  GridFields const* fields_;
  int node_;
};

}  // namespace

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

/// Particles that stretched since their bodies met weigh on other nodes.
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
  std::vector<Meeting> const& meetings = work_->meetings[block];
  if (options_.order == StressOrder::usf && options_.shape == ShapeFunction::cpgimp) weigh_meetings(block, scratch);
  clear_contacts(block, scratch);
  for_nodes(meetings, [&](std::size_t begin, std::size_t end) {
    MeetingNode const node(scratch, *work_, meetings[begin].node);
    int const count = static_cast<int>(end - begin);
    // Impulses along the normals: those that stop what closes, and those of the forces.
    std::vector<double>& stopping = scratch.stopping;
    std::vector<double>& pushing = scratch.pushing;
    stopping.resize(count);
    pushing.resize(count);
    for (int n = 0; n < count; ++n) {
      Meeting const& m = meetings[begin + n];
      stopping[n] = dot(node.velocity(m.first) - node.velocity(m.second), m.normal);
      pushing[n] = dot(node.change(m.first) - node.change(m.second), m.normal);
    }
    stop(&meetings[begin], count, stopping.data(), scratch.matrix);
    stop(&meetings[begin], count, pushing.data(), scratch.matrix);
    for (int n = 0; n < count; ++n) {
      Meeting const& m = meetings[begin + n];
      node.push(m.first, -stopping[n] * m.normal, -pushing[n] * m.normal, false);
      node.push(m.second, stopping[n] * m.normal, pushing[n] * m.normal, false);
    }
    for (int n = 0; n < count; ++n) {
      Meeting const& m = meetings[begin + n];
      book(block, m, pushing[n], node.rub(m, pushing[n]), given);
    }
  });
}

/// What rigid bodies give by contact, and what friction takes where the particles of a body do not lose it: a rigid
/// body, and held nodes. By the mass of the block's own particles, as all that happens to nodes.
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

/// The same for velocities that strain the particles.
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

}  // namespace brisance::mpm
