/// The stages of a step of the stress that all kinds of solids share: see stress.cpp. Private to this folder.
#pragma once

#include <cmath>

#include "core/loops.hpp"
#include "material/stress.hpp"

namespace brisance::material {

/// Particles are taken in chunks that stay in the first cache together with what passes between the stages.
inline constexpr int chunk = 128;

/// Every loop runs over a multiple of this many points, so that no particle ever meets the scalar rest of a vector
/// loop, whose rounding differs: the result of a particle does not depend on where it stands.
inline constexpr int lanes = 8;
static_assert(chunk % lanes == 0);

/// The particles of a chunk that yield, side by side, in the iteration for their increments of plastic strain.
struct Yielding {
  int particle[chunk];                  ///< which particle of the chunk
  alignas(64) double mises[chunk];      ///< of the trial [Pa]
  alignas(64) double ep[chunk];         ///< plastic strain at the start
  alignas(64) double soft[chunk];       ///< thermal factor of the yield stress
  alignas(64) double tolerance[chunk];  ///< of consistency [Pa]
  alignas(64) double u[chunk];          ///< ln of the increment
  alignas(64) double x[chunk];          ///< increment
  alignas(64) double hard[chunk];       ///< hardening at the end of the step [Pa]
};

/// The equation of state of each particle of a chunk that mixes, at the end of the step.
struct Blend {
  alignas(64) double partial[most_fluids][chunk];  ///< densities of the fluids [kg/m3]
  alignas(64) double G[chunk];                     ///< first the sum xi of the closure
  alignas(64) double f[chunk];                     ///< [Pa]; first the sum B
  alignas(64) double df[chunk];                    ///< rho f' [Pa]; first the sum H
};

/// What passes between the stages of a chunk.
struct Scratch {
  alignas(64) double work[chunk];         ///< (s0 + s1)/2 : d e [Pa]
  alignas(64) double floor[chunk];        ///< smallest pressure that the particle bears [Pa]
  alignas(64) double widest[chunk];       ///< specific volume at which waves are no faster if it grows [m3/kg]
  alignas(64) double burn[chunk];         ///< burn fraction
  alignas(64) double trial_work[chunk];   ///< s_trial : d e / 2 [Pa]
  alignas(64) double mises[chunk];        ///< Mises stress, first of the trial, then of the end [Pa]
  alignas(64) double increment[chunk];    ///< of equivalent plastic strain
  alignas(64) double scale[chunk];        ///< s1 = scale * s_trial
  alignas(64) double temperature[chunk];  ///< at the start of the step [K]
  alignas(64) double soft[chunk];         ///< thermal factor of the yield stress
  alignas(64) double slow[chunk];         ///< yield stress at the start of the step, at a low rate [Pa]
  Yielding yielding;
  Blend blend;
};

inline void fill(double* x, int n, double value) {
  for (int k = 0; k < n; ++k) x[k] = value;
}

/// Trial deviator: elastic half-increment, rotation, elastic half-increment. Also the parts of the work and the trial
/// Mises stress.
inline void trial_deviator(ParticleArrays const& a, double G, Scratch& t) {
  int const n = a.n;
  double const* const exx = a.strain[0];
  double const* const eyy = a.strain[1];
  double const* const ezz = a.strain[2];
  double const* const exy = a.strain[3];
  double const* const eyz = a.strain[4];
  double const* const ezx = a.strain[5];
  double const* const wx = a.spin[0];
  double const* const wy = a.spin[1];
  double const* const wz = a.spin[2];
  double* const sxx = a.deviator[0];
  double* const syy = a.deviator[1];
  double* const szz = a.deviator[2];
  double* const sxy = a.deviator[3];
  double* const syz = a.deviator[4];
  double* const szx = a.deviator[5];
  double* const start_work = t.work;
  double* const trial_work = t.trial_work;
  double* const mises = t.mises;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const mean = (exx[k] + eyy[k] + ezz[k]) * (1.0 / 3.0);
    double const dxx = exx[k] - mean;
    double const dyy = eyy[k] - mean;
    double const dzz = ezz[k] - mean;
    double const dxy = exy[k];
    double const dyz = eyz[k];
    double const dzx = ezx[k];
    double const s0 = sxx[k];
    double const s1 = syy[k];
    double const s2 = szz[k];
    double const s3 = sxy[k];
    double const s4 = syz[k];
    double const s5 = szx[k];
    start_work[k] = 0.5 * (s0 * dxx + s1 * dyy + s2 * dzz) + (s3 * dxy + s4 * dyz + s5 * dzx);
    double const axx = s0 + G * dxx;
    double const ayy = s1 + G * dyy;
    double const azz = s2 + G * dzz;
    double const axy = s3 + G * dxy;
    double const ayz = s4 + G * dyz;
    double const azx = s5 + G * dzx;

    // Q = (I - W/2)^-1 (I + W/2) = I + (W + W^2/2) / (1 + w^2/4), W^2 = w w^T - w^2 I.
    double const x = wx[k];
    double const y = wy[k];
    double const z = wz[k];
    double const w2 = x * x + y * y + z * z;
    double const f = 1.0 / (1.0 + 0.25 * w2);
    double const h = 0.5 * f;
    double const qxx = 1.0 + h * (x * x - w2);
    double const qyy = 1.0 + h * (y * y - w2);
    double const qzz = 1.0 + h * (z * z - w2);
    double const qxy = h * (x * y) - f * z;
    double const qyx = h * (x * y) + f * z;
    double const qyz = h * (y * z) - f * x;
    double const qzy = h * (y * z) + f * x;
    double const qzx = h * (z * x) - f * y;
    double const qxz = h * (z * x) + f * y;

    // b = Q a, r = b Q^T
    double const bxx = qxx * axx + qxy * axy + qxz * azx;
    double const bxy = qxx * axy + qxy * ayy + qxz * ayz;
    double const bxz = qxx * azx + qxy * ayz + qxz * azz;
    double const byx = qyx * axx + qyy * axy + qyz * azx;
    double const byy = qyx * axy + qyy * ayy + qyz * ayz;
    double const byz = qyx * azx + qyy * ayz + qyz * azz;
    double const bzx = qzx * axx + qzy * axy + qzz * azx;
    double const bzy = qzx * axy + qzy * ayy + qzz * ayz;
    double const bzz = qzx * azx + qzy * ayz + qzz * azz;
    double const rxx = bxx * qxx + bxy * qxy + bxz * qxz + G * dxx;
    double const ryy = byx * qyx + byy * qyy + byz * qyz + G * dyy;
    double const rzz = bzx * qzx + bzy * qzy + bzz * qzz + G * dzz;
    double const rxy = bxx * qyx + bxy * qyy + bxz * qyz + G * dxy;
    double const ryz = byx * qzx + byy * qzy + byz * qzz + G * dyz;
    double const rzx = bzx * qxx + bzy * qxy + bzz * qxz + G * dzx;

    sxx[k] = rxx;
    syy[k] = ryy;
    szz[k] = rzz;
    sxy[k] = rxy;
    syz[k] = ryz;
    szx[k] = rzx;
    trial_work[k] = 0.5 * (rxx * dxx + ryy * dyy + rzz * dzz) + (rxy * dxy + ryz * dyz + rzx * dzx);
    double const ss = (rxx * rxx + ryy * ryy + rzz * rzz) + 2.0 * (rxy * rxy + ryz * ryz + rzx * rzx);
    mises[k] = std::sqrt(1.5 * ss);
  }
}

