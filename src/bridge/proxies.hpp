/// Proxies: gas cells outside the region that act as points for a step, [Cui14] Eqs. (37)-(39). Nodes at the region's
/// surface take part of their mass, momentum and force from them.
#pragma once

#include <array>
#include <vector>

#include "bridge/faces.hpp"
#include "bridge/ledger.hpp"
#include "bridge/shared_gas.hpp"
#include "mpm/mpm.hpp"

namespace brisance::bridge {

class Proxies {
 public:
  /// Announces to the points that these are lent to the body of the gas points. Keeps references.
  Proxies(mpm::Mpm& points, int gas_body, Faces const& faces, SharedGas const& shared);

  /// Makes the points for a step that begins and ends at these parts of the gas step, 0 to 1. Each cell becomes as
  /// many points as the deck asks for; they stand where the rows of points in the region would go on: the ledger
  /// tells by how much of a point's mass.
  void lend(double begin, double end, Ledger const& ledger);
  /// Blocks of points that hold such cells.
  [[nodiscard]] std::vector<int> blocks() const;

 private:
  struct LentCell {
    int state = -1;    ///< number among the shared states, or, of cells beyond an open boundary,
    int average = -1;  ///< among the averages
    Index3 cell{0, 0, 0};
    /// Faces of the region that the cell lies before, one per direction at most; -1: none.
    std::array<int, 3> face{-1, -1, -1};
  };
  struct LentBlock {
    int block = 0;
    std::vector<LentCell> cells;
  };
  void lend_cell(LentCell const& lent, double begin, double end, Ledger const& ledger, mpm::PointSet& set) const;

  mpm::Mpm* points_;
  Faces const* faces_;
  SharedGas const* shared_;
  std::vector<LentBlock> blocks_;
};

}  // namespace brisance::bridge
