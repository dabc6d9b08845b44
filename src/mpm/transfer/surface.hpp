/// What particles fill, and their surfaces.
#pragma once

#include "mpm/transfer/set.hpp"

namespace brisance::mpm {

template <class S, int D>
struct Surfaces {
  /// Volumes of a chunk's particles in the plane or on the line that is resolved, per that of a cell: of a ring its
  /// cross section. `matter`: of solids that have come loose their matter alone, see `matter_fraction`.
  static void find_filled(SetView const& v, grid::Geometry geometry, bool matter, int begin, int n,
                          double (&out)[chunk]) {
    ParticleSet const& set = *v.set;
    double const* const mass = set.field(Field::mass) + begin;
    double const* const density = set.field(Field::density) + begin;
    double const* const radius = set.field(Field::position_x) + begin;
    double const width = v.h / v.body->particles_per_direction;
    double cell = 1.0;
    for (int d = 0; d < D; ++d) cell *= v.h;
    int const m = grid::radial_exponent(geometry);
    if (m == 0) {
      for (int q = 0; q < n; ++q) out[q] = mass[q] / (density[q] * cell);
    } else if (m == 1) {
      for (int q = 0; q < n; ++q) {
        double const r = radius[q];
        // A particle closer to the axis than half its width is a disc, not a ring.
        double const disc = 0.5 * (r + 0.5 * width);
        out[q] = mass[q] / (density[q] * cell * 2.0 * std::numbers::pi * (r > disc ? r : disc));
      }
    } else {
      for (int q = 0; q < n; ++q) {
        double const r = radius[q];
        out[q] = mass[q] / (density[q] * cell * 4.0 * std::numbers::pi * (r * r + width * width / 12.0));
      }
    }
    if (!matter || !v.body->solid.has_deviator()) return;
    double const whole_density = v.body->solid.density;
    for (int q = 0; q < n; ++q) out[q] *= density[q] < whole_density ? density[q] / whole_density : 1.0;
  }

  /// The same of one particle.
  static double cells_filled(SetView const& v, grid::Geometry geometry, int q) {
    double out[chunk];
    find_filled(v, geometry, false, q, 1, out);
    return out[0];
  }

  /// What the particles fill of the cells around the nodes.
  static void map_filled(SetView const& v, grid::Geometry geometry, NodeVelocity* nodes) {
    for_chunks<S, D, false>(v, [&](int begin, int n, Weights<S, D> const& k) {
      alignas(64) double filled[chunk];
      find_filled(v, geometry, true, begin, n, filled);
      alignas(64) Lanes4 record[chunk];
      for (int q = 0; q < n; q += 4) transpose(four_at(filled + q), Lanes4{}, Lanes4{}, Lanes4{}, record + q);
      add_values<S, D>(*v.patch, k, n, record, nodes, whole);
    });
  }

  /// nodes += w b + f grad w for one particle.
  static void add_surface(SetView const& v, Weights<S, D> const& k, int q, Lanes4 const& b, double f,
                          NodeVelocity* nodes) {
    add_with_gradient<S, D>(*v.patch, k, q, nodes, whole, b, Lanes4{f, 0.0, 0.0, 0.0}, Lanes4{0.0, f, 0.0, 0.0},
                            Lanes4{0.0, 0.0, f, 0.0});
  }

  /// What the particles fill of the cells around the nodes, and its gradient per h: surfaces and their normals.
  /// `matter`: of solids that have come loose their matter alone, see `matter_fraction`.
  static void map_gradient(SetView const& v, grid::Geometry geometry, bool matter, NodeVelocity* nodes) {
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      alignas(64) double filled[chunk];
      find_filled(v, geometry, matter, begin, n, filled);
      for (int q = 0; q < n; ++q) add_surface(v, k, q, Lanes4{0.0, 0.0, 0.0, filled[q]}, filled[q], nodes);
    });
  }

  /// Area of the surface that the particles around a node show to it, as a vector that points out of them [m2]: with it
  /// a pressure at the nodes is in balance with the same pressure within the particles.
  static void map_area(SetView const& v, Hoops const& hoops, NodeVelocity* nodes) {
    ParticleSet const& set = *v.set;
    double const hoop = hoops.yy + hoops.zz;
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      double const* density = set.field(Field::density) + begin;
      double const* radius = set.field(Field::position_x) + begin;
      for (int q = 0; q < n; ++q) {
        double const volume = mass[q] / density[q] * matter_fraction(*v.body, density[q]);
        double const f = volume / v.h;
        Lanes4 b{};
        if (hoop > 0.0) b[0] = hoop * volume / radius[q];
        add_surface(v, k, q, b, f, nodes);
      }
    });
  }

  /// Volume of a fluid's particles, and the same times the pressure that they push with.
  static void map_pressure(SetView const& v, NodeVelocity* nodes) {
    ParticleSet const& set = *v.set;
    double const reference = v.body->reference_pressure;
    for_chunks<S, D, false>(v, [&](int begin, int n, Weights<S, D> const& k) {
      double const* mass = set.field(Field::mass) + begin;
      double const* density = set.field(Field::density) + begin;
      double const* pressure = set.field(Field::pressure) + begin;
      double const* viscosity = set.field(Field::viscosity) + begin;
      alignas(64) Lanes4 record[chunk];
      for (int q = 0; q < n; q += 4) {
        Lanes4 const volume = four_at(mass + q) / four_at(density + q);
        Lanes4 const push = volume * (four_at(pressure + q) + four_at(viscosity + q) - reference);
        transpose(push, volume, Lanes4{}, Lanes4{}, record + q);
      }
      add_values<S, D>(*v.patch, k, n, record, nodes, whole);
    });
  }

  /// How far the particles reach beyond the nodes along the normals given there (zero: none wanted).
  static void map_extent(SetView const& v, grid::Geometry geometry, Vec3 const* normals, double* extents) {
    ParticleSet const& set = *v.set;
    Patch const& patch = *v.patch;
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      alignas(64) double filled[chunk];
      find_filled(v, geometry, false, begin, n, filled);
      for (int q = 0; q < n; ++q) {
        double const half = 0.5 * v.h * std::pow(filled[q], 1.0 / D);
        int const rows = D > 1 ? S::support : 1;
        int const planes = D > 2 ? S::support : 1;
        for (int c = 0; c < planes; ++c) {
          for (int b = 0; b < rows; ++b) {
            for (int a = 0; a < S::support; ++a) {
              int const node = k.base[q] + patch.index(a, b, c);
              Vec3 const& normal = normals[node];
              if (normal[0] == 0.0 && normal[1] == 0.0 && normal[2] == 0.0) continue;
              Vec3 const at = patch.position(patch.at(node));
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

}  // namespace brisance::mpm
