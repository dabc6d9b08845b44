#include "grid/forest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "core/error.hpp"
#include "grid/cell.hpp"
#include "grid/forest_p4est.hpp"

namespace brisance::grid {

namespace {

/// Bits of a place in a Morton key, for each of three directions.
constexpr int place_bits = 21;

/// The deepest level of p4est in 3D; no run comes near it.
constexpr int most_levels = 18;

/// The bits of a number, each followed by two zeros.
std::uint64_t spread(int value) {
  std::uint64_t bits = static_cast<std::uint64_t>(value) & 0x1fffffULL;
  bits = (bits | bits << 32) & 0x001f00000000ffffULL;
  bits = (bits | bits << 16) & 0x001f0000ff0000ffULL;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fULL;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3ULL;
  return (bits | bits << 2) & 0x1249249249249249ULL;
}

/// Where the leaves of one list come from in another of the same domain: both run through it in the same order.
std::vector<Origin> origins(std::vector<Leaf> const& before, std::vector<Leaf> const& after, int dimensions) {
  auto const volume = [dimensions](Leaf const& leaf) {
    return std::uint64_t{1} << (dimensions * (most_levels - leaf.level));
  };
  std::vector<Origin> found;
  found.reserve(after.size());
  int next = 0;
  std::uint64_t left = 0;  // of the leaf `next`, when some of its children have passed
  for (Leaf const& leaf : after) {
    Origin origin{next, 1};
    std::uint64_t const wanted = volume(leaf);
    auto const first = static_cast<std::size_t>(next);
    if (left == 0) left = volume(before[first]);
    while (left < wanted) {
      left += volume(before[first + origin.count]);
      ++origin.count;
    }
    left -= wanted;
    next = origin.first + origin.count - (left > 0 ? 1 : 0);
    found.push_back(origin);
  }
  return found;
}

}  // namespace

std::uint64_t morton(Index3 const& p) { return spread(p[0]) | spread(p[1]) << 1 | spread(p[2]) << 2; }

Forest::Forest(Index3 const& parts, int dimensions, std::array<bool, 3> const& periodic)
    : parts_(parts), dimensions_(dimensions), periodic_(periodic) {
  int most = 1;
  for (int d = 0; d < 3; ++d) {
    bool const resolved = d < dimensions;
    if (parts[d] < 1 || (!resolved && parts[d] != 1)) {
      throw InputError(fmt::format("{} block(s) in direction {} of a grid in {}D", parts[d], "xyz"[d], dimensions));
    }
    periodic_[d] = periodic[d] && resolved;
    most = std::max(most, parts[d]);
  }
  int const bits = std::bit_width(static_cast<unsigned>(most) - 1U);
  if (bits > place_bits) {
    throw InputError(
        fmt::format("{} blocks along a direction are more than 2^{}; choose larger blocks or cells", most, place_bits));
  }
  deepest_level_ = std::min(most_levels, place_bits - bits);

  CellRange const all{{0, 0, 0}, parts};
  leaves_.reserve(all.count());
  for_each_cell(all, [this](Index3 const& place) { leaves_.push_back({0, place}); });
  std::sort(leaves_.begin(), leaves_.end(),
            [](Leaf const& a, Leaf const& b) { return morton(a.place) < morton(b.place); });
  number();
}

Forest::Forest(Index3 const& parts, int dimensions, std::array<bool, 3> const& periodic, std::vector<Leaf> leaves,
               std::vector<std::uint8_t> const& left_coarse)
    : Forest(parts, dimensions, periodic) {
  leaves_ = std::move(leaves);
  require_tiling();
  number();
  require_balance();
  if (left_coarse.empty()) return;
  leave_coarse(left_coarse);
  if (left_coarse_ != left_coarse) throw InputError("blocks of the grid are left coarse beside finer ones");
}

void Forest::number() {
  keys_.resize(leaves_.size());
  std::transform(leaves_.begin(), leaves_.end(), keys_.begin(), [this](Leaf const& leaf) { return key(leaf); });
  left_coarse_.assign(leaves_.size(), 0);
}

bool Forest::touches_finer(Leaf const& leaf) const {
  return any_cell(around({0, 0, 0}, 1, dimensions_), [&](Index3 const& offset) {
    std::optional<Leaf> const next = at_offset(leaf, offset);
    if (!next || holding(*next) >= 0) return false;
    // Of the finer leaves those that touch.
    CellRange touching{next->place, next->place};
    for (int d = 0; d < 3; ++d) {
      if (d < dimensions_) touching.lower[d] = 2 * next->place[d] + (offset[d] < 0 ? 1 : 0);
      touching.upper[d] = touching.lower[d] + (d < dimensions_ && offset[d] == 0 ? 2 : 1);
    }
    return any_cell(touching, [&](Index3 const& place) {
      int const finer = find({leaf.level + 1, place});
      return finer < 0 || !is_left_coarse(finer);
    });
  });
}

void Forest::leave_coarse(std::vector<std::uint8_t> const& may) {
  if (may.size() != leaves_.size())
    throw InputError(fmt::format("{} marks for {} blocks of the grid", may.size(), leaves_.size()));
  left_coarse_.assign(leaves_.size(), 0);
  int finest = 0;
  for (Leaf const& leaf : leaves_) finest = std::max(finest, leaf.level);
  // Those of finer levels first: what they come to decides for the coarser ones.
  for (int level = finest; level > 0; --level) {
    for (std::size_t n = 0; n < leaves_.size(); ++n) {
      if (may[n] != 0 && leaves_[n].level == level && !touches_finer(leaves_[n])) left_coarse_[n] = 1;
    }
  }
}

bool Forest::in_domain(Leaf const& block) const {
  if (block.level < 0 || block.level > deepest_level_) return false;
  for (int d = 0; d < 3; ++d) {
    int const n = d < dimensions_ ? parts_[d] << block.level : 1;
    if (block.place[d] < 0 || block.place[d] >= n) return false;
  }
  return true;
}

std::uint64_t Forest::key(Leaf const& block) const {
  return morton(block.place) << (3 * (deepest_level_ - block.level));
}

void Forest::require_tiling() const {
  auto const blocks_of = [this](int level) { return std::uint64_t{1} << (dimensions_ * (deepest_level_ - level)); };
  std::uint64_t next = 0;
  std::uint64_t blocks = 0;
  for (Leaf const& leaf : leaves_) {
    if (!in_domain(leaf)) {
      throw InputError(fmt::format("the block ({}, {}, {}) of level {} lies outside the grid", leaf.place[0],
                                   leaf.place[1], leaf.place[2], leaf.level));
    }
    if (leaf.level > 0 && !can_refine(dimensions_)) {
      throw InputError("the grid has blocks of several levels, and this program was built without p4est");
    }
    if (key(leaf) < next) throw InputError("the blocks of the grid overlap or are not in Morton order");
    next = key(leaf) + keys_of(leaf.level);
    blocks += blocks_of(leaf.level);
  }
  std::uint64_t const all = CellRange{{0, 0, 0}, parts_}.count() * blocks_of(0);
  if (blocks != all) throw InputError("the blocks of the grid leave a part of the domain open");
}

void Forest::require_balance() const {
  for (Leaf const& leaf : leaves_) {
    for_each_cell(around({0, 0, 0}, 1, dimensions_), [&](Index3 const& offset) {
      std::optional<Leaf> const next = at_offset(leaf, offset);
      int const number = next ? holding(*next) : -1;
      if (number < 0) return;
      int const level = leaves_[static_cast<std::size_t>(number)].level;
      if (level < leaf.level - 1) {
        throw InputError(fmt::format("the block ({}, {}, {}) of level {} touches one of level {}", leaf.place[0],
                                     leaf.place[1], leaf.place[2], leaf.level, level));
      }
    });
  }
}

int Forest::holding(Leaf const& block) const {
  if (!in_domain(block)) return -1;
  // Leaves tile the domain: the last one that begins no later holds the low corner.
  auto const after = std::upper_bound(keys_.begin(), keys_.end(), key(block));
  int const number = static_cast<int>(after - keys_.begin()) - 1;
  return leaves_[static_cast<std::size_t>(number)].level <= block.level ? number : -1;
}

int Forest::find(Leaf const& block) const {
  int const number = holding(block);
  return number >= 0 && leaves_[static_cast<std::size_t>(number)].level == block.level ? number : -1;
}

std::optional<Leaf> Forest::across(Leaf const& block, int face) const {
  return face < 2 * dimensions_ ? at_offset(block, beside({0, 0, 0}, face / 2, face % 2)) : std::nullopt;
}

std::optional<Leaf> Forest::at_offset(Leaf const& block, Index3 const& offset) const {
  Leaf next = block;
  for (int d = 0; d < dimensions_; ++d) {
    int const n = parts_[d] << block.level;
    next.place[d] += offset[d];
    if (next.place[d] >= 0 && next.place[d] < n) continue;
    if (!periodic_[d]) return std::nullopt;
    next.place[d] = (next.place[d] + n) % n;
  }
  return next;
}

bool Forest::refines(std::vector<std::int8_t> const& marks, int most_level) const {
  for (std::size_t i = 0; i < leaves_.size(); ++i) {
    if (marks[i] > 0 && leaves_[i].level < most_level) return true;
  }
  return false;
}

bool Forest::merges(std::vector<std::int8_t> const& marks) const {
  std::size_t const family = std::size_t{1} << dimensions_;
  std::size_t together = 0;  // leaves of one family, one after the other, that want to be merged
  for (std::size_t i = 0; i < leaves_.size(); ++i) {
    Leaf const& leaf = leaves_[i];
    bool first = true;
    for (int d = 0; d < dimensions_; ++d) first = first && leaf.place[d] % 2 == 0;
    bool const wants = leaf.level > 0 && marks[i] < 0;
    if (first) together = wants ? 1 : 0;
    if (!first) together = wants && together > 0 && leaf.level == leaves_[i - 1].level ? together + 1 : 0;
    if (together == family) return true;
  }
  return false;
}

std::vector<Origin> Forest::adapt(std::vector<std::int8_t> const& marks, int most_level, IsWanted const& is_wanted) {
  if (marks.size() != leaves_.size()) {
    throw InputError(fmt::format("{} marks for {} blocks of the grid", marks.size(), leaves_.size()));
  }
  if (most_level > deepest_level_) {
    throw InputError(fmt::format("a grid of {} x {} x {} blocks can have up to {} levels above the first, not {}",
                                 parts_[0], parts_[1], parts_[2], deepest_level_, most_level));
  }
  std::vector<std::int8_t> of_leaves = marks;
  for (std::size_t n = 0; n < marks.size(); ++n) {
    if (left_coarse_[n] != 0 && marks[n] > 0) of_leaves[n] = 0;
  }
  bool const refined = refines(of_leaves, most_level);
  if (refined && !can_refine(dimensions_)) {
    throw InputError(dimensions_ == 1
                         ? "a 1D grid has blocks of one level only"
                         : "this program was built without p4est: its grids have blocks of one level only");
  }
  std::vector<Leaf> const before = leaves_;
  std::vector<std::uint8_t> const coarse_before = left_coarse_;
  left_coarse_.assign(leaves_.size(), 0);
  // A grid of one level never starts the library.
  if (refined || merges(of_leaves)) {
    leaves_ = leaves_by_p4est(*this, of_leaves, most_level);
    number();
  }
  std::vector<Origin> from = origins(before, leaves_, dimensions_);
  if (!is_wanted) return from;
  std::vector<std::uint8_t> may(leaves_.size(), 0);
  for (std::size_t n = 0; n < leaves_.size(); ++n) {
    auto const first = static_cast<std::size_t>(from[n].first);
    if (leaves_[n].level == 0 || from[n].count > 1) continue;
    bool const stays = leaves_[n].level == before[first].level;
    bool const leaves_it = coarse_before[first] != 0 ? marks[first] <= 0 : marks[first] < 0;
    may[n] = (stays ? leaves_it : !is_wanted(leaves_[n])) ? 1 : 0;
  }
  leave_coarse(may);
  return from;
}

}  // namespace brisance::grid
