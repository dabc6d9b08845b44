#include "deck/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "case/case.hpp"
#include "core/units.hpp"
#include "deck/schema_keys.hpp"
#include "observe/gas_fields.hpp"
#include "observe/point_fields.hpp"

namespace brisance::deck {

namespace {

Table const& output_table() {
  static Table const table = [] {
    run::Output const o;
    std::vector<std::string> names;
    for (auto const& field : observe::known_fields()) names.push_back(field.name);
    Key fields = typed(Type::words, "fields").like("[\"pressure\", \"velocity\"]").means("Fields to write");
    fields.choices = names;
    fields.note(fmt::format("`{}`", fmt::join(o.fields, "`, `")));
    Key point_fields = typed(Type::words, "point_fields")
                           .like("[\"velocity\", \"stress\"]")
                           .means("Fields of the material points to write, beside position, body and material");
    for (auto const& field : observe::known_point_fields()) point_fields.choices.push_back(field.name);
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

Table const& end_table() {
  static Table const table{
      "When the calculation ends: at `time`, or before by what comes first of the others. The conditions are looked at "
      "after every tenth step, from step 1000 on after about every hundredth of the steps done.",
      {number("time", "s", 1e-12, longest).required().like("\"10 ms\"").means("Simulated time, at the latest"),
       typed(Type::integer, "steps", "1", 1, 1e12).note("no limit").like("1000").means("Number of steps"),
       word("gauges", {"positive_phase"})
           .note("not by gauges")
           .like("\"positive_phase\"")
           .means("`positive_phase`: end when a wave of more than 1e-4 of the ambient pressure has arrived at every "
                  "gauge of the gas and the pressure there has come back to the ambient one for the first time. "
                  "Reflections that come later are not waited for"),
       number("kinetic_energy", "1", 1e-12, 0.5)
           .note("not by it")
           .like("0.01")
           .means("End when the kinetic energy of gas and bodies has been below this part of its largest value during "
                  "the last third of the time so far. Up to 0.06 the turning points of a vibration are no end"),
       number("wall_clock", "s", 1e-3, 1e8)
           .note("no limit")
           .like("\"2 h\"")
           .means("Time of the clock on the wall after which this program stops with a checkpoint and exit code 3, "
                  "whatever `[checkpoint]` says; `--resume` goes on, for as long again. It does not change the "
                  "results")},
      {},
      {}};
  return table;
}

Table const& checkpoint_table() {
  static Table const table = [] {
    run::Checkpoint const c;
    return Table{
        "When the whole state is written, so that `brisance run --resume` can go on from there. Nothing here changes "
        "the "
        "results.",
        {number("interval", "s", 0.0, longest)
             .of(c.interval)
             .like("\"1 ms\"")
             .means("Simulated time between two checkpoints; 0: not by the simulated time"),
         typed(Type::integer, "steps", "1", 0, 1e12)
             .of(c.steps)
             .like("1000")
             .means("Steps between two checkpoints; 0: not by steps"),
         number("wall_clock", "s", 0.0, 1e8)
             .of(c.wall_clock)
             .like("\"30 min\"")
             .means("Time of the clock on the wall between two checkpoints, more where writing one takes more than a "
                    "twentieth of it; 0: not by the clock"),
         typed(Type::integer, "keep", "1", 1, 1000)
             .of(static_cast<long>(c.keep))
             .like("2")
             .means("Number of checkpoints that stay on the disk, the newest ones"),
         typed(Type::boolean, "at_end").of(c.at_end).like("true").means("Write one at the end of the calculation"),
         typed(Type::boolean, "on_signal")
             .of(c.on_signal)
             .like("true")
             .means("Write one when the run is stopped by Ctrl-C or a signal")},
        {},
        {}};
  }();
  return table;
}

Table const& audit_table() {
  static Table const table = [] {
    run::AuditLimits const limits;
    return Table{
        "What the run says and does where its energy is not conserved. The energy of material points drifts, alone and "
        "together with gas; the drift counts as a part of the energy at work (the largest so far of kinetic energy, "
        "work of loads and gravity, and energy above the ambient state). What the gas scheme's guards add has limits "
        "of "
        "its own: told from 1e-4, the run ends from 1e-2 of the charges' energy on. Nothing here changes the results.",
        {number("warn", "1", 0.0, 1.0)
             .of(limits.warn)
             .like("0.005")
             .means("Drift from which on the run is told to be NOT BALANCED; 0: the drift is not judged"),
         number("fail", "1", 0.0, 1.0)
             .of(limits.fail)
             .like("0.05")
             .means(
                 "Drift from which on the run stops with exit code 4; 0: it never stops, whatever drifts, guards add "
                 "or the ledger holds")},
        {},
        {}};
  }();
  return table;
}

Table const& compare_table() {
  static Table const table{
      "Comparison of the gauges with Kingery and Bulmash's curves.",
      {word("burst", {"auto", "spherical", "hemispherical", "none"})
           .of("auto")
           .like("\"hemispherical\"")
           .means(
               "Kind of burst. `auto`: hemispherical for one hemispherical charge that stands on a wall or symmetry "
               "plane, "
               "spherical for one spherical charge in free air, none for everything else (obstacles, regions, further "
               "walls, another ambient fluid)")},
      {},
      {}};
  return table;
}

}  // namespace

Key const* Table::find(std::string_view key) const {
  for (auto const& k : keys) {
    if (k.name == key) return &k;
  }
  for (auto const& [word_, more] : variants) {
    for (auto const& k : more) {
      if (k.name == key) return &k;
    }
  }
  return nullptr;
}

Table const& deck_schema() {
  static Table const table = [] {
    Key inflow = nested(Type::named, "inflow", inflow_table());
    inflow.choices = faces();
    return Table{
        "",
        {typed(Type::text, "title").of("").like("\"10 kg of TNT on the ground\"").means("Title of the case"),
         word("start", {"direct", "remap"})
             .of("direct")
             .like("\"remap\"")
             .means("`direct`: the charges are on the grid from the beginning; `remap`: each bursts in a fine 1D "
                    "calculation "
                    "first, see `[remap]`"),
         nested(Type::table, "domain", domain_table()).required().like("size = [4, 4, 3] and cell = \"50 mm\""),
         nested(Type::table, "boundaries", boundaries_table()),
         std::move(inflow),
         nested(Type::table, "ambient", ambient_table()),
         nested(Type::tables, "charge", charge_table()),
         nested(Type::table, "afterburn", afterburn_table()),
         nested(Type::table, "remap", remap_table()),
         nested(Type::tables, "gauge", gauge_table()),
         nested(Type::tables, "obstacle", obstacle_table()),
         nested(Type::tables, "region", region_table()),
         nested(Type::tables, "body", body_table()),
         nested(Type::tables, "constraint", constraint_table()),
         nested(Type::tables, "contact", contact_table()),
         nested(Type::tables, "surface_pressure", surface_pressure_table()),
         nested(Type::tables, "reinforcement", reinforcement_table()),
         nested(Type::table, "points", points_table()),
         nested(Type::table, "mpm_region", mpm_region_table()),
         nested(Type::table, "numerics", numerics_table()),
         nested(Type::table, "output", output_table()),
         nested(Type::table, "end", end_table()).required().like("time = \"10 ms\""),
         nested(Type::table, "checkpoint", checkpoint_table()),
         nested(Type::table, "audit", audit_table()),
         nested(Type::table, "compare", compare_table()),
         nested(Type::named, "explosives", explosives_table()),
         nested(Type::named, "fluids", fluids_table()),
         nested(Type::named, "solids", solids_table())},
        {},
        {}};
  }();
  return table;
}

Table const& explosive_file_schema() {
  static Table const table{"", joined(file_keys("explosive"), explosive_keys()), "eos", explosive_variants()};
  return table;
}

Table const& fluid_file_schema() {
  static Table const table{"", joined(file_keys("fluid"), fluid_keys()), "eos", fluid_variants()};
  return table;
}

Table const& solid_file_schema() {
  static Table const table{"", joined(file_keys("solid"), solid_keys()), {}, {}};
  return table;
}

namespace {

/// Letters to change, insert, delete or swap with the neighbour (optimal string alignment), case aside.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  auto const lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      bool const same = lower(a[i - 1]) == lower(b[j - 1]);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0U : 1U)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1])) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest(std::string_view word_, std::vector<std::string> const& names) {
  std::string best;
  std::size_t best_distance = 0;
  for (auto const& name : names) {
    std::size_t const longer = std::max(word_.size(), name.size());
    std::size_t const shorter = std::min(word_.size(), name.size());
    std::size_t const allowed = std::max<std::size_t>(1, longer / 3);
    if (longer - shorter > allowed) continue;
    std::size_t const distance = edit_distance(word_, name);
    if (distance <= allowed && distance < longer && (best.empty() || distance < best_distance)) {
      best = name;
      best_distance = distance;
    }
  }
  return best;
}

std::string quoted_list(std::vector<std::string> const& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out += i + 1 == names.size() ? " or " : ", ";
    out += fmt::format("\"{}\"", names[i]);
  }
  return out;
}

std::string suggestion(std::string_view word_, std::vector<std::string> const& names, std::string_view label) {
  std::string const near = nearest(word_, names);
  if (!near.empty()) return fmt::format("did you mean \"{}\"?", near);
  if (names.empty()) return fmt::format("no {} are defined", label);
  return fmt::format("{}: {}", label, fmt::join(names, ", "));
}

std::string range_text(Key const& key) {
  bool const low = key.minimum > -unbounded;
  bool const high = key.maximum < unbounded;
  std::string const unit = key.unit == "1" ? "" : fmt::format(" {}", key.unit);
  if (low && high) return fmt::format("{:g} to {:g}{}", key.minimum, key.maximum, unit);
  if (low) return fmt::format("at least {:g}{}", key.minimum, unit);
  if (high) return fmt::format("at most {:g}{}", key.maximum, unit);
  return "any";
}

std::string expectation(Key const& key) {
  std::string quantity = key.unit == "1" ? "a number" : fmt::format("{} in {}", units::dimension(key.unit), key.unit);
  switch (key.type) {
    case Type::number: return quantity;
    case Type::integer: return "a whole number";
    case Type::boolean: return "true or false";
    case Type::text: return "a string";
    case Type::name: return "a name of letters, digits and . _ - +";
    case Type::word: return quoted_list(key.choices);
    case Type::axis: return fmt::format("{} or a vector of three numbers", quoted_list(key.choices));
    case Type::words: return fmt::format("a list of words out of {}", quoted_list(key.choices));
    case Type::names: return "a list of strings";
    case Type::numbers: return fmt::format("a list, each element {}", quantity);
    case Type::integers: return "a list of whole numbers";
    case Type::point: return fmt::format("a list with one element per resolved direction, each {}", quantity);
    case Type::table: return key.choices.empty() ? "a table" : quoted_list(key.choices) + " or a table";
    case Type::tables: return "an array of tables";
    case Type::named: return "a table of named tables";
  }
  return {};
}

}  // namespace brisance::deck
