/// Transfer between particles and nodes, particle by particle: a chunk of particles at a time gets its weights in
/// vectorised loops, then each particle adds to or reads its nodes, whose records fill one short vector each.
#pragma once

#include <array>

#include "core/lanes.hpp"
#include "core/loops.hpp"
#include "core/vec.hpp"
#include "mpm/particles.hpp"
#include "mpm/patches.hpp"
#include "mpm/shapes/shapes.hpp"

namespace brisance::mpm {

inline constexpr int chunk = 64;  ///< particles that are worked on together

/// Weights and gradients [1/cell] of a chunk of particles.
template <class S, int D>
struct Weights {
  alignas(64) int base[chunk];      ///< index of the first node in the patch
  alignas(64) int first[D][chunk];  ///< the same along each direction, from the patch's first cell
  alignas(64) double w[D][S::support][chunk];
  alignas(64) double g[D][S::support][chunk];
};

/// Where the half lengths of a chunk's particles come from.
struct HalfLengths {
  Vec3 constant{0.0, 0.0, 0.0};                                 ///< [m]
  std::array<double const*, 3> own{nullptr, nullptr, nullptr};  ///< per particle, of the chunk's first particle
};

/// Without `gradients` these are not calculated.
template <class S, int D, bool gradients = true>
void find_weights(Patch const& patch, double h, std::array<double const*, 3> const& position, HalfLengths const& half,
                  int n, Weights<S, D>& out) {
  double const inverse_h = 1.0 / h;
  int const reach = patch.reach;
  for (int d = 0; d < D; ++d) {
    double const* const x = position[d];
    double const origin = patch.first[d];
    int const cells = patch.cells[d];
    int const stride = patch.stride(d);
    // Plain pointers with constant strides: of arrays of pointers GCC cannot tell that they go on evenly.
    int* const base = out.base;
    int* const first = out.first[d];
    double* const weight = out.w[d][0];
    double* const gradient = out.g[d][0];
    alignas(64) double length[chunk];
    double const* const own = half.own[d];
    for (int q = 0; S::sized && q < n; ++q) length[q] = (own != nullptr ? own[q] : half.constant[d]) * inverse_h;
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) {
      double w[S::support];
      double g[S::support];
      int node = 0;
      S::weights((x[q] - origin) * inverse_h, S::sized ? length[q] : 0.0, cells, node, w, g);
      first[q] = node;
      base[q] = (d == 0 ? 0 : base[q]) + stride * (node + reach);
      for (int s = 0; s < S::support; ++s) {
        weight[s * chunk + q] = w[s];
        if constexpr (gradients) gradient[s * chunk + q] = g[s];
      }
    }
  }
}

/// Distances x_I - x [m] of a chunk of particles from the first of their nodes along each direction.
template <int D>
struct Distances {
  alignas(64) double first[D][chunk];
};

template <class S, int D>
void find_distances(Patch const& patch, double h, std::array<double const*, 3> const& position, int n,
                    Weights<S, D> const& weights, Distances<D>& out) {
  for (int d = 0; d < D; ++d) {
    double const* const x = position[d];
    double const origin = patch.first[d];
    int const* const index = weights.first[d];
    double* const distance = out.first[d];
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) distance[q] = origin + index[q] * h - x[q];
  }
}

/// Weights of APIC's affine part [1/cell], in place of the gradients: w (x_I - x)/D with D = sum w (x_I - x)^2, which
/// conserves angular momentum, [Jiang15]. For tents they are the gradients.
template <class S, int D>
struct AffineWeights : Distances<D> {
  alignas(64) double g[D][S::support][chunk];
};

template <class S, int D>
void find_affine_weights(Patch const& patch, double h, std::array<double const*, 3> const& position, int n,
                         Weights<S, D> const& weights, AffineWeights<S, D>& out) {
  find_distances<S, D>(patch, h, position, n, weights, out);
  for (int d = 0; d < D; ++d) {
    double const* const weight = weights.w[d][0];
    double const* const gradient = weights.g[d][0];
    double const* const distance = out.first[d];
    double* const g = out.g[d][0];
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) {
      double const first = distance[q];
      if constexpr (S::support == 2) {
        for (int s = 0; s < S::support; ++s) g[s * chunk + q] = gradient[s * chunk + q];
      } else {
        double moment = 0.0;
        for (int s = 0; s < S::support; ++s) moment += weight[s * chunk + q] * (first + s * h) * (first + s * h);
        for (int s = 0; s < S::support; ++s) g[s * chunk + q] = weight[s * chunk + q] * (first + s * h) * h / moment;
      }
    }
  }
}

