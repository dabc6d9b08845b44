/// [afterburn]: whose it is, how much energy it has, and when it may begin.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/models.hpp"
#include "deck/tables/tables.hpp"
#include "setup/start.hpp"

namespace brisance::deck {

Table const& afterburn_table() {
  static Table const table{
      "Energy that the detonation products release after the detonation, in proportion to their mass and independent "
      "of place: no model accounts for the air that has been mixed in. Without this table there is no afterburn. "
      "Afterburn is available in gas cells only and cannot be combined with bodies.",
      {model_word<material::AfterburnRate>("model")
           .required()
           .like("\"constant_rate\"")
           .means(
               "`constant_rate`: at a constant rate from `begin` to `end`; `miller`: d(lambda)/dt = a (1 - lambda)^m "
               "p^n [Miller95], where lambda is the fraction that has been released and is advected with the products"),
       number("energy", "J/kg", 0.0, 1e9)
           .note("that of the explosive, if known")
           .like("\"10.2 MJ/kg\"")
           .means("Total energy Q per mass of products")},
      "model",
      keys_of_models<material::AfterburnRate>()};
  return table;
}

namespace {

/// A time [s] at which the charge has burnt in every cell [m]: its farthest corner is lit, and its cells have burnt
/// through.
double burnt_at(run::Charge const& charge, grid::Domain const& domain, double cell) {
  if (charge.detonation == run::Detonation::instantaneous) return 0.0;
  auto const bounds = shape::bounds(charge.shape);
  Vec3 const middle = shape::centre(charge.shape);
  double last = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 x = middle;
    for (int d = 0; d < domain.dimensions(); ++d) x[d] = (corner >> d) % 2 == 0 ? bounds.lower[d] : bounds.upper[d];
    last = std::max(last, detonation::lighting_time(x, charge.initiation, charge.explosive.detonation_speed));
  }
  // The centre of a cell that the charge fills in part may lie beyond the corner, by half its diagonal at most; a cell
  // burns for 1.5 h/D.
  return last + (1.5 + 0.5 * std::sqrt(3.0)) * cell / charge.explosive.detonation_speed;
}

/// Does a release at a constant rate begin after the detonation? False after an error.
bool begins_burnt(Draft const& draft, Section const& section, material::ConstantRateAfterburn const& model) {
  if (!(model.end > model.begin)) {
    draft.error(section, "end",
                fmt::format("{} is not later than begin = {}: swap or correct them", section.shown("end"),
                            section.shown("begin")));
    return false;
  }
  double burnt = 0.0;
  // A charge that is remapped burns on the cells of the 1D simulation.
  bool const remapped = draft.deck.text("start") == "remap";
  Section const* remap = draft.deck.section("remap");
  double const specified = remap != nullptr ? remap->number("cell").value_or(0.0) : 0.0;
  for (run::Charge const& charge : draft.out.charges) {
    auto const bounds = shape::bounds(charge.shape);
    double radius = 0.0;
    for (int d = 0; d < draft.dims(); ++d) radius = std::max(radius, 0.5 * (bounds.upper[d] - bounds.lower[d]));
    double const cell =
        remapped ? setup::start_cell(specified, radius) : draft.out.domain_of(draft.out.adaptive.charges).h;
    burnt = std::max(burnt, burnt_at(charge, draft.out.domain, cell));
  }
  if (draft.domain_known && model.begin < burnt) {
    draft.error(
        section, "begin",
        fmt::format(
            "{} is before the end of the detonation, and unburnt explosive has no afterburn: write at least {:.3g} s",
            section.shown("begin"), 1.005 * burnt));
    return false;
  }
  if (draft.end_known && model.begin >= draft.out.end.time) {
    draft.warn(section, "begin", fmt::format("is after the end of the simulation at {:g} s", draft.out.end.time));
  }
  return true;
}

}  // namespace

void build_afterburn(Draft& draft) {
  Section const* section = draft.deck.section("afterburn");
  if (section == nullptr) return;
  if (draft.has_bodies() || draft.deck.given("mpm_region")) {
    draft.report.error(section->place, section->path,
                       "afterburn is available in gas cells only and cannot be combined with material points: remove "
                       "this table, or simulate without bodies and without an MPM region");
    return;
  }
  if (!draft.products_known || draft.deck.broken("charge")) return;
  material::Explosive const* products = draft.out.explosive_of(material::products_fluid);
  for (run::InitialState const& initial : draft.out.initial_states) {
    if (products == nullptr && initial.fluid == material::products_fluid &&
        draft.materials.fluid(initial.fluid_name) == nullptr) {
      products = draft.materials.explosive(initial.fluid_name);
    }
  }
  if (products == nullptr) {
    if (draft.deck.given("charge") || draft.deck.given("initial_state")) {
      if (draft.report.failed()) return;  // what is wrong with them is reported
    }
    draft.report.error(section->place, section->path,
                       "there are no detonation products that could burn: add a [[charge]], or remove this table");
    return;
  }
  auto const word = section->text("model");
  if (!word || section->broken("energy")) return;
  material::Afterburn afterburn;
  if (!section->given("energy") && !products->afterburn_energy) {
    draft.report.error(section->place, section->path_of("energy"),
                       fmt::format("the afterburn energy of {} is unknown: write, for example, energy = \"10 MJ/kg\"",
                                   products->name));
    return;
  }
  afterburn.energy = section->given("energy") ? *section->number("energy") : *products->afterburn_energy;
  auto const rate = filled<material::AfterburnRate>(*word, *section);
  if (!rate) return;
  auto const* constant = std::get_if<material::ConstantRateAfterburn>(&*rate);
  if (constant != nullptr && !begins_burnt(draft, *section, *constant)) return;
  afterburn.rate = *rate;
  draft.out.afterburn = afterburn;
}

}  // namespace brisance::deck
