/// The tables of a deck. Each NAME.cpp of this folder holds all of one table: its keys, and how a case is made of them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "deck/draft.hpp"
#include "deck/schema.hpp"

namespace brisance::bridge {
class Region;
}

namespace brisance::deck {

/// The case of a deck, through the builders of all its tables.
[[nodiscard]] Draft build_case(Section const& deck, Report& report);

// --- domain, levels, boundaries, inflow

/// Names of the domain's faces: x_low, x_high, ...
[[nodiscard]] std::vector<std::string> const& faces();
[[nodiscard]] Table const& domain_table();
void build_domain(Draft& draft);
[[nodiscard]] Table const& adaptive_table();
/// Cells of several sizes, by [adaptive], [[refine]] and mpm_region.cell. Where they are not known the domain is not
/// either.
void build_adaptive(Draft& draft);
/// The level whose cells have the size that a key gives; nothing where there is none or where it is finer than the
/// finest, which is reported.
[[nodiscard]] std::optional<int> level_up_to_finest(Draft const& draft, Section const& section, std::string_view key);
[[nodiscard]] Table const& refine_table();
void build_refinements(Draft& draft);
[[nodiscard]] Table const& boundaries_table();
void build_boundaries(Draft& draft);
[[nodiscard]] Table const& inflow_table();
void build_inflow(Draft& draft, Section const* boundaries);

// --- gas

[[nodiscard]] Table const& ambient_table();
void build_ambient(Draft& draft);
/// Density, pressure and velocity of a table, with defaults.
[[nodiscard]] std::optional<material::Primitive> fluid_state(Draft const& draft, Section const& section,
                                                             material::Fluid const& of, material::Primitive defaults,
                                                             std::string_view blamed);
/// Keys of the velocity at the start; without them it is `otherwise`.
[[nodiscard]] std::vector<Key> initial_velocity_keys(std::string const& otherwise);
/// The velocity at the start within a shape, if that is known; false after an error.
bool build_initial_velocity(Draft const& draft, Section const& section, shape::Shape const* shape, Vec3& velocity,
                            run::InitialMotion& motion);
[[nodiscard]] Table const& charge_table();
void build_charges(Draft& draft);
[[nodiscard]] Table const& initiation_table();
/// Kind of detonation and points of initiation of a charge or body (`what`); false after an error.
bool build_initiation(Draft& draft, Section const& section, shape::Shape const& body, char const* what,
                      run::Detonation& detonation, std::vector<run::InitiationPoint>& particles);
[[nodiscard]] Table const& afterburn_table();
void build_afterburn(Draft& draft);
[[nodiscard]] Table const& remap_table();
void build_start(Draft& draft);
[[nodiscard]] Table const& obstacle_table();
void build_obstacles(Draft& draft);
[[nodiscard]] Table const& initial_state_table();
void build_initial_states(Draft& draft);
[[nodiscard]] Table const& numerics_table();
void build_numerics(Draft& draft);
/// Once all materials are there.
void build_ideal_products(Draft& draft);

// --- material points

[[nodiscard]] Table const& body_table();
void build_bodies(Draft& draft);
/// Index of the body of that name; reports an unknown one.
[[nodiscard]] std::optional<int> body_named(Draft const& draft, Section const& section, std::string_view key,
                                            std::string const& name);
[[nodiscard]] bool is_rigid(Draft const& draft, std::size_t body);
/// Bodies that start under their weight: it has a direction, and they bear it.
void check_initial_stress(Draft const& draft);
/// Gas, or a liquid at the pressure of the air, that nothing holds together.
void warn_of_fluids_in_empty_space(Draft const& draft);
/// Do bodies, loads or constraints set something in motion?
[[nodiscard]] bool particles_move(Draft const& draft);
[[nodiscard]] Table const& particles_table();
void build_particles(Draft& draft);
[[nodiscard]] Table const& mpm_region_table();
/// Which of the regions holds each body.
void assign_bodies(Draft& draft);
void build_mpm_regions(Draft& draft);
/// Bodies, charges and obstacles that do not go with a region.
void check_mpm_region(Draft const& draft, bridge::Region const& region, std::size_t number);
/// Regions whose settings or places do not go together; `regions`: all of the case.
void check_together(Draft const& draft, std::vector<bridge::Region> const& regions);
[[nodiscard]] Table const& constraint_table();
void build_constraints(Draft& draft);
[[nodiscard]] Table const& contact_table();
void build_contacts(Draft& draft);
[[nodiscard]] Table const& surface_pressure_table();
void build_surface_pressures(Draft& draft);
[[nodiscard]] Table const& reinforcement_table();
void build_reinforcements(Draft& draft);

// --- shapes

[[nodiscard]] std::vector<Key> shape_keys();
/// Those of a body or of a place among material points, with what is added to them, cut out of them and kept of them.
[[nodiscard]] std::vector<Key> composed_shape_keys();
/// A part of space, by a composed shape.
[[nodiscard]] Table const& within_table();

/// What a shape is for: it decides which shapes are possible and how much of them must be given.
enum class Use {
  gas,        ///< obstacle or initial state of the gas
  charge,     ///< may leave its size to its mass
  particles,  ///< body or place among material points
};

/// One shape of a table, where its own motion and then that of the whole shape that it is a part of take it. A charge
/// may leave its size to `volume_asked` [m3].
[[nodiscard]] std::optional<shape::Shape> build_shape(Draft const& draft, Section const& section, Use use,
                                                      std::optional<double> volume_asked,
                                                      shape::Motion const& whole = {});
/// The shape of a body or of a place among material points: with `add`, `cut`, `common` and `whole`.
[[nodiscard]] std::optional<shape::Shape> build_composed_shape(Draft const& draft, Section const& section);

// --- run and output

[[nodiscard]] Table const& gauge_table();
void build_gauges(Draft& draft);
[[nodiscard]] Table const& end_table();
void build_end(Draft& draft);
[[nodiscard]] Table const& output_table();
void build_output(Draft& draft);
/// Reports an interval [s] that gives more than `most` of some things until the end.
void limit_times(Draft const& draft, Section const& section, std::string_view key, double interval, double most,
                 char const* things);
/// Each word once, in the order of the list.
void without_repeats(std::vector<std::string>& all);
[[nodiscard]] Table const& subset_table();
/// The subsets in the table [output].
void build_subsets(Draft& draft, Section const& output);
[[nodiscard]] Table const& checkpoint_table();
void build_checkpoint(Draft& draft);
[[nodiscard]] Table const& audit_table();
void build_audit(Draft& draft);
[[nodiscard]] Table const& compare_table();
void build_compare(Draft& draft);

// --- materials: of a deck, and of the library's files

[[nodiscard]] Table const& explosives_table();
void build_explosives(Draft& draft);
[[nodiscard]] Table const& fluids_table();
void build_fluids(Draft& draft);
[[nodiscard]] Table const& solids_table();
void build_solids(Draft& draft);

/// Material from a table that the schema has checked; nothing when one of its values was wrong.
[[nodiscard]] std::optional<material::Explosive> build_explosive(Section const& section, std::string const& name);
[[nodiscard]] std::optional<material::Fluid> build_fluid(Section const& section, std::string const& name);
/// The same; what its values mean together is checked here, and reported.
[[nodiscard]] std::optional<material::Material> build_solid(Section const& section, std::string const& name,
                                                            Report& report);

}  // namespace brisance::deck
