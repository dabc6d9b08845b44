/// The forest of blocks: the domain is cut into blocks of one size, level 0, and each of them may be cut into halves
/// per direction, again and again. What is cut no further is a leaf.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/vec.hpp"

namespace brisance::grid {

/// A block by its level and its place. Along each resolved direction a block of level l is 1/2^l as long as one of
/// level 0.
struct Leaf {
  int level = 0;
  Index3 place{0, 0, 0};  ///< counted in blocks of its level

  friend bool operator==(Leaf const&, Leaf const&) = default;
};

/// Morton key of a place: neighbours in space stay near each other in lists that it sorts.
[[nodiscard]] std::uint64_t morton(Index3 const& place);

/// Where a leaf comes from after a change: `count` leaves from `first` on, as they were numbered before. One of its own
/// level: the leaf is unchanged; one of a lower level: that was refined, maybe several times; a family of 2^dimensions:
/// they were merged.
struct Origin {
  int first = 0;
  int count = 1;
};

/// Leaves tile the domain and are balanced: those that touch, be it at a corner or through a periodic face, differ by
/// one level at most. The gas reads the coarse cells beside a fine block and a layer around them, past edges and
/// corners too: all of them must be of that level, in a leaf or below finer ones.
///
/// The order of leaves is the Morton order of their low corners, counted in blocks of the finest level, x fastest: it
/// does not depend on the library that refines, and with one level it is the Morton order of the places.
class Forest {
 public:
  /// Leaves of level 0, `parts` along each direction; unresolved directions have one. A periodic direction joins its
  /// two faces. Throws InputError when a direction has more blocks than an order can be found for: 2^21.
  Forest(Index3 const& parts, int dimensions, std::array<bool, 3> const& periodic);
  /// The same with leaves as they were. Throws InputError unless they are in order, tile the domain and are balanced,
  /// or where there are several levels and `can_refine` is false. `left_coarse`: which leaves are, or nothing; throws
  /// InputError where one of them cannot be.
  Forest(Index3 const& parts, int dimensions, std::array<bool, 3> const& periodic, std::vector<Leaf> leaves,
         std::vector<std::uint8_t> const& left_coarse = {});

  [[nodiscard]] std::vector<Leaf> const& leaves() const { return leaves_; }
  [[nodiscard]] Index3 const& parts() const { return parts_; }
  [[nodiscard]] int dimensions() const { return dimensions_; }
  [[nodiscard]] std::array<bool, 3> const& periodic() const { return periodic_; }
  /// The finest level that a forest of so many blocks may have.
  [[nodiscard]] int deepest_level() const { return deepest_level_; }

  /// Leaves that are left coarse: a family has one that is needed, and nobody asks for the fine cells of this one. It
  /// stands among the leaves, but its cells are those of the next coarser level.
  [[nodiscard]] bool is_left_coarse(int leaf) const { return left_coarse_[static_cast<std::size_t>(leaf)] != 0; }
  [[nodiscard]] std::vector<std::uint8_t> const& left_coarse() const { return left_coarse_; }
  /// The level of a leaf's cells.
  [[nodiscard]] int level_of_cells(int leaf) const {
    return leaves_[static_cast<std::size_t>(leaf)].level - (is_left_coarse(leaf) ? 1 : 0);
  }
  /// Leaves leaves coarse that `may` be, and no others: those that touch no finer cells than their own would be.
  void leave_coarse(std::vector<std::uint8_t> const& may);

  /// Number of the leaf that is a block or holds it; -1 where leaves are finer, or outside the domain.
  [[nodiscard]] int holding(Leaf const& block) const;
  /// Number of the leaf that is the block; -1 if none is.
  [[nodiscard]] int find(Leaf const& block) const;
  /// The block of the same level across a face (`Face` order), leaf or not; none behind the boundary of the domain.
  [[nodiscard]] std::optional<Leaf> across(Leaf const& block, int face) const;

  /// Asks whether the fine cells of a new leaf are wanted.
  using IsWanted = std::function<bool(Leaf const&)>;
  /// Refines leaves with mark > 0 that are below `most_level`, merges families all of whose leaves have mark < 0, each
  /// by one level, and refines what else the balance demands. It demands nothing finer than there is, so that no leaf
  /// goes beyond `most_level`. What would be merged only to be refined again stays as it is.
  ///
  /// With `is_wanted`, leaves are left coarse where that is possible: those with mark < 0, and new finer ones that are
  /// not wanted. One that has been left coarse stays so unless its mark is > 0; then it gets its own cells, and is not
  /// refined. So cells become coarser or finer by one level at most. Without, no leaf of the result is left coarse.
  ///
  /// Returns where each leaf comes from. Leaves, marks and `is_wanted` alone determine the result.
  /// Throws InputError when leaves must be refined and `can_refine` is false.
  std::vector<Origin> adapt(std::vector<std::int8_t> const& marks, int most_level, IsWanted const& is_wanted = {});

  /// Can forests with so many resolved directions have more than one level? In 2D and 3D, if the library is there.
  [[nodiscard]] static bool can_refine(int dimensions);
  /// Name and version of the library that refines; empty where the program was built without it.
  [[nodiscard]] static std::string library();

 private:
  [[nodiscard]] bool in_domain(Leaf const& block) const;
  /// The block of the same level that lies by an offset from one; none behind the boundary of the domain. Offsets are
  /// -1, 0 or 1 along each direction.
  [[nodiscard]] std::optional<Leaf> at_offset(Leaf const& block, Index3 const& offset) const;
  /// The Morton key of the low corner.
  [[nodiscard]] std::uint64_t key(Leaf const& block) const;
  /// Such keys that a block covers: those from its own on.
  [[nodiscard]] std::uint64_t keys_of(int level) const { return std::uint64_t{1} << (3 * (deepest_level_ - level)); }
  /// Does a leaf touch cells that are finer than its own level?
  [[nodiscard]] bool touches_finer(Leaf const& leaf) const;
  void require_tiling() const;
  void require_balance() const;
  /// Do the marks change a leaf?
  [[nodiscard]] bool refines(std::vector<std::int8_t> const& marks, int most_level) const;
  [[nodiscard]] bool merges(std::vector<std::int8_t> const& marks) const;
  void number();

  Index3 parts_;
  int dimensions_;
  std::array<bool, 3> periodic_;
  int deepest_level_ = 0;
  std::vector<Leaf> leaves_;
  std::vector<std::uint64_t> keys_;  ///< of the leaves: they increase
  std::vector<std::uint8_t> left_coarse_;
};

}  // namespace brisance::grid
