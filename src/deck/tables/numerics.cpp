/// [numerics]: the numerical method of the gas.
#include <fmt/format.h>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

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

namespace {

void cut_over(Draft& draft, double volume) {
  bool found = false;
  auto const set = [&](auto& eos) {
    if (auto* jwl = std::get_if<material::Jwl>(&eos)) {
      jwl->ideal_beyond = volume;
      found = true;
    }
  };
  for (auto& charge : draft.out.charges) charge.explosive.products.ideal_beyond = volume;
  if (draft.out.second_fluid) set(draft.out.second_fluid->eos);
  for (auto& body : draft.out.points.bodies) set(body.solid.eos);
  if (found || !draft.out.charges.empty()) return;
  Section const& section = *draft.deck.section("numerics");
  draft.report.warning(section.place_of("ideal_products"), section.path_of("ideal_products"),
                       "has no effect: nothing in the deck has a JWL equation of state");
}

}  // namespace

void build_numerics(Draft& draft) {
  Section const* section = draft.deck.section("numerics");
  if (section == nullptr) return;
  auto& n = draft.out.numerics;
  choose(*section, "scheme", n.scheme);
  n.courant = section->number("courant").value_or(n.courant);
  n.block_cells = static_cast<int>(section->integer("block_cells").value_or(n.block_cells));
  n.sleep = section->boolean("sleep").value_or(n.sleep);
  n.limiter_beta = section->number("limiter_beta").value_or(n.limiter_beta);
  n.carbuncle_cure = section->boolean("carbuncle_cure").value_or(n.carbuncle_cure);
  n.density_floor = section->number("density_floor").value_or(n.density_floor);
  n.pressure_floor = section->number("pressure_floor").value_or(n.pressure_floor);
  n.viscosity = section->number("viscosity").value_or(n.viscosity);
  if (auto const volume = section->number("ideal_products")) cut_over(draft, *volume);
  if (n.block_cells != 0 && n.block_cells < 4) {
    draft.error(*section, "block_cells",
                fmt::format("{} is too small; allowed: 0 (chosen by the program) or 4 to 4096", n.block_cells));
  }
  if (n.scheme == run::Scheme::lax_wendroff) {
    for (auto const* key : {"limiter_beta", "carbuncle_cure"}) {
      if (section->given(key))
        draft.report.warning(section->place_of(key), section->path_of(key), "has no effect with lax-wendroff");
    }
  } else if (section->given("viscosity")) {
    draft.report.warning(section->place_of("viscosity"), section->path_of("viscosity"),
                         "has no effect with muscl-hancock");
  }
}

}  // namespace brisance::deck
