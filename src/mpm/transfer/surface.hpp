/// What particles fill, and their surfaces.
#pragma once

#include "mpm/transfer/set.hpp"

namespace brisance::mpm {

template <class S, int D>
struct Surfaces {
  /// A particle's volume in the plane or on the line that is resolved, per that of a cell: of a ring its cross section.
  static double cells_filled(SetView const& v, grid::Geometry geometry, int q) {
    ParticleSet const& set = *v.set;
    double volume = set.field(Field::mass)[q] / set.field(Field::density)[q];
    int const m = grid::radial_exponent(geometry);
    if (m > 0) {
      double const r = set.field(Field::position_x)[q];
      double const width = v.h / v.body->particles_per_direction;
      // A particle closer to the axis than half its width is a disc, not a ring.
      double const middle = std::max(r, 0.5 * (r + 0.5 * width));
      volume /= m == 1 ? 2.0 * std::numbers::pi * middle : 4.0 * std::numbers::pi * (r * r + width * width / 12.0);
    }
    for (int d = 0; d < D; ++d) volume /= v.h;
    return volume;
  }

  /// What the particles fill of the cells around the nodes.
  static void map_filled(SetView const& v, grid::Geometry geometry, NodeVelocity* nodes) {
    double const* density = v.set->field(Field::density);
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      for (int q = 0; q < n; ++q) {
        double const f = cells_filled(v, geometry, begin + q) * matter_fraction(*v.body, density[begin + q]);
        add<S, D>(*v.patch, k, q, nodes, whole, Lanes4{f, 0.0, 0.0, 0.0});
      }
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
    double const* density = v.set->field(Field::density);
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      for (int q = 0; q < n; ++q) {
        double const fraction = matter ? matter_fraction(*v.body, density[begin + q]) : 1.0;
        double const f = cells_filled(v, geometry, begin + q) * fraction;
        add_surface(v, k, q, Lanes4{0.0, 0.0, 0.0, f}, f, nodes);
      }
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
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
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

  /// How far the particles reach beyond the nodes along the normals given there (zero: none wanted).
  static void map_extent(SetView const& v, grid::Geometry geometry, Vec3 const* normals, double* extents) {
    ParticleSet const& set = *v.set;
    Patch const& patch = *v.patch;
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
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
