#include "gas/cell_state.hpp"

#include <algorithm>
#include <cmath>

namespace brisance::gas {

Components conserved_of(Fluids const& fluids, Primitive const& s) {
  Components u{};
  Fractions const Y = fluids.mixed() ? s.mass_fraction : Fractions{};
  for (int k = 0; k < fluids.count; ++k) u[partial_density(k)] = Y[k] * s.density;
  for (int k = 1; k < fluids.count; ++k) u[volume_fraction(k)] = s.volume_fraction[k];
  double const rho = mixture_density(fluids.count, u);
  for (int d = 0; d < 3; ++d) u[momentum_x + d] = rho * s.velocity[d];
  u[energy] = mixture(fluids, partial_densities(fluids.count, u.data()), volume_fractions(fluids.count, u.data()))
                  .rho_e(s.pressure) +
              0.5 * rho * dot(s.velocity, s.velocity);
  return u;
}

Primitive primitive_of(Fluids const& fluids, double const* u, double F) {
  PerFluid const partial = partial_densities(fluids.count, u);
  Primitive w;
  w.volume_fraction = volume_fractions(fluids.count, u);
  Mixture const m = mixture(fluids, partial, w.volume_fraction, F);
  w.density = mixture_density(fluids.count, [u](int c) { return u[c]; });
  for (int d = 0; d < 3; ++d) w.velocity[d] = u[momentum_x + d] / w.density;
  w.pressure = m.pressure(u[energy] - 0.5 * w.density * dot(w.velocity, w.velocity));
  for (int k = 1; k < fluids.count; ++k) w.mass_fraction.set(k, partial[k] / w.density);
  w.sound_speed = std::sqrt(std::max(0.0, m.bulk_modulus(w.pressure)) / w.density);
  w.energy = u[energy];
  return w;
}

}  // namespace brisance::gas
