/// Levels of the gas: what joins cells of one size to those of half that size.
///
/// A level takes its step first, and then the next finer one takes two of half the length [BergerColella89]. Between
/// them stand
///   - strips: the coarse cells beside a fine block, at every stage of the coarse step. The fine block's ghost cells
///   are
///     made of them, at the time and after the sweeps that the fine step has reached;
///   - flux registers: what went through the faces between two levels, found by both. The coarse cells are corrected to
///     what the fine ones found, so that nothing is lost or made there;
///   - covered blocks and covered parts: they take the means of the fine cells that cover them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/buffer.hpp"
#include "gas/kernels.hpp"
#include "gas/prolongation.hpp"
#include "grid/block_store.hpp"
#include "grid/fields.hpp"
#include "grid/grid.hpp"

namespace brisance::gas {

class Levels {
 public:
  using IsSolid = std::function<bool(grid::Cell const& cell)>;

  /// `is_solid`: null where there are no obstacles. At the end of a level they fit its cells and the coarser ones.
  Levels(grid::Grid const& grid, Fluids const& fluids, int components, IsSolid const& is_solid = {});

  /// What quiescent gas holds and carries: accounts count differences to it, which blocks that sleep do not have.
  void set_quiescent(Components const& state, std::array<Components, 3> const& flux, Vec3 const& velocity);

  // Strips. A level begins a step with the sweeps of `order`.
  void begin_step(grid::Fields const& fields, grid::AwakeBlocks const& awake, int level, std::vector<int> const& order);
  /// A sweep of that step is done.
  void end_sweep(grid::Fields const& fields, grid::AwakeBlocks const& awake, int level);
  /// The finer level begins a step within that of the level below it: the part of that step before, and its own part.
  void begin_fine_step(int level, double begun, double length);
  void end_fine_sweep(int level, int direction) { clock_[level].done[direction] = true; }
  /// The ghost cells of a block beyond a face behind which cells are coarser: per component an array over the
  /// `grid::ghost_box`.
  void fill(int block, int face, double* ghosts) const;

  // Registers.
  /// The planes of a block across a direction at which cells may meet those of another level.
  enum class Plane : std::uint8_t { low, high, middle };
  [[nodiscard]] bool counts(int block, int direction, Plane plane) const {
    return !registers_[block][number_of(direction, plane)].sum.empty();
  }
  /// Adds what goes through a plane of a bundle's block in a sweep.
  void count(int block, BundleLayout const& layout, Plane plane, SweepContext const& context, BundleArrays& arrays);
  /// Corrects the cells of a level beside finer ones, and forgets what was counted. Calls changed(cell) for each.
  template <class Changed>
  void correct(grid::Fields& fields, int level, Changed const& changed) {
    for (Contact const& contact : contacts_[level]) correct(fields, contact, changed);
  }

  /// Gives the covered blocks of a level the means of the finer cells. Calls changed(block) for those in which any is
  /// not quiescent.
  template <class Changed>
  void restrict(grid::Fields& fields, grid::AwakeBlocks const& awake, int level, Changed const& changed) const {
    restrict(fields, awake, covered_[level], changed);
  }
  /// The same for some of them.
  template <class Changed>
  void restrict(grid::Fields& fields, grid::AwakeBlocks const& awake, std::vector<int> const& blocks,
                Changed const& changed) const {
    std::vector<std::uint8_t> disturbed(blocks.size(), 0);
    find_means(fields, awake, blocks, disturbed);
    for (std::size_t n = 0; n < blocks.size(); ++n) {
      if (disturbed[n] != 0) changed(blocks[n]);
    }
  }

