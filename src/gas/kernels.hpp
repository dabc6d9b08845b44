/// What the sweep kernels share: the arrays of a bundle and the constants of a sweep.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "gas/closure.hpp"
#include "gas/layout.hpp"
#include "grid/bundle.hpp"

namespace brisance::gas {

using grid::BundleArrays;
using grid::BundleLayout;

/// Order within a_left and a_right: the face values of a cell.
inline constexpr int f_u = 1;
inline constexpr int f_v = 2;
inline constexpr int f_w = 3;
inline constexpr int f_p = 4;
inline constexpr int f_rho_e = 5;
inline constexpr int f_c = 6;
/// alpha_k rho_k.
[[nodiscard]] constexpr int f_partial(int fluid) { return fluid == 0 ? 0 : f_c + 1 + 2 * (fluid - 1); }
/// alpha_k of a fluid from number 1 on.
[[nodiscard]] constexpr int f_alpha(int fluid) { return f_partial(fluid) + 1; }
/// Values of a cell with so many fluids.
[[nodiscard]] constexpr int face_values(int fluids) { return f_c + 1 + 2 * (fluids - 1); }

/// Names of the arrays of a bundle.
inline constexpr int a_state = 0;                       ///< the conserved components, in component order
inline constexpr int a_u = components_of(most_fluids);  ///< velocity along the sweep [m/s]
inline constexpr int a_v = a_u + 1;                     ///< transverse velocities
inline constexpr int a_w = a_u + 2;
inline constexpr int a_p = a_u + 3;   ///< pressure [Pa]
inline constexpr int a_xi = a_u + 4;  ///< closure sums, see closure.hpp
inline constexpr int a_B = a_u + 5;
inline constexpr int a_H = a_u + 6;
inline constexpr int a_burn = a_u + 7;       ///< burn fraction F; only while something burns
inline constexpr int a_solid = a_u + 8;      ///< 1 in obstacle cells; only in blocks with obstacles
inline constexpr int a_area_high = a_u + 9;  ///< dt A/V at the high and low face; only along a radius
inline constexpr int a_area_low = a_u + 10;
inline constexpr int a_expansion = a_u + 11;  ///< dt/2 (A_high - A_low)/V, signed like the radius
inline constexpr int a_p_half = a_u + 12;     ///< cell pressure at half time; only along a radius
inline constexpr int a_left = a_u + 13;       ///< state at the cell's high face, the left one of that face
/// State at the cell's low face, the right one of that face.
inline constexpr int a_right = a_left + face_values(most_fluids);
/// Fluxes through the cell's high face, in component order.
inline constexpr int a_flux = a_right + face_values(most_fluids);
inline constexpr int a_face_speed = a_flux + components_of(most_fluids);
inline constexpr int a_sensor = a_face_speed + 1;  ///< the shock sensor's new value
inline constexpr int a_signal = a_sensor + 1;      ///< |u| + c
inline constexpr int a_theta = a_signal + 1;       ///< lax-wendroff: theta of [Cui14] Eq. (4)
inline constexpr int a_inverse = a_theta + 1;      ///< 1 / density of the mixture
inline constexpr int a_keep = a_inverse + 1;       ///< lax-wendroff: 0 where a face gets Rusanov's flux
inline constexpr int a_inverse_xi = a_keep;        ///< muscl-hancock: 1 / xi; of one ideal gas it is not set
inline constexpr int a_viscosity = a_keep + 1;     ///< lax-wendroff: nu h / dt per face
inline constexpr int a_half_u = a_viscosity + 1;   ///< lax-wendroff: velocity and pressure at half time per face
inline constexpr int a_half_p = a_half_u + 1;
// The progress of the afterburn stands apart from the other components, so that without one nothing is moved.
inline constexpr int a_progress = a_half_p + 1;  ///< alpha rho lambda of the products
inline constexpr int a_progress_flux = a_progress + 1;
inline constexpr int a_lambda = a_progress + 2;   ///< lambda
inline constexpr int a_release = a_progress + 3;  ///< energy that the afterburn released in the step [J/m3]
inline constexpr int a_risk = a_progress + 4;     ///< 1 where the fluxes beside the cell are checked for positivity
inline constexpr int a_share = a_progress + 5;    ///< of the slopes that a shock near a wall keeps
inline constexpr int array_count = a_progress + 6;

/// The arrays of a conserved component and of its flux.
inline constexpr int state_array(int component) { return component == progress ? a_progress : a_state + component; }
inline constexpr int flux_array(int component) { return component == progress ? a_progress_flux : a_flux + component; }

/// Calls `use(k)` for the fluids from First to N - 1. Written out when compiled: loops over cells that are full of it
/// stay simple enough to be vectorised.
template <int First, int N, class Use>
constexpr void for_fluids(Use const& use) {
  if constexpr (First < N) {
    use(First);
    for_fluids<First + 1, N>(use);
  }
}
/// Sum of a quantity over N fluids, in their order.
template <int N, class Of>
[[nodiscard]] constexpr double sum_of_fluids(Of const& of) {
  if constexpr (N == 1)
    return of(0);
  else
    return sum_of_fluids<N - 1>(of) + of(N - 1);
}

/// Calls use.operator()<N>() with the number of fluids that a row holds.
template <int N = 1, class Use>
decltype(auto) with_fluids(int fluids, Use const& use) {
  if constexpr (N == most_fluids) {
    return use.template operator()<N>();
  } else {
    return fluids == N ? use.template operator()<N>() : with_fluids<N + 1>(fluids, use);
  }
}

/// An array for each of N fluids, to be read.
template <int N>
using FluidRows = std::array<double const*, N>;

/// Partial densities and volume fractions of the cells from `begin` on; the ambient fluid's volume fraction is null.
template <int N>
[[nodiscard]] FluidRows<N> rows_of_fluids(BundleArrays& a, int begin) {
  FluidRows<N> rows{};
  for_fluids<0, N>([&](int k) { rows[k] = a[a_state + partial_density(k)] + begin; });
  return rows;
}
template <int N>
[[nodiscard]] FluidRows<N> volume_fraction_rows(BundleArrays& a, int begin) {
  FluidRows<N> rows{};
  for_fluids<1, N>([&](int k) { rows[k] = a[a_state + volume_fraction(k)] + begin; });
  return rows;
}

/// The arrays of a bundle by their names, at hand in a register.
class Arrays {
 public:
  explicit Arrays(BundleArrays& a) : first_(a[0]) {}
  [[nodiscard]] double* operator[](int name) const {
    return first_ + static_cast<std::ptrdiff_t>(name) * grid::bundle_pitch;
  }

