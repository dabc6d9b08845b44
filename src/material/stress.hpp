/// The stress of material points over one step. Stress is positive in tension, pressure in compression:
/// sigma = s - (p + q) I with the deviator s and the bulk viscosity q.
#pragma once

#include "material/material.hpp"

namespace brisance::material {

/// n material points side by side, arrays of n values; null where the solid has no such field.
struct ParticleArrays {
  int n = 0;
  /// Increments of strain over the step [1]: xx yy zz xy yz zx, tensor components (not engineering shear).
  double const* strain[6] = {};
  /// Increments of rotation [rad]: axial vector w of the spin W_ij = (dv_i/dx_j - dv_j/dx_i) dt / 2, w_x = W_zy,
  /// w_y = W_xz, w_z = W_yx.
  double const* spin[3] = {};
  /// Increment of volumetric strain for density and pressure: trace(strain), or an average of it that controls locking.
  double const* volumetric = nullptr;
  double const* burn = nullptr;  ///< burn fraction at the end of the step; null: 1
  /// Composition of particles that mix; they keep it. Null: the ambient fluid alone.
  double const* mass_fraction = nullptr;    ///< Y of the fluid beside the ambient one
  double const* volume_fraction = nullptr;  ///< its alpha
  double* deviator[6] = {};                 ///< deviator of the Cauchy stress [Pa], components as for `strain`
  double* pressure = nullptr;               ///< p [Pa]
  double* viscosity = nullptr;              ///< out: bulk viscosity q [Pa]
  double* density = nullptr;                ///< [kg/m3]
  double* energy = nullptr;                 ///< specific internal energy [J/kg]
  double* plastic_strain = nullptr;         ///< equivalent plastic strain
  double* plastic_work = nullptr;           ///< [J/kg]
  double* temperature = nullptr;            ///< [K]
  double* damage = nullptr;                 ///< 0..1; of concrete the total, 1 - (1 - D_c)(1 - D_t)
  double* crushing = nullptr;               ///< concrete: D_c of compression and shear, 0..1
  double* cracking = nullptr;               ///< concrete: D_t of tension, 0..1
  double* compression = nullptr;            ///< concrete: largest mu = rho/rho0 - 1 so far, at least 0
  double* sound_speed = nullptr;            ///< out: longitudinal sound speed [m/s]
};

struct StepData {
  double dt;                         ///< [s]
  double length;                     ///< cell size h [m]
  double linear_viscosity = 0.06;    ///< coefficient of h c |d|
  double quadratic_viscosity = 1.5;  ///< coefficient of h^2 d^2
  /// The linear term is multiplied by x / (x + onset), x = h |d| / c: sound passes without it, shocks do not notice.
  /// 0: everything feels it.
  double linear_onset = 0.0;
  bool crack_band = true;  ///< tensile damage obeys its fracture energy, if it has one, with `length` as the band
};

/// One step of the stress of n particles; equation numbers are those of [Cui14]. In this order:
/// - density, Eq. (29): rho1 = rho0 / (1 + d eps_v);
/// - trial deviator: half the elastic increment 2 G d e, the midpoint rotation of the step [HughesWinget80], the other
///   half. This is the Jaumann rate of Eq. (30) to second order; the rotation keeps the invariants exactly, and
///   (s0 + s1)/2 : d e is exactly the elastic energy that the step stores;
/// - radial return [Wilkins64] to the yield stress at the end of the step, softened by the temperature at its start;
/// the
///   Taylor-Quinney fraction of the plastic work s1 : d ep heats;
/// - failure, with the pressure at the start of the step in the triaxiality;
/// - bulk viscosity q = rho h (linear c |d| + quadratic h d^2) where the rate of volume d is negative, c the bulk sound
///   speed [VonNeumannRichtmyer50], [Wilkins80];
/// - energy and pressure: e1 = e0 + V (s0 + s1)/2 : d e - ((p0 + p1)/2 + q) (V1 - V0), V the mean specific volume, with
///   p1 = F (f + G rho1 e1), F the burn fraction, Eqs. (52)-(53), solved for e1: of second order, and the change of e
///   is the sum of the works by construction. e holds all that the stress has done: compression, viscous and plastic
///   dissipation and the elastic energy of shear. The last, at most q_mises^2 / (6 G), thus enters p(rho, e) too, with
///   about 1e-3 of the yield stress; without it the balance would not close;
/// - cut-off: p1 is not below the solid's minimum pressure nor, where damage is 1, below 0; e1 then follows from the
///   pressure that really acts.
/// Particles that mix fluids obey the closure of gas cells (material/fluids.hpp). Along a particle the mass fraction Y
/// and, in the five-equation model [Allaire02], the volume fraction alpha stay constant: D alpha/Dt = 0. The fluids'
/// own densities are then (1 - Y) rho/(1 - alpha) and Y rho/alpha, and the mixture has a constant G and an f(rho) of
/// its own:
///     1/G = xi,   f = -B/xi,   rho f' = (H - B)/xi.
/// A particle whose alpha vanishes is the ambient fluid, whatever its Y.
/// The sound speed of failed particles still counts the shear modulus, on the safe side of the time step, but is no
/// larger than that of the solid at its density: debris that drifts apart carries nothing. That of particles not burnt
/// out is at least the detonation speed.
///
/// Solids whose strength depends on the pressure take another order: pressure, then strength and damage
/// (stress_concrete.cpp, stress_soil.cpp). Their pressure knows no energy.
///
/// Guards, which no step within the Courant limit meets: 1 + d eps_v is not below 0.1 and the implicit factor of e1 not
/// below 1/2. Finite numbers stay finite; NaN is not hidden.
///
/// A temperature that is not handed over is the solid's. No allocation; cheapest where n is a multiple of 8, for the
/// rest of up to 7 particles costs as much as 8 and a call (0.2 to 1 us). The result of a particle is the same, bit for
/// bit, wherever it stands and whoever its neighbours are.
void update_stress(Material const& solid, ParticleArrays const& particles, StepData const& step);

}  // namespace brisance::material
