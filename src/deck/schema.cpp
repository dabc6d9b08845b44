#include "deck/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/parameter.hpp"
#include "core/units.hpp"
#include "material/solid.hpp"
#include "run/point_fields.hpp"
#include "run/world.hpp"

namespace brisance::deck {

namespace {

constexpr double far = 1e6;        ///< largest coordinate [m]
constexpr double longest = 1e4;    ///< longest time [s]
constexpr double smallest = 1e-6;  ///< smallest length [m]

Key number(std::string name, std::string unit, double minimum, double maximum) {
  Key key;
  key.name = std::move(name);
  key.unit = std::move(unit);
  key.minimum = minimum;
  key.maximum = maximum;
  return key;
}
Key typed(Type type, std::string name) {
  Key key;
  key.name = std::move(name);
  key.type = type;
  key.minimum = -unbounded;
  key.maximum = unbounded;
  return key;
}
Key typed(Type type, std::string name, std::string unit, double minimum, double maximum) {
  Key key = number(std::move(name), std::move(unit), minimum, maximum);
  key.type = type;
  return key;
}
Key word(std::string name, std::vector<std::string> choices) {
  Key key = typed(Type::word, std::move(name));
  key.choices = std::move(choices);
  return key;
}
Key nested(Type type, std::string name, Table const& table) {
  Key key = typed(type, std::move(name));
  key.table = &table;
  return key;
}
Key position(std::string name) { return typed(Type::point, std::move(name), "m", -far, far); }
Key density() { return number("density", "kg/m3", 1e-4, 1e5).like("1.225"); }
Key pressure() { return number("pressure", "Pa", 1e-3, 1e13).like("\"101.325 kPa\""); }
Key velocity() { return typed(Type::point, "velocity", "m/s", -1e5, 1e5).like("[340, 0, 0]"); }

Key axis(std::string name) {
  Key key = typed(Type::axis, std::move(name));
  key.choices = {"x", "y", "z"};
  return key;
}
Key face_normal(std::string name) { return word(std::move(name), {"+x", "-x", "+y", "-y", "+z", "-z"}); }

/// The parameter table of a model as keys of the schema.
template <class Model>
std::vector<Key> parameter_keys() {
  std::vector<Key> keys;
  for (auto const& p : Model::parameters()) {
    Key key = number(std::string(p.key), std::string(p.unit), p.minimum, p.maximum);
    key.means(std::string(p.meaning));
    Model const model{};
    key.like(fmt::format("{}", model.*p.member));
    if (std::isnan(p.default_value)) {
      key.required();
    } else {
      key.of(p.default_value);
    }
    keys.push_back(std::move(key));
  }
  return keys;
}

/// Those of a model of a solid: what the solid's own keys tell may be left out.
template <class Model>
std::vector<Key> solid_parameter_keys() {
  auto keys = parameter_keys<Model>();
  for (auto& key : keys) {
    if (key.name == "rho0") {
      key.needed = false;
      key.note("the solid's `density`");
    }
    if (key.name == "K" || key.name == "G") {
      key.needed = false;
      key.note("from the solid's `E` and `nu`");
    }
  }
  return keys;
}

std::vector<Key> shape_keys(std::vector<std::string> shapes) {
  return {
      word("shape", std::move(shapes))
          .note("`sphere`; in planar2d and cylindrical1d `cylinder`, in planar1d `box`")
          .like("\"sphere\"")
          .means("Shape. In planar2d a cylinder is a disc and a box a rectangle; in axisymmetric2d a cylinder stands "
                 "around the "
                 "axis, a box turned around the axis is a ring; cylindrical1d and spherical1d know the concentric "
                 "cylinder "
                 "and sphere, and boxes as tubes and shells"),
      position("position")
          .note("the origin")
          .like("[0, 0, \"1.5 m\"]")
          .means("Centre of a sphere, cylinder or box; of a hemisphere the centre of its flat face"),
      number("radius", "m", smallest, far).like("\"50 mm\"").means("Radius of a sphere, hemisphere or cylinder"),
      number("length", "m", smallest, far).like("\"0.2 m\"").means("Length of a cylinder along its axis"),
      axis("axis")
          .note("`z`; in axisymmetric2d `y`")
          .like("\"z\"")
          .means("Direction of a cylinder's axis (in 3D; else it is fixed by the geometry): a letter or, except for a "
                 "charge, a vector of any length such as [1, 0, 1]"),
      face_normal("normal")
          .note("`+z`; in axisymmetric2d `+y`")
          .like("\"+z\"")
          .means("Side of its flat face on which a hemisphere lies: `+z` stands on the ground"),
      typed(Type::point, "size", "m", smallest, far)
          .like("[1, 1, \"20 cm\"]")
          .means("Edges of a box around `position`; instead of `lower` and `upper`"),
      position("lower").like("[2, -1, 0]").means("Low corner of a box"),
      position("upper").like("[3, 1, \"2.5 m\"]").means("High corner of a box"),
  };
}

std::vector<Key> joined(std::vector<Key> first, std::vector<Key> const& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// Shapes of bodies: those of everything else and meshes.
std::vector<Key> mesh_shape_keys(std::vector<std::string> shapes) {
  return joined(
      shape_keys(std::move(shapes)),
      {typed(Type::text, "file")
           .like("\"bracket.stl\"")
           .means("STL file of shape `stl` (3D only), relative to the deck: a closed surface; `position` moves it"),
       number("scale", "1", 1e-9, 1e9)
           .note("1")
           .like("0.001")
           .means("Factor on the coordinates of the STL file, 0.001 for a file in mm")});
}

Table const& part_table() {
  static Table const table{"A shape that is put together with others.",
                           mesh_shape_keys({"sphere", "hemisphere", "cylinder", "box", "stl"}),
                           {},
                           {}};
  return table;
}

/// Those of a body or of a region of material points, with what is added to them, cut out of them and kept of them.
std::vector<Key> composed_shape_keys() {
  return joined(mesh_shape_keys({"sphere", "hemisphere", "cylinder", "box", "stl"}),
                {nested(Type::tables, "add", part_table())
                     .note("none")
                     .like("[{shape = \"sphere\", radius = \"5 mm\"}]")
                     .means("Shapes that are joined to it"),
                 nested(Type::tables, "cut", part_table())
                     .note("none")
                     .like("[{shape = \"cylinder\", radius = \"5 mm\", length = \"1 m\"}]")
                     .means("Shapes that are then cut out: holes"),
                 nested(Type::tables, "common", part_table())
                     .note("none")
                     .like("[{lower = [0, 0, 0], upper = [1, 1, 1], shape = \"box\"}]")
                     .means("Shapes outside of which nothing is kept, last of all")});
}

Table const& domain_table() {
  static Table const table{
      "The grid: a box of cubic cells.",
      {word("geometry", {"cartesian3d", "planar2d", "axisymmetric2d", "planar1d", "cylindrical1d", "spherical1d"})
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

std::vector<std::string> const faces{"x_low", "x_high", "y_low", "y_high", "z_low", "z_high"};

Table const& boundaries_table() {
  static Table const table = [] {
    std::vector<std::string> const kinds{"outflow", "wall", "symmetry", "inflow", "periodic"};
    Table t{
        "What happens at the faces of the domain: `outflow` lets waves out, `wall` is rigid (the ground), `symmetry` "
        "is a "
        "mirror plane, `inflow` holds the state given in `[inflow.FACE]`, `periodic` joins opposite faces.",
        {},
        {},
        {}};
    t.keys.push_back(word("all", kinds).of("outflow").like("\"outflow\"").means("All faces that are not named"));
    for (auto const& face : faces) {
      t.keys.push_back(
          word(face, kinds)
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
      {typed(Type::text, "fluid").of("air").like("\"air\"").means("A fluid of the library or of `[fluids.NAME]`"),
       pressure().note("that of the fluid, 101325 Pa for air").means("Pressure"),
       density().note("that of the fluid, 1.225 kg/m3 for air").means("Density"),
       number("temperature", "K", 1.0, 1e4)
           .note("288.15 K for air")
           .like("\"15 degC\"")
           .means("Instead of `density`, for ideal gases: the density follows from that of the fluid's own table, "
                  "which is "
                  "taken to hold at 288.15 K"),
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
                             word("detonation", {"programmed", "instantaneous"})
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
  static Table const table{"A rigid body inside the gas.",
                           joined({typed(Type::name, "name").note("`obstacle-1`, ...").like("\"wall\"").means("Name")},
                                  shape_keys({"sphere", "hemisphere", "cylinder", "box"})),
                           {},
                           {}};
  return table;
}

Table const& region_table() {
  static Table const table{
      "A part of the domain with another state or fluid at the start; later regions overwrite earlier ones.",
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
      {word("scheme", {"muscl-hancock", "lax-wendroff"})
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
           .means("lax-wendroff: constant eta of the artificial viscosity; 0: eta of [Cui14] Eq. (5)")},
      {},
      {}};
  return table;
}

Table const& points_region_table() {
  static Table const table{"A part of space.", composed_shape_keys(), {}, {}};
  return table;
}

Table const& body_table() {
  static Table const table = [] {
    Table t{
        "A body of material points. A deck with bodies is calculated by the material point method alone: it has no "
        "gas, and charges, regions and obstacles cannot stand beside bodies yet. Bodies move in empty space; the "
        "domain's faces `wall` and `symmetry` hold them like mirror planes, `outflow` lets them leave, `periodic` "
        "joins opposite faces.",
        {typed(Type::name, "name").note("`body-1`, ...").like("\"plate\"").means("Name"),
         typed(Type::text, "material")
             .required()
             .like("\"OFHC-copper\"")
             .means(
                 "Name of a solid, explosive or fluid of the library (searched in this order) or of `[solids.NAME]`, "
                 "`[explosives.NAME]`, `[fluids.NAME]`")},
        {},
        {}};
    t.keys = joined(t.keys, composed_shape_keys());
    t.keys = joined(
        t.keys, {typed(Type::integer, "points_per_cell", "1", 1, 8)
                     .of(2L)
                     .like("2")
                     .means("Material points per cell and direction at the start: 2 makes 8 per cell in 3D"),
                 velocity().note("at rest").means("Velocity at the start"),
                 typed(Type::boolean, "rigid").of(false).like("true").means("It keeps its velocity, whatever it meets"),
                 density().note("that of the fluid").means("Density at the start, of fluids only"),
                 pressure().note("that of the fluid").means("Pressure at the start, of fluids only"),
                 word("detonation", {"programmed", "instantaneous"})
                     .of("programmed")
                     .like("\"programmed\"")
                     .means("Of explosives, as for charges"),
                 nested(Type::tables, "initiation", initiation_table())
                     .note("one point at the middle of the body, at time 0")
                     .like("[{position = [0, 0, 1.5], delay = \"2 us\"}]")
                     .means("Points of initiation of a programmed detonation")});
    return t;
  }();
  return table;
}

Table const& points_table() {
  static mpm::Options const o;
  static Table const table{
      "The material point method.",
      {word("shape_function", {"linear", "gimp", "cpgimp", "bspline"})
           .of("bspline")
           .like("\"gimp\"")
           .means("`linear`: tents; `gimp`: points of constant size (uGIMP); `cpgimp`: points that stretch with the "
                  "material; `bspline`: quadratic"),
       word("stress_order", {"usf", "usl", "musl"})
           .of("musl")
           .like("\"usf\"")
           .means("When the stress is updated: before the momentum (`usf`), after it (`usl`), or after it with the "
                  "velocity of the points mapped back to the nodes (`musl`)"),
       word("transfer", {"flip", "apic", "xpic"})
           .of("flip")
           .like("\"apic\"")
           .means("How the velocity of the points follows that of the nodes"),
       number("pic_fraction", "1", 0.0, 1.0).of(o.pic_fraction).like("0.01").means("flip: fraction of PIC"),
       typed(Type::integer, "xpic_order", "1", 1, 10)
           .of(static_cast<long>(o.xpic_order))
           .like("2")
           .means("xpic: its order; 1 is PIC"),
       typed(Type::boolean, "locking_control")
           .of(o.locking_control)
           .like("true")
           .means("Average the volumetric strain over the points of a body in a cell"),
       number("linear_viscosity", "1", 0.0, 10.0)
           .of(o.linear_viscosity)
           .like("0.06")
           .means("Linear coefficient of the bulk viscosity"),
       number("quadratic_viscosity", "1", 0.0, 100.0)
           .of(o.quadratic_viscosity)
           .like("1.5")
           .means("Quadratic coefficient of the bulk viscosity"),
       number("courant", "1", 0.01, 1.0).of(o.courant).like("0.4").means("Courant number"),
       typed(Type::point, "body_force", "m/s2", -1e9, 1e9)
           .note("none")
           .like("[0, 0, -9.81]")
           .means("Acceleration of everything, gravity for example"),
       typed(Type::integer, "block_cells", "1", 0, 4096)
           .of(static_cast<long>(o.block_cells))
           .like("8")
           .means("Cells per block and direction; 0: 8 in 3D, 32 in 2D, 256 in 1D")},
      {},
      {}};
  return table;
}

Table const& constraint_table() {
  static Table const table = [] {
    Key held = typed(Type::words, "held")
                   .note("all resolved directions")
                   .like("[\"x\", \"y\"]")
                   .means("fixed, velocity: components of the velocity that are prescribed");
    held.choices = {"x", "y", "z"};
    return Table{
        "The velocity of material points in a part of space is prescribed, by way of the grid nodes there.",
        {word("kind", {"fixed", "roller", "velocity"})
             .of("fixed")
             .like("\"roller\"")
             .means("`fixed`: at rest; `roller`: no motion along `normal`; `velocity`: moves with `velocity`"),
         nested(Type::table, "region", points_region_table())
             .note("everywhere, for the `body`")
             .like("{shape = \"box\", lower = [0, 0, 0], upper = [0.1, 1, 1]}")
             .means("Where; `region` or `body` is needed"),
         word("normal", {"x", "y", "z"})
             .note("needed by a roller")
             .like("\"z\"")
             .means("roller: the direction in which nothing moves"),
         velocity().note("needed by kind `velocity`").means("velocity: that of the held components"), std::move(held),
         typed(Type::text, "body").note("all bodies").like("\"plate\"").means("Name of the one body that is held")},
        {},
        {}};
  }();
  return table;
}

Table const& contact_table() {
  static Table const table{
      "Two bodies that touch, slide and part. Bodies without a contact share the motion of the grid where they meet: "
      "they stick together.",
      {typed(Type::names, "bodies").required().like("[\"rod\", \"plate\"]").means("Names of the two bodies"),
       number("friction", "1", 0.0, 10.0).of(0.0).like("0.2").means("Coulomb's coefficient of friction")},
      {},
      {}};
  return table;
}

Table const& history_table() {
  static Table const table{
      "Pressure in time: linear between the times, none before the first and after the last.",
      {typed(Type::numbers, "times", "s", 0.0, longest).required().like("[0, \"0.1 ms\"]").means("Times, rising"),
       typed(Type::numbers, "pressures", "Pa", -1e13, 1e13)
           .required()
           .like("[\"2 MPa\", 0]")
           .means("Pressures at these times")},
      {},
      {}};
  return table;
}

Table const& surface_pressure_table() {
  static Table const table{
      "A pressure on a flat face of a body. The layer of material points below the face takes it.",
      {typed(Type::text, "body").note("the only body").like("\"plate\"").means("Name of the body"),
       face_normal("normal").required().like("\"+z\"").means(
           "Outer normal of the face: `+z` is the upper face, pushed down"),
       nested(Type::table, "region", points_region_table())
           .note("everywhere")
           .like("{shape = \"cylinder\", radius = \"50 mm\", length = 1}")
           .means("Part of the body that is loaded, on its face or on the region's, whichever lies deeper"),
       number("thickness", "m", smallest, far)
           .note("one layer of points")
           .like("\"1 mm\"")
           .means("Depth of the layer that takes the pressure, rounded to whole layers of points"),
       nested(Type::table, "history", history_table())
           .note("from `pressure`")
           .like("{times = [0, \"0.1 ms\"], pressures = [\"2 MPa\", 0]}")
           .means("Pressure in time; instead of `pressure`"),
       number("pressure", "Pa", -1e13, 1e13)
           .note("from `history`")
           .like("\"2 MPa\"")
           .means("A constant pressure; instead of `history`"),
       number("duration", "s", 1e-12, longest)
           .note("to the end")
           .like("\"0.1 ms\"")
           .means("How long a constant pressure acts, from the start")},
      {},
      {}};
  return table;
}

Table const& output_table() {
  static Table const table = [] {
    run::Output const o;
    std::vector<std::string> names;
    for (auto const& field : run::known_fields()) names.push_back(field.name);
    Key fields = typed(Type::words, "fields").like("[\"pressure\", \"velocity\"]").means("Fields to write");
    fields.choices = names;
    fields.note(fmt::format("`{}`", fmt::join(o.fields, "`, `")));
    Key point_fields = typed(Type::words, "point_fields")
                           .like("[\"velocity\", \"stress\"]")
                           .means("Fields of the material points to write, beside position, body and material");
    for (auto const& field : run::known_point_fields()) point_fields.choices.push_back(field.name);
    point_fields.note(fmt::format("`{}`", fmt::join(o.point_fields, "`, `")));
    return Table{"What is written, and when.",
                 {number("field_interval", "s", 0.0, longest)
                      .of(o.field_interval)
                      .like("\"0.5 ms\"")
                      .means("Time between field dumps; 0: none but the last"),
                  typed(Type::numbers, "field_times", "s", 0.0, longest)
                      .note("none")
                      .like("[\"1 ms\", \"2.5 ms\"]")
                      .means("Further times of field dumps"),
                  number("gauge_interval", "s", 0.0, longest)
                      .of(o.gauge_interval)
                      .like("\"10 us\"")
                      .means("Time between gauge records; 0: every step"),
                  typed(Type::boolean, "peak_fields")
                      .of(o.peak_fields)
                      .like("true")
                      .means("Write peak overpressure and impulse of every cell at the end"),
                  word("precision", {"single", "double"})
                      .of(o.single_precision ? "single" : "double")
                      .like("\"single\"")
                      .means("Precision of the fields in the files; the calculation is always in double"),
                  std::move(fields), std::move(point_fields)},
                 {},
                 {}};
  }();
  return table;
}

Table const& end_table() {
  static Table const table{
      "When the calculation ends: at `time`, or after `steps` where these come first.",
      {number("time", "s", 1e-12, longest).required().like("\"10 ms\"").means("Simulated time"),
       typed(Type::integer, "steps", "1", 1, 1e12).note("no limit").like("1000").means("Number of steps")},
      {},
      {}};
  return table;
}

Table const& checkpoint_table() {
  static Table const table = [] {
    run::Checkpoint const c;
    return Table{
        "When the whole state is written, so that `brisance run --resume` can go on from there. Nothing here changes "
        "the "
        "results.",
        {number("interval", "s", 0.0, longest)
             .of(c.interval)
             .like("\"1 ms\"")
             .means("Simulated time between two checkpoints; 0: not by the simulated time"),
         typed(Type::integer, "steps", "1", 0, 1e12)
             .of(c.steps)
             .like("1000")
             .means("Steps between two checkpoints; 0: not by steps"),
         number("wall_clock", "s", 0.0, 1e8)
             .of(c.wall_clock)
             .like("\"30 min\"")
             .means("Time of the clock on the wall between two checkpoints, more where writing one takes more than a "
                    "twentieth of it; 0: not by the clock"),
         typed(Type::integer, "keep", "1", 1, 1000)
             .of(static_cast<long>(c.keep))
             .like("2")
             .means("Number of checkpoints that stay on the disk, the newest ones"),
         typed(Type::boolean, "at_end").of(c.at_end).like("true").means("Write one at the end of the calculation"),
         typed(Type::boolean, "on_signal")
             .of(c.on_signal)
             .like("true")
             .means("Write one when the run is stopped by Ctrl-C or a signal")},
        {},
        {}};
  }();
  return table;
}

Table const& compare_table() {
  static Table const table{
      "Comparison of the gauges with Kingery and Bulmash's curves.",
      {word("burst", {"auto", "spherical", "hemispherical", "none"})
           .of("auto")
           .like("\"hemispherical\"")
           .means(
               "Kind of burst. `auto`: hemispherical for one hemispherical charge that stands on a wall or symmetry "
               "plane, "
               "spherical for one spherical charge in free air, none for everything else (obstacles, regions, further "
               "walls, another ambient fluid)")},
      {},
      {}};
  return table;
}

Table const& tnt_equivalent_table() {
  static Table const table{
      "Mass of TNT with the same effect per mass of the explosive.",
      {number("pressure", "1", 0.01, 100.0).note("unknown").like("1.37").means("For peak overpressure"),
       number("impulse", "1", 0.01, 100.0).note("unknown").like("1.19").means("For impulse and times"),
       typed(Type::text, "source").of("").like("\"TM 5-855-1\"").means("Source of the two numbers")},
      {},
      {}};
  return table;
}

std::vector<Key> explosive_keys() {
  return {
      word("eos", {material::Jwl::name})
          .of(material::Jwl::name)
          .like("\"jwl\"")
          .means("Equation of state of the products"),
      number("energy", "J/m3", 1e6, 1e12)
          .required()
          .like("\"6.993 GJ/m3\"")
          .means("Energy E0 per unit volume of the unreacted explosive"),
      number("detonation_speed", "m/s", 100.0, 2e4).required().like("6930").means("Chapman-Jouguet detonation speed D"),
      number("cj_pressure", "Pa", 1e6, 1e12).required().like("\"21 GPa\"").means("Chapman-Jouguet pressure"),
      nested(Type::table, "tnt_equivalent", tnt_equivalent_table())
          .note("unknown")
          .like("{pressure = 1.37, impulse = 1.19}")
          .means(
              "TNT equivalents for the Kingery-Bulmash comparison, which leaves out what an unknown one decides; those "
              "of TNT are 1")};
}

std::vector<Key> fluid_keys() {
  return {word("eos", {material::IdealGas::name, material::StiffenedGas::name, material::MieGruneisen::name,
                       material::Jwl::name})
              .of(material::IdealGas::name)
              .like("\"ideal_gas\"")
              .means("Equation of state"),
          density().required().means("Default density, for gases at 288.15 K"),
          pressure().of(101325.0).means("Default pressure")};
}

std::map<std::string, std::vector<Key>> explosive_variants() {
  return {{material::Jwl::name, parameter_keys<material::Jwl>()}};
}

std::map<std::string, std::vector<Key>> fluid_variants() {
  return {{material::IdealGas::name, parameter_keys<material::IdealGas>()},
          {material::StiffenedGas::name, parameter_keys<material::StiffenedGas>()},
          {material::MieGruneisen::name, parameter_keys<material::MieGruneisen>()},
          {material::Jwl::name, parameter_keys<material::Jwl>()}};
}

std::vector<Key> own_keys() {
  return {typed(Type::text, "source").of("the deck").like("\"handbook, page 12\"").means("Source of the numbers")};
}

Table const& explosives_table() {
  static Table const table{"An explosive of the deck's own, under the name NAME.", joined(explosive_keys(), own_keys()),
                           "eos", explosive_variants()};
  return table;
}

Table const& fluids_table() {
  static Table const table{"A fluid of the deck's own, under the name NAME.", joined(fluid_keys(), own_keys()), "eos",
                           fluid_variants()};
  return table;
}

template <class... Models>
Table model_table(std::string meaning, std::string explanation) {
  return {std::move(meaning),
          {word("model", {Models::name...})
               .required()
               .like(fmt::format("\"{}\"", [](char const* first, auto const*...) { return first; }(Models::name...)))
               .means(std::move(explanation))},
          "model",
          {{Models::name, solid_parameter_keys<Models>()}...}};
}

Table const& solid_eos_table() {
  static Table const table = model_table<material::Linear, material::MieGruneisen>(
      "Equation of state of a solid: the pressure from density and energy.", "Equation of state");
  return table;
}
Table const& strength_table() {
  static Table const table =
      model_table<material::Elastic, material::VonMises, material::JohnsonCook, material::NoStrength>(
          "Strength of a solid: the rest of the stress.", "Strength model");
  return table;
}
Table const& failure_table() {
  static Table const table = model_table<material::JohnsonCookFailure, material::NoFailure>(
      "Failure of a solid: growing damage, at 1 neither shear stress nor tension.", "Failure model");
  return table;
}

std::vector<Key> solid_keys() {
  static material::Solid const s;
  return {density().required().like("2700").means("Density at the start"),
          number("E", "Pa", 1.0, 1e13)
              .note("from `G` and `K`")
              .like("\"70 GPa\"")
              .means("Young's modulus; together with `nu` it gives `K` of the linear equation of state and `G` of the "
                     "strength"),
          number("nu", "1", -0.9, 0.4999).note("from `G` and `K`").like("0.33").means("Poisson's ratio"),
          number("specific_heat", "J/kg/K", 0.0, 1e6)
              .of(s.specific_heat)
              .like("896")
              .means("Specific heat; 0: plastic work does not heat"),
          number("temperature", "K", 0.0, 1e5).of(s.temperature).like("293").means("Temperature at the start"),
          number("taylor_quinney", "1", 0.0, 1.0)
              .of(s.taylor_quinney)
              .like("0.9")
              .means("Part of the plastic work that heats"),
          number("minimum_pressure", "Pa", -1e13, 0.0)
              .note("none")
              .like("\"-2 GPa\"")
              .means("Tension cut-off (spall): the pressure never falls below it"),
          nested(Type::table, "eos", solid_eos_table())
              .note("`linear` from `E` and `nu`")
              .like("{model = \"mie_gruneisen\", C0 = 3940, S = 1.489, Gamma = 2.02}")
              .means("Equation of state"),
          nested(Type::table, "strength", strength_table())
              .note("`elastic` where `E` and `nu` are given, else none")
              .like("{model = \"von_mises\", yield = \"200 MPa\"}")
              .means("Strength"),
          nested(Type::table, "failure", failure_table())
              .note("none")
              .like("{model = \"johnson_cook\", D1 = 0.54, D2 = 4.89, D3 = -3.03, D4 = 0.014, D5 = 1.12}")
              .means("Failure")};
}

Table const& solids_table() {
  static Table const table{"A solid of the deck's own, under the name NAME.", joined(solid_keys(), own_keys()), {}, {}};
  return table;
}

std::vector<Key> file_keys(char const* kind) {
  return {word("kind", {kind}).required().like(fmt::format("\"{}\"", kind)).means("Kind of material"),
          typed(Type::text, "name").required().like("\"TNT\"").means("Name"),
          typed(Type::names, "aliases").note("none").like("[\"trotyl\"]").means("Other names"),
          typed(Type::text, "source").required().like("\"handbook, page 12\"").means("Source of the numbers")};
}

}  // namespace

Key const* Table::find(std::string_view key) const {
  for (auto const& k : keys) {
    if (k.name == key) return &k;
  }
  for (auto const& [word_, more] : variants) {
    for (auto const& k : more) {
      if (k.name == key) return &k;
    }
  }
  return nullptr;
}

Table const& deck_schema() {
  static Table const table = [] {
    Key inflow = nested(Type::named, "inflow", inflow_table());
    inflow.choices = faces;
    return Table{
        "",
        {typed(Type::text, "title").of("").like("\"10 kg of TNT on the ground\"").means("Title of the case"),
         nested(Type::table, "domain", domain_table()).required().like("size = [4, 4, 3] and cell = \"50 mm\""),
         nested(Type::table, "boundaries", boundaries_table()),
         std::move(inflow),
         nested(Type::table, "ambient", ambient_table()),
         nested(Type::tables, "charge", charge_table()),
         nested(Type::tables, "gauge", gauge_table()),
         nested(Type::tables, "obstacle", obstacle_table()),
         nested(Type::tables, "region", region_table()),
         nested(Type::tables, "body", body_table()),
         nested(Type::tables, "constraint", constraint_table()),
         nested(Type::tables, "contact", contact_table()),
         nested(Type::tables, "surface_pressure", surface_pressure_table()),
         nested(Type::table, "points", points_table()),
         nested(Type::table, "numerics", numerics_table()),
         nested(Type::table, "output", output_table()),
         nested(Type::table, "end", end_table()).required().like("time = \"10 ms\""),
         nested(Type::table, "checkpoint", checkpoint_table()),
         nested(Type::table, "compare", compare_table()),
         nested(Type::named, "explosives", explosives_table()),
         nested(Type::named, "fluids", fluids_table()),
         nested(Type::named, "solids", solids_table())},
        {},
        {}};
  }();
  return table;
}

Table const& explosive_file_schema() {
  static Table const table{"", joined(file_keys("explosive"), explosive_keys()), "eos", explosive_variants()};
  return table;
}

Table const& fluid_file_schema() {
  static Table const table{"", joined(file_keys("fluid"), fluid_keys()), "eos", fluid_variants()};
  return table;
}

Table const& solid_file_schema() {
  static Table const table{"", joined(file_keys("solid"), solid_keys()), {}, {}};
  return table;
}

namespace {

/// Letters to change, insert, delete or swap with the neighbour (optimal string alignment), case aside.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  auto const lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      bool const same = lower(a[i - 1]) == lower(b[j - 1]);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0U : 1U)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1])) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string nearest(std::string_view word_, std::vector<std::string> const& names) {
  std::string best;
  std::size_t best_distance = 0;
  for (auto const& name : names) {
    std::size_t const longer = std::max(word_.size(), name.size());
    std::size_t const shorter = std::min(word_.size(), name.size());
    std::size_t const allowed = std::max<std::size_t>(1, longer / 3);
    if (longer - shorter > allowed) continue;
    std::size_t const distance = edit_distance(word_, name);
    if (distance <= allowed && distance < longer && (best.empty() || distance < best_distance)) {
      best = name;
      best_distance = distance;
    }
  }
  return best;
}

std::string quoted_list(std::vector<std::string> const& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out += i + 1 == names.size() ? " or " : ", ";
    out += fmt::format("\"{}\"", names[i]);
  }
  return out;
}

std::string suggestion(std::string_view word_, std::vector<std::string> const& names, std::string_view label) {
  std::string const near = nearest(word_, names);
  if (!near.empty()) return fmt::format("did you mean \"{}\"?", near);
  if (names.empty()) return fmt::format("no {} are defined", label);
  return fmt::format("{}: {}", label, fmt::join(names, ", "));
}

std::string range_text(Key const& key) {
  bool const low = key.minimum > -unbounded;
  bool const high = key.maximum < unbounded;
  std::string const unit = key.unit == "1" ? "" : fmt::format(" {}", key.unit);
  if (low && high) return fmt::format("{:g} to {:g}{}", key.minimum, key.maximum, unit);
  if (low) return fmt::format("at least {:g}{}", key.minimum, unit);
  if (high) return fmt::format("at most {:g}{}", key.maximum, unit);
  return "any";
}

std::string expectation(Key const& key) {
  std::string quantity = key.unit == "1" ? "a number" : fmt::format("{} in {}", units::dimension(key.unit), key.unit);
  switch (key.type) {
    case Type::number: return quantity;
    case Type::integer: return "a whole number";
    case Type::boolean: return "true or false";
    case Type::text: return "a string";
    case Type::name: return "a name of letters, digits and . _ - +";
    case Type::word: return quoted_list(key.choices);
    case Type::axis: return fmt::format("{} or a vector of three numbers", quoted_list(key.choices));
    case Type::words: return fmt::format("a list of words out of {}", quoted_list(key.choices));
    case Type::names: return "a list of strings";
    case Type::numbers: return fmt::format("a list, each element {}", quantity);
    case Type::integers: return "a list of whole numbers";
    case Type::point: return fmt::format("a list with one element per resolved direction, each {}", quantity);
    case Type::table: return "a table";
    case Type::tables: return "an array of tables";
    case Type::named: return "a table of named tables";
  }
  return {};
}

}  // namespace brisance::deck
