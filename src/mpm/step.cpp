/// The passes of one step over the blocks; see `mpm.hpp`.
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

double amplitude(ActiveLoad const& load, double time) {
  if (time < load.times.front() || time > load.times.back()) return 0.0;
  for (std::size_t n = 1; n < load.times.size(); ++n) {
    if (time > load.times[n]) continue;
    double const s = (time - load.times[n - 1]) / (load.times[n] - load.times[n - 1]);
    return (1.0 - s) * load.pressures[n - 1] + s * load.pressures[n];
  }
  return load.pressures.back();
}

/// Mean of pressure and bulk viscosity over each cell of a set.
CellMeans mean_pressures(SetView const& v, Scratch& scratch) {
  PointSet const& set = *v.set;
  double const* mass = set.field(Field::mass);
  double const* density = set.field(Field::density);
  double const* pressure = set.field(Field::pressure);
  double const* viscosity = set.field(Field::viscosity);
  CellMeans means(v, scratch);
  for (int q = 0; q < set.size(); ++q) means.add(q, mass[q] / density[q], pressure[q] + viscosity[q]);
  return means;
}

}  // namespace

void Mpm::advance(double dt) {
  if (static_cast<int>(work_->scratch.size()) < threads()) work_->scratch.resize(threads());
  for (Scratch& scratch : work_->scratch) {
    scratch.state.resize(work_->fields);
    scratch.velocity.resize(work_->fields);
    scratch.before.resize(work_->fields);
    scratch.gradient.resize(work_->fields);
    scratch.area.resize(work_->fields);
    scratch.extent.resize(work_->fields);
    scratch.present.resize(work_->fields);
    scratch.exchange.resize(work_->fields);
    scratch.exchanges.resize(work_->fields);
    scratch.halt.resize(work_->fields);
    scratch.halts.resize(work_->fields);
    scratch.meet.resize(work_->fields);
    scratch.rub.resize(work_->fields);
    scratch.meets.resize(work_->fields);
    scratch.rubs.resize(work_->fields);
    scratch.keep.resize(work_->fields);
    scratch.stop.resize(work_->fields);
    scratch.stops.resize(work_->fields);
    scratch.gap.resize(work_->fields);
    scratch.whole.resize(work_->fields);
    scratch.wholes.resize(work_->fields);
    scratch.middle.resize(work_->fields);
    scratch.forced.resize(work_->fields);
    scratch.changed.resize(work_->fields);
  }
  bool const first = options_.order == StressOrder::usf;
  if (first) {
    // What the forces of the old stress do tells what walls stop and which bodies close in on each other.
    map_to_grid(true, work_->stops || work_->touches);
    update_stress(dt);
    // Points that stretched with the stress weigh on their nodes anew.
    map_to_grid(options_.shape == ShapeFunction::cpgimp, true);
  } else {
    map_to_grid(true, true);
  }
  if (work_->filters) filter();
  integrate(dt);
  if (!first) update_stress(dt);
  if (work_->conducts) conduct();
  collect_signals();
  time_ += dt;
  ++step_;
  migrate();
}

