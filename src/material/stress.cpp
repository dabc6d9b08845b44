#include "material/stress.hpp"

#include <cmath>
#include <type_traits>
#include <variant>

#include "core/loops.hpp"
#include "core/math.hpp"
#include "material/fluids.hpp"
#include "material/stress_stages.hpp"
#include "material/stress_yield.hpp"

namespace brisance::material {

namespace {

/// Arrays in ParticleArrays.
constexpr int arrays_of_a_particle = 31;

/// Calls f with every array that is read only.
template <class F>
void for_inputs(ParticleArrays& a, F const f) {
  for (auto& x : a.strain) f(x);
  for (auto& x : a.spin) f(x);
  f(a.volumetric);
  f(a.burn);
  f(a.mass_fraction);
  f(a.volume_fraction);
}

/// Calls f with every array that the step changes.
template <class F>
void for_state(ParticleArrays& a, F const f) {
  for (auto& x : a.deviator) f(x);
  for (auto* x : {&a.pressure, &a.viscosity, &a.density, &a.energy, &a.plastic_strain, &a.plastic_work, &a.temperature,
                  &a.damage, &a.crushing, &a.cracking, &a.compression, &a.sound_speed}) {
    f(*x);
  }
}

/// The arrays of particles `first` to `first + n`.
ParticleArrays window(ParticleArrays const& a, int first, int n) {
  ParticleArrays w = a;
  w.n = n;
  auto const shift = [first](auto& x) { x = x == nullptr ? nullptr : x + first; };
  for_inputs(w, shift);
  for_state(w, shift);
  return w;
}

/// The deviator and what depends on it; fills `work` and `floor`.
void deviator_stage(NoStrength const /*model*/, Material const& /*solid*/, ParticleArrays const& a, double /*dt*/,
                    Scratch& t) {
  fill(t.work, a.n, 0.0);
}

void deviator_stage(Elastic const model, Material const& /*solid*/, ParticleArrays const& a, double /*dt*/,
                    Scratch& t) {
  trial_deviator(a, model.G, t);
  int const n = a.n;
  double* const work = t.work;
  double const* const trial_work = t.trial_work;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) work[k] += trial_work[k];
}

template <class Plastic>
void deviator_stage(Plastic const model, Material const& solid, ParticleArrays const& a, double dt, Scratch& t) {
  int const n = a.n;
  trial_deviator(a, model.G, t);
  if (a.temperature != nullptr) {
    for (int k = 0; k < n; ++k) t.temperature[k] = a.temperature[k];
  } else {
    fill(t.temperature, n, solid.temperature);
  }
  bool const yields = plastic_increments(model, a, dt, t);
  double* const scale = t.scale;
  double* const mises = t.mises;
  double const* const increment = t.increment;
  if (yields) {
    double const three_G = 3.0 * model.G;
    BRISANCE_VECTOR_LOOP
    for (int k = 0; k < n; ++k) {
      double const trial = mises[k];
      double const left = trial - three_G * increment[k];
      double const end = left > 0.0 ? left : 0.0;
      scale[k] = end / (trial > 0.0 ? trial : 1.0);
      mises[k] = end;
    }
  } else {
    fill(scale, n, 1.0);
  }
  bool const damages = a.damage != nullptr && solid.damages();
  if (damages) {
    std::visit(
        [&](auto const& failure) {
          using Model = std::decay_t<decltype(failure)>;
          if constexpr (Model::damages) {
            if (yields) grow_damage(failure, scales_of(model), a, dt, t);
          }
        },
        solid.failure);
    lose_strength(a, solid.density, t);
  }
  double* const work = t.work;
  double const* const trial_work = t.trial_work;
  if (yields || damages) scale_deviator(a, t);
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) work[k] += scale[k] * trial_work[k];
  if (yields) plastic_flow(a, solid.specific_heat, solid.taylor_quinney, t);
}

/// One equation of state for all particles of a chunk.
template <class E>
struct CommonEos {
  E eos;

