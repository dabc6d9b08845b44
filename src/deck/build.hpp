/// From checked values to a case: what the values of a deck mean together. Shared by the build*.cpp files of this
/// folder, one for each part of a deck.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "case/case.hpp"
#include "deck/deck.hpp"
#include "deck/library.hpp"
#include "deck/reader.hpp"
#include "setup/solid_cells.hpp"

namespace brisance::deck {

inline constexpr double most_gauges = 1e5;
inline constexpr char const* directions = "xyz";

/// "[1, 2, 3]", the resolved directions.
[[nodiscard]] std::string point_text(Vec3 const& p, int dimensions);

/// Sets a choice to the word that a section gives, if it gives one.
template <class E>
void choose(Section const& section, std::string_view key, E& choice) {
  auto const word = section.text(key);
  if (auto const value = word ? value_of<E>(*word) : std::nullopt) choice = *value;
}

/// What a shape is for: it decides which shapes are possible and how much of them must be given.
enum class Use {
  gas,     ///< obstacle or region of the gas
  charge,  ///< may leave its size to its mass
  points,  ///< body or region of material points
};

class Builder {
 public:
  Builder(Section const& deck, Report& report) : deck_(deck), report_(report) {}
  run::Case build();
  /// The materials of the case that was built, and the deck's others.
  [[nodiscard]] std::vector<MaterialNumbers> materials(run::Case const& built) const;

 private:
  using Boundary = grid::Boundary;
  using Geometry = grid::Geometry;

  Section const& deck_;
  Report& report_;
  run::Case out_;
  bool geometry_known_ = false;  ///< without it, nothing about positions can be said
  bool domain_known_ = false;    ///< extents are known and sound
  bool boundaries_known_ = false;
  bool ambient_known_ = false;  ///< the fluid is known
  bool products_known_ = true;  ///< false when a charge's explosive was wrong
  bool end_known_ = false;
  bool has_gas_ = true;
  std::vector<material::Explosive> own_explosives_;
  std::vector<material::Fluid> own_fluids_;
  std::vector<material::Solid> own_solids_;
  std::set<std::string, std::less<>> wrong_materials_;  ///< names of own materials with an error of their own
  std::vector<std::pair<std::size_t, shape::Shape>> obstacle_shapes_;  ///< index of the section, shape
  std::vector<std::pair<Section const*, shape::Shape>> charge_shapes_;
  std::vector<Section const*> region_sections_;      ///< of the regions of the case, in their order
  std::vector<Section const*> constraint_sections_;  ///< of its constraints
  struct Onset {
    Section const* section;
    double time;             ///< [s]
    std::string_view key;    ///< that tells it
    std::string_view never;  ///< what does not happen where it lies after the end
  };
  std::vector<Onset> onsets_;  ///< of what may begin later than at the start

  // --- build.cpp: domain, boundaries, numerics, output

  [[nodiscard]] Geometry geometry() const { return out_.domain.geometry; }
  [[nodiscard]] int dims() const { return out_.domain.dimensions(); }
  [[nodiscard]] bool radial() const { return grid::radial_exponent(geometry()) > 0; }
  /// Lengths below this are round-off [m].
  [[nodiscard]] double tiny() const { return 1e-6 * out_.domain.h; }
  [[nodiscard]] bool has_bodies() const { return deck_.given("body"); }
  /// Does the deck speak of gas beside its bodies? Then both are calculated; bodies alone move in empty space.
  [[nodiscard]] bool speaks_of_gas() const;

  void error(Section const& section, std::string_view key, std::string const& message) {
    report_.error(section.place_of(key), section.path_of(key), message);
  }
  void warn(Section const& section, std::string_view key, std::string const& message) {
    report_.warning(section.place_of(key), section.path_of(key), message);
  }
  template <class F>
  void each(std::string_view key, F f) {
    auto const* all = deck_.sections(key);
    if (all == nullptr) return;
    for (auto const& section : *all) f(section);
  }

  /// A point or vector: one element per resolved direction; the others may be written as 0.
  std::optional<Vec3> point(Section const& section, std::string_view key);
  void domain();
  void boundaries();
  void numerics();
  void cut_over(double volume);  ///< to an ideal gas, of all products
  void end();
  void output();
  void checkpoint();
  void audit();
  void too_many(Section const& section, std::string_view key, double interval, double most, char const* things);
  void compare();

  // --- build_materials.cpp: materials by name

