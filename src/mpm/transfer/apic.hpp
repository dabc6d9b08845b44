/// Particles that take over the velocity of the nodes and its gradient, [Jiang15].
#pragma once

#include "mpm/affine.hpp"
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
    NodeVelocity const* taken = nodes.taken.data();
    NodeVelocity const* rub = nodes.rubs ? nodes.rub.data() : nullptr;
    NodeVelocity const* keep = nodes.meets ? nodes.keep.data() : nullptr;
    Dissipation dissipated;
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      auto const u = vector_at(set, Field::velocity_x, begin);
      auto const way = vector_at(set, Field::move_x, begin);
      alignas(64) double fresh[3][chunk];
      alignas(64) double lost[chunk];
      find_taken(v, rules, k, begin, n, taken, fresh, lost);
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

  /// Velocity, gradient and mixed derivatives that a chunk takes over, and what it loses of the nodes' energy.
  static void find_taken(SetView const& v, BodyRules const& rules, Weights<S, D> const& k, int begin, int n,
                         NodeVelocity const* taken, double (&fresh)[3][chunk], double (&lost)[chunk]) {
    ParticleSet& set = *v.set;
    AffineWeights<S, D> around;
    find_affine_weights<S, D>(*v.patch, v.h, constant_at(set, Field::position_x, begin), n, k, around);
    constexpr int records = 1 + D + pairs_of<D>;
    alignas(64) Lanes4 record[records][chunk];
    for (int q = 0; q < n; ++q) {
      std::array<Lanes4, 7> sum;
      value_and_gradient<S, D>(*v.patch, k, around.g, q, taken, whole, sum);
      for (int r = 0; r < 1 + D; ++r) record[r][q] = sum[r];
      for (int pair = 0; pair < pairs_of<D>; ++pair) record[1 + D + pair][q] = sum[4 + pair];
    }
    for (int q = n; q % 4 != 0; ++q) {
      for (auto& of : record) of[q] = Lanes4{};
    }
    double const inverse_h = 1.0 / v.h;
    bool const mixed = set.field(Field::cross_xy) != nullptr;
    // Before the gradient is overwritten.
    std::fill_n(lost, chunk, 0.0);
    for (int q = 0; !rules.has_gradient_energy && q < n; ++q) lost[q] = -gradient_energy(set, k, around, v.h, begin, q);
    auto const store = [&](int r, Field first, int stride, double weight) {
      double* to[3];
      for (int i = 0; i < 3; ++i) to[i] = set.field(first + stride * i) + begin;
      for (int q = 0; q < n; q += 4) {
        Lanes4 of[4];
        transpose(record[r][q], record[r][q + 1], record[r][q + 2], record[r][q + 3], of);
        for (int i = 0; i < 3; ++i) store_four(to[i] + q, inverse_h * of[i]);
        if (weight != 0.0)
          store_four(lost + q, four_at(lost + q) - weight * (of[0] * of[0] + of[1] * of[1] + of[2] * of[2]));
      }
    };
    for (int j = 0; j < D; ++j) store(1 + j, Field::affine_xx + j, 3, rules.has_gradient_energy ? 0.125 : 0.0);
    for (int pair = 0; mixed && pair < pairs_of<D>; ++pair) store(1 + D + pair, Field::cross_xy + 3 * pair, 1, 0.03125);
    for (int q = 0; q < n; q += 4) {
      Lanes4 of[4];
      transpose(record[0][q], record[0][q + 1], record[0][q + 2], record[0][q + 3], of);
      for (int i = 0; i < 3; ++i) store_four(&fresh[i][q], of[i]);
      store_four(lost + q, four_at(lost + q) + of[3] - 0.5 * (of[0] * of[0] + of[1] * of[1] + of[2] * of[2]));
    }
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

  /// Velocity, its gradient and its mixed derivatives of a chunk.
  static AffineFields<D> affine_fields(ParticleSet const& set, int begin) {
    AffineFields<D> out{};
    auto const at = [&](Field f) {
      double const* values = set.field(f);
      return values == nullptr ? nullptr : values + begin;
    };
    for (int i = 0; i < 3; ++i) {
      out.value[i] = at(Field::velocity_x + i);
      for (int j = 0; j < D; ++j) out.along[i][j] = at(Field::affine_xx + (3 * i + j));
      for (int pair = 0; pair < pairs_of<D>; ++pair) out.mixed[i][pair] = at(Field::cross_xy + (3 * pair + i));
    }
    return out;
  }

  /// The same times the mass, as records.
  template <bool mixed>
  static void find_gifts(AffineFields<D> const& v, double const* mass, double h, int n, AffineGifts<D>& out) {
    double const inverse_h = 1.0 / h;
    for (int q = 0; q < n; q += 4) {
      Lanes4 const m = four_at(mass + q);
      auto const times = [q](Lanes4 const& by, double const* values) { return by * four_at(values + q); };
      transpose(times(m, v.value[0]), times(m, v.value[1]), times(m, v.value[2]), m, out.value + q);
      for (int j = 0; j < D; ++j) {
        transpose(times(m, v.along[0][j]), times(m, v.along[1][j]), times(m, v.along[2][j]), Lanes4{},
                  out.along[j] + q);
      }
      Lanes4 const per_h = inverse_h * m;
      for (int pair = 0; mixed && pair < pairs_of<D>; ++pair) {
        transpose(times(per_h, v.mixed[0][pair]), times(per_h, v.mixed[1][pair]), times(per_h, v.mixed[2][pair]),
                  Lanes4{}, out.mixed[pair] + q);
      }
    }
  }
};

}  // namespace brisance::mpm
