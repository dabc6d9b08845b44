/// The pass over momentum and motion, block by block; see `mpm.hpp`.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Does the kinetic energy per mass of a node mean anything? Nodes of next to no gas, among solids whose surfaces push
/// it about, would pass more than a cell in the step by this energy or by what the forces change. No particle follows
/// them: their parts in the particles are as small as their mass.
bool means_something(NodeMotion const& node, double energy, double dt, double h) {
  double const changed =
      node.change[0] * node.change[0] + node.change[1] * node.change[1] + node.change[2] * node.change[2];
  return std::max(std::abs(energy), changed) * dt * dt <= h * h;
}

}  // namespace

/// Eq. (22): from mass, momentum and force to the new velocity and its change.
void Mpm::find_velocity(int block, double dt, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  double const floor = w.mass_floor;
  for (int f = 0; f < w.fields; ++f) {
    if (!scratch.of[f].present) continue;
    NodeSums const* sums = scratch.of[f].sums.data();
    NodeMotion* motion = scratch.of[f].motion.get(count);
    for (int node = 0; node < count; ++node) {
      NodeSums const& sum = sums[node];
      double const m = sum.momentum[3];
      double const inverse = m > floor ? 1.0 / m : 0.0;
      double const push = dt * inverse;
      NodeMotion& r = motion[node];
      r.change = sum.force * Lanes4{push, push, push, 1.0};
      r.velocity = sum.momentum * Lanes4{inverse, inverse, inverse, 1.0} + r.change * Lanes4{1.0, 1.0, 1.0, 0.0};
    }
  }
}

/// What particles of APIC take over: the nodes' velocity, with what the particles keep where bodies meet, and the
/// kinetic energy of the particles around per mass, with what the forces of the step add. Where they share nodes with
/// particles of other transfers, which keep to the increments, all heat is theirs.
void Mpm::find_taken(int block, double dt, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  double const h = w.patches[block].h;
  for (int f = 0; f < w.fields; ++f) {
    if (!scratch.of[f].present || w.affine[f] == 0) continue;
    NodeMotion const* nodes = scratch.of[f].motion.data();
    NodeVelocity const* others = scratch.of[f].exchanges ? scratch.of[f].exchange.data() : nullptr;
    NodeVelocity const* keep = scratch.of[f].meets ? scratch.of[f].keep.data() : nullptr;
    NodeVelocity* taken = scratch.of[f].taken.get(count);
    for (int node = 0; node < count; ++node) {
      NodeMotion const& r = nodes[node];
      NodeVelocity const v = keep == nullptr ? r.velocity : r.velocity + keep[node];
      taken[node] = v;
      double const m = r.velocity[3];
      double const of_others = others == nullptr ? 0.0 : others[node][3];
      if (of_others > w.mass_floor) {
        double before = 0.0;
        double after = 0.0;
        for (int d = 0; d < 3; ++d) {
          before += (v[d] - r.change[d]) * (v[d] - r.change[d]);
          after += v[d] * v[d];
        }
        double const own = m - of_others;
        taken[node][3] = own > 1e-12 * m ? (r.change[3] - 0.5 * m * before) / own + 0.5 * after : 0.5 * after;
        continue;
      }
      double sum = m > w.mass_floor ? r.change[3] / m : 0.0;
      for (int d = 0; d < 3; ++d) sum += r.change[d] * (v[d] - 0.5 * r.change[d]);
      // What is no particle's heat is counted to the last bit.
      taken[node][3] = w.heats[f] == 0 || means_something(r, sum, dt, h) ? sum : 0.0;
    }
  }
}

/// Where bodies are that do not slip. Nobody asks for the velocity of a fluid after the motion elsewhere, if its own
/// strain takes that of the nodes.
void Mpm::find_reached(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  scratch.reached.assign(count, 0);
  for (int f = 0; f < w.fields; ++f) {
    if (!scratch.of[f].present || w.slips[f] != 0) continue;
    NodeMotion const* nodes = scratch.of[f].motion.data();
    for (int node = 0; node < count; ++node) {
      if (nodes[node].velocity[3] > 0.0) scratch.reached[node] = 1;
    }
  }
}

