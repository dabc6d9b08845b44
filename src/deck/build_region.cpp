/// The MPM region of a deck: where gas and material points meet.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "deck/build.hpp"
#include "setup/place_region.hpp"

namespace brisance::deck {

namespace {

constexpr int samples = 4;  ///< per cell and direction, where shapes are looked for

}  // namespace

void Builder::mpm_region() {
  if (!has_gas_ || (!has_bodies() && !deck_.given("mpm_region")) || deck_.broken("mpm_region")) return;
  run::MpmRegion region;
  Section const* section = deck_.section("mpm_region");
  bool sound = domain_known_ && boundaries_known_;
  if (section != nullptr) {
    mpm_region_options(*section, region);
    sound = mpm_region_boxes(*section, region) && !section->doubtful() && sound;
    for (auto const* key : {"margin", "width"}) sound = sound && !section->broken(key);
  }
  if (section == nullptr) warn_if_only_gauges();
  bool const automatic = region.boxes.empty();
  // Bodies with an error of their own leave open where the region would be.
  bool const bodies_known = std::all_of(body_shapes_.begin(), body_shapes_.end(), [](auto const& s) { return s; });
  if (automatic && !has_bodies() && sound) {
    error(*section, "box",
          "there is no body that the region could be laid around: give its box, for example box = {lower = [0, 0, 0], "
          "upper = [1, 1, 1]}");
    return;
  }
  out_.mpm_region = region;
  products_of_bodies();
  contacts_of_fluids(region);
  if (!sound || (has_bodies() && (!bodies_known || body_shapes_.empty()))) return;
  try {
    check_mpm_region(setup::region_of(out_));
  } catch (InputError const& problem) {
    std::string const hint =
        automatic ? fmt::format(
                        "; this is the box around the bodies with {} cells on each side: write [mpm_region] "
                        "with a box or another margin",
                        setup::margin_of(region))
                  : "";
    bool const given = section != nullptr;
    std::string_view const key = given && section->given("boxes") ? "boxes" : "box";
    if (given) {
      error(*section, key, problem.what() + hint);
    } else {
      report_.error(deck_.place_of("body"), "mpm_region", problem.what() + hint);
    }
  }
}

void Builder::warn_if_only_gauges() {
  for (auto const* key : {"charge", "region", "obstacle", "inflow"}) {
    if (deck_.given(key)) return;
  }
  report_.warning(deck_.place_of("gauge"), "gauge",
                  "gauges in the gas put the bodies into the ambient gas, with an MPM region around them; write body = "
                  "... to measure on a body alone, or [mpm_region] where this is meant");
}

void Builder::products_of_bodies() {
  auto const* const sections = deck_.sections("body");
  if (sections == nullptr || sections->size() != out_.points.bodies.size()) return;  // there were errors
  for (std::size_t n = 0; n < sections->size(); ++n) {
    run::Body const& body = out_.points.bodies[n];
    if (!body.solid.burns()) continue;
    if (!out_.second_fluid) {
      out_.second_fluid = products(*explosive(body.solid.name));
    } else if (out_.second_fluid->name != body.solid.name) {
      error((*sections)[n], "material",
            fmt::format("the products of \"{}\" would be a third fluid beside \"{}\" and \"{}\"; a calculation has at "
                        "most two: use one explosive for all, or convert the mass by its TNT equivalent",
                        body.solid.name, out_.ambient.fluid.name, out_.second_fluid->name));
    }
  }
}

void Builder::contacts_of_fluids(run::MpmRegion const& region) {
  auto const* const sections = deck_.sections("contact");
  auto const& contacts = out_.points.contacts;
  if (!region.slip || sections == nullptr || sections->size() != contacts.size()) return;
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    for (int const body : {contacts[n].first, contacts[n].second}) {
      if (body >= static_cast<int>(out_.points.bodies.size())) return;  // there were errors
      run::Body const& fluid = out_.points.bodies[body];
      if (fluid.rigid || fluid.solid.has_deviator()) continue;
      error(
          (*sections)[n], "bodies",
          fmt::format("\"{}\" is a fluid, and fluids slip along solids in an MPM region, without friction: remove the "
                      "contact, or write mpm_region.slip = false",
                      fluid.name));
    }
  }
}

