#include "bridge/conversion.hpp"

#include <algorithm>
#include <cmath>

#include "gas/closure.hpp"

namespace brisance::bridge {

Primitive primitive(material::Fluids const& fluids, CellSums const& s) {
  Primitive w;
  double const mass = s.total();
  w.density = mass / s.volume;
  w.velocity = (1.0 / mass) * s.momentum;
  PerFluid partial{};
  for (int k = 0; k < most_fluids; ++k) partial[k] = s.mass[k] / s.volume;
  for (int k = 1; k < most_fluids; ++k) {
    w.mass_fraction.set(k, s.mass[k] / mass);
    w.volume_fraction.set(k, s.fluid_volume[k] / s.volume);
  }
  gas::Mixture const m = gas::mixture(fluids, partial, w.volume_fraction);
  w.pressure = m.pressure(s.energy / s.volume);
  w.sound_speed = std::sqrt(std::max(0.0, m.bulk_modulus(w.pressure)) / w.density);
  w.energy = s.energy / s.volume + 0.5 * w.density * dot(w.velocity, w.velocity);
  return w;
}

double specific_energy(material::Fluids const& fluids, Primitive const& s) {
  return material::mixture_of(fluids, s).rho_e(s.pressure) / s.density;
}

Amounts per_mass(Primitive const& s, double energy) {
  Amounts amounts;
  for (int k = 0; k < most_fluids; ++k) amounts.mass[k] = s.mass_fraction[k];
  amounts.momentum = s.velocity;
  amounts.energy = energy;
  return amounts;
}

void add_to_cell(gas::Gas& gas, grid::Cell const& to, Amounts const& load) {
  grid::Grid const& grid = gas.grid();
  auto const [b, at] = std::pair{to.block, to.offset};
  double const inverse = 1.0 / grid.block(to).volume(to);
  grid::Fields& u = gas.fields();
  for (int k = 0; k < gas.fluids().count; ++k) u.at(b, gas::partial_density(k))[at] += inverse * load.mass[k];
  for (int d = 0; d < 3; ++d) u.at(b, gas::momentum_x + d)[at] += inverse * load.momentum[d];
  u.at(b, gas::energy)[at] += inverse * load.energy;
  gas.wake(b);
}

}  // namespace brisance::bridge
