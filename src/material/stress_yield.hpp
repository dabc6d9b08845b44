/// The stages of a step of the stress in which particles yield, take damage and tear: see stress.cpp. Private to this
/// folder.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/loops.hpp"
#include "core/math.hpp"
#include "material/stress_stages.hpp"

namespace brisance::material {

/// Increments of plastic strain from the trial Mises stresses, 0 where nothing yields. Returns whether any point
/// yields.
template <class Model>
requires requires(Model const model) { model.plastic_increment(0.0, 0.0); }
bool plastic_increments(Model const model, ParticleArrays const& a, double /*dt*/, Scratch& t) {
  int const n = a.n;
  double const* const ep = a.plastic_strain;
  double const* const mises = t.mises;
  double* const increment = t.increment;
  long yielding = 0;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const x = model.plastic_increment(mises[k], ep[k]);
    increment[k] = x;
    yielding += x > 0.0 ? 1 : 0;
  }
  return yielding > 0;
}

/// One Newton step for every particle that is not consistent yet; returns how many were not. A particle that is
/// consistent stays as it is, so that its result does not depend on its neighbours. Three short loops: a single one
/// would wait for the chain of exp, log and exp.
inline long newton_step(JohnsonCook const model, int n, double log_rate, Yielding& y) {
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) y.x[k] = exp_bounded(y.u[k]);
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) y.hard[k] = model.hardened(y.ep[k] + y.x[k]);
  long open = 0;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const kept = y.u[k];
    auto const r = model.residual(kept, y.x[k], y.mises[k], y.ep[k], y.hard[k], y.soft[k], log_rate);
    double const miss = std::abs(r.value);
    double const bound = y.tolerance[k];
    double const moved = kept - r.value / r.slope;
    y.u[k] = miss > bound ? moved : kept;
    open += miss > bound ? 1 : 0;
  }
  return open;
}

/// Bound of the Newton steps: two million random states, many far beyond any use, needed 3.4 on average, at most 15.
inline constexpr int most_newton_steps = 32;

inline bool plastic_increments(JohnsonCook const model, ParticleArrays const& a, double dt, Scratch& t) {
  int const n = a.n;
  double const* const ep = a.plastic_strain;
  double const* const temperature = t.temperature;
  double const* const mises = t.mises;
  double* const increment = t.increment;
  double* const soft = t.soft;
  double* const slow = t.slow;
  if (count_above(temperature, n, model.T_room) > 0) {
    BRISANCE_VECTOR_LOOP
    for (int k = 0; k < n; ++k) soft[k] = model.softening(temperature[k]);
  } else {
    fill(soft, n, 1.0);
  }
  double const inverse = 1.0 / (3.0 * model.G);
  long yielding = 0;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const yield = model.slow_yield_stress(model.hardened(ep[k]), soft[k]);
    double const excess = mises[k] - yield;
    slow[k] = yield;
    // Without hardening and rate the increment would be this one: right of the root.
    increment[k] = (excess > 0.0 ? excess : 0.0) * inverse;
    yielding += excess > 0.0 ? 1 : 0;
  }
  if (yielding == 0) return false;

  // The yielding particles next to each other, filled up to whole vectors with copies of the first.
  Yielding& y = t.yielding;
  int m = 0;
  for (int k = 0; k < n; ++k) {
    y.particle[m] = k;
    m += increment[k] > 0.0 ? 1 : 0;
  }
  int const whole = (m + lanes - 1) / lanes * lanes;
  for (int j = m; j < whole; ++j) y.particle[j] = y.particle[0];
  for (int j = 0; j < whole; ++j) {
    int const k = y.particle[j];
    y.mises[j] = mises[k];
    y.ep[j] = ep[k];
    y.soft[j] = soft[k];
    y.x[j] = increment[k];
    y.tolerance[j] = 1e-11 * slow[k] + 1e-13 * mises[k];
  }
  BRISANCE_VECTOR_LOOP
  for (int j = 0; j < whole; ++j) y.u[j] = log_positive(y.x[j]);
  double const log_rate = -std::log(dt * model.rate0);
  for (int pass = 0; pass < most_newton_steps; ++pass) {
    if (newton_step(model, whole, log_rate, y) == 0) break;
  }
  BRISANCE_VECTOR_LOOP
  for (int j = 0; j < whole; ++j) y.x[j] = exp_bounded(y.u[j]);
  for (int j = 0; j < m; ++j) increment[y.particle[j]] = y.x[j];
  return true;
}