/// s1 = scale * s_trial.
inline void scale_deviator(ParticleArrays const& a, Scratch const& t) {
  int const n = a.n;
  double const* const scale = t.scale;
  for (double* const s : a.deviator) {
    BRISANCE_VECTOR_LOOP
    for (int k = 0; k < n; ++k) s[k] *= scale[k];
  }
}

/// Plastic strain, work and heat of the step.
inline void plastic_flow(ParticleArrays const& a, double specific_heat, double taylor_quinney, Scratch const& t) {
  int const n = a.n;
  double const* const increment = t.increment;
  double const* const mises = t.mises;
  double const* const rho = a.density;
  double const* const volumetric = a.volumetric;
  double* const ep = a.plastic_strain;
  double* const plastic_work = a.plastic_work;
  double* const temperature = a.temperature;
  if (temperature != nullptr && specific_heat > 0.0) {
    double const per_work = taylor_quinney / specific_heat;
    BRISANCE_VECTOR_LOOP
    for (int k = 0; k < n; ++k) {
      temperature[k] += per_work * increment[k] * mises[k] * (1.0 + 0.5 * volumetric[k]) / rho[k];
    }
  }
  if (plastic_work != nullptr) {
    BRISANCE_VECTOR_LOOP
    for (int k = 0; k < n; ++k) plastic_work[k] += increment[k] * mises[k] * (1.0 + 0.5 * volumetric[k]) / rho[k];
  }
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) ep[k] += increment[k];
}

