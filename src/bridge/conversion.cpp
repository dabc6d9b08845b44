#include "bridge/conversion.hpp"

#include <algorithm>
#include <cmath>

#include "gas/closure.hpp"

namespace brisance::bridge {

gas::Primitive primitive(material::Fluids const& fluids, CellSums const& s) {
  gas::Primitive w;
  double const mass = s.mass[0] + s.mass[1];
  w.density = mass / s.volume;
  w.velocity = (1.0 / mass) * s.momentum;
  w.mass_fraction = s.mass[1] / mass;
  w.volume_fraction = s.volume_second / s.volume;
  gas::Mixture const m = gas::mixture(fluids, s.mass[0] / s.volume, s.mass[1] / s.volume, w.volume_fraction);
  w.pressure = m.pressure(s.energy / s.volume);
  w.sound_speed = std::sqrt(std::max(0.0, m.bulk_modulus(w.pressure)) / w.density);
  return w;
}

GasState state_of(material::Fluids const& fluids, CellSums const& sums) {
  gas::Primitive const w = primitive(fluids, sums);
  return {w.density, w.velocity, w.pressure, w.mass_fraction, w.volume_fraction};
}

double specific_energy(material::Fluids const& fluids, GasState const& s) {
  double const Y = s.mass_fraction;
  return gas::mixture(fluids, (1.0 - Y) * s.density, Y * s.density, s.volume_fraction).rho_e(s.pressure) / s.density;
}

void add_to_cell(gas::Gas& gas, Index3 const& cell, Account const& load) {
  grid::Grid const& grid = gas.grid();
  grid::Cell const to = grid.locate(cell);
  auto const [b, at] = std::pair{to.block, to.offset};
  double const inverse = 1.0 / grid.block(to).volume(to);
  grid::Fields& u = gas.fields();
  u.at(b, gas::density)[at] += inverse * load.mass[0];
  for (int d = 0; d < 3; ++d) u.at(b, gas::momentum_x + d)[at] += inverse * load.momentum[d];
  u.at(b, gas::energy)[at] += inverse * load.energy;
  if (gas.fluids().two) u.at(b, gas::second_density)[at] += inverse * load.mass[1];
  gas.wake(b);
}

}  // namespace brisance::bridge
