#include "run/products.hpp"

#include <fmt/format.h>

#include <array>

#include "run/system.hpp"

namespace brisance::run {

int products_of(Case const& c, Body const& body) {
  if (!c.has_regions() || !body.solid.burns()) return 0;
  for (int k = 1; k < material::most_fluids; ++k) {
    material::Explosive const* explosive = c.explosive_of(k);
    material::Fluid const* fluid = c.other_fluid(k);
    if (explosive != nullptr ? explosive->name == body.solid.name : fluid != nullptr && fluid->name == body.solid.name)
      return k;
  }
  return 0;
}

std::string fluid_in_words(Case const& c, int fluid) {
  constexpr std::array<char const*, 3> numbers{"first", "second", "third"};
  return fluid == 0 ? c.ambient.fluid.name : fmt::format("the {} fluid", numbers.at(fluid));
}

void hand_over_products(Case const& setup, Region& region) {
  int const gas_body = region.gas_body();
  for (int n = 0; n < gas_body; ++n) {
    if (products_of(setup, setup.particles.bodies[region.bodies[n]]) > 0)
      mpm::hand_over_burnt(*region.particles, n, gas_body);
  }
}

}  // namespace brisance::run
