/// How many points a gas has: particles that stretched too far split, particles that crowd a cell merge, so that
/// neither the cells of an expanding gas run empty nor those of a compressed one overflow.
#pragma once

#include <limits>
#include <vector>

#include "grid/grid.hpp"
#include "mpm/particles.hpp"

namespace brisance::mpm {

struct Outbox;
struct Patch;

/// When particles split and merge. A standard particle fills 1/n^D of its cell, n particles per direction.
struct PopulationOptions {
  /// A particle splits above this many standard volumes. The halves then are standard particles; with two particles per
  /// direction none gets longer than a cell, which is what splines and GIMP need, and all that GIMP can represent.
  double split_volume = 2.0;
  /// Cells with more than this many times the standard number of particles merge some. A strong shock in a gas of gamma
  /// = 1.4 compresses to 6, detonation products seldom above 2: the shock itself should keep its particles.
  double crowd = 4.0;
  /// Particles lighter by this factor than the heaviest of their cell merge, where they also fill less than
  /// `small_volume` standard volumes. A light particle of full size is needed where it is: at a contact or in a
  /// rarefaction.
  double mass_ratio = 8.0;
  double small_volume = 0.5;
  /// Particles of one place may merge; states that differ more than this may not. The difference of the volume
  /// fractions, the ratios of pressures and of densities, and the relative speed in units of sqrt(p/rho), 0.85 of the
  /// sound speed of air.
  double composition = 0.1;
  double pressure_ratio = 1.2;
  double density_ratio = 2.0;
  double speed = 0.35;
};

/// Throws InputError when the criteria contradict each other.
void check(PopulationOptions const& options);

struct PopulationCount {
  long split = 0;
  long merged = 0;
  /// Kinetic energy that merging turned into heat, less what splitting with APIC took out of it [J].
  double heat = 0.0;
};

/// The block that a set of particles belongs to, and its body.
struct PopulationPlace {
  grid::Grid const* grid;
  int block;
  Patch const* patch;
  int particles_per_direction;
  /// Particles of an explosive that are lit later are left alone: they are not a gas yet [s].
  double lit_before = std::numeric_limits<double>::max();
};

/// How a particle splits.
struct SplitWay {
  int direction = 0;
  double offset = 0.0;  ///< of the halves to both sides [m]
};

/// Memory of one thread.
struct PopulationScratch {
  std::vector<int> cell;       ///< of each particle
  std::vector<int> start;      ///< of each cell in `sorted`
  std::vector<int> sorted;     ///< particles cell by cell
  std::vector<double> light;   ///< per cell: particles below this mass are light
  std::vector<int> due;        ///< points to split, cells to thin out, points to keep
  std::vector<SplitWay> ways;  ///< of the points to split
  std::vector<int> members;
  std::vector<int> stuck;
  std::vector<char> busy;  ///< per cell: something is to merge
  std::vector<char> gone;  ///< per particle: merged
};

/// Splits every particle above the largest volume, again until none is left. The two halves have half the mass and the
/// same state; they stand where a row of twice as many points would have them, along the direction with the largest
/// gaps to the neighbours (cpGIMP: along the particle's longest side). With APIC their velocity follows the particle's
/// own gradient, and the kinetic energy of that comes out of the internal energy, of which it may be a hundredth. A
/// half that falls into a neighbouring block goes to `out`. New particles have the identity -1. All sums are kept:
/// mass, momentum, angular momentum, centre, energy, volume and both fluids. Afterwards no particle is above the bound,
/// except on a face of the domain, where there is no room, and in a crowded cell (crowd n^D particles or more), where
/// the halves would merge at once.
PopulationCount split_particles(ParticleSet& gas, PopulationPlace const& place, PopulationOptions const& options,
                                PopulationScratch& scratch, Outbox& out);

/// Merges pairs of particles of one cell: light ones into their nearest neighbour, and where the cell is crowded those
/// pairs whose merging changes the second moment of the mass least. Sums are kept as in `split_points`, but for the
/// angular momentum of the relative motion; its energy becomes heat. The pressure is the volume's mean, so that the
/// forces do not change; for ideal and stiffened gases that is the pressure of the merged state up to the heat, for
/// others up to the square of the difference of the densities, until the next update of the stress recomputes it.
///
/// Afterwards
/// - a cell has at most max(2 crowd n^D, 10) particles: above that only the composition counts, and among eleven
/// particles two
///   are always close enough in it;
/// - a particle has at least 1/mass_ratio of the heaviest mass in its cell, or fills at least `small_volume` standard
///   volumes, or has no neighbour in its cell whose state is like its own.
PopulationCount merge_particles(ParticleSet& gas, PopulationPlace const& place, PopulationOptions const& options,
                                PopulationScratch& scratch);

/// Volume of a standard particle at distance r from the axis or centre, in the convention of `Metric::cell_volume`
/// [m3].
[[nodiscard]] double standard_volume(grid::Metric const& metric, int particles_per_direction, double r);

}  // namespace brisance::mpm
