/// The shape functions by their words: the one place that chooses them.
#pragma once

#include <utility>

#include "mpm/model.hpp"
#include "mpm/shapes/bspline.hpp"
#include "mpm/shapes/gimp.hpp"
#include "mpm/shapes/linear.hpp"

namespace brisance::mpm {

/// Calls use(S{}) with the model of a word.
template <class Use>
decltype(auto) with_shape(ShapeFunction shape, Use&& use) {
  switch (shape) {
    case ShapeFunction::linear: return use(Linear{});
    case ShapeFunction::bspline: return use(BSpline{});
    case ShapeFunction::gimp:
    case ShapeFunction::cpgimp: break;
  }
  return use(Gimp{});
}

/// Nodes that a particle may touch beyond those of its cell.
[[nodiscard]] inline int reach_of(ShapeFunction shape) {
  return with_shape(shape, []<class S>(S) { return S::reach; });
}
/// How far a shape function reaches from its node [cells], without the size of the particle.
[[nodiscard]] inline double width_of(ShapeFunction shape) {
  return with_shape(shape, []<class S>(S) { return S::width; });
}

}  // namespace brisance::mpm
