/// From particles to nodes in groups: particles that stand side by side in memory and touch the same nodes add to sums
/// that stay in registers, and a node's record is read and written once for all of them. `Mpm::sort` brings them
/// together.
#pragma once

#include "mpm/kernels.hpp"

namespace brisance::mpm {

/// Are there registers for four numbers? With shorter ones sums and particles in groups would need too many, and each
/// particle goes by itself.
#ifdef __AVX__
inline constexpr bool fours_fit = true;
#else
inline constexpr bool fours_fit = false;
#endif

/// Four numbers of an array. Chunks begin on a multiple of four, and arrays of particles have room for whole fours.
inline __attribute__((always_inline)) Lanes4 const& four_at(double const* from) {
  return *reinterpret_cast<Lanes4 const*>(from);
}
inline __attribute__((always_inline)) LooseLanes4 const& loose_four_at(double const* from) {
  return *reinterpret_cast<LooseLanes4 const*>(from);
}
inline __attribute__((always_inline)) void store_four(double* to, Lanes4 const& four) {
  *reinterpret_cast<LooseLanes4*>(to) = four;
}

/// Four vectors by component become four records by vector.
inline __attribute__((always_inline)) void transpose(Lanes4 const& x, Lanes4 const& y, Lanes4 const& z, Lanes4 const& w,
                                                     Lanes4* out) {
#ifdef __AVX__
  Lanes4 const low_xy = __builtin_shufflevector(x, y, 0, 4, 2, 6);
  Lanes4 const high_xy = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  Lanes4 const low_zw = __builtin_shufflevector(z, w, 0, 4, 2, 6);
  Lanes4 const high_zw = __builtin_shufflevector(z, w, 1, 5, 3, 7);
  out[0] = __builtin_shufflevector(low_xy, low_zw, 0, 1, 4, 5);
  out[1] = __builtin_shufflevector(high_xy, high_zw, 0, 1, 4, 5);
  out[2] = __builtin_shufflevector(low_xy, low_zw, 2, 3, 6, 7);
  out[3] = __builtin_shufflevector(high_xy, high_zw, 2, 3, 6, 7);
#else
  for (int i = 0; i < 4; ++i) out[i] = Lanes4{x[i], y[i], z[i], w[i]};
#endif
}

/// What of a node's motion is read.
inline constexpr auto velocity_of = [](auto& node) -> auto& { return node.velocity; };
inline constexpr auto change_of = [](auto& node) -> auto& { return node.change; };

/// Calls visit(begin, end) for each group of a chunk of n particles.
template <class S, int D, class Visit>
inline __attribute__((always_inline)) void for_groups(Weights<S, D> const& k, int n, Visit&& visit) {
  for (int begin = 0; begin < n;) {
    int end = begin + 1;
    while (end < n && k.base[end] == k.base[begin]) ++end;
    visit(begin, end);
    begin = end;
  }
}

/// part(node) += w values of the particles begin..end of a group, for plane c of their nodes.
template <class S, int D, class Node, class Part>
inline __attribute__((always_inline)) void add_to_plane(Patch const& patch, Weights<S, D> const& k, int begin, int end,
                                                        int c, Lanes4 const (&values)[chunk], Node* nodes,
                                                        Part const& part) {
  constexpr int rows = rows_of<S, D>;
  Node* first = row_of(patch, nodes + k.base[begin], 0, c);
  int const stride = patch.stride(1);
  Lanes4 sum[rows][S::support];
  for (int b = 0; b < rows; ++b) {
    for (int s = 0; s < S::support; ++s) sum[b][s] = part(first[b * stride + s]);
  }
  for (int q = begin; q < end; ++q) {
    Lanes4 const of_plane = weight_along<S, D, 2>(k, c, q) * values[q];
    for (int b = 0; b < rows; ++b) {
      Lanes4 const of_row = weight_along<S, D, 1>(k, b, q) * of_plane;
      for (int s = 0; s < S::support; ++s) sum[b][s] += k.w[0][s][q] * of_row;
    }
  }
  for (int b = 0; b < rows; ++b) {
    for (int s = 0; s < S::support; ++s) part(first[b * stride + s]) = sum[b][s];
  }
}

/// What the particles of a chunk give to their nodes: momentum += w m, force += w b + g_x cx + g_y cy + g_z cz.
struct Gifts {
  alignas(64) Lanes4 momentum[chunk];  ///< m
  alignas(64) Lanes4 push[chunk];      ///< b
  alignas(64) Lanes4 along[3][chunk];  ///< cx, cy, cz
};

/// Adds the forces of the particles begin..end of a group to plane c of their nodes; without `pushed` b is 0.
template <class S, int D, bool pushed>
inline __attribute__((always_inline)) void give_forces(Patch const& patch, Weights<S, D> const& k, int begin, int end,
                                                       int c, Gifts const& gifts, NodeSums* nodes) {
  constexpr int rows = rows_of<S, D>;
  // The weights of a row sum to 1 and their gradients to 0: the nearest node gets what the others leave of the whole,
  // which costs no product. Not of tents: both of their nodes may have next to no weight. The same with rows and planes
  // is slower: it takes more registers than there are.
  constexpr int rest = S::support == 3 ? 1 : -1;
  Lanes4 force[rows][S::support]{};
  for (int q = begin; q < end; ++q) {
    double const wz = weight_along<S, D, 2>(k, c, q);
    Lanes4 const x = wz * gifts.along[0][q];
    Lanes4 const y = wz * gifts.along[1][q];
    Lanes4 z{};
    if constexpr (pushed) z = wz * gifts.push[q];
    if constexpr (D > 2) z += k.g[2][c][q] * gifts.along[2][q];
    for (int b = 0; b < rows; ++b) {
      double const wy = weight_along<S, D, 1>(k, b, q);
      Lanes4 const u = wy * x;
      Lanes4 t{};
      if constexpr (pushed || D > 2) t = wy * z;
      if constexpr (D > 1) t += k.g[1][b][q] * y;
      for (int s = 0; s < S::support; ++s) {
        if (s == rest) {
          force[b][s] += t;
          continue;
        }
        force[b][s] += k.g[0][s][q] * u;  // two sums: a sum of both products would cost an operation more
        force[b][s] += k.w[0][s][q] * t;
      }
    }
  }
  for (int b = 0; b < rows; ++b) {
    NodeSums* row = row_of(patch, nodes + k.base[begin], b, c);
    for (int s = 0; s < S::support; ++s) {
      if (s == rest) continue;
      row[s].force += force[b][s];
      if constexpr (rest >= 0) force[b][rest] -= force[b][s];
    }
    if constexpr (rest >= 0) row[rest].force += force[b][rest];
  }
}

/// Adds what a chunk of n particles gives: forces, and with `with_mass` mass and momentum.
template <class S, int D, bool with_mass, bool pushed>
void give(Patch const& patch, Weights<S, D> const& k, int n, Gifts const& gifts, NodeSums* nodes) {
  if constexpr (!fours_fit) {
    for (int q = 0; q < n; ++q) {
      if constexpr (with_mass) add<S, D>(patch, k, q, nodes, momentum_of, gifts.momentum[q]);
      add_with_gradient<S, D>(patch, k, q, nodes, force_of, pushed ? gifts.push[q] : Lanes4{}, gifts.along[0][q],
                              gifts.along[1][q], gifts.along[2][q]);
    }
    return;
  }
  for_groups(k, n, [&](int begin, int end) {
    for (int c = 0; c < planes_of<S, D>; ++c) {
      // One after the other: together they would need more registers than there are.
      if constexpr (with_mass) add_to_plane<S, D>(patch, k, begin, end, c, gifts.momentum, nodes, momentum_of);
      give_forces<S, D, pushed>(patch, k, begin, end, c, gifts, nodes);
    }
  });
}

/// part(node) += w values of a chunk of n particles.
template <class S, int D, class Node, class Part>
void add_values(Patch const& patch, Weights<S, D> const& k, int n, Lanes4 const (&values)[chunk], Node* nodes,
                Part&& part) {
  if constexpr (!fours_fit) {
    for (int q = 0; q < n; ++q) add<S, D>(patch, k, q, nodes, part, values[q]);
    return;
  }
  for_groups(k, n, [&](int begin, int end) {
    for (int c = 0; c < planes_of<S, D>; ++c) add_to_plane<S, D>(patch, k, begin, end, c, values, nodes, part);
  });
}

/// Calls four(q) for four particles q.. of a chunk of n at a time that touch the same nodes, and one(q) for those that
/// remain.
template <class S, int D, class Four, class One>
inline __attribute__((always_inline)) void for_fours(Weights<S, D> const& k, int n, Four&& four, One&& one) {
  for_groups(k, n, [&](int begin, int end) {
    int q = begin;
    for (; fours_fit && q + 4 <= end; q += 4) four(q);
    for (; q < end; ++q) one(q);
  });
}

/// Weights of four particles along direction d; 1 where it is not resolved.
template <class S, int D, int d>
inline __attribute__((always_inline)) LooseLanes4 const& weights_along(Weights<S, D> const& k, int s, int q) {
  static constexpr double ones[4] = {1.0, 1.0, 1.0, 1.0};
  if constexpr (d < D) {
    return loose_four_at(&k.w[d][s][q]);
  } else {
    return loose_four_at(ones);
  }
}

/// Sums of w times the first three parts of the nodes at four particles that touch the same nodes; `part` is what is
/// read of a node.
template <class S, int D, class Node, class Part>
inline __attribute__((always_inline)) void values_at_four(Patch const& patch, Weights<S, D> const& k, int q,
                                                          Node const* nodes, Part&& part, Lanes4 (&out)[3]) {
  Node const* first = nodes + k.base[q];
  Lanes4 wx[S::support];
  for (int s = 0; s < S::support; ++s) wx[s] = weights_along<S, D, 0>(k, s, q);
  for (Lanes4& sum : out) sum = Lanes4{};
  for (int c = 0; c < planes_of<S, D>; ++c) {
    Lanes4 plane[3]{};
    for (int b = 0; b < rows_of<S, D>; ++b) {
      Node const* row = row_of(patch, first, b, c);
      Lanes4 const w = weights_along<S, D, 1>(k, b, q);
      for (int i = 0; i < 3; ++i) {
        Lanes4 r = wx[0] * part(row[0])[i];
        for (int s = 1; s < S::support; ++s) r += wx[s] * part(row[s])[i];
        plane[i] += w * r;
      }
    }
    Lanes4 const w = weights_along<S, D, 2>(k, c, q);
    for (int i = 0; i < 3; ++i) out[i] += w * plane[i];
  }
}

/// Value and gradient [1/cell] of part i of the nodes at four particles that touch the same nodes: out = {value, d/dx,
/// d/dy, d/dz}.
template <class S, int D>
inline __attribute__((always_inline)) void gradient_at_four(Patch const& patch, Weights<S, D> const& k, int q,
                                                            NodeVelocity const* nodes, int i, Lanes4 (&out)[4]) {
  NodeVelocity const* first = nodes + k.base[q];
  Lanes4 wx[S::support];
  Lanes4 gx[S::support];
  for (int s = 0; s < S::support; ++s) {
    wx[s] = loose_four_at(&k.w[0][s][q]);
    gx[s] = loose_four_at(&k.g[0][s][q]);
  }
  for (Lanes4& sum : out) sum = Lanes4{};
  for (int c = 0; c < planes_of<S, D>; ++c) {
    Lanes4 value{};
    Lanes4 x{};
    Lanes4 y{};
    for (int b = 0; b < rows_of<S, D>; ++b) {
      NodeVelocity const* row = row_of(patch, first, b, c);
      Lanes4 r = wx[0] * row[0][i];
      Lanes4 g = gx[0] * row[0][i];
      for (int s = 1; s < S::support; ++s) {
        r += wx[s] * row[s][i];
        g += gx[s] * row[s][i];
      }
      Lanes4 const w = weights_along<S, D, 1>(k, b, q);
      value += w * r;
      x += w * g;
      if constexpr (D > 1) y += loose_four_at(&k.g[1][b][q]) * r;
    }
    Lanes4 const w = weights_along<S, D, 2>(k, c, q);
    out[0] += w * value;
    out[1] += w * x;
    if constexpr (D > 1) out[2] += w * y;
    if constexpr (D > 2) out[3] += loose_four_at(&k.g[2][c][q]) * value;
  }
}

/// Sums of w times the first N parts of the nodes at a chunk of n particles.
template <class S, int D, int N>
void find_values(Patch const& patch, Weights<S, D> const& k, int n, NodeVelocity const* nodes,
                 double (&out)[N][chunk]) {
  auto const four = [&](int q) {
    NodeVelocity const* first = nodes + k.base[q];
    Lanes4 wx[S::support];
    for (int s = 0; s < S::support; ++s) wx[s] = weights_along<S, D, 0>(k, s, q);
    Lanes4 sum[N]{};
    for (int c = 0; c < planes_of<S, D>; ++c) {
      for (int b = 0; b < rows_of<S, D>; ++b) {
        NodeVelocity const* row = row_of(patch, first, b, c);
        Lanes4 const w = weights_along<S, D, 1>(k, b, q) * weights_along<S, D, 2>(k, c, q);
        for (int i = 0; i < N; ++i) {
          Lanes4 r = wx[0] * row[0][i];
          for (int s = 1; s < S::support; ++s) r += wx[s] * row[s][i];
          sum[i] += w * r;
        }
      }
    }
    for (int i = 0; i < N; ++i) store_four(&out[i][q], sum[i]);
  };
  auto const one = [&](int q) {
    Lanes4 sum;
    velocity_at<S, D>(patch, k, q, nodes, sum);
    for (int i = 0; i < N; ++i) out[i][q] = sum[i];
  };
  for_fours(k, n, four, one);
}

/// Divergence [1/cell] of the nodes' velocity in the resolved directions at a chunk of n particles, and the velocity
/// along the first.
template <class S, int D>
void find_divergence(Patch const& patch, Weights<S, D> const& k, int n, NodeVelocity const* nodes,
                     double (&divergence)[chunk], double (&along)[chunk]) {
  auto const four = [&](int q) {
    NodeVelocity const* first = nodes + k.base[q];
    Lanes4 wx[S::support];
    Lanes4 gx[S::support];
    for (int s = 0; s < S::support; ++s) {
      wx[s] = loose_four_at(&k.w[0][s][q]);
      gx[s] = loose_four_at(&k.g[0][s][q]);
    }
    Lanes4 sum{};
    Lanes4 value{};
    for (int c = 0; c < planes_of<S, D>; ++c) {
      Lanes4 const wz = weights_along<S, D, 2>(k, c, q);
      for (int b = 0; b < rows_of<S, D>; ++b) {
        NodeVelocity const* row = row_of(patch, first, b, c);
        Lanes4 x{};
        Lanes4 dx{};
        Lanes4 y{};
        Lanes4 z{};
        for (int s = 0; s < S::support; ++s) {
          x += wx[s] * row[s][0];
          dx += gx[s] * row[s][0];
          if constexpr (D > 1) y += wx[s] * row[s][1];
          if constexpr (D > 2) z += wx[s] * row[s][2];
        }
        Lanes4 const wy = weights_along<S, D, 1>(k, b, q);
        Lanes4 const w = wy * wz;
        value += w * x;
        sum += w * dx;
        if constexpr (D > 1) sum += loose_four_at(&k.g[1][b][q]) * wz * y;
        if constexpr (D > 2) sum += loose_four_at(&k.g[2][c][q]) * wy * z;
      }
    }
    store_four(divergence + q, sum);
    store_four(along + q, value);
  };
  auto const one = [&](int q) {
    std::array<Lanes4, 4> sum;
    value_and_gradient<S, D>(patch, k, k.g, q, nodes, whole, sum);
    divergence[q] = sum[1][0] + sum[2][1] + sum[3][2];
    along[q] = sum[0][0];
  };
  for_fours(k, n, four, one);
}

/// Momentum and mass of a vector u that a chunk of n particles carries.
inline void find_momentum(int n, double const* mass, std::array<double const*, 3> const& u, Lanes4 (&out)[chunk]) {
  double const* ux = u[0];
  double const* uy = u[1];
  double const* uz = u[2];
  for (int q = 0; q < n; q += 4) {
    Lanes4 const m = four_at(mass + q);
    transpose(m * four_at(ux + q), m * four_at(uy + q), m * four_at(uz + q), m, out + q);
  }
}

}  // namespace brisance::mpm
