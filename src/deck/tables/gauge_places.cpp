/// Where gauges on obstacles stand.
#include "deck/tables/gauge_places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brisance::deck {

namespace {

/// The point of a cell's face that is nearest to p.
Vec3 nearest_of_face(grid::Domain const& domain, Index3 const& cell, int face, Vec3 const& p) {
  Vec3 x = domain.centre(cell);
  for (int d = 0; d < domain.dimensions(); ++d) {
    double const half = 0.5 * domain.h;
    x[d] = d != face / 2 ? std::clamp(p[d], x[d] - half, x[d] + half) : x[d] + (face % 2 == 0 ? -half : half);
  }
  return x;
}

/// Does gas lie behind a face of a cell?
bool gas_behind(grid::Domain const& domain, setup::SolidCells const& solid, Index3 cell, int face) {
  cell[face / 2] += face % 2 == 0 ? -1 : 1;
  return cell[face / 2] >= 0 && cell[face / 2] < domain.cells[face / 2] && !solid(cell);
}

double distance(Vec3 const& a, Vec3 const& b, int dimensions) {
  double square = 0.0;
  for (int d = 0; d < dimensions; ++d) square += (a[d] - b[d]) * (a[d] - b[d]);
  return std::sqrt(square);
}

}  // namespace

std::optional<Vec3> middle_of_obstacle(grid::Domain const& domain, setup::SolidCells const& solid, std::size_t obstacle,
                                       int face) {
  shape::Box const box = shape::bounds(solid.shapes()[obstacle]);
  int const dims = domain.dimensions();
  Vec3 middle{0.0, 0.0, 0.0};
  for (int d = 0; d < dims; ++d) {
    double const low = std::max(box.lower[d], domain.lower[d]);
    double const high = std::min(box.upper[d], domain.upper(d));
    middle[d] = d != face / 2 ? 0.5 * (low + high) : face % 2 == 0 ? low : high;
  }
  std::optional<Vec3> nearest;
  for (Index3 const& cell : solid.cells_of(obstacle)) {
    if (!gas_behind(domain, solid, cell, face)) continue;
    Vec3 const x = nearest_of_face(domain, cell, face, middle);
    if (!nearest || distance(x, middle, dims) < distance(*nearest, middle, dims) - 1e-9 * domain.h) nearest = x;
  }
  return nearest;
}

std::optional<Vec3> nearest_face(grid::Domain const& domain, setup::SolidCells const& solid, Vec3 const& p) {
  int const dims = domain.dimensions();
  Index3 at{0, 0, 0};
  for (int d = 0; d < dims; ++d)
    at[d] = std::clamp(static_cast<int>((p[d] - domain.lower[d]) / domain.h), 0, domain.cells[d] - 1);
  int const farthest = std::max({domain.cells[0], domain.cells[1], domain.cells[2]});
  std::optional<Vec3> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (int ring = 0; ring <= farthest && (ring - 1) * domain.h < least; ++ring) {
    grid::CellRange const cube = common(grid::around(at, ring, dims), domain.all_cells());
    for_each_cell(cube, [&](Index3 const& cell) {
      int far = 0;
      for (int d = 0; d < dims; ++d) far = std::max(far, std::abs(cell[d] - at[d]));
      if (far != ring || !solid(cell)) return;
      for (int face = 0; face < 2 * dims; ++face) {
        Vec3 const x = nearest_of_face(domain, cell, face, p);
        double const away = distance(x, p, dims);
        if (away >= least - 1e-9 * domain.h || !gas_behind(domain, solid, cell, face)) continue;
        least = away;
        nearest = x;
      }
    });
  }
  return nearest;
}

}  // namespace brisance::deck
