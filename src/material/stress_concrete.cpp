/// Concrete: HJC strength, compaction and tensile damage over one step. [HJC93], [Cui14] Eqs. (56)-(58).
///
/// Order of a step: pressure from density and the largest compression; return to the surface of the old damage, in
/// which the softening by the new compression-shear damage is implicit; tensile damage from the largest principal
/// stress there; then pressure and deviator once more with the total damage. Damage never falls, for each part of it
/// only grows.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.hpp"
#include "material/stress_stages.hpp"

namespace brisance::material {

namespace {

/// What passes between the loops.
struct Concrete {
  alignas(64) double free[chunk];     ///< pressure of the compaction curves at the end of the step [Pa]
  alignas(64) double trial[chunk];    ///< pressure that the step would reach elastically from its start [Pa]
  alignas(64) double held[chunk];     ///< pressure, cut off at the old damage [Pa]
  alignas(64) double modulus[chunk];  ///< rho c^2 [Pa]
  alignas(64) double crushed[chunk];  ///< increment of plastic volume strain
  alignas(64) double rate[chunk];     ///< factor of the strength
  alignas(64) double kept[chunk];     ///< Mises stress after the first return [Pa]
  alignas(64) double p1[chunk];       ///< pressure at the end of the step [Pa]
};

/// Pressure and compression. [HJC93] Fig. 2.
void compact(Compaction::Curves const c, ParticleArrays const& a, Concrete& w) {
  int const n = a.n;
  double const* const density = a.density;
  double const* const volumetric = a.volumetric;
  double const* const pressure = a.pressure;
  double* const compression = a.compression;
  double* const free = w.free;
  double* const trial = w.trial;
  double* const modulus = w.modulus;
  double* const crushed = w.crushed;
  double const per_rho0 = 1.0 / c.rho0;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const rho = density[k] * per_rho0;
    double const rho1 = rho / volume_ratio(volumetric[k]);
    double const mu = rho1 - 1.0;
    double const before = compression[k];
    double const most = mu > before ? mu : before;
    double const slope = c.unloading_slope(most);
    double const grown = c.residual(most) - c.residual(before);
    free[k] = c.pressure(mu, most);
    trial[k] = pressure[k] + slope * (rho1 - rho);
    crushed[k] = most > before && grown > 0.0 ? grown : 0.0;
    modulus[k] = slope * rho1;
    compression[k] = most;
  }
}

/// Factor of the strength by the rate of the deviatoric strain.
void rate_factors(Hjc const model, ParticleArrays const& a, double dt, Concrete& w) {
  int const n = a.n;
  double const* const exx = a.strain[0];
  double const* const eyy = a.strain[1];
  double const* const ezz = a.strain[2];
  double const* const exy = a.strain[3];
  double const* const eyz = a.strain[4];
  double const* const ezx = a.strain[5];
  double* const rate = w.rate;
  double const per_dt = 1.0 / dt;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const mean = (exx[k] + eyy[k] + ezz[k]) * (1.0 / 3.0);
    double const dxx = exx[k] - mean;
    double const dyy = eyy[k] - mean;
    double const dzz = ezz[k] - mean;
    double const square =
        dxx * dxx + dyy * dyy + dzz * dzz + 2.0 * (exy[k] * exy[k] + eyz[k] * eyz[k] + ezx[k] * ezx[k]);
    rate[k] = model.rate_factor(std::sqrt(2.0 / 3.0 * square) * per_dt);
  }
}

[[nodiscard]] inline double total_damage(double crushing, double cracking) {
  return 1.0 - (1.0 - crushing) * (1.0 - cracking);
}

/// Return to the surface of the old damage, with the softening of this step's compression-shear damage in it: the
/// strength falls by H d ep, so that d ep = (trial - strength) / (3 G - H). Where the solid has tensile damage
/// (`cracks`) plastic strain under mean tension is the opening of cracks, which is that one's: it does not count here.
/// What has failed already is not crushed any more: rubble shears without resistance.
void crush(Hjc const model, double T_max, bool cracks, ParticleArrays const& a, Scratch& t, Concrete& w) {
  int const n = a.n;
  double const* const free = w.free;
  double const* const crushed = w.crushed;
  double const* const rate = w.rate;
  double const* const mises = t.mises;
  double const* const cracking = a.cracking;
  double* const crushing = a.crushing;
  double* const held = w.held;
  double* const kept = w.kept;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const whole = 1.0 - cracking[k];
    double const D = total_damage(crushing[k], cracking[k]);
    double const bound = -T_max * (1.0 - D);
    double const p = free[k] > bound ? free[k] : bound;
    bool const counts = D < 1.0 && !(cracks && p < 0.0);
    double const per_ef = counts ? 1.0 / model.failure_strain(p) : 0.0;
    double const start = total_damage(crushing[k] + crushed[k] * per_ef, cracking[k]);
    double const strength = model.strength(p, start < 1.0 ? start : 1.0, rate[k], T_max);
    double const falling = model.A * model.fc * rate[k] * whole * per_ef;
    bool const softens = start < 1.0 && strength < model.S_max * model.fc;
    double const stiffness = 3.0 * model.G - (softens ? falling : 0.0);
    double const least = 0.3 * model.G;  // a steeper fall would be faster than any equilibrium
    double const over = mises[k] - strength;
    double const increment = over > 0.0 ? over / (stiffness > least ? stiffness : least) : 0.0;
    double const grown = crushing[k] + (crushed[k] + increment) * per_ef;
    double const Dc = grown < 1.0 ? grown : 1.0;
    double const most = model.strength(p, total_damage(Dc, cracking[k]), rate[k], T_max);
    crushing[k] = Dc;
    held[k] = p;
    kept[k] = mises[k] < most ? mises[k] : most;
  }
}

