/// `start` and [remap]: charges on the grid, or bursts in one direction that are remapped.
#include <fmt/format.h>

#include <filesystem>

#include "core/error.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"
#include "setup/start.hpp"

namespace brisance::deck {

namespace {

Settings<run::Start> const& settings() {
  using S = run::Start;
  static Settings<S> const all{
      {&S::method, word<run::StartMethod>("method").like("\"gas\"").means(
                       "`gas`: the gas scheme; `points`: material points, as in [Cui14]")},
      {&S::cell, number("cell", "m", smallest, 1e4)
                     .note("1/400 of the charge radius")
                     .like("\"0.5 mm\"")
                     .means("Cell size of the 1D simulation")},
      {&S::time, number("time", "s", 1e-12, longest)
                     .note("when the shock is about to reach something")
                     .like("\"0.2 ms\"")
                     .means("Time of the remap; gauges then do not stop it")},
      {&S::radius, number("radius", "m", smallest, far)
                       .note("where the shock is about to reach something")
                       .like("\"0.8 m\"")
                       .means("Radius of the shock at the remap, instead of the time; gauges then do not stop it")},
      typed(Type::text, "profile")
          .note("none: 1D simulation")
          .like("\"../burst-results/profiles/start_1.h5\"")
          .means("Profile of an earlier run that replaces the 1D simulation, with a path relative to the deck. It may "
                 "come from a 1D run or, for 3D, from axisymmetric2d. It is scaled to the mass of the charge; its "
                 "explosive and its ambient gas must be those of the deck")};
  return all;
}

}  // namespace

Table const& remap_table() {
  static Table const table{
      "Settings of `start = \"remap\"`: each charge detonates in a one-dimensional simulation (spherical; cylindrical "
      "in planar2d) until its shock is about to reach a boundary, an obstacle, the MPM region, another blast wave or a "
      "gauge. The profile is then mapped onto the grid with the mass of both fluids, the energy and the momentum "
      "conserved, and the simulation continues from that time.",
      settings().keys(),
      {},
      {}};
  return table;
}

namespace {

/// A profile is the burst of one charge and nothing else.
void check_profile(Draft const& draft) {
  if (!draft.out.output.profile || !draft.geometry_known) return;
  bool const possible = draft.geometry() == Geometry::spherical1d || draft.geometry() == Geometry::cylindrical1d ||
                        draft.geometry() == Geometry::axisymmetric2d;
  auto const* charges = draft.deck.sections("charge");
  bool const one = charges != nullptr && charges->size() == 1;
  if (!possible || !one || draft.has_bodies() || draft.deck.given("obstacle") || draft.deck.given("initial_state") ||
      draft.deck.given("mpm_region")) {
    draft.error(
        *draft.deck.section("output"), "profile",
        fmt::format("a profile describes the blast wave of one charge in spherical1d, cylindrical1d or axisymmetric2d "
                    "without bodies, obstacles and initial states, but this deck {}: remove the key",
                    !possible ? fmt::format("is in {}", word_of(draft.geometry()))
                    : !one    ? fmt::format("has {} charges", charges == nullptr ? 0 : charges->size())
                              : "contains one of these"));
  }
}

/// What [remap] sets.
void remap_options(Draft const& draft, Section const& section, run::Start& s) {
  settings().read(section, s);
  if (auto const file = section.text("profile")) {
    s.profile = (std::filesystem::path(draft.report.file()).parent_path() / *file).string();
    for (auto const* other : {"method", "cell", "time", "radius"}) {
      if (!section.given(other)) continue;
      draft.error(section, other,
                  fmt::format("{} belongs to the 1D simulation, which the profile replaces: remove one of the two",
                              section.shown(other)));
    }
  }
  if (s.method == run::StartMethod::particles && draft.deck.given("afterburn")) {
    draft.error(section, "method",
                fmt::format("{} cannot be combined with [afterburn], which is available in gas cells only: write "
                            "\"gas\", or remove the afterburn",
                            section.shown("method")));
  }
  if (section.given("time") && section.given("radius")) {
    draft.error(section, "radius",
                fmt::format("{} is given together with a time: remove one of the two", section.shown("radius")));
  }
}

}  // namespace

void build_start(Draft& draft) {
  bool const specified = draft.deck.text("start") == "remap";
  Section const* section = draft.deck.section("remap");
  check_profile(draft);
  if (!specified) {
    if (section != nullptr && !draft.deck.broken("start")) {
      draft.report.warning(section->place, section->path,
                           "has no effect without start = \"remap\" at the top of the deck");
    }
    return;
  }
  run::Start& s = draft.out.start;
  s.remap = true;
  std::string_view key = "start";
  Section const* blamed = &draft.deck;
  if (section != nullptr) {
    remap_options(draft, *section, s);
    for (auto const* candidate : {"cell", "time", "radius", "profile"}) {
      if (!section->given(candidate)) continue;
      blamed = section;
      key = candidate;
    }
  }
  Place const place = blamed->place_of(key);
  s.place = fmt::format("{}:{}:{}: error: {}", draft.report.file(), place.line, place.column, blamed->path_of(key));
  if (!draft.has_gas && draft.geometry_known) {
    draft.error(draft.deck, "start",
                "\"remap\" needs a charge in gas, but this deck has bodies in empty space: remove it");
    return;
  }
  if (s.time && draft.end_known && *s.time >= draft.out.end.time) {
    draft.error(
        *section, "time",
        fmt::format(
            "{} is not before the end of the simulation at {:g} s: choose an earlier time, or extend the simulation",
            section->shown("time"), draft.out.end.time));
    return;
  }
  // What the parts of the deck mean together can be told only when all of them are sound.
  bool const sound = draft.domain_known && draft.boundaries_known && draft.end_known && !draft.report.failed();
  if (!sound || !s.profile.empty()) return;
  try {
    for (std::size_t n = 0; n < std::max<std::size_t>(1, draft.out.charges.size()); ++n)
      (void)setup::plan_start(draft.out, n);
  } catch (InputError const& problem) {
    draft.error(*blamed, key, problem.what());
  }
}

}  // namespace brisance::deck
