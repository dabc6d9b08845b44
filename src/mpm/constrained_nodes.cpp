#include "mpm/constrained_nodes.hpp"

namespace brisance::mpm {

bool contains_node(shape::Shape const& shape, grid::Metric const& cells, Vec3 const& x) {
  if (shape::contains(shape, cells, x)) return true;
  double const nudge = 1e-6 * cells.h;
  int const dims = cells.dimensions();
  for (int sides = 0; sides < (1 << dims); ++sides) {
    Vec3 y = x;
    for (int d = 0; d < dims; ++d) y[d] += ((sides >> d) & 1) != 0 ? nudge : -nudge;
    if (shape::contains(shape, cells, y)) return true;
  }
  return false;
}

}  // namespace brisance::mpm
