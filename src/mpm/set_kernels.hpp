/// What happens to the particles of one body in one block, for each shape function and dimension: the loops between
/// particles and nodes with the physics in them.
#pragma once

#include "mpm/transfer/apic.hpp"
#include "mpm/transfer/axis.hpp"
#include "mpm/transfer/flip.hpp"
#include "mpm/transfer/heat.hpp"
#include "mpm/transfer/strain.hpp"
#include "mpm/transfer/stress.hpp"
#include "mpm/transfer/surface.hpp"
#include "mpm/transfer/to_grid.hpp"
#include "mpm/transfer/work.hpp"

namespace brisance::mpm {

/// All of them for one shape function and dimension.
template <class S, int D>
struct Kernels : ToGrid<S, D>,
                 Flip<S, D>,
                 Apic<S, D>,
                 Strain<S, D>,
                 Stress<S, D>,
                 NodeWork<S, D>,
                 BesideAxis<S, D>,
                 Surfaces<S, D>,
                 Heat<S, D> {
  /// Moves the particles of a set by their transfer; rigid ones go on as they are. `back`: the nodes that the new
  /// velocity is mapped back to, or null; `wanted`: see `ToGrid::map_velocity`.
  static Dissipation move(SetView const& v, Options const& options, double dt, BodyRules const& rules,
                          FieldScratch const& nodes, NodeVelocity* back, char const* wanted) {
    ParticleSet& set = *v.set;
    bool const affine = set.field(Field::affine_xx) != nullptr;
    if (!v.body->rigid_velocity && !affine) return Flip<S, D>::move(v, options, dt, nodes, back);
    Dissipation dissipated;
    if (v.body->rigid_velocity) {
      auto const u = vector_at(set, Field::velocity_x, 0);
      auto const way = vector_at(set, Field::move_x, 0);
      for (int d = 0; d < 3; ++d) {
        for (int q = 0; q < set.size(); ++q) way[d][q] = dt * u[d][q];
      }
    } else {
      dissipated = Apic<S, D>::move(v, dt, rules, nodes);
    }
    if (back != nullptr) ToGrid<S, D>::map_velocity(v, Field::velocity_x, back, wanted);
    return dissipated;
  }
};

/// Calls call(Kernels<S, D>) for the shape function and dimension of a simulation.
template <class Call>
void with_kernels(ShapeFunction shape, int dimensions, Call&& call) {
  with_shape(shape, [&]<class S>(S) {
    if (dimensions == 1) {
      call(Kernels<S, 1>{});
    } else if (dimensions == 2) {
      call(Kernels<S, 2>{});
    } else {
      call(Kernels<S, 3>{});
    }
  });
}

}  // namespace brisance::mpm
