/// The pass over strain and stress; see `mpm.hpp`.
#include <algorithm>

#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

void Mpm::update_set(int block, int body, Hoops const& hoops, double dt, Scratch& scratch) {
  Workspace& w = *work_;
  ParticleSet& set = particles(block, body);
  if (set.empty()) return;
  double fastest = 0.0;
  if (bodies_[body].rigid_velocity) {
    fastest = norm(*bodies_[body].rigid_velocity);
  } else {
    SetView const view{&set, &bodies_[body], &w.patches[block], w.patches[block].h};
    NodeVelocity const* filled = nullptr;
    if (bodies_[body].fills_space && w.gather(w.filled, w.filled_present, block, w.filling, scratch.filled, true))
      filled = scratch.filled.data();
    NodeVelocity const* even = evens_out(block, body) ? gather_even(block, body, scratch, true) : nullptr;
    with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) {
      NodeVelocity const* before = rules_[body].settles_work ? scratch.of[w.field_of[body]].before.data() : nullptr;
      fastest = kernels.update(view, options_, hoops, time_, dt, scratch.of[w.field_of[body]].velocity.data(), before,
                               filled, even, rules_[body].books_work, scratch);
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
      find_old_velocity(block, scratch);
    } else {
      gather_velocity(block, scratch);
    }
    if (w.slides || (first && w.touches)) gather_gradients(block, scratch);
    gather_gaps(block, scratch);
    if (first && w.touches) {
      gather_extents(block, scratch);
      find_meetings(block, dt, scratch, true);
    }
    if (w.slides) weigh_images(block, scratch, false);
    constrain_velocity(block, dt, scratch);
    if (first) signals_[block] = 0.0;
    for (int body = 0; body < bodies; ++body) {
      if (rules_[body].order != StressOrder::usl) update_set(block, body, hoops, dt, scratch);
    }
  });
}

/// The nodes' velocity before the step.
void Mpm::find_old_velocity(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  gather_sums(block, scratch);
  for (int f = 0; f < w.fields; ++f) {
    if (!scratch.of[f].present) continue;
    NodeSums const* nodes = scratch.of[f].sums.data();
    NodeVelocity* to = scratch.of[f].velocity.get(count);
    for (int node = 0; node < count; ++node) {
      Lanes4 const& p = nodes[node].momentum;
      double const inverse = p[3] > w.mass_floor ? 1.0 / p[3] : 0.0;
      to[node] = p * Lanes4{inverse, inverse, inverse, 1.0};
    }
  }
}

}  // namespace brisance::mpm
