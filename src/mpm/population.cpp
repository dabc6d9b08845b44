#include "mpm/population.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "mpm/cells.hpp"
#include "mpm/population_set.hpp"

namespace brisance::mpm {

void sort_by_cell(ParticleSet const& gas, Patch const& patch, PopulationScratch& s) {
  find_cells(gas, patch, s.cell);
  find_starts(s.cell, patch.cell_range().count(), s.start);
}

void list_particles(PopulationScratch& s) {
  s.sorted.resize(s.cell.size());
  for (std::size_t q = s.cell.size(); q-- > 0;) {
    s.sorted[--s.start[s.cell[q] + 1]] = static_cast<int>(q);
  }
  // Every entry now holds the start of the cell before it.
  std::copy(s.start.begin() + 1, s.start.end(), s.start.begin());
  s.start.back() = static_cast<int>(s.cell.size());
}

int crowd_of(PopulationPlace const& place, PopulationOptions const& options) {
  int standard = 1;
  for (int d = 0; d < place.patch->dimensions; ++d) standard *= place.particles_per_direction;
  return static_cast<int>(options.crowd * standard);
}

double standard_volume(grid::Metric const& metric, int particles_per_direction, double r) {
  double const side = metric.h / particles_per_direction;
  // Nearer to the axis than half its size a ring would vanish.
  double const radius = std::max(std::abs(r), 0.5 * side);
  switch (metric.geometry) {
    case grid::Geometry::cartesian3d: return side * side * side;
    case grid::Geometry::planar2d: return side * side;
    case grid::Geometry::planar1d: return side;
    case grid::Geometry::axisymmetric2d: return 2.0 * std::numbers::pi * radius * side * side;
    case grid::Geometry::cylindrical1d: return 2.0 * std::numbers::pi * radius * side;
    case grid::Geometry::spherical1d: return 4.0 * std::numbers::pi * (radius * radius + side * side / 12.0) * side;
  }
  return 0.0;
}

void check(PopulationOptions const& options) {
  auto const at_least = [](char const* name, double value, double bound, char const* why) {
    if (value >= bound) return;
    throw InputError(fmt::format("splitting and merging of material points: {} = {:.6g} is below {:.6g} ({})", name,
                                 value, bound, why));
  };
  at_least("split_volume", options.split_volume, 1.25, "standard particles would split immediately; 2 is usual");
  at_least("crowd", options.crowd, 1.5, "a cell of standard particles would count as crowded; 4 is usual");
  at_least("mass_ratio", options.mass_ratio, 2.0, "the halves of a particle would merge again; 8 is usual");
  at_least("small_volume", options.small_volume, 0.0, "0 disables merging of light particles; 0.5 is usual");
  at_least("composition", options.composition, 0.1, "the number of particles in a mixed cell would be unbounded");
  at_least("pressure_ratio", options.pressure_ratio, 1.0, "the ratio of the larger to the smaller value; 1.2 is usual");
  at_least("density_ratio", options.density_ratio, 1.0, "the ratio of the larger to the smaller value; 2 is usual");
  at_least("speed", options.speed, 0.0, "a magnitude; 0.35 is usual");
}

}  // namespace brisance::mpm
