#include "setup/region_gaps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "setup/levels.hpp"
#include "setup/place_region.hpp"

namespace brisance::setup {

namespace {

/// A box of cells of a level in lengths [m].
shape::Box box_of(grid::Domain const& domain, bridge::CellBox const& cells) {
  shape::Box box;
  for (int d = 0; d < domain.dimensions(); ++d) {
    box.lower[d] = domain.face(d, cells.lower[d]);
    box.upper[d] = domain.face(d, cells.upper[d]);
  }
  return box;
}

/// Distance along a direction; negative where the boxes overlap. Across periodic faces it may be shorter.
double distance_along(grid::Domain const& domain, int d, shape::Box const& a, shape::Box const& b) {
  double const apart = std::max(a.lower[d] - b.upper[d], b.lower[d] - a.upper[d]);
  if (domain.boundary[2 * d] != grid::Boundary::periodic) return apart;
  double const length = domain.upper(d) - domain.lower[d];
  double const around = length - (std::max(a.upper[d], b.upper[d]) - std::min(a.lower[d], b.lower[d]));
  return std::min(apart, around);
}

/// Smallest distance of the boxes of two regions [m]; negative where they overlap.
double distance(bridge::Region const& first, bridge::Region const& second) {
  double least = std::numeric_limits<double>::infinity();
  for (bridge::CellBox const& a : first.boxes()) {
    for (bridge::CellBox const& b : second.boxes()) {
      double most = -std::numeric_limits<double>::infinity();
      for (int d = 0; d < first.domain().dimensions(); ++d) {
        most = std::max(most, distance_along(first.domain(), d, box_of(first.domain(), a), box_of(second.domain(), b)));
      }
      least = std::min(least, most);
    }
  }
  return least;
}

std::string advice(int cells, double cell) {
  return fmt::format(
      "between two MPM regions there must be at least {} cells of gas, of the larger ones: {:.6g} m; move them apart, "
      "make them smaller, or join them to one region with `boxes`",
      cells, cells * cell);
}

}  // namespace

int least_gap_of_regions(Case const& setup) { return bridge::least_gap + proxy_reach(setup); }

std::optional<RegionConflict> conflict_of(Case const& setup, std::vector<bridge::Region> const& regions) {
  int const cells = least_gap_of_regions(setup);
  for (std::size_t second = 1; second < regions.size(); ++second) {
    for (std::size_t first = 0; first < second; ++first) {
      double const cell = std::max(regions[first].metric().h, regions[second].metric().h);
      double const apart = distance(regions[first], regions[second]);
      if (apart >= cells * cell * (1.0 - 1e-9)) continue;
      std::string const where =
          apart < -1e-9 * cell
              ? fmt::format("MPM regions {} and {} overlap", first + 1, second + 1)
              : fmt::format("MPM regions {} and {} are {:.6g} m apart", first + 1, second + 1, std::max(apart, 0.0));
      return RegionConflict{first, second, fmt::format("{}; {}", where, advice(cells, cell))};
    }
  }
  auto const mixed = regions_without_own_blocks(setup);
  if (!mixed) return std::nullopt;
  auto const [first, second] = *mixed;
  return RegionConflict{
      first, second,
      fmt::format(
          "MPM regions {} and {}, with cells of {:.6g} m and {:.6g} m, are too near to each other: around each of "
          "them there are {} layers of its own cells, and a block of cells has one size: move them apart, give "
          "them the same `cell`, or make the blocks smaller (numerics.block_cells)",
          first + 1, second + 1, regions[first].metric().h, regions[second].metric().h,
          level_margin + proxy_reach(setup))};
}

}  // namespace brisance::setup
