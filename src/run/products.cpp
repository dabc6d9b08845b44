#include "run/products.hpp"

namespace brisance::run {

bool becomes_gas(Case const& c, Body const& body) {
  if (!c.mpm_region || !body.solid.burns()) return false;
  if (!c.charges.empty()) return c.charges.front().explosive.name == body.solid.name;
  return c.second_fluid && c.second_fluid->name == body.solid.name;
}

void hand_over_products(Case const& setup, mpm::Mpm& points, int gas_body) {
  for (std::size_t n = 0; n < setup.points.bodies.size(); ++n) {
    if (becomes_gas(setup, setup.points.bodies[n])) mpm::hand_over_burnt(points, static_cast<int>(n), gas_body);
  }
}

}  // namespace brisance::run
