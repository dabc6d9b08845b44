/// [compare]: the curves that the gauges are compared with, and decks in which nothing would happen.
#include <fmt/format.h>

#include <cmath>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

Table const& compare_table() {
  static Table const table{
      "Comparison of the gauges with the curves of Kingery and Bulmash.",
      {word("burst", {"auto", "spherical", "hemispherical", "none"})
           .of("auto")
           .like("\"hemispherical\"")
           .means("Type of burst. `auto`: hemispherical for one hemispherical charge on a wall or symmetry plane, "
                  "spherical for one spherical charge in free air, none in all other cases (obstacles, initial states, "
                  "further walls, another ambient fluid)")},
      {},
      {}};
  return table;
}

namespace {

run::Burst automatic_burst(Draft const& draft) {
  bool const body_of_revolution = draft.geometry() == Geometry::cartesian3d ||
                                  draft.geometry() == Geometry::axisymmetric2d ||
                                  draft.geometry() == Geometry::spherical1d;
  if (draft.out.charges.size() != 1 || !draft.out.initial_states.empty() || !draft.out.obstacles.empty() ||
      draft.has_bodies() || !body_of_revolution || draft.out.ambient.fluid.name != "air") {
    return run::Burst::none;
  }
  auto const& body = draft.out.charges.front().shape;
  auto const* half = std::get_if<shape::Hemisphere>(&body);
  if (half == nullptr && !std::holds_alternative<shape::Sphere>(body)) return run::Burst::none;
  Vec3 const c = shape::centre(body);
  bool on_ground = false;
  for (int f = 0; f < 2 * draft.dims(); ++f) {
    int const d = f / 2;
    Boundary const b = draft.out.domain.boundary[f];
    if (grid::is_open(b) || (draft.radial() && f == 0)) continue;
    double const plane = f % 2 == 0 ? draft.out.domain.lower[d] : draft.out.domain.upper(d);
    bool const through_centre = std::abs(c[d] - plane) <= draft.tiny();
    bool const flat_side = half != nullptr && half->normal[d] * (f % 2 == 0 ? 1.0 : -1.0) > 0.0;
    if (!through_centre || (b != Boundary::symmetry && !(b == Boundary::wall && flat_side))) return run::Burst::none;
    on_ground = on_ground || flat_side;
  }
  if (half != nullptr) return on_ground ? run::Burst::hemispherical : run::Burst::none;
  return run::Burst::spherical;
}

}  // namespace

void build_compare(Draft& draft) {
  Section const& section = draft.table("compare");
  auto const word = section.text("burst");
  if (!word) return;
  if (*word == "spherical") draft.out.burst = run::Burst::spherical;
  if (*word == "hemispherical") draft.out.burst = run::Burst::hemispherical;
  if (*word == "auto") draft.out.burst = automatic_burst(draft);
  auto const* charges = draft.deck.sections("charge");
  bool const one = charges != nullptr && charges->size() == 1;
  if (*word != "auto" && *word != "none" && !one && !draft.deck.broken("charge")) {
    draft.error(section, "burst",
                fmt::format("\"{}\" needs exactly one charge, but there are {}: write \"none\"", *word,
                            charges == nullptr ? 0 : charges->size()));
  }
  if (!draft.has_gas) draft.out.burst = run::Burst::none;
  bool const particles = draft.has_bodies() && particles_move(draft);
  // A wind blows against obstacles and walls.
  bool const wind = draft.has_gas && norm(draft.out.ambient.state.velocity) > 0.0;
  bool const gas =
      wind || draft.deck.given("charge") || draft.deck.given("initial_state") || draft.deck.given("inflow");
  if (particles || gas) return;
  if (!draft.has_gas) {
    draft.report.warning(
        draft.deck.place_of("body"), "body",
        "nothing will happen: no body moves, detonates or is under pressure, and no load or body force acts");
  } else if (draft.has_bodies()) {
    draft.report.warning(draft.deck.place, "charge",
                         "nothing will happen: there is no charge, no initial state and no inflow, no body moves or "
                         "detonates, and no load or body force acts");
  } else {
    draft.report.warning(draft.deck.place, "charge",
                         "nothing will happen: there is no charge, no initial state and no inflow");
  }
}

}  // namespace brisance::deck
