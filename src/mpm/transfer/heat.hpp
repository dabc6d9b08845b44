/// Conduction of heat in shocks.
#pragma once

#include "mpm/transfer/set.hpp"

namespace brisance::mpm {

template <class S, int D>
struct Heat {
  /// Fraction of a particle's heat that a step exchanges.
  static double exchanged(double conduction, double p, double q) {
    double const positive = p > 0.0 ? p : 0.0;
    double const fraction = conduction * q / (q > 0.0 ? positive + q : 1.0);
    return q > 0.0 ? (fraction < 0.5 ? fraction : 0.5) : 0.0;
  }

  /// Internal energy and mass of the particles, and the part that is exchanged: see `Body::shock_conduction`.
  static void map_heat(SetView const& v, NodeVelocity* nodes) {
    ParticleSet const& set = *v.set;
    for_chunks<S, D, false>(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      double const* energy = set.field(Field::energy) + begin;
      double const* pressure = set.field(Field::pressure) + begin;
      double const* viscosity = set.field(Field::viscosity) + begin;
      alignas(64) double part[chunk];
      double const conduction = v.body->shock_conduction;
      BRISANCE_VECTOR_LOOP
      for (int q = 0; q < n; ++q) part[q] = exchanged(conduction, pressure[q], viscosity[q]);
      alignas(64) Lanes4 record[chunk];
      for (int q = 0; q < n; q += 4) {
        Lanes4 const m = four_at(mass + q);
        transpose(m * four_at(energy + q), m * four_at(part + q), Lanes4{}, m, record + q);
      }
      add_values<S, D>(*v.patch, k, n, record, nodes, whole);
    });
  }

  /// Exchanges heat with the nodes, which hold (energy per mass * part, part, -, mass): what one particle gives at a
  /// node others take.
  static ConductionCount take_heat(SetView const& v, NodeVelocity const* nodes) {
    ParticleSet& set = *v.set;
    ConductionCount count;
    for_chunks<S, D, false>(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      double const* density = set.field(Field::density) + begin;
      double* energy = set.field(Field::energy) + begin;
      double* pressure = set.field(Field::pressure) + begin;
      double const* Y = set.field(Field::mass_fraction);
      double const* alpha = set.field(Field::volume_fraction);
      alignas(64) double seen[2][chunk];
      find_values<S, D>(*v.patch, k, n, nodes, seen);
      for (int q = 0; q < n; ++q) {
        double const gained = seen[0][q] - seen[1][q] * energy[q];
        if (gained == 0.0) continue;
        energy[q] += gained;
        count.made += mass[q] * gained;
        count.moved += std::max(0.0, mass[q] * gained);
        pressure[q] =
            std::max(material::pressure(v.body->solid, density[q], energy[q], Y == nullptr ? 0.0 : Y[begin + q],
                                        alpha == nullptr ? 0.0 : alpha[begin + q]),
                     v.body->solid.minimum_pressure);
      }
    });
    return count;
  }
};

}  // namespace brisance::mpm
