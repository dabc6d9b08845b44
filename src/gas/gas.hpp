/// The gas region: conserved fields in blocks, advanced by dimensionally split sweeps. [Cui14] Sec. 2.1, Eqs. (1)-(9).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gas/burn.hpp"
#include "gas/cell_state.hpp"
#include "gas/coupling.hpp"
#include "gas/cut_cells.hpp"
#include "gas/disturbance.hpp"
#include "gas/kernels.hpp"
#include "gas/levels.hpp"
#include "gas/obstacles.hpp"
#include "gas/open_faces.hpp"
#include "gas/peaks.hpp"
#include "grid/block_store.hpp"
#include "grid/exchange.hpp"
#include "grid/fields.hpp"
#include "grid/ghost_cells.hpp"
#include "grid/grid.hpp"
#include "material/afterburn.hpp"

namespace brisance {
class Archive;
}
namespace brisance::grid {
class Forest;
}

namespace brisance::gas {

enum class Scheme { muscl_hancock, lax_wendroff };
constexpr auto words(Scheme) {
  return std::array{Word{Scheme::muscl_hancock, "muscl-hancock"}, Word{Scheme::lax_wendroff, "lax-wendroff"}};
}

struct Options {
  Scheme scheme = Scheme::muscl_hancock;
  double beta = 1.5;                             ///< limiter, 1 to 2
  bool carbuncle_cure = true;                    ///< HLL at faces near detected shocks; muscl_hancock in 2D and 3D
  double density_floor = 1e-6;                   ///< [kg/m3]
  double pressure_floor = 1e-3;                  ///< [Pa]
  double viscosity = 0.0;                        ///< lax_wendroff: constant eta; 0: [Cui14] Eq. (5)
  bool sleep = true;                             ///< skip quiescent blocks
  bool peak_fields = false;                      ///< keep peak overpressure and impulse per cell
  std::vector<WaveSource> wave_sources;          ///< where waves come from that are to leave through outflow boundaries
  std::optional<material::Afterburn> afterburn;  ///< of the products
  Index3 sweep_order{0, 1, 2};  ///< directions in the order of the forward step; those not resolved are skipped
  int bundle_cells = 320;  ///< cells that a sweep works on at a time; their arrays should stay in the nearest caches
  bool chains = true;      ///< sweeps pass through chains of blocks; false: the same bits, by copies of ghost cells
  int part_cells = 16384;  ///< cells that a thread sweeps at a time: so few that all threads end at about the same time
};

/// What calculates beside the gas, step by step of some levels.
struct Companion {
  std::vector<int> levels;  ///< of which it sees every step
  /// Before a step of a level, and after it and the steps of finer levels in it: where it begins [s], and of what
  /// length.
  std::function<void(int level, double time, double dt)> before, after;
  /// Looks at a level after each of its steps, at a time [s]; null: nobody does.
  std::function<void(int level, double time)> look;

  [[nodiscard]] bool sees(int level) const { return std::find(levels.begin(), levels.end(), level) != levels.end(); }
};

/// Guards and boundary flows since the start, summed over blocks in fixed order.
struct Account {
  Components outflow{};  ///< of each component through the domain's faces, integrated [unit m3]
  long guarded_cells = 0;
  long fallback_faces = 0;        ///< faces whose flux was replaced by, or blended with, a first-order one
  double guard_mass = 0.0;        ///< [kg]
  double guard_energy = 0.0;      ///< [J]
  double afterburn_energy = 0.0;  ///< released by the products after the detonation [J]
  Components opened{};            ///< of each component, what cells hold more since obstacles gave way [unit m3]

  Account& operator+=(Account const& other);
};

class Gas {
 public:
  /// All cells are filled with `quiescent` (the ambient state). `inflow` gives the state beyond each
  /// face where it is given (`grid::is_given`).
  Gas(grid::Grid const& grid, Fluids const& fluids, Options const& options, Primitive const& quiescent,
      std::array<Primitive, 6> const& inflow = {});

  [[nodiscard]] Fluids const& fluids() const { return fluids_; }
  [[nodiscard]] Options const& options() const { return options_; }
  [[nodiscard]] grid::Grid const& grid() const { return *grid_; }
  /// The conserved fields; after changing them call `start()`.
  [[nodiscard]] grid::Fields& fields() { return fields_; }
  [[nodiscard]] grid::Fields const& fields() const { return fields_; }

