#include "bridge/node_shares.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace brisance::bridge {

namespace {

constexpr int reach = 2;   // nodes on both sides of a face that particles on its other side can touch
constexpr int margin = 3;  // of node numbers around the grid of the particles
constexpr int all = 3;     // number of the shares of all faces around a node

/// Quadratic B-spline around a node; `x` in cells.
double spline(double x) {
  x = std::abs(x);
  return x < 0.5 ? 0.75 - x * x : x < 1.5 ? 0.5 * (1.5 - x) * (1.5 - x) : 0.0;
}

}  // namespace

/// A lane counts for a node by its area and by the weight of the node at its middle. Of an even pressure on the whole
/// region every lane gets its own area's part: next to edges too, since the weights of all nodes at a particle sum
/// to 1.
NodeShares::NodeShares(Faces const& faces) {
  Region const& region = faces.region();
  grid::Domain const& own = region.particles_domain();
  int const dims = own.dimensions();
  for (int d = 0; d < dims; ++d) nodes_.upper[d] = own.cells[d] + 1;
  nodes_ = nodes_.grown(margin, dims);

  std::map<std::size_t, std::array<std::map<int, double>, 4>> weights;  // node -> kind -> face
  for (int f = 0; f < faces.count(); ++f) {
    Face const& face = faces[f];
    Index3 const cell = region.to_particles(face.inside);
    grid::CellRange near;
    for (int d = 0; d < dims; ++d) {
      bool const normal = d == face.direction;
      near.lower[d] = normal ? cell[d] + face.side - reach : cell[d] - 1;
      near.upper[d] = (normal ? cell[d] + face.side + reach : cell[d] + 2) + 1;
    }
    for_each_cell(near, [&](Index3 const& node) {
      double weight = 0.0;
      for (int lane = 0; lane < faces.lanes(); ++lane) {
        Index3 const sub = faces.sub_cell(f, lane);
        double w = faces.lane_area(f, lane);
        for (int d = 0; d < dims; ++d) {
          if (d != face.direction) w *= spline(node[d] - cell[d] - (sub[d] + 0.5) / faces.parts());
        }
        weight += w;
      }
      if (weight <= 0.0) return;
      std::size_t const key = key_of(grid::image_node(own, node).index);
      weights[key][face.direction][f] += weight;
      weights[key][all][f] += weight;
    });
  }
  for (auto const& [key, kinds] : weights) {
    auto& ranges = ranges_[key];
    for (int kind = 0; kind < 4; ++kind) {
      auto const& some = kinds[kind].empty() ? kinds[all] : kinds[kind];
      ranges[kind] = {static_cast<int>(shares_.size()), static_cast<int>(some.size())};
      double sum = 0.0;
      for (auto const& [face, weight] : some) sum += weight;
      for (auto const& [face, weight] : some) shares_.push_back({face, weight / sum});
    }
  }
}

std::span<NodeShares::Share const> NodeShares::find(Index3 const& node, int kind) const {
  auto const found = ranges_.find(key_of(node));
  if (found == ranges_.end()) return {};
  Range const& range = found->second[kind];
  return std::span(shares_).subspan(range.first, range.count);
}

std::span<NodeShares::Share const> NodeShares::across(Index3 const& node, int direction) const {
  return find(node, direction);
}

std::span<NodeShares::Share const> NodeShares::around(Index3 const& node) const { return find(node, all); }

}  // namespace brisance::bridge
