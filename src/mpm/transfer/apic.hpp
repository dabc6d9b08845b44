/// Particles that take over the velocity of the nodes and its gradient, [Jiang15].
#pragma once

#include "mpm/transfer/set.hpp"

namespace brisance::mpm {

template <class S, int D>
struct Apic {
  /// Velocity and motion of the particles, [Cui14] Eqs. (24)-(25): the nodes' new velocity and its gradient. The nodes
  /// hold kinetic energy per mass in the place of their mass, and what the particles' velocity and its gradient C do
  /// not take up of it, e = v^2/2 + h^2/8 C:C + h^4/32 B:B (B: the mixed derivatives), heats or is counted: h^2/4 is
  /// the second moment of the B-splines. With other shape functions, whose moments depend on the place, the energy of
  /// the gradient is no part of a particle's, and what it had given the nodes is taken off. Returns what is counted,
  /// and what friction takes.
  static Dissipation move(SetView const& v, double dt, BodyRules const& rules, FieldScratch const& nodes) {
    ParticleSet& set = *v.set;
    double const h = v.h;
    NodeVelocity const* taken = nodes.taken.data();
    NodeVelocity const* rub = nodes.rubs ? nodes.rub.data() : nullptr;
    NodeVelocity const* keep = nodes.meets ? nodes.keep.data() : nullptr;
    Dissipation dissipated;
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      auto const u = vector_at(set, Field::velocity_x, begin);
      auto const way = vector_at(set, Field::move_x, begin);
      alignas(64) double fresh[3][chunk];
      alignas(64) double lost[chunk];
      AffineWeights<S, D> around;
      find_affine_weights<S, D>(*v.patch, h, constant_at(set, Field::position_x, begin), n, k, around);
      double const inverse_h = 1.0 / h;
      bool const mixed = set.field(Field::cross_xy) != nullptr;
      for (int q = 0; q < n; ++q) {
        std::array<Lanes4, 7> sum;
        value_and_gradient<S, D>(*v.patch, k, around.g, q, taken, whole, sum);
        lost[q] = sum[0][3] - 0.5 * (sum[0][0] * sum[0][0] + sum[0][1] * sum[0][1] + sum[0][2] * sum[0][2]);
        if (!rules.has_gradient_energy) lost[q] -= gradient_energy(set, k, around, h, begin, q);
        for (int j = 0; rules.has_gradient_energy && j < D; ++j) {
          for (int i = 0; i < 3; ++i) lost[q] -= 0.125 * sum[1 + j][i] * sum[1 + j][i];
        }
        for (int pair = 0; mixed && pair < (D == 3 ? 3 : 1); ++pair) {
          for (int i = 0; i < 3; ++i) {
            lost[q] -= 0.03125 * sum[4 + pair][i] * sum[4 + pair][i];
            set.field(Field::cross_xy + (3 * pair + i))[begin + q] = sum[4 + pair][i] * inverse_h;
          }
        }
        for (int i = 0; i < 3; ++i) {
          fresh[i][q] = sum[0][i];
          for (int j = 0; j < D; ++j) {
            set.field(Field::affine_xx + (3 * i + j))[begin + q] = sum[1 + j][i] * inverse_h;
          }
        }
      }
      // These take over what the nodes say, see `Mpm::note_rubbing`.
      for (int q = 0; rub != nullptr && q < n; ++q) {
        Lanes4 given;
        velocity_at<S, D>(*v.patch, k, q, rub, given);
        dissipated.friction -= set.field(Field::mass)[begin + q] * given[3];
      }
      for (int d = 0; d < 3; ++d) {
        for (int q = 0; q < n; ++q) {
          u[d][q] = fresh[d][q];
          way[d][q] = dt * fresh[d][q];
        }
      }
      if (keep != nullptr) take_kept(v, k, n, dt, keep, way);
      if (rules.keeps_energy) {
        double* const energy = set.field(Field::energy) + begin;
        for (int q = 0; q < n; ++q) energy[q] += lost[q];
      } else {
        for (int q = 0; q < n; ++q) dissipated.apic += set.field(Field::mass)[begin + q] * lost[q];
      }
    });
    return dissipated;
  }

  /// Takes off the way of particles what only their velocity has, see contact.cpp.
  static void take_kept(SetView const& v, Weights<S, D> const& k, int n, double dt, NodeVelocity const* keep,
                        std::array<double*, 3> const& way) {
    for (int q = 0; q < n; ++q) {
      Lanes4 kept;
      velocity_at<S, D>(*v.patch, k, q, keep, kept);
      for (int d = 0; d < 3; ++d) way[d][q] -= dt * kept[d];
    }
  }

  /// What a particle gave the nodes by its velocity gradient, 1/2 sum w |C (x_I - x)|^2 [J/kg].
  static double gradient_energy(ParticleSet& set, Weights<S, D> const& k, AffineWeights<S, D> const& around, double h,
                                int begin, int q) {
    double sum = 0.0;
    for (int j = 0; j < D; ++j) {
      double moment = 0.0;
      for (int s = 0; s < S::support; ++s) {
        double const distance = around.first[j][q] + s * h;
        moment += k.w[j][s][q] * distance * distance;
      }
      for (int i = 0; i < 3; ++i) {
        double const c = set.field(Field::affine_xx + (3 * i + j))[begin + q];
        sum += 0.5 * moment * c * c;
      }
    }
    return sum;
  }

  /// Momentum that APIC's velocity gradient adds per distance in each direction.
  static std::array<Lanes4, 3> affine_columns(ParticleSet& set, int q, double m) {
    std::array<Lanes4, 3> c{};
    for (int j = 0; j < D; ++j) {
      for (int i = 0; i < 3; ++i) c[j][i] = m * set.field(Field::affine_xx + (3 * i + j))[q];
    }
    return c;
  }

  /// The same per product of two distances, from its mixed derivatives.
  static std::array<Lanes4, 3> mixed_columns(ParticleSet& set, int q, double m) {
    std::array<Lanes4, 3> c{};
    if (set.field(Field::cross_xy) == nullptr) return c;
    for (int pair = 0; pair < (D == 3 ? 3 : 1); ++pair) {
      for (int i = 0; i < 3; ++i) c[pair][i] = m * set.field(Field::cross_xy + (3 * pair + i))[q];
    }
    return c;
  }
};

}  // namespace brisance::mpm
