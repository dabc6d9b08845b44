/// The bridge in a checkpoint: what is under way between gas and particles, and the counts since the start. The states
/// that it reads of cells and particles are read anew at the beginning of every step.
#include <cmath>

#include "bridge/bridge.hpp"
#include "core/archive.hpp"

namespace brisance::bridge {

namespace {

void archive(Archive& a, Amounts& l) { a(l.mass, l.momentum, l.energy, l.volume); }

}  // namespace

void Ledger::archive(Archive& a) {
  a.sized(outwards_, "the number of faces of the MPM region");
  for (Amounts& account : accounts_) bridge::archive(a, account);
}

void Bridge::archive(Archive& a) {
  a.section("bridge");
  a.same(gas_body_, "the body of the gas particles");
  a.same(ledger_.accounts().size(), "the size of the ledger");
  a(awake_, last_step_);
  a.require(last_step_ >= 0.0 && std::isfinite(last_step_), "the last step of the particles");
  ledger_.archive(a);
  a(traffic_.injected, traffic_.absorbed, traffic_.pressure_work, traffic_.pressure_impulse);
  bridge::archive(a, traffic_.outflow);
  shared_.states().archive(a);
  // The signals that come in with the next step are those of the cells, which have been read before the bridge.
  if (a.reading() && awake_) read_cells();
}

}  // namespace brisance::bridge
