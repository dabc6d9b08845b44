/// Tables of the domain and of the gas: ambient, charges, gauges, obstacles, regions, numerics.
#include <fmt/format.h>

#include "case/case.hpp"
#include "deck/schema_keys.hpp"
#include "empirical/standard_atmosphere.hpp"

namespace brisance::deck {

Table const& domain_table() {
  static Table const table{
      "The grid: a box of cubic cells.",
      {word<grid::Geometry>("geometry")
           .of("cartesian3d")
           .like("\"cartesian3d\"")
           .means("Resolved directions and symmetry. In axisymmetric2d x is the radius and y the axis; in "
                  "cylindrical1d and "
                  "spherical1d x is the radius"),
       number("cell", "m", smallest, 1e4).required().like("\"50 mm\"").means("Edge h of the cubic cells"),
       position("lower").note("the origin").like("[0, 0, 0]").means("Low corner"),
       position("upper").note("from `size`").like("[4, 4, 3]").means("High corner; `upper` or `size` is needed"),
       typed(Type::point, "size", "m", smallest, 2.0 * far)
           .note("from `upper`")
           .like("[4, 4, 3]")
           .means("Extent, a whole number of cells in each direction; `upper` or `size` is needed")},
      {},
      {}};
  return table;
}

std::vector<std::string> const& faces() {
  static std::vector<std::string> const names{"x_low", "x_high", "y_low", "y_high", "z_low", "z_high"};
  return names;
}

Table const& boundaries_table() {
  static Table const table = [] {
    Table t{
        "What happens at the faces of the domain: `outflow` lets waves out, as if the gas that is there at the start "
        "went on beyond the face; `wall` is rigid (the ground); `symmetry` is a mirror plane; `inflow` holds the state "
        "given in `[inflow.FACE]`; `periodic` joins opposite faces; `zero_gradient` repeats the cells next to the "
        "face, "
        "which sends back a part of every wave whose strength varies, for comparison.",
        {},
        {},
        {}};
    t.keys.push_back(
        word<grid::Boundary>("all").of("outflow").like("\"outflow\"").means("All faces that are not named"));
    for (auto const& face : faces()) {
      t.keys.push_back(
          word(face, all_words<grid::Boundary>())
              .note(face == "x_low" ? "as `all`; `symmetry` where x is a radius and x_low lies at 0" : "as `all`")
              .like("\"symmetry\"")
              .means(fmt::format("Face at the {} end of {}", face.substr(2), face.substr(0, 1))));
    }
    return t;
  }();
  return table;
}

Table const& inflow_table() {
  static Table const table{
      "State of the ambient fluid that enters through a face whose boundary is `inflow`.",
      {density().note("that of the ambient").means("Density"), pressure().note("that of the ambient").means("Pressure"),
       velocity().required().means("Velocity")},
      {},
      {}};
  return table;
}

Table const& ambient_table() {
  static Table const table{
      "The fluid that fills the domain before anything happens.",
      {typed(Type::text, "fluid")
           .of("air")
           .like("\"air\"")
           .means("A fluid of the library or of `[fluids.NAME]`. Of the two waters `water` is for shocks of 0.5 to 4 "
                  "GPa, beside a charge (sound at rest 1625 m/s, peaks of TNT 17 to 21 % above Cole's at 1 to 3.5 "
                  "m/kg^(1/3)), `water_mg` for shocks below 1 GPa, arrivals and what stands in the water (1480 m/s, 10 "
                  "to 19 % below with 53 cells per charge radius, more with fewer); see materials.md"),
       pressure().note("that of the fluid, 101325 Pa for air").means("Pressure"),
       density().note("that of the fluid, 1.225 kg/m3 for air").means("Density"),
       number("temperature", "K", 1.0, 1e4)
           .note("288.15 K for air")
           .like("\"15 degC\"")
           .means("Instead of `density`, for ideal gases: the density follows from that of the fluid's own table, "
                  "which is "
                  "taken to hold at 288.15 K"),
       number("altitude", "m", empirical::lowest_altitude, empirical::highest_altitude)
           .note("none")
           .like("\"3 km\"")
           .means("Instead of `pressure`, `density` and `temperature`, for ideal gases: height above the sea, at which "
                  "the "
                  "standard atmosphere [ISO2533] has its pressure and its temperature; the density follows from them"),
       velocity().note("at rest").means("Velocity")},
      {},
      {}};
  return table;
}

Table const& initiation_table() {
  static Table const table{"A point of initiation.",
                           {position("position").note("the charge's `position`").like("[0, 0, 1.5]").means("Where"),
                            number("delay", "s", 0.0, longest).of(0.0).like("\"2 us\"").means("When, after the start")},
                           {},
                           {}};
  return table;
}

Table const& charge_table() {
  static Table const table = [] {
    Table t{
        "An explosive charge. Give its `mass` or its size, or both where they agree within 0.1 %. The mass is that of "
        "the "
        "whole body, also where symmetry planes pass through its centre; in planar2d and cylindrical1d it is per "
        "metre, in "
        "planar1d per square metre.",
        {typed(Type::text, "explosive")
             .of("TNT")
             .like("\"TNT\"")
             .means("An explosive of the library or of `[explosives.NAME]`; all charges of a deck have the same"),
         number("mass", "kg", 1e-12, 1e12)
             .or_unit("kg/m")
             .or_unit("kg/m2")
             .note("from the size")
             .like("\"10 kg\"")
             .means("Mass of the whole body")},
        {},
        {}};
    t.keys = joined(t.keys, shape_keys({"sphere", "hemisphere", "cylinder", "box"}));
    t.keys = joined(t.keys, {number("length_to_diameter", "1", 1e-3, 1e3)
                                 .note("from `length`")
                                 .like("1.0")
                                 .means("Of a cylinder that is given by its mass; instead of `length` or `radius`"),
                             word<run::Detonation>("detonation")
                                 .of("programmed")
                                 .like("\"programmed\"")
                                 .means("`programmed`: a detonation front runs from the points of initiation at the "
                                        "listed speed; `instantaneous`: "
                                        "the products stand at the charge's density and energy at the start"),
                             nested(Type::tables, "initiation", initiation_table())
                                 .note("one point at `position`, at time 0")
                                 .like("[{position = [0, 0, 1.5], delay = \"2 us\"}]")
                                 .means("Points of initiation of a programmed detonation")});
    return t;
  }();
  return table;
}

Table const& remap_table() {
  static Table const table{
      "Settings of `start = \"remap\"`: each charge bursts in a calculation with one direction (spherical; in planar2d "
      "cylindrical) until its shock is about to meet a boundary, an obstacle, the MPM region, another burst or a "
      "gauge. "
      "Its profile then goes onto the grid, with the mass of both fluids, the energy and the momentum that it has, and "
      "the "
      "calculation goes on from that time.",
      {word<run::StartMethod>("method").of("gas").like("\"gas\"").means(
           "`gas`: the gas scheme; `points`: material points, as in [Cui14]"),
       number("cell", "m", smallest, 1e4)
           .note("a 400th of the charge's radius")
           .like("\"0.5 mm\"")
           .means("Cell of the 1D calculation"),
       number("time", "s", 1e-12, longest)
           .note("when the shock is about to meet something")
           .like("\"0.2 ms\"")
           .means("Time of the remap; gauges then do not stop it"),
       number("radius", "m", smallest, far)
           .note("where the shock is about to meet something")
           .like("\"0.8 m\"")
           .means("Radius of the shock at the remap, instead of the time; gauges then do not stop it"),
       typed(Type::text, "profile")
           .note("calculated")
           .like("\"../burst-results/profiles/start_1.h5\"")
           .means(
               "Profile of an earlier run, relative to the deck, that stands in for the calculation: of 1D, or of "
               "axisymmetric2d for 3D. It is scaled to the mass of the charge; its explosive and its ambient gas must "
               "be those of the deck")},
      {},
      {}};
  return table;
}

namespace {

Table const& line_table() {
  static Table const table{"Gauges at equal distances on a line.",
                           {position("from").required().like("[1, 0, 0]").means("First gauge"),
                            position("to").required().like("[5, 0, 0]").means("Last gauge"),
                            typed(Type::integer, "count", "1", 2, 1e5).required().like("5").means("Number of gauges")},
                           {},
                           {}};
  return table;
}

Table const& plane_table() {
  static Table const table{
      "Gauges on a parallelogram, from `origin` to `origin + edge1 + edge2`.",
      {position("origin").required().like("[0, 0, 0]").means("Corner with the first gauge"),
       position("edge1").required().like("[4, 0, 0]").means("First edge, as a vector"),
       position("edge2").required().like("[0, 4, 0]").means("Second edge, as a vector"),
       typed(Type::integers, "counts", "1", 2, 1e5).required().like("[5, 5]").means("Gauges along the two edges")},
      {},
      {}};
  return table;
}

}  // namespace

Table const& gauge_table() {
  static Table const table{
      "Gauges record in time. In the gas: pressure, density and velocity at a `point`, on a `line` or on a `plane`. "
      "Of material points: `body` alone watches a body as a whole, `body` and `point` ride on the body's point that is "
      "nearest at the start. At most 100000 in all.",
      {typed(Type::name, "name")
           .note("`g1`, `g2`, ...; lines and planes append `-1`, `-2`, ...")
           .like("\"roof\"")
           .means("Name"),
       typed(Type::text, "body").like("\"plate\"").means("Name of a body that is watched"),
       position("point").like("[2, 0, 1]").means("One gauge"),
       nested(Type::table, "line", line_table())
           .like("{from = [1, 0, 0], to = [5, 0, 0], count = 5}")
           .means("Gauges on a line"),
       nested(Type::table, "plane", plane_table())
           .like("{origin = [0, 0, 0], edge1 = [4, 0, 0], edge2 = [0, 4, 0], counts = [5, 5]}")
           .means("Gauges on a plane")},
      {},
      {}};
  return table;
}

Table const& obstacle_table() {
  static Table const table{
      "A rigid body inside the gas. A cell is solid from half its volume on. An obstacle that makes no "
      "cell solid, and a wall so thin that gas would pass between its cells, is refused. With `fails_at` it is a panel "
      "that gives way: a vent, a door, a window. An obstacle takes the place of those before it: a panel that is "
      "written after a wall leaves a hole in the wall.",
      joined(joined({typed(Type::name, "name").note("`obstacle-1`, ...").like("\"wall\"").means("Name")},
                    shape_keys({"sphere", "hemisphere", "cylinder", "box"})),
             {number("fails_at", "Pa", 1e-3, 1e13)
                  .note("never")
                  .like("\"10 kPa\"")
                  .means("The obstacle gives way, as a whole, when the difference between the mean pressures on its "
                         "two sides reaches this, in either sense. Its sides face along the direction in which there "
                         "is gas on both and it is thinnest"),
              number("areal_mass", "kg/m2", 1e-6, 1e6)
                  .note("none: all of it opens at once")
                  .like("\"10 kg/m2\"")
                  .means("Mass of the panel per area. From `fails_at` on it moves as a whole, mass times acceleration "
                         "equal to the difference of the pressures, and gas passes through its perimeter times the "
                         "way that it has gone, until that is its area")}),
      {},
      {}};
  return table;
}

Table const& region_table() {
  static Table const table{
      "A part of the domain with another state or fluid at the start. It fills its own volume: a cell that it cuts "
      "gets "
      "that part of its mass, momentum and energy. Later regions overwrite earlier ones, charges and obstacles all.",
      joined(shape_keys({"sphere", "hemisphere", "cylinder", "box"}),
             {typed(Type::text, "fluid")
                  .note("that of the ambient")
                  .like("\"helium\"")
                  .means("Fluid. A deck has at most two: that of the ambient and one other, which is the explosive "
                         "where there are "
                         "charges"),
              density().note("that of the ambient, or of the other fluid's table").means("Density"),
              pressure().note("that of the ambient").means("Pressure"),
              velocity().note("that of the ambient").means("Velocity")}),
      {},
      {}};
  return table;
}

Table const& numerics_table() {
  static run::Numerics const n;
  static Table const table{
      "The numerical method.",
      {word<gas::Scheme>("scheme")
           .of("muscl-hancock")
           .like("\"muscl-hancock\"")
           .means("`muscl-hancock`: second-order Godunov scheme with the HLLC solver; `lax-wendroff`: the scheme of "
                  "[Cui14] with "
                  "adaptive viscosity"),
       number("courant", "1", 0.01, 1.0).of(n.courant).like("0.8").means("Courant number"),
       typed(Type::integer, "block_cells", "1", 0, 4096)
           .of(0L)
           .like("16")
           .means("Cells per block and direction; 0: chosen by the program"),
       typed(Type::boolean, "sleep")
           .of(n.sleep)
           .like("true")
           .means("Skip blocks in which nothing happens; the result is the same"),
       number("limiter_beta", "1", 1.0, 2.0)
           .of(n.limiter_beta)
           .like("1.5")
           .means("Generalised monotonised-central limiter: 1 is minmod, 2 the steepest"),
       typed(Type::boolean, "carbuncle_cure").of(n.carbuncle_cure).like("true").means("Blend to HLL along shocks"),
       number("density_floor", "kg/m3", 1e-12, 1.0).of(n.density_floor).like("1e-6").means("Guard: smallest density"),
       number("pressure_floor", "Pa", 1e-9, 1e4).of(n.pressure_floor).like("1e-3").means("Guard: smallest pressure"),
       number("viscosity", "1", 0.0, 1.0)
           .of(n.viscosity)
           .like("0.5")
           .means("lax-wendroff: constant eta of the artificial viscosity; 0: eta of [Cui14] Eq. (5)"),
       number("ideal_products", "1", 4.0, 1e6)
           .note("where double precision no longer tells the difference")
           .like("10")
           .means(
               "Relative volume V from which detonation products are an ideal gas with gamma = 1 + omega; the "
               "exponentials of the JWL fade out from half of it on. Saves little; docs/validation/remap.md shows the "
               "error")},
      {},
      {}};
  return table;
}

}  // namespace brisance::deck
