/// Tables of the material points: bodies, what holds and loads them, the method, the MPM region.
#include "case/case.hpp"
#include "deck/schema_keys.hpp"

namespace brisance::deck {

namespace {

Table const& points_region_table() {
  static Table const table{"A part of space.", composed_shape_keys(), {}, {}};
  return table;
}

}  // namespace

Table const& body_table() {
  static Table const table = [] {
    Table t{
        "A body of material points. In a deck with `[mpm_region]`, or with charges, regions, obstacles, inflow or "
        "gauges in the gas, bodies stand in the gas of `[ambient]`. Otherwise they move in empty space; the domain's "
        "faces `wall` push solids and do not pull them, `symmetry` holds them like a mirror, `outflow` lets them "
        "leave, `periodic` joins "
        "opposite faces.",
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
                 word<run::Detonation>("detonation")
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
      {word<mpm::ShapeFunction>("shape_function")
           .of("bspline")
           .like("\"gimp\"")
           .means("`linear`: tents; `gimp`: points of constant size (uGIMP); `cpgimp`: points that stretch with the "
                  "material; `bspline`: quadratic"),
       word<mpm::StressOrder>("stress_order")
           .of("musl")
           .like("\"usf\"")
           .means("When the stress is updated: before the momentum (`usf`), after it (`usl`), or after it with the "
                  "velocity of the points mapped back to the nodes (`musl`)"),
       word<mpm::Transfer>("transfer")
           .of("flip")
           .like("\"apic\"")
           .means("How the velocity of the points follows that of the nodes"),
       number("pic_fraction", "1", 0.0, 1.0).of(o.pic_fraction).like("0.01").means("flip: fraction of PIC"),
       typed(Type::integer, "xpic_order", "1", 1, 10)
           .of(static_cast<long>(o.xpic_order))
           .like("2")
           .means("xpic: its order; 1 is PIC"),
       word("regularisation", {"crack_band", "none"})
           .of("crack_band")
           .like("\"none\"")
           .means("Softening by tensile damage: `crack_band` scales it with the cell to the fracture energy of the "
                  "material, where it has one; `none` leaves it to the rate law"),
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
       number("wall_friction", "1", 0.0, 10.0)
           .of(o.wall_friction)
           .like("0.2")
           .means("Coulomb's coefficient of friction between bodies and the faces of the domain that are a `wall`"),
       typed(Type::integer, "block_cells", "1", 0, 4096)
           .of(static_cast<long>(o.block_cells))
           .like("8")
           .means("Cells per block and direction; 0: 8 in 3D, 32 in 2D, 256 in 1D")},
      {},
      {}};
  return table;
}

namespace {

Table const& box_table() {
  static Table const table{"A box of cells, in the resolved directions.",
                           {position("lower").required().like("[0.1, 0]").means("Low corner"),
                            position("upper").required().like("[0.16, 0.5]").means("High corner")},
                           {},
                           {}};
  return table;
}

}  // namespace

Table const& mpm_region_table() {
  static Table const table = [] {
    static run::MpmRegion const r;
    Key box = nested(Type::table, "box", box_table());
    box.choices = {"auto"};
    return Table{
        "The part of a calculation with gas that material points calculate: the bodies and the gas around them "
        "([Cui14] Sec. 3). A deck with bodies and anything of the gas (charges, regions, obstacles, inflow, gauges in "
        "the gas) has one, also without this table; with this table bodies stand in the gas of `[ambient]` whatever "
        "else there is. Around the inside of the region lies the bridge, `width` cells thick, where gas cells and "
        "points calculate both. Solids keep `width` + 2 cells away from the faces of the region, charges and obstacles "
        "4 cells from its outside. The region calculates nothing until a wave comes near.",
        {std::move(
             box.of("auto")
                 .like("{lower = [\"110 mm\", 0], upper = [\"160 mm\", \"500 mm\"]}")
                 .means("Where: a table with `lower` and `upper`, whose faces lie between cells, on a boundary of "
                        "the domain or at least 4 cells from it; `auto`: the smallest box around the bodies with "
                        "`margin`, and the whole domain where an explosive throws out soil")),
         nested(Type::tables, "boxes", box_table())
             .note("none")
             .like("[{lower = [0, 0], upper = [1, 2]}, {lower = [1, 0], upper = [2, 1]}]")
             .means("Several boxes, instead of `box`: the region is what they cover together"),
         typed(Type::integer, "margin", "1", 1, 1e6)
             .note("`width` + 10")
             .like("20")
             .means("Cells between the bodies and the faces of the box, with `box = \"auto\"`: room for the bodies to "
                    "move. A box that ends near a boundary of the domain is drawn out to it"),
         typed(Type::integer, "width", "1", 1, 50)
             .of(static_cast<long>(r.width))
             .like("5")
             .means("Width w of the bridge in cells, 5 in [Cui14]"),
         word<bridge::Transport>("transport")
             .of("ledger")
             .like("\"ledger\"")
             .means("How mass crosses the faces of the region: `ledger` conserves it to round-off, `paper` is Eqs. "
                    "(40)-(51) of [Cui14] as printed, which count twice what flows out of the region"),
         typed(Type::integer, "points_per_direction", "1", 1, 8)
             .note("4 in 1D, 3 in 2D, 2 in 3D")
             .like("2")
             .means("Points of the gas per cell and direction at the start"),
         number("activation", "Pa", 0.0, 1e13)
             .note("a thousandth of the ambient pressure")
             .like("\"100 Pa\"")
             .means("Overpressure next to the region that wakes it"),
         typed(Type::boolean, "subcycling")
             .of(r.subcycling)
             .like("true")
             .means("Gas and points take steps of their own within a common one; else both take the shorter one"),
         word<mpm::Transfer>("transfer")
             .of("apic")
             .like("\"apic\"")
             .means("Of the gas points; `points.transfer` is that of the bodies"),
         word("order", {"usl", "musl"})
             .of("usl")
             .like("\"usl\"")
             .means("Of the gas points; `points.stress_order` is that of the bodies"),
         number("linear_viscosity", "1", 0.0, 10.0)
             .of(r.linear_viscosity)
             .like("0.06")
             .means("Linear coefficient of the bulk viscosity of the gas points"),
         number("quadratic_viscosity", "1", 0.0, 100.0)
             .of(r.quadratic_viscosity)
             .like("1.5")
             .means("Quadratic coefficient of the bulk viscosity of the gas points"),
         typed(Type::boolean, "slip")
             .of(r.slip)
             .like("false")
             .means("Gas slips along solids: it shares their velocity across their surfaces only. false: gas sticks to "
                    "them, by the shared grid of [Cui14]; it then loads a plate some 20 % too much on 4 cells over its "
                    "thickness"),
         number("shock_conduction", "1", 0.0, 10.0)
             .of(r.shock_conduction)
             .like("0.2")
             .means("Coefficient of the conduction of heat in shocks of the gas points"),
         number("courant", "1", 0.01, 1.0)
             .of(r.courant)
             .like("0.8")
             .means("Courant number of the gas points; `points.courant` is that of the bodies"),
         typed(Type::integer, "population_interval", "1", 0, 1e6)
             .of(static_cast<long>(r.population_interval))
             .like("4")
             .means("Steps between splits and merges of the gas points; 0: none"),
         number("reference_pressure", "Pa", 0.0, 1e13)
             .note("the lowest pressure of the gas, the ambient one at most")
             .like("\"101.325 kPa\"")
             .means("Taken off the pressure in the forces on the points")},
        {},
        {}};
  }();
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
        "The velocity of material points in a part of space is prescribed, by way of the grid nodes there. Gas that "
        "slips along bodies (`mpm_region.slip`) is not held, but stays at the surface of those that are; gas that "
        "sticks to them is held with them.",
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

namespace {

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

}  // namespace

Table const& surface_pressure_table() {
  static Table const table{
      "A pressure on the surface of a body, by its true normal and area: with `normal` on what is seen from that side, "
      "so "
      "that the force is the pressure times the body's shadow; without it on the whole surface, or on all of it in "
      "`region`. The layer of material points below the surface takes it. Areas and normals are those of the start.",
      {typed(Type::text, "body").note("the only body").like("\"plate\"").means("Name of the body"),
       face_normal("normal")
           .note("all sides")
           .like("\"+z\"")
           .means("Side that the pressure comes from: `+z` loads what is seen from above, and pushes a flat top down"),
       nested(Type::table, "region", points_region_table())
           .note("everywhere")
           .like("{shape = \"cylinder\", radius = \"50 mm\", length = 1}")
           .means("Part of the surface that is loaded"),
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

Table const& reinforcement_table() {
  static mpm::Bar const bar;
  static Table const table{
      "A steel bar in a body, or a row of them, thinner than the grid resolves: smeared over the points within a cell "
      "of the "
      "axis, which carry its stress along it beside their own. In cartesian3d. A bar of two cells and more in diameter "
      "is a "
      "`[[body]]` of its own, cut out of the other. Where bars cross, the points belong to the first. A bar with its "
      "middle on a symmetry plane goes on behind it as its mirror image, as bodies do.",
      {typed(Type::text, "body").note("the only body").like("\"slab\"").means("Name of the body"),
       position("from").required().like("[0, 0.1, 0.03]").means("One end of the axis, in the body"),
       position("to").required().like("[1, 0.1, 0.03]").means("The other"),
       number("diameter", "m", smallest, far).required().like("\"12 mm\"").means("Diameter"),
       typed(Type::integer, "copies", "1", 1, 10000).of(1L).like("10").means("Number of equal bars side by side"),
       position("step").note("needed by several copies").like("[0, \"0.1 m\", 0]").means("From one to the next"),
       number("E", "Pa", 1.0, 1e13).of(bar.E).like("\"200 GPa\"").means("Young's modulus"),
       number("yield", "Pa", 0.0, 1e12).of(bar.yield).like("\"500 MPa\"").means("Yield stress"),
       number("hardening", "Pa", 0.0, 1e13)
           .of(bar.hardening)
           .like("\"1 GPa\"")
           .means("Plastic modulus, d sigma / d eps_p")},
      {},
      {}};
  return table;
}

}  // namespace brisance::deck
