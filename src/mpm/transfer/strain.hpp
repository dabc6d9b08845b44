/// Strain of particles.
#pragma once

#include "mpm/transfer/set.hpp"

namespace brisance::mpm {

template <class S, int D>
struct Strain {
  /// Strain and spin increments of a chunk, [Cui14] Eqs. (27)-(28), in rows of `chunk`: 0-5 strain, 6-8 spin, 9 volume.
  static void strain(SetView const& v, Hoops const& hoops, double dt, int begin, int n, Weights<S, D> const& k,
                     NodeVelocity const* nodes, double (&out)[10][chunk]) {
    ParticleSet const& set = *v.set;
    double const scale = dt / v.h;
    double const* radius = set.field(Field::position_x) + begin;
    alignas(64) double l[3][3][chunk];  // dv_i/dx_j dt
    alignas(64) double u[3][chunk];     // v_i
    auto const four = [&](int q) {
      for (int i = 0; i < 3; ++i) {
        Lanes4 sum[4];
        gradient_at_four<S, D>(*v.patch, k, q, nodes, i, sum);
        store_four(&u[i][q], sum[0]);
        for (int j = 0; j < 3; ++j) store_four(&l[i][j][q], scale * sum[1 + j]);
      }
    };
    auto const one = [&](int q) {
      std::array<Lanes4, 4> sum;
      value_and_gradient<S, D>(*v.patch, k, k.g, q, nodes, whole, sum);
      for (int i = 0; i < 3; ++i) u[i][q] = sum[0][i];
      for (int j = 0; j < 3; ++j) {
        Lanes4 const along = scale * sum[1 + j];
        for (int i = 0; i < 3; ++i) l[i][j][q] = along[i];
      }
    };
    for_fours(k, n, four, one);
    for (int q = 0; hoops.any() && q < n; ++q) {
      double const stretch = dt * u[0][q] / radius[q];
      l[1][1][q] += hoops.yy * stretch;
      l[2][2][q] += hoops.zz * stretch;
    }
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) {
      out[0][q] = l[0][0][q];
      out[1][q] = l[1][1][q];
      out[2][q] = l[2][2][q];
      out[3][q] = 0.5 * (l[0][1][q] + l[1][0][q]);
      out[4][q] = 0.5 * (l[1][2][q] + l[2][1][q]);
      out[5][q] = 0.5 * (l[2][0][q] + l[0][2][q]);
      out[6][q] = 0.5 * (l[2][1][q] - l[1][2][q]);
      out[7][q] = 0.5 * (l[0][2][q] - l[2][0][q]);
      out[8][q] = 0.5 * (l[1][0][q] - l[0][1][q]);
      out[9][q] = l[0][0][q] + l[1][1][q] + l[2][2][q];
    }
  }
};

}  // namespace brisance::mpm