  [[nodiscard]] double gruneisen(int /*k*/) const { return eos.gruneisen(); }
  [[nodiscard]] double reference(int /*k*/, double rho) const { return eos.reference(rho); }
  [[nodiscard]] double rho_d_reference(int /*k*/, double rho) const { return eos.rho_d_reference(rho); }
};

/// An equation of state for each particle, known at its density at the end of the step.
struct OwnEos {
  double const* G;
  double const* f;
  double const* df;

  [[nodiscard]] double gruneisen(int k) const { return G[k]; }
  [[nodiscard]] double reference(int k, double /*rho*/) const { return f[k]; }
  [[nodiscard]] double rho_d_reference(int k, double /*rho*/) const { return df[k]; }
};

/// Is anything but the ambient fluid in the chunk?
[[nodiscard]] bool mixes_anywhere(Fluids const& fluids, ParticleArrays const& a) {
  if (!fluids.mixed() || a.mass_fraction == nullptr || a.volume_fraction == nullptr) return false;
  return count_beyond(a.volume_fraction, a.n, vanishing_fraction) > 0;
}

/// Fills in the equations of state of particles that mix. The ambient fluid alone has exactly its own one: a particle
/// must not depend on whether its neighbours mix.
void blend(Fluids const& fluids, ParticleArrays const& a, Blend& m) {
  int const n = a.n;
  double const* const volumetric = a.volumetric;
  double const* const density = a.density;
  double const* const Y = a.mass_fraction;
  double const* const alpha = a.volume_fraction;
  double* const ambient = m.partial[0];
  double* const other = m.partial[1];
  double* const G = m.G;
  double* const f = m.f;
  double* const df = m.df;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const rho = density[k] / volume_ratio(volumetric[k]);
    ambient[k] = (1.0 - Y[k]) * rho;
    other[k] = Y[k] * rho;
  }
  fill(G, n, 0.0);
  fill(f, n, 0.0);
  fill(df, n, 0.0);
  std::visit([&](auto const& eos) { add_fluid_sums(eos, n, Rest<1>{{alpha}}, ambient, nullptr, 0.0, G, f, df); },
             fluids.ambient());
  std::visit([&](auto const& eos) { add_fluid_sums(eos, n, Own{alpha}, other, nullptr, 0.0, G, f, df); },
             fluids.eos[1]);
  std::visit(
      [=](auto const eos) {
        BRISANCE_VECTOR_LOOP
        for (int k = 0; k < n; ++k) {
          double const rho = density[k] / volume_ratio(volumetric[k]);
          double const per_xi = 1.0 / G[k];
          double const B = f[k];
          double const H = df[k];
          bool const mixes = std::abs(alpha[k]) > vanishing_fraction;
          G[k] = mixes ? per_xi : eos.gruneisen();
          f[k] = mixes ? -B * per_xi : eos.reference(rho);
          df[k] = mixes ? (H - B) * per_xi : eos.rho_d_reference(rho);
        }
      },
      fluids.ambient());
}

/// The pressure of an equation of state, linear in the energy. `slowest` [m/s] bounds the sound speed of what is not
/// burnt out from below: the front of a programmed burn runs through particles that have no stiffness yet.
template <class PointwiseEos>
struct PressureOfEnergy {
  PointwiseEos eos;
  double const* floor;
  double const* burn;
  double slowest;

  struct At {
    double f, df, g, per_e;  ///< p1 = f + per_e e1
    double change, floor;

