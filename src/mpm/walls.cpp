/// Faces of the domain that are a `wall`, for bodies: they press on it and rub along it, but it does not pull them.
///
/// Fields of bodies have no images behind walls, only the points' own nodes there. A mirror is the same as a set of
/// constraints on these: the velocity across the plane is 0 at the nodes on it, and opposite at each pair of nodes that
/// lie k cells before and behind it. Here each of them acts only where it pushes, and where the surface of the points
/// reaches the plane within the step: v >= -gap/dt on the plane, the sum of both >= -2 gap/dt in a pair. Both nodes of
/// a pair get the same impulse. Friction takes up to its coefficient times the change across the plane off the velocity
/// along it.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

constexpr double far = std::numeric_limits<double>::max();

/// Calls visit(node) for the nodes on a wall, in their order.
template <class Visit>
void for_plane(Patch const& patch, WallFace const& wall, Visit&& visit) {
  int const stride = patch.stride(wall.direction);
  int const beyond = stride * patch.n[wall.direction];
  for (int begin = wall.plane * stride; begin < patch.count(); begin += beyond) {
    for (int node = begin; node < begin + stride; ++node) visit(node);
  }
}

/// Half the size of a point across a wall [m]: of a cube of its volume, or its own.
double half_size(SetView const& v, grid::Geometry geometry, int d, int q) {
  if (double const* own = v.set->field(Field::half_x + d)) return own[q];
  double part = 0.0;
  with_kernels(ShapeFunction::linear, v.patch->dimensions,
               [&](auto kernels) { part = kernels.cells_filled(v, geometry, q); });
  return 0.5 * v.h * std::pow(part, 1.0 / v.patch->dimensions);
}

}  // namespace

