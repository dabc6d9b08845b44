/// What splitting and merging share: a set of gas particles by names and by cells.
#pragma once

#include <array>

#include "mpm/patches.hpp"
#include "mpm/population.hpp"

namespace brisance::mpm {

/// The particles of a set by cell: `cell` and `start`.
void sort_by_cell(ParticleSet const& gas, Patch const& patch, PopulationScratch& s);

/// Fills `sorted`; needs `sort_by_cell`, leaves `start` as it was.
void list_particles(PopulationScratch& s);

/// Particles of a cell beyond which it is crowded.
[[nodiscard]] int crowd_of(PopulationPlace const& place, PopulationOptions const& options);

/// A set with the names that splitting and merging need.
struct GasSet {
  GasSet(ParticleSet& set_, PopulationPlace const& place)
      : set(&set_),
        metric(&place.grid->blocks()[place.block].metric),
        h(metric->h),
        particles_per_direction(place.particles_per_direction),
        lit_before(place.lit_before) {
    find();
  }
  /// Anew after particles were appended.
  void find() {
    for (int d = 0; d < 3; ++d) {
      x[d] = set->field(Field::position_x + d);
      v[d] = set->field(Field::velocity_x + d);
    }
    mass = set->field(Field::mass);
    density = set->field(Field::density);
    pressure = set->field(Field::pressure);
    energy = set->field(Field::energy);
    lighting = set->field(Field::lighting_time);
    fraction = set->field(Field::volume_fraction);
  }
  [[nodiscard]] double volume(int q) const { return mass[q] / density[q]; }
  [[nodiscard]] double standard(int q) const { return standard_volume(*metric, particles_per_direction, x[0][q]); }
  [[nodiscard]] bool burnt(int q) const { return lighting == nullptr || lighting[q] <= lit_before; }

  ParticleSet* set;
  grid::Metric const* metric;
  double h;  ///< size of the block's cells [m]
  int particles_per_direction;
  double lit_before;
  std::array<double*, 3> x{};
  std::array<double*, 3> v{};
  double* mass = nullptr;
  double* density = nullptr;
  double* pressure = nullptr;
  double* energy = nullptr;
  double* lighting = nullptr;
  double* fraction = nullptr;
};

}  // namespace brisance::mpm
