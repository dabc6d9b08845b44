#include "run/adaptation.hpp"

#include <utility>

#include "core/archive.hpp"
#include "core/timer.hpp"
#include "run/system.hpp"

namespace brisance::run {

void Adaptation::follow(System& system) {
  if (system.clock.step % interval_ != 0) return;
  PhaseTimer const timer(system.timings["regrid"]);
  grid::Forest forest = system.forest();
  if (!refinement_.adapt(*system.gas, forest)) return;
  system.regrid(std::move(forest));
  ++changes_;
}

void Adaptation::archive(Archive& a) {
  a(changes_);
  refinement_.archive(a);
}

}  // namespace brisance::run
