/// One step: the list of its passes, and those between points and nodes; see `mpm.hpp`.
#include <algorithm>
#include <optional>

#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

void Mpm::advance(double dt) {
  prepare_scratch();
  bool const first = options_.order == StressOrder::usf;
  // Eqs. (18)-(21). Where the stress comes first, what the forces of the old one do tells which nodes walls stop and
  // which bodies close in on each other.
  map_to_grid(true, !first || work_->stops || work_->touches);
  if (first) {
    update_stress(dt);  // Eqs. (27)-(30)
    // Points that stretched with the stress weigh on their nodes anew.
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
      NodeSums* nodes = w.state[w.slot(block, f)].data();
      // The scalar is the kinetic energy of APIC's points, which came with the mass.
      for (int node = 0; node < patch.count(); ++node) nodes[node].force *= NodeVelocity{0.0, 0.0, 0.0, 1.0};
    }
    for_sets(block, [&](PointSet& set, int body) {
      int const slot = w.slot(block, w.field_of[body]);
      NodeSums* nodes = w.state[slot].get(patch.count());
      bool const surface = w.contact && w.slips[w.field_of[body]] == 0;
      NodeVelocity* gradient = surface ? w.gradient[slot].get(patch.count()) : nullptr;
      if (w.present[slot] == 0) {
        std::fill(nodes, nodes + patch.count(), NodeSums{});
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
          NodeSums* alone = w.lent[block].get(patch.count());
          std::fill(alone, alone + patch.count(), NodeSums{});
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
        if (with_mass && w.shared[w.field_of[body]] != 0 && !rules_[body].affine) {
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