/// Calls visit(row, w_yz, g_y w_z, w_y g_z) for each row of nodes along x that a particle touches.
template <class S, int D, class Node, class Visit>
inline __attribute__((always_inline)) void for_rows(Patch const& patch, Weights<S, D> const& k, int q, Node* nodes,
                                                    Visit&& visit) {
  Node* first = nodes + k.base[q];
  if constexpr (D == 1) {
    visit(first, 1.0, 0.0, 0.0, 0, 0);
  } else if constexpr (D == 2) {
    for (int b = 0; b < S::support; ++b) visit(first + b * patch.stride(1), k.w[1][b][q], k.g[1][b][q], 0.0, b, 0);
  } else {
    int const row = patch.stride(1);
    int const plane = patch.stride(2);
    for (int c = 0; c < S::support; ++c) {
      double const wz = k.w[2][c][q];
      double const gz = k.g[2][c][q];
      for (int b = 0; b < S::support; ++b) {
        double const wy = k.w[1][b][q];
        visit(first + b * row + c * plane, wy * wz, k.g[1][b][q] * wz, wy * gz, b, c);
      }
    }
  }
}

/// part(node) += w b + g_x cx + g_y cy + g_z cz for one particle; `part` picks what is written in a node.
template <class S, int D, class Node, class Part>
inline __attribute__((always_inline)) void add_with_gradient(Patch const& patch, Weights<S, D> const& k, int q,
                                                             Node* nodes, Part&& part, Lanes4 const& b,
                                                             Lanes4 const& cx, Lanes4 const& cy, Lanes4 const& cz) {
  for_rows<S, D>(patch, k, q, nodes, [&](Node* row, double w, double gy, double gz, int, int) {
    Lanes4 t = w * b;
    if constexpr (D > 1) t += gy * cy;
    if constexpr (D > 2) t += gz * cz;
    Lanes4 const u = w * cx;
    for (int s = 0; s < S::support; ++s) part(row[s]) += k.w[0][s][q] * t + k.g[0][s][q] * u;
  });
}

/// part(node) += w a for one particle.
template <class S, int D, class Node, class Part>
inline __attribute__((always_inline)) void add(Patch const& patch, Weights<S, D> const& k, int q, Node* nodes,
                                               Part&& part, Lanes4 const& a) {
  for_rows<S, D>(patch, k, q, nodes, [&](Node* row, double w, double, double, int, int) {
    Lanes4 const t = w * a;
    for (int s = 0; s < S::support; ++s) part(row[s]) += k.w[0][s][q] * t;
  });
}

/// Row b in plane c of the nodes that a particle touches.
template <class Node>
inline __attribute__((always_inline)) Node* row_of(Patch const& patch, Node* first, int b, int c) {
  return first + (b * patch.stride(1) + c * patch.stride(2));
}

/// Weight of a row or plane of nodes; 1 in directions that are not resolved.
template <class S, int D, int d>
inline __attribute__((always_inline)) double weight_along(Weights<S, D> const& k, int s, int q) {
  if constexpr (d < D) {
    return k.w[d][s][q];
  } else {
    return 1.0;
  }
}

/// How many rows a plane of the nodes that a particle touches has, and how many planes there are.
template <class S, int D>
inline constexpr int rows_of = D > 1 ? S::support : 1;
template <class S, int D>
inline constexpr int planes_of = D > 2 ? S::support : 1;

