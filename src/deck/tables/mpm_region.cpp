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
          .means("Where: a table with `lower` and `upper`, whose faces lie between cells, on a boundary of "
                 "the domain or at least 4 cells from it; `auto`: the smallest box around the bodies with "
                 "`margin`, and the whole domain where an explosive throws out soil"),
      nested(Type::tables, "boxes", box_table())
          .note("none")
          .like("[{lower = [0, 0], upper = [1, 2]}, {lower = [1, 0], upper = [2, 1]}]")
          .means("Several boxes, instead of `box`: the region is what they cover together"),
      {&R::margin,
       typed(Type::integer, "margin", "1", 1, 1e6)
           .note("`width` + 10")
           .like("20")
           .means("Cells between the bodies and the faces of the box, with `box = \"auto\"`: room for the bodies to "
                  "move. A box that ends near a boundary of the domain is drawn out to it")},
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
           .means("How mass crosses the faces of the region: `ledger` conserves it to round-off, `paper` is Eqs. "
                  "(40)-(51) of [Cui14] as printed, which count twice what flows out of the region")},
      {&R::particles_per_direction, typed(Type::integer, "points_per_direction", "1", 1, 8)
                                        .note("4 in 1D, 3 in 2D, 2 in 3D")
                                        .like("2")
                                        .means("Points of the gas per cell and direction at the start")},
      {&R::activation, number("activation", "Pa", 0.0, 1e13)
                           .note("a thousandth of the ambient pressure")
                           .like("\"100 Pa\"")
                           .means("Overpressure next to the region that wakes it")},
      {&R::subcycling,
       typed(Type::boolean, "subcycling")
           .like("true")
           .means("Gas and points take steps of their own within a common one; else both take the shorter one")},
      {&R::transfer, word<mpm::Transfer>("transfer")
                         .like("\"apic\"")
                         .means("Of the gas points; `points.transfer` is that of the bodies")},
      {&R::order, word("order", {"usl", "musl"})
                      .like("\"usl\"")
                      .means("Of the gas points; `points.stress_order` is that of the bodies")},
      {&R::linear_viscosity, number("linear_viscosity", "1", 0.0, 10.0)
                                 .like("0.06")
                                 .means("Linear coefficient of the bulk viscosity of the gas points")},
      {&R::quadratic_viscosity, number("quadratic_viscosity", "1", 0.0, 100.0)
                                    .like("1.5")
                                    .means("Quadratic coefficient of the bulk viscosity of the gas points")},
      {&R::slip,
       typed(Type::boolean, "slip")
           .like("false")
           .means("Gas slips along solids: it shares their velocity across their surfaces only. false: gas sticks to "
                  "them, by the shared grid of [Cui14]; it then loads a plate some 20 % too much on 4 cells over its "
                  "thickness")},
      {&R::shock_conduction, number("shock_conduction", "1", 0.0, 10.0)
                                 .like("0.2")
                                 .means("Coefficient of the conduction of heat in shocks of the gas points")},
      {&R::courant, number("courant", "1", 0.01, 1.0)
                        .like("0.8")
                        .means("Courant number of the gas points; `points.courant` is that of the bodies")},
      {&R::population_interval, typed(Type::integer, "population_interval", "1", 0, 1e6)
                                    .like("4")
                                    .means("Steps between splits and merges of the gas points; 0: none")},
      {&R::reference_pressure, number("reference_pressure", "Pa", 0.0, 1e13)
                                   .note("the lowest pressure of the gas, the ambient one at most")
                                   .like("\"101.325 kPa\"")
                                   .means("Taken off the pressure in the forces on the points")}};
  return all;
}

}  // namespace

Table const& mpm_region_table() {
  static Table const table{
      "The part of a calculation with gas that material points calculate: the bodies and the gas around them "
      "([Cui14] Sec. 3). A deck with bodies and anything of the gas (charges, regions, obstacles, inflow, gauges in "
      "the gas) has one, also without this table; with this table bodies stand in the gas of `[ambient]` whatever "
      "else there is. Around the inside of the region lies the bridge, `width` cells thick, where gas cells and "
      "points calculate both. Solids keep `width` + 2 cells away from the faces of the region, charges and obstacles "
      "4 cells from its outside. The region calculates nothing until a wave comes near.",
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
  draft.report.warning(
      draft.deck.place_of("gauge"), "gauge",
      "gauges in the gas put the bodies into the ambient gas, with an MPM region around them; write body = "
      "... to measure on a body alone, or [mpm_region] where this is meant");
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
          fmt::format("the products of \"{}\" would be a third fluid beside \"{}\" and \"{}\"; a calculation has at "
                      "most two: use one explosive for all, or convert the mass by its TNT equivalent",
                      body.solid.name, draft.out.ambient.fluid.name, other->name));
    }
  }
}

