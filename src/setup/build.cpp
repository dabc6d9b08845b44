#include "setup/build.hpp"

#include "setup/place_bodies.hpp"
#include "setup/place_gas.hpp"
#include "setup/place_region.hpp"

namespace brisance::setup {

run::World build(Case setup) {
  run::World w(std::move(setup));
  if (w.setup.particles.any() && !w.setup.mpm_region) {
    place_bodies(w, w.setup.domain);
  } else {
    place_gas(w);
    if (w.setup.mpm_region) place_region(w);
    w.gas->start(w.clock.time);
    if (w.particles != nullptr) w.particles->set_time(w.clock.time);
    if (w.bridge != nullptr && w.bridge->awake()) w.awake_since = w.clock.time;
  }
  w.start_audit();
  return w;
}

}  // namespace brisance::setup
