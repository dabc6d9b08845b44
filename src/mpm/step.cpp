/// One step: the list of its passes, and those between particles and nodes; see `mpm.hpp`.
#include <algorithm>
#include <optional>

#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

void Mpm::advance(double dt) {
  take_proxies();
  prepare_scratch();
  damp(dt);
  prescribe(dt);
  bool const first = options_.order == StressOrder::usf;
  // Eqs. (18)-(21). Where the stress comes first, what the forces of the old one do tells which nodes walls stop and
  // which bodies close in on each other.
  map_to_grid(true, !first || work_->stops || work_->touches);
  if (first) {
    update_stress(dt);  // Eqs. (27)-(30)
    // Particles that stretched with the stress weigh on their nodes anew.
    map_to_grid(options_.shape == ShapeFunction::cpgimp, true);
  }
  if (work_->filters) filter();
  integrate(dt);                  // Eqs. (22)-(26)
  if (!first) update_stress(dt);  // Eqs. (27)-(30)
  if (work_->conducts) conduct();
  collect_signals();
  time_ += dt;
  ++step_;
  migrate();
}

void Mpm::prepare_scratch() {
  if (static_cast<int>(work_->scratch.size()) < threads()) work_->scratch.resize(threads());
  for (Scratch& scratch : work_->scratch) scratch.of.resize(work_->fields);
}

/// What a pass from points to nodes writes, and what it needs for that.
struct Mapping {
  bool mass = false;  ///< and momentum
  bool forces = false;
  Hoops hoops;
  OuterForces outer;
};

void Mpm::map_to_grid(bool with_mass, bool with_forces) {
  PhaseTimer const timer(timings_["points to grid"]);
  Workspace& w = *work_;
  Mapping const mapping{with_mass, with_forces, hoops_of(grid_.domain().geometry), outer_forces()};
  bool const again = with_forces && !with_mass && (w.stops || w.touches);
  if (with_mass) {
    for (std::vector<char>* present : {&w.present, &w.momentum_present, &w.even_present, &w.filled_present})
      std::fill(present->begin(), present->end(), 0);
  }
  if (with_forces) std::fill(w.area_present.begin(), w.area_present.end(), 0);
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    for (int f = 0; again && f < w.fields; ++f) {
      if (w.present[w.slot(block, f)] == 0) continue;
      NodeSums* nodes = w.state[w.slot(block, f)].data();
      // The scalar is the kinetic energy of APIC's particles, which came with the mass.
      for (int node = 0; node < w.patches[block].count(); ++node) nodes[node].force *= NodeVelocity{0.0, 0.0, 0.0, 1.0};
    }
    for_sets(block, [&](ParticleSet& set, int body) {
      map_set(block, set, body, mapping, w.scratch[thread]);
      map_surroundings(block, set, body, mapping);
    });
    if (with_mass && w.slides) continue_behind_ends(block);
    if (with_mass) map_gaps(block);
  });
  if (with_mass) map_even_again();
  if (with_mass && w.touches) map_extents();
}