void Mpm::map_to_grid(bool with_mass, bool with_forces) {
  PhaseTimer const timer(timings_["points to grid"]);
  Workspace& w = *work_;
  double const h = grid_.domain().h;
  Hoops const hoops = hoops_of(grid_.domain().geometry);
  OuterForces const outer = outer_forces();
  bool const again = with_forces && !with_mass && (w.stops || w.touches);
  if (with_mass) std::fill(w.present.begin(), w.present.end(), 0);
  if (with_mass) std::fill(w.momentum_present.begin(), w.momentum_present.end(), 0);
  if (with_forces) std::fill(w.area_present.begin(), w.area_present.end(), 0);
  if (with_mass) std::fill(w.even_present.begin(), w.even_present.end(), 0);
  if (with_mass) std::fill(w.filled_present.begin(), w.filled_present.end(), 0);
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Patch const& patch = w.patches[block];
    for (int f = 0; again && f < w.fields; ++f) {
      if (w.present[w.slot(block, f)] == 0) continue;
      NodeState* nodes = w.state[w.slot(block, f)].data();
      // The scalar is the kinetic energy of APIC's points, which came with the mass.
      for (int node = 0; node < patch.count(); ++node) nodes[node].force *= NodeVelocity{0.0, 0.0, 0.0, 1.0};
    }
    for_sets(block, [&](PointSet& set, int body) {
      int const slot = w.slot(block, w.field_of[body]);
      NodeState* nodes = w.state[slot].get(patch.count());
      bool const surface = w.contact && w.slips[w.field_of[body]] == 0;
      NodeVelocity* gradient = surface ? w.gradient[slot].get(patch.count()) : nullptr;
      if (w.present[slot] == 0) {
        std::fill(nodes, nodes + patch.count(), NodeState{});
        if (gradient != nullptr) std::fill(gradient, gradient + patch.count(), NodeVelocity{});
        w.present[slot] = 1;
      }
      SetView const view{&set, &bodies_[body], &patch, h};
      std::optional<CellMeans> means;
      if (with_forces && options_.locking_control && bodies_[body].solid.has_deviator())
        means = mean_pressures(view, w.scratch[thread]);
      CellMeans const* mean = means ? &*means : nullptr;
      with_kernels(options_.shape, patch.dimensions, [&](auto kernels) {
        bool const lent = lent_body_ >= 0 && &set == &lent_[block];
        if (with_mass && with_forces) {
          kernels.template map_state<true, true>(view, hoops, outer, mean, nodes);
        } else if (with_mass) {
          kernels.template map_state<true, false>(view, hoops, outer, mean, nodes);
        } else {
          kernels.template map_state<false, true>(view, hoops, outer, mean, nodes);
        }
        if (lent && with_forces) {
          // Once more alone: what they give to the others is booked.
          NodeState* alone = w.lent[block].get(patch.count());
          std::fill(alone, alone + patch.count(), NodeState{});
          kernels.template map_state<true, true>(view, hoops, outer, mean, alone);
        }
        if (with_mass && !lent && evens_out(block, body)) {
          int const at = set_index(block, body);
          NodeVelocity* even = w.even[at].get(patch.count());
          std::fill(even, even + patch.count(), NodeVelocity{});
          w.even_present[at] = 1;
          kernels.map_even(view, grid_.domain().geometry, even);
        }
        if (with_mass && w.filling >= 0) kernels.map_filled(view, grid_.domain().geometry, filled_nodes(block));
        if (NodeVelocity* area = with_forces && w.slides ? area_nodes(block, body) : nullptr) {
          if (w.slips[w.field_of[body]] != 0) {
            kernels.map_pressure(view, area);
          } else {
            kernels.map_area(view, hoops, area);
          }
        }
        if (with_mass && gradient != nullptr) kernels.map_gradient(view, grid_.domain().geometry, w.slides, gradient);
        if (with_mass && w.shared[w.field_of[body]] != 0 && !affine(body)) {
          NodeVelocity* own = w.momentum[slot].get(patch.count());
          if (w.momentum_present[slot] == 0) std::fill(own, own + patch.count(), NodeVelocity{});
          w.momentum_present[slot] = 1;
          kernels.map_velocity(view, Field::velocity_x, own);
        }
      });
    });
    if (with_mass && w.slides) continue_behind_ends(block);
    if (with_mass) map_gaps(block);
  });
  if (with_mass) map_even_again();
  if (with_mass && w.touches) map_extents();
}

