/// Faces of the domain that are a `wall`, for bodies: they press on it and rub along it, but it does not pull them.
///
/// Fields of bodies have no images behind walls, only the particles' own nodes there. A mirror is the same as a set of
/// constraints on these: the velocity across the plane is 0 at the nodes on it, and opposite at each pair of nodes that
/// lie k cells before and behind it. Here each of them acts only where it pushes, and where the surface of the
/// particles reaches the plane within the step: v >= -gap/dt on the plane, the sum of both >= -2 gap/dt in a pair. Both
/// nodes of a pair get the same impulse. Friction takes up to its coefficient times the change across the plane off the
/// velocity along it.
#include <algorithm>
#include <cmath>
#include <utility>

#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

/// The nodes of one grid field of a block that walls stop, and where that is booked.
///
/// Each block books for its own particles. What is stopped has no velocity left, so that the forces of the step do no
/// work on it: all of its change is loss, as where constraints constrained. While it closes a gap they do, and where
/// the stress was updated before, with another velocity. What contact gave is in what is stopped, too. What friction
/// did of it: the wall takes that away, and accounts for the loss of particles that follow increments. For those that
/// take over the nodes' velocity friction does its work all the same, at the mean of before and after the step, see
/// `Mpm::note_rubbing`.
class WallStops {
 public:
  struct Settings {
    double friction = 0.0;
    bool strained_before = false;  ///< the stress was updated before, with another velocity
    /// Where particles take over the nodes' velocity and the loss is counted, the nodes tell it.
    bool taken_over = false;
    bool all_follow = false;  ///< all particles follow increments of the velocity: what gas loses is heat
  };
  /// `own` and `following`: what the block's own particles gave the nodes, and those of them that follow increments;
  /// null where there are none.
  WallStops(Settings const& settings, FieldScratch& nodes, NodeSums const* own, NodeVelocity const* following,
            Given& given)
      : settings_(settings),
        s_(&nodes),
        nodes_(nodes.motion.data()),
        stop_(nodes.stop.data()),
        own_(own),
        following_(following),
        given_(&given) {}

  /// Stops a node on the wall: its velocity misses `missing`, the surface may still close in by `slack`; `constrained`:
  /// it was stopped in the step before.
  void node(WallFace const& wall, int node, double missing, double slack, bool constrained) {
    push(wall, node, missing);
    book(wall, node, missing, slack, constrained);
  }
  /// Stops a pair of nodes before and behind the wall.
  void pair(WallFace const& wall, int ahead, int behind, double missing, double slack, bool constrained) {
    double const ma = nodes_[ahead].velocity[3];
    double const mb = nodes_[behind].velocity[3];
    push(wall, ahead, missing * mb / (ma + mb));
    push(wall, behind, missing * ma / (ma + mb));
    book_pair(wall, ahead, behind, missing, slack, constrained);
  }

 private:
  [[nodiscard]] double own_mass(int node) const { return own_ == nullptr ? 0.0 : own_[node].momentum[3]; }
  [[nodiscard]] double following_mass(int node) const {
    return settings_.all_follow ? own_mass(node) : following_ == nullptr ? 0.0 : following_[node][3];
  }
  [[nodiscard]] double lost_by_node(int node, int d) const {
    NodeMotion const& r = nodes_[node];
    return settings_.taken_over ? -own_mass(node) * stop_[node][d] * (r.velocity[d] - 0.5 * r.change[d]) : 0.0;
  }
  [[nodiscard]] double met_at(int node, int d) const { return s_->meets ? s_->meet.data()[node][d] : 0.0; }
  [[nodiscard]] double rubbed_at(int node, int d) const { return s_->rubs ? s_->rub.data()[node][d] : 0.0; }