/// Fluids that slip share one field of the grid and have no contact of their own.
void contacts_of_fluids(Draft const& draft, run::MpmRegion const& region) {
  auto const* const sections = draft.deck.sections("contact");
  auto const& contacts = draft.out.particles.contacts;
  if (!region.slip || sections == nullptr || sections->size() != contacts.size()) return;
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    for (int const body : {contacts[n].first, contacts[n].second}) {
      if (body >= static_cast<int>(draft.out.particles.bodies.size())) return;  // there were errors
      run::Body const& fluid = draft.out.particles.bodies[body];
      if (fluid.rigid || fluid.solid.has_deviator()) continue;
      draft.error(
          (*sections)[n], "bodies",
          fmt::format("\"{}\" is a fluid, and fluids slip along solids in an MPM region, without friction: remove the "
                      "contact, or write mpm_region.slip = false",
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
    draft.error(section, "boxes", "the region is given by box and by boxes: give only one of the two");
    return false;
  }
  if (several != nullptr && several->empty()) {
    draft.error(section, "boxes", "the list is empty: give at least one box, or remove the key");
    return false;
  }
  if (section.given("margin") && (one != nullptr || several != nullptr)) {
    draft.warn(section, "margin", "has no effect where the box is given");
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
                  fmt::format("{} does not lie above lower = {} in direction {}: exchange or correct them",
                              given.shown("upper"), given.shown("lower"), directions[d]));
      sound = false;
      return;
    }
    for (int d = 0; d < draft.dims() && draft.domain_known; ++d) {
      bool const below = (*lower)[d] < draft.out.domain.lower[d] - draft.tiny();
      if (!below && (*upper)[d] <= draft.out.domain.upper(d) + draft.tiny()) continue;
      draft.error(given, below ? "lower" : "upper",
                  fmt::format("{} lies outside the domain, which reaches from {:.6g} to {:.6g} m in direction {}",
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

}  // namespace

void build_mpm_region(Draft& draft) {
  if (!draft.has_gas || (!draft.has_bodies() && !draft.deck.given("mpm_region")) || draft.deck.broken("mpm_region"))
    return;
  run::MpmRegion region;
  Section const* section = draft.deck.section("mpm_region");
  bool sound = draft.domain_known && draft.boundaries_known;
  if (section != nullptr) {
    extent().read(*section, region);
    method().read(*section, region);
    sound = region_boxes(draft, *section, region) && !section->doubtful() && sound;
    for (auto const* key : {"margin", "width"}) sound = sound && !section->broken(key);
  }
  if (section == nullptr) warn_if_only_gauges(draft);
  bool const automatic = region.boxes.empty();
  // Bodies with an error of their own leave open where the region would be.
  bool const bodies_known =
      std::all_of(draft.body_shapes.begin(), draft.body_shapes.end(), [](auto const& s) { return s; });
  if (automatic && !draft.has_bodies() && sound) {
    draft.error(
        *section, "box",
        "there is no body that the region could be laid around: give its box, for example box = {lower = [0, 0, 0], "
        "upper = [1, 1, 1]}");
    return;
  }
  draft.out.mpm_region = region;
  products_of_bodies(draft);
  contacts_of_fluids(draft, region);
  if (!sound || (draft.has_bodies() && (!bodies_known || draft.body_shapes.empty()))) return;
  try {
    check_mpm_region(draft, setup::region_of(draft.out));
  } catch (InputError const& problem) {
    std::string const hint =
        automatic ? fmt::format(
                        "; this is the box around the bodies with {} cells on each side: write [mpm_region] "
                        "with a box or another margin",
                        setup::margin_of(region))
                  : "";
    bool const given = section != nullptr;
    std::string_view const key = given && section->given("boxes") ? "boxes" : "box";
    if (given) {
      draft.error(*section, key, problem.what() + hint);
    } else {
      draft.report.error(draft.deck.place_of("body"), "mpm_region", problem.what() + hint);
    }
  }
}

}  // namespace brisance::deck
