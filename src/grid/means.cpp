#include "grid/means.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/loops.hpp"
#include "grid/fine_cells.hpp"

namespace brisance::grid {

namespace {

/// Of rows of fine cells that lie in one row of coarse ones. Sums of equal values are exact.
template <int rows>
void means_of_rows(std::array<double const*, rows> const& fine, double* means, int cells) {
  constexpr int chunk = 16;
  std::array<double, 2 * chunk> sum{};
  for (int first = 0; first < cells; first += chunk) {
    int const count = std::min(chunk, cells - first);
    BRISANCE_VECTOR_LOOP
    for (int n = 0; n < 2 * count; ++n) {
      int const at = 2 * first + n;
      if constexpr (rows == 4)
        sum[n] = (fine[0][at] + fine[1][at]) + (fine[2][at] + fine[3][at]);
      else
        sum[n] = fine[0][at] + fine[1][at];
    }
    BRISANCE_VECTOR_LOOP
    for (int n = 0; n < count; ++n) means[first + n] = (sum[2 * n] + sum[2 * n + 1]) * (0.5 / rows);
  }
}

/// The same around an axis, where the outer ones of two rings have the larger volume: from the differences to one of
/// them, so that equal values stay what they are.
void means_of_rings(Metric const& fine, int first, std::array<double const*, 2> const& rows, double* means, int cells) {
  for (int i = 0; i < cells; ++i) {
    double const inner = fine.cell_volume(first + 2 * i);
    double const outer = fine.cell_volume(first + 2 * i + 1);
    double const one = rows[0][2 * i];
    double sum = outer * (rows[0][2 * i + 1] - one);
    sum += inner * (rows[1][2 * i] - one) + outer * (rows[1][2 * i + 1] - one);
    means[i] = one + sum / (2.0 * (inner + outer));
  }
}

}  // namespace

void take_means(Block const& fine, double const* from, CellRange const& box, double* to) {
  int const dims = fine.metric.dimensions();
  CellRange const own = fine.in_domain();
  CellRange const cells = coarse_cells(own, dims);
  bool const radial = radial_exponent(fine.metric.geometry) > 0;
  std::ptrdiff_t const y = own.stride(1);
  for_each_row(cells, [&](Index3 const& first) {
    double* const means = to + box.offset(first);
    Index3 const corner = fine_cells(first, dims).lower;
    double const* const row = from + own.offset(corner);
    if (dims == 3) {
      double const* const above = row + own.stride(2);
      means_of_rows<4>({row, row + y, above, above + y}, means, cells.n(0));
    } else if (radial) {
      means_of_rings(fine.metric, corner[0], {row, row + y}, means, cells.n(0));
    } else {
      means_of_rows<2>({row, row + y}, means, cells.n(0));
    }
  });
}

}  // namespace brisance::grid