/// Largest principal value of a deviator whose Mises stress is q > 0.
[[nodiscard]] double largest_principal(ParticleArrays const& a, int k, double q) {
  double const xx = a.deviator[0][k];
  double const yy = a.deviator[1][k];
  double const zz = a.deviator[2][k];
  double const xy = a.deviator[3][k];
  double const yz = a.deviator[4][k];
  double const zx = a.deviator[5][k];
  double const J3 = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
  double const cosine = std::clamp(13.5 * J3 / (q * q * q), -1.0, 1.0);
  return 2.0 / 3.0 * q * std::cos(std::acos(cosine) / 3.0);
}

/// Growth of the tensile damage. Few particles are in tension: one by one.
void crack(TensileDamage const& tensile, Hjc const& model, ParticleArrays const& a, StepData const& step,
           Scratch const& t, Concrete const& w) {
  bool const band = step.crack_band && tensile.fracture_energy > 0.0;
  double const per_opening = band ? tensile.sigma0 * step.length / tensile.fracture_energy : 0.0;
  for (int k = 0; k < a.n; ++k) {
    double const D = a.cracking[k];
    double const whole = 1.0 - D;
    if (!(whole > 0.0) || w.held[k] >= 2.0 / 3.0 * w.kept[k] - tensile.sigma0 * whole) continue;
    double const q = t.mises[k];
    double const principal = q > 0.0 ? largest_principal(a, k, q) : 0.0;  // of the trial
    double const stress = -w.held[k] + (q > 0.0 ? principal * (w.kept[k] / q) : 0.0);
    double grown = tensile.grown(D, stress / whole, step.dt);
    if (band && grown > D) {
      // Damage that leaves the stress within the softened surface is free; beyond, the crack has to open.
      double const sound = model.A * (1.0 - a.crushing[k]) * model.fc * w.rate[k];
      double const pulled = -std::min(w.held[k], 0.0) / (tensile.T_max * (1.0 - a.crushing[k]));
      double const pressed = std::max(w.held[k], 0.0) / model.fc;
      double const friction = model.B * model.fc * w.rate[k] * pow_nonnegative(pressed, model.N);
      double const load = sound > 0.0 ? std::max(w.kept[k] - friction, 0.0) / sound + pulled : 1.0;
      // Opening from the plastic work of the step, and from that of the fall of the stress by the damage itself: where
      // the second alone would be enough the fall is sudden, the energy that of the elastic strain.
      double const pull = std::max(-w.held[k], 0.0);
      double const slack = std::max(w.held[k] - w.trial[k], 0.0);
      double const worked = w.kept[k] * (q - w.kept[k]) / (3.0 * model.G) + pull * slack / w.modulus[k];
      double const stored = w.kept[k] * w.kept[k] / (3.0 * model.G) + pull * pull / w.modulus[k];
      double const brittle = stress - per_opening * stored;
      double const softening = brittle > 0.0 ? whole * per_opening * worked / brittle : 1.0;
      grown = std::min(grown, std::max(D, 1.0 - load) + softening);
    }
    grown = 1.0 - grown < TensileDamage::open ? 1.0 : grown;
    a.cracking[k] = std::max(D, grown);
  }
}

/// Pressure and deviator at the end of the step.
void settle(Hjc const model, double T_max, double minimum, ParticleArrays const& a, Scratch& t, Concrete& w) {
  int const n = a.n;
  double const* const free = w.free;
  double const* const rate = w.rate;
  double const* const crushing = a.crushing;
  double const* const cracking = a.cracking;
  double* const damage = a.damage;
  double* const mises = t.mises;
  double* const increment = t.increment;
  double* const scale = t.scale;
  double* const p1 = w.p1;
  double const per_three_G = 1.0 / (3.0 * model.G);
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const D = total_damage(crushing[k], cracking[k]);
    double const cut = -T_max * (1.0 - D);
    double const bound = cut > minimum ? cut : minimum;
    double const p = free[k] > bound ? free[k] : bound;
    double const most = model.strength(p, D, rate[k], T_max);
    double const trial = mises[k];
    double const end = trial < most ? trial : most;
    damage[k] = D;
    p1[k] = p;
    increment[k] = (trial - end) * per_three_G;
    scale[k] = end / (trial > 0.0 ? trial : 1.0);
    mises[k] = end;
  }
}

}  // namespace

void update_concrete(Material const& solid, Hjc const& model, ParticleArrays const& a, StepData const& step,
                     Scratch& t) {
  Concrete w;
  auto const& eos = std::get<Compaction>(solid.eos);
  auto const* tensile = std::get_if<TensileDamage>(&solid.failure);
  double const T_max = tensile != nullptr ? tensile->T_max : model.T;
  trial_deviator(a, model.G, t);
  compact(eos.curves(), a, w);
  rate_factors(model, a, step.dt, w);
  crush(model, T_max, tensile != nullptr, a, t, w);
  if (tensile != nullptr) crack(*tensile, model, a, step, t, w);
  settle(model, T_max, solid.minimum_pressure, a, t, w);
  scale_deviator(a, t);
  int const n = a.n;
  double* const work = t.work;
  double const* const trial_work = t.trial_work;
  double const* const scale = t.scale;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) work[k] += scale[k] * trial_work[k];
  plastic_flow(a, solid.specific_heat, solid.taylor_quinney, t);
  fill(t.widest, n, 1.0 / solid.density);
  finish(ColdPressure{w.p1, w.modulus}, a, step, model.G, t);
}

}  // namespace brisance::material
