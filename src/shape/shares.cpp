#include "shape/shares.hpp"

#include <algorithm>
#include <cmath>

namespace brisance::shape {

namespace {

/// Fractions of a cell below this are round-off of coordinates.
constexpr double round_off = 1e-9;

/// Lines through a cell in each direction across x.
int lines_through(int dimensions) { return dimensions == 3 ? 12 : 64; }

/// What a box of cells sees of a shape. Boxes along the grid are told exactly, so that one whose faces lie between
/// cells cuts none of them.
Cover cover_of(Shape const& shape, grid::Metric const& metric, CellRange const& cells) {
  int const dims = metric.dimensions();
  Vec3 middle = metric.centre(cells.lower);
  double half = 0.0;
  for (int d = 0; d < dims; ++d) {
    double const size = metric.h * (cells.upper[d] - cells.lower[d]);
    middle[d] = metric.face(d, cells.lower[d]) + 0.5 * size;
    half = std::max(half, 0.5 * size);
  }
  auto const* box = std::get_if<Box>(&shape);
  if (box == nullptr) return cover(shape, dims, middle, half);
  double const slack = round_off * metric.h;
  bool inside = true;
  for (int d = 0; d < dims; ++d) {
    double const low = metric.face(d, cells.lower[d]);
    double const high = metric.face(d, cells.upper[d]);
    if (box->lower[d] >= high - slack || box->upper[d] <= low + slack) return Cover::outside;
    inside = inside && box->lower[d] <= low + slack && box->upper[d] >= high - slack;
  }
  return inside ? Cover::inside : Cover::cut;
}

/// The shapes that count in a range of cells, from the first that others may lie above to the last.
struct Stack {
  std::vector<int> shapes;  ///< rising
  bool cut = false;         ///< some surface may pass through the range
};

Stack stack_in(std::vector<Shape> const& shapes, std::vector<int> const& candidates, grid::Metric const& metric,
               CellRange const& cells) {
  Stack stack;
  for (auto n = candidates.rbegin(); n != candidates.rend(); ++n) {
    Cover const seen = cover_of(shapes[*n], metric, cells);
    if (seen == Cover::outside) continue;
    stack.shapes.push_back(*n);
    if (seen == Cover::inside) break;  // what lies below it does not show
    stack.cut = true;
  }
  std::reverse(stack.shapes.begin(), stack.shapes.end());
  return stack;
}

/// A line along x through a cell, which shapes take from the last to the first.
class Line {
 public:
  Line(grid::Metric const& metric, Index3 const& cell)
      : geometry_(metric.geometry), low_(metric.face_radius(cell[0])), high_(metric.face_radius(cell[0] + 1)) {}

  [[nodiscard]] double whole() const { return measure(low_, high_); }
  void begin() { free_.assign(1, {low_, high_}); }
  /// Takes what is left of the line within the shape and returns its measure.
  double take(Shape const& shape, int dimensions, double y, double z) {
    spans(shape, dimensions, y, z, spans_, {low_, high_});
    double taken = 0.0;
    for (Span const& s : spans_) {
      rest_.clear();
      for (Span const& f : free_) {
        double const from = std::max(f.from, s.from);
        double const to = std::min(f.to, s.to);
        if (from >= to) {
          rest_.push_back(f);
          continue;
        }
        taken += measure(from, to);
        if (f.from < from) rest_.push_back({f.from, from});
        if (to < f.to) rest_.push_back({to, f.to});
      }
      free_.swap(rest_);
    }
    return taken;
  }

 private:
  [[nodiscard]] double measure(double from, double to) const {
    return radial_integral(geometry_, to) - radial_integral(geometry_, from);
  }