OuterForces Mpm::outer_forces() const {
  OuterForces outer;
  for (ActiveLoad const& load : work_->loads) {
    Vec3 p{0.0, 0.0, 0.0};
    for (ActiveLoad::Part const& part : load.parts)
      p = p + amplitude(work_->loads[static_cast<std::size_t>(part.load)], time_) * part.direction;
    if (load.parts.empty()) p.fill(amplitude(load, time_));
    outer.pressures.push_back(p);
  }
  outer.body_force = options_.body_force;
  outer.acceleration = options_.acceleration;
  outer.time = time_;
  return outer;
}

double Mpm::work_on(int block, int body, OuterForces const& outer) const {
  PointSet const& set = points(block, body);
  if (bodies_[body].rigid_velocity) return 0.0;
  Vec3 const& g = options_.body_force;
  double const* load_number = set.field(Field::load_number);
  double const* mass = set.field(Field::mass);
  double work = 0.0;
  if (dot(g, g) > 0.0) {
    for (int d = 0; d < 3; ++d) {
      double const* move = set.field(Field::move_x + d);
      for (int q = 0; q < set.size(); ++q) work += mass[q] * g[d] * move[q];
    }
  }
  if (outer.acceleration) {
    for (int q = 0; q < set.size(); ++q) {
      Vec3 const a = outer.acceleration(
          {set.field(Field::position_x)[q], set.field(Field::position_y)[q], set.field(Field::position_z)[q]},
          outer.time);
      for (int d = 0; d < 3; ++d) work += mass[q] * a[d] * set.field(Field::move_x + d)[q];
    }
  }
  if (load_number != nullptr) {
    for (int q = 0; q < set.size(); ++q) {
      if (load_number[q] <= 0.0) continue;
      double const volume = mass[q] / set.field(Field::density)[q];
      Vec3 const& p = outer.pressures[static_cast<std::size_t>(load_number[q]) - 1];
      for (int d = 0; d < 3; ++d)
        work += volume * p[d] * set.field(Field::load_x + d)[q] * set.field(Field::move_x + d)[q];
    }
  }
  return work;
}

void Mpm::filter() {
  PhaseTimer const timer(timings_["filter"]);
  Workspace& w = *work_;
  double const h = grid_.domain().h;
  auto const each_set = [&](int block, auto&& work) {
    for_sets(block, [&](PointSet& set, int body) {
      if (!set.fields().has(Field::filtered_x)) return;
      SetView const view{&set, &bodies_[body], &w.patches[block], h};
      with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) { work(body, view, kernels); });
    });
  };
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    for_sets(active_[n], [&](PointSet& set, int) {
      if (!set.fields().has(Field::filtered_x)) return;
      for (int d = 0; d < 3; ++d) {
        double const* v = set.field(Field::velocity_x + d);
        std::copy(v, v + set.size(), set.field(Field::filtered_x + d));
      }
    });
  });
  for (int pass = 0; pass < options_.xpic_order; ++pass) {
    parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
      int const block = active_[n];
      clear_velocity(block);
      each_set(block, [&](int body, SetView const& view, auto kernels) {
        kernels.map_velocity(view, Field::filtered_x, w.velocity[w.slot(block, w.field_of[body])].data());
      });
    });
    parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
      int const block = active_[n];
      Scratch& scratch = w.scratch[thread];
      gather_velocity(block, scratch);
      each_set(block, [&](int body, SetView const& view, auto kernels) {
        kernels.filter(view, scratch.velocity[w.field_of[body]].data());
      });
    });
  }
}

