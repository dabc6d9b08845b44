/// [mpm_region]: where gas and material points meet.
#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"
#include "setup/place_region.hpp"

namespace brisance::deck {

namespace {

Table const& box_table() {
  static Table const table{"A box of cells, in the resolved directions.",
                           {position("lower").required().like("[0.1, 0]").means("Low corner"),
                            position("upper").required().like("[0.16, 0.5]").means("High corner")},
                           {},
                           {}};
  return table;
}

/// Where the region lies.
Settings<run::MpmRegion> const& extent() {
  using R = run::MpmRegion;
  static Settings<R> const all{
      nested_or(Type::table, "box", box_table(), {"auto"})
          .of("auto")
          .like("{lower = [\"110 mm\", 0], upper = [\"160 mm\", \"500 mm\"]}")
          .means("Extent of the MPM region: a table with `lower` and `upper`, whose faces are cell faces, either on a "
                 "boundary of the domain or at least 4 cells from it; `auto`: the smallest box around the bodies plus "
                 "`margin`, or the whole domain if an explosive ejects soil"),
      nested(Type::tables, "boxes", box_table())
          .note("none")
          .like("[{lower = [0, 0], upper = [1, 2]}, {lower = [1, 0], upper = [2, 1]}]")
          .means("Several boxes, instead of `box`: the region is their union"),
      typed(Type::names, "bodies")
          .note("those in its boxes; all where there is one region")
          .like("[\"plate\", \"frame\"]")
          .means("With several regions: names of the bodies that this one surrounds. A region without `box` or `boxes` "
                 "needs it"),
      {&R::margin,
       typed(Type::integer, "margin", "1", 1, 1e6)
           .note("`width` + 10")
           .like("20")
           .means("With `box = \"auto\"`: number of cells between the bodies and the faces of the box, in which the "
                  "bodies can move. A box that ends near a boundary of the domain is extended to it")},
      number("cell", "m", smallest, 1e4)
          .note("`adaptive.finest`; without `[adaptive]` `domain.cell`")
          .like("\"8 mm\"")
          .means(
              "Size of the cells in the region and around it: `domain.cell` halved a whole number of times, at least "
              "`adaptive.finest`. Bodies, particles, `margin` and `width` count in these cells"),
      {&R::width,
       typed(Type::integer, "width", "1", 1, 50).like("5").means("Width w of the bridge in cells, 5 in [Cui14]")}};
  return all;
}

/// How it is calculated.
Settings<run::MpmRegion> const& method() {
  using R = run::MpmRegion;
  static Settings<R> const all{
      {&R::transport,
       word<bridge::Transport>("transport")
           .like("\"ledger\"")
           .means("How mass crosses the faces of the region: `ledger` conserves it to round-off; `paper` uses Eqs. "
                  "(40)-(51) of [Cui14] as printed, which count outflow from the region twice")},
      {&R::particles_per_direction, typed(Type::integer, "points_per_direction", "1", 1, 8)
                                        .note("4 in 1D, 3 in 2D, 2 in 3D")
                                        .like("2")
                                        .means("Initial number of gas particles per cell and direction")},
      {&R::activation, number("activation", "Pa", 0.0, 1e13)
                           .note("0.1 % of the ambient pressure")
                           .like("\"100 Pa\"")
                           .means("Overpressure next to the region that activates it")},
      {&R::subcycling, typed(Type::boolean, "subcycling")
                           .like("true")
                           .means("true: gas and particles use their own sub-steps within a common step; false: both "
                                  "use the shorter step")},
      {&R::transfer, word<mpm::Transfer>("transfer")
                         .like("\"apic\"")
                         .means("For the gas particles; `points.transfer` applies to the bodies")},
      {&R::order, word("order", {"usl", "musl"})
                      .like("\"usl\"")
                      .means("For the gas particles; `points.stress_order` applies to the bodies")},
      {&R::linear_viscosity, number("linear_viscosity", "1", 0.0, 10.0)
                                 .like("0.06")
                                 .means("Linear coefficient of the bulk viscosity of the gas particles")},
      {&R::quadratic_viscosity, number("quadratic_viscosity", "1", 0.0, 100.0)
                                    .like("1.5")
                                    .means("Quadratic coefficient of the bulk viscosity of the gas particles")},
      {&R::slip, typed(Type::boolean, "slip")
                     .like("false")
                     .means("true: gas slips along solids and shares only the normal component of their velocity; "
                            "false: gas sticks to them through the shared grid, as in [Cui14], and then overloads a "
                            "plate by about 20 % with 4 cells over its thickness")},
      {&R::shock_conduction, number("shock_conduction", "1", 0.0, 10.0)
                                 .like("0.2")
                                 .means("Coefficient of heat conduction in shocks of the gas particles")},
      {&R::courant, number("courant", "1", 0.01, 1.0)
                        .like("0.8")
                        .means("Courant number of the gas particles; `points.courant` applies to the bodies")},
      {&R::population_interval, typed(Type::integer, "population_interval", "1", 0, 1e6)
                                    .like("4")
                                    .means("Steps between splitting and merging of gas particles; 0: none")},
      {&R::reference_pressure,
       number("reference_pressure", "Pa", 0.0, 1e13)
           .note("the lowest pressure of the gas, at most the ambient pressure")
           .like("\"101.325 kPa\"")
           .means("Pressure that is subtracted when the forces on the particles are computed")}};
  return all;
}

}  // namespace

Table const& mpm_region_table() {
  static Table const table{
      "The MPM region (\"region\" below): the part of a simulation with gas that is computed with material points, "
      "namely the bodies and the gas around them ([Cui14] Sec. 3). A deck with bodies and with gas (charges, initial "
      "states, obstacles, inflow or gauges in the gas) always has an MPM region, even without this table. With this "
      "table, bodies are always surrounded by the gas of `[ambient]`. The bridge lies along the inside of the region, "
      "`width` cells thick; there, gas cells and particles are both computed. Solids must stay `width` + 2 cells away "
      "from the faces of the region; charges and obstacles must stay 4 cells outside it. The region is inactive until "
      "a wave comes near. Several tables `[[mpm_region]]` give several regions, each with settings and, with "
      "`[adaptive]`, a cell size of its own: each body belongs to one of them, and between two regions there must be "
      "some cells of gas. A message says how many.",
      joined(extent().keys(), method().keys()),
      {},
      {}};
  return table;
}

namespace {

void warn_if_only_gauges(Draft const& draft) {
  for (auto const* key : {"charge", "initial_state", "obstacle", "inflow"}) {
    if (draft.deck.given(key)) return;
  }
  draft.report.warning(draft.deck.place_of("gauge"), "gauge",
                       "gauges in the gas surround the bodies with ambient gas and an MPM region; write body = ... to "
                       "record a body only, or add [mpm_region] if this is intended");
}

/// The products of explosives in the region are the fluid beside the ambient one.
void products_of_bodies(Draft& draft) {
  auto const* const sections = draft.deck.sections("body");
  if (sections == nullptr || sections->size() != draft.out.particles.bodies.size()) return;  // there were errors
  for (std::size_t n = 0; n < sections->size(); ++n) {
    run::Body const& body = draft.out.particles.bodies[n];
    if (!body.solid.burns()) continue;
    material::Fluid const* other = draft.out.other_fluid(1);
    if (other == nullptr) {
      draft.out.other_fluids = {products(*draft.materials.explosive(body.solid.name))};
    } else if (other->name != body.solid.name) {
      draft.error(
          (*sections)[n], "material",
          fmt::format("the products of \"{}\" would be a third fluid in addition to \"{}\" and \"{}\"; a simulation "
                      "has at most two: use one explosive for all, or convert the mass with its TNT equivalent",
                      body.solid.name, draft.out.ambient.fluid.name, other->name));
    }
  }
}

/// Fluids that slip share one field of the grid and have no contact of their own.
void contacts_of_fluids(Draft const& draft) {
  auto const* const sections = draft.deck.sections("contact");
  auto const& contacts = draft.out.particles.contacts;
  if (sections == nullptr || sections->size() != contacts.size()) return;
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    for (int const body : {contacts[n].first, contacts[n].second}) {
      if (body >= static_cast<int>(draft.out.particles.bodies.size())) return;  // there were errors
      if (!draft.out.mpm_regions[draft.out.region_with(body)].slip) continue;
      run::Body const& fluid = draft.out.particles.bodies[body];
      if (fluid.rigid || fluid.solid.has_deviator()) continue;
      draft.error((*sections)[n], "bodies",
                  fmt::format("\"{}\" is a fluid, and in an MPM region fluids slip along solids without friction: "
                              "remove the contact, or write mpm_region.slip = false",
                              fluid.name));
    }
  }
}

/// The boxes of the table; false after an error.
bool region_boxes(Draft const& draft, Section const& section, run::MpmRegion& region) {
  if (section.broken("box") || section.broken("boxes")) return false;
  Section const* one = section.section("box");
  auto const* several = section.sections("boxes");
  if (one != nullptr && several != nullptr) {
    draft.error(section, "boxes", "boxes is given together with box: give only one of them");
    return false;
  }
  if (several != nullptr && several->empty()) {
    draft.error(section, "boxes", "the list is empty: give at least one box, or remove the key");
    return false;
  }
  if (section.given("margin") && (one != nullptr || several != nullptr)) {
    draft.warn(section, "margin", "has no effect if the box is given");
  }
  bool sound = true;
  auto const add = [&](Section const& given) {
    auto const lower = draft.point(given, "lower");
    auto const upper = draft.point(given, "upper");
    if (!lower || !upper || given.doubtful()) {
      sound = false;
      return;
    }
    for (int d = 0; d < draft.dims(); ++d) {
      if ((*upper)[d] > (*lower)[d]) continue;
      draft.error(given, "upper",
                  fmt::format("{} is not above lower = {} in direction {}: swap or correct them", given.shown("upper"),
                              given.shown("lower"), directions[d]));
      sound = false;
      return;
    }
    for (int d = 0; d < draft.dims() && draft.domain_known; ++d) {
      bool const below = (*lower)[d] < draft.out.domain.lower[d] - draft.tiny();
      if (!below && (*upper)[d] <= draft.out.domain.upper(d) + draft.tiny()) continue;
      draft.error(given, below ? "lower" : "upper",
                  fmt::format("{} lies outside the domain, which extends from {:.6g} to {:.6g} m in direction {}",
                              given.shown(below ? "lower" : "upper"), draft.out.domain.lower[d],
                              draft.out.domain.upper(d), directions[d]));
      sound = false;
      return;
    }
    region.boxes.push_back({*lower, *upper});
  };
  if (one != nullptr) add(*one);
  if (several != nullptr) {
    for (Section const& given : *several) add(given);
  }
  return sound;
}

/// The table of a region; false after an error that leaves open where the region lies.
bool read_region(Draft& draft, Section const& section, run::MpmRegion& region) {
  extent().read(section, region);
  method().read(section, region);
  bool sound = region_boxes(draft, section, region) && !section.doubtful();
  for (auto const* key : {"margin", "width"}) sound = sound && !section.broken(key);
  if (section.given("bodies") && !draft.has_bodies()) {
    draft.error(section, "bodies", "there are no bodies in this deck: remove the key");
    return false;
  }
  bool const without_bodies = draft.has_several_regions() ? draft.bodies_assigned : !draft.has_bodies();
  if (sound && draft.domain_known && region.boxes.empty() && region.bodies.empty() && without_bodies) {
    sound = false;
    draft.error(section, "box",
                draft.has_several_regions() && !draft.body_names.empty()
                    ? "nothing says where the MPM region lies: give its box, or name the bodies that it surrounds, for "
                      "example bodies = [\"" +
                          draft.body_names.front() + "\"]"
                    : "there is no body around which the MPM region could be placed: give its box, for example box = "
                      "{lower = [0, 0, 0], upper = [1, 1, 1]}");
  }
  return sound;
}

/// The cells of a region, where it fits the domain and what else there is.
std::optional<bridge::Region> placed_region(Draft const& draft, std::size_t number) {
  auto const& sections = draft.region_sections();
  run::MpmRegion const& region = draft.out.mpm_regions[number];
  try {
    bridge::Region placed = setup::region_of(draft.out, number);
    check_mpm_region(draft, placed, number);
    return placed;
  } catch (InputError const& problem) {
    std::string const hint = region.boxes.empty() ? fmt::format(
                                                        "; this is the box around the bodies with a margin of {} "
                                                        "cells: write [mpm_region] with a box or another margin",
                                                        setup::margin_of(region))
                                                  : "";
    if (sections.empty()) {
      draft.report.error(draft.deck.place_of("body"), "mpm_region", problem.what() + hint);
    } else {
      Section const& section = sections[number];
      draft.error(section, section.given("boxes") ? "boxes" : "box", problem.what() + hint);
    }
  }
  return std::nullopt;
}

}  // namespace

