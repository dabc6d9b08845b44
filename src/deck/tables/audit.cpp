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
                     .means("Drift above which the run is reported as NOT BALANCED; 0: the drift is not checked")},
      {&A::fail,
       number("fail", "1", 0.0, 1.0)
           .like("0.05")
           .means("Drift above which the run stops with exit code 4; 0: the audit never stops the run, however large "
                  "the drift, the energy and mass added by guards, or the contents of the ledger")}};
  return all;
}

}  // namespace

Table const& audit_table() {
  static Table const table{
      "What the run reports and does if its energy is not conserved. The energy of material points, with or without "
      "gas, is not conserved exactly; it drifts. The drift is a fraction of the reference energy (the largest value so "
      "far of kinetic energy, work of loads and gravity, and energy above the ambient state). The energy and mass "
      "added by the gas scheme's guards have separate limits: above 1e-4 of those of the charges they are reported, "
      "above 1e-2 the run stops. Nothing here changes the results.",
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
    draft.error(*section, section->given("fail") ? "fail" : "warn",
                fmt::format("the run would stop at fail = {:g} before it warns at warn = {:g}: increase `fail`, "
                            "decrease `warn`, or write `fail = 0` so that the run never stops",
                            limits.fail, limits.warn));
  }
}

}  // namespace brisance::deck
