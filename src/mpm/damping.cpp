/// Damping of bodies that settle: their particles lose velocity at a constant rate; see `Options::damping`.
#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

/// Multiplies components of a field that the particles may carry by `factor`. Returns the sum of their squares times
/// the mass before.
double scale(ParticleSet& set, Field first, int components, double factor) {
  double const* mass = set.field(Field::mass);
  double sum = 0.0;
  for (int c = 0; c < components; ++c) {
    double* x = set.field(first + c);
    if (x == nullptr) continue;
    for (int q = 0; q < set.size(); ++q) {
      sum += mass[q] * x[q] * x[q];
      x[q] *= factor;
    }
  }
  return sum;
}

}  // namespace

void Mpm::damp(double dt) {
  double const span = std::min(dt, options_.damping_end - time_);
  if (!(options_.damping > 0.0) || !(span > 0.0)) return;
  PhaseTimer const timer(timings_["damping"]);
  Workspace& w = *work_;
  double const factor = std::exp(-options_.damping * span);
  w.damped.assign(static_cast<std::size_t>(grid_.block_count()), 0.0);
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    int const block = active_[n];
    double const h = grid_.blocks()[block].h();
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
      if (!bodies_[body].damped || bodies_[body].rigid_velocity) continue;
      ParticleSet& set = particles(block, body);
      double squares = scale(set, Field::velocity_x, 3, factor);
      // As in `affine_energy`.
      double const gradients =
          0.25 * scale(set, Field::affine_xx, 9, factor) + 0.0625 * scale(set, Field::cross_xy, 9, factor);
      if (rules_[body].has_gradient_energy) squares += h * h * gradients;
      w.damped[block] += 0.5 * squares * (1.0 - factor * factor);
    }
  });
  for (double const taken : w.damped) accounts_.dissipation.damping += taken;
}

}  // namespace brisance::mpm