  void push(WallFace const& wall, int node, double change) {
    NodeMotion& r = nodes_[node];
    int const d = wall.direction;
    double const m = r.velocity[3];
    Vec3 given_here{0.0, 0.0, 0.0};
    given_here[d] = wall.inwards * change;
    if (settings_.friction > 0.0) {
      double square = 0.0;
      for (int e = 0; e < 3; ++e) square += e == d ? 0.0 : r.velocity[e] * r.velocity[e];
      double const fraction = square > 0.0 ? std::min(1.0, settings_.friction * change / std::sqrt(square)) : 0.0;
      for (int e = 0; e < 3; ++e) {
        if (e == d) continue;
        given_here[e] = -fraction * r.velocity[e];
        s_->rub.data()[node][e] += given_here[e];
      }
    }
    for (int e = 0; e < 3; ++e) {
      r.change[e] += given_here[e];
      r.velocity[e] += given_here[e];
      given_->impulse[e] += own_mass(node) * given_here[e];
    }
    // Heat of fluids that share the node: what is lost at the mean of the velocities before and after the step.
    if (settings_.taken_over) return;
    for (int e = 0; e < 3; ++e) r.change[3] -= m * given_here[e] * (r.velocity[e] - 0.5 * r.change[e]);
  }
  void take(int node, int d, double met, double rubbed) {
    if (s_->meets) s_->meet.data()[node][d] -= met;
    if (!s_->rubs) return;
    NodeVelocity& rub = s_->rub.data()[node];
    rub[d] -= rubbed;
    rub[3] += rubbed * (nodes_[node].velocity[d] - 0.5 * nodes_[node].change[d]);
  }
  void book(WallFace const& wall, int node, double change, double slack, bool constrained) {
    int const d = wall.direction;
    NodeMotion const& r = nodes_[node];
    stop_[node][d] = r.change[d];
    double const by_forces = wall.inwards * r.change[d] - change;
    double const was = wall.inwards * (r.velocity[d] - r.change[d]);
    double const strained = settings_.strained_before && !constrained ? was : -slack;
    given_->drive += following_mass(node) * by_forces * strained + lost_by_node(node, d);
    double const middle = r.velocity[d] - 0.5 * r.change[d];
    double const taken = rubbed_at(node, d);
    take(node, d, met_at(node, d), taken);
    if (settings_.taken_over) {
      given_->drive += own_mass(node) * taken * (middle - wall.inwards * strained);
    } else {
      given_->friction -= following_mass(node) * wall.inwards * strained * taken;
    }
  }
  void book_pair(WallFace const& wall, int a, int b, double change, double slack, bool constrained) {
    int const d = wall.direction;
    double const ma = nodes_[a].velocity[3];
    double const mb = nodes_[b].velocity[3];
    double const both = nodes_[a].change[d] + nodes_[b].change[d];
    stop_[a][d] = both * mb / (ma + mb);
    stop_[b][d] = both * ma / (ma + mb);
    double const by_forces = wall.inwards * both - change;
    double const was = wall.inwards * (nodes_[a].velocity[d] + nodes_[b].velocity[d] - both);
    double const strained = settings_.strained_before && !constrained ? was : -2.0 * slack;
    double const mass = 0.5 * (following_mass(a) * mb + following_mass(b) * ma) / (ma + mb);
    given_->drive += mass * by_forces * strained + lost_by_node(a, d) + lost_by_node(b, d);
    double const met = met_at(a, d) + met_at(b, d);
    double const sum = rubbed_at(a, d) + rubbed_at(b, d);
    for (auto const& [node, fraction] : {std::pair{a, mb / (ma + mb)}, std::pair{b, ma / (ma + mb)}}) {
      take(node, d, fraction * met, fraction * sum);
      double const middle = nodes_[node].velocity[d] - 0.5 * nodes_[node].change[d];
      if (settings_.taken_over) given_->drive += own_mass(node) * fraction * sum * middle;
    }
    if (settings_.taken_over) {
      given_->drive -= mass * sum * wall.inwards * strained;
    } else {
      given_->friction -= mass * wall.inwards * strained * sum;
    }
  }

  Settings settings_;
  FieldScratch* s_;
  NodeMotion* nodes_;
  NodeVelocity* stop_;
  NodeSums const* own_;
  NodeVelocity const* following_;
  Given* given_;
};

/// Stops the new velocities of bodies' nodes where they would go through a wall, and books what they lose by it.
void Mpm::stop_at_walls(int block, double dt, Scratch& scratch, Given& given) {
  Workspace& w = *work_;
  for (FieldScratch& s : scratch.of) s.stops = false;
  std::vector<WallFace> const& walls = w.walls[block];
  if (walls.empty()) return;
  Patch const& patch = w.patches[block];
  int const count = patch.count();
  WallStops::Settings settings;
  settings.friction = options_.wall_friction;
  settings.strained_before = options_.order == StressOrder::usf;
  for (int f = 0; f < w.fields; ++f) {
    FieldScratch& s = scratch.of[f];
    if (w.one_sided[f] == 0 || !s.present) continue;
    int const slot = w.slot(block, f);
    w.stopped[slot].resize(static_cast<std::size_t>(count) * walls.size());
    NodeVelocity* stop = s.stop.get(count);
    std::fill(stop, stop + count, NodeVelocity{});
    s.stops = true;
    if (settings.friction > 0.0 && !s.rubs) {
      NodeVelocity* rub = s.rub.get(count);
      std::fill(rub, rub + count, NodeVelocity{});
      s.rubs = true;
    }
    settings.taken_over = w.taken_over(f);
    settings.all_follow = w.affine[f] == 0 || settings.taken_over;
    bool const some_follow = w.shared[f] != 0 && w.momentum_present[slot] != 0;
    WallStops stops(settings, s, w.present[slot] != 0 ? w.state[slot].data() : nullptr,
                    some_follow ? w.momentum[slot].data() : nullptr, given);
    for (std::size_t n = 0; n < walls.size(); ++n) stop_at_wall(block, f, n, dt, s, stops);
  }
}

