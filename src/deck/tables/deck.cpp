/// The whole of a deck: its tables, and the order in which they are built.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

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
             .means("`direct`: the charges are on the grid from the beginning; `remap`: each charge first detonates in "
                    "a fine 1D simulation, see `[remap]`"),
         nested(Type::table, "domain", domain_table()).required().like("size = [4, 4, 3] and cell = \"50 mm\""),
         nested(Type::table, "adaptive", adaptive_table()),
         nested(Type::tables, "refine", refine_table()),
         nested(Type::table, "boundaries", boundaries_table()),
         std::move(inflow),
         nested(Type::table, "ambient", ambient_table()),
         nested(Type::tables, "charge", charge_table()),
         nested(Type::table, "afterburn", afterburn_table()),
         nested(Type::table, "remap", remap_table()),
         nested(Type::tables, "gauge", gauge_table()),
         nested(Type::tables, "obstacle", obstacle_table()),
         nested(Type::tables, "initial_state", initial_state_table()),
         nested(Type::tables, "body", body_table()),
         nested(Type::tables, "constraint", constraint_table()),
         nested(Type::tables, "contact", contact_table()),
         nested(Type::tables, "surface_pressure", surface_pressure_table()),
         nested(Type::tables, "reinforcement", reinforcement_table()),
         nested(Type::table, "points", particles_table()),
         nested(Type::tables, "mpm_region", mpm_region_table()).or_one(),
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

namespace {

/// Does the deck speak of gas beside its bodies? Then both are calculated; bodies alone move in empty space.
bool speaks_of_gas(Draft const& draft) {
  for (auto const* key : {"mpm_region", "charge", "initial_state", "obstacle", "inflow"}) {
    if (draft.deck.given(key)) return true;
  }
  auto const* all = draft.deck.sections("gauge");
  return all != nullptr && std::any_of(all->begin(), all->end(),
                                       [](Section const& gauge) { return !gauge.doubtful() && !gauge.given("body"); });
}

/// Settings of the gas beside bodies in empty space.
void warn_of_unused_gas(Draft const& draft) {
  for (auto const* key : {"ambient", "numerics"}) {
    if (!draft.deck.given(key)) continue;
    draft.report.warning(draft.deck.place_of(key), key,
                         "has no effect: this deck contains no gas, and its bodies move in empty space; with "
                         "[mpm_region] they are surrounded by the ambient gas");
  }
}

/// Things of material points without a body.
void refuse_particles(Draft const& draft) {
  for (auto const* key : {"constraint", "contact", "surface_pressure", "reinforcement"}) {
    auto const* all = draft.deck.sections(key);
    if (all == nullptr || all->empty()) continue;
    draft.report.error(all->front().place, all->front().path,
                       "there is no body on which this could act: add a [[body]] or remove it");
  }
  if (draft.deck.given("points") && !draft.deck.given("mpm_region")) {
    draft.report.warning(draft.deck.place_of("points"), "points", "has no effect in a deck without bodies");
  }
}

void unused_materials(Draft const& draft) {
  std::set<std::string> used;
  auto const use = [&](Section const& section, std::string_view key) {
    if (auto const name = section.text(key)) used.insert(*name);
  };
  if (Section const* ambient = draft.deck.section("ambient")) use(*ambient, "fluid");
  draft.each("charge", [&](Section const& section) { use(section, "explosive"); });
  draft.each("initial_state", [&](Section const& section) { use(section, "fluid"); });
  draft.each("body", [&](Section const& section) { use(section, "material"); });
  for (auto const* key : {"explosives", "fluids", "solids"}) {
    draft.each(key, [&](Section const& section) {
      if (used.contains(section.name)) return;
      draft.report.warning(section.place, section.path, "is not used in this deck: refer to it by name, or remove it");
    });
  }
}

/// What a deck names is built, or an error says why it is not.
void nothing_is_dropped(Draft const& draft) {
  if (draft.report.failed()) return;
  auto const named = [&](std::string_view key) {
    auto const* all = draft.deck.sections(key);
    return all == nullptr ? std::size_t{0} : all->size();
  };
  for (auto const& [key, built] :
       {std::pair{"charge", draft.out.charges.size()}, std::pair{"body", draft.out.particles.bodies.size()},
        std::pair{"initial_state", draft.out.initial_states.size()},
        std::pair{"gauge", draft.out.gauges.size() + draft.out.particles.gauges.size()}}) {
    if (built >= named(key)) continue;  // a line of gauges is many
    throw std::logic_error(
        fmt::format("of {} [[{}]] only {} were built, but no error was reported", named(key), key, built));
  }
}

}  // namespace

Draft build_case(Section const& deck, Report& report) {
  Draft draft(deck, report);
  draft.out.title = draft.deck.text("title").value_or("");
  build_domain(draft);
  build_numerics(draft);
  build_explosives(draft);
  build_fluids(draft);
  build_solids(draft);
  build_ambient(draft);
  if (draft.geometry_known) {
    draft.has_gas = !draft.has_bodies() || speaks_of_gas(draft);
    build_boundaries(draft);
    build_adaptive(draft);
    if (draft.has_bodies()) {
      build_bodies(draft);
      assign_bodies(draft);
      build_constraints(draft);
      build_contacts(draft);
      build_surface_pressures(draft);
      build_reinforcements(draft);
    } else {
      refuse_particles(draft);
    }
    if (draft.has_gas) {
      build_obstacles(draft);
      build_charges(draft);
      build_initial_states(draft);
    } else {
      warn_of_unused_gas(draft);
      warn_of_fluids_in_empty_space(draft);
    }
    build_gauges(draft);
  }
  build_particles(draft);
  if (draft.geometry_known) build_mpm_regions(draft);
  check_initial_stress(draft);  // on the cells of the region
  build_ideal_products(draft);
  build_end(draft);
  if (draft.geometry_known) build_afterburn(draft);
  build_output(draft);
  build_start(draft);
  build_checkpoint(draft);
  build_audit(draft);
  build_compare(draft);
  unused_materials(draft);
  nothing_is_dropped(draft);
  return draft;
}

}  // namespace brisance::deck