/// The nodes on a wall that a point touches learn how far its surface is from it.
void Mpm::map_gaps(int block) {
  Workspace& w = *work_;
  std::vector<WallFace> const& walls = w.walls[block];
  if (walls.empty()) return;
  Patch const& patch = w.patches[block];
  double const h = grid_.domain().h;
  int const count = patch.count();
  for (int f = 0; f < w.fields; ++f) w.gap_present[w.slot(block, f)] = 0;
  for_sets(block, [&](PointSet& set, int body) {
    int const f = w.field_of[body];
    if (w.one_sided[f] == 0) return;
    int const slot = w.slot(block, f);
    int const all = count * static_cast<int>(walls.size());
    double* gaps = w.gap[slot].get(all);
    if (w.gap_present[slot] == 0) std::fill(gaps, gaps + all, far);
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
        std::array<int, 3> first{0, 0, 0};
        std::array<int, 3> last{0, 0, 0};
        first[d] = last[d] = wall.plane;
        for (int e = 0; e < patch.dimensions; ++e) {
          if (e == d) continue;
          double reach = options_.shape == ShapeFunction::bspline ? 1.5 : 1.0;
          if (options_.shape == ShapeFunction::gimp) reach += 0.5 / bodies_[body].points_per_direction;
          if (options_.shape == ShapeFunction::cpgimp) reach += set.field(Field::half_x + e)[q] / h;
          double const u = (set.field(Field::position_x + e)[q] - patch.first[e]) / h + patch.reach;
          first[e] = std::max(0, static_cast<int>(std::floor(u - reach)) + 1);
          last[e] = std::min(patch.n[e] - 1, static_cast<int>(std::ceil(u + reach)) - 1);
        }
        for (int k = first[2]; k <= last[2]; ++k) {
          for (int j = first[1]; j <= last[1]; ++j) {
            for (int i = first[0]; i <= last[0]; ++i) {
              double& to = gaps[static_cast<int>(n) * count + patch.index(i, j, k)];
              to = std::min(to, gap);
            }
          }
        }
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
  std::fill(gaps, gaps + all, far);
  for (std::size_t n = 0; n < walls.size(); ++n) {
    int const d = walls[n].direction;
    for (Link const& link : patch.links) {
      int const slot = w.slot(link.source, field);
      if (link.wall || w.walls[link.source].empty() || w.gap_present[slot] == 0) continue;
      auto const& others = w.walls[link.source];
      auto const same = std::find_if(others.begin(), others.end(),
                                     [&](WallFace const& other) { return other.number == walls[n].number; });
      if (same == others.end()) continue;
      int const source_count = link.source_n[0] * link.source_n[1] * link.source_n[2];
      double const* from = w.gap[slot].data() + (same - others.begin()) * source_count;
      double* to = gaps + static_cast<int>(n) * count;
      Index3 lower = link.lower;
      Index3 upper = link.upper;
      if (lower[d] > walls[n].plane || upper[d] < walls[n].plane) continue;
      lower[d] = upper[d] = walls[n].plane;
      for (int k = lower[2]; k <= upper[2]; ++k) {
        for (int j = lower[1]; j <= upper[1]; ++j) {
          for (int i = lower[0]; i <= upper[0]; ++i) {
            double& gap = to[patch.index(i, j, k)];
            gap = std::min(gap, from[link.source_index(i, j, k)]);
          }
        }
      }
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

/// Stops the new velocities of bodies' nodes where they would go through a wall, and books what they lose by it.
void Mpm::stop_at_walls(int block, double dt, Scratch& scratch, Given& given) {
  Workspace& w = *work_;
  for (FieldScratch& s : scratch.of) s.stops = false;
  std::vector<WallFace> const& walls = w.walls[block];
  if (walls.empty()) return;
  Patch const& patch = w.patches[block];
  int const count = patch.count();
  double const friction = options_.wall_friction;
  for (int f = 0; f < w.fields; ++f) {
    if (w.one_sided[f] == 0 || !scratch.of[f].present) continue;
    std::vector<char>& stopped = w.stopped[w.slot(block, f)];
    stopped.resize(static_cast<std::size_t>(count) * walls.size());
    NodeVelocity* stop = scratch.of[f].stop.get(count);
    std::fill(stop, stop + count, NodeVelocity{});
    scratch.of[f].stops = true;
    if (friction > 0.0 && !scratch.of[f].rubs) {
      NodeVelocity* rub = scratch.of[f].rub.get(count);
      std::fill(rub, rub + count, NodeVelocity{});
      scratch.of[f].rubs = true;
    }
    NodeMotion* nodes = scratch.of[f].motion.data();
    // Each block books for its own points.
    auto const own_mass = [&](int node) { return w.own_mass(block, f, node); };
    // Of its points that follow increments of the velocity: what gas loses is heat. Where points take over the nodes'
    // velocity and the loss is counted, the nodes tell it.
    bool const taken_over = w.taken_over(f);
    NodeVelocity const* following =
        w.shared[f] != 0 && w.momentum_present[w.slot(block, f)] != 0 ? w.momentum[w.slot(block, f)].data() : nullptr;
    auto const following_mass = [&](int node) {
      return w.affine[f] == 0 || taken_over ? own_mass(node) : following == nullptr ? 0.0 : following[node][3];
    };
    auto const push = [&](WallFace const& wall, int node, double change) {
      NodeMotion& r = nodes[node];
      int const d = wall.direction;
      double const m = r.velocity[3];
      Vec3 given_here{0.0, 0.0, 0.0};
      given_here[d] = wall.inwards * change;
      if (friction > 0.0) {
        double square = 0.0;
        for (int e = 0; e < 3; ++e) square += e == d ? 0.0 : r.velocity[e] * r.velocity[e];
        double const part = square > 0.0 ? std::min(1.0, friction * change / std::sqrt(square)) : 0.0;
        for (int e = 0; e < 3; ++e) {
          if (e == d) continue;
          given_here[e] = -part * r.velocity[e];
          scratch.of[f].rub.data()[node][e] += given_here[e];
        }
      }
      for (int e = 0; e < 3; ++e) {
        r.change[e] += given_here[e];
        r.velocity[e] += given_here[e];
        given.impulse[e] += own_mass(node) * given_here[e];
      }
      // Heat of fluids that share the node: what is lost at the mean of the velocities before and after the step.
      if (taken_over) return;
      for (int e = 0; e < 3; ++e) r.change[3] -= m * given_here[e] * (r.velocity[e] - 0.5 * r.change[e]);
    };
    // What is stopped has no velocity left, so that the forces of the step do no work on it: all of its change is loss,
    // as where constraints hold. While it closes a gap they do, and where the stress was updated before, with another
    // velocity.
    bool const before = options_.order == StressOrder::usf;
    auto const lost_by_node = [&](int node, int d) {
      NodeMotion const& r = nodes[node];
      return taken_over ? -own_mass(node) * stop[node][d] * (r.velocity[d] - 0.5 * r.change[d]) : 0.0;
    };
    // What contact gave is in what is stopped, too. What friction did of it: the wall takes that away, and accounts for
    // the loss of points that follow increments. For those that take over the nodes' velocity friction does its work
    // all the same, at the mean of before and after the step, see `Mpm::note_rubbing`.
    FieldScratch const& s = scratch.of[f];
    auto const met_at = [&](int node, int d) { return s.meets ? s.meet.data()[node][d] : 0.0; };
    auto const rubbed_at = [&](int node, int d) { return s.rubs ? s.rub.data()[node][d] : 0.0; };
    auto const take = [&](int node, int d, double met, double rubbed) {
      if (scratch.of[f].meets) scratch.of[f].meet.data()[node][d] -= met;
      if (!scratch.of[f].rubs) return;
      NodeVelocity& rub = scratch.of[f].rub.data()[node];
      rub[d] -= rubbed;
      rub[3] += rubbed * (nodes[node].velocity[d] - 0.5 * nodes[node].change[d]);
    };
    auto const book = [&](WallFace const& wall, int node, double change, double slack, bool held) {
      int const d = wall.direction;
      NodeMotion const& r = nodes[node];
      stop[node][d] = r.change[d];
      double const by_forces = wall.inwards * r.change[d] - change;
      double const was = wall.inwards * (r.velocity[d] - r.change[d]);
      double const strained = before && !held ? was : -slack;
      given.drive += following_mass(node) * by_forces * strained + lost_by_node(node, d);
      double const middle = r.velocity[d] - 0.5 * r.change[d];
      double const taken = rubbed_at(node, d);
      take(node, d, met_at(node, d), taken);
      if (taken_over) {
        given.drive += own_mass(node) * taken * (middle - wall.inwards * strained);
      } else {
        given.friction -= following_mass(node) * wall.inwards * strained * taken;
      }
    };
    auto const book_pair = [&](WallFace const& wall, int a, int b, double change, double slack, bool held) {
      int const d = wall.direction;
      double const ma = nodes[a].velocity[3];
      double const mb = nodes[b].velocity[3];
      double const both = nodes[a].change[d] + nodes[b].change[d];
      stop[a][d] = both * mb / (ma + mb);
      stop[b][d] = both * ma / (ma + mb);
      double const by_forces = wall.inwards * both - change;
      double const was = wall.inwards * (nodes[a].velocity[d] + nodes[b].velocity[d] - both);
      double const strained = before && !held ? was : -2.0 * slack;
      double const mass = 0.5 * (following_mass(a) * mb + following_mass(b) * ma) / (ma + mb);
      given.drive += mass * by_forces * strained + lost_by_node(a, d) + lost_by_node(b, d);
      double const met = met_at(a, d) + met_at(b, d);
      double const sum = rubbed_at(a, d) + rubbed_at(b, d);
      for (auto const& [node, part] : {std::pair{a, mb / (ma + mb)}, std::pair{b, ma / (ma + mb)}}) {
        take(node, d, part * met, part * sum);
        double const middle = nodes[node].velocity[d] - 0.5 * nodes[node].change[d];
        if (taken_over) given.drive += own_mass(node) * part * sum * middle;
      }
      if (taken_over) {
        given.drive -= mass * sum * wall.inwards * strained;
      } else {
        given.friction -= mass * wall.inwards * strained * sum;
      }
    };
    for (std::size_t n = 0; n < walls.size(); ++n) {
      WallFace const& wall = walls[n];
      int const d = wall.direction;
      int const stride = wall.inwards * patch.stride(d);
      double const* gaps = scratch.of[f].gap.data() + static_cast<int>(n) * count;
      for_plane(patch, wall, [&](int node) {
        if (gaps[node] == far) return;
        double const slack = std::max(0.0, gaps[node]) / dt;
        char& bits = stopped[n * count + node];
        char const earlier = bits;
        bits = 0;
        if (nodes[node].velocity[3] > w.mass_floor) {
          double const missing = -slack - wall.inwards * nodes[node].velocity[d];
          if (missing > 0.0) {
            push(wall, node, missing);
            book(wall, node, missing, slack, (earlier & 1) != 0);
            bits = 1;
          }
        }
        for (int k = 1; k <= patch.reach; ++k) {
          NodeMotion const& a = nodes[node + k * stride];
          NodeMotion const& b = nodes[node - k * stride];
          double const ma = a.velocity[3];
          double const mb = b.velocity[3];
          if (!(ma > w.mass_floor && mb > w.mass_floor)) continue;
          double const missing = -2.0 * slack - wall.inwards * (a.velocity[d] + b.velocity[d]);
          if (!(missing > 0.0)) continue;
          push(wall, node + k * stride, missing * mb / (ma + mb));
          push(wall, node - k * stride, missing * ma / (ma + mb));
          book_pair(wall, node + k * stride, node - k * stride, missing, slack, ((earlier >> k) & 1) != 0);
          bits = static_cast<char>(bits | (1 << k));
        }
      });
    }
  }
}

/// The same for velocities that strain the points. Those that the points gave back to the nodes are held where the new
/// ones were stopped, and nowhere else, so that noise about the wall's velocity has no mean. Where the stress is
/// updated first, what the forces of the old stress would do tells which will be: by their velocity alone nodes under a
/// body that lies on a wall would be let go half of the time, and the forces would do work there that nothing takes up.
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
      for_plane(patch, wall, [&](int node) {
        if (gaps[node] == far) return;
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
          double const part = b[3] / (a[3] + b[3]);
          a[d] += wall.inwards * missing * part;
          b[d] += wall.inwards * missing * (1.0 - part);
        }
      });
    }
  }
}

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
      for_plane(patch, wall, [&](int node) {
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
      for_plane(patch, wall, [&](int node) {
        if (bodies_at(node) > w.mass_floor) set(node, wall.direction, 0.0);
        for (int k = 1; k <= patch.reach; ++k) {
          int const a = node + k * stride;
          int const b = node - k * stride;
          double const ma = bodies_at(a);
          double const mb = bodies_at(b);
          if (!(ma + mb > w.mass_floor)) continue;
          double const part = ma / (ma + mb);
          for (int d = 0; d < 3; ++d) {
            double const sign = d == wall.direction ? -1.0 : 1.0;
            double const v = part * velocity(a, d) + sign * (1.0 - part) * velocity(b, d);
            set(a, d, v);
            set(b, d, sign * v);
          }
        }
      });
    }
  }
}

}  // namespace brisance::mpm
