/// [ambient]: the fluid that is there before anything happens.
#include <fmt/format.h>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/tables.hpp"
#include "empirical/standard_atmosphere.hpp"

namespace brisance::deck {

Table const& ambient_table() {
  static Table const table{
      "The fluid that fills the domain initially.",
      {typed(Type::text, "fluid")
           .of("air")
           .like("\"air\"")
           .means("A fluid of the library or of `[fluids.NAME]`. There are two models of water. `water` suits shocks "
                  "of 0.5 to 4 GPa close to a charge (sound speed at rest 1625 m/s; peaks of TNT 17 to 21 % above "
                  "Cole's at 1 to 3.5 m/kg^(1/3)). `water_mg` suits shocks below 1 GPa, arrival times and structures "
                  "in the water (sound speed 1480 m/s; peaks 10 to 19 % below Cole's with 53 cells per charge radius, "
                  "lower with fewer cells). See materials.md"),
       pressure().note("that of the fluid, 101325 Pa for air").means("Pressure"),
       density().note("that of the fluid, 1.225 kg/m3 for air").means("Density"),
       number("temperature", "K", 1.0, 1e4)
           .note("288.15 K for air")
           .like("\"15 degC\"")
           .means("Instead of `density`, for ideal gases: the density is scaled from that of the fluid's own table, "
                  "which is assumed to apply at 288.15 K"),
       number("altitude", "m", empirical::lowest_altitude, empirical::highest_altitude)
           .note("none")
           .like("\"3 km\"")
           .means("Instead of `pressure`, `density` and `temperature`, for ideal gases: altitude above sea level. "
                  "Pressure and temperature are those of the standard atmosphere [ISO2533]; the density follows from "
                  "them"),
       velocity().note("at rest").means("Velocity")},
      {},
      {}};
  return table;
}

namespace {

constexpr double gas_temperature = 288.15;  ///< at which a gas has the density of its table [K]

/// Pressure and density of the standard atmosphere; false after an error.
bool altitude(Draft const& draft, Section const& section, material::Fluid const& fluid, material::Primitive& state) {
  auto const height = section.number("altitude");
  if (!height) return false;
  for (auto const* key : {"pressure", "density", "temperature"}) {
    if (!section.given(key)) continue;
    draft.error(section, "altitude",
                fmt::format("{} is given together with {}: remove one of the two", section.shown("altitude"), key));
    return false;
  }
  if (!std::holds_alternative<material::IdealGas>(fluid.eos)) {
    draft.error(section, "altitude",
                fmt::format("{} cannot be used: {} is not an ideal gas; give its pressure and density instead",
                            section.shown("altitude"), fluid.name));
    return false;
  }
  auto const air = empirical::standard_atmosphere(*height);
  state.pressure = air.pressure;
  state.density = fluid.density * (air.pressure / fluid.pressure) * (gas_temperature / air.temperature);
  return true;
}

}  // namespace

std::optional<material::Primitive> fluid_state(Draft const& draft, Section const& section, material::Fluid const& of,
                                               material::Primitive defaults, std::string_view blamed) {
  if (draft.geometry_known && section.given("velocity") && section.strings("velocity") == nullptr) {
    auto const velocity = draft.point(section, "velocity");
    if (!velocity) return std::nullopt;
    defaults.velocity = *velocity;
  }
  if (section.broken("density") || section.broken("pressure")) return std::nullopt;
  defaults.density = section.number("density").value_or(defaults.density);
  defaults.pressure = section.number("pressure").value_or(defaults.pressure);
  if (!(material::bulk_modulus(of.eos, defaults.density, defaults.pressure) > 0.0)) {
    std::string_view const key = section.given(blamed) ? blamed : "pressure";
    draft.report.error(section.place_of(key), section.path_of(key),
                       fmt::format("{} at {:g} kg/m3 and {:g} Pa has no real sound speed: this state is outside its "
                                   "equation of state; its default density is {:g} kg/m3",
                                   of.name, defaults.density, defaults.pressure, of.density));
    return std::nullopt;
  }
  return defaults;
}

void build_ambient(Draft& draft) {
  if (draft.deck.broken("ambient")) return;
  Section const& section = draft.table("ambient");
  auto const name = section.text("fluid");
  if (!name) return;
  auto const* found = draft.materials.fluid(*name);
  if (found == nullptr) {
    unknown_material(draft, section, "fluid", *name, "fluid", draft.materials.fluid_names());
    return;
  }
  draft.out.ambient.fluid = *found;
  draft.out.ambient.state = {found->density, found->pressure, {0.0, 0.0, 0.0}};
  draft.ambient_known = true;
  material::Primitive defaults{found->density, found->pressure, {0.0, 0.0, 0.0}};
  if (section.given("temperature")) {
    auto const temperature = section.number("temperature");
    if (section.given("density")) {
      draft.error(
          section, "temperature",
          fmt::format("{} is given together with a density: remove one of the two", section.shown("temperature")));
    } else if (!std::holds_alternative<material::IdealGas>(found->eos)) {
      draft.error(section, "temperature",
                  fmt::format("{} cannot be used: {} is not an ideal gas; give its density instead",
                              section.shown("temperature"), found->name));
    } else if (temperature) {
      double const p = section.number("pressure").value_or(found->pressure);
      defaults.density = found->density * (p / found->pressure) * (gas_temperature / *temperature);
    }
  }
  if (section.given("altitude") && !altitude(draft, section, *found, defaults)) return;
  auto const s = fluid_state(draft, section, *found, defaults, "density");
  if (s) draft.out.ambient.state = *s;
}

}  // namespace brisance::deck
