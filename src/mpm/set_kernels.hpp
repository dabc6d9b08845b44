/// What happens to the points of one body in one block, for each shape function and dimension: the loops between points
/// and nodes with the physics in them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/loops.hpp"
#include "material/stress.hpp"
#include "mpm/burn.hpp"
#include "mpm/kernels.hpp"
#include "mpm/mpm.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

inline std::array<double const*, 3> constant_at(PointSet const& set, Field first, int begin) {
  std::array<double const*, 3> out{};
  for (int d = 0; d < 3; ++d) {
    double const* values = set.field(first + d);
    out[d] = values == nullptr ? nullptr : values + begin;
  }
  return out;
}

inline std::array<double*, 3> vector_at(PointSet& set, Field first, int begin) {
  std::array<double*, 3> out{};
  for (int d = 0; d < 3; ++d) {
    double* values = set.field(first + d);
    out[d] = values == nullptr ? nullptr : values + begin;
  }
  return out;
}

inline HalfLengths half_lengths(PointSet const& set, Body const& body, double h, int begin) {
  HalfLengths half;
  double const constant = 0.5 * h / body.points_per_direction;
  half.constant = {constant, constant, constant};
  half.own = constant_at(set, Field::half_x, begin);
  return half;
}

inline Hoops hoops_of(grid::Geometry geometry) {
  switch (geometry) {
    case grid::Geometry::axisymmetric2d:
    case grid::Geometry::cylindrical1d: return {0.0, 1.0};
    case grid::Geometry::spherical1d: return {1.0, 1.0};
    default: return {};
  }
}

/// What becomes of the kinetic energy that APIC loses.
struct ApicEnergy {
  bool heats = false;        ///< the points; else it is counted
  bool of_gradient = false;  ///< is that of the velocity gradient part of a point's?
};

/// Part of a point's volume that the gas around does not fill. Debris flies apart and soil bursts, and the volumes of
/// their points grow with the gaps between them: a solid bears the pressure of the gas with no more than its matter.
/// With all of it single grains push, and are pushed, as if they filled many cells, and are thrown.
inline double matter_part(Body const& body, double density) {
  return body.solid.has_deviator() ? std::min(1.0, density / body.solid.density) : 1.0;
}

/// What a pass over one set needs.
struct SetView {
  PointSet* set;
  Body const* body;
  Patch const* patch;
  double h;
};

/// Outer forces of a step: the surface pressures [Pa] by their numbers, which multiply `load_x` component by component,
/// and the body force and acceleration of `Options`. All of them reach the nodes from the points, and so do those of
/// the images behind mirror planes, which are pulled the other way.
struct OuterForces {
  std::vector<Vec3> pressures;
  Vec3 body_force{0.0, 0.0, 0.0};
  std::function<Vec3(Vec3 const& x, double time)> acceleration;
  double time = 0.0;
};

/// See `Kernels::even_out`. Measured on the rod of tests/mpm/test_axis.cpp: with 0, 1000, 2000 and 3000 per strain the
/// pressure at the axis scatters 7.3, 1.8, 1.2 and 1.1 times as much as at mid radius with B-splines, 2.7, 0.5, 0.4 and
/// 0.3 times with GIMP. A reach of 8 cells brings no more.
inline constexpr double even_per_strain = 3000.0;
inline constexpr double even_most = 0.3;   ///< part that a step takes
inline constexpr double even_cells = 4.0;  ///< radius that it reaches
/// Nothing is taken off where the cells around a point are filled by no more than the first, all of it from the second
/// on: the outer two of the points across a plate, of which the nodes see one side only.
inline constexpr double surface_fill = 0.85;
inline constexpr double inner_fill = 0.95;

/// Locking control. Replaces the volumetric strain of each point by that of its cell, and the pressure in the forces by
/// the cell's mean, both weighted with volume: the two are conjugate, so that the work of the forces and the energy of
/// the points agree (the B-bar method of finite elements, with the cell as the element, [Hughes80]).
class CellMeans {
 public:
  /// Finds the cell of each point of a set.
  CellMeans(SetView const& v, Scratch& scratch) : scratch_(&scratch) {
    PointSet const& set = *v.set;
    Patch const& patch = *v.patch;
    scratch.order.assign(set.size(), 0);
    scratch.cell_sums.assign(static_cast<std::size_t>(patch.cells[0] * patch.cells[1] * patch.cells[2]) * 2, 0.0);
    double const inverse_h = 1.0 / v.h;
    int stride = 1;
    for (int d = 0; d < patch.dimensions; ++d) {
      double const* x = set.field(Field::position_x + d);
      for (int q = 0; q < set.size(); ++q) {
        int const i = static_cast<int>((x[q] - patch.first[d]) * inverse_h);
        scratch.order[q] += stride * std::clamp(i, 0, patch.cells[d] - 1);
      }
      stride *= patch.cells[d];
    }
  }
  void add(int point, double volume, double value) {
    double* sums = scratch_->cell_sums.data() + 2L * scratch_->order[point];
    sums[0] += volume;
    sums[1] += volume * value;
  }
  [[nodiscard]] double mean(int point) const {
    double const* sums = scratch_->cell_sums.data() + 2L * scratch_->order[point];
    return sums[1] / sums[0];
  }

 private:
  Scratch* scratch_;
};

/// The transfer kernels for one shape function and dimension.
template <class S, int D>
struct Kernels {
  static Weights<S, D> const& weights(SetView const& v, int begin, int n, Weights<S, D>& out) {
    PointSet const& set = *v.set;
    find_weights<S, D>(*v.patch, v.h, constant_at(set, Field::position_x, begin),
                       half_lengths(set, *v.body, v.h, begin), n, out);
    return out;
  }

  template <class Work>
  static void for_chunks(SetView const& v, Work&& work) {
    Weights<S, D> k;
    for (int begin = 0; begin < v.set->size(); begin += chunk) {
      int const n = std::min(chunk, v.set->size() - begin);
      weights(v, begin, n, k);
      work(begin, n, k);
    }
  }

