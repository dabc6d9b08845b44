/// Points that somebody else owns and lends to the blocks for a step.
#pragma once

#include <vector>

#include "mpm/accounts.hpp"
#include "mpm/points.hpp"

namespace brisance::mpm {

/// Lent points give the nodes mass, momentum and force as all others do, but their state belongs to their owner, who
/// also tells their velocity at the end of the step (field `next_x`). They may be changed between steps.
class Loans {
 public:
  /// `sets`: those of all bodies, block by block. Keeps a reference.
  Loans(std::vector<PointSet> const& sets, int blocks) : sets_(&sets), blocks_(blocks) {}

  /// Which body the lent points belong to. To be called before the first is lent.
  void belong_to(int body);
  [[nodiscard]] int body() const { return body_; }                 ///< -1: nothing is lent
  [[nodiscard]] std::size_t size() const { return lent_.size(); }  ///< blocks, or 0 where nothing is lent
  [[nodiscard]] PointSet& points(int block) { return lent_[block]; }
  [[nodiscard]] PointSet const& points(int block) const { return lent_[block]; }
  /// Does a block have lent points?
  [[nodiscard]] bool any(int block) const { return body_ >= 0 && !lent_[block].empty(); }
  /// Is it the set of the points lent to a block?
  [[nodiscard]] bool owns(int block, PointSet const& set) const { return body_ >= 0 && &set == &lent_[block]; }
  /// What the points lent to a block gave at its nodes in the last step.
  [[nodiscard]] std::vector<NodeGift>& gifts(int block) { return gifts_[block]; }

 private:
  std::vector<PointSet> const* sets_;
  int blocks_;
  int body_ = -1;
  std::vector<PointSet> lent_;                ///< per block
  std::vector<std::vector<NodeGift>> gifts_;  ///< per block
};

}  // namespace brisance::mpm
