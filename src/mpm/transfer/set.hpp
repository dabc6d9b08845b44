/// The particles of one body in one block, and what the loops between them and the nodes of the block's patch share.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/loops.hpp"
#include "mpm/cells.hpp"
#include "mpm/groups.hpp"
#include "mpm/kernels.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

inline std::array<double const*, 3> constant_at(ParticleSet const& set, Field first, int begin) {
  std::array<double const*, 3> out{};
  for (int d = 0; d < 3; ++d) {
    double const* values = set.field(first + d);
    out[d] = values == nullptr ? nullptr : values + begin;
  }
  return out;
}

inline std::array<double*, 3> vector_at(ParticleSet& set, Field first, int begin) {
  std::array<double*, 3> out{};
  for (int d = 0; d < 3; ++d) {
    double* values = set.field(first + d);
    out[d] = values == nullptr ? nullptr : values + begin;
  }
  return out;
}

inline HalfLengths half_lengths(ParticleSet const& set, Body const& body, double h, int begin) {
  HalfLengths half;
  double const constant = 0.5 * h / body.particles_per_direction;
  half.constant = {constant, constant, constant};
  half.own = constant_at(set, Field::half_x, begin);
  return half;
}

inline Hoops hoops_of(grid::Geometry geometry) {
  switch (geometry) {
    case grid::Geometry::axisymmetric2d:
    case grid::Geometry::cylindrical1d: return {0.0, 1.0};
    case grid::Geometry::spherical1d: return {1.0, 1.0};
    default: return {};
  }
}

/// Fraction of a particle's volume that the gas around does not fill. Debris flies apart and soil bursts, and the
/// volumes of their particles grow with the gaps between them: a solid bears the pressure of the gas with no more than
/// its matter. With all of it single grains push, and are pushed, as if they filled many cells, and are thrown.
inline double matter_fraction(Body const& body, double density) {
  return body.solid.has_deviator() ? std::min(1.0, density / body.solid.density) : 1.0;
}

/// What a pass over one set needs.
struct SetView {
  ParticleSet* set;
  Body const* body;
  Patch const* patch;
  double h;
};

/// Locking control. Replaces the volumetric strain of each particle by that of its cell, and the pressure in the forces
/// by the cell's mean, both weighted with volume: the two are conjugate, so that the work of the forces and the energy
/// of the particles agree (the B-bar method of finite elements, with the cell as the element, [Hughes80]).
class CellMeans {
 public:
  /// Finds the cell of each particle of a set.
  CellMeans(SetView const& v, Scratch& scratch) : scratch_(&scratch) {
    scratch.cell_sums.assign(v.patch->cell_range().count() * 2, 0.0);
    find_cells(*v.set, *v.patch, scratch.order);
  }
  void add(int particle, double volume, double value) {
    double* sums = scratch_->cell_sums.data() + 2L * scratch_->order[particle];
    sums[0] += volume;
    sums[1] += volume * value;
  }
  [[nodiscard]] double mean(int particle) const {
    double const* sums = scratch_->cell_sums.data() + 2L * scratch_->order[particle];
    return sums[1] / sums[0];
  }

 private:
  Scratch* scratch_;
};

/// Calls work(begin, n, weights) for the particles of a set, a chunk at a time; without `gradients` there are none.
template <class S, int D, bool gradients = true, class Work>
void for_chunks(SetView const& v, Work&& work) {
  ParticleSet const& set = *v.set;
  Weights<S, D> k;
  for (int begin = 0; begin < set.size(); begin += chunk) {
    int const n = std::min(chunk, set.size() - begin);
    find_weights<S, D, gradients>(*v.patch, v.h, constant_at(set, Field::position_x, begin),
                                  half_lengths(set, *v.body, v.h, begin), n, k);
    work(begin, n, k);
  }
}

/// Mean of pressure and bulk viscosity over each cell of a set.
inline CellMeans mean_pressures(SetView const& v, Scratch& scratch) {
  ParticleSet const& set = *v.set;
  double const* mass = set.field(Field::mass);
  double const* density = set.field(Field::density);
  double const* pressure = set.field(Field::pressure);
  double const* viscosity = set.field(Field::viscosity);
  CellMeans means(v, scratch);
  for (int q = 0; q < set.size(); ++q) means.add(q, mass[q] / density[q], pressure[q] + viscosity[q]);
  return means;
}

}  // namespace brisance::mpm
