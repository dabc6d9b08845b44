/// Beside the axis.
#pragma once

#include "mpm/transfer/surface.hpp"

namespace brisance::mpm {

/// See `BesideAxis::even_out`. Measured on the rod of tests/mpm/test_axis.cpp: with 0, 1000, 2000 and 3000 per strain
/// the pressure at the axis scatters 7.3, 1.8, 1.2 and 1.1 times as much as at mid radius with B-splines, 2.7, 0.5, 0.4
/// and 0.3 times with GIMP. A reach of 8 cells brings no more.
inline constexpr double even_per_strain = 3000.0;
inline constexpr double even_most = 0.3;   ///< part that a step takes
inline constexpr double even_cells = 4.0;  ///< radius that it reaches
/// Nothing is taken off where the cells around a particle are filled by no more than the first, all of it from the
/// second on: the outer two of the particles across a plate, of which the nodes see one side only.
inline constexpr double surface_fill = 0.85;
inline constexpr double inner_fill = 0.95;

template <class S, int D>
struct BesideAxis {
  /// Does a particle take part? Those within the reach and, so that their means are whole, some cells around them;
  /// those that have failed or come loose drift apart and have nothing in common.
  static bool evened(SetView const& v, double const* damage, int q) {
    constexpr double coherent = 0.9;  // of the density at the start; no solid stretches that far
    double const radius = v.set->field(Field::position_x)[q];
    return radius < (even_cells + 6.0) * v.h && (damage == nullptr || damage[q] < 1.0) &&
           v.set->field(Field::density)[q] > coherent * v.body->solid.density;
  }

  /// What the particles of a body beside the axis fill of the cells around the nodes, and the same times density, s_xx
  /// and s_yy: see `even_out`.
  static void map_even(SetView const& v, grid::Geometry geometry, NodeVelocity* nodes) {
    ParticleSet const& set = *v.set;
    double const* damage = set.field(Field::damage);
    double const* density = set.field(Field::density);
    double const* xx = set.field(Field::deviator_xx);
    double const* yy = set.field(Field::deviator_yy);
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      for (int q = 0; q < n; ++q) {
        int const at = begin + q;
        if (!evened(v, damage, at)) continue;
        double const filled = Surfaces<S, D>::cells_filled(v, geometry, at);
        add<S, D>(*v.patch, k, q, nodes, whole, filled * Lanes4{density[at], xx[at], yy[at], 1.0});
      }
    });
  }

  /// The same of what the nodes make of it.
  static void map_even_again(SetView const& v, grid::Geometry geometry, NodeVelocity const* means,
                             NodeVelocity* nodes) {
    double const* damage = v.set->field(Field::damage);
    for_chunks<S, D>(v, [&](int begin, int n, Weights<S, D> const& k) {
      for (int q = 0; q < n; ++q) {
        if (!evened(v, damage, begin + q)) continue;
        Lanes4 seen;
        velocity_at<S, D>(*v.patch, k, q, means, seen);
        seen[3] = 1.0;
        add<S, D>(*v.patch, k, q, nodes, whole, Surfaces<S, D>::cells_filled(v, geometry, begin + q) * seen);
      }
    });
  }

  /// Beside the axis stresses that no node feels gather at the particles: patterns a cell long whose forces cancel,
  /// left over by waves that run together there, as strains are taken where the particles are while they swing, and
  /// worth the more stress the less volume a ring has. They are drained as fast as the particles are strained. With P,
  /// from particles to nodes and back, (I - P)^2 of density and deviator is taken off: all of such a pattern, of a wave
  /// of ten cells a hundredth. Mass and energy of a body remain: what the pattern held is heat. At its surface, where P
  /// would flatten the stress of bending, it stays. `means`: (2 P - P^2) of it at the nodes.
  static void even_out(SetView const& v, int begin, int n, Weights<S, D> const& k, double const (&e)[10][chunk],
                       NodeVelocity const* means) {
    ParticleSet& set = *v.set;
    double const* radius = set.field(Field::position_x) + begin;
    double const* damage = set.field(Field::damage);
    double* density = set.field(Field::density) + begin;
    double* xx = set.field(Field::deviator_xx) + begin;
    double* yy = set.field(Field::deviator_yy) + begin;
    double* zz = set.field(Field::deviator_zz) + begin;
    double* pressure = set.field(Field::pressure) + begin;
    // In soil the pressure is a state that follows the changes of density; it would keep the pattern, and a particle
    // that lost density here would bear pressure however far it flew apart.
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
      double const fraction = whole_cells * near * std::min(even_most, even_per_strain * strained);
      double const dx = fraction * (seen[1] - xx[q]);
      double const dy = fraction * (seen[2] - yy[q]);
      double const denser = fraction * (seen[0] - density[q]);
      density[q] += denser;
      pressure[q] += stiffness * denser;
      xx[q] += dx;
      yy[q] += dy;
      zz[q] -= dx + dy;
    }
  }
};

}  // namespace brisance::mpm
