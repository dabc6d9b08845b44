/// Particles that add the change of the nodes' velocity to their own: FLIP, with a part of PIC or the filter of XPIC.
#pragma once

#include "mpm/transfer/set.hpp"

namespace brisance::mpm {

template <class S, int D>
struct Flip {
  /// Velocity and motion of the particles, [Cui14] Eqs. (24)-(25), the latter with the nodes' new velocity. Returns the
  /// kinetic energy that they lose by constraints and walls (gains count negative), by the filters and by friction.
  /// `back`: the nodes that the new velocity is mapped back to, Eq. (26), or null.
  static Dissipation move(SetView const& v, Options const& options, double dt, FieldScratch const& nodes,
                          NodeVelocity* back) {
    ParticleSet& set = *v.set;
    double const pic = v.body->transfer.value_or(options.transfer) == Transfer::flip ? options.pic_fraction : 0.0;
    NodeMotion const* motion = nodes.motion.data();
    NodeVelocity const* exchange = nodes.exchanges ? nodes.exchange.data() : nullptr;
    NodeVelocity const* halt = nodes.halts ? nodes.halt.data() : nullptr;
    NodeVelocity const* stop = nodes.stops ? nodes.stop.data() : nullptr;
    NodeVelocity const* rub = nodes.rubs ? nodes.rub.data() : nullptr;
    NodeVelocity const* keep = nodes.meets && pic > 0.0 ? nodes.keep.data() : nullptr;
    bool const books = halt != nullptr || stop != nullptr || rub != nullptr;
    Dissipation dissipated;
    for_chunks<S, D, false>(v, [&](int begin, int n, Weights<S, D> const& k) {
      auto const u = vector_at(set, Field::velocity_x, begin);
      auto const way = vector_at(set, Field::move_x, begin);
      alignas(64) double fresh[3][chunk];
      alignas(64) double change[3][chunk];
      find_motion(v, k, n, motion, fresh, change);
      for (int q = 0; (books || exchange != nullptr) && q < n; ++q) {
        if (books) {
          book(v, k, q, {halt, stop, rub}, set.field(Field::mass)[begin + q], {u[0][q], u[1][q], u[2][q]},
               {change[0][q], change[1][q], change[2][q]}, dissipated);
        }
        if (exchange == nullptr) continue;
        Lanes4 taken;
        velocity_at<S, D>(*v.patch, k, q, exchange, taken);
        for (int d = 0; d < 3; ++d) change[d][q] += taken[d];
      }
      auto const filtered = vector_at(set, Field::filtered_x, begin);
      bool const filters = pic > 0.0 || filtered[0] != nullptr;
      double const* mass = set.field(Field::mass) + begin;
      for (int d = 0; filters && d < 3; ++d) {
        for (int q = 0; q < n; ++q) {
          double const moved = u[d][q] + change[d][q];
          dissipated.filtered += 0.5 * mass[q] * moved * moved;
        }
      }
      for (int d = 0; d < 3; ++d) {
        double* x = way[d];
        double const* f = fresh[d];
        BRISANCE_VECTOR_LOOP
        for (int q = 0; q < n; ++q) x[q] = dt * f[q];
      }
      // PIC takes over the velocity that the particles keep where bodies meet, not the one with which the nodes move.
      for (int q = 0; keep != nullptr && q < n; ++q) {
        Lanes4 kept;
        velocity_at<S, D>(*v.patch, k, q, keep, kept);
        for (int d = 0; d < 3; ++d) fresh[d][q] += kept[d];
      }
      for (int d = 0; d < 3; ++d) {
        double* to = u[d];
        double const* f = fresh[d];
        double const* c = change[d];
        BRISANCE_VECTOR_LOOP
        for (int q = 0; q < n; ++q) to[q] = (1.0 - pic) * (to[q] + c[q]) + pic * f[q];
        if (double const* noise = filtered[d]) {
          for (int q = 0; q < n; ++q) to[q] -= noise[q];
        }
        for (int q = 0; filters && q < n; ++q) dissipated.filtered -= 0.5 * mass[q] * to[q] * to[q];
      }
      if (back == nullptr) return;
      alignas(64) Lanes4 momentum[chunk];
      find_momentum(n, mass, {u[0], u[1], u[2]}, momentum);
      add_values<S, D>(*v.patch, k, n, momentum, back, whole);
    });
    return dissipated;
  }

  /// The nodes' new velocity, and its change, at the particles of a chunk.
  static void find_motion(SetView const& v, Weights<S, D> const& k, int n, NodeMotion const* motion,
                          double (&fresh)[3][chunk], double (&change)[3][chunk]) {
    auto const four = [&](int q) {
      Lanes4 sum[3];
      values_at_four<S, D>(*v.patch, k, q, motion, velocity_of, sum);
      for (int d = 0; d < 3; ++d) store_four(&fresh[d][q], sum[d]);
      values_at_four<S, D>(*v.patch, k, q, motion, change_of, sum);
      for (int d = 0; d < 3; ++d) store_four(&change[d][q], sum[d]);
    };
    auto const one = [&](int q) {
      Lanes4 velocity;
      Lanes4 added;
      state_at<S, D>(*v.patch, k, q, motion, velocity, added);
      for (int d = 0; d < 3; ++d) {
        fresh[d][q] = velocity[d];
        change[d][q] = added[d];
      }
    };
    for_fours(k, n, four, one);
  }

  /// What constraints, walls and friction take of a particle: each at the mean velocity, half of what they change
  /// together in it. The forces do their work with the stress, and share it with friction alone.
  static inline __attribute__((always_inline)) void book(SetView const& v, Weights<S, D> const& k, int q,
                                                         std::array<NodeVelocity const*, 3> const& causes, double m,
                                                         Vec3 const& velocity, Vec3 const& change, Dissipation& taken) {
    std::array<Lanes4, 3> by{};
    Lanes4 all{};
    for (std::size_t c = 0; c < causes.size(); ++c) {
      if (causes[c] == nullptr) continue;
      velocity_at<S, D>(*v.patch, k, q, causes[c], by[c]);
      all += by[c];
    }
    for (int d = 0; d < 3; ++d) {
      taken.constraints -= m * (by[0][d] + by[1][d]) * (velocity[d] + 0.5 * all[d]);
      taken.friction -= m * by[2][d] * (velocity[d] + 0.5 * change[d]);
    }
  }

  /// XPIC: takes from `filtered` what the nodes see of it.
  static void filter(SetView const& v, NodeVelocity const* nodes) {
    ParticleSet& set = *v.set;
    for_chunks<S, D, false>(v, [&](int begin, int n, Weights<S, D> const& k) {
      auto const u = vector_at(set, Field::filtered_x, begin);
      for (int q = 0; q < n; ++q) {
        Lanes4 seen;
        velocity_at<S, D>(*v.patch, k, q, nodes, seen);
        for (int d = 0; d < 3; ++d) u[d][q] -= seen[d];
      }
    });
  }
};

}  // namespace brisance::mpm
