#include "setup/build.hpp"

#include "setup/levels.hpp"
#include "setup/place_bodies.hpp"
#include "setup/place_gas.hpp"
#include "setup/place_region.hpp"

namespace brisance::setup {

namespace {

/// A world whose blocks suit what the gas holds at the start. Where shocks or the products' surface ask for finer cells
/// the start is made again on those, until nothing asks for more.
run::World start_on_levels(Case setup) {
  auto const obstacles = std::make_shared<LevelObstacles const>(setup);
  grid::Forest forest = start_forest(setup, obstacles);
  gas::RefinementRules const rules = refinement_rules(setup, obstacles);
  for (int pass = 0;; ++pass) {
    run::World w(std::move(setup), forest);
    place_gas(w);
    if (w.setup.start.from_checkpoint || pass == rules.most_level) return w;
    w.gas->start(w.clock.time);
    gas::Refinement refinement(rules);
    if (!refinement.adapt(*w.gas, forest)) return w;
    setup = std::move(w.setup);
  }
}

}  // namespace

run::World build(Case setup) {
  bool const bodies_alone = setup.particles.any() && !setup.has_regions();
  run::World w = setup.adaptive.any() ? start_on_levels(std::move(setup)) : run::World(std::move(setup));
  if (bodies_alone) {
    place_bodies(w, w.regions.emplace_back(), w.setup.domain);
  } else {
    if (w.gas == nullptr) place_gas(w);
    place_regions(w);
    w.gas->start(w.clock.time);
    for (run::Region& region : w.regions) {
      region.particles->set_time(w.clock.time);
      if (region.bridge->awake()) region.awake_since = w.clock.time;
    }
  }
  w.start_audit();
  return w;
}

}  // namespace brisance::setup
