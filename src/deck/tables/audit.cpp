/// [audit]: what the run does where its energy is not conserved.
#include <fmt/format.h>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Settings<run::AuditLimits> const& settings() {
  using A = run::AuditLimits;
  static Settings<A> const all{
      {&A::warn, number("warn", "1", 0.0, 1.0)
                     .like("0.005")
                     .means("Drift from which on the run is told to be NOT BALANCED; 0: the drift is not judged")},
      {&A::fail,
       number("fail", "1", 0.0, 1.0)
           .like("0.05")
           .means("Drift from which on the run stops with exit code 4; 0: it never stops, whatever drifts, guards add "
                  "or the ledger holds")}};
  return all;
}

}  // namespace

Table const& audit_table() {
  static Table const table{
      "What the run says and does where its energy is not conserved. The energy of material points drifts, alone and "
      "together with gas; the drift counts as a part of the energy at work (the largest so far of kinetic energy, "
      "work of loads and gravity, and energy above the ambient state). What the gas scheme's guards add has limits "
      "of "
      "its own: told from 1e-4, the run ends from 1e-2 of the charges' energy on. Nothing here changes the results.",
      settings().keys(),
      {},
      {}};
  return table;
}

void build_audit(Draft& draft) {
  Section const* section = draft.deck.section("audit");
  if (section == nullptr) return;
  auto& limits = draft.out.audit;
  bool const read = settings().read(*section, limits);
  if (read && limits.fail > 0.0 && limits.warn > limits.fail) {
    draft.error(
        *section, section->given("fail") ? "fail" : "warn",
        fmt::format("the run would stop at fail = {:g} before it warns at warn = {:g}: make `fail` larger, `warn` "
                    "smaller, or `fail = 0` for a run that never stops",
                    limits.fail, limits.warn));
  }
}

}  // namespace brisance::deck
