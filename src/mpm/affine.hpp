/// From particles of APIC to nodes, in groups (groups.hpp): the velocity of such a particle varies within it, and a
/// node gets what it is at the node's place.
#pragma once

#include "mpm/groups.hpp"

namespace brisance::mpm {

/// Pairs of directions whose mixed derivatives there are: xy, yz, zx.
template <int D>
inline constexpr int pairs_of = D == 3 ? 3 : D - 1;

/// Momentum of a chunk of particles as a function of the distance from them:
/// value + sum along_d x_d + sum mixed_de x_d x_e, each with the mass in `value` alone.
template <int D>
struct AffineGifts {
  alignas(64) Lanes4 value[chunk];
  alignas(64) Lanes4 along[D][chunk];
  alignas(64) Lanes4 mixed[D > 1 ? pairs_of<D> : 1][chunk];
};

/// The same for the velocities of a chunk, component by component; null where there is none.
template <int D>
struct AffineFields {
  double const* value[3];
  double const* along[3][D];                        ///< [1/s]
  double const* mixed[3][D > 1 ? pairs_of<D> : 1];  ///< [1/s], per distance over h
};

/// Momentum of the particles begin..end of a group at plane c of their nodes: value in the row and its change with the
/// distance along x.
template <class S, int D, bool mixed>
inline __attribute__((always_inline)) void add_affine_to_plane(Weights<S, D> const& k, Distances<D> const& distances,
                                                               double const (&moment)[S::support][chunk], double h,
                                                               int begin, int end, int c, AffineGifts<D> const& gifts,
                                                               Lanes4 (&sum)[rows_of<S, D>][S::support]) {
  for (int q = begin; q < end; ++q) {
    double const wz = weight_along<S, D, 2>(k, c, q);
    Lanes4 plane = gifts.value[q];
    Lanes4 along_x = gifts.along[0][q];
    Lanes4 along_y{};
    if constexpr (D > 1) along_y = gifts.along[1][q];
    if constexpr (D > 2) {
      double const z = distances.first[2][q] + c * h;
      plane += z * gifts.along[2][q];
      if constexpr (mixed) along_y += z * gifts.mixed[1][q];
      if constexpr (mixed) along_x += z * gifts.mixed[2][q];
    }
    for (int b = 0; b < rows_of<S, D>; ++b) {
      Lanes4 row = plane;
      Lanes4 change = along_x;
      if constexpr (D > 1) {
        double const y = distances.first[1][q] + b * h;
        row += y * along_y;
        if constexpr (mixed) change += y * gifts.mixed[0][q];
      }
      double const w = wz * weight_along<S, D, 1>(k, b, q);
      row *= w;
      change *= w;
      for (int s = 0; s < S::support; ++s) {
        sum[b][s] += k.w[0][s][q] * row;
        sum[b][s] += moment[s][q] * change;
      }
    }
  }
}

/// w_x times the distance along x, of a chunk.
template <class S, int D>
inline void find_moments(Weights<S, D> const& k, Distances<D> const& distances, double h, int n,
                         double (&moment)[S::support][chunk]) {
  double const* const distance = distances.first[0];
  for (int s = 0; s < S::support; ++s) {
    double const* const w = k.w[0][s];
    double* const out = moment[s];
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) out[q] = w[q] * (distance[q] + s * h);
  }
}

