/// Gauges: linear interpolation between cell centres, so that a gauge between two cells sees the shock between their
/// times.
#include <algorithm>
#include <cmath>

#include "core/timer.hpp"
#include "run/world.hpp"

namespace brisance::run {

namespace {

struct Stencil {
  std::vector<Index3> cells;
  std::vector<double> weights;
};

/// The cells around x and their weights; beyond the last cell centre the nearest cell counts alone.
Stencil stencil_at(grid::Domain const& domain, Vec3 const& x) {
  Stencil s;
  int const dims = domain.dimensions();
  Index3 low{0, 0, 0};
  Vec3 part{0.0, 0.0, 0.0};
  for (int d = 0; d < dims; ++d) {
    double const position =
        std::clamp((x[d] - domain.lower[d]) / domain.h - 0.5, 0.0, static_cast<double>(domain.cells[d] - 1));
    low[d] = std::min(static_cast<int>(position), domain.cells[d] - 2);
    part[d] = position - low[d];
  }
  for (int corner = 0; corner < 1 << dims; ++corner) {
    Index3 cell = low;
    double weight = 1.0;
    for (int d = 0; d < dims; ++d) {
      int const up = corner >> d & 1;
      cell[d] += up;
      weight *= up ? part[d] : 1.0 - part[d];
    }
    if (weight <= 0.0) continue;
    s.cells.push_back(cell);
    s.weights.push_back(weight);
  }
  return s;
}

}  // namespace

void World::sample_gauges() {
  if (gauges.empty()) return;
  PhaseTimer const timer(timings["gauges"]);
  for (GaugeHistory& history : gauges) {
    Stencil const s = stencil_at(setup.domain, history.gauge.position);
    std::vector<gas::Primitive> const states = gas->gather(s.cells);
    GaugeRecord record;
    record.time = clock.time;
    double sum = 0.0;
    for (std::size_t n = 0; n < states.size(); ++n) {
      int const b = grid.block_of(s.cells[n]);
      Index3 const& o = grid.blocks()[b].origin;
      if (gas->is_obstacle(b, s.cells[n][0] - o[0], s.cells[n][1] - o[1], s.cells[n][2] - o[2])) continue;
      double const weight = s.weights[n];
      sum += weight;
      record.pressure += weight * states[n].pressure;
      record.density += weight * states[n].density;
      record.velocity = record.velocity + weight * states[n].velocity;
    }
    if (sum > 0.0) {
      record.pressure /= sum;
      record.density /= sum;
      record.velocity = (1.0 / sum) * record.velocity;
    }
    history.records.push_back(record);
  }
}

}  // namespace brisance::run