/// Scales of rate and temperature of the failure model.
struct Scales {
  double rate0 = 1.0;
  double T_room = 0.0;
  double inverse_span = 0.0;  ///< 1 / (T_melt - T_room) [1/K]; 0: no dependence on temperature
};
template <class Model>
Scales scales_of(Model const& /*model*/) {
  return {};
}
inline Scales scales_of(JohnsonCook const& model) {
  return {model.rate0, model.T_room, 1.0 / (model.T_melt - model.T_room)};
}

/// Damage by the increments of plastic strain.
template <class Model>
void grow_damage(Model const model, Scales const scales, ParticleArrays const& a, double dt, Scratch& t) {
  int const n = a.n;
  double* const D = a.damage;
  double const* const p = a.pressure;
  double const* const mises = t.mises;
  double const* const temperature = t.temperature;
  double* const increment = t.increment;
  double const per_rate0 = 1.0 / (dt * scales.rate0);
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const before = D[k];
    double const x = before < 1.0 ? increment[k] : 0.0;
    double const q = mises[k];
    double const triaxiality = -p[k] / (q > 1.0 ? q : 1.0);
    double const r = x * per_rate0;
    double const log_rate = log_positive(r > 1.0 ? r : 1.0);
    double const y = (temperature[k] - scales.T_room) * scales.inverse_span;
    double const above = y > 0.0 ? y : 0.0;
    double const hot = above < 1.0 ? above : 1.0;
    double const grown = before + x / model.failure_strain(triaxiality, log_rate, hot);
    D[k] = grown < 1.0 ? grown : 1.0;
    increment[k] = x;
  }
}

/// What has failed loses its deviator and bears no tension.
inline void lose_strength(ParticleArrays const& a, double density, Scratch& t) {
  int const n = a.n;
  double const* const D = a.damage;
  double* const scale = t.scale;
  double* const floor = t.floor;
  double* const widest = t.widest;
  double const as_solid = 1.0 / density;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const whole = D[k];
    double const kept = scale[k];
    double const bound = floor[k];
    scale[k] = whole < 1.0 ? kept : 0.0;
    floor[k] = whole < 1.0 ? bound : 0.0;
    widest[k] = whole < 1.0 ? unbounded : as_solid;
  }
}

/// Largest principal stress [Pa].
inline double largest_principal(ParticleArrays const& a, int k) {
  double s[6];
  for (int c = 0; c < 6; ++c) s[c] = a.deviator[c][k];
  double const J2 = 0.5 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) + s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
  if (!(J2 > 0.0)) return -a.pressure[k];
  double const J3 =
      s[0] * (s[1] * s[2] - s[4] * s[4]) - s[3] * (s[3] * s[2] - s[4] * s[5]) + s[5] * (s[3] * s[4] - s[1] * s[5]);
  double const lode = std::clamp(1.5 * std::sqrt(3.0) * J3 / (J2 * std::sqrt(J2)), -1.0, 1.0);
  return 2.0 * std::sqrt(J2 / 3.0) * std::cos(std::acos(lode) / 3.0) - a.pressure[k];
}

/// Spall: particles that the tension of the step has torn have failed.
inline void tear(Material const& solid, ParticleArrays const& a) {
  if (a.damage == nullptr || !solid.tears()) return;
  double const limit = solid.minimum_pressure;
  for (int k = 0; k < a.n; ++k) {
    bool const torn = solid.spall == Spall::pressure ? a.pressure[k] <= limit : largest_principal(a, k) >= -limit;
    if (torn) a.damage[k] = 1.0;
  }
}

}  // namespace brisance::material
