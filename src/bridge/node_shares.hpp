/// Which faces of the region a node of the particles counts for. What gas cells outside give to the nodes is booked on
/// the accounts of the faces that it comes through.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <unordered_map>
#include <vector>

#include "bridge/faces.hpp"

namespace brisance::bridge {

class NodeShares {
 public:
  struct Share {
    int face = 0;
    double fraction = 0.0;  ///< the parts of a node sum to 1
  };

  explicit NodeShares(Faces const& faces);

  /// Of what acts at a node in a direction: pressure. The faces across that direction, or where there are none, all.
  [[nodiscard]] std::span<Share const> across(Index3 const& node, int direction) const;
  /// Of what a node gets by the exchange of momentum: all faces around it.
  [[nodiscard]] std::span<Share const> around(Index3 const& node) const;

 private:
  struct Range {
    int first = 0;
    int count = 0;
  };
  [[nodiscard]] std::span<Share const> find(Index3 const& node, int kind) const;
  [[nodiscard]] std::size_t key_of(Index3 const& node) const { return nodes_.offset(node); }

  grid::CellRange nodes_;  ///< of the grid of the particles, with a margin
  std::unordered_map<std::size_t, std::array<Range, 4>> ranges_;
  std::vector<Share> shares_;
};

}  // namespace brisance::bridge
