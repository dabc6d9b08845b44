/// Several MPM regions: which bodies each of them holds, and what they must leave to each other.
#include <fmt/format.h>

#include <algorithm>

#include "deck/draft.hpp"
#include "deck/places.hpp"
#include "deck/tables/tables.hpp"
#include "setup/region_gaps.hpp"

namespace brisance::deck {

namespace {

constexpr std::size_t most_regions = 100;

/// The boxes of a region as far as they can be read; what is wrong with them is reported elsewhere.
std::vector<shape::Box> boxes_of(Draft const& draft, Section const& region) {
  std::vector<shape::Box> boxes;
  auto const add = [&](Section const& given) {
    auto const* lower = given.numbers("lower");
    auto const* upper = given.numbers("upper");
    auto const dims = static_cast<std::size_t>(draft.dims());
    if (lower == nullptr || upper == nullptr || lower->size() < dims || upper->size() < dims) return;
    shape::Box box;
    for (std::size_t d = 0; d < dims; ++d) {
      box.lower[d] = (*lower)[d];
      box.upper[d] = (*upper)[d];
    }
    boxes.push_back(box);
  };
  if (Section const* one = region.section("box")) add(*one);
  if (auto const* several = region.sections("boxes")) {
    for (Section const& given : *several) add(given);
  }
  return boxes;
}

bool reaches_into(Draft const& draft, shape::Shape const& body, shape::Box const& box) {
  shape::Box const common = overlap(shape::bounds(body), box);
  for (int d = 0; d < draft.dims(); ++d) {
    if (common.upper[d] - common.lower[d] <= draft.tiny()) return false;
  }
  return true;
}

/// Numbers of the bodies that a region names.
std::vector<int> named_bodies(Draft& draft, Section const& region) {
  std::vector<int> bodies;
  auto const* names = region.strings("bodies");
  if (names == nullptr) return bodies;
  for (std::string const& name : *names) {
    auto const body = body_named(draft, region, "bodies", name);
    if (!body) {
      draft.bodies_assigned = false;
      continue;
    }
    if (std::ranges::find(bodies, *body) == bodies.end()) {
      bodies.push_back(*body);
    } else {
      draft.error(region, "bodies", fmt::format("\"{}\" is named twice: remove one of the two", name));
    }
  }
  return bodies;
}

/// The regions that name a body or that it reaches into, of those that name none.
std::vector<std::size_t> regions_of(Draft const& draft, std::vector<std::vector<int>> const& named, std::size_t body) {
  std::vector<std::size_t> found;
  auto const& sections = draft.region_sections();
  for (std::size_t n = 0; n < sections.size(); ++n) {
    if (sections[n].given("bodies")) {
      if (std::ranges::find(named[n], static_cast<int>(body)) != named[n].end()) found.push_back(n);
      continue;
    }
    auto const& shape = draft.body_shapes[body];
    if (shape && std::ranges::any_of(boxes_of(draft, sections[n]),
                                     [&](shape::Box const& box) { return reaches_into(draft, *shape, box); }))
      found.push_back(n);
  }
  return found;
}

/// Gas and particles of all regions take common steps.
void check_common_keys(Draft const& draft) {
  auto const& sections = draft.region_sections();
  auto const& regions = draft.out.mpm_regions;
  for (std::size_t n = 1; n < regions.size(); ++n) {
    if (regions[n].subcycling == regions[0].subcycling) continue;
    Section const& blamed = sections[n].given("subcycling") ? sections[n] : sections[0];
    draft.error(blamed, "subcycling",
                fmt::format("{} has {} and {} has {}, but gas and particles of all regions meet after common steps: "
                            "give all regions the same value",
                            sections[0].path, regions[0].subcycling, sections[n].path, regions[n].subcycling));
    return;
  }
}

}  // namespace

void assign_bodies(Draft& draft) {
  auto const& sections = draft.region_sections();
  std::size_t const bodies = draft.body_names.size();
  draft.body_regions.assign(bodies, 0);
  if (sections.size() > most_regions) {
    draft.error(draft.deck, "mpm_region",
                fmt::format("there are {} MPM regions; allowed: at most {}", sections.size(), most_regions));
    draft.bodies_assigned = false;
    return;
  }
  std::vector<std::vector<int>> named;
  for (Section const& region : sections) {
    named.push_back(named_bodies(draft, region));
    if (region.broken("bodies") || region.doubtful()) draft.bodies_assigned = false;
  }
  bool const told = std::ranges::any_of(sections, [](Section const& region) { return region.given("bodies"); });
  if (!draft.bodies_assigned || (sections.size() < 2 && !told)) return;
  for (std::size_t body = 0; body < bodies; ++body) {
    Section const& section = (*draft.deck.sections("body"))[body];
    auto const found = regions_of(draft, named, body);
    if (!found.empty()) draft.body_regions[body] = static_cast<int>(found.front());
    if (found.size() == 1) continue;
    draft.bodies_assigned = false;
    if (!draft.body_shapes[body]) continue;  // reported
    if (found.empty()) {
      draft.error(
          section, place_key(section),
          fmt::format("body \"{}\" is in no MPM region: name it in `bodies` of one of them, or put a box around "
                      "it",
                      draft.body_names[body]));
    } else {
      draft.error(
          section, place_key(section),
          fmt::format("body \"{}\" is in {} and in {}, but a body belongs to one MPM region: name it in `bodies` "
                      "of one of them only, or separate their boxes",
                      draft.body_names[body], sections[found[0]].path, sections[found[1]].path));
    }
  }
}

void check_together(Draft const& draft, std::vector<bridge::Region> const& regions) {
  check_common_keys(draft);
  auto const conflict = setup::conflict_of(draft.out, regions);
  if (!conflict) return;
  Section const& section = draft.region_sections()[conflict->second];
  draft.error(section,
              section.given("boxes")    ? "boxes"
              : section.given("bodies") ? "bodies"
                                        : "box",
              conflict->problem);
}

}  // namespace brisance::deck