  // What is to be filled before the start, and then asked.
  Obstacles obstacles;
  CutCells cut;
  Burn burn;
  Coupling coupling;

  /// Sets one cell.
  void set(grid::Cell const& cell, Primitive const& state);
  /// Sets one cell from amounts per volume, total energy among them. Its shock sensor stays.
  void set(grid::Cell const& cell, Amounts const& per_volume, Fractions const& volume_fraction);
  /// Gives a cell that has just been opened the gas of another, at rest; what it held and what it holds now go to the
  /// account. From a cell in which explosive burns it gets nothing.
  void fill_opened(grid::Cell const& to, grid::Cell const& donor);
  /// A block whose cells have been changed from outside does not sleep on.
  void wake(int block) { awake_[block] = 1; }
  [[nodiscard]] bool awake(int block) const { return awake_[block] != 0; }

  /// Changes the blocks to the leaves of a forest. `grid` is the one that the gas has been made for; all that follow it
  /// see its new blocks. What was refined is made from the cells before, see prolongation.hpp, and what was merged is
  /// their mean: nothing is lost. Obstacles, burn times, roles and watched faces of blocks that stay are kept;
  /// `furnish` is to set those of new blocks, and all cut cells.
  using Furnish = std::function<void(std::vector<int> const& new_blocks)>;
  void regrid(grid::Grid& grid, grid::Forest const& forest, Furnish const& furnish = {});

  /// Ends the initial phase: finds the quiescent blocks, the state beyond outflow boundaries and the first wave speeds.
  void start(double time = 0.0);

  /// Largest |u_d| + c over the resolved directions and all cells, or those of a block that is awake [m/s].
  static constexpr int all_blocks = -1;
  [[nodiscard]] double fastest_signal(int block = all_blocks) const {
    return block == all_blocks ? fastest_signal_ : blocks_[block].signal;
  }

  /// One step of length dt: a sweep in each resolved direction, x first or last. A pair of steps with `reverse` false
  /// and true is the Strang splitting of [Cui14] Eq. (6) over 2 dt. Level l takes 2^l steps of dt / 2^l, and the
  /// companion steps with one of them. Throws NumericalError when a cell holds something that is no number.
  void advance(double dt, bool reverse, Companion const& companion = {});
  [[nodiscard]] double time() const { return time_; }

  [[nodiscard]] Primitive primitive(grid::Cell const& cell) const;
  [[nodiscard]] Peaks const& peaks() const { return peaks_; }
  [[nodiscard]] Account account() const;
  /// Wall-clock seconds spent in exchange and in sweeps.
  [[nodiscard]] std::map<std::string, double> const& timings() const { return timings_; }
  void archive(Archive& a);  ///< in a checkpoint, see state.cpp

 private:
  /// What sweeps find in a block, or in a part of it.
  struct Tally {
    Account account;
    double signal = 0.0;
    int not_a_number = -1;  ///< offset of a cell that is no number
  };
  /// Bundles [first, end) of all blocks of a chain, which a thread sweeps at a time.
  struct Part {
    grid::Chain const* chain;
    int first, end;
    int tally;  ///< number of that of the first block
  };
  /// What each thread has.
  struct Workspace {
    BundleArrays arrays{array_count};
    grid::KeptLayers kept;
  };

  /// Quiescent gas, and what the scheme makes of it.
  struct Quiescence {
    Components state{};
    std::array<Components, 3> flux{};  ///< by the direction of the sweep; whatever the length of the step
    double pressure = 0.0;             ///< as `measure` finds it
    double signal = 0.0;
  };

  /// What a new block holds: components, and the peaks of its cells, in turn.
  struct Contents {
    Buffer fields, peaks;
  };
  /// Of a block that is to come, from the blocks that are.
  [[nodiscard]] Contents contents_of(grid::Block const& block) const;
  /// The peaks of cells that finer ones have covered until now are the means of theirs.
  void keep_peaks_of_uncovered(grid::Grid const& next, std::vector<int> const& before);
  void merge_into(grid::Block const& block, Contents& contents) const;
  void refine_into(grid::Block const& block, Contents& contents) const;
  [[nodiscard]] bool is_quiescent_block(int block) const;
  /// Parts and what joins levels, for the grid's blocks; new ones that are covered take the means of the finer ones.
  void find_levels(std::vector<int> const& new_blocks);