void Mpm::conduct() {
  PhaseTimer const timer(timings_["heat in shocks"]);
  Workspace& w = *work_;
  int const bodies = static_cast<int>(bodies_.size());
  double const h = grid_.domain().h;
  auto const each_set = [&](int block, auto&& work) {
    for (int body = 0; body < bodies; ++body) {
      PointSet& set = points(block, body);
      if (set.empty() || bodies_[body].shock_conduction <= 0.0) continue;
      SetView const view{&set, &bodies_[body], &w.patches[block], h};
      with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) { work(body, view, kernels); });
    }
  };
  // Blocks without a shock have nothing to exchange but with their neighbours.
  std::fill(w.shocked.begin(), w.shocked.end(), 0);
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    int const block = active_[n];
    bool shocked = false;
    for (int body = 0; body < bodies; ++body) {
      PointSet const& set = points(block, body);
      if (set.empty() || bodies_[body].shock_conduction <= 0.0) continue;
      double const* p = set.field(Field::pressure);
      double const* q = set.field(Field::viscosity);
      for (int k = 0; k < set.size() && !shocked; ++k) shocked = q[k] > 1e-3 * p[k];
    }
    w.shocked[block] = shocked ? 1 : 0;
  });
  auto const near_shock = [&](int block) {
    auto const& around = w.around[block];
    return std::any_of(around.begin(), around.end(),
                       [&](int other) { return other != grid::no_neighbour && w.shocked[other] != 0; });
  };
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    int const block = active_[n];
    if (!near_shock(block)) {
      // Its neighbours may look at it all the same.
      bool const seen = std::any_of(w.around[block].begin(), w.around[block].end(),
                                    [&](int other) { return other != grid::no_neighbour && near_shock(other); });
      if (!seen) return;
    }
    clear_velocity(block);
    each_set(block, [&](int body, SetView const& view, auto kernels) {
      kernels.map_heat(view, w.velocity[w.slot(block, w.field_of[body])].data());
    });
  });
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    if (!near_shock(block)) return;
    Scratch& scratch = w.scratch[thread];
    gather_velocity(block, scratch, true);  // divides by the mass
    int const count = w.patches[block].count();
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.present[f] == 0) continue;
      NodeVelocity* nodes = scratch.velocity[f].data();
      for (int node = 0; node < count; ++node) nodes[node][0] *= nodes[node][1];
    }
    each_set(block, [&](int body, SetView const& view, auto kernels) {
      w.conducted[block] += kernels.take_heat(view, scratch.velocity[w.field_of[body]].data());
    });
  });
}

void Mpm::clear_velocity(int block) {
  Workspace& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    int const slot = w.slot(block, f);
    if (w.present[slot] == 0) continue;
    NodeVelocity* nodes = w.velocity[slot].get(count);
    std::fill(nodes, nodes + count, NodeVelocity{});
  }
}

void Mpm::gather_velocity(int block, Scratch& scratch, bool scalars) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    scratch.present[f] = w.gather_moving(w.velocity, w.present, block, f, scratch.velocity[f], scalars) ? 1 : 0;
    if (scratch.present[f] == 0) continue;
    NodeVelocity* nodes = scratch.velocity[f].data();
    double const floor = w.mass_floor;
    for (int node = 0; node < count; ++node) {
      double const m = nodes[node][3];
      double const inverse = m > floor ? 1.0 / m : 0.0;
      nodes[node] *= NodeVelocity{inverse, inverse, inverse, 1.0};
    }
  }
}

namespace {

/// Does the kinetic energy per mass of a node mean anything? Nodes of next to no gas, among solids whose surfaces push
/// it about, would pass more than a cell in the step by this energy or by what the forces change. No point follows
/// them: their parts in the points are as small as their mass.
bool means_something(NodeState const& node, double energy, double dt, double h) {
  double const changed = node.force[0] * node.force[0] + node.force[1] * node.force[1] + node.force[2] * node.force[2];
  return std::max(std::abs(energy), changed) * dt * dt <= h * h;
}

}  // namespace

