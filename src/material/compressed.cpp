#include "material/compressed.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace brisance::material {

Compressed compressed_to(Material const& start, double pressure, double mises) {
  double const p0 = start_pressure(start);
  double const G = shear_modulus(start.strength);
  auto const energy = [&](double rho) {
    double const shear = G > 0.0 ? mises * mises / (6.0 * G * rho) : 0.0;
    return start.specific_energy + 0.5 * (p0 + pressure) * (1.0 / start.density - 1.0 / rho) + shear;
  };
  auto const is_below = [&](double rho) { return material::pressure(start, rho, energy(rho)) < pressure; };
  if (!(pressure > p0)) return {start.density, start.specific_energy};
  double low = start.density;
  double width = 1e-6 * start.density;
  while (is_below(low + width)) {
    low += width;
    width *= 2.0;
    if (low < 10.0 * start.density) continue;
    throw InputError(fmt::format("{} reaches {:.6g} Pa at no density up to ten times its own", start.name, pressure));
  }
  double high = low + width;
  for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high))
    (is_below(middle) ? low : high) = middle;
  return {high, energy(high)};
}

double lateral_coefficient(Material const& start) {
  double const K = bulk_modulus(start, start.density, start_pressure(start));
  double const G = shear_modulus(start.strength);
  return (3.0 * K - 2.0 * G) / (3.0 * K + 4.0 * G);
}

}  // namespace brisance::material