  grid::Geometry geometry_;
  double low_, high_;
  std::vector<Span> spans_, free_, rest_;
};

/// Does the section of a shape not change with z but where it begins, ends or has faces?
bool is_upright(Shape const& shape) {
  auto const* mesh = std::get_if<Mesh>(&shape);
  return mesh != nullptr ? mesh->upright()
                         : std::holds_alternative<Box>(shape) || std::holds_alternative<Everywhere>(shape);
}

std::vector<Share> cut_cell(std::vector<Shape> const& shapes, std::vector<int> const& stack, grid::Metric const& metric,
                            Index3 const& cell, int lines) {
  int const dims = metric.dimensions();
  if (lines == 0) lines = lines_through(dims);
  // The section of a box does not change between its faces.
  bool const boxes = std::all_of(stack.begin(), stack.end(), [&](int n) {
    return std::holds_alternative<Box>(shapes[n]) || std::holds_alternative<Everywhere>(shapes[n]);
  });
  // Nor does one of an upright body upwards.
  bool const upright =
      dims == 3 && std::all_of(stack.begin(), stack.end(), [&](int n) { return is_upright(shapes[n]); });
  auto const along = [&](int d) {
    if (d >= dims) return std::vector<Station>{{0.0, 1.0}};
    Box box;
    double const slack = round_off * metric.h;
    for (int k = 0; k < dims; ++k) {
      double const inset = k == d ? slack : 0.0;
      box.lower[k] = metric.face(k, cell[k]) + inset;
      box.upper[k] = metric.face(k, cell[k]) + metric.h - inset;
    }
    std::vector<double> ends;
    for (int const n : stack) {
      if (dims == 3) {
        breaks(shapes[n], d, box, ends);
      } else {
        breaks(shapes[n], d, box.lower[d], box.upper[d], ends);
      }
    }
    double const from = metric.face(d, cell[d]);
    return stations(std::move(ends), from, from + metric.h, boxes || (upright && d == 2) ? 1 : lines, slack);
  };
  Line line(metric, cell);
  std::vector<double> parts(stack.size(), 0.0);
  auto const ys = along(1);
  for (Station const& z : along(2)) {
    for (Station const& y : ys) {
      line.begin();
      for (std::size_t n = stack.size(); n-- > 0;) {
        parts[n] += z.share * y.share * line.take(shapes[stack[n]], dims, y.at, z.at);
      }
    }
  }
  double sum = 0.0;
  for (double& part : parts) {
    part /= line.whole();
    if (part < round_off) part = 0.0;
    sum += part;
  }
  std::vector<Share> shares;
  for (std::size_t n = 0; n < stack.size(); ++n) {
    if (parts[n] <= 0.0) continue;
    // A cell that is full but for round-off is full.
    double const part = parts[n] > 1.0 - round_off ? 1.0 : sum > 1.0 - round_off ? parts[n] / sum : parts[n];
    shares.push_back({stack[n], part});
  }
  return shares;
}

using Visit = std::function<bool(CellRange const&, std::vector<Share> const&)>;

bool descend(std::vector<Shape> const& shapes, std::vector<int> const& candidates, grid::Metric const& metric,
             CellRange const& range, Visit const& visit) {
  Stack const stack = stack_in(shapes, candidates, metric, range);
  if (stack.shapes.empty()) return true;
  if (!stack.cut) return visit(range, {{stack.shapes.front(), 1.0}});
  if (range.single()) {
    auto const shares = cut_cell(shapes, stack.shapes, metric, range.lower, 0);
    return shares.empty() || visit(range, shares);
  }
  int longest = 0;
  for (int d = 1; d < 3; ++d) {
    if (range.upper[d] - range.lower[d] > range.upper[longest] - range.lower[longest]) longest = d;
  }
  CellRange low = range;
  CellRange high = range;
  low.upper[longest] = high.lower[longest] = (range.lower[longest] + range.upper[longest]) / 2;
  return descend(shapes, stack.shapes, metric, low, visit) && descend(shapes, stack.shapes, metric, high, visit);
}

std::vector<int> all_of(std::vector<Shape> const& shapes) {
  std::vector<int> all(shapes.size());
  for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<int>(n);
  return all;
}

}  // namespace

CellRange cells_around(Shape const& shape, grid::Domain const& domain) {
  CellRange range = domain.all_cells();
  Box const box = bounds(shape);
  for (int d = 0; d < domain.dimensions(); ++d) {
    double const n = domain.cells[d];
    range.lower[d] = static_cast<int>(std::clamp(std::floor(domain.in_cells(d, box.lower[d])), 0.0, n));
    range.upper[d] = static_cast<int>(std::clamp(std::ceil(domain.in_cells(d, box.upper[d])), 0.0, n));
    range.upper[d] = std::max(range.upper[d], range.lower[d]);
  }
  return range;
}

double volume_of(CellRange const& cells, grid::Metric const& metric) {
  double across = 1.0;
  for (int d = 1; d < metric.dimensions(); ++d) across *= cells.upper[d] - cells.lower[d];
  if (grid::radial_exponent(metric.geometry) == 0) {
    return across * (cells.upper[0] - cells.lower[0]) * metric.cell_volume(cells.lower[0]);
  }
  double sum = 0.0;
  for (int i = cells.lower[0]; i < cells.upper[0]; ++i) sum += metric.cell_volume(i);
  return across * sum;
}

double sum_of(std::vector<Share> const& shares) {
  double sum = 0.0;
  for (Share const& share : shares) sum += share.fraction;
  return sum;
}

std::vector<Share> shares_of_cell(std::vector<Shape> const& shapes, grid::Metric const& metric, Index3 const& cell,
                                  int lines) {
  CellRange const range = grid::around(cell, 0, 0);
  Stack const stack = stack_in(shapes, all_of(shapes), metric, range);
  if (stack.shapes.empty()) return {};
  if (!stack.cut) return {{stack.shapes.front(), 1.0}};
  return cut_cell(shapes, stack.shapes, metric, cell, lines);
}

void for_each_share(std::vector<Shape> const& shapes, grid::Metric const& metric, CellRange const& range,
                    Visit const& visit) {
  if (range.empty()) return;
  descend(shapes, all_of(shapes), metric, range, visit);
}

}  // namespace brisance::shape
