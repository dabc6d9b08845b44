/// Conduction of heat in shocks.
#pragma once

#include "mpm/transfer/set.hpp"

namespace brisance::mpm {

template <class S, int D>
struct Heat {
  /// Fraction of a particle's heat that a step exchanges.
  static double exchanged(double conduction, double p, double q) {
    return q > 0.0 ? std::min(0.5, conduction * q / (std::max(p, 0.0) + q)) : 0.0;
  }

  /// Internal energy and mass of the particles, and the part that is exchanged: see `Body::shock_conduction`.
  static void map_heat(SetView const& v, NodeVelocity* nodes) {
    ParticleSet const& set = *v.set;
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      double const* energy = set.field(Field::energy) + begin;
      double const* pressure = set.field(Field::pressure) + begin;
      double const* viscosity = set.field(Field::viscosity) + begin;
      for (int q = 0; q < n; ++q) {
        double const m = mass[q];
        double const fraction = exchanged(v.body->shock_conduction, pressure[q], viscosity[q]);
        add<S, D>(*v.patch, k, q, nodes, whole, Lanes4{m * energy[q], m * fraction, 0.0, m});
      }
    });
  }

  /// Exchanges heat with the nodes, which hold (energy per mass * part, part, -, mass): what one particle gives at a
  /// node others take.
  static ConductionCount take_heat(SetView const& v, NodeVelocity const* nodes) {
    ParticleSet& set = *v.set;
    ConductionCount count;
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      double const* density = set.field(Field::density) + begin;
      double* energy = set.field(Field::energy) + begin;
      double* pressure = set.field(Field::pressure) + begin;
      double const* Y = set.field(Field::mass_fraction);
      double const* alpha = set.field(Field::volume_fraction);
      for (int q = 0; q < n; ++q) {
        Lanes4 seen;
        velocity_at<S, D>(*v.patch, k, q, nodes, seen);
        double const gained = seen[0] - seen[1] * energy[q];
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
