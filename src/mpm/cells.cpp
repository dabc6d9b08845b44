#include "mpm/cells.hpp"

#include "core/loops.hpp"

namespace brisance::mpm {

namespace {

/// Adds `stride` times the index along d of what a particle lies in: 0 to `last`, counted from `shift` cells below the
/// block's first node.
void add_index(ParticleSet const& set, Patch const& patch, int d, double shift, int last, int stride, int first,
               std::vector<int>& place) {
  double const inverse_h = 1.0 / patch.h;
  double const origin = patch.first[d];
  double const* const x = set.field(Field::position_x + d);
  int* const to = place.data();
  int const count = set.size();
  BRISANCE_VECTOR_LOOP
  for (int q = 0; q < count; ++q) {
    double const shifted = (x[q] - origin) * inverse_h + shift;
    int i = static_cast<int>(shifted);
    i = i < 0 ? 0 : i;
    i = i > last ? last : i;
    to[q] += stride * (i + first);
  }
}

}  // namespace

void find_cells(ParticleSet const& set, Patch const& patch, std::vector<int>& cell) {
  cell.assign(set.size(), 0);
  for (int d = 0; d < patch.dimensions; ++d)
    add_index(set, patch, d, 0.0, patch.cells[d] - 1, static_cast<int>(patch.cell_range().stride(d)), 0, cell);
}

void find_nearest_nodes(ParticleSet const& set, Patch const& patch, std::vector<int>& node) {
  node.assign(set.size(), 0);
  for (int d = 0; d < patch.dimensions; ++d)
    add_index(set, patch, d, 0.5, patch.cells[d], patch.stride(d), patch.reach, node);
}

void find_starts(std::vector<int> const& cell, std::size_t cells, std::vector<int>& start) {
  start.assign(cells + 1, 0);
  for (int const c : cell) ++start[c + 1];
  for (std::size_t c = 0; c < cells; ++c) start[c + 1] += start[c];
}

}  // namespace brisance::mpm