  [[nodiscard]] int components() const { return fields_.components(); }
  /// The parts of a level for sweeps along a direction. They do not depend on the number of threads.
  [[nodiscard]] std::vector<Part> make_parts(int level, int direction) const;
  /// Directions of the sweeps of a step.
  [[nodiscard]] std::vector<int> sweeps_of(bool reverse) const;
  /// A step of a level from a time on, and those of the finer ones in it.
  void advance_level(int level, double time, double dt, bool reverse, Companion const& companion);
  void sweep_level(int level, int direction, double dt, bool last);
  /// Steps that the finer level needs in what is left of a step of a level, 2 in the whole: more where waves have
  /// become much faster since the step was chosen.
  [[nodiscard]] double fine_steps(int level, double left) const;
  /// What the finer level has found becomes the coarser one's.
  void take_from_finer(int level);
  /// Sweeps what is awake.
  void sweep_part(Part const& part, SweepContext const& context, grid::AwakeBlocks const& awake, bool last,
                  Workspace& workspace);
  [[nodiscard]] bool is_swept(int block, grid::AwakeBlocks const& awake) const {
    return awake[block] != 0 && !coupling.all_frozen(block);
  }
  /// From the loaded bundle to the stored one.
  void sweep_bundle(int block, int bundle, BundleLayout const& layout, SweepContext& context, bool last,
                    BundleArrays& arrays, Tally& tally);
  /// What is to be fetched while a bundle of the block at a position in the chain is calculated, for the next one.
  [[nodiscard]] grid::Ahead ahead_of(Part const& part, int position, int bundle, SweepContext const& context,
                                     grid::AwakeBlocks const& awake, bool last) const;
  /// Adds what has been found in the parts of all blocks, in their order.
  void add_tallies(std::vector<Part> const& parts);
  void load_burn(int block, BundleLayout const& layout, BundleArrays& arrays) const;
  /// Where a bundle finds the ghost cells of a side.
  [[nodiscard]] grid::GhostSide ghosts_beyond(int block, int side, BundleLayout const& layout) const;
  void load_bundle(int block, BundleLayout const& layout, SweepContext& context, Workspace& workspace) const;
  /// Rings or shells of a row of cells along a radius, its ghost cells included.
  struct Shells {
    std::vector<double> high, low;  ///< areas of the faces per volume [1/m]
    std::vector<double> spread;     ///< half their difference, signed like the radius
  };
  [[nodiscard]] static Shells shells_of(grid::Grid const& grid, grid::Block const& block);
  /// Puts those of a block, times dt, into the rows of a bundle along the radius.
  void load_shells(int block, BundleLayout const& layout, SweepContext const& context, BundleArrays& arrays) const;
  void store(int block, BundleLayout const& layout, SweepContext const& context, BundleArrays& arrays);
  /// Does a step change the quiescent blocks? Wakes those that it does change: in a wind an obstacle, a wall or an axis
  /// disturbs the gas from the first step on, and only the scheme itself knows what it changes in the last bit.
  void wake_where_wind_changes();
  /// A step that quiescent gas can take [s].
  [[nodiscard]] double short_step() const;
  /// Finds what the scheme makes of quiescent gas.
  void find_quiescence();
  /// Are the ghost cells quiescent that a bundle sees?
  [[nodiscard]] bool ghosts_rest(int block, BundleLayout const& layout, grid::KeptLayers const& kept) const;
  /// Is a bundle quiescent, and stays so?
  [[nodiscard]] bool rests(int block, int bundle, BundleLayout const& layout, grid::KeptLayers const& kept);
  /// Books what goes through the domain's faces in front of a quiescent bundle, as if it were swept.
  void account_quiet(int block, BundleLayout const& layout, int direction, double dt, Account& account) const;
  /// The same for a sleeping block of a part.
  void account_asleep(int block, Part const& part, int direction, double dt, Account& account) const;
  [[nodiscard]] SweepContext sweep_context(int direction, double dt) const;
  /// How many fluids a row holds, and what follows from it.
  void set_present(int present, SweepContext& s) const;
  void account_boundaries(int block, BundleLayout const& layout, SweepContext const& context, BundleArrays& arrays,
                          Account& account) const;
  /// Guards, wave speed and peak fields of the bundle's own cells after the last sweep of a step.
  void measure(int block, int bundle, BundleLayout const& layout, SweepContext const& context, BundleArrays& arrays,
               GuardCount& guards, Tally& tally);
  /// Releases the energy of the afterburn in the bundle's own cells, after the last sweep of a step.
  void burn_on(int block, BundleLayout const& layout, SweepContext const& context, BundleArrays& arrays,
               Account& account) const;
  /// Counts what the guards of a bundle have done.
  void account_guards(int block, BundleLayout const& layout, GuardCount const& guards, Tally& tally) const;
  /// Puts the frozen cells of a bundle back to what they were.
  void restore_frozen(int block, BundleLayout const& layout, BundleArrays& arrays) const;
  /// Adds what goes through the watched faces.
  void account_watched(int block, int bundle, BundleLayout const& layout, SweepContext const& context,
                       BundleArrays& arrays);
  /// A cell has been changed from outside.
  void note_change(grid::Cell const& cell);
  void load_node(int node);
  // Cut cells, see cut_sweep.cpp. Takes the states of nodes from the fields.
  void load_nodes();
  /// The states beside walls at the start of a step.
  void find_walls();
  void find_wall(Node const& node, double const* state);
  [[nodiscard]] Components wall_flux(int cut_cell, int direction);
  /// Asks for what will be read of the nodes in a bundle, long enough before.
  void announce_nodes(int block, int direction, int bundle);
  /// What a sweep changes in the cut cells of a bundle; the update will leave them alone.
  void take_cut_changes(int block, int bundle, BundleLayout const& layout, SweepContext const& context,
                        BundleArrays& arrays);
  /// The states of the nodes in a bundle after a sweep.
  void take_node_states(int block, int bundle, SweepContext const& context, BundleArrays& arrays);
  /// Leaves the peaks of a bundle's nodes to `share_states`.
  void keep_peaks(int block, int bundle, SweepContext const& context, BundleArrays& arrays) const;
  /// State redistribution after a sweep.
  void share_small_cells(SweepContext const& context, bool last);
  void merge_small_cells();
  /// Of the nodes [begin, end), all of one block; tells those that are left unsound.
  void share_states(int begin, int end, SweepContext const& context, bool last, std::vector<int>& unsound);
  void store_node(int node);
  /// Blends the state of an unsound node and of the cells beside it with their mean, no more than it takes.
  void mend(int node, SweepContext const& context);
  [[nodiscard]] bool is_quiescent(double const* state) const;
  void measure_all();
  void prepare_workspaces();
  /// Infinite where a fluid bears tension, else 0, see `margin`.
  [[nodiscard]] double most_H() const;
  [[noreturn]] void report_not_a_number(int block, int direction) const;