/// Volume at the end of the step over that at its start.
[[nodiscard]] inline double volume_ratio(double volumetric) {
  double const grown = 1.0 + volumetric;
  return grown < 0.1 ? 0.1 : grown;  // this way round NaN stays NaN and is found
}

/// Where a particle ends in a step.
struct End {
  double pressure;  ///< [Pa]
  double energy;    ///< [J/kg]
  double modulus;   ///< rho c^2 of the bulk [Pa]
};

/// What the pressure of a step works with.
struct Volumes {
  double before;  ///< specific volume at the start of the step [m3/kg]
  double after;
  double density;  ///< at the end of the step [kg/m3]
};

/// The end of a step for all solids: viscosity, density, energy, pressure and sound speed. `law` knows the pressure, at
/// two particles of it for each particle k:
///     auto known = law.at(k, volumes)                       what does not depend on the energy of this step
///     known.bulk(e0) -> double                              rho c^2 of the bulk, for the viscosity [Pa]
///     known.end(p0, e0, deviatoric, q) -> End               `deviatoric`: work of the deviator [J/kg], q: viscosity
/// and `law.least_speed(k)` [m/s], which bounds the sound speed from below. Debris that bears neither tension nor shear
/// drifts apart, and nothing runs through it faster than through the solid that it was: its moduli count by no larger
/// volume than that (`Scratch::widest`).
template <class Law>
void finish(Law const law, ParticleArrays const& a, StepData const step, double shear, Scratch const& t) {
  int const n = a.n;
  double const* const volumetric = a.volumetric;
  double const* const work = t.work;
  double* const density = a.density;
  double* const energy = a.energy;
  double* const pressure = a.pressure;
  double* const viscosity = a.viscosity;
  double* const sound_speed = a.sound_speed;
  double const* const widest = t.widest;
  double const stiffening = 4.0 / 3.0 * shear;
  double const linear = step.linear_viscosity * step.length / step.dt;
  double const onset = step.linear_onset > 0.0 ? step.linear_onset * step.dt / step.length : 0.0;
  double const quadratic = step.quadratic_viscosity * (step.length / step.dt) * (step.length / step.dt);
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const ratio = volume_ratio(volumetric[k]);
    double const rho0 = density[k];
    double const V0 = 1.0 / rho0;
    double const V1 = V0 * ratio;
    double const rho1 = rho0 / ratio;
    auto const known = law.at(k, {V0, V1, rho1});

    double const carrying = V1 < widest[k] ? V1 : widest[k];
    double const c = std::sqrt(known.bulk(energy[k]) * carrying);
    double const closing = ratio < 1.0 ? 1.0 - ratio : 0.0;  // -d dt in compression
    double const strong = closing / (closing + onset * c + 1e-300);
    double const q = rho1 * closing * (linear * c * strong + quadratic * closing);

    End const end = known.end(pressure[k], energy[k], 0.5 * (V0 + V1) * work[k], q);
    double const longitudinal = std::sqrt((end.modulus + stiffening) * carrying);
    double const least = law.least_speed(k);
    density[k] = rho1;
    energy[k] = end.energy;
    pressure[k] = end.pressure;
    viscosity[k] = q;
    sound_speed[k] = longitudinal > least ? longitudinal : least;
  }
}

/// A pressure that knows no energy: found before, with rho c^2 [Pa] of the bulk.
struct ColdPressure {
  double const* pressure;
  double const* modulus;

  struct At {
    double p1, modulus, change;

    [[nodiscard]] double bulk(double /*e0*/) const { return modulus; }
    [[nodiscard]] End end(double p0, double e0, double deviatoric, double q) const {
      return {p1, e0 + (deviatoric - (0.5 * (p0 + p1) + q) * change), modulus};
    }
  };
  [[nodiscard]] At at(int k, Volumes const v) const { return {pressure[k], modulus[k], v.after - v.before}; }
  [[nodiscard]] double least_speed(int /*k*/) const { return 0.0; }
};

/// The particles of a chunk whose strength depends on the pressure.
void update_concrete(Material const& solid, Hjc const& model, ParticleArrays const& a, StepData const& step,
                     Scratch& t);
void update_soil(Material const& solid, DruckerPrager const& model, ParticleArrays const& a, StepData const& step,
                 Scratch& t);

}  // namespace brisance::material