 private:
  static constexpr int plane_count = 9;  ///< of a block: its faces, and one in the middle across each direction
  [[nodiscard]] static int number_of(int direction, Plane plane) {
    return plane == Plane::middle ? 6 + direction : 2 * direction + (plane == Plane::low ? 0 : 1);
  }
  /// What went through the faces of a block's cells at one of its planes, less what quiescent gas carries, times area
  /// and time: all components and the volume, cell by cell.
  struct Register {
    std::vector<double> sum;
  };
  /// A fine block's face behind which cells are coarser.
  struct Contact {
    int fine = 0;                      ///< block
    int face = 0;                      ///< of the fine block
    int coarse = 0;                    ///< block
    Plane plane = Plane::low;          ///< of the coarse block: in the middle where the fine one covers a part of it
    grid::CellRange core;              ///< the coarse cells beside the face, by their index in the domain
    std::vector<std::uint8_t> closed;  ///< of the core: nothing goes through the face; empty: through all of it
  };
  enum class Holds : std::uint8_t { nothing, gas, solid };
  struct Strip {
    grid::CellRange box;  ///< the core of its contact and one layer around
    /// Cells of the box along x that follow each other in a block.
    struct Row {
      int block = 0;
      int offset = 0;
      int count = 0;
      std::size_t place = 0;  ///< in the box
    };
    std::vector<Row> rows;
    std::vector<Holds> holds;  ///< what the cells of the box hold
    std::vector<int> blocks;   ///< that give something
    bool quiet = false;        ///< all of them have slept since the step began
    /// The cells at the start of the step and after each sweep: arrays over the box, component by component. Empty
    /// as long as none was needed.
    std::array<std::vector<double>, 4> stages;
  };
  /// Where a level stands within a step of the level below it.
  struct Clock {
    std::vector<int> order;                         ///< of its own sweeps
    int sweeps = 0;                                 ///< of its own step that are done
    double begun = 0.0;                             ///< part of the coarser step before its own one
    double length = 0.5;                            ///< part that its own one is
    std::array<bool, 3> done{false, false, false};  ///< own sweeps, by their direction
  };

  /// The cells at a plane of a block; where it lies in the middle, those below it.
  [[nodiscard]] static grid::CellRange cells_at(grid::Block const& block, int direction, Plane plane);
  [[nodiscard]] Contact contact_at(grid::Block const& fine, int face) const;
  /// Finds where the face is closed, from the strip of the contact.
  static void close(Contact& contact, Strip const& strip);
  [[nodiscard]] Strip strip_at(Contact const& contact, IsSolid const& is_solid) const;
  void gather(grid::Fields const& fields, grid::AwakeBlocks const& awake, Strip& strip, int stage) const;
  /// The arrays of a strip at the time of the fine level.
  [[nodiscard]] std::vector<double> at_present(Strip const& strip, int coarse_level) const;
  [[nodiscard]] int values() const { return components_ + 1; }
  [[nodiscard]] double* entry(int block, int direction, Plane plane, grid::Cell const& cell);

  template <class Changed>
  void correct(grid::Fields& fields, Contact const& contact, Changed const& changed) {
    std::vector<grid::Cell> const cells = correct(fields, contact);
    for (grid::Cell const& cell : cells) changed(cell);
  }
  std::vector<grid::Cell> correct(grid::Fields& fields, Contact const& contact);
  void find_means(grid::Fields& fields, grid::AwakeBlocks const& awake, std::vector<int> const& blocks,
                  std::vector<std::uint8_t>& disturbed) const;
  /// The cells of a block that one finer block covers; is any mean anything but quiescent?
  bool find_means(grid::Fields& fields, grid::Block const& coarse, grid::Block const& fine) const;

  grid::Grid const* grid_;
  Fluids fluids_;
  int components_;
  Components quiet_{};
  std::array<Components, 3> quiet_flux_{};
  Vec3 quiet_velocity_{0.0, 0.0, 0.0};
  std::vector<std::vector<int>> covered_;          ///< blocks, as a whole or in part, by their level
  std::vector<std::vector<Contact>> contacts_;     ///< by the level of the coarse cells
  std::vector<std::vector<Strip>> strips_;         ///< of the same
  grid::BlockStore<std::array<int, 6>> strip_of_;  ///< of a fine block's faces, by the number in its level
  std::vector<std::array<Register, plane_count>> registers_;
  std::vector<Clock> clock_;
};

}  // namespace brisance::gas
