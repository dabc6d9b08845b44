#include "mpm/cells.hpp"

#include <algorithm>

namespace brisance::mpm {

void find_cells(ParticleSet const& set, Patch const& patch, std::vector<int>& cell) {
  cell.assign(set.size(), 0);
  double const inverse_h = 1.0 / patch.h;
  for (int d = 0; d < patch.dimensions; ++d) {
    double const* x = set.field(Field::position_x + d);
    int const stride = static_cast<int>(patch.cell_range().stride(d));
    for (int q = 0; q < set.size(); ++q) {
      int const i = static_cast<int>((x[q] - patch.first[d]) * inverse_h);
      cell[q] += stride * std::clamp(i, 0, patch.cells[d] - 1);
    }
  }
}

void find_nearest_nodes(ParticleSet const& set, Patch const& patch, std::vector<int>& node) {
  node.assign(set.size(), 0);
  double const inverse_h = 1.0 / patch.h;
  for (int d = 0; d < patch.dimensions; ++d) {
    double const* x = set.field(Field::position_x + d);
    for (int q = 0; q < set.size(); ++q) {
      double const shifted = (x[q] - patch.first[d]) * inverse_h + 0.5;
      int const i = static_cast<int>(shifted);
      node[q] += patch.stride(d) * (std::clamp(i, 0, patch.cells[d]) + patch.reach);
    }
  }
}

void find_starts(std::vector<int> const& cell, std::size_t cells, std::vector<int>& start) {
  start.assign(cells + 1, 0);
  for (int const c : cell) ++start[c + 1];
  for (std::size_t c = 0; c < cells; ++c) start[c + 1] += start[c];
}

}  // namespace brisance::mpm