void Mpm::integrate(double dt) {
  PhaseTimer const timer(timings_["momentum and motion"]);
  Workspace& w = *work_;
  int const bodies = static_cast<int>(bodies_.size());
  double const h = grid_.domain().h;
  bool const map_back = w.maps_back;
  bool const strain_here = w.strains_early;
  Hoops const hoops = hoops_of(grid_.domain().geometry);
  OuterForces const outer = outer_forces();
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Patch const& patch = w.patches[block];
    int const count = patch.count();
    Scratch& scratch = w.scratch[thread];
    for (int f = 0; f < w.fields; ++f) {
      scratch.present[f] = w.gather_moving(w.state, w.present, block, f, scratch.state[f]) ? 1 : 0;
    }
    if (w.contact) {
      gather_gradients(block, scratch);
      if (w.touches && options_.order != StressOrder::usf) gather_extents(block, scratch);
    }
    if (w.slides) {
      weigh_images(block, scratch, true);
      share_pressure(block, dt, scratch);
    }
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.present[f] == 0) continue;
      NodeState* nodes = scratch.state[f].data();
      // Eq. (22): from mass, momentum and force to the new velocity and its change.
      double const floor = w.mass_floor;
      for (int node = 0; node < count; ++node) {
        NodeState& r = nodes[node];
        double const m = r.momentum[3];
        double const inverse = m > floor ? 1.0 / m : 0.0;
        double const push = dt * inverse;
        r.force = r.force * Lanes4{push, push, push, 1.0};
        r.momentum = r.momentum * Lanes4{inverse, inverse, inverse, 1.0} + r.force * Lanes4{1.0, 1.0, 1.0, 0.0};
      }
    }
    constrain_state(block, dt, scratch);
    share_momentum(block, scratch);
    if (lent_body_ >= 0) collect_gifts(block, dt, scratch);
    if (options_.order != StressOrder::usf) signals_[block] = 0.0;  // usf has found them already
    if (w.counts_energy) {
      // In the place of the mass: kinetic energy of the points around per mass, with what the forces of the step add.
      // Where APIC's points share nodes with others, which keep to the increments, all heat is theirs.
      for (int f = 0; f < w.fields; ++f) {
        if (scratch.present[f] == 0) continue;
        NodeState* nodes = scratch.state[f].data();
        NodeVelocity const* others = scratch.exchanges[f] == 0 ? nullptr : scratch.exchange[f].data();
        for (int node = 0; node < count; ++node) {
          NodeState& r = nodes[node];
          double const m = r.momentum[3];
          double const of_others = others == nullptr ? 0.0 : others[node][3];
          if (of_others > w.mass_floor) {
            double before = 0.0;
            double after = 0.0;
            for (int d = 0; d < 3; ++d) {
              before += (r.momentum[d] - r.force[d]) * (r.momentum[d] - r.force[d]);
              after += r.momentum[d] * r.momentum[d];
            }
            double const own = m - of_others;
            r.momentum[3] = own > 1e-12 * m ? (r.force[3] - 0.5 * m * before) / own + 0.5 * after : 0.5 * after;
            continue;
          }
          double sum = m > w.mass_floor ? r.force[3] / m : 0.0;
          for (int d = 0; d < 3; ++d) sum += r.force[d] * (r.momentum[d] - 0.5 * r.force[d]);
          r.momentum[3] = w.heats[f] == 0 || means_something(r, sum, dt, h) ? sum : 0.0;
        }
      }
    }

    if (w.books_work) note_changes(scratch, count);

    if (map_back) clear_velocity(block);
    for_sets(block, [&](PointSet& set, int body) {
      int const f = w.field_of[body];
      SetView const view{&set, &bodies_[body], &patch, h};
      bool const own = lent_body_ < 0 || &set != &lent_[block];
      with_kernels(options_.shape, patch.dimensions, [&](auto kernels) {
        if (own) {
          auto const known = [f](std::vector<char> const& which, std::vector<NodeArray<NodeVelocity>> const& changes) {
            return which[f] == 0 ? nullptr : changes[f].data();
          };
          NodeChanges const changes{known(scratch.exchanges, scratch.exchange), known(scratch.halts, scratch.halt),
                                    known(scratch.rubs, scratch.rub), known(scratch.stops, scratch.stop),
                                    known(scratch.meets, scratch.keep)};
          if (books_work(body)) {
            std::optional<CellMeans> means;
            if (options_.locking_control && bodies_[body].solid.has_deviator()) means = mean_pressures(view, scratch);
            kernels.book_work(view, hoops, dt, scratch.middle[f].data(), scratch.forced[f].data(),
                              scratch.changed[f].data(), means ? &*means : nullptr);
          }
          ApicEnergy const fate{keeps_energy(body), has_gradient_energy(body)};
          w.dissipation[block] += kernels.move(view, options_, dt, fate, scratch.state[f].data(), changes);
          w.work[block] += work_on(block, body, outer);
        } else {
          for (int d = 0; d < 3; ++d) {
            std::copy_n(set.field(Field::next_x + d), set.size(), set.field(Field::velocity_x + d));
          }
        }
        if (map_back) kernels.map_velocity(view, Field::velocity_x, w.velocity[w.slot(block, f)].data());
      });
    });
    if (!strain_here) return;
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.present[f] == 0) continue;
      NodeState const* from = scratch.state[f].data();
      NodeVelocity* to = scratch.velocity[f].get(count);
      for (int node = 0; node < count; ++node) to[node] = from[node].momentum;
      if (scratch.meets[f] != 0) {
        NodeVelocity const* keep = scratch.keep[f].data();
        for (int node = 0; node < count; ++node) to[node] -= keep[node];
      }
      if (!w.keeps_energy) continue;
      NodeVelocity* before = scratch.before[f].get(count);
      for (int node = 0; node < count; ++node) before[node] = from[node].momentum - from[node].force;
    }
    for (int body = 0; body < bodies; ++body) {
      if (order_of(body) == StressOrder::usl) update_set(block, body, hoops, dt, scratch);
    }
  });
}

