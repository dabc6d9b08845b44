/// Conduction of heat in shocks, see `Body::shock_conduction`.
#include <algorithm>

#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

void Mpm::conduct() {
  PhaseTimer const timer(timings_["heat in shocks"]);
  Workspace& w = *work_;
  int const bodies = static_cast<int>(bodies_.size());
  auto const each_set = [&](int block, auto&& work) {
    for (int body = 0; body < bodies; ++body) {
      ParticleSet& set = particles(block, body);
      if (set.empty() || bodies_[body].shock_conduction <= 0.0) continue;
      SetView const view{&set, &bodies_[body], &w.patches[block], w.patches[block].h};
      with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) { work(body, view, kernels); });
    }
  };
  // Blocks without a shock have nothing to exchange but with their neighbours.
  std::fill(w.shocked.begin(), w.shocked.end(), 0);
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    int const block = active_[n];
    bool shocked = false;
    for (int body = 0; body < bodies; ++body) {
      ParticleSet const& set = particles(block, body);
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
      if (!scratch.of[f].present) continue;
      NodeVelocity* nodes = scratch.of[f].velocity.data();
      for (int node = 0; node < count; ++node) nodes[node][0] *= nodes[node][1];
    }
    each_set(block, [&](int body, SetView const& view, auto kernels) {
      w.conducted[block] += kernels.take_heat(view, scratch.of[w.field_of[body]].velocity.data());
    });
  });
}

}  // namespace brisance::mpm
