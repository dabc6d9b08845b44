/// [numerics]: the numerical method of the gas.
#include <fmt/format.h>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Settings<run::Numerics> const& settings() {
  using N = run::Numerics;
  static Settings<N> const all{
      {&N::scheme, word<gas::Scheme>("scheme")
                       .like("\"muscl-hancock\"")
                       .means("`muscl-hancock`: second-order Godunov scheme with the HLLC solver; `lax-wendroff`: the "
                              "scheme of [Cui14] with adaptive viscosity")},
      {&N::obstacles, word<run::ObstacleCells>("obstacles").like("\"cut\"").means("How the gas sees obstacles")},
      {&N::courant, number("courant", "1", 0.01, 1.0).like("0.8").means("Courant number")},
      {&N::block_cells, typed(Type::integer, "block_cells", "1", 0, 4096)
                            .like("16")
                            .means("Cells per block and direction, never more than 376; 0: automatic")},
      {&N::sleep, typed(Type::boolean, "sleep")
                      .like("true")
                      .means("Skip blocks in which nothing happens; does not change the results")},
      {&N::limiter_beta,
       number("limiter_beta", "1", 1.0, 2.0)
           .like("1.5")
           .means("Parameter of the generalised monotonised-central limiter: 1 is minmod, 2 is the steepest")},
      {&N::carbuncle_cure,
       typed(Type::boolean, "carbuncle_cure").like("true").means("Blend towards HLL along shocks (carbuncle cure)")},
      {&N::density_floor, number("density_floor", "kg/m3", 1e-12, 1.0).like("1e-6").means("Guard: smallest density")},
      {&N::pressure_floor, number("pressure_floor", "Pa", 1e-9, 1e4).like("1e-3").means("Guard: smallest pressure")},
      {&N::viscosity, number("viscosity", "1", 0.0, 1.0)
                          .like("0.5")
                          .means("lax-wendroff: constant eta of the artificial viscosity; 0: eta of [Cui14] Eq. (5)")},
      number("ideal_products", "1", 4.0, 1e6)
          .note("where double precision no longer resolves the difference")
          .like("10")
          .means("Relative volume V above which detonation products are treated as an ideal gas with gamma = 1 + "
                 "omega; the exponential terms of the JWL equation are faded out from half of it. Saves little; "
                 "docs/validation/remap.md shows the error")};
  return all;
}

}  // namespace

Table const& numerics_table() {
  static Table const table{"The numerical method.", settings().keys(), {}, {}};
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
  for (auto& fluid : draft.out.other_fluids) set(fluid.eos);
  for (auto& body : draft.out.particles.bodies) set(body.solid.eos);
  if (found || !draft.out.charges.empty()) return;
  Section const& section = *draft.deck.section("numerics");
  draft.report.warning(section.place_of("ideal_products"), section.path_of("ideal_products"),
                       "has no effect: no material of the deck has a JWL equation of state");
}

}  // namespace

void build_numerics(Draft& draft) {
  Section const* section = draft.deck.section("numerics");
  if (section == nullptr) return;
  auto& n = draft.out.numerics;
  settings().read(*section, n);
  if (n.block_cells != 0 && n.block_cells < 4) {
    draft.error(*section, "block_cells",
                fmt::format("{} is too small; allowed: 0 (automatic) or 4 to 4096", n.block_cells));
  }
  struct OfScheme {
    char const* key;
    run::Scheme scheme;
  };
  for (OfScheme const& of :
       {OfScheme{"limiter_beta", run::Scheme::muscl_hancock}, OfScheme{"carbuncle_cure", run::Scheme::muscl_hancock},
        OfScheme{"viscosity", run::Scheme::lax_wendroff}}) {
    if (!section->given(of.key) || n.scheme == of.scheme) continue;
    draft.report.warning(section->place_of(of.key), section->path_of(of.key),
                         fmt::format("has no effect with {}", word_of(n.scheme)));
  }
  if (n.obstacles == run::ObstacleCells::cut && n.scheme != run::Scheme::muscl_hancock) {
    draft.error(*section, "obstacles",
                fmt::format("{} sees obstacles as stairs: use obstacles = \"stairs\" or scheme = \"{}\"",
                            word_of(n.scheme), word_of(run::Scheme::muscl_hancock)));
  }
}

void build_ideal_products(Draft& draft) {
  Section const* section = draft.deck.section("numerics");
  if (section == nullptr) return;
  if (auto const volume = section->number("ideal_products")) cut_over(draft, *volume);
}

}  // namespace brisance::deck
