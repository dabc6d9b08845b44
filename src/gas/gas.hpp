/// The gas region: conserved fields in blocks, advanced by dimensionally split sweeps. [Cui14] Sec. 2.1, Eqs. (1)-(9).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gas/closure.hpp"
#include "gas/kernels.hpp"
#include "gas/open_faces.hpp"
#include "grid/block_store.hpp"
#include "grid/exchange.hpp"
#include "grid/fields.hpp"
#include "grid/grid.hpp"
#include "material/afterburn.hpp"

namespace brisance {
class Archive;
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
  std::optional<material::Afterburn> afterburn;  ///< of the second fluid
  Index3 sweep_order{0, 1, 2};  ///< directions in the order of the forward step; those not resolved are skipped
  int bundle_cells = 320;  ///< cells that a sweep works on at a time; their arrays should stay in the nearest caches
};

/// State of a cell as people think of it.
struct Primitive {
  double density = 0.0;          ///< of the mixture [kg/m3]
  Vec3 velocity{0.0, 0.0, 0.0};  ///< [m/s]
  double pressure = 0.0;         ///< [Pa]
  double volume_fraction = 0.0;  ///< of the second fluid
  double mass_fraction = 0.0;    ///< of the second fluid
  double sound_speed = 0.0;      ///< [m/s]
};

/// A mixture given by its primitive state; the fluids' own densities are free.
struct MixtureState {
  double ambient_density = 1.225;  ///< density of the ambient fluid itself [kg/m3]
  double second_density = 0.0;     ///< density of the second fluid itself [kg/m3]
  double volume_fraction = 0.0;    ///< of the second fluid
  Vec3 velocity{0.0, 0.0, 0.0};
  double pressure = 101325.0;
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

/// What a cell is to the gas where another method calculates too.
enum class Role : std::uint8_t {
  own,     ///< advanced, and counted
  shadow,  ///< advanced, but its content is counted by the other method
  held,    ///< keeps what others put into it; seen by its neighbours
};

/// What went through one face, integrated over time, per area; positive along the direction.
struct FaceFlux {
  std::array<double, 2> mass{0.0, 0.0};  ///< of the two fluids [kg/m2]
  Vec3 momentum{0.0, 0.0, 0.0};          ///< carried along with the mass [kg/(m s)]
  double energy = 0.0;                   ///< carried along with the mass [J/m2]
  double impulse = 0.0;                  ///< of the pressure [Pa s]
  double work = 0.0;                     ///< of the pressure [J/m2]
  double volume = 0.0;                   ///< of gas that crossed, per area [m]
};

/// When a cell's explosive begins to burn and when all of it is burnt [s]: the burn fraction F grows evenly between,
/// from 0 to 1. By default what comes into the cell is burnt.
struct BurnTime {
  double begin = -std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();
};

class Gas {
 public:
  /// All cells are filled with `quiescent` (the ambient state). `inflow` gives the state outside each inflow face.
  Gas(grid::Grid const& grid, Fluids const& fluids, Options const& options, MixtureState const& quiescent,
      std::array<MixtureState, 6> const& inflow = {});

  [[nodiscard]] int components() const { return fields_.components(); }
  [[nodiscard]] Fluids const& fluids() const { return fluids_; }
  [[nodiscard]] Options const& options() const { return options_; }
  [[nodiscard]] grid::Grid const& grid() const { return *grid_; }
  /// The conserved fields; after changing them call `start()`.
  [[nodiscard]] grid::Fields& fields() { return fields_; }
  [[nodiscard]] grid::Fields const& fields() const { return fields_; }

  /// Sets one cell.
  void set(grid::Cell const& cell, MixtureState const& state);
  /// Sets one cell from conserved quantities per volume: partial densities, momentum, total energy, volume fraction.
  void set_conserved(grid::Cell const& cell, double ambient, double second, Vec3 const& momentum, double total_energy,
                     double volume_fraction);
  /// Conserved components of a state, in component order.
  [[nodiscard]] Components conserved(MixtureState const& state) const;

  /// Marks obstacle cells of a block (1: solid), over `Block::with_ghosts`.
  void set_obstacles(int block, std::vector<std::uint8_t> solid);
  [[nodiscard]] bool is_obstacle(grid::Cell const& cell) const;
  /// The same by the index in the domain.
  [[nodiscard]] bool is_obstacle(Index3 const& cell) const { return is_obstacle(grid_->locate(cell)); }
  /// From now on these cells (domain indices) are gas; they hold what they did.
  void open_obstacles(std::vector<Index3> const& cells);
  /// Gives a cell that has just been opened the gas of another, at rest; what it held and what it holds now go to the
  /// account. From a cell in which explosive burns it gets nothing.
  void fill_opened(Index3 const& cell, Index3 const& from);