/// Eqs. (23)-(25), and (26), the velocity of the particles mapped back.
void Mpm::move_particles(int block, double dt, Hoops const& hoops, OuterForces const& outer, Scratch& scratch) {
  Workspace& w = *work_;
  Patch const& patch = w.patches[block];
  if (w.maps_back) {
    clear_velocity(block);
    if (w.strains_early) find_reached(block, scratch);
  }
  for_sets(block, [&](ParticleSet& set, int body) {
    int const f = w.field_of[body];
    FieldScratch const& nodes = scratch.of[f];
    SetView const view{&set, &bodies_[body], &patch, patch.h};
    bool const own = !proxies_.owns(block, set);
    NodeVelocity* back = w.maps_back ? w.velocity[w.slot(block, f)].data() : nullptr;
    char const* wanted = w.slips[f] != 0 && w.early[f] != 0 ? scratch.reached.data() : nullptr;
    with_kernels(options_.shape, patch.dimensions, [&](auto kernels) {
      if (own) {
        if (rules_[body].books_work) {
          std::optional<CellMeans> means;
          if (options_.locking_control && bodies_[body].solid.has_deviator()) means = mean_pressures(view, scratch);
          kernels.book_work(view, hoops, dt, nodes.middle.data(), nodes.forced.data(), nodes.changed.data(),
                            means ? &*means : nullptr);
        }
        w.dissipation[block] += kernels.move(view, options_, dt, rules_[body], nodes, back, wanted);
        w.work[block] += work_on(block, body, outer);
      } else {
        for (int d = 0; d < 3; ++d) {
          std::copy_n(set.field(Field::next_x + d), set.size(), set.field(Field::velocity_x + d));
        }
        if (back != nullptr) kernels.map_velocity(view, Field::velocity_x, back, wanted);
      }
    });
  });
}

void Mpm::integrate(double dt) {
  PhaseTimer const timer(timings_["momentum and motion"]);
  Workspace& w = *work_;
  Hoops const hoops = hoops_of(grid_.domain().geometry);
  OuterForces const outer = outer_forces();
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Scratch& scratch = w.scratch[thread];
    gather_sums(block, scratch);
    if (w.contact) gather_gradients(block, scratch);
    if (w.touches && options_.order != StressOrder::usf) gather_extents(block, scratch);
    gather_gaps(block, scratch);
    if (w.slides) {
      weigh_images(block, scratch, true);
      share_pressure(block, dt, scratch);
    }
    find_velocity(block, dt, scratch);
    constrain_motion(block, dt, scratch);
    share_momentum(block, scratch);
    if (proxies_.body() >= 0) collect_gifts(block, dt, scratch);
    if (w.counts_energy) find_taken(block, dt, scratch);
    if (w.books_work) note_changes(block, scratch);
    if (options_.order != StressOrder::usf) signals_[block] = 0.0;  // usf has found them already
    move_particles(block, dt, hoops, outer, scratch);
    if (w.strains_early) strain_with_motion(block, hoops, dt, scratch);
  });
}

/// USL: strain by the nodes' new velocity, while it is at hand.
void Mpm::strain_with_motion(int block, Hoops const& hoops, double dt, Scratch& scratch) {
  Workspace& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    if (!scratch.of[f].present) continue;
    NodeMotion const* from = scratch.of[f].motion.data();
    NodeVelocity* to = scratch.of[f].velocity.get(count);
    for (int node = 0; node < count; ++node) to[node] = from[node].velocity;
    if (!w.keeps_energy) continue;
    NodeVelocity* before = scratch.of[f].before.get(count);
    for (int node = 0; node < count; ++node) before[node] = from[node].velocity - from[node].change;
  }
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
    if (rules_[body].order == StressOrder::usl) update_set(block, body, hoops, dt, scratch);
  }
}

/// The sums of all blocks around, at the nodes of one.
void Mpm::gather_sums(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  for (int f = 0; f < w.fields; ++f) {
    scratch.of[f].present = w.gather_moving(w.state, w.present, block, f, scratch.of[f].sums);
  }
}

/// For `NodeWork::book_work`. What holds, friction and walls change of the nodes' velocity has accounts of its own:
/// those of holds and walls go first, before what forces do, that of friction in the middle of the whole change.
void Mpm::note_changes(int block, Scratch& scratch) const {
  int const count = work_->patches[block].count();
  for (int f = 0; f < work_->fields; ++f) {
    if (!scratch.of[f].present) continue;
    FieldScratch& s = scratch.of[f];
    NodeMotion const* nodes = s.motion.data();
    NodeVelocity const* exchange = s.exchanges ? s.exchange.data() : nullptr;
    NodeVelocity const* halt = s.halts ? s.halt.data() : nullptr;
    NodeVelocity const* meet = s.meets ? s.meet.data() : nullptr;
    NodeVelocity const* rub = s.rubs ? s.rub.data() : nullptr;
    NodeVelocity const* stop = s.stops ? s.stop.data() : nullptr;
    NodeVelocity* middle = s.middle.get(count);
    NodeVelocity* forced = s.forced.get(count);
    NodeVelocity* changed = s.changed.get(count);
    for (int node = 0; node < count; ++node) {
      NodeVelocity first{};
      if (halt != nullptr) first += halt[node];
      if (stop != nullptr) first += stop[node];
      NodeVelocity const change = nodes[node].change;
      middle[node] = nodes[node].velocity - 0.5 * (change - first);
      NodeVelocity const total = exchange == nullptr ? change : change + exchange[node];
      NodeVelocity own = total - first;
      if (rub != nullptr) own -= rub[node];
      changed[node] = total + first;
      // Contact takes part of what the stress does, and does no work itself.
      NodeVelocity const by_stress = meet == nullptr ? own : own - meet[node];
      own[3] = by_stress[0] * changed[node][0] + by_stress[1] * changed[node][1] + by_stress[2] * changed[node][2];
      forced[node] = own;
    }
  }
}

