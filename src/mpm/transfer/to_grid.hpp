/// Mass, momentum and forces from the particles of a set to the nodes.
#pragma once

#include <functional>
#include <vector>

#include "mpm/transfer/apic.hpp"
#include "mpm/transfer/bars.hpp"

namespace brisance::mpm {

/// Outer forces of a step: the surface pressures [Pa] by their numbers, which multiply `load_x` component by component,
/// and the body force and acceleration of `Options`. All of them reach the nodes from the particles, and so do those of
/// the images behind mirror planes, which are pulled the other way.
struct OuterForces {
  std::vector<Vec3> pressures;
  Vec3 body_force{0.0, 0.0, 0.0};
  std::function<Vec3(Vec3 const& x, double time)> acceleration;
  double time = 0.0;
};

template <class S, int D>
struct ToGrid {
  /// Mass and momentum, [Cui14] Eqs. (18), (21), and the inner and outer forces, Eqs. (19)-(20); of APIC's particles
  /// the kinetic energy too, that of their velocity gradient included.
  template <bool with_mass, bool with_forces>
  static void map_state(SetView const& v, Hoops const& hoops, OuterForces const& outer, CellMeans const* means,
                        NodeSums* nodes) {
    ParticleSet& set = *v.set;
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
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
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
          double const p = stressed * (own - reference * matter_fraction(*v.body, density[q]));
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
        if (driven) add_acceleration(set, begin + q, outer, b);
        if constexpr (!with_mass) {
          add_with_gradient<S, D>(*v.patch, k, q, nodes, force_of, b, cx, cy, cz);
        } else if (affine) {
          add_affine_energy<S, D>(*v.patch, k, around, v.h, q, nodes, a, Apic<S, D>::affine_columns(set, begin + q, m),
                                  Apic<S, D>::mixed_columns(set, begin + q, m * inverse_h), 1.0 / m);
          if constexpr (with_forces) add_with_gradient<S, D>(*v.patch, k, q, nodes, force_of, b, cx, cy, cz);
        } else if constexpr (with_forces) {
          add_state<S, D>(*v.patch, k, q, nodes, a, b, cx, cy, cz);
        } else {
          add<S, D>(*v.patch, k, q, nodes, momentum_of, a);
        }
      }
    });
  }

  /// Adds the force of the acceleration where a particle is.
  static void add_acceleration(ParticleSet const& set, int particle, OuterForces const& outer, Lanes4& force) {
    Vec3 const x{set.field(Field::position_x)[particle], set.field(Field::position_y)[particle],
                 set.field(Field::position_z)[particle]};
    Vec3 const g = outer.acceleration(x, outer.time);
    for (int d = 0; d < 3; ++d) force[d] += set.field(Field::mass)[particle] * g[d];
  }

  /// Momentum and mass of a vector that the particles carry: their velocity mapped back, [Cui14] Eq. (26).
  static void map_velocity(SetView const& v, Field vector, NodeVelocity* nodes) {
    ParticleSet& set = *v.set;
    bool const affine = vector == Field::velocity_x && set.field(Field::affine_xx) != nullptr;
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      auto const u = vector_at(set, vector, begin);
      AffineWeights<S, D> around;
      if (affine) find_affine_weights<S, D>(*v.patch, v.h, constant_at(set, Field::position_x, begin), n, k, around);
      for (int q = 0; q < n; ++q) {
        double const m = mass[q];
        Lanes4 const a{m * u[0][q], m * u[1][q], m * u[2][q], m};
        if (affine) {
          add_affine<S, D>(*v.patch, k, around, v.h, q, nodes, whole, a, Apic<S, D>::affine_columns(set, begin + q, m));
        } else {
          add<S, D>(*v.patch, k, q, nodes, whole, a);
        }
      }
    });
  }
};

}  // namespace brisance::mpm