/// For `NodeWork::book_work`. What holds, friction and walls change of the nodes' velocity has accounts of its own:
/// those of holds and walls go first, before what forces do, that of friction in the middle of the whole change.
void Mpm::note_changes(Scratch& scratch, int count) const {
  for (int f = 0; f < work_->fields; ++f) {
    if (scratch.present[f] == 0) continue;
    NodeState const* nodes = scratch.state[f].data();
    auto const of = [f](std::vector<char> const& known, std::vector<NodeArray<NodeVelocity>> const& changes) {
      return known[f] == 0 ? nullptr : changes[f].data();
    };
    NodeVelocity const* exchange = of(scratch.exchanges, scratch.exchange);
    NodeVelocity const* halt = of(scratch.halts, scratch.halt);
    NodeVelocity const* meet = of(scratch.meets, scratch.meet);
    NodeVelocity const* rub = of(scratch.rubs, scratch.rub);
    NodeVelocity const* stop = of(scratch.stops, scratch.stop);
    NodeVelocity const* keep = of(scratch.meets, scratch.keep);
    NodeVelocity* middle = scratch.middle[f].get(count);
    NodeVelocity* forced = scratch.forced[f].get(count);
    NodeVelocity* changed = scratch.changed[f].get(count);
    for (int node = 0; node < count; ++node) {
      NodeVelocity first{};
      if (halt != nullptr) first += halt[node];
      if (stop != nullptr) first += stop[node];
      NodeVelocity const change = nodes[node].force;
      // The nodes move with what contact lets them.
      NodeVelocity const moves = keep == nullptr ? nodes[node].momentum : nodes[node].momentum - keep[node];
      middle[node] = moves - 0.5 * (change - first);
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

NodeVelocity* Mpm::filled_nodes(int block) {
  Workspace& w = *work_;
  int const slot = w.slot(block, w.filling);
  int const count = w.patches[block].count();
  NodeVelocity* nodes = w.filled[slot].get(count);
  if (w.filled_present[slot] == 0) std::fill(nodes, nodes + count, NodeVelocity{});
  w.filled_present[slot] = 1;
  return nodes;
}

/// What lent points give to a node is linear in what they wrote there, once the node's new velocity is known: each
/// block books what its own wrote, and the sum over the copies of a node is the whole. At nodes that only lent points
/// reach it is nothing. Nodes that are another's copy, behind a periodic face or a mirror, count for that one.
void Mpm::collect_gifts(int block, double dt, Scratch const& scratch) {
  Workspace const& w = *work_;
  std::vector<NodeGift>& gifts = gifts_[block];
  gifts.clear();
  int const f = w.field_of[lent_body_];
  if (lent_[block].empty() || scratch.present[f] == 0) return;
  double const h = grid_.domain().h;
  Patch const& patch = w.patches[block];
  NodeState const* nodes = scratch.state[f].data();
  NodeState const* lent = w.lent[block].data();
  bool const takes_over = affine(lent_body_);
  for (int k = 0; k < patch.n[2]; ++k) {
    for (int j = 0; j < patch.n[1]; ++j) {
      for (int i = 0; i < patch.n[0]; ++i) {
        NodeState const& l = lent[patch.index(i, j, k)];
        NodeState const& n = nodes[patch.index(i, j, k)];
        if (!(l.momentum[3] > w.mass_floor)) continue;
        Index3 node{i, j, k};
        for (int d = 0; d < patch.dimensions; ++d) node[d] += grid_.blocks()[block].origin[d] - patch.reach;
        auto const [index, sign] = grid::image_node(grid_.domain(), node);
        NodeGift gift;
        gift.node = index;
        // Kinetic energy of all points around per mass, with what the forces of the step add.
        double all = n.force[3] / n.momentum[3];
        for (int d = 0; d < 3; ++d) all += n.force[d] * (n.momentum[d] - 0.5 * n.force[d]);
        if (!means_something(n, all, dt, h)) continue;
        gift.energy = l.force[3] - l.momentum[3] * all;
        for (int d = 0; d < 3; ++d) {
          double const impulse = l.force[d] * dt;
          gift.impulse[d] = sign[d] * impulse;
          gift.work[d] = impulse * (n.momentum[d] - 0.5 * n.force[d]);
          // Points of APIC take over the velocity of their nodes, all others add its change to their own.
          double const kept = takes_over ? l.momentum[d] - l.momentum[3] * n.momentum[d] : -l.momentum[3] * n.force[d];
          gift.momentum[d] = sign[d] * kept;
        }
        gifts.push_back(gift);
      }
    }
  }
}

bool Mpm::evens_out(int block, int body) const {
  grid::Domain const& domain = grid_.domain();
  if (grid::radial_exponent(domain.geometry) == 0) return false;
  return work_->patches[block].first[0] < even_cells * domain.h && bodies_[body].solid.has_deviator() &&
         !bodies_[body].rigid_velocity && !points(block, body).empty();
}

void Mpm::map_even_again() {
  Workspace& w = *work_;
  if (grid::radial_exponent(grid_.domain().geometry) == 0) return;
  PhaseTimer const timer(timings_["beside the axis"]);
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Patch const& patch = w.patches[block];
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
      if (!evens_out(block, body)) continue;
      NodeVelocity const* means = gather_even(block, body, w.scratch[thread], false);
      NodeVelocity* nodes = w.even_again[set_index(block, body)].get(patch.count());
      std::fill(nodes, nodes + patch.count(), NodeVelocity{});
      SetView const view{&points(block, body), &bodies_[body], &patch, grid_.domain().h};
      with_kernels(options_.shape, patch.dimensions,
                   [&](auto kernels) { kernels.map_even_again(view, grid_.domain().geometry, means, nodes); });
    }
  });
}