 private:
  double* first_;
};

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

/// Which closure sums of a row stand in arrays.
enum class Sums {
  none,  ///< one ideal gas: they are constants
  xi,    ///< no fluid has a reference curve that counts: B = H = 0
  all,
};
inline constexpr int kinds_of_sums = 3;

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
  int present = 1;  ///< fluids of the row: the first so many of all
  bool radial = false;
  bool solid = false;
  bool burning = false;
  bool rests = false;                                ///< quiescent bundles may be left as they are
  bool progress = false;                             ///< the products carry a progress of their afterburn
  bool bounded_phase = false;                        ///< see `FacePass::bound_density` and `bound_energy`
  bool flattened = false;                            ///< `a_share` weakens the slopes of some cells
  double most_H = 0.0;                               ///< infinite where a fluid bears tension, else 0: see `margin`
  Sums sums = Sums::all;                             ///< of the row before the update
  double gamma = 0.0;                                ///< with Sums::none: that of the ideal gas
  PerFluid xi_slope{};                               ///< what the volume fraction of a fluid adds to xi
  std::vector<WallRun> const* near_walls = nullptr;  ///< cells of the bundle near rigid surfaces
  grid::Ahead ahead;                                 ///< what the next bundle reads

  [[nodiscard]] int normal() const { return momentum_x + direction; }
  [[nodiscard]] int transverse1() const { return momentum_x + (direction + 1) % 3; }
  [[nodiscard]] int transverse2() const { return momentum_x + (direction + 2) % 3; }
};

// Where fluxes are checked for positivity: the pressure changes by this factor within three cells, or the kinetic
// energy is this multiple of margin / xi, a Mach number of about 8.
inline constexpr double steep_pressure = 4.0;
inline constexpr double cold_flow = 30.0;

/// How far a state is from losing its meaning [Pa]: where a fluid bears tension (`most_H` infinite) the stiffness
/// xi rho c^2 = p (xi + 1) + H; where none does (0) a negative pressure has no meaning either, for the energy is then
/// less than that of the cold products.
template <class V>
[[nodiscard]] inline V margin(V const& p, V const& xi, V const& H, V const& most_H) {
  using std::min;
  return p * (xi + 1.0) + min(H, most_H);
}

/// Density of the mixture in a cell.
[[nodiscard]] inline double mixture_density(SweepContext const& s, BundleArrays& a, int q) {
  return mixture_density(s.present, [&](int c) { return a[c][q]; });
}

/// Closure of a cell in which all is burnt.
[[nodiscard]] inline Mixture mixture_at(SweepContext const& s, BundleArrays& a, int q) {
  PerFluid partial{};
  Fractions alpha;
  for (int k = 0; k < s.present; ++k) {
    partial[k] = a[partial_density(k)][q];
    if (k > 0) alpha.set(k, a[volume_fraction(k)][q]);
  }
  return mixture(*s.fluids, partial, alpha);
}

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