/// Kinetic energy [J] that a chunk of particles gives each of the nodes of plane c: of the velocity at the node's place
/// and of the mass that it gets.
template <class S, int D, bool mixed>
void find_affine_energies(Weights<S, D> const& k, Distances<D> const& distances, double h, int n, int c,
                          double const* mass, AffineFields<D> const& v,
                          double (&energy)[rows_of<S, D>][S::support][chunk]) {
  constexpr int last = D - 1;
  double const inverse_h = 1.0 / h;
  double const* const x = distances.first[0];
  double const* const y = distances.first[D > 1 ? 1 : 0];
  double const* const z = distances.first[last];
  for (int b = 0; b < rows_of<S, D>; ++b) {
    double const* const w_y = k.w[D > 1 ? 1 : 0][D > 1 ? b : 0];
    double const* const w_z = k.w[last][D > 2 ? c : 0];
    double* const out = energy[b][0];
    double const* const w_x = k.w[0][0];
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) {
      double const to_y = y[q] + b * h;
      double const to_z = z[q] + c * h;
      // Velocity on the row of the nodes beside the particle, and its change along x.
      auto const on_row = [&](int i) {
        double u = v.value[i][q];
        if constexpr (D > 1) u += to_y * v.along[i][1][q];
        if constexpr (D > 2) u += to_z * v.along[i][2][q];
        if constexpr (D > 2 && mixed) u += to_z * inverse_h * to_y * v.mixed[i][1][q];
        return u;
      };
      auto const along_row = [&](int i) {
        double g = v.along[i][0][q];
        if constexpr (D > 1 && mixed) g += to_y * inverse_h * v.mixed[i][0][q];
        if constexpr (D > 2 && mixed) g += to_z * inverse_h * v.mixed[i][2][q];
        return g;
      };
      double const ux = on_row(0);
      double const uy = on_row(1);
      double const uz = on_row(2);
      double const gx = along_row(0);
      double const gy = along_row(1);
      double const gz = along_row(2);
      double half_mass = 0.5 * mass[q];
      if constexpr (D > 1) half_mass *= w_y[q];
      if constexpr (D > 2) half_mass *= w_z[q];
      double const square = ux * ux + uy * uy + uz * uz;
      double const cross = 2.0 * (ux * gx + uy * gy + uz * gz);
      double const of_change = gx * gx + gy * gy + gz * gz;
      for (int s = 0; s < S::support; ++s) {
        double const to_x = x[q] + s * h;
        out[s * chunk + q] = w_x[s * chunk + q] * half_mass * (square + to_x * (cross + to_x * of_change));
      }
    }
  }
}

/// Adds the momentum and mass of a chunk of n particles to part(node).
template <class S, int D, bool mixed, class Node, class Part>
void give_affine_momentum(Patch const& patch, Weights<S, D> const& k, Distances<D> const& distances, double h, int n,
                          AffineGifts<D> const& gifts, Node* nodes, Part&& part) {
  constexpr int rows = rows_of<S, D>;
  alignas(64) double moment[S::support][chunk];
  find_moments<S, D>(k, distances, h, n, moment);
  for_groups(k, n, [&](int begin, int end) {
    for (int c = 0; c < planes_of<S, D>; ++c) {
      Node* first = row_of(patch, nodes + k.base[begin], 0, c);
      Lanes4 sum[rows][S::support];
      for (int b = 0; b < rows; ++b) {
        for (int s = 0; s < S::support; ++s) sum[b][s] = part(first[b * patch.stride(1) + s]);
      }
      add_affine_to_plane<S, D, mixed>(k, distances, moment, h, begin, end, c, gifts, sum);
      for (int b = 0; b < rows; ++b) {
        for (int s = 0; s < S::support; ++s) part(first[b * patch.stride(1) + s]) = sum[b][s];
      }
    }
  });
}

/// Adds the kinetic energy of a chunk of n particles to the nodes, in the place of `force`'s scalar.
template <class S, int D, bool mixed>
void give_affine_energy(Patch const& patch, Weights<S, D> const& k, Distances<D> const& distances, double h, int n,
                        double const* mass, AffineFields<D> const& v, NodeSums* nodes) {
  constexpr int rows = rows_of<S, D>;
  alignas(64) double energy[rows][S::support][chunk];
  for (int c = 0; c < planes_of<S, D>; ++c) {
    find_affine_energies<S, D, mixed>(k, distances, h, n, c, mass, v, energy);
    for_groups(k, n, [&](int begin, int end) {
      NodeSums* first = row_of(patch, nodes + k.base[begin], 0, c);
      double sum[rows][S::support]{};
      for (int q = begin; q < end; ++q) {
        for (int b = 0; b < rows; ++b) {
          for (int s = 0; s < S::support; ++s) sum[b][s] += energy[b][s][q];
        }
      }
      for (int b = 0; b < rows; ++b) {
        for (int s = 0; s < S::support; ++s) first[b * patch.stride(1) + s].force[3] += sum[b][s];
      }
    });
  }
}

}  // namespace brisance::mpm
