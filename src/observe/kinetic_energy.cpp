#include "observe/kinetic_energy.hpp"

#include "core/reduce.hpp"
#include "run/system.hpp"

namespace brisance::observe {

namespace {

double gas_energy(run::System const& w) {
  int const fluids = w.gas->fluids().count;
  return sum_over(w.grid.block_count(), [&](int b) {
    grid::Block const& block = w.grid.blocks()[b];
    auto const& fields = w.gas->fields();
    double sum = 0.0;
    if (block.covered) return sum;
    for_each_row(block, [&](grid::Cell const& first) {
      double row = 0.0;
      for (int i = 0; i < block.n[0]; ++i) {
        grid::Cell const cell = block.cell(i, first.j, first.k);
        if (!w.gas->coupling.is_own(cell) || block.is_covered(cell)) continue;
        int const at = cell.offset;
        double const density = gas::mixture_density(fluids, [&](int c) { return fields.at(b, c)[at]; });
        double square = 0.0;
        for (int d = 0; d < 3; ++d) {
          double const m = fields.at(b, gas::momentum_x + d)[at];
          square += m * m;
        }
        if (square > 0.0) row += 0.5 * square / density * w.gas->cut.volume(cell);
      }
      sum += row;
    });
    return sum;
  });
}

}  // namespace

double kinetic_energy(run::System const& system) {
  double sum = system.gas == nullptr ? 0.0 : gas_energy(system);
  for (run::Region const& region : system.regions) {
    for (std::size_t body = 0; body < region.bodies.size(); ++body)
      sum += mpm::sums(*region.particles, static_cast<int>(body)).kinetic_energy;
  }
  return sum;
}

}  // namespace brisance::observe
