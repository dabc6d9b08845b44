/// [[initial_state]]: parts of the domain with another state or fluid at the start.
#include <fmt/format.h>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/tables/tables.hpp"
#include "setup/place_initial_states.hpp"

namespace brisance::deck {

Table const& initial_state_table() {
  static Table const table{
      "A volume of the domain with another initial state or fluid. Its volume is exact: a cell that it covers partly "
      "receives the corresponding fraction of mass, momentum and energy. Later initial states overwrite earlier ones; "
      "charges and obstacles overwrite all.",
      joined(joined(shape_keys(), initial_velocity_keys("that of `[ambient]`")),
             {typed(Type::text, "fluid")
                  .note("that of `[ambient]`")
                  .like("\"helium\"")
                  .means("Fluid. A deck has at most two fluids: the ambient fluid and one other, which is the "
                         "explosive if there are charges"),
              density().note("that of `[ambient]`, or of the table of the other fluid").means("Density"),
              pressure().note("that of `[ambient]`").means("Pressure")}),
      {},
      {}};
  return table;
}

namespace {

/// An initial state has cells of its own.
void check_initial_states(Draft const& draft) {
  if (!draft.domain_known || draft.out.initial_states.empty()) return;
  // On the finest cells: which of them it will have is known later.
  run::Case finest = draft.out;
  finest.domain = draft.out.domain_of(draft.out.adaptive.finest);
  setup::InitialStatePlacing const placing(finest);
  for (std::size_t n = 0; n < draft.out.initial_states.size(); ++n) {
    auto const b = shape::bounds(draft.out.initial_states[n].shape);
    bool outside = false;
    for (int d = 0; d < draft.dims(); ++d) {
      outside = outside || !(b.upper[d] > draft.out.domain.lower[d] && b.lower[d] < draft.out.domain.upper(d));
    }
    if (outside || !placing.vanishes(n)) continue;  // outside: reported
    Section const& section = *draft.initial_state_sections[n];
    draft.error(section, place_key(section),
                fills(draft, draft.out.initial_states[n].shape)
                    ? "it fills nothing, because later initial states or obstacles cover it completely: remove it, or "
                      "write it after those that cover it"
                    : "it fills no part of the domain: move it, or make it larger");
  }
}

}  // namespace

void build_initial_states(Draft& draft) {
  draft.each("initial_state", [&](Section const& section) {
    run::InitialState initial;
    auto const body = build_shape(draft, section, Use::gas, std::nullopt);
    if (body) {
      initial.shape = *body;
      touches_domain(draft, section, *body, "initial state");
    }
    if (section.broken("fluid")) return;
    auto const name = section.text("fluid");
    material::Fluid own = draft.out.ambient.fluid;
    material::Primitive defaults = draft.out.ambient.state;
    if (name) {
      auto const* found = draft.materials.fluid(*name);
      auto const* charged = found == nullptr ? draft.materials.explosive(*name) : nullptr;
      if (found == nullptr && charged == nullptr) {
        unknown_material(draft, section, "fluid", *name, "fluid", draft.materials.fluid_names());
        return;
      }
      own = found != nullptr ? *found : products(*charged);
      if (!draft.ambient_known || own.name != draft.out.ambient.fluid.name) {
        material::Fluid const* other = draft.out.other_fluid(1);
        if (draft.ambient_known && draft.products_known && other != nullptr && other->name != own.name) {
          draft.error(section, "fluid",
                      fmt::format("\"{}\" would be a third fluid in addition to \"{}\" and \"{}\"; a simulation has at "
                                  "most two: use one of these",
                                  *name, draft.out.ambient.fluid.name, other->name));
          return;
        }
        if (draft.products_known) draft.out.other_fluids = {own};
        initial.fluid = 1;
        initial.fluid_name = own.name;
        defaults.density = own.density;
      }
    }
    if (!draft.ambient_known && !name) return;
    auto const s = fluid_state(draft, section, own, defaults, "density");
    if (!s || !body) return;
    initial.state = *s;
    if (!build_initial_velocity(draft, section, &*body, initial.state.velocity, initial.motion)) return;
    draft.out.initial_states.push_back(std::move(initial));
    draft.initial_state_sections.push_back(&section);
  });
  check_initial_states(draft);
}

}  // namespace brisance::deck
