/// [points]: the material point method.
#include <fmt/format.h>

#include <algorithm>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Settings<mpm::Options> const& settings() {
  using O = mpm::Options;
  static Settings<O> const all{
      {&O::shape, word<mpm::ShapeFunction>("shape_function")
                      .like("\"gimp\"")
                      .means("`linear`: piecewise linear; `gimp`: particles of constant size (uGIMP); `cpgimp`: "
                             "particles that stretch with the material; `bspline`: quadratic B-splines")},
      {&O::order, word<mpm::StressOrder>("stress_order")
                      .like("\"usf\"")
                      .means("When the stress is updated: before the momentum (`usf`), after it (`usl`), or after it "
                             "with the particle velocities mapped back to the nodes (`musl`)")},
      {&O::transfer, word<mpm::Transfer>("transfer")
                         .like("\"apic\"")
                         .means("How particle velocities are updated from nodal velocities")},
      {&O::pic_fraction, number("pic_fraction", "1", 0.0, 1.0).like("0.01").means("For `flip`: fraction of PIC")},
      {&O::xpic_order,
       typed(Type::integer, "xpic_order", "1", 1, 10).like("2").means("For `xpic`: its order; 1 is PIC")},
      {&O::crack_band,
       word("regularisation", {"crack_band", "none"})
           .like("\"none\"")
           .means("Softening by tensile damage: `crack_band` scales the softening with the cell size so that it "
                  "dissipates the fracture energy of the material, if one is given; `none` uses the rate law alone")},
      {&O::locking_control, typed(Type::boolean, "locking_control")
                                .like("true")
                                .means("Average the volumetric strain over the particles of a body in each cell")},
      {&O::linear_viscosity,
       number("linear_viscosity", "1", 0.0, 10.0).like("0.06").means("Linear coefficient of the bulk viscosity")},
      {&O::quadratic_viscosity,
       number("quadratic_viscosity", "1", 0.0, 100.0).like("1.5").means("Quadratic coefficient of the bulk viscosity")},
      {&O::courant, number("courant", "1", 0.01, 1.0)
                        .note("0.4; for metals and elastic bodies with B-splines in an MPM region 0.6, in 3D 0.5")
                        .like("0.4")
                        .means("Courant number")},
      typed(Type::point, "body_force", "m/s2", -1e9, 1e9)
          .note("none")
          .like("[0, 0, -9.81]")
          .means("Acceleration of all particles, for example gravity"),
      {&O::wall_friction,
       number("wall_friction", "1", 0.0, 10.0)
           .like("0.2")
           .means("Coulomb friction coefficient between bodies and faces of the domain of type `wall`")},
      {&O::damping, number("damping", "1/s", 0.0, 1e9)
                        .like("50")
                        .means("Rate at which bodies lose velocity, v' = -damping v, for example to let them settle "
                               "under gravity. Gas, explosives and rigid bodies are not damped")},
      {&O::damping_end,
       number("damping_end", "s", 0.0, longest).note("the end").like("\"0.2 s\"").means("Time at which damping ends")},
      {&O::block_cells, typed(Type::integer, "block_cells", "1", 0, 4096)
                            .like("8")
                            .means("Cells per block and direction; 0: about 8 in 3D, 32 in 2D, 256 in 1D")}};
  return all;
}

}  // namespace

Table const& particles_table() {
  static Table const table{"Settings of the material point method.", settings().keys(), {}, {}};
  return table;
}

void build_particles(Draft& draft) {
  Section const* section = draft.deck.section("points");
  if (section == nullptr) return;
  auto& o = draft.out.particles.options;
  settings().read(*section, o);
  if (draft.geometry_known && section->given("body_force")) {
    o.body_force = draft.point(*section, "body_force").value_or(o.body_force);
    if (draft.radial() && o.body_force[0] != 0.0) {
      draft.error(*section, "body_force",
                  fmt::format("{} has a component along x, the radius of {}, so it would not be symmetric about the "
                              "axis: write 0 as its first element",
                              section->shown("body_force"), word_of(draft.geometry())));
    }
  }
  if (o.block_cells != 0 && o.block_cells < 4) {
    draft.error(*section, "block_cells",
                fmt::format("{} is too small; allowed: 0 (automatic) or 4 to 4096", o.block_cells));
  }
  if (section->given("pic_fraction") && o.transfer != mpm::Transfer::flip) {
    draft.warn(*section, "pic_fraction", "has an effect only with transfer = \"flip\"");
  }
  if (section->given("xpic_order") && o.transfer != mpm::Transfer::xpic) {
    draft.warn(*section, "xpic_order", "has an effect only with transfer = \"xpic\"");
  }
  if (section->given("damping_end") && !(o.damping > 0.0)) {
    draft.warn(*section, "damping_end", "has no effect without damping");
  }
  auto const& faces = draft.out.domain.boundary;
  bool const walls = std::find(faces.begin(), faces.end(), grid::Boundary::wall) != faces.end();
  if (o.wall_friction > 0.0 && draft.boundaries_known && !walls) {
    draft.warn(*section, "wall_friction",
               "has no effect: no face of the domain is a wall; write, for example, z_low = \"wall\" in [boundaries]");
  }
}

}  // namespace brisance::deck
