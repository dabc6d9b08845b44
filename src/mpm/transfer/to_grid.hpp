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
    bool const affine = with_mass && v.set->field(Field::affine_xx) != nullptr;
    bool const pushed = with_forces && is_pushed(*v.set, hoops, outer);
    for_chunks<S, D, with_forces>(v, [&](int begin, int n, Weights<S, D> const& k) {
      Gifts gifts;
      if constexpr (with_mass) {
        if (affine) {
          give_affine(v, begin, n, k, nodes);
        } else {
          find_momentum(n, v.set->field(Field::mass) + begin, constant_at(*v.set, Field::velocity_x, begin),
                        gifts.momentum);
          if constexpr (!with_forces) add_values<S, D>(*v.patch, k, n, gifts.momentum, nodes, momentum_of);
        }
      }
      if constexpr (with_forces) {
        find_forces(v, hoops, outer, means, begin, n, pushed, gifts);
        if (with_mass && !affine) {
          pushed ? give<S, D, true, true>(*v.patch, k, n, gifts, nodes)
                 : give<S, D, true, false>(*v.patch, k, n, gifts, nodes);
        } else {
          pushed ? give<S, D, false, true>(*v.patch, k, n, gifts, nodes)
                 : give<S, D, false, false>(*v.patch, k, n, gifts, nodes);
        }
      }
    });
  }

  /// May a particle of a set feel more than its stress?
  static bool is_pushed(ParticleSet const& set, Hoops const& hoops, OuterForces const& outer) {
    return hoops.any() || set.field(Field::load_number) != nullptr || outer.acceleration != nullptr ||
           dot(outer.body_force, outer.body_force) > 0.0;
  }

  /// Momentum and kinetic energy of APIC's particles.
  static void give_affine(SetView const& v, int begin, int n, Weights<S, D> const& k, NodeSums* nodes) {
    ParticleSet const& set = *v.set;
    double const* mass = set.field(Field::mass) + begin;
    AffineFields<D> const fields = Apic<S, D>::affine_fields(set, begin);
    Distances<D> distances;
    find_distances<S, D>(*v.patch, v.h, constant_at(set, Field::position_x, begin), n, k, distances);
    AffineGifts<D> gifts;
    if (fields.mixed[0][0] != nullptr) {
      Apic<S, D>::template find_gifts<true>(fields, mass, v.h, n, gifts);
      give_affine_momentum<S, D, true>(*v.patch, k, distances, v.h, n, gifts, nodes, momentum_of);
      give_affine_energy<S, D, true>(*v.patch, k, distances, v.h, n, mass, fields, nodes);
    } else {
      Apic<S, D>::template find_gifts<false>(fields, mass, v.h, n, gifts);
      give_affine_momentum<S, D, false>(*v.patch, k, distances, v.h, n, gifts, nodes, momentum_of);
      give_affine_energy<S, D, false>(*v.patch, k, distances, v.h, n, mass, fields, nodes);
    }
  }

  /// Pressure of a chunk as the forces know it.
  static void find_pressure(SetView const& v, CellMeans const* means, int begin, int n, double (&p)[chunk]) {
    ParticleSet const& set = *v.set;
    double const* density = set.field(Field::density) + begin;
    double const* pressure = set.field(Field::pressure) + begin;
    double const* viscosity = set.field(Field::viscosity) + begin;
    double const reference = v.body->reference_pressure;
    if (means == nullptr) {
      for (int q = 0; q < n; ++q) p[q] = pressure[q] + viscosity[q];
    } else {
      for (int q = 0; q < n; ++q) p[q] = means->mean(begin + q);
    }
    for (int q = 0; reference != 0.0 && q < n; ++q) p[q] -= reference * matter_fraction(*v.body, density[q]);
  }

  /// Inner forces of a chunk, and the outer ones where it is `pushed`.
  static void find_forces(SetView const& v, Hoops const& hoops, OuterForces const& outer, CellMeans const* means,
                          int begin, int n, bool pushed, Gifts& gifts) {
    if (v.body->rigid_velocity) {
      for (auto& along : gifts.along) std::fill_n(along, n, Lanes4{});
    } else {
      alignas(64) double pressure[chunk]{};
      find_pressure(v, means, begin, n, pressure);
      give_stress(v, begin, n, pressure, gifts);
    }
    if (pushed) give_pushes(v, hoops, outer, begin, n, gifts);
  }

  /// Inner forces: stress times volume.
  static void give_stress(SetView const& v, int begin, int n, double const (&pressure)[chunk], Gifts& gifts) {
    ParticleSet const& set = *v.set;
    double const* mass = set.field(Field::mass) + begin;
    double const* density = set.field(Field::density) + begin;
    double const inverse_h = 1.0 / v.h;
    if (set.field(Field::deviator_xx) == nullptr) {
      for (int q = 0; q < n; q += 4) {
        Lanes4 const push = inverse_h * four_at(mass + q) / four_at(density + q) * four_at(pressure + q);
        transpose(push, Lanes4{}, Lanes4{}, Lanes4{}, gifts.along[0] + q);
        transpose(Lanes4{}, push, Lanes4{}, Lanes4{}, gifts.along[1] + q);
        transpose(Lanes4{}, Lanes4{}, push, Lanes4{}, gifts.along[2] + q);
      }
    } else {
      std::array<double const*, 6> s{};
      for (int c = 0; c < 6; ++c) s[c] = set.field(Field::deviator_xx + c) + begin;
      for (int q = 0; q < n; q += 4) {
        Lanes4 const f = -inverse_h * four_at(mass + q) / four_at(density + q);
        Lanes4 const p = four_at(pressure + q);
        Lanes4 const xy = f * four_at(s[3] + q);
        Lanes4 const yz = f * four_at(s[4] + q);
        Lanes4 const zx = f * four_at(s[5] + q);
        transpose(f * (four_at(s[0] + q) - p), xy, zx, Lanes4{}, gifts.along[0] + q);
        transpose(xy, f * (four_at(s[1] + q) - p), yz, Lanes4{}, gifts.along[1] + q);
        transpose(zx, yz, f * (four_at(s[2] + q) - p), Lanes4{}, gifts.along[2] + q);
      }
    }
    double const* bar_number = set.field(Field::bar_number);
    for (int q = 0; bar_number != nullptr && q < n; ++q) {
      if (bar_number[begin + q] == 0.0) continue;
      std::array<double, 6> s{};
      add_bar(set, begin + q, s);
      double const f = -inverse_h * mass[q] / density[q];
      gifts.along[0][q] += f * Lanes4{s[0], s[3], s[5], 0.0};
      gifts.along[1][q] += f * Lanes4{s[3], s[1], s[4], 0.0};
      gifts.along[2][q] += f * Lanes4{s[5], s[4], s[2], 0.0};
    }
  }

  /// Outer forces, and those of hoops.
  static void give_pushes(SetView const& v, Hoops const& hoops, OuterForces const& outer, int begin, int n,
                          Gifts& gifts) {
    ParticleSet const& set = *v.set;
    double const* mass = set.field(Field::mass) + begin;
    double const* density = set.field(Field::density) + begin;
    double const* radius = set.field(Field::position_x) + begin;
    double const* load_number = set.field(Field::load_number);
    bool const driven = outer.acceleration != nullptr;
    Vec3 const& gravity = outer.body_force;
    for (int q = 0; q < n; ++q) {
      Lanes4 b = mass[q] * Lanes4{gravity[0], gravity[1], gravity[2], 0.0};
      // The inner forces hold the stress times -volume/h.
      if (hoops.any()) b[0] += v.h * (hoops.yy * gifts.along[1][q][1] + hoops.zz * gifts.along[2][q][2]) / radius[q];
      if (load_number != nullptr && load_number[begin + q] > 0.0) {
        double const volume = mass[q] / density[q];
        Vec3 const& push = outer.pressures[static_cast<std::size_t>(load_number[begin + q]) - 1];
        for (int d = 0; d < 3; ++d) b[d] += volume * push[d] * set.field(Field::load_x + d)[begin + q];
      }
      if (driven) add_acceleration(set, begin + q, outer, b);
      gifts.push[q] = b;
    }
  }

  /// Adds the force of the acceleration where a particle is.
  static void add_acceleration(ParticleSet const& set, int particle, OuterForces const& outer, Lanes4& force) {
    Vec3 const x{set.field(Field::position_x)[particle], set.field(Field::position_y)[particle],
                 set.field(Field::position_z)[particle]};
    Vec3 const g = outer.acceleration(x, outer.time);
    for (int d = 0; d < 3; ++d) force[d] += set.field(Field::mass)[particle] * g[d];
  }

  /// Momentum and mass of a vector that the particles carry: their velocity mapped back, [Cui14] Eq. (26). `wanted`: is
  /// a node, or null: are all.
  static void map_velocity(SetView const& v, Field vector, NodeVelocity* nodes, char const* wanted = nullptr) {
    ParticleSet const& set = *v.set;
    bool const affine = vector == Field::velocity_x && set.field(Field::affine_xx) != nullptr;
    for_chunks<S, D, false>(v, [&](int begin, int n, Weights<S, D> const& k) {
      if (wanted != nullptr && !reaches(*v.patch, k, n, wanted)) return;
      double const* mass = set.field(Field::mass) + begin;
      if (!affine) {
        alignas(64) Lanes4 momentum[chunk];
        find_momentum(n, mass, constant_at(set, vector, begin), momentum);
        add_values<S, D>(*v.patch, k, n, momentum, nodes, whole);
        return;
      }
      Distances<D> distances;
      find_distances<S, D>(*v.patch, v.h, constant_at(set, Field::position_x, begin), n, k, distances);
      AffineGifts<D> gifts;
      Apic<S, D>::template find_gifts<false>(Apic<S, D>::affine_fields(set, begin), mass, v.h, n, gifts);
      give_affine_momentum<S, D, false>(*v.patch, k, distances, v.h, n, gifts, nodes, whole);
    });
  }

  /// Does any of a chunk's particles touch a node that is wanted?
  static bool reaches(Patch const& patch, Weights<S, D> const& k, int n, char const* wanted) {
    for (int q = 0; q < n; ++q) {
      if (q > 0 && k.base[q] == k.base[q - 1]) continue;
      for (int c = 0; c < planes_of<S, D>; ++c) {
        for (int b = 0; b < rows_of<S, D>; ++b) {
          char const* row = row_of(patch, wanted + k.base[q], b, c);
          for (int s = 0; s < S::support; ++s) {
            if (row[s] != 0) return true;
          }
        }
      }
    }
    return false;
  }
};

}  // namespace brisance::mpm
