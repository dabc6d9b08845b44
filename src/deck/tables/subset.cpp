/// [[output.subset]]: planes and boxes of the field output.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/text.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/tables.hpp"
#include "observe/gas_fields.hpp"
#include "observe/subset_cells.hpp"

namespace brisance::deck {

namespace {

Table const& plane_table() {
  static Table const table{
      "A plane across one direction.",
      {word("normal", {"x", "y", "z"}).required().like("\"z\"").means("Direction of the normal"),
       number("at", "m", -far, far).required().like("\"1.5 m\"").means("Coordinate along the normal")},
      {},
      {}};
  return table;
}

Table const& box_table() {
  static Table const table{
      "A box within the domain. It is enlarged to whole cells of `domain.cell`, or of `cell` where "
      "that is larger.",
      {position("lower").required().like("[0, 0, 0]").means("Low corner"),
       position("upper").required().like("[2, 2, 1]").means("High corner")},
      {},
      {}};
  return table;
}

}  // namespace

Table const& subset_table() {
  static Table const table = [] {
    Key fields = typed(Type::words, "fields");
    for (auto const& field : observe::known_fields()) fields.choices.push_back(field.name);
    return Table{
        "A plane or a box of the gas (2D and 3D) whose fields are written as a series of their own, "
        "`subsets/NAME.hdf.series`. Give `plane` or `box`. In a deck with subsets that sets neither "
        "`output.field_interval` nor `output.field_times` the whole domain is not written.",
        {typed(Type::name, "name").required().like("\"street\"").means("Name of the series"),
         nested(Type::table, "plane", plane_table())
             .like("{normal = \"z\", at = \"1.5 m\"}")
             .means("The cells that a plane cuts"),
         nested(Type::table, "box", box_table())
             .like("{lower = [0, 0, 0], upper = [2, 2, 1]}")
             .means("The cells in a box"),
         number("cell", "m", smallest, 1e4)
             .note("cells as they are")
             .like("\"0.2 m\"")
             .means("Smallest cell size to write: `domain.cell` halved or doubled a whole number of times; smaller "
                    "cells are replaced by their means, weighted by volume"),
         number("interval", "s", 0.0, longest)
             .note("`output.field_interval`")
             .like("\"0.1 ms\"")
             .means("Time between dumps; 0: only the first and the last one"),
         std::move(fields)
             .note("those of the dumps of the whole domain")
             .like("[\"pressure\"]")
             .means("Fields to write")},
        {},
        {}};
  }();
  return table;
}

namespace {

constexpr std::size_t most_subsets = 100;
constexpr double most_dumps = 1e4;
constexpr double cell_tolerance = 1e-6;  ///< relative, of a cell size to a permitted one
constexpr double most_doublings = 20.0;

/// A size of cells without round-off.
std::string size_text(double size) { return quantity(size, "m", 9); }

std::optional<run::Plane> plane_of(Draft const& draft, Section const& section) {
  auto const normal = section.text("normal");
  auto const at = section.number("at");
  if (!normal || !at || section.doubtful()) return std::nullopt;
  int const d = static_cast<int>(std::string_view(directions).find(*normal));
  if (d >= draft.dims()) {
    draft.error(section, "normal",
                fmt::format("\"{}\" is not possible in {}, which resolves {}: write \"x\" or \"y\"", *normal,
                            word_of(draft.geometry()), direction_list(draft.dims())));
    return std::nullopt;
  }
  if (!draft.domain_known) return std::nullopt;
  double const low = draft.out.domain.lower[d];
  double const high = draft.out.domain.upper(d);
  if (*at >= low - draft.tiny() && *at <= high + draft.tiny()) return run::Plane{d, *at};
  draft.error(section, "at",
              fmt::format("{} lies outside the domain, which extends from {:.6g} to {:.6g} m along {}: write a "
                          "coordinate within it",
                          section.shown("at"), low, high, *normal));
  return std::nullopt;
}

std::optional<shape::Box> box_of(Draft const& draft, Section const& section) {
  auto const lower = draft.point(section, "lower");
  auto const upper = draft.point(section, "upper");
  if (!lower || !upper || section.doubtful() || !draft.domain_known) return std::nullopt;
  for (int d = 0; d < draft.dims(); ++d) {
    if ((*upper)[d] - (*lower)[d] <= draft.tiny()) {
      draft.error(section, "upper",
                  fmt::format("{} is not above lower = {} along {}: write a larger coordinate, or a plane",
                              section.shown("upper"), section.shown("lower"), directions[d]));
      return std::nullopt;
    }
    double const low = draft.out.domain.lower[d];
    double const high = draft.out.domain.upper(d);
    for (auto const& [key, x] : {std::pair{"lower", (*lower)[d]}, std::pair{"upper", (*upper)[d]}}) {
      if (x >= low - draft.tiny() && x <= high + draft.tiny()) continue;
      draft.error(section, key,
                  fmt::format("{} lies outside the domain, which extends from {:.6g} to {:.6g} m along {}: write "
                              "coordinates within it",
                              section.shown(key), low, high, directions[d]));
      return std::nullopt;
    }
  }
  return shape::Box{*lower, *upper};
}

/// The level of the cells that `cell` asks for; nothing after an error.
std::optional<int> level_of(Draft const& draft, Section const& section) {
  auto const size = section.number("cell");
  if (!size) return std::nullopt;
  double const coarsest = draft.out.domain.smallest_cell();
  double const finest = draft.out.domain_of(draft.out.adaptive.finest).smallest_cell();
  if (*size < finest * (1.0 - cell_tolerance)) {
    draft.error(section, "cell",
                fmt::format("{} is smaller than the {}cells, {}: remove the key to write the cells as they are, or "
                            "write a larger size",
                            section.shown("cell"), draft.out.adaptive.any() ? "finest " : "", size_text(finest)));
    return std::nullopt;
  }
  double const doublings = std::log2(*size / coarsest);
  double const whole = std::round(doublings);
  if (std::abs(std::exp2(doublings - whole) - 1.0) > cell_tolerance || whole > most_doublings) {
    double const below = std::min(std::floor(doublings), most_doublings - 1.0);
    draft.error(section, "cell",
                fmt::format("{} is not domain.cell = {} {}doubled up to {:g} times: write \"{}\" or \"{}\"",
                            section.shown("cell"), size_text(coarsest), draft.out.adaptive.any() ? "halved or " : "",
                            most_doublings, size_text(coarsest * std::exp2(below)),
                            size_text(coarsest * std::exp2(below + 1.0))));
    return std::nullopt;
  }
  return -static_cast<int>(whole);
}

/// Do its cells end with the domain?
bool fits(Draft const& draft, Section const& section, run::FieldSubset const& subset) {
  observe::SubsetCells const shown(subset, draft.out.domain, draft.out.adaptive.finest);
  int const d = shown.direction_beyond();
  if (d < 0) return true;
  int const cells = draft.out.domain.cells[d];
  double size = draft.out.domain.smallest_cell();
  for (int rest = cells; rest % 2 == 0; rest /= 2) size *= 2.0;
  draft.error(
      section, "cell",
      fmt::format("cells of {} do not end with the domain, which has {} cells of {} along {}: write at most {}{}",
                  section.shown("cell"), cells, size_text(draft.out.domain.smallest_cell()), directions[d],
                  size_text(size), shown.normal() < 0 ? ", or a box that ends before" : ""));
  return false;
}

/// What one table asks for; nothing after an error.
std::optional<run::FieldSubset> subset_of(Draft const& draft, Section const& section) {
  if (section.given("plane") == section.given("box")) {
    draft.report.error(section.place, section.path,
                       fmt::format("it has {}, but exactly one of them tells what is written: write, for example, "
                                   "plane = {{normal = \"x\", at = \"1 m\"}}",
                                   section.given("plane") ? "both plane and box" : "neither plane nor box"));
    return std::nullopt;
  }
  run::FieldSubset subset;
  subset.interval = section.number("interval").value_or(draft.out.output.field_interval);
  if (section.given("interval")) limit_times(draft, section, "interval", subset.interval, most_dumps, "dumps");
  if (auto const* fields = section.strings("fields")) {
    subset.fields = *fields;
    without_repeats(subset.fields);
    if (subset.fields.empty())
      draft.error(section, "fields", "is empty: name a field, or remove the key for those of the whole domain");
  }
  std::string_view const key = section.given("plane") ? "plane" : "box";
  Section const* const place = section.section(key);
  if (place == nullptr) return std::nullopt;
  auto const plane = key == "plane" ? plane_of(draft, *place) : std::nullopt;
  auto const box = key == "box" ? box_of(draft, *place) : std::nullopt;
  bool const with_cell = section.given("cell");
  if (!draft.domain_known) return std::nullopt;
  if (with_cell) subset.level = level_of(draft, section);
  auto const name = section.text("name");
  if (!name || (!plane && !box) || (with_cell && !subset.level)) return std::nullopt;
  subset.name = *name;
  if (plane)
    subset.place = *plane;
  else
    subset.place = *box;
  if (!fits(draft, section, subset)) return std::nullopt;
  return subset;
}

/// Can the deck have subsets at all?
bool can_have(Draft const& draft, Section const& first, std::size_t count) {
  if (!draft.has_gas) {
    draft.report.error(first.place, first.path,
                       "this deck contains no gas, and only fields of the gas have subsets: remove the table");
  } else if (draft.dims() == 1) {
    draft.report.error(first.place, first.path,
                       fmt::format("{} has neither planes nor boxes: remove the table, and use field_interval",
                                   word_of(draft.geometry())));
  } else if (count > most_subsets) {
    draft.report.error(first.place, first.path,
                       fmt::format("there are {} subsets; allowed: at most {}: remove some", count, most_subsets));
  } else {
    return true;
  }
  return false;
}

}  // namespace

void build_subsets(Draft& draft, Section const& output) {
  auto const* all = output.sections("subset");
  if (all == nullptr || all->empty() || !draft.geometry_known) return;
  if (!can_have(draft, all->front(), all->size())) return;
  draft.out.output.whole = output.given("field_interval") || output.given("field_times");
  std::set<std::string> names;
  for (Section const& section : *all) {
    auto const name = section.text("name");
    if (name && !names.insert(*name).second)
      draft.error(section, "name", fmt::format("\"{}\" is used by another subset: choose another name", *name));
    if (section.doubtful()) continue;
    if (auto subset = subset_of(draft, section)) draft.out.output.subsets.push_back(std::move(*subset));
  }
}

}  // namespace brisance::deck
