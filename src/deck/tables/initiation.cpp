/// Points of initiation of charges and bodies.
#include <fmt/format.h>

#include <algorithm>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/places.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Settings<run::InitiationPoint> const& settings() {
  using P = run::InitiationPoint;
  static Settings<P> const all{
      position("position").note("the charge's `position`").like("[0, 0, 1.5]").means("Location"),
      {&P::delay, number("delay", "s", 0.0, longest).like("\"2 us\"").means("Time of initiation, after the start")}};
  return all;
}

}  // namespace

Table const& initiation_table() {
  static Table const table{"A point of initiation.", settings().keys(), {}, {}};
  return table;
}

bool build_initiation(Draft& draft, Section const& section, shape::Shape const& body, char const* what,
                      run::Detonation& detonation, std::vector<run::InitiationPoint>& particles) {
  auto const word = section.text("detonation");
  if (!word || section.broken("initiation")) return false;
  choose(section, "detonation", detonation);
  auto const* all = section.sections("initiation");
  // A body may be hollow.
  auto const middle_is_explosive = [&](Section const& blamed, std::string_view key) {
    if (!draft.domain_known || shape::contains(body, draft.out.domain, shape::centre(body))) return true;
    draft.report.error(blamed.place_of(key), blamed.path_of(key),
                       fmt::format("there is no explosive at the centre of the {}, {} m: give a position within the "
                                   "explosive, initiation = [{{position = [...]}}]",
                                   what, point_text(shape::centre(body), draft.dims())));
    return false;
  };
  if (detonation == run::Detonation::instantaneous) {
    if (all == nullptr) return true;
    draft.error(
        section, "initiation",
        "an instantaneous detonation has no points of initiation: remove them, or write detonation = \"programmed\"");
    return false;
  }
  if (all == nullptr || all->empty()) {
    if (!middle_is_explosive(section, "initiation")) return false;
    particles.push_back({shape::centre(body), 0.0});
    return true;
  }
  bool sound = true;
  for (auto const& given : *all) {
    run::InitiationPoint p{shape::centre(body), 0.0};
    if (!settings().read(given, p) || given.broken("position")) {
      sound = false;
      continue;
    }
    if (given.given("position")) {
      auto const position = draft.point(given, "position");
      if (!position) {
        sound = false;
        continue;
      }
      p.position = *position;
      // A point on the surface counts as inside: it is moved towards the middle by a round-off length.
      Vec3 const inward = shape::centre(body) - p.position;
      double const distance = norm(inward);
      Vec3 const moved =
          distance > 0.0 ? p.position + std::min(1.0, 1e-3 * draft.out.domain.h / distance) * inward : p.position;
      if (!shape::contains(body, draft.out.domain, p.position) && !shape::contains(body, draft.out.domain, moved)) {
        auto const b = shape::bounds(body);
        draft.error(given, "position",
                    fmt::format("{} lies outside the {}, which extends from {} to {} m: move the point inside",
                                given.shown("position"), what, point_text(b.lower, draft.dims()),
                                point_text(b.upper, draft.dims())));
        sound = false;
        continue;
      }
    } else if (!middle_is_explosive(given, "position")) {
      sound = false;
      continue;
    }
    particles.push_back(p);
  }
  if (!particles.empty()) {
    auto const first = std::min_element(particles.begin(), particles.end(),
                                        [](auto const& a, auto const& b) { return a.delay < b.delay; });
    draft.onsets.push_back({&section, first->delay, "initiation", "never detonates"});
  }
  return sound;
}

}  // namespace brisance::deck
