/// The afterburn of a deck: whose it is, how much energy it has, and when it may begin.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "deck/build.hpp"
#include "deck/build_models.hpp"
#include "setup/start.hpp"

namespace brisance::deck {

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

}  // namespace

void Builder::afterburn() {
  Section const* section = deck_.section("afterburn");
  if (section == nullptr) return;
  if (has_bodies() || deck_.given("mpm_region")) {
    report_.error(section->place, section->path,
                  "material points have no afterburn, only gas cells: remove this table, or calculate without bodies "
                  "and without an MPM region");
    return;
  }
  if (!products_known_ || deck_.broken("charge")) return;
  material::Explosive const* products = out_.charges.empty() ? nullptr : &out_.charges.front().explosive;
  for (run::Region const& region : out_.regions) {
    if (products == nullptr && region.second_fluid && fluid(region.fluid_name) == nullptr) {
      products = explosive(region.fluid_name);
    }
  }
  if (products == nullptr) {
    if (deck_.given("charge") || deck_.given("region")) {
      if (report_.failed()) return;  // what is wrong with them is reported
    }
    report_.error(section->place, section->path,
                  "there are no detonation products that could burn on: add a [[charge]], or remove this table");
    return;
  }
  auto const word = section->text("model");
  if (!word || section->broken("energy")) return;
  material::Afterburn afterburn;
  if (!section->given("energy") && !products->afterburn_energy) {
    report_.error(section->place, section->path_of("energy"),
                  fmt::format("the afterburn energy of {} is not known: write for example energy = \"10 MJ/kg\"",
                              products->name));
    return;
  }
  afterburn.energy = section->given("energy") ? *section->number("energy") : *products->afterburn_energy;
  auto const rate = filled<material::AfterburnRate>(*word, *section);
  if (!rate) return;
  if (auto const* model = std::get_if<material::ConstantRateAfterburn>(&*rate)) {
    if (!(model->end > model->begin)) {
      error(*section, "end",
            fmt::format("{} does not lie after begin = {}: exchange or correct them", section->shown("end"),
                        section->shown("begin")));
      return;
    }
    double burnt = 0.0;
    // A charge that is remapped burns on the cells of the 1D calculation.
    bool const remapped = deck_.text("start") == "remap";
    Section const* remap = deck_.section("remap");
    double const asked = remap != nullptr ? remap->number("cell").value_or(0.0) : 0.0;
    for (run::Charge const& charge : out_.charges) {
      auto const bounds = shape::bounds(charge.shape);
      double radius = 0.0;
      for (int d = 0; d < dims(); ++d) radius = std::max(radius, 0.5 * (bounds.upper[d] - bounds.lower[d]));
      double const cell = remapped ? setup::start_cell(asked, radius) : out_.domain.h;
      burnt = std::max(burnt, burnt_at(charge, out_.domain, cell));
    }
    if (domain_known_ && model->begin < burnt) {
      error(*section, "begin",
            fmt::format("{} lies before the end of the detonation, and unburnt explosive has no afterburn: write at "
                        "least {:.3g} s",
                        section->shown("begin"), 1.005 * burnt));
      return;
    }
    if (end_known_ && model->begin >= out_.end.time) {
      warn(*section, "begin", fmt::format("lies after the end of the calculation at {:g} s", out_.end.time));
    }
  }
  afterburn.rate = *rate;
  out_.afterburn = afterburn;
}

}  // namespace brisance::deck
