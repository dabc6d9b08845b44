/// How far a burst may spread before it meets something.
#include "setup/reach.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "setup/place_region.hpp"
#include "setup/solid_cells.hpp"

namespace brisance::setup {

namespace {

double charge_radius(shape::Shape const& shape) {
  if (auto const* s = std::get_if<shape::Sphere>(&shape)) return s->radius;
  if (auto const* h = std::get_if<shape::Hemisphere>(&shape)) return h->radius;
  if (auto const* c = std::get_if<shape::Cylinder>(&shape)) return c->radius;
  return 0.0;
}

/// Distance of a particle from a cell, in the resolved directions.
double distance_to_cell(grid::Domain const& domain, Index3 const& cell, Vec3 const& x) {
  double sum = 0.0;
  for (int d = 0; d < domain.dimensions(); ++d) {
    double const low = domain.face(d, cell[d]);
    double const away = std::max({low - x[d], x[d] - low - domain.smallest_cell(), 0.0});
    sum += away * away;
  }
  return std::sqrt(sum);
}

/// Distance of a particle from the nearest solid cell that an obstacle reaches into; `bound` where none is nearer.
double distance_to_obstacle(grid::Domain const& domain, SolidCells const& solid, shape::Shape const& shape,
                            Vec3 const& x, double bound) {
  shape::CellRange range = shape::cells_around(shape, domain);
  for (int d = 0; d < domain.dimensions(); ++d) {
    auto const cell = [&](double y) {
      double const at = std::floor(domain.in_cells(d, y));
      return static_cast<int>(std::clamp(at, 0.0, domain.cells[d] - 1.0));
    };
    range.lower[d] = std::max(range.lower[d], cell(x[d] - bound));
    range.upper[d] = std::min(range.upper[d], cell(x[d] + bound) + 1);
  }
  grid::for_each_cell(range, [&](Index3 const& cell) {
    double const distance = distance_to_cell(domain, cell, x);
    if (distance >= bound || shape::shares_of_cell({shape}, domain, cell).empty()) return;
    if (solid(cell)) bound = distance;
  });
  return bound;
}

}  // namespace

Reach reach_of(Case const& setup, std::size_t number, bool with_gauges, int grounded) {
  grid::Domain const& domain = setup.domain;
  double const h = domain.smallest_cell();
  int const dims = domain.dimensions();
  Vec3 centre = shape::centre(setup.charges[number].shape);
  for (int d = dims; d < 3; ++d) centre[d] = 0.0;
  auto const planes = detonation::planes_through(domain, centre);
  Reach reach{std::numeric_limits<double>::infinity(), ""};
  auto const bound = [&](double radius, std::string const& by) {
    if (radius < reach.radius) reach = {radius, by};
  };
  for (int f = 0; f < 2 * dims; ++f) {
    int const d = f / 2;
    if (f == grounded || (f == 0 && grid::radial_exponent(domain.geometry) > 0)) continue;
    double const plane = f % 2 == 0 ? domain.lower[d] : domain.upper(d);
    if (planes[d] == (f % 2 == 0 ? 1 : -1)) continue;
    bound(std::abs(plane - centre[d]) - h, fmt::format("the face {} of the domain", grid::face_names[f]));
  }
  // Gauges lie between the centres of cells: the cells around them stay ambient.
  for (std::size_t g = 0; with_gauges && g < setup.gauges.size(); ++g) {
    Vec3 away = setup.gauges[g].position - centre;
    for (int d = dims; d < 3; ++d) away[d] = 0.0;
    bound(norm(away) - 2.0 * h, fmt::format("gauge \"{}\"", setup.gauges[g].name));
  }
  for (std::size_t other = 0; other < setup.charges.size(); ++other) {
    if (other == number) continue;
    Vec3 away = shape::centre(setup.charges[other].shape) - centre;
    for (int d = dims; d < 3; ++d) away[d] = 0.0;
    // The bursts share the way between them by the sizes of the charges.
    double const own = charge_radius(setup.charges[number].shape);
    double const fraction = own / (own + charge_radius(setup.charges[other].shape));
    bound(fraction * norm(away) - h, fmt::format("the blast wave of charge {}", other + 1));
  }
  SolidCells const solid(domain, setup.obstacles);
  for (Obstacle const& obstacle : setup.obstacles) {
    double const distance = distance_to_obstacle(domain, solid, obstacle.shape, centre, reach.radius + h);
    bound(distance - h, fmt::format("obstacle \"{}\"", obstacle.name));
  }
  for (std::size_t r = 0; r < setup.mpm_regions.size(); ++r) {
    // Three layers of cells around the region act as its particles.
    constexpr double room = 5.0;
    double nearest = reach.radius + room * h;
    bridge::Region const region = region_of(setup, r);
    grid::Domain const fine = setup.region_domain(r);
    for (Index3 const& cell : region.cells()) nearest = std::min(nearest, distance_to_cell(fine, cell, centre));
    bound(nearest - room * h, "the MPM region");
  }
  return reach;
}

}  // namespace brisance::setup