  template <class Material>
  static Material const* find_own(std::vector<Material> const& all, std::string_view name) {
    for (auto const& m : all) {
      if (m.name == name) return &m;
    }
    return nullptr;
  }
  /// Notes that a material has an error; throws std::logic_error where none was reported.
  void wrong_material(std::string const& name);
  void own_materials();
  void own_solids();
  material::Explosive const* explosive(std::string_view name) const;
  material::Fluid const* fluid(std::string_view name) const;
  material::Solid const* solid(std::string_view name) const;
  void unknown_material(Section const& section, std::string_view key, std::string const& name, char const* kind,
                        std::vector<std::string> const& names);
  std::vector<std::string> fluid_names() const;
  std::vector<std::string> explosive_names() const;
  std::vector<std::string> solid_names() const;
  /// The products of an explosive as a fluid; density and pressure are those of an instantaneous detonation.
  static material::Fluid products(material::Explosive const& e);

  // --- build_shapes.cpp: shapes and where they lie

  [[nodiscard]] std::vector<std::string> possible_shapes(Use use) const;
  [[nodiscard]] bool cylinder_has_length() const;
  /// One shape of a table. A charge may leave its size to `volume_asked` [m3].
  std::optional<shape::Shape> shape(Section const& section, Use use, std::optional<double> volume_asked);
  /// The shape of a body or of a region of material points: with `add`, `cut` and `common`.
  std::optional<shape::Shape> composed_shape(Section const& section);
  std::optional<shape::Shape> mesh(Section const& section, Vec3 const& position);
  /// Direction of a cylinder, a unit vector.
  std::optional<Vec3> cylinder_axis(Section const& section);
  void size_missing(Section const& section, std::string_view key, bool charge, std::string const& example);
  /// Are only those size keys given that the shape has?
  bool only_keys_of(Section const& section, std::string const& word);
  std::optional<shape::Shape> cylinder(Section const& section, Vec3 const& position,
                                       std::optional<double> volume_asked);
  std::optional<shape::Shape> box(Section const& section, Vec3 const& position, std::optional<double> volume_asked);
  /// Where the shape is placed: the key to blame.
  static std::string_view place_key(Section const& section);
  void touches_domain(Section const& section, shape::Shape const& shape, char const* what = "body");
  /// Do the bodies share points? Two balls (in 2D discs) exactly, others by points in the box that their bounds share;
  /// strictly: by more points, of which those on a surface do not count.
  [[nodiscard]] std::optional<Vec3> common_point(shape::Shape const& a, shape::Shape const& b,
                                                 bool strictly = false) const;
  /// Inside, and not on the surface, where a gauge on a body belongs.
  [[nodiscard]] bool well_inside(shape::Shape const& body, Vec3 const& p) const;

  // --- build_gas.cpp: ambient, inflow, charges, regions, obstacles and their gauges

  void inflow(Section const* section);
  /// Density, pressure and velocity of a table, with defaults.
  std::optional<run::FluidState> state(Section const& section, material::Fluid const& of, run::FluidState defaults,
                                       std::string_view blamed);
  void ambient();
  /// Pressure and density of the standard atmosphere; false after an error.
  bool altitude(Section const& section, material::Fluid const& fluid, run::FluidState& state);
  void charges();
  void charge(Section const& section, std::string& first_explosive,
              std::vector<std::pair<Section const*, shape::Shape>>& placed);
  /// "10 kg/m" belongs to planar2d and cylindrical1d, "10 kg/m2" to planar1d; a plain mass goes everywhere.
  bool mass_unit_fits(Section const& section);
  /// A charge lies in the domain; only a symmetry plane through its centre may cut it.
  bool inside_domain(Section const& section, shape::Shape const& body);
  /// Kind of detonation and points of initiation of a charge or body (`what`); false after an error.
  bool initiation(Section const& section, shape::Shape const& body, char const* what, run::Detonation& detonation,
                  std::vector<run::InitiationPoint>& points);
  void regions();
  void obstacles();
  void gauges();
  bool room_for_gauges(Section const& section, std::string_view key, double count);
  void line(Section const& section, std::string const& name);
  void plane(Section const& section, std::string const& name);
  /// Gauges from `first` on: unique names, in the domain, not in an obstacle. One error per table.
  void check_gauges(Section const& section, std::string_view key, std::size_t first, std::set<std::string>& names);
  [[nodiscard]] run::Burst automatic_burst() const;

  // --- build_placed.cpp: things that would fill, hold or do nothing

