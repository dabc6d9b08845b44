/// Shapes along lines: the stretches that lie inside, where a section changes, and stations for integrals.
#include <algorithm>
#include <cmath>
#include <utility>

#include "shape/primitives.hpp"

namespace brisance::shape {

namespace {

/// Adds b to a; both disjoint and in order.
void unite(std::vector<Span>& a, std::vector<Span> const& b) {
  if (b.empty()) return;
  a.insert(a.end(), b.begin(), b.end());
  std::sort(a.begin(), a.end(), [](Span const& p, Span const& q) { return p.from < q.from; });
  std::size_t last = 0;
  for (std::size_t n = 1; n < a.size(); ++n) {
    if (a[n].from <= a[last].to) {
      a[last].to = std::max(a[last].to, a[n].to);
    } else {
      a[++last] = a[n];
    }
  }
  a.resize(last + 1);
}

std::vector<Span> intersect(std::vector<Span> const& a, std::vector<Span> const& b) {
  std::vector<Span> common;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    double const from = std::max(a[i].from, b[j].from);
    double const to = std::min(a[i].to, b[j].to);
    if (from < to) common.push_back({from, to});
    (a[i].to < b[j].to ? i : j) += 1;
  }
  return common;
}

/// All of the line that is not in the spans.
std::vector<Span> complement(std::vector<Span> const& spans) {
  std::vector<Span> rest;
  double from = -infinity;
  for (Span const& s : spans) {
    if (s.from > from) rest.push_back({from, s.from});
    from = s.to;
  }
  if (from < infinity) rest.push_back({from, infinity});
  return rest;
}

void spans(Combination const& whole, int dimensions, double y, double z, std::vector<Span>& out, Span const& in) {
  shape::spans(whole.parts.front(), dimensions, y, z, out, in);
  std::vector<Span> part;
  for (std::size_t n = 1; n < whole.parts.size(); ++n) {
    if (out.empty() && whole.operation != Operation::united) return;
    shape::spans(whole.parts[n], dimensions, y, z, part, in);
    switch (whole.operation) {
      case Operation::united: unite(out, part); break;
      case Operation::intersection: out = intersect(out, part); break;
      case Operation::difference: out = intersect(out, complement(part)); break;
    }
  }
}

}  // namespace

void spans(Shape const& shape, int dimensions, double y, double z, std::vector<Span>& out, Span const& part) {
  std::visit(
      [&](auto const& s) {
        using S = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<S, std::shared_ptr<Combination const>>) {
          spans(*s, dimensions, y, z, out, part);
        } else {
          Vec3 x = seen_from(s, dimensions, {0.0, y, z});
          if constexpr (std::is_same_v<S, Mesh>) {
            s.spans(x[1], x[2], out, part);
          } else {
            out.clear();
            Span const line = stretch(resolved(s, dimensions), {0.0, x[1], x[2]});
            if (line.from < line.to) out.push_back(line);
          }
        }
      },
      shape);
}

void breaks(Shape const& shape, int direction, double from, double to, std::vector<double>& out) {
  auto const add = [&](double at) {
    if (at > from && at < to) out.push_back(at);
  };
  if (auto const* mesh = std::get_if<Mesh>(&shape)) {
    auto const& faces = mesh->faces(direction);
    for (auto at = std::upper_bound(faces.begin(), faces.end(), from); at != faces.end() && *at < to; ++at) add(*at);
    return;
  }
  if (auto const* whole = std::get_if<std::shared_ptr<Combination const>>(&shape)) {
    for (Shape const& part : (*whole)->parts) breaks(part, direction, from, to, out);
    return;
  }
  Box const box = bounds(shape);
  add(box.lower[direction]);
  add(box.upper[direction]);
  if (auto const* half = std::get_if<Hemisphere>(&shape)) add(half->centre[direction]);
  if (auto const* cylinder = std::get_if<Cylinder>(&shape)) {
    // The two ends of an oblique cylinder begin and end within its box.
    double const a = cylinder->axis[direction];
    double const disc = cylinder->radius * std::sqrt(std::max(0.0, 1.0 - a * a));
    double const end = 0.5 * cylinder->length * std::abs(a);
    add(cylinder->centre[direction] + end - disc);
    add(cylinder->centre[direction] - end + disc);
  }
}

void breaks(Shape const& shape, int direction, Box const& box, std::vector<double>& out) {
  if (auto const* mesh = std::get_if<Mesh>(&shape)) {
    mesh->faces_in(direction, box.lower, box.upper, out);
  } else if (auto const* whole = std::get_if<std::shared_ptr<Combination const>>(&shape)) {
    for (Shape const& part : (*whole)->parts) breaks(part, direction, box, out);
  } else {
    breaks(shape, direction, box.lower[direction], box.upper[direction], out);
  }
}

std::vector<Station> stations(Shape const& shape, int direction, double from, double to, int count, double slack) {
  std::vector<double> ends;
  breaks(shape, direction, from + slack, to - slack, ends);
  return stations(std::move(ends), from, to, count, slack);
}

std::vector<Station> stations(std::vector<double> ends, double from, double to, int count, double slack) {
  std::sort(ends.begin(), ends.end());
  ends.push_back(to);
  std::vector<Station> all;
  double low = from;
  for (double const end : ends) {
    double const width = end - low;
    if (width <= slack && end < to) continue;
    int const n = std::max(2, static_cast<int>(std::ceil(count * width / (to - from) - 1e-9)));
    for (int q = 0; q < n; ++q) all.push_back({low + (q + 0.5) / n * width, width / (to - from) / n});
    low = end;
  }
  return all;
}

}  // namespace brisance::shape
