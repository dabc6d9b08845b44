/// Stress of particles from their strain.
#pragma once

#include "material/stress.hpp"
#include "mpm/burn.hpp"
#include "mpm/transfer/axis.hpp"
#include "mpm/transfer/bars.hpp"
#include "mpm/transfer/work.hpp"

namespace brisance::mpm {

template <class S, int D>
struct Stress {
  /// Burn fraction at the end of the step, [Cui14] Eqs. (52)-(53).
  static void burn(SetView const& v, double time, int begin, int n, double (&out)[chunk]) {
    double const* lighting = v.set->field(Field::lighting_time) + begin;
    double const rate = burn_rate(v.body->solid.detonation_speed, v.h);
    for (int q = 0; q < n; ++q) out[q] = burn_fraction(time, lighting[q], rate);
  }

  /// Stress of a chunk from its strain. Returns the fastest signal [m/s].
  static double stress(SetView const& v, Options const& options, double time, double dt, int begin, int n,
                       double const (&e)[10][chunk], double const* volumetric) {
    ParticleSet& set = *v.set;
    auto const at = [&](Field f) {
      double* values = set.field(f);
      return values == nullptr ? nullptr : values + begin;
    };
    alignas(64) double sound[chunk];
    alignas(64) double burnt[chunk];
    material::ParticleArrays arrays{};
    arrays.n = n;
    for (int c = 0; c < 6; ++c) {
      arrays.strain[c] = e[c];
      arrays.deviator[c] = at(Field::deviator_xx + c);
    }
    for (int d = 0; d < 3; ++d) arrays.spin[d] = e[6 + d];
    arrays.volumetric = volumetric;
    if (set.field(Field::lighting_time) != nullptr) {
      burn(v, time + dt, begin, n, burnt);
      arrays.burn = burnt;
    }
    arrays.pressure = at(Field::pressure);
    arrays.viscosity = at(Field::viscosity);
    arrays.density = at(Field::density);
    arrays.energy = at(Field::energy);
    arrays.plastic_strain = at(Field::plastic_strain);
    arrays.plastic_work = at(Field::plastic_work);
    arrays.temperature = at(Field::temperature);
    arrays.damage = at(Field::damage);
    arrays.crushing = at(Field::crushing);
    arrays.cracking = at(Field::cracking);
    arrays.compression = at(Field::compression);
    arrays.sound_speed = sound;
    arrays.mass_fraction = at(Field::mass_fraction);
    arrays.volume_fraction = at(Field::volume_fraction);
    material::update_stress(v.body->solid, arrays,
                            {dt, v.h, v.body->linear_viscosity.value_or(options.linear_viscosity),
                             v.body->quadratic_viscosity.value_or(options.quadratic_viscosity), v.body->viscosity_onset,
                             options.crack_band});
    if (set.field(Field::bar_number) != nullptr) strain_bars(v, begin, n, e, sound);
    for (int d = 0; d < D; ++d) {
      double* half = at(Field::half_x + d);
      if (half == nullptr) continue;
      double const* stretch = e[d];
      for (int q = 0; q < n; ++q) half[q] *= 1.0 + stretch[q];
    }
    auto const u = vector_at(set, Field::velocity_x, begin);
    double const* ux = u[0];
    double const* uy = u[1];
    double const* uz = u[2];
    double const detonation = set.field(Field::lighting_time) == nullptr ? 0.0 : v.body->solid.detonation_speed;
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) {
      double const c = sound[q] > detonation ? sound[q] : detonation;
      sound[q] = c + std::sqrt(ux[q] * ux[q] + uy[q] * uy[q] + uz[q] * uz[q]);
    }
    return largest_of(sound, n);
  }

