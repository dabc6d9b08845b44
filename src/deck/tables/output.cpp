/// [output]: what is written, and when.
#include <fmt/format.h>

#include <algorithm>

#include "case/case.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"
#include "observe/gas_fields.hpp"
#include "observe/particle_fields.hpp"

namespace brisance::deck {

namespace {

/// A list of the names of fields.
template <class Field>
Key words(std::string name, std::vector<Field> const& known, std::vector<std::string> const& chosen) {
  Key key = typed(Type::words, std::move(name));
  for (auto const& field : known) key.choices.push_back(field.name);
  return key.note(fmt::format("`{}`", fmt::join(chosen, "`, `")));
}

Settings<run::Output> const& settings() {
  using O = run::Output;
  static Settings<O> const all{
      {&O::field_interval, number("field_interval", "s", 0.0, longest)
                               .like("\"0.5 ms\"")
                               .means("Time between field dumps; 0: only the last one")},
      {&O::field_times, typed(Type::numbers, "field_times", "s", 0.0, longest)
                            .note("none")
                            .like("[\"1 ms\", \"2.5 ms\"]")
                            .means("Additional times of field dumps")},
      {&O::gauge_interval, number("gauge_interval", "s", 0.0, longest)
                               .like("\"10 us\"")
                               .means("Time between gauge records; 0: every step")},
      {&O::peak_fields, typed(Type::boolean, "peak_fields")
                            .like("true")
                            .means("Write peak overpressure and impulse of every cell at the end")},
      {&O::single_precision,
       word("precision", {"single", "double"})
           .like("\"single\"")
           .means("Precision of the fields in the files; the simulation always uses double precision")},
      {&O::fields, words("fields", observe::known_fields(), O{}.fields)
                       .like("[\"pressure\", \"velocity\"]")
                       .means("Fields to write")},
      {&O::particle_fields,
       words("point_fields", observe::known_particle_fields(), O{}.particle_fields)
           .like("[\"velocity\", \"stress\"]")
           .means("Fields of the material points to write, in addition to position, body and material")},
      {&O::gas_particles, typed(Type::boolean, "gas_points")
                              .like("true")
                              .means("Write the gas particles of an `[mpm_region]` as well; otherwise the field dumps "
                                     "show their gas as cells")},
      {&O::profile,
       typed(Type::boolean, "profile")
           .like("true")
           .means("Write the final state as a profile, `profiles/end.h5`, from which a later deck can start "
                  "(`[remap]`); for spherical1d, cylindrical1d and axisymmetric2d with one charge")},
      nested(Type::tables, "subset", subset_table())
          .like("[{name = \"street\", plane = {normal = \"z\", at = \"1.5 m\"}}]")
          .means("Planes and boxes that are written beside the whole domain or in its place, usually as "
                 "`[[output.subset]]`")};
  return all;
}

}  // namespace

Table const& output_table() {
  static Table const table{"What to write, and when.", settings().keys(), {}, {}};
  return table;
}

namespace {

constexpr double most_dumps = 1e4;
constexpr double most_records = 1e7;  ///< per gauge

}  // namespace

void without_repeats(std::vector<std::string>& all) {
  std::vector<std::string> once;
  for (auto& word : all) {
    if (std::find(once.begin(), once.end(), word) == once.end()) once.push_back(std::move(word));
  }
  all = std::move(once);
}

void limit_times(Draft const& draft, Section const& section, std::string_view key, double interval, double most,
                 char const* things) {
  if (!draft.end_known || interval <= 0.0 || draft.out.end.time / interval <= most) return;
  draft.error(
      section, key,
      fmt::format("{} until {:g} s gives {:.4g} {}; allowed: at most {:g}; write at least {:.3g} s", section.shown(key),
                  draft.out.end.time, draft.out.end.time / interval, things, most, draft.out.end.time / most));
}

void build_output(Draft& draft) {
  Section const* section = draft.deck.section("output");
  if (section == nullptr) return;
  auto& o = draft.out.output;
  settings().read(*section, o);
  without_repeats(o.fields);
  without_repeats(o.particle_fields);
  for (auto const* key : {"fields", "peak_fields"}) {
    if (!draft.has_gas && section->given(key))
      draft.warn(*section, key, "has no effect in a deck with bodies but without gas");
  }
  bool const region = draft.has_gas && (draft.has_bodies() || draft.deck.given("mpm_region"));
  if (!region && section->given("gas_points")) {
    draft.warn(*section, "gas_points", "has no effect in a deck without an MPM region");
  }
  if (!draft.has_bodies() && !(region && o.gas_particles) && section->given("point_fields")) {
    draft.warn(*section, "point_fields",
               region ? "has no effect in a deck without bodies, unless gas_points = true"
                      : "has no effect in a deck without bodies");
  }
  std::sort(o.field_times.begin(), o.field_times.end());
  build_subsets(draft, *section);
  if (!draft.end_known) return;
  double const time = draft.out.end.time;
  if (!o.field_times.empty() && o.field_times.back() > time) {
    draft.error(*section, "field_times",
                fmt::format("{:g} s is after the end of the simulation at {:g} s: remove it or extend the simulation",
                            o.field_times.back(), time));
  }
  for (auto const& [key, interval, what] : {std::tuple{"field_interval", o.field_interval, "dumps are written"},
                                            std::tuple{"gauge_interval", o.gauge_interval, "gauges record"}}) {
    if (section->given(key) && interval > time) {
      draft.warn(*section, key,
                 fmt::format("is longer than the simulation, {:g} s: {} only at its start and its end", time, what));
    }
  }
  limit_times(draft, *section, "field_interval", o.field_interval, most_dumps, "field dumps");
  limit_times(draft, *section, "gauge_interval", o.gauge_interval, most_records, "records per gauge");
}

}  // namespace brisance::deck
