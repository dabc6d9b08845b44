/// Proxy particles: they act in the blocks for one step, and somebody else owns them.
#pragma once

#include <vector>

#include "grid/block_store.hpp"
#include "mpm/accounts.hpp"
#include "mpm/particles.hpp"

namespace brisance::mpm {

/// Proxy particles give the nodes mass, momentum and force as all others do, but their state belongs to their owner,
/// who also tells their velocity at the end of the step (field `next_x`). They may be changed between steps.
class ProxyParticles {
 public:
  /// Keeps a reference.
  explicit ProxyParticles(grid::Grid const& grid) : grid_(&grid) {}

  /// Which body the proxy particles belong to, and what its own particles carry. To be called before the first is
  /// added.
  void belong_to(int body, FieldList fields);
  [[nodiscard]] int body() const { return body_; }                 ///< -1: there are none
  [[nodiscard]] std::size_t size() const { return sets_.size(); }  ///< blocks, or 0 where there are none
  [[nodiscard]] ParticleSet& particles(int block) { return sets_[block]; }
  [[nodiscard]] ParticleSet const& particles(int block) const { return sets_[block]; }
  /// Does a block have proxy particles?
  [[nodiscard]] bool any(int block) const { return body_ >= 0 && !sets_[block].empty(); }
  /// Is it the set of a block's proxy particles?
  [[nodiscard]] bool owns(int block, ParticleSet const& set) const { return body_ >= 0 && &set == &sets_[block]; }
  /// What the proxy particles of a block gave to its nodes in the last step.
  [[nodiscard]] std::vector<NodeGift>& gifts(int block) { return gifts_[block]; }

 private:
  grid::Grid const* grid_;
  int body_ = -1;
  grid::BlockStore<ParticleSet> sets_;
  grid::BlockStore<std::vector<NodeGift>> gifts_;
};

}  // namespace brisance::mpm