void build_mpm_regions(Draft& draft) {
  if (!draft.has_gas || (!draft.has_bodies() && !draft.deck.given("mpm_region")) || draft.deck.broken("mpm_region"))
    return;
  auto const& sections = draft.region_sections();
  if (sections.empty() && draft.deck.given("mpm_region")) {
    draft.error(draft.deck, "mpm_region", "the list of MPM regions is empty: remove the key, or write [[mpm_region]]");
    return;
  }
  if (sections.empty()) warn_if_only_gauges(draft);
  bool sound = draft.domain_known && draft.boundaries_known;
  std::vector<run::MpmRegion> regions(draft.region_levels.size());
  for (std::size_t n = 0; n < draft.body_regions.size(); ++n) {
    auto const number = static_cast<std::size_t>(draft.body_regions[n]);
    regions[number].bodies.push_back(static_cast<int>(n));
  }
  for (std::size_t n = 0; n < regions.size(); ++n) {
    regions[n].level = draft.region_levels[n];
    if (!sections.empty()) sound = read_region(draft, sections[n], regions[n]) && sound;
  }
  draft.out.mpm_regions = std::move(regions);
  products_of_bodies(draft);
  contacts_of_fluids(draft);
  // Bodies with an error of their own leave open where a region would be.
  bool const bodies_known = draft.bodies_assigned && std::all_of(draft.body_shapes.begin(), draft.body_shapes.end(),
                                                                 [](auto const& s) { return s; });
  if (!sound || (draft.has_bodies() && (!bodies_known || draft.body_shapes.empty()))) return;
  std::vector<bridge::Region> placed;
  for (std::size_t n = 0; n < draft.out.mpm_regions.size(); ++n) {
    if (auto region = placed_region(draft, n)) placed.push_back(std::move(*region));
  }
  if (placed.size() == draft.out.mpm_regions.size()) check_together(draft, placed);
}

}  // namespace brisance::deck
