/// What the particles beside the axis have in common with their neighbours; see `BesideAxis::even_out`.
#include <algorithm>

#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

bool Mpm::evens_out(int block, int body) const {
  grid::Domain const& domain = grid_.domain();
  if (grid::radial_exponent(domain.geometry) == 0) return false;
  return work_->patches[block].first[0] < even_cells * work_->patches[block].h && bodies_[body].solid.has_deviator() &&
         !bodies_[body].rigid_velocity && !particles(block, body).empty();
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
      SetView const view{&particles(block, body), &bodies_[body], &patch, patch.h};
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

}  // namespace brisance::mpm