void Builder::mpm_region_options(Section const& section, run::MpmRegion& region) {
  auto const set = [&](std::string_view key, int& value) {
    if (auto const given = section.integer(key)) value = static_cast<int>(*given);
  };
  set("margin", region.margin);
  set("width", region.width);
  set("points_per_direction", region.points_per_direction);
  set("population_interval", region.population_interval);
  choose(section, "transport", region.transport);
  region.activation = section.number("activation");
  region.subcycling = section.boolean("subcycling").value_or(region.subcycling);
  choose(section, "transfer", region.transfer);
  choose(section, "order", region.order);
  region.linear_viscosity = section.number("linear_viscosity").value_or(region.linear_viscosity);
  region.quadratic_viscosity = section.number("quadratic_viscosity").value_or(region.quadratic_viscosity);
  region.slip = section.boolean("slip").value_or(region.slip);
  region.shock_conduction = section.number("shock_conduction").value_or(region.shock_conduction);
  region.courant = section.number("courant").value_or(region.courant);
  region.reference_pressure = section.number("reference_pressure");
}

bool Builder::mpm_region_boxes(Section const& section, run::MpmRegion& region) {
  if (section.broken("box") || section.broken("boxes")) return false;
  Section const* one = section.section("box");
  auto const* several = section.sections("boxes");
  if (one != nullptr && several != nullptr) {
    error(section, "boxes", "the region is given by box and by boxes: give only one of the two");
    return false;
  }
  if (several != nullptr && several->empty()) {
    error(section, "boxes", "the list is empty: give at least one box, or remove the key");
    return false;
  }
  if (section.given("margin") && (one != nullptr || several != nullptr)) {
    warn(section, "margin", "has no effect where the box is given");
  }
  bool sound = true;
  auto const add = [&](Section const& given) {
    auto const lower = point(given, "lower");
    auto const upper = point(given, "upper");
    if (!lower || !upper || given.doubtful()) {
      sound = false;
      return;
    }
    for (int d = 0; d < dims(); ++d) {
      if ((*upper)[d] > (*lower)[d]) continue;
      error(given, "upper",
            fmt::format("{} does not lie above lower = {} in direction {}: exchange or correct them",
                        given.shown("upper"), given.shown("lower"), directions[d]));
      sound = false;
      return;
    }
    for (int d = 0; d < dims() && domain_known_; ++d) {
      bool const below = (*lower)[d] < out_.domain.lower[d] - tiny();
      if (!below && (*upper)[d] <= out_.domain.upper(d) + tiny()) continue;
      error(given, below ? "lower" : "upper",
            fmt::format("{} lies outside the domain, which reaches from {:.6g} to {:.6g} m in direction {}",
                        given.shown(below ? "lower" : "upper"), out_.domain.lower[d], out_.domain.upper(d),
                        directions[d]));
      sound = false;
      return;
    }
    region.boxes.push_back({*lower, *upper});
  };
  if (one != nullptr) add(*one);
  if (several != nullptr) {
    for (Section const& given : *several) add(given);
  }
  return sound;
}

template <class Wrong>
std::optional<Vec3> Builder::wrong_place(shape::Shape const& shape, bool by_centres, Wrong&& wrong,
                                         std::optional<shape::Box> const& within) const {
  grid::Domain const& domain = out_.domain;
  auto bounds = shape::bounds(shape);
  for (int d = 0; within && d < dims(); ++d) {
    bounds.lower[d] = std::max(bounds.lower[d], within->lower[d]);
    bounds.upper[d] = std::min(bounds.upper[d], within->upper[d]);
    if (bounds.upper[d] < bounds.lower[d]) return std::nullopt;
  }
  Index3 first{0, 0, 0};
  Index3 last{0, 0, 0};
  for (int d = 0; d < dims(); ++d) {
    auto const cell = [&](double x) {
      return static_cast<int>(std::floor(std::clamp((x - domain.lower[d]) / domain.h, 0.0, domain.cells[d] - 0.5)));
    };
    first[d] = cell(bounds.lower[d] + tiny());
    last[d] = cell(bounds.upper[d] - tiny());
  }
  int const parts = by_centres ? 1 : samples;
  Index3 count{1, 1, 1};
  for (int d = 0; d < dims(); ++d) count[d] = parts;
  for (int k = first[2]; k <= last[2]; ++k) {
    for (int j = first[1]; j <= last[1]; ++j) {
      for (int i = first[0]; i <= last[0]; ++i) {
        Index3 const cell{i, j, k};
        if (!wrong(cell)) continue;
        for (int n = 0; n < count[0] * count[1] * count[2]; ++n) {
          Index3 const part{n % count[0], n / count[0] % count[1], n / (count[0] * count[1])};
          Vec3 x = domain.centre(cell);
          for (int d = 0; d < dims(); ++d) x[d] += ((part[d] + 0.5) / parts - 0.5) * domain.h;
          if (shape::contains(shape, domain, x)) return x;
        }
      }
    }
  }
  return std::nullopt;
}