  /// Gives the cells of a block their roles; without them all are its own.
  void set_roles(int block, std::vector<Role> roles);
  [[nodiscard]] Role role(int block, int offset) const {
    return blocks_[block].roles.empty() ? Role::own : blocks_[block].roles[offset];
  }
  /// Does a cell's content count?
  [[nodiscard]] bool is_own(grid::Cell const& cell) const { return role(cell.block, cell.offset) == Role::own; }
  /// A block whose cells have been changed from outside does not sleep on.
  void wake(int block) { awake_[block] = 1; }

  /// Keeps account of the face at the high side of a cell (domain index, not beyond the domain's last but one) in a
  /// direction. Returns its number.
  int watch(Index3 const& cell, int direction);
  /// What went through the watched faces since `clear_watched`, by their numbers. Through faces between sleeping blocks
  /// nothing goes.
  [[nodiscard]] std::vector<FaceFlux> const& watched() const { return watched_; }
  void clear_watched() { std::fill(watched_.begin(), watched_.end(), FaceFlux{}); }

  /// Programmed burn: when the block's cells burn, over `Block::with_ghosts`.
  void set_burn_times(int block, std::vector<BurnTime> times);
  /// Speed of the detonation [m/s], the time after which everything is burnt [s], and the volume fraction up to which
  /// explosive in a cell is a trace that counts as burnt: with less of it than the pressure of the air in the cell asks
  /// for, the model of unburnt explosive would leave that air no pressure of its own.
  void set_burn(double detonation_speed, double end_time, double trace);
  [[nodiscard]] bool burning() const { return time_ < burn_end_; }

  /// Tells that a charge bursts in an interval of time [s]: it burns or its products break out. What that means for the
  /// steps decides who takes them.
  void expect_burst(double begin, double end) { bursts_.push_back({begin, end}); }
  [[nodiscard]] bool bursting() const;
  /// When the next burst begins [s]; infinite: there is none to come.
  [[nodiscard]] double next_burst() const;
  /// Largest compression, the second fluid's own density over the unburnt one less 1, in cells that hold a good
  /// part of explosive that will not burn for some cells' time yet; 0: none is compressed. Nothing but a blow from
  /// elsewhere compresses it, and programmed burn leaves it no strength but the ambient pressure.
  [[nodiscard]] double unlit_compression(double unburnt_density) const;
  /// Burn fraction F of a cell, see `BurnTime`.
  [[nodiscard]] double burn_fraction(grid::Cell const& cell) const;

  /// Progress lambda of the afterburn in a cell: 0 without products, without afterburn and before it.
  [[nodiscard]] double afterburn_progress(grid::Cell const& cell) const;

  /// Where the waves come from that are to leave through outflow boundaries; call `start()` afterwards.
  void set_wave_sources(std::vector<WaveSource> sources) { open_faces_.set_sources(std::move(sources)); }

  /// Ends the initial phase: finds the quiescent blocks, the state beyond outflow boundaries and the first wave speeds.
  void start(double time = 0.0);

  /// Largest |u_d| + c over the resolved directions and all cells [m/s].
  [[nodiscard]] double fastest_signal() const { return fastest_signal_; }

  /// One step of length dt: a sweep in each resolved direction, x first or last. A pair of steps with `reverse` false
  /// and true is the Strang splitting of [Cui14] Eq. (6) over 2 dt. Throws NumericalError when a cell holds something
  /// that is no number.
  void advance(double dt, bool reverse);
  [[nodiscard]] double time() const { return time_; }

  [[nodiscard]] Primitive primitive(grid::Cell const& cell) const;
  /// The same for any cell of the domain, wherever it lies.
  [[nodiscard]] std::vector<Primitive> gather(std::vector<Index3> const& cells) const;
  /// Peak fields of a block, x fastest: peak overpressure [Pa], largest running impulse [Pa s]. Empty without
  /// `peak_fields`.
  [[nodiscard]] double const* peak_overpressure(int block) const;
  [[nodiscard]] double const* peak_impulse(int block) const;

  [[nodiscard]] bool awake(int block) const { return awake_[block] != 0; }
  [[nodiscard]] Account account() const;
  /// Wall-clock seconds spent in exchange and in sweeps.
  [[nodiscard]] std::map<std::string, double> const& timings() const { return timings_; }
  void archive(Archive& a);  ///< in a checkpoint, see state.cpp

