#include "observe/subset_cells.hpp"

#include <algorithm>
#include <cmath>

namespace brisance::observe {

namespace {

/// Of a cell: places closer to a face lie on it.
constexpr double on_face = 1e-6;

/// The smallest whole number that is not less than `value` over 2^`halvings`.
int divided_up(int value, int halvings) { return (value + (1 << halvings) - 1) >> halvings; }

}  // namespace

grid::CellRange on_level(grid::CellRange const& cells, int from, int to, int dimensions) {
  grid::CellRange other = cells;
  for (int d = 0; d < dimensions; ++d) {
    other.lower[d] = to >= from ? cells.lower[d] << (to - from) : cells.lower[d] >> (from - to);
    other.upper[d] = to >= from ? cells.upper[d] << (to - from) : divided_up(cells.upper[d], from - to);
  }
  return other;
}

grid::Domain with_level(grid::Domain const& domain, int level) {
  if (level >= 0) return domain.refined(level);
  grid::Domain coarse = domain;
  static_cast<grid::Metric&>(coarse) = {domain.geometry, domain.lower, std::ldexp(domain.smallest_cell(), -level)};
  coarse.cells = on_level(domain.all_cells(), 0, level, domain.dimensions()).upper;
  return coarse;
}

SubsetCells::SubsetCells(run::FieldSubset const& subset, grid::Domain const& domain, int finest)
    : domain_(domain),
      dimensions_(domain.dimensions()),
      deepest_(finest),
      finest_(std::min(finest, subset.level.value_or(finest))),
      coarsest_(std::min(finest_, 0)),
      part_(with_level(domain, coarsest_).all_cells()) {
  if (auto const* plane = std::get_if<run::Plane>(&subset.place)) {
    normal_ = plane->normal;
    grid::Domain const fine = with_level(domain, deepest_);
    layer_ = std::clamp(static_cast<int>(std::floor(fine.in_cells(normal_, plane->at) + on_face)), 0,
                        fine.cells[normal_] - 1);
    return;
  }
  auto const& box = std::get<shape::Box>(subset.place);
  grid::Domain const coarse = with_level(domain, coarsest_);
  for (int d = 0; d < dimensions_; ++d) {
    int const low = static_cast<int>(std::floor(coarse.in_cells(d, box.lower[d]) + on_face));
    int const high = static_cast<int>(std::ceil(coarse.in_cells(d, box.upper[d]) - on_face));
    part_.lower[d] = std::clamp(low, 0, coarse.cells[d] - 1);
    part_.upper[d] = std::clamp(high, part_.lower[d] + 1, coarse.cells[d]);
  }
}

grid::CellRange SubsetCells::cells(int level) const {
  grid::CellRange cells = on_level(part_, coarsest_, level, dimensions_);
  if (normal_ >= 0) {
    cells.lower[normal_] = layer_ >> (deepest_ - level);
    cells.upper[normal_] = cells.lower[normal_] + 1;
  }
  return cells;
}

grid::Domain SubsetCells::shown() const {
  grid::Domain shown = with_level(domain_, coarsest_);
  shown.lower = shown.low_corner(part_.lower);
  shown.cells = part_.n();
  return shown;
}

int SubsetCells::direction_beyond() const {
  grid::CellRange const fine = on_level(part_, coarsest_, 0, dimensions_);
  for (int d = 0; d < dimensions_; ++d) {
    if (fine.upper[d] > domain_.cells[d]) return d;
  }
  return -1;
}

double SubsetCells::count(std::vector<double> const& cells_of_level) const {
  double sum = 0.0;
  for (std::size_t n = 0; n < cells_of_level.size(); ++n) {
    int const level = static_cast<int>(n);
    int const own = std::min(level, finest_);
    auto const whole = static_cast<double>(with_level(domain_, own).all_cells().count());
    double const merged = std::ldexp(cells_of_level[n], dimensions_ * (own - level));
    sum += merged * static_cast<double>(cells(own).count()) / whole;
  }
  return sum;
}

}  // namespace brisance::observe