/// The same for one field and one wall.
void Mpm::stop_at_wall(int block, int field, std::size_t number, double dt, FieldScratch const& s, WallStops& stops) {
  Workspace& w = *work_;
  Patch const& patch = w.patches[block];
  WallFace const& wall = w.walls[block][number];
  int const d = wall.direction;
  int const stride = wall.inwards * patch.stride(d);
  auto const first = number * static_cast<std::size_t>(patch.count());
  double const* gaps = s.gap.data() + first;
  char* stopped = w.stopped[w.slot(block, field)].data() + first;
  NodeMotion const* nodes = s.motion.data();
  grid::for_each_node(patch, patch.plane(d, wall.plane), [&](int node) {
    if (gaps[node] == no_gap) return;
    double const slack = std::max(0.0, gaps[node]) / dt;
    char const earlier = stopped[node];
    char bits = 0;
    if (nodes[node].velocity[3] > w.mass_floor) {
      double const missing = -slack - wall.inwards * nodes[node].velocity[d];
      if (missing > 0.0) {
        stops.node(wall, node, missing, slack, (earlier & 1) != 0);
        bits = 1;
      }
    }
    for (int k = 1; k <= patch.reach; ++k) {
      NodeMotion const& a = nodes[node + k * stride];
      NodeMotion const& b = nodes[node - k * stride];
      if (!(a.velocity[3] > w.mass_floor && b.velocity[3] > w.mass_floor)) continue;
      double const missing = -2.0 * slack - wall.inwards * (a.velocity[d] + b.velocity[d]);
      if (!(missing > 0.0)) continue;
      stops.pair(wall, node + k * stride, node - k * stride, missing, slack, ((earlier >> k) & 1) != 0);
      bits = static_cast<char>(bits | (1 << k));
    }
    stopped[node] = bits;
  });
}

/// The same for velocities that strain the particles. Those that the particles gave back to the nodes are constrained
/// where the new ones were stopped, and nowhere else, so that noise about the wall's velocity has no mean. Where the
/// stress is updated first, what the forces of the old stress would do tells which will be: by their velocity alone
/// nodes under a body that lies on a wall would be let go half of the time, and the forces would do work there that
/// nothing takes up.
void Mpm::stop_velocity_at_walls(int block, double dt, Scratch& scratch) const {
  Workspace& w = *work_;
  std::vector<WallFace> const& walls = w.walls[block];
  if (walls.empty()) return;
  Patch const& patch = w.patches[block];
  int const count = patch.count();
  bool const first = options_.order == StressOrder::usf;
  for (int f = 0; f < w.fields; ++f) {
    if (w.one_sided[f] == 0 || !scratch.of[f].present) continue;
    std::vector<char>& stopped = w.stopped[w.slot(block, f)];
    if (first) stopped.assign(static_cast<std::size_t>(count) * walls.size(), 0);
    NodeVelocity* nodes = scratch.of[f].velocity.data();
    NodeSums const* state = scratch.of[f].sums.data();
    for (std::size_t n = 0; n < walls.size(); ++n) {
      WallFace const& wall = walls[n];
      int const d = wall.direction;
      int const stride = wall.inwards * patch.stride(d);
      double const* gaps = scratch.of[f].gap.data() + static_cast<int>(n) * count;
      auto const pushed = [&](int node) { return wall.inwards * dt * state[node].force[d] / nodes[node][3]; };
      grid::for_each_node(patch, patch.plane(d, wall.plane), [&](int node) {
        if (gaps[node] == no_gap) return;
        double const slack = std::max(0.0, gaps[node]) / dt;
        char& bits = stopped[n * count + node];
        if (nodes[node][3] > w.mass_floor) {
          double const missing = -slack - wall.inwards * nodes[node][d];
          if (first && missing > pushed(node)) bits = 1;
          if ((bits & 1) != 0) nodes[node][d] += wall.inwards * missing;
        }
        for (int k = 1; k <= patch.reach; ++k) {
          int const ahead = node + k * stride;
          int const behind = node - k * stride;
          NodeVelocity& a = nodes[ahead];
          NodeVelocity& b = nodes[behind];
          if (!(a[3] > w.mass_floor && b[3] > w.mass_floor)) continue;
          double const missing = -2.0 * slack - wall.inwards * (a[d] + b[d]);
          if (first && missing > pushed(ahead) + pushed(behind)) bits = static_cast<char>(bits | (1 << k));
          if (((bits >> k) & 1) == 0) continue;
          double const fraction = b[3] / (a[3] + b[3]);
          a[d] += wall.inwards * missing * fraction;
          b[d] += wall.inwards * missing * (1.0 - fraction);
        }
      });
    }
  }
}

}  // namespace brisance::mpm