  grid::Grid const* grid_;
  Fluids fluids_;
  Options options_;
  Primitive quiescent_;
  grid::Fields fields_;
  grid::Exchange exchange_;
  OpenFaces open_faces_;
  Quiescence quiet_;
  grid::AwakeBlocks awake_;
  Disturbance disturbance_;
  grid::BlockStore<Tally> blocks_;
  grid::BlockStore<Shells> shells_;
  std::vector<std::array<std::vector<Part>, 3>> parts_;  ///< of all blocks, by level and the direction of the sweep
  Levels levels_;
  std::vector<Tally> tallies_;  ///< of the parts
  Account carried_;             ///< of blocks that are no more
  Peaks peaks_;
  std::vector<Workspace> workspaces_;
  std::map<std::string, double> timings_;
  double time_ = 0.0;
  double time_at_step_end_ = 0.0;
  double fastest_signal_ = 0.0;
  double most_signal_ = 0.0;  ///< with which the present step is stable [m/s]
};

/// Do a cell and the next one in a block's arrays hold the same gas, to the last bit? Not asked where explosive burns.
[[nodiscard]] bool hold_the_same(Gas const& gas, int block, int offset);

/// The states of cells of a level, wherever they lie.
[[nodiscard]] std::vector<Primitive> gather(Gas const& gas, std::vector<Index3> const& cells, int level = 0);

}  // namespace brisance::gas