  /// Mass and momentum, [Cui14] Eqs. (18), (21), and the inner and outer forces, Eqs. (19)-(20); of APIC's points the
  /// kinetic energy too, that of their velocity gradient included.
  template <bool with_mass, bool with_forces>
  static void map_state(SetView const& v, Hoops const& hoops, OuterForces const& outer, CellMeans const* means,
                        NodeState* nodes) {
    PointSet& set = *v.set;
    double const inverse_h = 1.0 / v.h;
    bool const affine = with_mass && set.field(Field::affine_xx) != nullptr;
    std::array<double const*, 6> deviator{};
    for (int c = 0; c < 6 && !v.body->rigid_velocity; ++c) deviator[c] = set.field(Field::deviator_xx + c);
    double const* const bar_number = set.field(Field::bar_number);
    double const stressed = v.body->rigid_velocity ? 0.0 : 1.0;
    double const reference = v.body->reference_pressure;
    bool const driven = with_forces && outer.acceleration != nullptr;
    Vec3 const& gravity = outer.body_force;
    bool const heavy = with_forces && dot(gravity, gravity) > 0.0;
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      double const* density = set.field(Field::density) + begin;
      double const* pressure = set.field(Field::pressure) + begin;
      double const* viscosity = set.field(Field::viscosity) + begin;
      auto const velocity = vector_at(set, Field::velocity_x, begin);
      double const* radius = set.field(Field::position_x) + begin;
      double const* load_number = set.field(Field::load_number);
      AffineWeights<S, D> around;
      if (affine) find_affine_weights<S, D>(*v.patch, v.h, constant_at(set, Field::position_x, begin), n, k, around);
      for (int q = 0; q < n; ++q) {
        double const m = mass[q];
        double const volume = m / density[q];
        Lanes4 const a{m * velocity[0][q], m * velocity[1][q], m * velocity[2][q], m};
        Lanes4 b{};
        Lanes4 cx{};
        Lanes4 cy{};
        Lanes4 cz{};
        if constexpr (with_forces) {
          double const own = means == nullptr ? pressure[q] + viscosity[q] : means->mean(begin + q);
          double const p = stressed * (own - reference * matter_part(*v.body, density[q]));
          std::array<double, 6> s{-p, -p, -p, 0.0, 0.0, 0.0};
          if (deviator[0] != nullptr) {
            for (int c = 0; c < 6; ++c) s[c] += deviator[c][begin + q];
          }
          if (bar_number != nullptr && bar_number[begin + q] > 0.0) add_bar(set, begin + q, s);
          double const f = -volume * inverse_h;
          cx = Lanes4{f * s[0], f * s[3], f * s[5], 0.0};
          cy = Lanes4{f * s[3], f * s[1], f * s[4], 0.0};
          cz = Lanes4{f * s[5], f * s[4], f * s[2], 0.0};
          if (hoops.any()) b[0] -= volume * (hoops.yy * s[1] + hoops.zz * s[2]) / radius[q];
          if (load_number != nullptr && load_number[begin + q] > 0.0) {
            Vec3 const& push = outer.pressures[static_cast<std::size_t>(load_number[begin + q]) - 1];
            for (int d = 0; d < 3; ++d) b[d] += volume * push[d] * set.field(Field::load_x + d)[begin + q];
          }
        }
        if (heavy) {
          for (int d = 0; d < 3; ++d) b[d] += m * gravity[d];
        }
        if (driven) {
          Vec3 const x{set.field(Field::position_x)[begin + q], set.field(Field::position_y)[begin + q],
                       set.field(Field::position_z)[begin + q]};
          Vec3 const g = outer.acceleration(x, outer.time);
          for (int d = 0; d < 3; ++d) b[d] += m * g[d];
        }
        if constexpr (!with_mass) {
          add_with_gradient<S, D>(*v.patch, k, q, nodes, force_of, b, cx, cy, cz);
        } else if (affine) {
          add_affine_energy<S, D>(*v.patch, k, around, v.h, q, nodes, a, affine_columns(set, begin + q, m),
                                  mixed_columns(set, begin + q, m * inverse_h), 1.0 / m);
          if constexpr (with_forces) add_with_gradient<S, D>(*v.patch, k, q, nodes, force_of, b, cx, cy, cz);
        } else if constexpr (with_forces) {
          add_state<S, D>(*v.patch, k, q, nodes, a, b, cx, cy, cz);
        } else {
          add<S, D>(*v.patch, k, q, nodes, momentum_of, a);
        }
      }
    });
  }

  /// Adds the stress of a bar to that of its point.
  static void add_bar(PointSet const& set, int q, std::array<double, 6>& s) {
    double const f = set.field(Field::bar_part)[q] * set.field(Field::bar_stress)[q];
    Vec3 const n{set.field(Field::bar_x)[q], set.field(Field::bar_y)[q], set.field(Field::bar_z)[q]};
    for (int d = 0; d < 3; ++d) {
      s[d] += f * n[d] * n[d];
      s[3 + d] += f * n[d] * n[(d + 1) % 3];
    }
  }

  /// Stress and energy of the bars that run through a chunk; they make sound faster.
  static void strain_bars(SetView const& v, int begin, int n, double const (&e)[10][chunk], double (&sound)[chunk]) {
    PointSet& set = *v.set;
    double const* const number = set.field(Field::bar_number);
    for (int q = 0; q < n; ++q) {
      int const at = begin + q;
      if (number[at] == 0.0) continue;
      Bar const& bar = v.body->bars[static_cast<std::size_t>(number[at]) - 1];
      auto const direction = vector_at(set, Field::bar_x, at);
      Vec3 const m{*direction[0], *direction[1], *direction[2]};
      double const strain = m[0] * (m[0] * e[0][q] + 2.0 * (m[1] * e[3][q] + m[2] * e[5][q])) +
                            m[1] * (m[1] * e[1][q] + 2.0 * m[2] * e[4][q]) + m[2] * m[2] * e[2][q];
      double& stress = set.field(Field::bar_stress)[at];
      double& flow = set.field(Field::bar_plastic_strain)[at];
      BarState const end = stretched(bar, {stress, flow}, strain);
      double const per_mass = set.field(Field::bar_part)[at] / set.field(Field::density)[at];
      set.field(Field::energy)[at] += 0.5 * (stress + end.stress) * strain * per_mass;
      stress = end.stress;
      flow = end.plastic_strain;
      Vec3 const turned{m[0] + e[7][q] * m[2] - e[8][q] * m[1], m[1] + e[8][q] * m[0] - e[6][q] * m[2],
                        m[2] + e[6][q] * m[1] - e[7][q] * m[0]};
      double const length = norm(turned);
      for (int d = 0; d < 3; ++d) *direction[d] = turned[d] / length;
      sound[q] = std::sqrt(sound[q] * sound[q] + bar.E * per_mass);
    }
  }

  /// Momentum that APIC's velocity gradient adds per distance in each direction.
  static std::array<Lanes4, 3> affine_columns(PointSet& set, int q, double m) {
    std::array<Lanes4, 3> c{};
    for (int j = 0; j < D; ++j) {
      for (int i = 0; i < 3; ++i) c[j][i] = m * set.field(Field::affine_xx + (3 * i + j))[q];
    }
    return c;
  }

  /// The same per product of two distances, from its mixed derivatives.
  static std::array<Lanes4, 3> mixed_columns(PointSet& set, int q, double m) {
    std::array<Lanes4, 3> c{};
    if (set.field(Field::cross_xy) == nullptr) return c;
    for (int pair = 0; pair < (D == 3 ? 3 : 1); ++pair) {
      for (int i = 0; i < 3; ++i) c[pair][i] = m * set.field(Field::cross_xy + (3 * pair + i))[q];
    }
    return c;
  }

  /// Momentum and mass of a vector that the points carry: their velocity mapped back, [Cui14] Eq. (26).
  static void map_velocity(SetView const& v, Field vector, NodeVelocity* nodes) {
    PointSet& set = *v.set;
    bool const affine = vector == Field::velocity_x && set.field(Field::affine_xx) != nullptr;
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      auto const u = vector_at(set, vector, begin);
      AffineWeights<S, D> around;
      if (affine) find_affine_weights<S, D>(*v.patch, v.h, constant_at(set, Field::position_x, begin), n, k, around);
      for (int q = 0; q < n; ++q) {
        double const m = mass[q];
        Lanes4 const a{m * u[0][q], m * u[1][q], m * u[2][q], m};
        if (affine) {
          add_affine<S, D>(*v.patch, k, around, v.h, q, nodes, whole, a, affine_columns(set, begin + q, m));
        } else {
          add<S, D>(*v.patch, k, q, nodes, whole, a);
        }
      }
    });
  }

  /// Part of a point's heat that a step exchanges.
  static double exchanged(double conduction, double p, double q) {
    return q > 0.0 ? std::min(0.5, conduction * q / (std::max(p, 0.0) + q)) : 0.0;
  }

  /// Internal energy and mass of the points, and the part that is exchanged: see `Body::shock_conduction`.
  static void map_heat(SetView const& v, NodeVelocity* nodes) {
    PointSet const& set = *v.set;
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      double const* energy = set.field(Field::energy) + begin;
      double const* pressure = set.field(Field::pressure) + begin;
      double const* viscosity = set.field(Field::viscosity) + begin;
      for (int q = 0; q < n; ++q) {
        double const m = mass[q];
        double const part = exchanged(v.body->shock_conduction, pressure[q], viscosity[q]);
        add<S, D>(*v.patch, k, q, nodes, whole, Lanes4{m * energy[q], m * part, 0.0, m});
      }
    });
  }

  /// Exchanges heat with the nodes, which hold (energy per mass * part, part, -, mass): what one point gives at a node
  /// others take.
  static ConductionCount take_heat(SetView const& v, NodeVelocity const* nodes) {
    PointSet& set = *v.set;
    ConductionCount count;
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
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

  /// Lifts gas points whose energy is below that of no pressure, see `FloorCount`.
  static FloorCount lift_energy(SetView const& v) {
    PointSet& set = *v.set;
    double const* mass = set.field(Field::mass);
    double const* density = set.field(Field::density);
    double const* pressure = set.field(Field::pressure);
    double const* mass_fraction = set.field(Field::mass_fraction);
    double const* volume_fraction = set.field(Field::volume_fraction);
    double* energy = set.field(Field::energy);
    FloorCount count;
    for (int q = 0; q < set.size(); ++q) {
      if (pressure[q] > 0.0) continue;
      double const Y = mass_fraction == nullptr ? 0.0 : mass_fraction[q];
      double const alpha = volume_fraction == nullptr ? 0.0 : volume_fraction[q];
      auto const pressure_at = [&](double e) { return material::pressure(v.body->solid, density[q], e, Y, alpha); };
      double const own = pressure_at(energy[q]);
      if (!(own < 0.0)) continue;
      // The pressure is linear in the energy.
      double const scale = std::max(std::abs(energy[q]), -own / density[q]);
      double const added = -own * scale / (pressure_at(energy[q] + scale) - own);
      energy[q] += added;
      count.energy += mass[q] * added;
      ++count.points;
    }
    return count;
  }

  /// XPIC: takes from `filtered` what the nodes see of it.
  static void filter(SetView const& v, NodeVelocity const* nodes) {
    PointSet& set = *v.set;
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      auto const u = vector_at(set, Field::filtered_x, begin);
      for (int q = 0; q < n; ++q) {
        Lanes4 seen;
        velocity_at<S, D>(*v.patch, k, q, nodes, seen);
        for (int d = 0; d < 3; ++d) u[d][q] -= seen[d];
      }
    });
  }

  /// Velocity and motion of the points, [Cui14] Eqs. (24)-(25), the latter with the nodes' new velocity. With
  /// APIC the nodes hold kinetic energy per mass in the place of their mass, and what the points' velocity
  /// and its gradient C do not take up of it, e = v^2/2 + h^2/8 C:C + h^4/32 B:B (B: the mixed derivatives), heats or
  /// is counted: h^2/4 is the second moment of the B-splines. With other shape functions, whose moments depend on the
  /// place, the energy of the gradient is no part of a point's, and what it had given the nodes is taken off.
  /// `exchange`: see `Mpm::share_momentum`, or null. `halt`: how constraints change the nodes' velocity, or null.
  /// `rub`: how friction does, of contacts and walls, `stop`: how walls do, across them, `keep`: by how much the
  /// velocity that points take over differs from that with which the nodes move, or null. Returns the kinetic energy
  /// that points which follow increments lose by `halt` and `stop` (gains count negative) and by the filters, and all
  /// points by friction.
  static Dissipation move(SetView const& v, Options const& options, double dt, ApicEnergy fate, NodeState const* nodes,
                          NodeVelocity const* exchange, NodeVelocity const* halt, NodeVelocity const* rub,
                          NodeVelocity const* stop, NodeVelocity const* keep) {
    PointSet& set = *v.set;
    double const h = v.h;
    Transfer const transfer = v.body->transfer.value_or(options.transfer);
    double const pic = transfer == Transfer::flip ? options.pic_fraction : 0.0;
    bool const affine = set.field(Field::affine_xx) != nullptr;
    Dissipation dissipated;
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      auto const u = vector_at(set, Field::velocity_x, begin);
      auto const way = vector_at(set, Field::move_x, begin);
      if (v.body->rigid_velocity) {
        for (int d = 0; d < 3; ++d) {
          for (int q = 0; q < n; ++q) way[d][q] = dt * u[d][q];
        }
        return;
      }
      alignas(64) double fresh[3][chunk];
      alignas(64) double change[3][chunk];
      alignas(64) double lost[chunk];
      if (affine) {
        AffineWeights<S, D> around;
        find_affine_weights<S, D>(*v.patch, h, constant_at(set, Field::position_x, begin), n, k, around);
        double const inverse_h = 1.0 / h;
        bool const mixed = set.field(Field::cross_xy) != nullptr;
        for (int q = 0; q < n; ++q) {
          std::array<Lanes4, 7> sum;
          value_and_gradient<S, D>(*v.patch, k, around.g, q, nodes, momentum_of, sum);
          lost[q] = sum[0][3] - 0.5 * (sum[0][0] * sum[0][0] + sum[0][1] * sum[0][1] + sum[0][2] * sum[0][2]);
          if (!fate.of_gradient) lost[q] -= gradient_energy(set, k, around, h, begin, q);
          for (int j = 0; fate.of_gradient && j < D; ++j) {
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
        // These take over what the nodes say, see `Mpm::release`.
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
        if (fate.heats) {
          double* const energy = set.field(Field::energy) + begin;
          for (int q = 0; q < n; ++q) energy[q] += lost[q];
        } else {
          for (int q = 0; q < n; ++q) dissipated.apic += set.field(Field::mass)[begin + q] * lost[q];
        }
        return;
      }
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
        std::array<NodeVelocity const*, 3> const causes{halt, stop, rub};
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
      if (keep != nullptr) take_kept(v, k, n, dt, keep, way);
    });
    return dissipated;
  }

  /// Takes off the way of points what only their velocity has.
  static void take_kept(SetView const& v, Weights<S, D> const& k, int n, double dt, NodeVelocity const* keep,
                        std::array<double*, 3> const& way) {
    for (int q = 0; q < n; ++q) {
      Lanes4 kept;
      velocity_at<S, D>(*v.patch, k, q, keep, kept);
      for (int d = 0; d < 3; ++d) way[d][q] -= dt * kept[d];
    }
  }

  /// What a point gave the nodes by its velocity gradient, 1/2 sum w |C (x_I - x)|^2 [J/kg].
  static double gradient_energy(PointSet& set, Weights<S, D> const& k, AffineWeights<S, D> const& around, double h,
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

  /// Strain and spin increments of a chunk, [Cui14] Eqs. (27)-(28), in rows of `chunk`: 0-5 strain, 6-8 spin, 9 volume.
  static void strain(SetView const& v, Hoops const& hoops, double dt, int begin, int n, Weights<S, D> const& k,
                     NodeVelocity const* nodes, double (&out)[10][chunk]) {
    PointSet const& set = *v.set;
    double const scale = dt / v.h;
    double const* radius = set.field(Field::position_x) + begin;
    alignas(64) double l[3][3][chunk];  // dv_i/dx_j dt
    for (int q = 0; q < n; ++q) {
      std::array<Lanes4, 4> sum;
      value_and_gradient<S, D>(*v.patch, k, k.g, q, nodes, whole, sum);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) l[i][j][q] = scale * sum[1 + j][i];
      }
      if (hoops.any()) {
        double const stretch = dt * sum[0][0] / radius[q];
        l[1][1][q] += hoops.yy * stretch;
        l[2][2][q] += hoops.zz * stretch;
      }
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

  /// Burn fraction at the end of the step, [Cui14] Eqs. (52)-(53).
  static void burn(SetView const& v, double time, int begin, int n, double (&out)[chunk]) {
    double const* lighting = v.set->field(Field::lighting_time) + begin;
    double const rate = burn_rate(v.body->solid.detonation_speed, v.h);
    for (int q = 0; q < n; ++q) out[q] = burn_fraction(time, lighting[q], rate);
  }

  /// Stress of a chunk from its strain. Returns the fastest signal [m/s].
  static double stress(SetView const& v, Options const& options, double time, double dt, int begin, int n,
                       double const (&e)[10][chunk], double const* volumetric) {
    PointSet& set = *v.set;
    auto const at = [&](Field f) {
      double* values = set.field(f);
      return values == nullptr ? nullptr : values + begin;
    };
    alignas(64) double sound[chunk];
    alignas(64) double burnt[chunk];
    material::PointArrays arrays{};
    arrays.n = n;
    for (int c = 0; c < 6; ++c) {
      arrays.strain[c] = e[c];
      arrays.deviator[c] = at(Field::deviator_xx + c);
    }
    for (int d = 0; d < 3; ++d) arrays.spin[d] = e[6 + d];
    arrays.volumetric = volumetric;
    if (set.field(Field::lighting_time) != nullptr) {
      burn(v, time + dt, begin, n, burnt);
      arrays.burn = burnt;
    }
    arrays.pressure = at(Field::pressure);
    arrays.viscosity = at(Field::viscosity);
    arrays.density = at(Field::density);
    arrays.energy = at(Field::energy);
    arrays.plastic_strain = at(Field::plastic_strain);
    arrays.plastic_work = at(Field::plastic_work);
    arrays.temperature = at(Field::temperature);
    arrays.damage = at(Field::damage);
    arrays.crushing = at(Field::crushing);
    arrays.cracking = at(Field::cracking);
    arrays.compression = at(Field::compression);
    arrays.sound_speed = sound;
    arrays.mass_fraction = at(Field::mass_fraction);
    arrays.volume_fraction = at(Field::volume_fraction);
    material::update_stress(v.body->solid, arrays,
                            {dt, v.h, v.body->linear_viscosity.value_or(options.linear_viscosity),
                             v.body->quadratic_viscosity.value_or(options.quadratic_viscosity), v.body->viscosity_onset,
                             options.crack_band});
    if (set.field(Field::bar_number) != nullptr) strain_bars(v, begin, n, e, sound);
    for (int d = 0; d < D; ++d) {
      double* half = at(Field::half_x + d);
      if (half == nullptr) continue;
      double const* stretch = e[d];
      for (int q = 0; q < n; ++q) half[q] *= 1.0 + stretch[q];
    }
    auto const u = vector_at(set, Field::velocity_x, begin);
    double const* ux = u[0];
    double const* uy = u[1];
    double const* uz = u[2];
    double const detonation = set.field(Field::lighting_time) == nullptr ? 0.0 : v.body->solid.detonation_speed;
    BRISANCE_VECTOR_LOOP
    for (int q = 0; q < n; ++q) {
      double const c = sound[q] > detonation ? sound[q] : detonation;
      sound[q] = c + std::sqrt(ux[q] * ux[q] + uy[q] * uy[q] + uz[q] * uz[q]);
    }
    return largest_of(sound, n);
  }

  /// The work of the points' pressure, as the forces on the nodes do it: they push with the pressure of the start of
  /// the step while the nodes move at the mean of their velocities before and after. The energy that a step of the
  /// stress books, with the mean pressure and the new velocity alone, comes to the same in the sum over the steps, but
  /// for what the way from nodes to points and back changes in the velocity. So one half of each step's work, and half
  /// of the viscous one, is provisional, and the next step puts the real one in its place. Without this gas that is
  /// shocked again and again loses energy: a tube at 20 bar 0.6 % in 40 ms, with it 0.004 %. The reference pressure
  /// does no work at the nodes. `before`: the nodes' velocities at the start of the step; `volumetric`: strain of the
  /// step.
  static void settle_work(SetView const& v, Hoops const& hoops, double dt, int begin, int n, Weights<S, D> const& k,
                          NodeVelocity const* before, double const* volumetric) {
    PointSet& set = *v.set;
    double const scale = dt / v.h;
    double const reference = v.body->reference_pressure;
    double const* radius = set.field(Field::position_x) + begin;
    double const* pressure = set.field(Field::pressure) + begin;
    double const* viscosity = set.field(Field::viscosity) + begin;
    double const* density = set.field(Field::density) + begin;
    double const* provisional = set.field(Field::provisional) + begin;
    double* energy = set.field(Field::energy) + begin;
    for (int q = 0; q < n; ++q) {
      if (provisional[q] == 0.0) continue;  // a new point, or gas that nothing strains
      std::array<Lanes4, 4> sum;
      value_and_gradient<S, D>(*v.patch, k, k.g, q, before, whole, sum);
      double strain = scale * (sum[1][0] + sum[2][1] + sum[3][2]);
      if (hoops.any()) strain += (hoops.yy + hoops.zz) * dt * sum[0][0] / radius[q];
      double const work = 0.5 * (pressure[q] - reference) * strain + 0.5 * viscosity[q] * (strain + volumetric[q]);
      energy[q] -= work / density[q] + provisional[q];
    }
  }

  /// What of the work of the step that has been made is provisional; `density`: at its start.
  static void note_work(SetView const& v, int begin, int n, double const* volumetric, double const* density) {
    PointSet& set = *v.set;
    double const reference = v.body->reference_pressure;
    double const* pressure = set.field(Field::pressure) + begin;
    double const* viscosity = set.field(Field::viscosity) + begin;
    double* provisional = set.field(Field::provisional) + begin;
    for (int q = 0; q < n; ++q) {
      provisional[q] = -(0.5 * (pressure[q] - reference) + viscosity[q]) * volumetric[q] / density[q];
    }
  }

  /// The energy of points that follow increments takes what the forces on the nodes really do, and what of it the
  /// points do not take up as motion: see `Body::books_work`. The stress of the start of the step works while the nodes
  /// move at `middle`, the mean of their velocities before and after; it stands in for what the last step booked for
  /// the time being. Of the squares of the changes the nodes gain the mean, a point the square of the mean: the rest is
  /// heat. `forced`: change of the nodes' velocity by forces, `change` the whole one and once more what holds and walls
  /// did of it, which has an account of its own; their product in the place of the mass of `forced`.
  /// `means`: see `CellMeans`, or null.
  static void book_work(SetView const& v, Hoops const& hoops, double dt, NodeVelocity const* middle,
                        NodeVelocity const* forced, NodeVelocity const* change, CellMeans const* means) {
    PointSet& set = *v.set;
    std::array<double const*, 6> deviator{};
    for (int c = 0; c < 6; ++c) deviator[c] = set.field(Field::deviator_xx + c);
    double const* bar_number = set.field(Field::bar_number);
    double const* pressure = set.field(Field::pressure);
    double const* viscosity = set.field(Field::viscosity);
    double const* density = set.field(Field::density);
    double* provisional = set.field(Field::provisional);
    double* energy = set.field(Field::energy);
    bool const affine = set.field(Field::affine_xx) != nullptr;
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      alignas(64) double e[10][chunk];
      strain(v, hoops, dt, begin, n, k, middle, e);
      for (int q = 0; q < n; ++q) {
        int const at = begin + q;
        double const own = means == nullptr ? pressure[at] + viscosity[at] : means->mean(at);
        double const p = own - v.body->reference_pressure * matter_part(*v.body, density[at]);
        std::array<double, 6> s{-p, -p, -p, 0.0, 0.0, 0.0};
        for (int c = 0; deviator[0] != nullptr && c < 6; ++c) s[c] += deviator[c][at];
        if (bar_number != nullptr && bar_number[at] > 0.0) add_bar(set, at, s);
        double work = 0.0;
        for (int c = 0; c < 3; ++c) work += s[c] * e[c][q] + 2.0 * s[3 + c] * e[3 + c][q];
        Lanes4 by;
        Lanes4 all;
        velocity_at<S, D>(*v.patch, k, q, forced, by);
        velocity_at<S, D>(*v.patch, k, q, change, all);
        double const heat = 0.5 * (by[3] - (by[0] * all[0] + by[1] * all[1] + by[2] * all[2]));
        // What APIC's points do not take up has an account of its own.
        energy[at] += work / density[at] + (affine ? 0.0 : heat) - provisional[at];
        provisional[at] = 0.0;
      }
    });
  }

  /// Takes off the first half of the work that the coming update of the stress books, with strains of its own: the
  /// forces have done it. `booked`: the energy without it.
  static void undo_half(SetView const& v, int begin, int n, double const (&e)[10][chunk], double (&booked)[chunk]) {
    PointSet& set = *v.set;
    double* energy = set.field(Field::energy) + begin;
    double const* pressure = set.field(Field::pressure) + begin;
    double const* density = set.field(Field::density) + begin;
    double const reference = v.body->fills_space ? v.body->reference_pressure : 0.0;
    for (int q = 0; q < n; ++q) {
      double work = -(pressure[q] - reference) * e[9][q];
      for (int c = 0; c < 3 && set.field(Field::deviator_xx) != nullptr; ++c) {
        work += set.field(Field::deviator_xx + c)[begin + q] * (e[c][q] - e[9][q] / 3.0) +
                2.0 * set.field(Field::deviator_xx + (3 + c))[begin + q] * e[3 + c][q];
      }
      booked[q] = energy[q] - reference * e[9][q] / density[q];
      energy[q] -= 0.5 * work / density[q];
    }
  }

  /// Takes the volumes of a chunk's points towards the room that there is around them, see `Body::fills_space`;
  /// `filled` is what the points fill of the cells around the nodes, by `map_filled`. They drift with the strain, and
  /// come back with it: gas in uniform motion stays as it is, to the last bit. Not beside open faces: nobody knows what
  /// fills the space behind them.
  static void fill_space(SetView const& v, Options const& options, int begin, int n, Weights<S, D> const& k,
                         double const* volumetric, NodeVelocity const* filled) {
    // Measured: from 5 to 80 the tubes and rooms of `Confined` come out alike.
    constexpr double per_strain = 20.0;
    constexpr double most_part = 0.3;  // of the difference in a step
    constexpr double most = 0.02;      // change of a volume in a step
    PointSet& set = *v.set;
    double* density = set.field(Field::density) + begin;
    double* energy = set.field(Field::energy) + begin;
    double const reference = v.body->reference_pressure;
    for (int q = 0; q < n; ++q) {
      bool known = true;
      for (int d = 0; d < D; ++d) {
        double const x = set.field(Field::position_x + d)[begin + q];
        for (int side = 0; side < 2; ++side) {
          auto const& end = options.ends[2 * d + side];
          known = known && (!end || std::abs(x - *end) > 3.0 * v.h);
        }
      }
      if (!known) continue;
      Lanes4 seen;
      velocity_at<S, D>(*v.patch, k, q, filled, seen);
      double const part = std::min(most_part, per_strain * std::abs(volumetric[q]));
      double const change = std::clamp(part * (seen[0] - 1.0), -most, most);
      double const before = density[q];
      density[q] *= 1.0 + change;
      energy[q] += reference * (1.0 / before - 1.0 / density[q]);
    }
  }

  /// Does a point take part? Those within the reach and, so that their means are whole, some cells around them; those
  /// that have failed or come loose drift apart and have nothing in common.
  static bool evened(SetView const& v, double const* damage, int q) {
    constexpr double coherent = 0.9;  // of the density at the start; no solid stretches that far
    double const radius = v.set->field(Field::position_x)[q];
    return radius < (even_cells + 6.0) * v.h && (damage == nullptr || damage[q] < 1.0) &&
           v.set->field(Field::density)[q] > coherent * v.body->solid.density;
  }

  /// What the points of a body beside the axis fill of the cells around the nodes, and the same times density, s_xx and
  /// s_yy: see `even_out`.
  static void map_even(SetView const& v, grid::Geometry geometry, NodeVelocity* nodes) {
    PointSet const& set = *v.set;
    double const* damage = set.field(Field::damage);
    double const* density = set.field(Field::density);
    double const* xx = set.field(Field::deviator_xx);
    double const* yy = set.field(Field::deviator_yy);
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      for (int q = 0; q < n; ++q) {
        int const at = begin + q;
        if (!evened(v, damage, at)) continue;
        double const filled = cells_filled(v, geometry, at);
        add<S, D>(*v.patch, k, q, nodes, whole, filled * Lanes4{density[at], xx[at], yy[at], 1.0});
      }
    });
  }

  /// The same of what the nodes make of it.
  static void map_even_again(SetView const& v, grid::Geometry geometry, NodeVelocity const* means,
                             NodeVelocity* nodes) {
    double const* damage = v.set->field(Field::damage);
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      for (int q = 0; q < n; ++q) {
        if (!evened(v, damage, begin + q)) continue;
        Lanes4 seen;
        velocity_at<S, D>(*v.patch, k, q, means, seen);
        seen[3] = 1.0;
        add<S, D>(*v.patch, k, q, nodes, whole, cells_filled(v, geometry, begin + q) * seen);
      }
    });
  }

  /// Beside the axis stresses that no node feels gather at the points: patterns a cell long whose forces cancel, left
  /// over by waves that run together there, as strains are taken where the points are while they swing, and worth the
  /// more stress the less volume a ring has. They are drained as fast as the points are strained. With P, from points
  /// to nodes and back, (I - P)^2 of density and deviator is taken off: all of such a pattern, of a wave of ten cells a
  /// hundredth. Mass and energy of a body remain: what the pattern held is heat. At its surface, where P would flatten
  /// the stress of bending, it stays. `means`: (2 P - P^2) of it at the nodes.
  static void even_out(SetView const& v, int begin, int n, Weights<S, D> const& k, double const (&e)[10][chunk],
                       NodeVelocity const* means) {
    PointSet& set = *v.set;
    double const* radius = set.field(Field::position_x) + begin;
    double const* damage = set.field(Field::damage);
    double* density = set.field(Field::density) + begin;
    double* xx = set.field(Field::deviator_xx) + begin;
    double* yy = set.field(Field::deviator_yy) + begin;
    double* zz = set.field(Field::deviator_zz) + begin;
    double* pressure = set.field(Field::pressure) + begin;
    // In soil the pressure is a state that follows the changes of density; it would keep the pattern, and a point that
    // lost density here would bear pressure however far it flew apart.
    auto const* linear = std::get_if<material::Linear>(&v.body->solid.eos);
    bool const soil = linear != nullptr && std::holds_alternative<material::DruckerPrager>(v.body->solid.strength);
    double const stiffness = soil ? linear->K / linear->rho0 : 0.0;
    for (int q = 0; q < n; ++q) {
      double const near = 1.0 - radius[q] / (even_cells * v.h);
      if (near <= 0.0 || !evened(v, damage, begin + q)) continue;
      Lanes4 seen;
      velocity_at<S, D>(*v.patch, k, q, means, seen);
      double const whole_cells = std::clamp((seen[3] - surface_fill) / (inner_fill - surface_fill), 0.0, 1.0);
      double const strained = std::abs(e[0][q]) + std::abs(e[1][q]) + std::abs(e[2][q]) + 2.0 * std::abs(e[3][q]);
      double const part = whole_cells * near * std::min(even_most, even_per_strain * strained);
      double const dx = part * (seen[1] - xx[q]);
      double const dy = part * (seen[2] - yy[q]);
      double const denser = part * (seen[0] - density[q]);
      density[q] += denser;
      pressure[q] += stiffness * denser;
      xx[q] += dx;
      yy[q] += dy;
      zz[q] -= dx + dy;
    }
  }

  /// Strain and stress of a set, [Cui14] Eqs. (27)-(30). Returns the fastest signal [m/s]. `nodes`: the new velocities;
  /// `before`: those before the step, for `settle_work`, or null; `filled`: for `fill_space`, or null;
  /// `books`: does the body book the work of the nodes?
  static double update(SetView const& v, Options const& options, Hoops const& hoops, double time, double dt,
                       NodeVelocity const* nodes, NodeVelocity const* before, NodeVelocity const* filled,
                       NodeVelocity const* even, bool books, Scratch& scratch) {
    double fastest = 0.0;
    auto const stress_of = [&](int begin, int n, double const(&e)[10][chunk]) {
      alignas(64) double booked[chunk];
      if (books) undo_half(v, begin, n, e, booked);
      double const signal = stress(v, options, time, dt, begin, n, e, e[9]);
      for (int q = 0; books && q < n; ++q)
        v.set->field(Field::provisional)[begin + q] = v.set->field(Field::energy)[begin + q] - booked[q];
      return signal;
    };
    if (!options.locking_control || !v.body->solid.has_deviator()) {
      for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
        alignas(64) double e[10][chunk];
        strain(v, hoops, dt, begin, n, k, nodes, e);
        alignas(64) double density[chunk];
        if (before != nullptr) {
          settle_work(v, hoops, dt, begin, n, k, before, e[9]);
          std::copy_n(v.set->field(Field::density) + begin, n, density);
        }
        if (filled != nullptr) fill_space(v, options, begin, n, k, e[9], filled);
        if (even != nullptr) even_out(v, begin, n, k, e, even);
        fastest = std::max(fastest, stress_of(begin, n, e));
        if (before != nullptr) note_work(v, begin, n, e[9], density);
      });
      return fastest;
    }
    PointSet const& set = *v.set;
    int const points = set.size();
    double const* mass = set.field(Field::mass);
    double const* density = set.field(Field::density);
    scratch.strain.resize(static_cast<std::size_t>((points + chunk - 1) / chunk) * 10 * chunk);
    auto* stored = reinterpret_cast<double(*)[10][chunk]>(scratch.strain.data());
    CellMeans means(v, scratch);
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      auto& e = stored[begin / chunk];
      strain(v, hoops, dt, begin, n, k, nodes, e);
      if (even != nullptr) even_out(v, begin, n, k, e, even);
      for (int q = 0; q < n; ++q) means.add(begin + q, mass[begin + q] / density[begin + q], e[9][q]);
    });
    for (int begin = 0; begin < points; begin += chunk) {
      int const n = std::min(chunk, points - begin);
      auto& e = stored[begin / chunk];
      for (int q = 0; q < n; ++q) e[9][q] = means.mean(begin + q);
      fastest = std::max(fastest, stress_of(begin, n, e));
    }
    return fastest;
  }

  /// A point's volume in the plane or on the line that is resolved, per that of a cell: of a ring its cross section.
  static double cells_filled(SetView const& v, grid::Geometry geometry, int q) {
    PointSet const& set = *v.set;
    double volume = set.field(Field::mass)[q] / set.field(Field::density)[q];
    int const m = grid::radial_exponent(geometry);
    if (m > 0) {
      double const r = set.field(Field::position_x)[q];
      double const width = v.h / v.body->points_per_direction;
      // A point closer to the axis than half its width is a disc, not a ring.
      double const middle = std::max(r, 0.5 * (r + 0.5 * width));
      volume /= m == 1 ? 2.0 * std::numbers::pi * middle : 4.0 * std::numbers::pi * (r * r + width * width / 12.0);
    }
    for (int d = 0; d < D; ++d) volume /= v.h;
    return volume;
  }

  /// What the points fill of the cells around the nodes.
  static void map_filled(SetView const& v, grid::Geometry geometry, NodeVelocity* nodes) {
    double const* density = v.set->field(Field::density);
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      for (int q = 0; q < n; ++q) {
        double const f = cells_filled(v, geometry, begin + q) * matter_part(*v.body, density[begin + q]);
        add<S, D>(*v.patch, k, q, nodes, whole, Lanes4{f, 0.0, 0.0, 0.0});
      }
    });
  }

  /// nodes += w b + f grad w for one point.
  static void add_surface(SetView const& v, Weights<S, D> const& k, int q, Lanes4 const& b, double f,
                          NodeVelocity* nodes) {
    add_with_gradient<S, D>(*v.patch, k, q, nodes, whole, b, Lanes4{f, 0.0, 0.0, 0.0}, Lanes4{0.0, f, 0.0, 0.0},
                            Lanes4{0.0, 0.0, f, 0.0});
  }

  /// What the points fill of the cells around the nodes, and its gradient per h: surfaces and their normals. `matter`:
  /// of solids that have come loose their matter alone, see `matter_part`.
  static void map_gradient(SetView const& v, grid::Geometry geometry, bool matter, NodeVelocity* nodes) {
    double const* density = v.set->field(Field::density);
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      for (int q = 0; q < n; ++q) {
        double const part = matter ? matter_part(*v.body, density[begin + q]) : 1.0;
        double const f = cells_filled(v, geometry, begin + q) * part;
        add_surface(v, k, q, Lanes4{0.0, 0.0, 0.0, f}, f, nodes);
      }
    });
  }

  /// Area of the surface that the points around a node show to it, as a vector that points out of them [m2]: with it a
  /// pressure at the nodes is in balance with the same pressure within the points.
  static void map_area(SetView const& v, Hoops const& hoops, NodeVelocity* nodes) {
    PointSet const& set = *v.set;
    double const hoop = hoops.yy + hoops.zz;
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      double const* density = set.field(Field::density) + begin;
      double const* radius = set.field(Field::position_x) + begin;
      for (int q = 0; q < n; ++q) {
        double const volume = mass[q] / density[q] * matter_part(*v.body, density[q]);
        double const f = volume / v.h;
        Lanes4 b{};
        if (hoop > 0.0) b[0] = hoop * volume / radius[q];
        add_surface(v, k, q, b, f, nodes);
      }
    });
  }

  /// Volume of a fluid's points, and the same times the pressure that they push with.
  static void map_pressure(SetView const& v, NodeVelocity* nodes) {
    PointSet const& set = *v.set;
    double const reference = v.body->reference_pressure;
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      double const* density = set.field(Field::density) + begin;
      double const* pressure = set.field(Field::pressure) + begin;
      double const* viscosity = set.field(Field::viscosity) + begin;
      for (int q = 0; q < n; ++q) {
        double const volume = mass[q] / density[q];
        double const push = volume * (pressure[q] + viscosity[q] - reference);
        add<S, D>(*v.patch, k, q, nodes, whole, Lanes4{push, volume, 0.0, 0.0});
      }
    });
  }

  /// How far the points reach beyond the nodes along the normals given there (zero: none wanted).
  static void map_extent(SetView const& v, grid::Geometry geometry, Vec3 const* normals, double* extents) {
    PointSet const& set = *v.set;
    Patch const& patch = *v.patch;
    for_chunks(v, [&](int begin, int n, Weights<S, D> const& k) {
      for (int q = 0; q < n; ++q) {
        double const half = 0.5 * v.h * std::pow(cells_filled(v, geometry, begin + q), 1.0 / D);
        int const rows = D > 1 ? S::support : 1;
        int const planes = D > 2 ? S::support : 1;
        for (int c = 0; c < planes; ++c) {
          for (int b = 0; b < rows; ++b) {
            for (int a = 0; a < S::support; ++a) {
              int const node = k.base[q] + patch.index(a, b, c);
              Vec3 const& normal = normals[node];
              if (normal[0] == 0.0 && normal[1] == 0.0 && normal[2] == 0.0) continue;
              Index3 const i{node % patch.n[0], (node / patch.n[0]) % patch.n[1], node / (patch.n[0] * patch.n[1])};
              Vec3 const at = patch.position(i, v.h);
              double reach = half;
              for (int d = 0; d < D; ++d) reach += normal[d] * (set.field(Field::position_x + d)[begin + q] - at[d]);
              extents[node] = std::max(extents[node], reach);
            }
          }
        }
      }
    });
  }
};

/// Calls call(Kernels<S, D>) for the shape function and dimension of a calculation.
template <class Call>
void with_kernels(ShapeFunction shape, int dimensions, Call&& call) {
  auto const with_shape = [&]<class S>(S) {
    if (dimensions == 1) {
      call(Kernels<S, 1>{});
    } else if (dimensions == 2) {
      call(Kernels<S, 2>{});
    } else {
      call(Kernels<S, 3>{});
    }
  };
  switch (shape) {
    case ShapeFunction::linear: with_shape(Linear{}); break;
    case ShapeFunction::bspline: with_shape(BSpline{}); break;
    default: with_shape(Gimp{});
  }
}

}  // namespace brisance::mpm
