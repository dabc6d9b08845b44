/// What does not go with the place of an MPM region: bodies, charges and obstacles.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "deck/draft.hpp"
#include "deck/places.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

constexpr int samples = 4;  ///< per cell and direction, where shapes are looked for

/// Where the shape meets cells that are wrong for it, in a box where that is enough; nothing: nowhere.
template <class Wrong>
std::optional<Vec3> wrong_place(Draft const& draft, grid::Domain const& domain, shape::Shape const& shape,
                                Wrong&& wrong, std::optional<shape::Box> const& within = {}) {
  auto bounds = shape::bounds(shape);
  for (int d = 0; within && d < draft.dims(); ++d) {
    bounds.lower[d] = std::max(bounds.lower[d], within->lower[d]);
    bounds.upper[d] = std::min(bounds.upper[d], within->upper[d]);
    if (bounds.upper[d] < bounds.lower[d]) return std::nullopt;
  }
  Index3 first{0, 0, 0};
  Index3 last{0, 0, 0};
  for (int d = 0; d < draft.dims(); ++d) {
    auto const cell = [&](double x) {
      return static_cast<int>(std::floor(std::clamp((x - domain.lower[d]) / domain.h, 0.0, domain.cells[d] - 0.5)));
    };
    first[d] = cell(bounds.lower[d] + draft.tiny());
    last[d] = cell(bounds.upper[d] - draft.tiny());
  }
  int const parts = samples;
  Index3 count{1, 1, 1};
  for (int d = 0; d < draft.dims(); ++d) count[d] = parts;
  for (int k = first[2]; k <= last[2]; ++k) {
    for (int j = first[1]; j <= last[1]; ++j) {
      for (int i = first[0]; i <= last[0]; ++i) {
        Index3 const cell{i, j, k};
        if (!wrong(cell)) continue;
        for (int n = 0; n < count[0] * count[1] * count[2]; ++n) {
          Index3 const part{n % count[0], n / count[0] % count[1], n / (count[0] * count[1])};
          Vec3 x = domain.centre(cell);
          for (int d = 0; d < draft.dims(); ++d) x[d] += ((part[d] + 0.5) / parts - 0.5) * domain.h;
          if (shape::contains(shape, domain, x)) return x;
        }
      }
    }
  }
  return std::nullopt;
}

void check_body_place(Draft const& draft, bridge::Region const& region, std::size_t index) {
  int const keep = region.width() + 2;
  grid::Domain const domain = draft.particle_domain(static_cast<int>(index));
  auto const place = wrong_place(draft, domain, *draft.body_shapes[index],
                                 [&](Index3 const& cell) { return region.layer(cell) <= keep; });
  if (!place) return;
  Section const& section = (*draft.deck.sections("body"))[index];
  Index3 cell{0, 0, 0};
  for (int d = 0; d < draft.dims(); ++d) cell[d] = static_cast<int>(std::floor(domain.in_cells(d, (*place)[d])));
  int const layer = region.layer(cell);
  draft.error(
      section, place_key(section),
      fmt::format("at {} m the body extends {}: solids must stay at least {} cells = {:.6g} m (width + 2) away from "
                  "the faces of the MPM region; enlarge the MPM region, or make the bridge narrower (mpm_region.width)",
                  point_text(*place, draft.dims()),
                  layer == 0 ? std::string("beyond the MPM region")
                             : fmt::format("into cell {} from a face of the MPM region", layer),
                  keep, keep * domain.h));
}

}  // namespace

void check_mpm_region(Draft const& draft, bridge::Region const& region, std::size_t number) {
  for (int const body : draft.out.bodies_of(number)) check_body_place(draft, region, static_cast<std::size_t>(body));
  grid::Domain const domain = draft.out.region_domain(number);
  // The region and the cells beside it that act as particles.
  std::vector<Index3> near;
  for (Index3 const& cell : region.proxy_cells()) near.push_back(region.clamped(cell));
  std::sort(near.begin(), near.end());
  // Elsewhere nothing is wrong, and a large charge is not looked through there.
  shape::Box around;
  around.lower = {1e300, 1e300, 1e300};
  around.upper = {-1e300, -1e300, -1e300};
  for (auto const* cells : {&region.cells(), &region.proxy_cells()}) {
    for (Index3 const& cell : *cells) {
      for (int d = 0; d < draft.dims(); ++d) {
        double const low = domain.face(d, cell[d]);
        around.lower[d] = std::min(around.lower[d], low);
        around.upper[d] = std::max(around.upper[d], low + domain.h);
      }
    }
  }
  auto const taken = [&](Index3 const& cell) {
    return region.inside(cell) || std::binary_search(near.begin(), near.end(), cell);
  };
  for (auto const& [section, shape] : draft.charge_shapes) {
    auto place = wrong_place(draft, domain, shape, taken, around);
    // One between the places that are looked at is small, and its middle counts.
    Vec3 const middle = shape::centre(shape);
    Index3 cell{0, 0, 0};
    for (int d = 0; d < draft.dims(); ++d) {
      cell[d] = std::clamp(static_cast<int>(std::floor(domain.in_cells(d, middle[d]))), 0, domain.cells[d] - 1);
    }
    if (!place && taken(cell)) place = middle;
    if (!place) continue;
    draft.error(*section, place_key(*section),
                fmt::format("at {} m the charge extends into the MPM region or the 3 cells next to it: move it, make "
                            "the MPM region smaller, or write the charge as a [[body]] of its explosive",
                            point_text(*place, draft.dims())));
  }
  auto const* obstacles = draft.deck.sections("obstacle");
  setup::SolidCells const solid(domain, draft.out.obstacles);
  for (auto const& [index, shape] : draft.obstacle_shapes) {
    std::optional<Vec3> place;
    shape::for_each_share({shape}, domain,
                          grid::common(shape::cells_around(shape, domain), shape::cells_around(around, domain)),
                          [&](shape::CellRange const& r, std::vector<shape::Share> const&) {
                            for (int k = r.lower[2]; k < r.upper[2] && !place; ++k) {
                              for (int j = r.lower[1]; j < r.upper[1] && !place; ++j) {
                                for (int i = r.lower[0]; i < r.upper[0] && !place; ++i) {
                                  if (taken({i, j, k}) && solid({i, j, k})) place = domain.centre({i, j, k});
                                }
                              }
                            }
                            return !place;
                          });
    if (!place) continue;
    draft.error((*obstacles)[index], place_key((*obstacles)[index]),
                fmt::format("at {} m the obstacle extends into the MPM region or the 3 cells next to it: move it, make "
                            "the MPM region smaller, or write the obstacle as a [[body]] with rigid = true",
                            point_text(*place, draft.dims())));
  }
}

}  // namespace brisance::deck
