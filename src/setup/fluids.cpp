#include "setup/fluids.hpp"

namespace brisance::setup {

gas::Fluids fluids_of(Case const& c) {
  gas::Fluids fluids;
  fluids.ambient = c.ambient.fluid.eos;
  fluids.ambient_pressure = c.ambient.state.pressure;
  if (!c.charges.empty()) {
    fluids.two = true;
    fluids.second = c.charges.front().explosive.products;
  } else if (c.second_fluid) {
    fluids.two = true;
    fluids.second = c.second_fluid->eos;
  }
  return fluids;
}

gas::MixtureState ambient_mixture(FluidState const& state) {
  gas::MixtureState m;
  m.ambient_density = state.density;
  m.pressure = state.pressure;
  m.velocity = state.velocity;
  return m;
}

}  // namespace brisance::setup