NodeVelocity* Mpm::gather_even(int block, int body, Scratch& scratch, bool again) const {
  Workspace const& w = *work_;
  Patch const& patch = w.patches[block];
  auto const gathered = [&](std::vector<NodeArray<NodeVelocity>> const& raw, NodeArray<NodeVelocity>& sum) {
    NodeVelocity* nodes = sum.get(patch.count());
    sum_links(
        patch, nodes,
        [&](int source) {
          int const from = set_index(source, body);
          return w.even_present[from] == 0 ? nullptr : raw[from].data();
        },
        true);
    for (int node = 0; node < patch.count(); ++node) {
      double const filled = nodes[node][3];
      double const inverse = filled > 0.0 ? 1.0 / filled : 0.0;
      nodes[node] *= NodeVelocity{inverse, inverse, inverse, 1.0};
    }
    return nodes;
  };
  NodeVelocity* means = gathered(w.even, scratch.even);
  if (!again) return means;
  NodeVelocity const* twice = gathered(w.even_again, scratch.even_again);
  for (int node = 0; node < patch.count(); ++node) means[node] = 2.0 * means[node] - twice[node];
  return means;
}

void Mpm::update_set(int block, int body, Hoops const& hoops, double dt, Scratch& scratch) {
  Workspace& w = *work_;
  PointSet& set = points(block, body);
  if (set.empty()) return;
  double fastest = 0.0;
  if (bodies_[body].rigid_velocity) {
    fastest = norm(*bodies_[body].rigid_velocity);
  } else {
    SetView const view{&set, &bodies_[body], &w.patches[block], grid_.domain().h};
    NodeVelocity const* filled = nullptr;
    if (bodies_[body].fills_space && w.gather(w.filled, w.filled_present, block, w.filling, scratch.filled, true))
      filled = scratch.filled.data();
    NodeVelocity const* even = evens_out(block, body) ? gather_even(block, body, scratch, true) : nullptr;
    with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) {
      NodeVelocity const* before = settles_work(body) ? scratch.before[w.field_of[body]].data() : nullptr;
      fastest = kernels.update(view, options_, hoops, time_, dt, scratch.velocity[w.field_of[body]].data(), before,
                               filled, even, books_work(body), scratch);
      if (bodies_[body].solid.is_gas()) w.floored[block] += kernels.lift_energy(view);
    });
  }
  signals_[block] = std::max(signals_[block], signal_weight(body) * fastest);
}

