/// Cut cells: cells of which rigid bodies leave the gas a part of the volume and of the faces.
///
/// A sweep changes a cell of open volume V by the fluxes through its open faces and through the wall in it,
///     U += dt/V (A_low F_low - A_high F_high + S F_wall),   S = A_high - A_low   (a radius: less 2 pi times the
///     section),
/// so that uniform gas stays uniform whatever the cell's shape. The flux through the wall is that of the gas beside it
/// without its velocity into the wall, u_t with u_t . S = 0, and with the pressure p* of the gas that is stopped there:
///     F_wall = u_t,d (rho, rho u_t, E + p) + p* n_d.
/// The state that it is made of is that at the start of the step, the same in all sweeps: then what the wall lets
/// through in one sweep it returns in the others, to round-off [Gokhale18], and uniform gas that flows along a wall
/// stays uniform.
///
/// Cells that are too small for the step share their state with neighbours: state redistribution [BergerGiuliani21]
/// with weights that vanish where a cell is large enough [BergerGiuliani24], after every sweep.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/buffer.hpp"
#include "gas/layout.hpp"
#include "grid/bundle.hpp"
#include "shape/cut_cells.hpp"

namespace brisance::gas {

/// What is open of a cell.
struct CutCell {
  Index3 cell{0, 0, 0};          ///< index in the domain
  double volume = 0.0;           ///< [m3], as `Metric::cell_volume`
  std::array<double, 6> area{};  ///< of its faces [m2]
  Vec3 wall{0.0, 0.0, 0.0};      ///< area of the wall times its normal into the gas [m2]
};

/// A cell whose state redistribution may change: a cut cell, or one whose state small cells share.
struct Node {
  grid::Cell cell;
  double volume = 0.0;  ///< open [m3]
  int cut = -1;         ///< number of the cut cell; -1: it is whole
  /// Its entries in the list of shares.
  int first = 0;
  int end = 0;
};

/// A small cell with the neighbours that share its state.
struct Merger {
  int node = 0;  ///< the small cell
  /// Its members in the list of members.
  int first = 0;
  int end = 0;
};

/// What a cell and a merger have of each other.
struct Share {
  int node = 0;
  int merger = 0;
  /// By the node: the part of the cell's volume that the merger takes. By the merger: that part of its own volume.
  double weight = 0.0;
};

/// What a sweep asks of a cut cell; one line of the cache.
struct alignas(64) CutFlow {
  double inverse_volume = 0.0;   ///< [1/m3]
  std::array<double, 6> area{};  ///< [m2]
  double opening = 0.0;          ///< along a radius: what faces open outwards without a wall [m2]
};

/// The gas beside the wall of a cut cell at the start of a step; one line of the cache.
struct alignas(64) WallState {
  Vec3 velocity{0.0, 0.0, 0.0};  ///< along the wall [m/s]
  double pressure = 0.0;         ///< of the gas that is stopped at it [Pa]
  double enthalpy = 0.0;         ///< total, E + p [J/m3]
  PerFluid partial{};            ///< partial densities [kg/m3]
  double progress = 0.0;         ///< of the afterburn [kg/m3]
};

class CutCells {
 public:
  struct InBundle {
    int q = 0;
    int node = 0;
    int cut = -1;  ///< as in `Node`
  };

  /// `bundle_cells`: those of the sweeps.
  CutCells(grid::Grid const& grid, int bundle_cells) : grid_(&grid), bundle_cells_(bundle_cells) {}

  /// Is a cell (index in the domain) solid as a whole?
  using IsSolid = std::function<bool(Index3 const& cell)>;
  /// Sets the cut cells of the domain, all of one level, and how many components a state has.
  void set(std::vector<shape::CutCell> const& cells, int level, IsSolid const& is_solid, int components);
  /// That of all of them.
  [[nodiscard]] int level() const { return level_; }
  [[nodiscard]] std::vector<CutCell> const& cells() const { return cells_; }
  /// The node at a place; -1: none.
  [[nodiscard]] int node_at(grid::Cell const& cell) const;
  /// What obstacles leave of a cell's volume [m3]; of one that is solid as a whole all of it, for it holds gas too.
  [[nodiscard]] double volume(grid::Cell const& cell) const;
  /// What they leave of its low (side 0) or high (1) face [m2].
  [[nodiscard]] double area(grid::Cell const& cell, int direction, int side) const;
  /// Is a face of the domain beside a block's cells cut?
  [[nodiscard]] bool cut_boundary(int block, int face) const { return in(block) && of_block_[block].boundary[face]; }
  /// Does a block hold nodes?
  [[nodiscard]] bool in(int block) const { return any() && !of_block_[block].numbers.empty(); }

