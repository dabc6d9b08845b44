#include "shape/parts.hpp"

#include <algorithm>

namespace brisance::shape {

Parts parts_of_cell(std::vector<Shape> const& shapes, grid::Metric const& fine, Index3 const& cell, int per_direction) {
  Parts parts;
  Index3 first{0, 0, 0};
  for (int d = 0; d < fine.dimensions(); ++d) {
    parts.box.upper[d] = per_direction;
    first[d] = cell[d] * per_direction;
  }
  grid::for_each_cell(parts.box.moved(first), [&](Index3 const& part) {
    parts.free.push_back(shares_of_cell(shapes, fine, part, 2).empty() ? 1 : 0);
  });
  return parts;
}

int Pieces::largest() const { return static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin()); }

Pieces pieces_of(Parts const& parts) {
  Pieces pieces{std::vector<int>(parts.free.size(), 0), {0}};
  std::vector<std::size_t> reached;
  for (std::size_t start = 0; start < parts.free.size(); ++start) {
    if (parts.free[start] == 0 || pieces.number[start] != 0) continue;
    int const count = static_cast<int>(pieces.size.size());
    pieces.size.push_back(0);
    pieces.number[start] = count;
    reached.push_back(start);
    while (!reached.empty()) {
      Index3 const part = parts.box.at(reached.back());
      reached.pop_back();
      ++pieces.size.back();
      for (int face = 0; face < 6; ++face) {
        Index3 const beside = grid::beside(part, face / 2, face % 2);
        if (!parts.box.contains(beside)) continue;
        std::size_t const next = parts.box.offset(beside);
        if (parts.free[next] == 0 || pieces.number[next] != 0) continue;
        pieces.number[next] = count;
        reached.push_back(next);
      }
    }
  }
  return pieces;
}

}  // namespace brisance::shape