void Builder::check_mpm_region(bridge::Region const& region) {
  for (std::size_t i = 0; i < body_shapes_.size(); ++i) check_body_place(region, i);
  // The region and the cells beside it that act as points.
  std::vector<Index3> near;
  for (Index3 const& cell : region.lent()) near.push_back(region.clamped(cell));
  std::sort(near.begin(), near.end());
  // Elsewhere nothing is wrong, and a large charge is not looked through there.
  shape::Box around;
  around.lower = {1e300, 1e300, 1e300};
  around.upper = {-1e300, -1e300, -1e300};
  for (auto const* cells : {&region.cells(), &region.lent()}) {
    for (Index3 const& cell : *cells) {
      for (int d = 0; d < dims(); ++d) {
        double const low = out_.domain.lower[d] + cell[d] * out_.domain.h;
        around.lower[d] = std::min(around.lower[d], low);
        around.upper[d] = std::max(around.upper[d], low + out_.domain.h);
      }
    }
  }
  auto const taken = [&](Index3 const& cell) {
    return region.inside(cell) || std::binary_search(near.begin(), near.end(), cell);
  };
  for (auto const& [section, shape] : charge_shapes_) {
    auto place = wrong_place(shape, false, taken, around);
    // One between the places that are looked at is small, and its middle counts.
    Vec3 const middle = shape::centre(shape);
    Index3 cell{0, 0, 0};
    for (int d = 0; d < dims(); ++d) {
      cell[d] = std::clamp(static_cast<int>(std::floor((middle[d] - out_.domain.lower[d]) / out_.domain.h)), 0,
                           out_.domain.cells[d] - 1);
    }
    if (!place && taken(cell)) place = middle;
    if (!place) continue;
    error(*section, place_key(*section),
          fmt::format("the charge reaches at {} m into the MPM region or the 3 cells beside it: move it, make the "
                      "region smaller, or write the charge as a [[body]] of its explosive",
                      point_text(*place, dims())));
  }
  auto const* obstacles = deck_.sections("obstacle");
  setup::SolidCells const solid(out_.domain, out_.obstacles);
  for (auto const& [index, shape] : obstacle_shapes_) {
    std::optional<Vec3> place;
    shape::for_each_share({shape}, out_.domain, shape::cells_around(shape, out_.domain),
                          [&](shape::CellRange const& r, std::vector<shape::Share> const&) {
                            for (int k = r.lower[2]; k < r.upper[2] && !place; ++k) {
                              for (int j = r.lower[1]; j < r.upper[1] && !place; ++j) {
                                for (int i = r.lower[0]; i < r.upper[0] && !place; ++i) {
                                  if (taken({i, j, k}) && solid({i, j, k})) place = out_.domain.centre({i, j, k});
                                }
                              }
                            }
                            return !place;
                          });
    if (!place) continue;
    error((*obstacles)[index], place_key((*obstacles)[index]),
          fmt::format("the obstacle reaches at {} m into the MPM region or the 3 cells beside it: move it, make the "
                      "region smaller, or write the obstacle as a [[body]] with rigid = true",
                      point_text(*place, dims())));
  }
}

void Builder::check_body_place(bridge::Region const& region, std::size_t index) {
  int const keep = region.width() + 2;
  auto const place =
      wrong_place(*body_shapes_[index], false, [&](Index3 const& cell) { return region.layer(cell) <= keep; });
  if (!place) return;
  Section const& section = (*deck_.sections("body"))[index];
  Index3 cell{0, 0, 0};
  for (int d = 0; d < dims(); ++d) {
    cell[d] = static_cast<int>(std::floor((((*place)[d]) - out_.domain.lower[d]) / out_.domain.h));
  }
  int const layer = region.layer(cell);
  error(section, place_key(section),
        fmt::format("the body reaches at {} m {}: solids keep at least {} cells = {:.6g} m (width + 2) away from the "
                    "faces of the region; make the region larger, or the bridge narrower (mpm_region.width)",
                    point_text(*place, dims()),
                    layer == 0 ? std::string("out of the MPM region")
                               : fmt::format("into cell {} from a face of the MPM region", layer),
                    keep, keep * out_.domain.h));
}

}  // namespace brisance::deck