/// Mass, momentum and forces of a set.
void Mpm::map_set(int block, ParticleSet& set, int body, Mapping const& mapping, Scratch& scratch) {
  Workspace& w = *work_;
  Patch const& patch = w.patches[block];
  int const f = w.field_of[body];
  int const slot = w.slot(block, f);
  NodeSums* nodes = w.state[slot].get(patch.count());
  NodeVelocity* gradient = w.contact && w.slips[f] == 0 ? w.gradient[slot].get(patch.count()) : nullptr;
  if (w.present[slot] == 0) {
    std::fill(nodes, nodes + patch.count(), NodeSums{});
    if (gradient != nullptr) std::fill(gradient, gradient + patch.count(), NodeVelocity{});
    w.present[slot] = 1;
  }
  SetView const view{&set, &bodies_[body], &patch, patch.h};
  std::optional<CellMeans> means;
  if (mapping.forces && options_.locking_control && bodies_[body].solid.has_deviator())
    means = mean_pressures(view, scratch);
  CellMeans const* mean = means ? &*means : nullptr;
  Hoops const& hoops = mapping.hoops;
  OuterForces const& outer = mapping.outer;
  with_kernels(options_.shape, patch.dimensions, [&](auto kernels) {
    if (mapping.mass && mapping.forces) {
      kernels.template map_state<true, true>(view, hoops, outer, mean, nodes);
    } else if (mapping.mass) {
      kernels.template map_state<true, false>(view, hoops, outer, mean, nodes);
    } else {
      kernels.template map_state<false, true>(view, hoops, outer, mean, nodes);
    }
    if (mapping.forces && proxies_.owns(block, set)) {
      // Once more alone: what they give to the others is booked.
      NodeSums* alone = w.by_proxies[block].get(patch.count());
      std::fill(alone, alone + patch.count(), NodeSums{});
      kernels.template map_state<true, true>(view, hoops, outer, mean, alone);
    }
    if (mapping.mass && w.shared[f] != 0 && !rules_[body].affine) {
      NodeVelocity* own = w.momentum[slot].get(patch.count());
      if (w.momentum_present[slot] == 0) std::fill(own, own + patch.count(), NodeVelocity{});
      w.momentum_present[slot] = 1;
      kernels.map_velocity(view, Field::velocity_x, own);
    }
  });
}

/// What the nodes around a set must know of it beside that: where it is, its surface, and the pressure on surfaces.
void Mpm::map_surroundings(int block, ParticleSet& set, int body, Mapping const& mapping) {
  Workspace& w = *work_;
  Patch const& patch = w.patches[block];
  int const f = w.field_of[body];
  grid::Geometry const geometry = grid_.domain().geometry;
  SetView const view{&set, &bodies_[body], &patch, patch.h};
  with_kernels(options_.shape, patch.dimensions, [&](auto kernels) {
    if (mapping.mass && !proxies_.owns(block, set) && evens_out(block, body)) {
      int const at = set_index(block, body);
      NodeVelocity* even = w.even[at].get(patch.count());
      std::fill(even, even + patch.count(), NodeVelocity{});
      w.even_present[at] = 1;
      kernels.map_even(view, geometry, even);
    }
    if (mapping.mass && w.filling >= 0) kernels.map_filled(view, geometry, filled_nodes(block));
    if (NodeVelocity* area = mapping.forces && w.slides ? area_nodes(block, body) : nullptr) {
      if (w.slips[f] != 0) {
        kernels.map_pressure(view, area);
      } else {
        kernels.map_area(view, mapping.hoops, area);
      }
    }
    if (mapping.mass && w.contact && w.slips[f] == 0)
      kernels.map_gradient(view, geometry, w.slides, w.gradient[w.slot(block, f)].data());
  });
}

void Mpm::filter() {
  PhaseTimer const timer(timings_["filter"]);
  Workspace& w = *work_;
  auto const each_set = [&](int block, auto&& work) {
    for_sets(block, [&](ParticleSet& set, int body) {
      if (!set.fields().has(Field::filtered_x)) return;
      SetView const view{&set, &bodies_[body], &w.patches[block], w.patches[block].h};
      with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) { work(body, view, kernels); });
    });
  };
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    for_sets(active_[n], [&](ParticleSet& set, int) {
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
        kernels.filter(view, scratch.of[w.field_of[body]].velocity.data());
      });
    });
  }
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
    scratch.of[f].present = w.gather_moving(w.velocity, w.present, block, f, scratch.of[f].velocity, scalars);
    if (!scratch.of[f].present) continue;
    NodeVelocity* nodes = scratch.of[f].velocity.data();
    double const floor = w.mass_floor;
    for (int node = 0; node < count; ++node) {
      double const m = nodes[node][3];
      double const inverse = m > floor ? 1.0 / m : 0.0;
      nodes[node] *= NodeVelocity{inverse, inverse, inverse, 1.0};
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

}  // namespace brisance::mpm
