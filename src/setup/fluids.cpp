#include "setup/fluids.hpp"

namespace brisance::setup {

gas::Fluids fluids_of(Case const& c) {
  gas::Fluids fluids;
  fluids.eos[0] = c.ambient.fluid.eos;
  fluids.ambient_pressure = c.ambient.state.pressure;
  for (int k = 1; k < material::most_fluids; ++k) {
    material::Explosive const* explosive = c.explosive_of(k);
    material::Fluid const* fluid = c.other_fluid(k);
    if (explosive == nullptr && fluid == nullptr) break;
    fluids.count = k + 1;
    if (explosive != nullptr)
      fluids.eos[k] = explosive->products;
    else
      fluids.eos[k] = fluid->eos;
  }
  return fluids;
}

}  // namespace brisance::setup
