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
      {&E::time, number("time", "s", 1e-12, longest).required().like("\"10 ms\"").means("Maximum simulated time")},
      {&E::steps, typed(Type::integer, "steps", "1", 1, 1e12).note("no limit").like("1000").means("Number of steps")},
      {&E::gauges, word("gauges", {"positive_phase"})
                       .note("off")
                       .like("\"positive_phase\"")
                       .means("`positive_phase`: end when a wave of more than 1e-4 of the ambient pressure has arrived "
                              "at every gauge in the gas and the pressure there has returned to ambient for the first "
                              "time. Later reflections are ignored")},
      {&E::kinetic_energy, number("kinetic_energy", "1", 1e-12, 0.5)
                               .note("off")
                               .like("0.01")
                               .means("End when the kinetic energy of gas and bodies has been below this fraction of "
                                      "its maximum during the last third of the simulated time. With values up to 0.06 "
                                      "the turning points of a vibration do not end the run")},
      {&E::wall_clock,
       number("wall_clock", "s", 1e-3, 1e8)
           .note("no limit")
           .like("\"2 h\"")
           .means(
               "Wall-clock time after which the program writes a checkpoint, regardless of `[checkpoint]`, and stops "
               "with exit code 3; `--resume` continues for the same time again. It does not change the results")}};
  return all;
}

}  // namespace

Table const& end_table() {
  static Table const table{
      "When the simulation ends: at `time`, or earlier if one of the other conditions is met. The conditions are "
      "checked every 10 steps and, after step 1000, each time the number of steps has grown by about 1 %.",
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
                         fmt::format("{} within this simulation: its time {:g} s is after the end at {:g} s",
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