  [[nodiscard]] std::vector<Node> const& nodes() const { return nodes_; }
  /// The nodes of each block that has some: [first, second).
  [[nodiscard]] std::vector<std::pair<int, int>> const& ranges() const { return ranges_; }
  [[nodiscard]] std::vector<Merger> const& mergers() const { return mergers_; }
  /// Shares by the node, and by the merger.
  [[nodiscard]] std::vector<Share> const& shares() const { return shares_; }
  [[nodiscard]] std::vector<Share> const& members() const { return members_; }
  /// The nodes of a bundle of a sweep.
  [[nodiscard]] std::span<InBundle const> in_bundle(int block, int direction, int bundle) const {
    if (!any() || of_block_[block].in_bundles[direction].first.empty()) return {};
    OfBundles const& of = of_block_[block].in_bundles[direction];
    return {of.nodes.data() + of.first[bundle], of.nodes.data() + of.first[bundle + 1]};
  }

  /// Whole lines of the cache, of 8 doubles each, that a state takes; what it does not need of them is 0.
  [[nodiscard]] int lines() const { return static_cast<int>(pitch_) / line; }
  static constexpr int line = 8;
  /// The state of a node: as the last sweep left it, or what a sweep changes of it.
  [[nodiscard]] double* state(int node) { return states_.data() + pitch_ * node; }
  [[nodiscard]] double* merged(int merger) { return merged_.data() + pitch_ * merger; }
  [[nodiscard]] CutFlow const& flow(int cut) const { return flows_[cut]; }
  [[nodiscard]] WallState& wall(int cut) { return walls_[cut]; }
  /// Is the gas beside the wall quiescent? That of blocks that sleep is.
  [[nodiscard]] std::uint8_t& quiescent(int cut) { return quiescent_[cut]; }

 private:
  [[nodiscard]] bool any() const { return !nodes_.empty(); }
  struct OfBundles {
    std::vector<InBundle> nodes;  ///< bundle by bundle
    std::vector<int> first;       ///< of each bundle, and the number of all
  };
  struct OfBlock {
    std::vector<int> numbers;               ///< of the nodes, by the cell's offset; -1: none. Empty in blocks without
    std::array<OfBundles, 3> in_bundles{};  ///< per direction
    std::array<bool, 6> boundary{};         ///< is a face of the domain cut?
  };
  /// A small cell and the neighbours that it takes into its merger.
  struct Group {
    std::size_t cut = 0;
    std::vector<Index3> members;  ///< without the cell itself
    double weight = 0.0;          ///< that it asks of each
  };
  [[nodiscard]] std::vector<Group> groups(IsSolid const& is_solid) const;
  [[nodiscard]] Group group_of(std::size_t cut, IsSolid const& is_solid) const;
  /// The open area of a cell's face, and its open volume.
  [[nodiscard]] double open_area(Index3 const& cell, int face) const;
  [[nodiscard]] double open_volume(Index3 const& cell) const;
  /// The cut cell at a place; null: it is whole, or solid.
  [[nodiscard]] CutCell const* find(grid::Cell const& cell) const;
  [[nodiscard]] CutCell const* find(Index3 const& cell) const;
  void make_nodes(std::vector<Group> const& groups);
  void make_mergers(std::vector<Group> const& groups);
  void find_bundles();
  void find_boundaries();

  [[nodiscard]] grid::Domain const& domain() const { return grid_->domain(level_); }
  [[nodiscard]] grid::Cell locate(Index3 const& cell) const { return grid_->locate(level_, cell).value(); }

  grid::Grid const* grid_;
  int bundle_cells_;
  int level_ = 0;
  std::vector<CutCell> cells_;
  std::unordered_map<std::size_t, std::size_t> number_;  ///< place in the domain -> cut cell
  std::unordered_map<std::size_t, int> node_of_;         ///< place in the domain -> node
  std::vector<Node> nodes_;
  std::vector<std::pair<int, int>> ranges_;
  std::vector<Merger> mergers_;
  std::vector<Share> shares_, members_;
  std::vector<OfBlock> of_block_;
  Buffer states_, merged_;
  std::size_t pitch_ = 0;  ///< doubles per state: whole lines of the cache
  std::vector<CutFlow> flows_;
  std::vector<WallState> walls_;
  std::vector<std::uint8_t> quiescent_;
};

}  // namespace brisance::gas
