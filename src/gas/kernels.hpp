/// What the sweep kernels share: the arrays of a bundle and the constants of a sweep.
#pragma once

#include <vector>

#include "gas/closure.hpp"
#include "gas/components.hpp"
#include "grid/bundle.hpp"

namespace brisance::gas {

using grid::BundleArrays;
using grid::BundleLayout;

/// Names of the arrays of a bundle.
inline constexpr int a_state = 0;  ///< the conserved components, in component order
inline constexpr int a_u = 8;      ///< velocity along the sweep [m/s]
inline constexpr int a_v = 9;      ///< transverse velocities
inline constexpr int a_w = 10;
inline constexpr int a_p = 11;   ///< pressure [Pa]
inline constexpr int a_xi = 12;  ///< closure sums, see closure.hpp
inline constexpr int a_B = 13;
inline constexpr int a_H = 14;
inline constexpr int a_burn = 15;       ///< burn fraction F; only while something burns
inline constexpr int a_solid = 16;      ///< 1 in obstacle cells; only in blocks with obstacles
inline constexpr int a_area_high = 17;  ///< dt A/V at the high and low face; only along a radius
inline constexpr int a_area_low = 18;
inline constexpr int a_expansion = 19;      ///< dt/2 (A_high - A_low)/V, signed like the radius
inline constexpr int a_p_half = 20;         ///< cell pressure at half time; only along a radius
inline constexpr int a_left = 21;           ///< state at the cell's high face, the left one of that face; nine values
inline constexpr int a_right = a_left + 9;  ///< state at the cell's low face, the right one of that face
inline constexpr int a_flux = a_right + 9;  ///< fluxes through the cell's high face, in component order
inline constexpr int a_face_speed = a_flux + 8;
inline constexpr int a_sensor = a_face_speed + 1;  ///< the shock sensor's new value
inline constexpr int a_signal = a_sensor + 1;      ///< |u| + c
inline constexpr int a_theta = a_signal + 1;       ///< lax-wendroff: theta of [Cui14] Eq. (4)
inline constexpr int a_inverse = a_theta + 1;      ///< 1 / density of the mixture
inline constexpr int a_contact = a_inverse + 1;    ///< 1 where a contact is to be steepened
inline constexpr int a_keep = a_contact + 1;       ///< 0 where a cell falls back to its own state at its faces
inline constexpr int a_squeeze = a_keep + 1;       ///< dt/2 div u
inline constexpr int a_slope = a_squeeze + 1;  ///< limited differences over the cell, in the order of the face values
inline constexpr int a_viscosity = a_slope;    ///< lax-wendroff, in the place of the slopes: nu h / dt per face
inline constexpr int a_half_u = a_slope + 1;   ///< velocity and pressure at half time per face
inline constexpr int a_half_p = a_slope + 2;
// The progress of the afterburn stands apart from the other components, so that without one nothing is moved.
inline constexpr int a_progress = a_slope + 9;  ///< alpha_1 rho_1 lambda
inline constexpr int a_progress_flux = a_progress + 1;
inline constexpr int a_lambda = a_progress + 2;   ///< lambda
inline constexpr int a_release = a_progress + 3;  ///< energy that the afterburn released in the step [J/m3]
inline constexpr int a_risk = a_progress + 4;     ///< 1 where the fluxes beside the cell are checked for positivity
inline constexpr int a_share = a_progress + 5;    ///< of the slopes that a shock near a wall keeps
inline constexpr int a_uneven = a_progress + 6;   ///< 1 where the second fluid's own density is bounded
inline constexpr int array_count = a_progress + 7;

/// The arrays of a conserved component and of its flux.
inline constexpr int state_array(int component) { return component == progress ? a_progress : a_state + component; }
inline constexpr int flux_array(int component) { return component == progress ? a_progress_flux : a_flux + component; }

/// Order within a_left and a_right.
inline constexpr int f_density = 0;
inline constexpr int f_u = 1;
inline constexpr int f_v = 2;
inline constexpr int f_w = 3;
inline constexpr int f_p = 4;
inline constexpr int f_rho_e = 5;
inline constexpr int f_c = 6;
inline constexpr int f_second = 7;
inline constexpr int f_alpha = 8;

/// Where the guards begin.
struct Floors {
  double density = 1e-6;   ///< [kg/m3]
  double pressure = 1e-3;  ///< [Pa]
};

/// Consecutive cells of a bundle near a rigid surface that faces the sweep: a wall or plane of symmetry of the domain,
/// or an obstacle.
struct WallRun {
  int q = 0;           ///< bundle index of the first cell
  int count = 0;       ///< number of cells
  int distance = 0;    ///< cells between the first one and the surface
  int change = 0;      ///< of the distance from one cell to the next: -1, 0 or 1
  bool above = false;  ///< the surface lies beyond the high end of the cells
};

/// Cells between a rigid surface and the last cell that is near it, plus one.
inline constexpr int near_wall_cells = 8;

/// Constants of one sweep.
struct SweepContext {
  Fluids const* fluids = nullptr;
  int direction = 0;
  double dt = 0.0;
  double h = 1.0;
  double beta = 1.5;  ///< limiter
  Floors floors;
  double viscosity = 0.0;  ///< lax-wendroff eta; 0: [Cui14] Eq. (5)
  bool shock_sensor = false;
  bool two = false;  ///< kernels for two fluids
  bool radial = false;
  bool solid = false;
  bool burning = false;
  bool progress = false;                             ///< the second fluid carries a progress of its afterburn
  bool bounded_phase = false;                        ///< see `bound_phase_density` and `bound_reference_energy`
  double most_H = 0.0;                               ///< infinite where a fluid bears tension, else 0: see `margin`
  std::vector<WallRun> const* near_walls = nullptr;  ///< cells of the bundle near rigid surfaces

  [[nodiscard]] int normal() const { return momentum_x + direction; }
  [[nodiscard]] int transverse1() const { return momentum_x + (direction + 1) % 3; }
  [[nodiscard]] int transverse2() const { return momentum_x + (direction + 2) % 3; }
};

/// One cell that a guard had to lift; densities, per volume.
struct Lift {
  int q = 0;            ///< bundle index
  double mass = 0.0;    ///< added [kg/m3]
  double energy = 0.0;  ///< added [J/m3]
  bool finite = true;   ///< false: the cell holds something that is no number
};

/// What happened to the block's own cells of a bundle.
struct GuardCount {
  std::vector<Lift> lifts;
  long fallback_faces = 0;  ///< faces whose flux was replaced by, or blended with, a first-order one
};

}  // namespace brisance::gas
