/// Conservation audit: what is in the domain, what left it, what the guards added.
#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "run/world.hpp"

namespace brisance::run {

std::array<double, 3> Audit::relative_error() const {
  auto const error = [](double before, double out, double added, double now) {
    double const scale = std::max({std::abs(before), std::abs(out), std::abs(now), 1e-300});
    return std::abs(before - out + added - now) / scale;
  };
  return {error(initial.mass[0], outflow.mass[0], guard_mass, current.mass[0]),
          error(initial.mass[1], outflow.mass[1], 0.0, current.mass[1]),
          error(initial.energy, outflow.energy, guard_energy + afterburn_energy, current.energy)};
}

namespace {

/// Without gas the mass is that of all bodies, with gas that of the two fluids in the gas points.
Totals totals_of(mpm::Mpm const& points, int gas_body = -1) {
  Totals total;
  for (int body = 0; body < static_cast<int>(points.bodies().size()); ++body) {
    mpm::BodySums const sums = points.sums(body);
    total.momentum = total.momentum + sums.momentum;
    total.energy += sums.kinetic_energy + sums.internal_energy;
    if (gas_body >= 0 && body != gas_body) continue;
    for (int f = 0; f < 2; ++f) total.mass[f] += sums.fluid_mass[f];
  }
  return total;
}

}  // namespace

Totals World::totals() const {
  if (gas == nullptr) return totals_of(*points);
  Totals total = gas_totals();
  if (bridge != nullptr) {
    bridge::Ledger const ledger = bridge->ledger();
    for (int f = 0; f < 2; ++f) total.mass[f] += ledger.mass[f];
    total.momentum = total.momentum + ledger.momentum;
    total.energy += ledger.energy;
    total += totals_of(*points, gas_body());
  }
  return total;
}

Totals World::gas_totals() const {
  // One sum per block, then over blocks in order: the same bits for any number of threads.
  std::vector<Totals> parts(static_cast<std::size_t>(grid.block_count()));
  bool const two = gas->fluids().two;
  parallel_for(grid.block_count(), [&](int b, int) {
    grid::Block const& block = grid.blocks()[b];
    // Rows, then planes, then the block: short sums keep their digits.
    for (int k = 0; k < block.n[2]; ++k) {
      Totals plane;
      for (int j = 0; j < block.n[1]; ++j) {
        Totals row;
        for (int i = 0; i < block.n[0]; ++i) {
          int const at = block.offset(i, j, k);
          if (!gas->is_own(b, at)) continue;
          double const volume = setup.domain.cell_volume(block.origin[0] + i);
          row.mass[0] += volume * gas->fields().at(b, gas::density)[at];
          if (two) row.mass[1] += volume * gas->fields().at(b, gas::second_density)[at];
          for (int d = 0; d < 3; ++d) row.momentum[d] += volume * gas->fields().at(b, gas::momentum_x + d)[at];
          row.energy += volume * gas->fields().at(b, gas::energy)[at];
        }
        plane += row;
      }
      parts[b] += plane;
    }
  });
  Totals total;
  for (Totals const& part : parts) total += part;
  return total;
}

void World::update_audit() {
  audit.current = totals();
  audit.outflow = {};
  if (points != nullptr) {
    mpm::Losses const& lost = points->losses();
    if (gas == nullptr) audit.outflow.mass[0] = lost.mass;
    audit.outflow.momentum = lost.momentum;
    audit.outflow.energy = lost.energy;
  }
  if (gas == nullptr) return;
  if (bridge != nullptr) {
    bridge::Ledger const& out = bridge->traffic().outflow;
    audit.outflow += {out.mass, out.momentum, out.energy};
  }
  gas::Account const account = gas->account();
  Vec3 momentum{0.0, 0.0, 0.0};
  for (int d = 0; d < 3; ++d) momentum[d] = account.outflow[gas::momentum_x + d];
  audit.outflow +=
      {{account.outflow[gas::density], account.outflow[gas::second_density]}, momentum, account.outflow[gas::energy]};
  audit.guarded_cells = account.guarded_cells;
  audit.fallback_faces = account.fallback_faces;
  audit.guard_mass = account.guard_mass;
  audit.guard_energy = account.guard_energy;
  audit.afterburn_energy = account.afterburn_energy;
}

}  // namespace brisance::run