void Mpm::update_stress(double dt) {
  bool const first = options_.order == StressOrder::usf;
  if (!first && !work_->maps_back) return;  // `integrate` did it, while the nodes were at hand
  PhaseTimer const timer(timings_["strain and stress"]);
  Workspace& w = *work_;
  int const bodies = static_cast<int>(bodies_.size());
  Hoops const hoops = hoops_of(grid_.domain().geometry);
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Scratch& scratch = w.scratch[thread];
    if (first) {
      velocity_from_state(block, scratch);
    } else {
      gather_velocity(block, scratch);
    }
    if (w.slides || (first && w.touches)) gather_gradients(block, scratch);
    if (first && w.touches) {
      gather_extents(block, scratch);
      find_meetings(block, dt, scratch, true);
    }
    if (w.slides) weigh_images(block, scratch, false);
    constrain_velocity(block, dt, scratch);
    if (first) signals_[block] = 0.0;
    for (int body = 0; body < bodies; ++body) {
      if (order_of(body) != StressOrder::usl) update_set(block, body, hoops, dt, scratch);
    }
  });
}

void Mpm::velocity_from_state(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    scratch.present[f] = w.gather_moving(w.state, w.present, block, f, scratch.state[f]) ? 1 : 0;
    if (scratch.present[f] == 0) continue;
    NodeState const* nodes = scratch.state[f].data();
    NodeVelocity* to = scratch.velocity[f].get(count);
    for (int node = 0; node < count; ++node) {
      Lanes4 const& p = nodes[node].momentum;
      double const inverse = p[3] > w.mass_floor ? 1.0 / p[3] : 0.0;
      to[node] = p * Lanes4{inverse, inverse, inverse, 1.0};
    }
  }
}

}  // namespace brisance::mpm