    /// At the new density, before the energy of this step.
    [[nodiscard]] double bulk(double e0) const {
      double const stiff = (1.0 + g) * (f + per_e * e0) + df - f;
      return stiff > 0.0 ? stiff : 0.0;
    }
    [[nodiscard]] End end(double p0, double e0, double deviatoric, double q) const {
      double const known = e0 + deviatoric - (0.5 * p0 + q) * change;
      double const implicit = 1.0 + 0.5 * per_e * change;
      double const e_free = (known - 0.5 * f * change) / (implicit > 0.5 ? implicit : 0.5);
      double const p_free = f + per_e * e_free;
      double const e_cut = known - 0.5 * floor * change;
      double const bulk = (1.0 + g) * p_free + df - f;
      return {p_free < floor ? floor : p_free, p_free < floor ? e_cut : e_free, bulk > 0.0 ? bulk : 0.0};
    }
  };
  [[nodiscard]] At at(int k, Volumes const v) const {
    double const F = burn[k];
    double const g = F * eos.gruneisen(k);
    return {F * eos.reference(k, v.density),
            F * eos.rho_d_reference(k, v.density),
            g,
            g * v.density,
            v.after - v.before,
            floor[k]};
  }
  [[nodiscard]] double least_speed(int k) const { return burn[k] < 1.0 ? slowest : 0.0; }
};

void update_chunk(Material const& solid, ParticleArrays const& a, StepData const& step, Scratch& t) {
  if (auto const* hjc = std::get_if<Hjc>(&solid.strength)) return update_concrete(solid, *hjc, a, step, t);
  if (auto const* soil = std::get_if<DruckerPrager>(&solid.strength)) return update_soil(solid, *soil, a, step, t);
  fill(t.floor, a.n, solid.minimum_pressure);
  fill(t.widest, a.n, unbounded);
  if (a.burn != nullptr) {
    for (int k = 0; k < a.n; ++k) t.burn[k] = a.burn[k];
  } else {
    fill(t.burn, a.n, 1.0);
  }
  std::visit(
      [&]<class Model>(Model const& strength) {
        if constexpr (!requires { Model::pressure_dependent; }) deviator_stage(strength, solid, a, step.dt, t);
      },
      solid.strength);
  double const shear = shear_modulus(solid.strength);
  auto const with = [&](auto const& eos) {
    finish(PressureOfEnergy<std::decay_t<decltype(eos)>>{eos, t.floor, t.burn, solid.detonation_speed}, a, step, shear,
           t);
  };
  auto const with_common = [&](auto const& eos) { with(CommonEos<std::decay_t<decltype(eos)>>{eos}); };
  if (!solid.mixes()) {
    std::visit(with_common, solid.eos);
  } else if (!mixes_anywhere(*solid.mixture, a)) {
    std::visit(with_common, solid.mixture->ambient());
  } else {
    blend(*solid.mixture, a, t.blend);
    with(OwnEos{t.blend.G, t.blend.f, t.blend.df});
  }
  tear(solid, a);
}

/// The last particles, too few for a whole number of vectors: on copies, filled up with more of the first of them.
void update_rest(Material const& solid, ParticleArrays const& a, StepData const& step, Scratch& t) {
  double copies[arrays_of_a_particle][lanes];
  ParticleArrays padded = a;
  padded.n = lanes;
  int used = 0;
  auto const copy = [&](auto& x) {
    if (x == nullptr) return;
    double* const to = copies[used++];
    for (int k = 0; k < lanes; ++k) to[k] = x[k < a.n ? k : 0];
    x = to;
  };
  for_inputs(padded, copy);
  int const first_of_state = used;
  for_state(padded, copy);
  update_chunk(solid, padded, step, t);
  used = first_of_state;
  ParticleArrays original = a;
  for_state(original, [&](double* x) {
    if (x == nullptr) return;
    double const* const from = copies[used++];
    for (int k = 0; k < a.n; ++k) x[k] = from[k];
  });
}

}  // namespace

void update_stress(Material const& solid, ParticleArrays const& particles, StepData const& step) {
  Scratch scratch;
  int const whole = particles.n / lanes * lanes;
  for (int first = 0; first < whole; first += chunk) {
    int const n = whole - first < chunk ? whole - first : chunk;
    update_chunk(solid, window(particles, first, n), step, scratch);
  }
  if (whole < particles.n) update_rest(solid, window(particles, whole, particles.n - whole), step, scratch);
}

}  // namespace brisance::material
