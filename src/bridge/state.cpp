/// The state of the bridge in a checkpoint: the ledger and the sums since the start. What cells and points lend each
/// other is made anew in every step.
#include "bridge/bridge.hpp"
#include "core/archive.hpp"

namespace brisance::bridge {

namespace {

void archive(Archive& a, Ledger& l) { a(l.mass, l.momentum, l.energy); }

}  // namespace

void Bridge::archive(Archive& a) {
  a.section("bridge");
  a.same(ledger_.size(), "the number of lanes of the ledger");
  for (Ledger& account : ledger_) bridge::archive(a, account);
  for (char& outwards : outwards_) a(outwards);
  a(awake_, last_step_, traffic_.born, traffic_.left, traffic_.pressure_work, traffic_.pressure_impulse);
  bridge::archive(a, traffic_.outflow);
}

}  // namespace brisance::bridge
