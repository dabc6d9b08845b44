#include "observe/kinetic_energy.hpp"

#include "core/parallel.hpp"
#include "run/system.hpp"

namespace brisance::observe {

namespace {

double gas_energy(run::System const& w) {
  // One sum per block, then over blocks in order: the same bits for any number of threads.
  std::vector<double> parts(static_cast<std::size_t>(w.grid.block_count()), 0.0);
  int const fluids = w.gas->fluids().count;
  parallel_for(w.grid.block_count(), [&](int b, int) {
    grid::Block const& block = w.grid.blocks()[b];
    auto const& fields = w.gas->fields();
    for_each_row(block, [&](grid::Cell const& first) {
      double row = 0.0;
      for (int i = 0; i < block.n[0]; ++i) {
        grid::Cell const cell = block.cell(i, first.j, first.k);
        if (!w.gas->coupling.is_own(cell)) continue;
        int const at = cell.offset;
        double const density = gas::mixture_density(fluids, [&](int c) { return fields.at(b, c)[at]; });
        double square = 0.0;
        for (int d = 0; d < 3; ++d) {
          double const m = fields.at(b, gas::momentum_x + d)[at];
          square += m * m;
        }
        if (square > 0.0) row += 0.5 * square / density * block.volume(cell);
      }
      parts[b] += row;
    });
  });
  double sum = 0.0;
  for (double const part : parts) sum += part;
  return sum;
}

}  // namespace

double kinetic_energy(run::System const& system) {
  double sum = system.gas == nullptr ? 0.0 : gas_energy(system);
  auto const& points = system.points;
  for (int body = 0; points != nullptr && body < static_cast<int>(points->bodies().size()); ++body)
    sum += points->sums(body).kinetic_energy;
  return sum;
}

}  // namespace brisance::observe