  /// Takes the volumes of a chunk's particles towards the room that there is around them, see `Body::fills_space`;
  /// `filled` is what the particles fill of the cells around the nodes, by `map_filled`. They drift with the strain,
  /// and come back with it: gas in uniform motion stays as it is, to the last bit. Not beside open faces: nobody knows
  /// what fills the space behind them.
  static void fill_space(SetView const& v, Options const& options, int begin, int n, Weights<S, D> const& k,
                         double const* volumetric, NodeVelocity const* filled) {
    // Measured: from 5 to 80 the tubes and rooms of `Confined` come out alike.
    constexpr double per_strain = 20.0;
    constexpr double most_fraction = 0.3;  // of the difference in a step
    constexpr double most = 0.02;          // change of a volume in a step
    ParticleSet& set = *v.set;
    double* density = set.field(Field::density) + begin;
    double* energy = set.field(Field::energy) + begin;
    double const reference = v.body->reference_pressure;
    alignas(64) double seen[1][chunk];
    find_values<S, D>(*v.patch, k, n, filled, seen);
    for (int d = 0; d < D; ++d) {
      double const* x = set.field(Field::position_x + d) + begin;
      for (int side = 0; side < 2; ++side) {
        auto const& end = options.ends[2 * d + side];
        for (int q = 0; end && q < n; ++q) {
          if (std::abs(x[q] - *end) <= 3.0 * v.h) seen[0][q] = 1.0;  // not known: as if it were full
        }
      }
    }
    for (int q = 0; q < n; ++q) {
      double const fraction = std::min(most_fraction, per_strain * std::abs(volumetric[q]));
      double const change = std::clamp(fraction * (seen[0][q] - 1.0), -most, most);
      double const before = density[q];
      density[q] *= 1.0 + change;
      energy[q] += reference * (1.0 / before - 1.0 / density[q]);
    }
  }

  /// Strain and stress of a set, [Cui14] Eqs. (27)-(30). Returns the fastest signal [m/s]. `nodes`: the new velocities;
  /// `before`: those before the step, for `settle_work`, or null; `filled`: for `fill_space`, or null;
  /// `books`: does the body book the work of the nodes?
  static double update(SetView const& v, Options const& options, Hoops const& hoops, double time, double dt,
                       NodeVelocity const* nodes, NodeVelocity const* before, NodeVelocity const* filled,
                       NodeVelocity const* even, bool books, Scratch& scratch) {
    double fastest = 0.0;
    auto const stress_of = [&](int begin, int n, double const(&e)[10][chunk]) {
      alignas(64) double booked[chunk];
      if (books) NodeWork<S, D>::undo_half(v, begin, n, e, booked);
      double const signal = stress(v, options, time, dt, begin, n, e, e[9]);
      for (int q = 0; books && q < n; ++q)
        v.set->field(Field::provisional)[begin + q] = v.set->field(Field::energy)[begin + q] - booked[q];
      return signal;
    };
    if (!options.locking_control || !v.body->solid.has_deviator()) {
      for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
        alignas(64) double e[10][chunk];
        Strain<S, D>::strain(v, hoops, dt, begin, n, k, nodes, e);
        alignas(64) double density[chunk];
        if (before != nullptr) {
          NodeWork<S, D>::settle_work(v, hoops, dt, begin, n, k, before, e[9]);
          std::copy_n(v.set->field(Field::density) + begin, n, density);
        }
        if (filled != nullptr) fill_space(v, options, begin, n, k, e[9], filled);
        if (even != nullptr) BesideAxis<S, D>::even_out(v, begin, n, k, e, even);
        fastest = std::max(fastest, stress_of(begin, n, e));
        if (before != nullptr) NodeWork<S, D>::note_work(v, begin, n, e[9], density);
      });
      return fastest;
    }
    ParticleSet const& set = *v.set;
    int const particles = set.size();
    double const* mass = set.field(Field::mass);
    double const* density = set.field(Field::density);
    scratch.strain.resize(static_cast<std::size_t>((particles + chunk - 1) / chunk) * 10 * chunk);
    auto* stored = reinterpret_cast<double(*)[10][chunk]>(scratch.strain.data());
    CellMeans means(v, scratch);
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      auto& e = stored[begin / chunk];
      Strain<S, D>::strain(v, hoops, dt, begin, n, k, nodes, e);
      if (even != nullptr) BesideAxis<S, D>::even_out(v, begin, n, k, e, even);
      for (int q = 0; q < n; ++q) means.add(begin + q, mass[begin + q] / density[begin + q], e[9][q]);
    });
    for (int begin = 0; begin < particles; begin += chunk) {
      int const n = std::min(chunk, particles - begin);
      auto& e = stored[begin / chunk];
      for (int q = 0; q < n; ++q) e[9][q] = means.mean(begin + q);
      fastest = std::max(fastest, stress_of(begin, n, e));
    }
    return fastest;
  }
};

}  // namespace brisance::mpm