  /// Does the shape fill anything of the domain?
  [[nodiscard]] bool fills(shape::Shape const& shape) const;
  /// Parts that are cut out of a shape, or all of it, must be there.
  bool check_composition(Section const& section, std::string_view key, std::vector<Section> const& parts,
                         std::vector<shape::Shape> const& shapes, shape::Shape const& before);
  /// Has the body points in the loaded layer of a surface pressure?
  [[nodiscard]] bool has_points_in(shape::Shape const& body, shape::Shape const& layer, long points_per_cell) const;
  /// An obstacle makes cells solid, and no gas flows through it.
  void check_obstacles();
  /// An obstacle that gives way has gas on both its sides, and an edge where it needs one.
  void check_panels(setup::SolidCells const& solid);
  /// Warns of gaps beside boxes that are narrower than a cell and would be closed.
  void closed_gaps(setup::SolidCells const& solid);
  /// A charge beside obstacles finds room between solid cells.
  void fits_between_obstacles(Section const& section, shape::Shape const& body);
  /// Own materials that nothing is made of.
  /// Throws std::logic_error where something of the deck was left out and no error reported.
  void nothing_is_dropped() const;
  void unused_materials();
  /// A region has cells of its own.
  void check_regions();
  /// Is a gauge between solid cells only?
  [[nodiscard]] bool walled_in(setup::SolidCells const& solid, Vec3 const& p) const;
  [[nodiscard]] bool is_rigid(std::size_t body) const;
  /// A constraint holds nodes, bodies are there, and no other says something else.
  void check_constraints();
  /// A node of the grid within a box that all the regions hold.
  [[nodiscard]] std::optional<Vec3> held_node(std::vector<shape::Shape const*> const& regions,
                                              shape::Box const& within) const;
  /// The box whose nodes a body gives mass to; -1: all bodies that are not rigid.
  [[nodiscard]] shape::Box reach_of_bodies(int body) const;
  void check_contradictions(std::size_t number);
  /// Charges that are lit, and loads that begin, after the end.
  void check_onsets();

  // --- build_afterburn.cpp

  void afterburn();

  // --- build_start.cpp: the start by a remap

  void start();

  // --- build_bodies.cpp: material points

  void bodies();
  void body(Section const& section, std::size_t index);
  bool body_material(Section const& section, shape::Shape const* shape, run::Body& body);
  bool body_state(Section const& section, material::Fluid const& fluid, run::Body& body);
  /// A body lies in the domain, is no smaller than a cell, and only a symmetry plane through its middle may cut it.
  bool body_fits(Section const& section, shape::Shape const& shape);
  void overlaps();
  /// Index of the body of that name; reports an unknown one.
  std::optional<int> body_named(Section const& section, std::string_view key, std::string const& name);
  /// Settings of the gas beside bodies in empty space.
  void warn_of_unused_gas();
  /// Gas, or a liquid at the pressure of the air, that nothing holds together.
  void warn_of_fluids_in_empty_space();
  void refuse_inflow(Section const* boundaries);
  /// Things of material points without a body.
  void refuse_points();
  void points_options();
  void constraints();
  void constraint(Section const& section);
  void contacts();
  void surface_pressures();
  void surface_pressure(Section const& section);
  bool pressure_history(Section const& section, mpm::SurfacePressure& pressure);
  /// The layer below the loaded face in whole layers of points; false when the body has none there (reported).
  bool loaded_layer(Section const& section, mpm::SurfacePressure& pressure);
  bool curved_layer(Section const& section, double asked, double layer, mpm::SurfacePressure& pressure);
  [[nodiscard]] bool is_flat_face(shape::Shape const& body, int direction, double face) const;
  void reinforcements();  // build_reinforcement.cpp
  void reinforcement(Section const& section);
  void body_gauge(Section const& section, std::string const& name, std::set<std::string>& names);
  /// Inside, or on the surface.
  [[nodiscard]] bool near_body(shape::Shape const& body, Vec3 const& p) const;
  /// Do bodies, loads or constraints set something in motion?
  [[nodiscard]] bool points_move();

  // --- build_region.cpp: the MPM region, where gas and material points meet

  void mpm_region();
  void warn_if_only_gauges();
  /// The products of explosives in the region are the second fluid of the gas.
  void products_of_bodies();
  /// Fluids that slip share one field of the grid and have no contact of their own.
  void contacts_of_fluids(run::MpmRegion const& region);
  void mpm_region_options(Section const& section, run::MpmRegion& region);
  /// The boxes of the table; false after an error.
  bool mpm_region_boxes(Section const& section, run::MpmRegion& region);
  /// Bodies, charges and obstacles that do not go with the region.
  void check_mpm_region(bridge::Region const& region);
  void check_body_place(bridge::Region const& region, std::size_t index);
  /// Where the shape meets cells that are wrong for it, in a box where that is enough; nothing: nowhere.
  template <class Wrong>
  [[nodiscard]] std::optional<Vec3> wrong_place(shape::Shape const& shape, bool by_centres, Wrong&& wrong,
                                                std::optional<shape::Box> const& within = {}) const;

  std::vector<std::string> body_names_;                   ///< of all bodies, also of those with errors
  std::vector<std::optional<shape::Shape>> body_shapes_;  ///< in the same order; nothing after an error
};

}  // namespace brisance::deck