 private:
  struct WatchedFace {
    grid::Cell cell;
    int number = 0;
  };
  struct BlockData {
    std::vector<std::uint8_t> solid;
    std::vector<Role> roles;  ///< empty: all own
    bool all_held = false;
    std::array<std::vector<std::vector<WatchedFace>>, 3> watched;  ///< per direction and bundle
    std::array<std::vector<std::vector<WallRun>>, 3> near_walls;   ///< the same; empty: none near
    std::vector<BurnTime> burn_times;
    Account account;
    double signal = 0.0;
    int not_a_number = -1;  ///< offset of a cell that is no number
  };
  enum Peak : int { peak_pressure, running_impulse, largest_impulse, peak_count };

  void sweep_block(int block, SweepContext const& context, bool last, BundleArrays& arrays);
  void load_burn(int block, BundleLayout const& layout, BundleArrays& arrays) const;
  void load_bundle(int block, BundleLayout const& layout, SweepContext& context, BundleArrays& arrays) const;
  /// Areas and volumes of the rings or shells of a bundle along a radius.
  void load_shells(grid::Block const& block, BundleLayout const& layout, SweepContext const& context,
                   BundleArrays& arrays) const;
  static void update(BundleLayout const& layout, SweepContext const& context, BundleArrays& arrays);
  void store(int block, BundleLayout const& layout, SweepContext const& context, BundleArrays& arrays);
  /// Does a step change the quiescent blocks? Wakes those that it does change: in a wind an obstacle, a wall or an axis
  /// disturbs the gas from the first step on, and only the scheme itself knows what it changes in the last bit.
  void wake_where_wind_changes();
  /// What the scheme makes of quiescent gas in a sweep: its fluxes, and its pressure.
  [[nodiscard]] Components quiescent_flux(SweepContext context) const;
  [[nodiscard]] double quiescent_pressure() const;
  /// Books what goes through the domain's faces in front of a sleeping block, as an awake one would.
  void account_asleep(int block, SweepContext const& context, Components const& flux);
  [[nodiscard]] SweepContext sweep_context(int direction, double dt) const;
  void account_boundaries(int block, BundleLayout const& layout, SweepContext const& context, BundleArrays& arrays);
  /// Guards, wave speed and peak fields of the bundle's own cells after the last sweep of a step.
  void measure(int block, BundleLayout const& layout, SweepContext const& context, BundleArrays& arrays,
               GuardCount& guards);
  /// Releases the energy of the afterburn in the bundle's own cells, after the last sweep of a step.
  void burn_on(int block, BundleLayout const& layout, SweepContext const& context, BundleArrays& arrays);
  /// Puts the held cells of a bundle back to what they were.
  void restore_held(int block, BundleLayout const& layout, BundleArrays& arrays) const;
  /// Adds what goes through the watched faces.
  void account_watched(int block, int bundle, BundleLayout const& layout, SweepContext const& context,
                       BundleArrays& arrays);
  void measure_all();
  void prepare_workspaces();
  /// Finds the cells of some blocks that are near rigid surfaces, from the obstacles and the faces of the domain. See
  /// walls.cpp.
  void find_near_walls(std::vector<int> const& blocks);
  /// Blocks that reach, with so many layers around them, into the box of some cells; all where the domain is periodic.
  [[nodiscard]] std::vector<int> blocks_near(std::vector<Index3> const& cells, int layers) const;
  /// Infinite where a fluid bears tension, else 0, see `margin`.
  [[nodiscard]] double most_H() const;
  [[noreturn]] void report_not_a_number(int block, int direction) const;
  [[nodiscard]] Primitive to_primitive(double const* components, double F) const;
  [[nodiscard]] double burn_fraction_of(BurnTime const& times) const;
  [[nodiscard]] bool is_trace(double alpha) const;

  grid::Grid const* grid_;
  Fluids fluids_;
  Options options_;
  MixtureState quiescent_;
  grid::Fields fields_;
  grid::Exchange exchange_;
  OpenFaces open_faces_;
  double quiet_pressure_ = 0.0;  ///< of quiescent gas as `measure` finds it
  grid::AwakeBlocks awake_;
  grid::BlockStore<BlockData> blocks_;
  std::vector<FaceFlux> watched_;
  grid::BlockStore<Buffer> peaks_;  ///< without `peak_fields` empty ones
  std::vector<BundleArrays> workspaces_;
  std::map<std::string, double> timings_;
  double time_ = 0.0;
  double time_at_step_end_ = 0.0;
  double fastest_signal_ = 0.0;
  double detonation_speed_ = 0.0;
  double burn_end_ = 0.0;
  double trace_ = vanishing_fraction;          ///< volume fraction of explosive that counts as burnt
  std::vector<std::array<double, 2>> bursts_;  ///< begin and end [s]
};

}  // namespace brisance::gas
