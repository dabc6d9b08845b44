/// [end]: when the simulation ends.
#include <fmt/format.h>

#include <algorithm>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Settings<run::End> const& settings() {
  using E = run::End;
  static Settings<E> const all{
      {&E::time,
       number("time", "s", 1e-12, longest).required().like("\"10 ms\"").means("Simulated time, at the latest")},
      {&E::steps, typed(Type::integer, "steps", "1", 1, 1e12).note("no limit").like("1000").means("Number of steps")},
      {&E::gauges,
       word("gauges", {"positive_phase"})
           .note("not by gauges")
           .like("\"positive_phase\"")
           .means("`positive_phase`: end when a wave of more than 1e-4 of the ambient pressure has arrived at every "
                  "gauge of the gas and the pressure there has come back to the ambient one for the first time. "
                  "Reflections that come later are not waited for")},
      {&E::kinetic_energy,
       number("kinetic_energy", "1", 1e-12, 0.5)
           .note("not by it")
           .like("0.01")
           .means(
               "End when the kinetic energy of gas and bodies has been below this fraction of its largest value during "
               "the last third of the time so far. Up to 0.06 the turning points of a vibration are no end")},
      {&E::wall_clock,
       number("wall_clock", "s", 1e-3, 1e8)
           .note("no limit")
           .like("\"2 h\"")
           .means("Time of the clock on the wall after which this program stops with a checkpoint and exit code 3, "
                  "whatever `[checkpoint]` says; `--resume` goes on, for as long again. It does not change the "
                  "results")}};
  return all;
}

}  // namespace

Table const& end_table() {
  static Table const table{
      "When the calculation ends: at `time`, or before by what comes first of the others. The conditions are looked at "
      "after every tenth step, from step 1000 on after about every hundredth of the steps done.",
      settings().keys(),
      {},
      {}};
  return table;
}

namespace {

/// Charges that are lit, and loads that begin, after the end.
void check_onsets(Draft const& draft) {
  if (!draft.end_known) return;
  for (Onset const& onset : draft.onsets) {
    if (onset.time < draft.out.end.time) continue;
    std::string_view const key = onset.section->given(onset.key) ? onset.key : "";
    draft.report.warning(key.empty() ? onset.section->place : onset.section->place_of(key),
                         key.empty() ? onset.section->path : onset.section->path_of(key),
                         fmt::format("{} within this calculation: its time {:g} s lies after the end at {:g} s",
                                     onset.never, onset.time, draft.out.end.time));
  }
}

}  // namespace

void build_end(Draft& draft) {
  Section const* section = draft.deck.section("end");
  if (section == nullptr) return;
  settings().read(*section, draft.out.end);
  auto const* gauges = draft.deck.sections("gauge");
  bool const of_gas =
      draft.has_gas && gauges != nullptr &&
      std::any_of(gauges->begin(), gauges->end(), [](auto const& g) { return g.doubtful() || !g.given("body"); });
  if (draft.out.end.gauges && !of_gas && !draft.deck.broken("gauge")) {
    draft.error(*section, "gauges", "there is no gauge in the gas: add [[gauge]] with a point, or remove the key");
  }
  if (!section->number("time")) return;
  draft.end_known = true;
  check_onsets(draft);
}

}  // namespace brisance::deck
