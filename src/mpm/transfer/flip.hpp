/// Points that add the change of the nodes' velocity to their own: FLIP, with a part of PIC or the filter of XPIC.
#pragma once

#include "mpm/transfer/set.hpp"

namespace brisance::mpm {

template <class S, int D>
struct Flip {
  /// Velocity and motion of the points, [Cui14] Eqs. (24)-(25), the latter with the nodes' new velocity. Returns the
  /// kinetic energy that they lose by constraints and walls (gains count negative), by the filters and by friction.
  static Dissipation move(SetView const& v, Options const& options, double dt, NodeState const* nodes,
                          NodeChanges const& changes) {
    PointSet& set = *v.set;
    double const pic = v.body->transfer.value_or(options.transfer) == Transfer::flip ? options.pic_fraction : 0.0;
    Dissipation dissipated;
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      auto const u = vector_at(set, Field::velocity_x, begin);
      auto const way = vector_at(set, Field::move_x, begin);
      alignas(64) double fresh[3][chunk];
      alignas(64) double change[3][chunk];
      for (int q = 0; q < n; ++q) {
        Lanes4 velocity;
        Lanes4 added;
        state_at<S, D>(*v.patch, k, q, nodes, velocity, added);
        for (int d = 0; d < 3; ++d) {
          fresh[d][q] = velocity[d];
          change[d][q] = added[d];
        }
        // What constraints, walls and friction take: each at the mean velocity, half of what they change together in
        // it. The forces do their work with the stress, and share it with friction alone.
        std::array<NodeVelocity const*, 3> const causes{changes.halt, changes.stop, changes.rub};
        std::array<Lanes4, 3> by{};
        Lanes4 all{};
        for (std::size_t c = 0; c < causes.size(); ++c) {
          if (causes[c] == nullptr) continue;
          velocity_at<S, D>(*v.patch, k, q, causes[c], by[c]);
          all += by[c];
        }
        double const m = set.field(Field::mass)[begin + q];
        for (int d = 0; d < 3; ++d) {
          dissipated.held -= m * (by[0][d] + by[1][d]) * (u[d][q] + 0.5 * all[d]);
          dissipated.friction -= m * by[2][d] * (u[d][q] + 0.5 * change[d][q]);
        }
        if (changes.exchange == nullptr) continue;
        Lanes4 taken;
        velocity_at<S, D>(*v.patch, k, q, changes.exchange, taken);
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
        double* to = u[d];
        double* x = way[d];
        double const* f = fresh[d];
        double const* c = change[d];
        BRISANCE_VECTOR_LOOP
        for (int q = 0; q < n; ++q) {
          to[q] = (1.0 - pic) * (to[q] + c[q]) + pic * f[q];
          x[q] = dt * f[q];
        }
        if (double const* noise = filtered[d]) {
          for (int q = 0; q < n; ++q) to[q] -= noise[q];
        }
        for (int q = 0; filters && q < n; ++q) dissipated.filtered -= 0.5 * mass[q] * to[q] * to[q];
      }
      if (changes.keep != nullptr) take_kept<S, D>(v, k, n, dt, changes.keep, way);
    });
    return dissipated;
  }

  /// XPIC: takes from `filtered` what the nodes see of it.
  static void filter(SetView const& v, NodeVelocity const* nodes) {
    PointSet& set = *v.set;
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
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