/// Sums of w times the nodes' velocity and of its change at one particle: rows, then planes, then all.
template <class S, int D>
inline __attribute__((always_inline)) void state_at(Patch const& patch, Weights<S, D> const& k, int q,
                                                    NodeMotion const* nodes, Lanes4& velocity, Lanes4& change) {
  NodeMotion const* first = nodes + k.base[q];
  Lanes4 v{};
  Lanes4 c{};
  for (int plane = 0; plane < planes_of<S, D>; ++plane) {
    Lanes4 plane_v{};
    Lanes4 plane_c{};
    for (int line = 0; line < rows_of<S, D>; ++line) {
      NodeMotion const* row = row_of(patch, first, line, plane);
      Lanes4 row_v = k.w[0][0][q] * row[0].velocity;
      Lanes4 row_c = k.w[0][0][q] * row[0].change;
      for (int s = 1; s < S::support; ++s) {
        row_v += k.w[0][s][q] * row[s].velocity;
        row_c += k.w[0][s][q] * row[s].change;
      }
      double const w = weight_along<S, D, 1>(k, line, q);
      plane_v += w * row_v;
      plane_c += w * row_c;
    }
    double const w = weight_along<S, D, 2>(k, plane, q);
    v += w * plane_v;
    c += w * plane_c;
  }
  velocity = v;
  change = c;
}

/// Sum of w nodes at one particle.
template <class S, int D>
inline __attribute__((always_inline)) void velocity_at(Patch const& patch, Weights<S, D> const& k, int q,
                                                       NodeVelocity const* nodes, Lanes4& velocity) {
  NodeVelocity const* first = nodes + k.base[q];
  Lanes4 v{};
  for (int plane = 0; plane < planes_of<S, D>; ++plane) {
    Lanes4 of_plane{};
    for (int line = 0; line < rows_of<S, D>; ++line) {
      NodeVelocity const* row = row_of(patch, first, line, plane);
      Lanes4 r = k.w[0][0][q] * row[0];
      for (int s = 1; s < S::support; ++s) r += k.w[0][s][q] * row[s];
      of_plane += weight_along<S, D, 1>(k, line, q) * r;
    }
    v += weight_along<S, D, 2>(k, plane, q) * of_plane;
  }
  velocity = v;
}

/// Value and gradient [1/cell] at one particle: out = {value, d/dx, d/dy, d/dz}, and, where it has seven members, the
/// mixed parts xy, yz and zx; `g` are the gradients to use, `part` what is read of a node. Rows, then planes, then all.
template <class S, int D, class Node, class Part, std::size_t N>
inline __attribute__((always_inline)) void value_and_gradient(Patch const& patch, Weights<S, D> const& k,
                                                              double const (&g)[D][S::support][chunk], int q,
                                                              Node const* nodes, Part&& part,
                                                              std::array<Lanes4, N>& out) {
  static_assert(N == 4 || N == 7);
  constexpr bool mixed = N == 7;
  out.fill(Lanes4{});
  Node const* first = nodes + k.base[q];
  for (int c = 0; c < planes_of<S, D>; ++c) {
    Lanes4 value{};
    Lanes4 x{};
    Lanes4 y{};
    Lanes4 xy{};
    for (int b = 0; b < rows_of<S, D>; ++b) {
      Node const* row = row_of(patch, first, b, c);
      Lanes4 r = k.w[0][0][q] * part(row[0]);
      Lanes4 s = g[0][0][q] * part(row[0]);
      for (int i = 1; i < S::support; ++i) {
        r += k.w[0][i][q] * part(row[i]);
        s += g[0][i][q] * part(row[i]);
      }
      double const w = weight_along<S, D, 1>(k, b, q);
      value += w * r;
      x += w * s;
      if constexpr (D > 1) y += g[1][b][q] * r;
      if constexpr (D > 1 && mixed) xy += g[1][b][q] * s;
    }
    double const w = weight_along<S, D, 2>(k, c, q);
    out[0] += w * value;
    out[1] += w * x;
    if constexpr (D > 1) out[2] += w * y;
    if constexpr (D > 1 && mixed) out[4] += w * xy;
    if constexpr (D > 2) out[3] += g[2][c][q] * value;
    if constexpr (D > 2 && mixed) {
      out[5] += g[2][c][q] * y;
      out[6] += g[2][c][q] * x;
    }
  }
}

/// What of a node is read or written.
inline constexpr auto whole = [](auto& node) -> auto& { return node; };
inline constexpr auto momentum_of = [](auto& node) -> auto& { return node.momentum; };
inline constexpr auto force_of = [](auto& node) -> auto& { return node.force; };

}  // namespace brisance::mpm
