/// Remap: a profile becomes the initial state of a simulation with more directions, [Cui14] Sec. 4.1. Spherical
/// profiles go into 3D and axisymmetric 2D, cylindrical ones into planar 2D, axisymmetric ones into 3D.
#pragma once

#include <array>

#include "detonation/profile.hpp"
#include "gas/gas.hpp"

namespace brisance::detonation {

/// Where the burst goes.
struct Placing {
  Vec3 centre{0.0, 0.0, 0.0};  ///< of the charge [m]
  int axis = 2;                ///< of axisymmetric profiles in 3D: the direction of their y
  double sense = 1.0;          ///< 1 or -1: which way it points
};

struct RemapReport {
  double time = 0.0;    ///< of the profile [s]
  double radius = 0.0;  ///< of the burst [m]
  double cells_per_radius = 0.0;
  double share = 1.0;   ///< fraction of the burst that lies in the domain: the planes through its centre halve it
  gas::Amounts before;  ///< of that part, in the profile
  gas::Amounts after;   ///< on the grid
  double radial_momentum = 0.0;  ///< of that part: integral of the size of the momentum [kg m/s]
  /// Largest relative error of these sums before they were corrected: that of the quadrature in cut cells.
  double quadrature_error = 0.0;
  /// Among the cells that hold both fluids: the root of the mean square of p / <p> - 1, where <p> is the mean of the
  /// profile's pressure over the cell; with the volume fraction averaged, and with the one that was chosen.
  double pressure_error_averaged = 0.0;
  double pressure_error = 0.0;

  /// Largest relative error of masses, energy and momentum (the latter relative to `radial_momentum`).
  [[nodiscard]] double error() const;
};

void archive(Archive& a, RemapReport& report);

/// Symmetry planes and walls of the domain that pass through the centre: per direction 1 where the domain lies above
/// the plane, -1 where it lies below, 0 without one. The axis of a curvilinear geometry is none.
[[nodiscard]] std::array<int, 3> planes_through(grid::Domain const& domain, Vec3 const& centre);

/// Puts the burst into gas that is ambient wherever the burst goes.
///
/// Every cell gets the integrals of the conserved components over the part of it that the burst fills (radial profiles,
/// in shells merged to 20 or more per cell: exact along lines, by Gauss's rule across them; axisymmetric ones alike
/// along the axis), and the ambient state in the rest. Then the sums are made those of the profile to round-off; the
/// kinetic energy that averaging takes from the momentum is internal energy of the cell. The volume fraction, which
/// nothing conserves, is chosen so that the pressure of a mixed cell is the mean of that of the profile, where a
/// fraction within half the way to 0 or 1 does that. Cells that the burst does not touch keep every bit.
///
/// Throws InputError where the profile does not fit the gas, or where two bursts share a cell.
RemapReport remap(gas::Gas& gas, Profile const& profile, Placing const& placing);

}  // namespace brisance::detonation
