/// [output]: what is written, and when.
#include <fmt/format.h>

#include <algorithm>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/tables.hpp"
#include "run/gas_fields.hpp"
#include "run/point_fields.hpp"
#include "run/world.hpp"

namespace brisance::deck {

Table const& output_table() {
  static Table const table = [] {
    run::Output const o;
    std::vector<std::string> names;
    for (auto const& field : run::known_fields()) names.push_back(field.name);
    Key fields = typed(Type::words, "fields").like("[\"pressure\", \"velocity\"]").means("Fields to write");
    fields.choices = names;
    fields.note(fmt::format("`{}`", fmt::join(o.fields, "`, `")));
    Key point_fields = typed(Type::words, "point_fields")
                           .like("[\"velocity\", \"stress\"]")
                           .means("Fields of the material points to write, beside position, body and material");
    for (auto const& field : run::known_point_fields()) point_fields.choices.push_back(field.name);
    point_fields.note(fmt::format("`{}`", fmt::join(o.point_fields, "`, `")));
    return Table{
        "What is written, and when.",
        {number("field_interval", "s", 0.0, longest)
             .of(o.field_interval)
             .like("\"0.5 ms\"")
             .means("Time between field dumps; 0: none but the last"),
         typed(Type::numbers, "field_times", "s", 0.0, longest)
             .note("none")
             .like("[\"1 ms\", \"2.5 ms\"]")
             .means("Further times of field dumps"),
         number("gauge_interval", "s", 0.0, longest)
             .of(o.gauge_interval)
             .like("\"10 us\"")
             .means("Time between gauge records; 0: every step"),
         typed(Type::boolean, "peak_fields")
             .of(o.peak_fields)
             .like("true")
             .means("Write peak overpressure and impulse of every cell at the end"),
         word("precision", {"single", "double"})
             .of(o.single_precision ? "single" : "double")
             .like("\"single\"")
             .means("Precision of the fields in the files; the calculation is always in double"),
         std::move(fields), std::move(point_fields),
         typed(Type::boolean, "gas_points")
             .of(o.gas_points)
             .like("true")
             .means("Write the gas points of an `[mpm_region]` too; without them the field dumps show their gas "
                    "as cells"),
         typed(Type::boolean, "profile")
             .of(o.profile)
             .like("true")
             .means("Write the state at the end as a profile, `profiles/end.h5`, with which a later deck may begin "
                    "(`[remap]`): of spherical1d, cylindrical1d and axisymmetric2d with one charge")},
        {},
        {}};
  }();
  return table;
}

namespace {

constexpr double most_dumps = 1e4;
constexpr double most_records = 1e7;  ///< per gauge

void too_many(Draft const& draft, Section const& section, std::string_view key, double interval, double most,
              char const* things) {
  if (interval <= 0.0 || draft.out.end.time / interval <= most) return;
  draft.error(
      section, key,
      fmt::format("{} until {:g} s makes {:.4g} {}; allowed: at most {:g}; write at least {:.3g} s", section.shown(key),
                  draft.out.end.time, draft.out.end.time / interval, things, most, draft.out.end.time / most));
}

}  // namespace

void build_output(Draft& draft) {
  Section const* section = draft.deck.section("output");
  if (section == nullptr) return;
  auto& o = draft.out.output;
  o.field_interval = section->number("field_interval").value_or(o.field_interval);
  o.gauge_interval = section->number("gauge_interval").value_or(o.gauge_interval);
  o.peak_fields = section->boolean("peak_fields").value_or(o.peak_fields);
  o.single_precision = section->text("precision").value_or("single") == "single";
  if (auto const* times = section->numbers("field_times")) o.field_times = *times;
  if (auto const* fields = section->strings("fields")) {
    o.fields.clear();
    for (auto const& field : *fields) {
      if (std::find(o.fields.begin(), o.fields.end(), field) == o.fields.end()) o.fields.push_back(field);
    }
  }
  if (auto const* fields = section->strings("point_fields")) {
    o.point_fields.clear();
    for (auto const& field : *fields) {
      if (std::find(o.point_fields.begin(), o.point_fields.end(), field) == o.point_fields.end()) {
        o.point_fields.push_back(field);
      }
    }
  }
  for (auto const* key : {"fields", "peak_fields"}) {
    if (!draft.has_gas && section->given(key))
      draft.warn(*section, key, "has no effect in a deck of bodies without gas");
  }
  bool const region = draft.has_gas && (draft.has_bodies() || draft.deck.given("mpm_region"));
  o.gas_points = section->boolean("gas_points").value_or(o.gas_points);
  o.profile = section->boolean("profile").value_or(o.profile);
  if (!region && section->given("gas_points")) {
    draft.warn(*section, "gas_points", "has no effect in a deck without an MPM region");
  }
  if (!draft.has_bodies() && !(region && o.gas_points) && section->given("point_fields")) {
    draft.warn(*section, "point_fields",
               region ? "has no effect in a deck without bodies, unless gas_points = true"
                      : "has no effect in a deck without bodies");
  }
  std::sort(o.field_times.begin(), o.field_times.end());
  if (!draft.end_known) return;
  double const time = draft.out.end.time;
  if (!o.field_times.empty() && o.field_times.back() > time) {
    draft.error(*section, "field_times",
                fmt::format("{:g} s lies after the end of the calculation at {:g} s: remove it or calculate longer",
                            o.field_times.back(), time));
  }
  for (auto const& [key, interval, what] : {std::tuple{"field_interval", o.field_interval, "dumps are written"},
                                            std::tuple{"gauge_interval", o.gauge_interval, "gauges record"}}) {
    if (section->given(key) && interval > time) {
      draft.warn(*section, key,
                 fmt::format("is longer than the calculation, {:g} s: {} at its start and its end only", time, what));
    }
  }
  too_many(draft, *section, "field_interval", o.field_interval, most_dumps, "field dumps");
  too_many(draft, *section, "gauge_interval", o.gauge_interval, most_records, "records per gauge");
}

}  // namespace brisance::deck