/// What proxy particles give to a node is linear in what they wrote there, once the node's new velocity is known: each
/// block books what its own wrote, and the sum over the copies of a node is the whole. At nodes that only proxy
/// particles reach it is nothing. Nodes that are another's copy, behind a periodic face or a mirror, count for that
/// one.
void Mpm::collect_gifts(int block, double dt, Scratch const& scratch) {
  Workspace const& w = *work_;
  std::vector<NodeGift>& gifts = proxies_.gifts(block);
  gifts.clear();
  int const f = w.field_of[proxies_.body()];
  if (!proxies_.any(block) || !scratch.of[f].present) return;
  Patch const& patch = w.patches[block];
  NodeMotion const* nodes = scratch.of[f].motion.data();
  NodeSums const* by_proxies = w.by_proxies[block].data();
  bool const takes_over = rules_[proxies_.body()].affine;
  // Index in the grid of the patch's first node.
  Index3 const first = grid_.blocks()[block].in_domain().grown(patch.reach, patch.dimensions).lower;
  for_each_cell(patch.all(), [&](Index3 const& within) {
    NodeSums const& l = by_proxies[patch.index(within)];
    NodeMotion const& n = nodes[patch.index(within)];
    if (!(l.momentum[3] > w.mass_floor)) return;
    auto const [index, sign] =
        grid::image_node(grid_.domain(), {first[0] + within[0], first[1] + within[1], first[2] + within[2]});
    NodeGift gift;
    gift.node = index;
    // Kinetic energy of all particles around per mass, with what the forces of the step add.
    double all = n.change[3] / n.velocity[3];
    for (int d = 0; d < 3; ++d) all += n.change[d] * (n.velocity[d] - 0.5 * n.change[d]);
    if (!means_something(n, all, dt, patch.h)) return;
    gift.energy = l.force[3] - l.momentum[3] * all;
    for (int d = 0; d < 3; ++d) {
      double const impulse = l.force[d] * dt;
      gift.impulse[d] = sign[d] * impulse;
      gift.work[d] = impulse * (n.velocity[d] - 0.5 * n.change[d]);
      // Particles of APIC take over the velocity of their nodes, all others add its change to their own.
      double const kept = takes_over ? l.momentum[d] - l.momentum[3] * n.velocity[d] : -l.momentum[3] * n.change[d];
      gift.momentum[d] = sign[d] * kept;
    }
    gifts.push_back(gift);
  });
}

/// Particles of APIC take over the velocity of their nodes, all others add its change to their own. Where both share
/// nodes the first give and take momentum there that the others must take and give: they add the difference between the
/// nodes' common velocity and their own one.
void Mpm::share_momentum(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    scratch.of[f].exchanges = false;
    if (w.shared[f] == 0 || !scratch.of[f].present) continue;
    if (!w.gather_moving(w.momentum, w.momentum_present, block, f, scratch.of[f].exchange)) continue;
    scratch.of[f].exchanges = true;
    NodeMotion* nodes = scratch.of[f].motion.data();
    NodeVelocity* exchange = scratch.of[f].exchange.data();
    NodeVelocity const* keep = scratch.of[f].meets ? scratch.of[f].keep.data() : nullptr;
    for (int node = 0; node < count; ++node) {
      double const own = exchange[node][3];
      // Where the others are alone the difference is round-off.
      bool const both = own > w.mass_floor && nodes[node].velocity[3] - own > 1e-12 * own;
      double const inverse = both ? 1.0 / own : 0.0;
      double const fraction = both ? 1.0 : 0.0;
      NodeVelocity const common =
          (keep == nullptr ? nodes[node].velocity : nodes[node].velocity + keep[node]) - nodes[node].change;
      NodeVelocity const alone = inverse * exchange[node];
      exchange[node] = fraction * common - alone;
      exchange[node][3] = own;
      // What is not in the common motion becomes heat of the first.
      nodes[node].change[3] += 0.5 * own * (alone[0] * alone[0] + alone[1] * alone[1] + alone[2] * alone[2]);
    }
  }
}

}  // namespace brisance::mpm
